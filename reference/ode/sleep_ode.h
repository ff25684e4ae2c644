// When this world's bodies fall asleep: ODE's own law (dInternalHandleAutoDisabling), before each step of
// ODE's, in our hands, so that it can be saved and set, and so that what a moving surface carries, or a body
// that moves draws along, stays awake: ODE would stop a body at rest in each step that friction moves it by
// less than the threshold.
#pragma once

#include <unordered_set>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/joints_ode.h"

namespace lodestone::ode {

class Sleep {
 public:
  explicit Sleep(const OdeSettings& settings) : law_(settings.sleep), on_(settings.auto_disable) {}

  void set_law(const SleepLaw& law) { law_ = law; }
  const SleepLaw& law() const { return law_; }

  /// For the next step, of `h` s, with these contacts. Bodies on surfaces that move, those on joints to
  /// kinematic bodies that move, and what hangs together with these by joints, those of contacts too, stay
  /// awake.
  void run(Bodies& bodies, const ContactJoints& joints, double h);

 private:
  void find_carried(Bodies& bodies, const ContactJoints& joints);
  void find_group(dBodyID body, const ContactGraph& contacts);
  bool is_still(const Body& body) const;
  bool is_dragged(Body& body, const ContactGraph& contacts, double h) const;
  bool is_drawn(Bodies& bodies, const Body& body, const ContactGraph& contacts) const;
  void find_pulled(Bodies& bodies, const ContactGraph& contacts);

  SleepLaw law_;
  bool on_;
  Vec3 gravity_ = Vec3::Zero();  // m/s², in the last run
  std::unordered_set<dBodyID> carried_, grouped_, pulled_, unpulled_;
  std::vector<dBodyID> waiting_, joined_;
};

}  // namespace lodestone::ode
