# Installs the build into a fresh folder, as a static and as a shared library, builds small programs against what was installed alone, and runs them.
#   cmake -D BUILD=<build folder> -D SOURCE=<source folder> -D CONSUMER=<this folder> -D COMPILER=<C++ compiler> -P install_test.cmake
set(SCRATCH "${BUILD}/install test")  # a space, as users' folders have
file(REMOVE_RECURSE "${SCRATCH}")

# Signatures are measured once for this build folder, and not into the user's cache.
set(ENV{XDG_CACHE_HOME} "${BUILD}/install test cache")

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Builds the programs against the package in `prefix`, all of them or those named, and runs them.
function(run_programs prefix build)
  run("${CMAKE_COMMAND}" -G Ninja -D CMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_PREFIX_PATH=${prefix}" "-DONLY=${ARGN}" -S "${CONSUMER}" -B "${build}")
  run("${CMAKE_COMMAND}" --build "${build}")
  file(GLOB programs "${build}/programs/*")
  foreach(program ${programs})
    run("${program}")
  endforeach()
  run("${build}/host" "${build}/libplugin.so")
endfunction()

# Builds a program as people do without CMake.
function(run_with_pkg_config prefix program)
  file(GLOB_RECURSE package "${prefix}/*/lodestone.pc")
  cmake_path(GET package PARENT_PATH folder)
  set(ENV{PKG_CONFIG_PATH} "${folder}")
  cmake_path(GET folder PARENT_PATH libraries)
  run(sh -c "eval \"\$0\" -std=c++20 -O1 -w '\"\$1\"' -o '\"\$2\"' \$(pkg-config --cflags --libs lodestone) '-Wl,-rpath,\"\$3\"'" "${COMPILER}" "${CONSUMER}/one_include.cpp" "${program}" "${libraries}")
  run("${program}")
endfunction()

set(STATIC "${SCRATCH}/static")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${STATIC}" OUTPUT_QUIET)
file(GLOB_RECURSE PRIVATE_HEADERS "${STATIC}/include/*_impl.h" "${STATIC}/include/*_ode.h" "${STATIC}/include/*_level.h")
if(PRIVATE_HEADERS)
  message(FATAL_ERROR "private headers are installed: ${PRIVATE_HEADERS}")
endif()
run_programs("${STATIC}" "${SCRATCH}/static build")
run_with_pkg_config("${STATIC}" "${SCRATCH}/static program")
run("${STATIC}/bin/lodestone" --help)

# The same objects as a shared library.
set(SHARED "${SCRATCH}/shared")
run("${CMAKE_COMMAND}" -G Ninja -D CMAKE_BUILD_TYPE=Release -D BUILD_SHARED_LIBS=ON -D LODESTONE_BUILD_SCENES=OFF -D LODESTONE_BUILD_TESTS=OFF "-DCMAKE_CXX_COMPILER=${COMPILER}"
    "-DLODESTONE_ENGINE_OBJECTS=${BUILD}/engine_objects.txt" -S "${SOURCE}" -B "${SCRATCH}/shared library")
run("${CMAKE_COMMAND}" --build "${SCRATCH}/shared library")
run("${CMAKE_COMMAND}" --install "${SCRATCH}/shared library" --prefix "${SHARED}" OUTPUT_QUIET)
file(GLOB_RECURSE ARCHIVES "${SHARED}/*.a")
if(ARCHIVES)
  message(FATAL_ERROR "a static library is installed with the shared one: ${ARCHIVES}")
endif()
run_programs("${SHARED}" "${SCRATCH}/shared build" one_include consumer c_interface)
run_with_pkg_config("${SHARED}" "${SCRATCH}/shared program")
