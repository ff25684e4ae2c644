// One include for all of the engine, with the version that it was compiled against.
#include <lodestone/lodestone.h>

#include <string>

#include "check.h"

static_assert(LODESTONE_VERSION ==
              LODESTONE_VERSION_MAJOR * 10000 + LODESTONE_VERSION_MINOR * 100 + LODESTONE_VERSION_PATCH);

int main() {
  using namespace lodestone;
  const std::string version = std::to_string(LODESTONE_VERSION_MAJOR) + "." +
                              std::to_string(LODESTONE_VERSION_MINOR) + "." +
                              std::to_string(LODESTONE_VERSION_PATCH);
  check::that(version == LODESTONE_VERSION_STRING, "the version's string has its numbers");

  Manager manager({.policy = {.policy = DistancePolicy{}}});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  const BodyId body =
      manager.add_body({.shape = crate, .state = {.position = {0, 0, 1}}, .level = LevelChoice::full});
  for (int i = 0; i < 120; ++i) manager.step(1.0 / 60.0);
  check::within(manager.state(body).position.z(), 0.09, 0.21, "a full crate's height after two seconds, m");

  bool threw = false;
  try {
    make_box({0.0, 1.0, 1.0});
  } catch (const InputError&) {
    threw = true;
  }
  check::that(threw, "an InputError of the library is caught outside of it");
  return check::result();
}
