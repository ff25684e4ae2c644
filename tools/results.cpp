#include "tools/results.h"

#include <fmt/format.h>

#include "tools/interrupt.h"

namespace lodestone {

void print_json(nlohmann::ordered_json json) {
  if (is_interrupted()) json["incomplete"] = true;
  fmt::print("{}\n", json.dump(2));
}

}  // namespace lodestone
