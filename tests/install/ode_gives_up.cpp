// What a caller does where one of ODE's own assertions fails in a step, here over a mass that the caller set
// himself: it is told which body that is most likely about, and reads where the others are.
#include <ode/ode.h>

#include <optional>
#include <vector>

#include "check.h"
#include "crate.h"

using namespace lodestone;

int main() {
  Manager manager({.signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 4; ++i)
    bodies.push_back(manager.add_body(
        {.shape = crate, .state = at(0.03 * i, 0.14 + 0.28 * i), .level = LevelChoice::full}));
  manager.step(kFrame);
  dMass light;
  dMassSetBoxTotal(&light, 1e-30, 0.3, 0.3, 0.3);
  dBodySetMass(manager.ode_body(bodies[2]), &light);

  std::optional<std::uint32_t> body;
  bool gave_up = false;
  try {
    for (int i = 0; i < 300; ++i) manager.step(kFrame);
  } catch (const SimulationError& error) {
    std::printf("%s\n", error.what());
    gave_up = true, body = error.body();
  }
  check::that(gave_up, "a step of what ODE cannot go on with throws SimulationError");
  check::that(body == bodies[2].index, "which names the body by its index");
  check::within(manager.state(bodies[0]).position.x(), -1.0, 1.0, "m, where another is");
  return check::result();
}
