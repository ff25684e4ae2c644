# The texts of HTML pages (tools/*/*.html, *.css, *.js) and the tables that they show (tests/baselines/*.csv) as one C++ file, so that the program needs no file of its own at run time.
function(add_page_texts TARGET)
  file(GLOB FILES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/*/*.html ${PROJECT_SOURCE_DIR}/tools/*/*.css ${PROJECT_SOURCE_DIR}/tools/*/*.js
    ${PROJECT_SOURCE_DIR}/tests/baselines/*.csv)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${FILES})
  set(TEXTS "")
  foreach(FILE ${FILES})
    get_filename_component(NAME ${FILE} NAME)
    file(READ ${FILE} TEXT)
    string(APPEND TEXTS "    {\"${NAME}\", R\"lodestone_page(${TEXT})lodestone_page\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/page_texts.cpp @ONLY CONTENT [=[
#include "tools/pages/page_texts.h"

#include <array>
#include <utility>

namespace lodestone {

std::optional<std::string_view> find_page_text(std::string_view name) {
  static const std::pair<std::string_view, std::string_view> kTexts[] = {  // too long for constexpr with clang
@TEXTS@  };
  for (const auto& [known, text] : kTexts)
    if (known == name) return text;
  return std::nullopt;
}

}  // namespace lodestone
]=])
  # GCC and clang take literals of any length.
  set_source_files_properties(${PROJECT_BINARY_DIR}/page_texts.cpp PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
  target_sources(${TARGET} PRIVATE ${PROJECT_BINARY_DIR}/page_texts.cpp)
endfunction()
