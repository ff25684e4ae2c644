// Sequences of calls on a manager, and the same ones on another with two threads. After each step every state
// is sound, both have the same hash, no energy came from nowhere, and without ground and gravity momentum is
// kept.
#include <numeric>
#include <vector>

#include "lod/manager.h"
#include "reference/error.h"
#include "reference/free_rotation.h"
#include "tests/fuzz/fuzz_input.h"

namespace lodestone {
namespace {

using fuzz::FuzzInput;
using fuzz::require;

constexpr double kFloor = -0.5;  // m, under which nothing of a body is to get by its middle
constexpr int kMostBodies = 12, kMostCalls = 60;

std::shared_ptr<const Shape> shape(int which) {
  static const std::shared_ptr<const Shape> shapes[] = {
      std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4}))),
      std::make_shared<const Shape>(make_sphere_shape(0.15)),
      std::make_shared<const Shape>(make_shape("l", make_l(0.4, 0.3, 0.1, 0.1))),
      std::make_shared<const Shape>(make_shape("cube", make_box({0.25, 0.25, 0.25})))};
  return shapes[which % 4];
}

double kinetic(const Manager& manager, BodyId body) {
  return manager.mass(body) * kinetic_energy(manager.shape(body), manager.state(body));
}

class Sequence {
 public:
  explicit Sequence(FuzzInput& input) : input_(input), in_space_(input.choice(4) == 0) {
    for (const int threads : {1, 2}) {
      ManagerSettings settings{.threads = threads,
                               .sleeping = !in_space_,
                               .signatures = [](const Shape&, const ContactLaw&) { return nullptr; }};
      if (in_space_) settings.gravity.setZero();
      settings.model = StatisticalModel::support;
      both_.emplace_back(settings);
      if (!in_space_) both_.back().add_plane(Vec3::UnitZ(), 0.0);
    }
  }

  void run() {
    for (int i = 0; i < kMostCalls && !input_.ended(); ++i) call();
    for (int i = 0; i < 5; ++i) step(1.0 / 60.0);
  }

 private:
  void call() {
    const int what = input_.choice(16);
    if (what < 6) return step(input_.real(0.001, 0.05));
    if (what < 9 || bodies_.empty()) return add();
    const BodyId body = bodies_[std::size_t(input_.choice(int(bodies_.size())))];
    const auto both = [&](const auto& change) {
      for (Manager& manager : both_) change(manager);
    };
    switch (what) {
      case 9: {
        const auto choice = LevelChoice(input_.choice(4));  // tables need a signature
        return both([&](Manager& m) { m.set_level(body, choice); });
      }
      case 10: {
        const Vec3 force(input_.real(-50, 50), input_.real(-50, 50), input_.real(-50, 50)),
            torque(input_.real(-1, 1), input_.real(-1, 1), input_.real(-1, 1));
        both([&](Manager& m) { m.add_force(body, force, torque); });
        forces_.push_back({body, force, torque});
        return;
      }
      case 11: {
        const double before = energy();
        const Vec3 momentum_before = momentum(),
                   impulse(input_.real(-5, 5), input_.real(-5, 5), input_.real(-5, 5));
        both([&](Manager& m) { m.add_impulse(body, impulse, m.state(body).position + Vec3(0.05, 0, 0)); });
        allow(energy() - before);
        momentum_ += momentum() - momentum_before;
        return;
      }
      case 12:
        if (!in_space_) both([&](Manager& m) { m.sleep(body); });  // stops it: momentum is not kept
        return;
      case 13:
        return both([&](Manager& m) { m.wake(body); });
      case 14:
        return remove(body);
      default:
        return break_a_rule(body);
    }
  }

  void add() {
    if (bodies_.size() >= std::size_t(kMostBodies)) return;
    BodyDefinition definition{.shape = shape(input_.choice(4)), .level = LevelChoice(input_.choice(4))};
    definition.state.position = {input_.real(-1, 1), input_.real(-1, 1), input_.real(0.3, 3)};
    definition.state.orientation =
        rotation_from_vector({input_.real(-3, 3), input_.real(-3, 3), input_.real(-3, 3)});
    definition.state.velocity = {input_.real(-5, 5), input_.real(-5, 5), input_.real(-5, 5)};
    definition.state.angular_velocity = {input_.real(-20, 20), input_.real(-20, 20), input_.real(-20, 20)};
    definition.mass = input_.real(0.5, 20);
    const double before = energy();
    const BodyId body = both_[0].add_body(definition);
    require(both_[1].add_body(definition) == body, "two managers that name a body differently");
    bodies_.push_back(body);
    allow(energy() - before);
    // Bodies made in each other push themselves apart: at 1 m/s at most, and up to their size against gravity
    // (see the full level's recovery of overlap).
    allow(std::accumulate(bodies_.begin(), bodies_.end(), 0.0, [&](double sum, BodyId b) {
      return sum + both_[0].mass(b) * (2.0 + 9.81 * both_[0].shape(b).size);
    }));
    momentum_ += *definition.mass * definition.state.velocity;
  }

