# For ctest, before it runs: each suite of PROGRAM, which has GoogleTest's options, becomes a test, and the largest begin first. Not each
# test of a suite, as gtest_discover_tests() has it: starting a process takes longer than most of them. A suite whose name begins with Long is
# labelled `long`.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE LISTED COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE " +#[^\n]*" "" LISTED "${LISTED}")  # what parameters are
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\.[^\n]*(\n  [^\n]*)*" SUITES "${LISTED}")
foreach(TESTS IN LISTS SUITES)
  string(REGEX REPLACE "^\n([^.]*).*" "\\1" SUITE "${TESTS}")
  string(REGEX MATCHALL "\n" COUNT "${TESTS}")
  list(LENGTH COUNT COUNT)
  add_test("${SUITE}" "${PROGRAM}" "--gtest_filter=${SUITE}.*")
  set_tests_properties("${SUITE}" PROPERTIES COST ${COUNT})
  if(SUITE MATCHES "^Long")
    set_tests_properties("${SUITE}" PROPERTIES LABELS long)
  endif()
endforeach()
