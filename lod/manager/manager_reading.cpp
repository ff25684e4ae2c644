#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"

namespace lodestone {
namespace {

void check_size(std::size_t found, std::size_t expected, std::string_view what) {
  if (found != expected)
    throw_input_error(what, fmt::format("room for {} numbers", found), fmt::to_string(expected));
}

}  // namespace

std::string_view name_of(Rung rung) { return std::array{"tables", "support", "full"}[std::size_t(rung)]; }

int Manager::bodies() const { return impl_->levels.bodies.size(); }
bool Manager::valid(BodyId body) const { return impl_->levels.bodies.valid(body); }
RigidState Manager::state(BodyId body) const { return impl_->levels.state(impl_->index_of(body)); }
double Manager::mass(BodyId body) const { return impl_->levels.bodies[impl_->index_of(body)].mass; }
const Shape& Manager::shape(BodyId body) const { return *impl_->levels.bodies.shape(impl_->index_of(body)); }
Level Manager::level(BodyId body) const { return level_of(rung(body)); }
Rung Manager::rung(BodyId body) const { return impl_->levels.bodies.level(impl_->index_of(body)).rung; }
bool Manager::asleep(BodyId body) const { return impl_->levels.asleep(impl_->index_of(body)); }
double Manager::collision_radius(BodyId body) const {
  const StatisticalPlace place = impl_->levels.bodies[impl_->index_of(body)].statistical;
  return place ? impl_->levels.statistical->sphere_radius(place) : 0.0;
}
dxBody* Manager::ode_body(BodyId body) const {
  const BodyRecord& record = impl_->levels.bodies[impl_->index_of(body)];
  return record.ode ? impl_->levels.full.world()->ode_body(record.ode) : nullptr;
}
std::uintptr_t Manager::user_data(BodyId body) const {
  return impl_->levels.bodies[impl_->index_of(body)].user_data;
}
const BodyProperties& Manager::properties(BodyId body) const {
  return impl_->levels.bodies.properties(impl_->index_of(body));
}

void Manager::read_states(std::span<const BodyId> bodies, std::span<RigidState> states) const {
  check_size(states.size(), bodies.size(), "states");
  for (const BodyId body : bodies) impl_->index_of(body);
  for (std::size_t i = 0; i < bodies.size(); ++i) states[i] = impl_->levels.state(bodies[i].index);
}

void Manager::read_poses(std::span<const BodyId> bodies, std::span<float> positions_xyz,
                         std::span<float> orientations_wxyz) const {
  check_size(positions_xyz.size(), 3 * bodies.size(), "positions");
  check_size(orientations_wxyz.size(), 4 * bodies.size(), "orientations");
  for (const BodyId body : bodies) impl_->index_of(body);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RigidState state = impl_->levels.state(bodies[i].index);
    const Quat& q = state.orientation;
    const std::array<double, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
    std::ranges::transform(state.position, &positions_xyz[3 * i], [](double x) { return float(x); });
    std::ranges::transform(wxyz, &orientations_wxyz[4 * i], [](double x) { return float(x); });
  }
}

std::span<const BodyId> Manager::moved() const { return impl_->changes.moved(); }
std::span<const BodyId> Manager::fell_asleep() const { return impl_->changes.fell_asleep(); }
std::span<const BodyId> Manager::woke() const { return impl_->changes.woke(); }
std::span<const RungChange> Manager::rung_changes() const { return impl_->changes.rung_changes(); }

const StepReport& Manager::report() const { return impl_->report; }
std::size_t Manager::statistical_bytes() const {
  return impl_->levels.statistical ? impl_->levels.statistical->bytes() : 0;
}

std::uint64_t Manager::state_hash() const {
  const Levels& levels = impl_->levels;
  std::uint64_t hash = 0;
  for (const std::uint32_t body : levels.bodies.in_order_of_creation()) {
    const std::array<double, 15> numbers = levels.numbers_of(body);
    hash = XXH64(numbers.data(), sizeof numbers, hash);
  }
  return hash;
}

}  // namespace lodestone