  void remove(BodyId body) {
    momentum_ -= both_[0].mass(body) * both_[0].state(body).velocity;
    for (Manager& manager : both_) manager.remove_body(body);
    std::erase(bodies_, body);
    std::erase_if(forces_, [&](const Push& push) { return push.body == body; });
    for (Manager& manager : both_) require(!manager.valid(body), "an id that outlives its body");
  }

  /// What the contract refuses changes nothing.
  void break_a_rule(BodyId body) {
    const std::uint64_t before = both_[0].state_hash();
    RigidState state = both_[0].state(body);
    const int which = input_.choice(5);
    const double bad = input_.choice(2) == 0 ? std::numeric_limits<double>::quiet_NaN()
                                             : std::numeric_limits<double>::infinity();
    bool refused = false;
    try {
      if (which == 0) state.position.x() = bad, both_[0].set_state(body, state);
      if (which == 1) both_[0].add_force(body, Vec3(0, bad, 0));
      if (which == 2) both_[0].step(-bad);
      if (which == 3) both_[0].set_importance(body, -1.0);
      if (which == 4) both_[0].set_state(BodyId{body.index, body.generation + 7}, state);
    } catch (const InputError&) {
      refused = true;
    }
    require(refused, "a bad call taken");
    require(both_[0].state_hash() == before, "a bad call that changed something");
  }

  void step(double dt) {
    double work = 0.0;
    for (const auto& [body, force, torque] : forces_) {
      // ∫ F·v ≤ |F| (|v| + |F| dt / m) dt, and the same of torques; v may grow in the step by what the others
      // give: twice that.
      const RigidState s = both_[0].state(body);
      const double mass = both_[0].mass(body),
                   inertia = mass * 1.0 / both_[0].shape(body).inverse_inertia_per_mass.norm();
      work += 2.0 * dt *
              (force.norm() * (s.velocity.norm() + 9.81 * dt + 2.0 * force.norm() * dt / mass) +
               torque.norm() * (s.angular_velocity.norm() + 2.0 * torque.norm() * dt / inertia));
      momentum_ += dt * force;
    }
    allow(work + 1e-3 * std::max(0.0, allowed_));  // what steps may add by their length
    forces_.clear();
    for (Manager& manager : both_) manager.step(dt);
    check();
  }

  void check() {
    require(both_[0].state_hash() == both_[1].state_hash(), "another hash on two threads");
    for (const BodyId body : bodies_) {
      const RigidState s = both_[0].state(body);
      require(s.position.allFinite() && s.velocity.allFinite() && s.angular_velocity.allFinite(),
              "a state that is not finite");
      require(std::abs(s.orientation.norm() - 1.0) < 1e-6, "an orientation that is no rotation");
      require(in_space_ || s.position.z() > kFloor, "a body under the floor");
    }
    require(both_[0].report().counters.states_recovered == 0, "a state that had to be recovered");
    require(energy() <= allowed_ + 1e-6,
            "energy out of nothing: " + std::to_string(energy()) + " J of " + std::to_string(allowed_));
    double scale = 1.0;
    for (const BodyId body : bodies_) scale += both_[0].mass(body) * both_[0].state(body).velocity.norm();
    if (in_space_) require((momentum() - momentum_).norm() < 1e-6 * scale, "momentum that is not kept");
  }

  /// Kinetic and potential (over the floor), J.
  double energy() const {
    double sum = 0.0;
    for (const BodyId body : bodies_)
      sum += kinetic(both_[0], body) +
             (in_space_ ? 0.0 : both_[0].mass(body) * 9.81 * (both_[0].state(body).position.z() - kFloor));
    return sum;
  }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const BodyId body : bodies_) sum += both_[0].mass(body) * both_[0].state(body).velocity;
    return sum;
  }
  void allow(double joule) { allowed_ += joule; }

  struct Push {
    BodyId body;
    Vec3 force, torque;
  };

  FuzzInput& input_;
  const bool in_space_;
  std::vector<Manager> both_;
  std::vector<BodyId> bodies_;
  std::vector<Push> forces_;
  double allowed_ =
      0.0;  // J, energy that the world may have; a body that is removed leaves its share to the others
  Vec3 momentum_ = Vec3::Zero();
};

}  // namespace
}  // namespace lodestone

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lodestone::fuzz::FuzzInput input(data, size);
  lodestone::Sequence(input).run();
  return 0;
}
