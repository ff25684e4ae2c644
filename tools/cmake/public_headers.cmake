# The headers that a user of Lodestone may include: those named here and what they include of the project's own.
set(LODESTONE_PUBLIC_ENGINE lod/*.h reference/error.h signature/signature_file.h signature/signature_source.h)
set(LODESTONE_PUBLIC_SCENES scenes/scene_file.h scenes/runner.h scenes/shape_source.h scenes/trajectory.h)

# Sets `result` to the headers, relative to `source`, that match the patterns which follow, and all that those include with quotes.
function(lodestone_public_headers result source)
  list(TRANSFORM ARGN PREPEND "${source}/" OUTPUT_VARIABLE patterns)
  file(GLOB waiting RELATIVE "${source}" ${patterns})
  set(found)
  while(waiting)
    list(POP_FRONT waiting header)
    list(FIND found "${header}" at)  # installation scripts know no IN_LIST
    if(NOT at EQUAL -1)
      continue()
    endif()
    list(APPEND found "${header}")
    file(STRINGS "${source}/${header}" lines REGEX "^#include \"")
    list(TRANSFORM lines REPLACE "^#include \"([^\"]+)\".*" "\\1")
    list(APPEND waiting ${lines})
  endwhile()
  list(SORT found)
  set(${result} ${found} PARENT_SCOPE)
endfunction()
