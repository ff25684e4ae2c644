#include "tools/hard_cases/statistical_case_parts.h"

#include "reference/hull/hull_overlap.h"
#include "signature/signature_source.h"
#include "tools/terminal.h"

namespace lodestone {

std::shared_ptr<const Signature> find_case_signature(const Shape& shape, const ContactLaw& law) {
  SignatureSourceSettings source;
  if (shape.sphere_radius)
    source.measuring.settling_trials = 1, source.measuring.clips = 0;  // a ball rolls for ever
  source.warn = warn;
  return find_or_measure_signature(shape, law, source).signature;
}

Manager make_case_manager(const StatisticalCase& settings) {
  Manager manager({.gravity = settings.gravity,
                   .seed = settings.seed,
                   .threads = settings.threads,
                   .model = settings.model,
                   .tables = {.published = settings.published},
                   .signatures = [signature = settings.signature](const Shape&, const ContactLaw&) {
                     return signature;
                   }});
  manager.materials().replace(0,
                              {.restitution = settings.law.restitution, .friction = settings.law.friction});
  for (const Vec3& normal : settings.plane_normals) manager.add_plane(normal, 0.0);
  return manager;
}

BodyId add_case_body(Manager& manager, const std::shared_ptr<const Shape>& shape, const RigidState& state) {
  return manager.add_body({.shape = shape, .state = state, .level = LevelChoice::statistical});
}

double resting_height(const Shape& shape, const Quat& orientation, const Vec3& normal) {
  return measure_plane_overlap(shape, {.orientation = orientation}, normal, 0.0);
}

}  // namespace lodestone
