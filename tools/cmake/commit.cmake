# Writes FILE, which defines LODESTONE_COMMIT, where that has changed: run at each build, as `cmake -D SOURCE=… -D FILE=… -P commit.cmake`.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty=+ --exclude=* OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE FAILED)
if(FAILED)
  set(COMMIT unknown)
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "#define LODESTONE_COMMIT \"@COMMIT@\"\n" @ONLY)
