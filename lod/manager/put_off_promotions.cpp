#include "lod/manager/put_off_promotions.h"

#include <algorithm>

namespace lodestone {

void PutOffPromotions::put_off(std::uint32_t body) {
  constexpr int kFirst = 8, kLast = 128;  // frames
  Wait& wait = waits_[body];
  wait.frames_left = wait.frames = std::clamp(2 * wait.frames, kFirst, kLast);
}

std::vector<std::uint32_t> PutOffPromotions::count_down() {
  std::vector<std::uint32_t> due;
  for (auto& [body, wait] : waits_)
    if (wait.frames_left > 0 && --wait.frames_left == 0) due.push_back(body);
  return due;
}

std::vector<std::uint32_t> PutOffPromotions::waiting() const {
  std::vector<std::uint32_t> waiting;
  for (const auto& [body, wait] : waits_)
    if (wait.frames_left > 0) waiting.push_back(body);
  return waiting;
}

}  // namespace lodestone
