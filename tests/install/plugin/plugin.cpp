// A game's module that has Lodestone in it: a static library, too, must be position-independent for this to
// link.
#include <lodestone/lodestone.h>

extern "C" double height_after_a_fall(double seconds) {
  using namespace lodestone;
  Manager manager;
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  const BodyId body =
      manager.add_body({.shape = crate, .state = {.position = {0, 0, 10}}, .level = LevelChoice::full});
  for (double time = 0.0; time < seconds; time += 1.0 / 64.0) manager.step(1.0 / 64.0);
  return manager.state(body).position.z();
}
