#include "reference/error.h"

#include <cstdio>
#include <cstdlib>

namespace lodestone {

void check_that(bool holds, std::string_view contract, std::string_view values, std::source_location place) {
  if (holds) return;
  std::fprintf(stderr, "%s:%u: contract broken: %.*s %.*s\n", place.file_name(), place.line(),
               int(contract.size()), contract.data(), int(values.size()), values.data());
  std::abort();
}

}  // namespace lodestone
