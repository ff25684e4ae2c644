# Installs the build into a fresh folder, builds a small program against it alone, and runs that program.
#   cmake -D BUILD=<build folder> -D CONSUMER=<this folder> -P install_test.cmake
set(SCRATCH "${BUILD}/install test")  # a space, as users' folders have
set(PREFIX "${SCRATCH}/prefix")
file(REMOVE_RECURSE "${SCRATCH}")

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}" OUTPUT_QUIET)
run("${CMAKE_COMMAND}" -G Ninja -D CMAKE_BUILD_TYPE=Release -D "CMAKE_PREFIX_PATH=${PREFIX}"
    -S "${CONSUMER}" -B "${SCRATCH}/build")
run("${CMAKE_COMMAND}" --build "${SCRATCH}/build")
# Its signature is measured once for this build folder, and not into the user's cache.
run("${CMAKE_COMMAND}" -E env "XDG_CACHE_HOME=${BUILD}/install test cache" "${SCRATCH}/build/consumer")
run("${PREFIX}/bin/lodestone" --help)
