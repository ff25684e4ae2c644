// What a caller says to the policy, and what it says of a body.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"

namespace lodestone {
namespace {

// Why bodies make no group.
std::string words_of_refused(std::span<const std::uint32_t> bodies, const Groups& groups) {
  for (auto body = bodies.begin(); body != bodies.end(); ++body) {
    if (std::find(bodies.begin(), body, *body) != body) return fmt::format("body {} twice", *body);
    if (groups.of(*body)) return fmt::format("body {}, which is in a group already", *body);
  }
  return "no body";
}

}  // namespace

PolicySettings::~PolicySettings() = default;

void Manager::set_policy(const PolicySettings& policy) {
  check_policy(policy);
  impl_->choose.set_policy(policy);
  if (impl_->recorder.on())
    impl_->recorder.note(Call::set_policy,
                         RecordedPolicy{policy, bool(policy.visible), bool(policy.significance)});
}

void Manager::set_viewpoints(std::span<const Vec3> positions) {
  for (const Vec3& position : positions) checked(Viewpoint{.position = position});
  impl_->choose.set_views(Views(positions));
  if (impl_->recorder.on())
    impl_->recorder.note(Call::set_positions, std::vector<Vec3>(positions.begin(), positions.end()));
}

void Manager::set_viewpoints(std::span<const Viewpoint> viewpoints) {
  std::vector<Viewpoint> sound;
  for (const Viewpoint& viewpoint : viewpoints) sound.push_back(checked(viewpoint));
  impl_->choose.set_views(Views(std::span<const Viewpoint>(sound)));
  if (impl_->recorder.on())
    impl_->recorder.note(Call::set_viewpoints, std::vector<Viewpoint>(viewpoints.begin(), viewpoints.end()));
}

void Manager::set_viewpoints(std::initializer_list<Viewpoint> viewpoints) {
  set_viewpoints(std::span(viewpoints.begin(), viewpoints.size()));
}

void Manager::set_rung_range(BodyId body, Rung least, Rung greatest) {
  const std::uint32_t index = impl_->index_of(body);
  check_rung_range(least, greatest);
  impl_->levels.bodies.level(index).least = least;
  impl_->levels.bodies.level(index).greatest = greatest;
  impl_->choose.note(index);
  impl_->recorder.note(Call::set_rung_range, body, least, greatest);
}

GroupId Manager::make_group(std::span<const BodyId> bodies, GroupJoints joints) {
  if (bool(joints.before_demotion) != bool(joints.after_promotion))
    throw_input_error("a group's joints", "one function alone", "both or none");
  std::vector<std::uint32_t> members;
  for (const BodyId body : bodies) members.push_back(impl_->index_of(body));
  const GroupId group = impl_->choose.groups().make(members, std::move(joints));
  if (!group)
    throw_input_error("a group", words_of_refused(members, impl_->choose.groups()),
                      "at least one body, none twice and none in another group");
  for (const std::uint32_t member : members) impl_->choose.note(member);
  if (impl_->recorder.on())
    impl_->recorder.note(Call::make_group, std::vector<BodyId>(bodies.begin(), bodies.end()));
  return group;
}

void Manager::dissolve_group(GroupId group) {
  Groups& groups = impl_->choose.groups();
  if (!groups.valid(group))
    throw InputError(fmt::format(
        "a group's id: found index {}, generation {}, expected one that make_group returned and that was not "
        "dissolved",
        group.index, group.generation));
  impl_->changes.keep_moved();
  if (groups.detached(group)) groups.bring_back(group, Groups::Return::asleep);
  for (const std::uint32_t member : groups.members(group)) impl_->choose.note(member);
  groups.dissolve(group);
  impl_->recorder.note(Call::dissolve_group, group);
}

bool Manager::valid(GroupId group) const { return impl_->choose.groups().valid(group); }

Why Manager::explain(BodyId body) const {
  const std::uint32_t index = impl_->index_of(body);
  const Levels& levels = impl_->levels;
  const Choose& choose = impl_->choose;
  const BodyLevel& level = levels.bodies.level(index);
  const LevelCandidate seen = choose.seen(index);
  Why why{.rung = level.rung,
          .rule = level.reason,
          .placed = !level.newcomer,
          .group = choose.groups().of(index)};
  if (!choose.views().empty()) {
    why.distance_m =
        std::max(0.0, std::sqrt(choose.views().squared(seen.position, Measure::distance)) - seen.radius);
    why.pixels = choose.pixels(seen);
    why.in_view = choose.in_view(seen.position, seen.radius);
  }
  const Activity does = choose.activity(index);
  if (does != Activity::asleep) {
    const RungError error = levels.errors_of(index, does)[std::size_t(level.rung)];
    why.predicted_error = error.score;
    why.predicted_error_pixels =
        error.drift * why.pixels / (why.in_view ? 1.0 : choose.policy().out_of_view_factor);
  }
  why.cost_work = work_of(level.rung, std::size_t(does));
  const PolicySettings& policy = choose.policy();
  if (!limits_of(policy) && !counts_work(policy))
    why.cost_ms = impl_->costs.ms_of_one(level.rung, std::size_t(does));
  why.dwell_left_frames = choose.dwell_left(index);
  return why;
}

std::string Manager::why(BodyId body) const { return text_of(explain(body)); }

std::string text_of(const Why& why) {
  if (!why.placed) return "at no level yet: the next step chooses one";
  const bool unseen = why.rule == Rule::far && std::isinf(why.distance_m);
  return fmt::format("{}: {}", name_of(why.rung), unseen ? "there is no viewpoint" : text_of(why.rule));
}

std::string_view text_of(Rule rule) {
  switch (rule) {
    case Rule::forced:
      return "the caller chose this level";
    case Rule::near:
      return "near a viewpoint";
    case Rule::far:
      return "far from every viewpoint";
    case Rule::within_hysteresis:
      return "only just past the limit, within the hysteresis";
    case Rule::dwell:
      return "it changed too recently to change again";
    case Rule::queued:
      return "it waits its turn: others change first";
    case Rule::over_budget:
      return "nearer bodies use up the budget";
    case Rule::in_budget:
      return "among the nearest bodies that fit the budget";
    case Rule::most_reached:
      return "as many nearer bodies as may be on a higher level are there";
    case Rule::overlap_put_off:
      return "its promotion waits until it overlaps no other body";
    case Rule::signature_pending:
      return "its signature is still being measured";
    case Rule::rung_range:
      return "the caller left it this level alone";
    case Rule::out_of_view:
      return "out of every viewpoint's picture";
    case Rule::look_ahead:
      return "about to hit a full body";
    case Rule::joined:
      return "joints hold its ODE body";
    case Rule::carries_full:
      return "it carries or pushes full bodies";
    case Rule::paused:
      return "it waits, as the budget has just sent back down who had gone up";
  }
  return "";
}

}  // namespace lodestone
