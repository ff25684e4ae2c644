// What a program sees of a Manager through its hooks: lines of a log, zones of a profiler, lines and points
// to draw.
#include <lodestone/lodestone.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "check.h"

using namespace lodestone;

namespace {

bool same(DebugColor a, DebugColor b) { return a.red == b.red && a.green == b.green && a.blue == b.blue; }

void check_zones(Manager& manager) {
  std::vector<std::string> open;
  std::map<std::string, int> entered;
  bool nested = true;
  manager.set_profile(
      {.begin = [&](std::string_view zone) { open.emplace_back(zone), ++entered[std::string(zone)]; },
       .end =
           [&](std::string_view zone) {
             nested = nested && !open.empty() && open.back() == zone;
             open.pop_back();
           }});
  manager.step(1.0 / 60.0);
  manager.set_profile({});
  check::that(nested && open.empty(), "every zone ends, within those around it");
  check::within(entered["step"], 1, 1, "zones of the whole step");
  for (const char* zone :
       {"choose", "transfer", "flight", "broad_phase", "pairs", "crowd", "rest", "cross_level", "full"})
    check::that(entered[zone] > 0, (std::string("zone ") + zone).c_str());
  const std::size_t zones = entered.size();
  check::within(double(zones), 10, 10, "kinds of zones");
  manager.step(1.0 / 60.0);
  check::within(entered["step"], 1, 1, "zones once nobody listens");
}

void check_drawing(const Manager& manager, const std::vector<BodyId>& bodies) {
  const DrawSettings settings;
  std::map<Rung, int> lines;
  int contact_lines = 0, others = 0, points = 0;
  double farthest = 0.0;
  const auto count = [&](const Vec3& from, const Vec3& to, DebugColor color) {
    double nearest = 1e9;
    for (const BodyId body : bodies)
      nearest = std::min({nearest, (manager.state(body).position - from).norm(),
                          (manager.state(body).position - to).norm()});
    farthest = std::max(farthest, nearest);
    const auto rung = std::ranges::find_if(settings.colors, [&](DebugColor c) {
      return same(c, color) || same({0.5f * c.red, 0.5f * c.green, 0.5f * c.blue}, color);
    });
    if (rung != settings.colors.end())
      ++lines[Rung(rung - settings.colors.begin())];
    else
      ++(same(color, settings.contact_color) ? contact_lines : others);
  };
  manager.draw({.line = count, .point = [&](const Vec3&, DebugColor) { ++points; }});
  std::map<Rung, int>
      expected;  // 18 edges of a box's triangulated hull, three circles of a sphere in 16 parts
  for (const BodyId body : bodies)
    expected[manager.rung(body)] += manager.rung(body) == Rung::tables ? 48 : 18;
  check::that(lines == expected, "the lines of each rung");
  check::that(lines.size() == 3, "all three rungs are drawn");
  check::within(others, 0, 0, "lines of no rung and no contact");
  check::within(contact_lines, 4, 1e9, "lines at contacts");
  check::within(points, double(bodies.size()) + contact_lines, double(bodies.size()) + contact_lines,
                "points");
  check::within(farthest, 0.05, 0.4, "a line's distance from the nearest body, m");
}

}  // namespace

int main() {
  std::vector<std::pair<LogLevel, std::string>> log;
  Manager manager({.policy = {.policy = DistancePolicy{.full_within = 1.5, .support_within = 4.0},
                              .max_transitions_per_frame = 20},
                   .signature_timing = SignatureTiming::in_step});
  manager.set_log([&](LogLevel level, std::string_view text) { log.emplace_back(level, text); });
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 60; ++i)
    bodies.push_back(
        manager.add_body({.shape = crate,
                          .state = {.position = Vec3(0.45 * (i / 3), 0.0, 0.15 + 0.301 * (i % 3)),
                                    .orientation = Quat(0.5, 0.5, 0.5, 0.5)}}));
  const Vec3 camera(0.0, 0.0, 0.5);
  manager.set_viewpoints({&camera, 1});
  for (int i = 0; i < 10; ++i) manager.step(1.0 / 60.0);
  check_zones(manager);
  check_drawing(manager, bodies);

  const auto said = [&](LogLevel level, const char* text) {
    return std::ranges::any_of(log, [&](const auto& line) {
      return line.first == level && line.second.find(text) != std::string::npos;
    });
  };
  check::that(said(LogLevel::info, "the signature of crate is there"), "the log has the signature");
  // Two crates in one place: the statistical one must wait.
  const Vec3 far(100.0, 0.0, 0.0);
  manager.add_body({.shape = crate, .state = {.position = far}, .level = LevelChoice::full});
  const BodyId second =
      manager.add_body({.shape = crate, .state = {.position = far}, .level = LevelChoice::support});
  manager.step(1e-3);
  manager.set_level(second, LevelChoice::full);
  manager.step(1e-3);
  check::that(said(LogLevel::info, "promotions put off"), "the log has promotions that were put off");

  Manager without(
      {.signatures = [](const Shape& shape, const ContactLaw&) -> std::shared_ptr<const Signature> {
        throw InputError("none for " + shape.name);
      }});
  std::string error;
  without.set_log([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::error) error = text;
  });
  without.add_body({.shape = crate, .level = LevelChoice::support});
  bool threw = false;
  try {
    without.step(1.0 / 60.0);
  } catch (const InputError&) {
    threw = true;
  }
  check::that(threw && error == "the signature of crate cannot be had: none for crate",
              "a signature that cannot be had is logged, then thrown");
  return check::result();
}
