#include "lod/timing/stage_zones.h"

#include <array>
#include <functional>
#include <string_view>

namespace lodestone {
namespace {

constexpr std::array<std::string_view, 9> kZones = {
    "choose", "transfer", "flight", "broad_phase", "pairs", "crowd", "rest", "cross_level", "full"};
static_assert(sizeof(StageTimes) == (kZones.size() + 1) * sizeof(double),
              "one zone for each of StageTimes but the total, in its order");

// Timers are deep inside the levels, which know of no hooks: it goes by thread, as a call stack does.
thread_local StageZones* current = nullptr;

}  // namespace

StageZones::StageZones(const ProfileHooks& hooks, const StageTimes& times)
    : hooks_(&hooks), times_(&times), outer_(current) {
  if (hooks.begin || hooks.end) current = this;
  if (hooks.begin) hooks.begin("step");
}

StageZones::~StageZones() {
  if (hooks_->end) hooks_->end("step");
  current = outer_;
}

std::string_view StageZones::name_of(const double& field) const {
  const double* first = &times_->choose_ms;
  return std::less<>{}(&field, first) || !std::less<>{}(&field, first + kZones.size())
             ? std::string_view{}
             : kZones[std::size_t(&field - first)];
}

void StageZones::begin(const double& field) {
  if (!current || !current->hooks_->begin) return;
  if (const std::string_view zone = current->name_of(field); !zone.empty()) current->hooks_->begin(zone);
}

void StageZones::end(const double& field) {
  if (!current || !current->hooks_->end) return;
  if (const std::string_view zone = current->name_of(field); !zone.empty()) current->hooks_->end(zone);
}

}  // namespace lodestone
