#include "tools/scene_signatures.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "signature/signature_source.h"

namespace lodestone {
namespace {

using SignatureKey = std::tuple<std::uint64_t, double, double>;  // shape, restitution, friction
using Memory = std::map<SignatureKey, std::shared_ptr<const Signature>>;

std::shared_ptr<const Signature> find_or_measure(const Shape& shape, const ContactLaw& law, ProgressLine& line) {
  SignatureSourceSettings source;
  source.progress = [&](const std::string& stage, double fraction) {
    line.show(fmt::format("signature of {}: {}", shape.name, stage), fraction);
  };
  return find_or_measure_signature(shape, law, source).signature;
}

bool stays_full(const BodyDefinition& body, const RunSettings& settings) {
  const LevelChoice level = settings.level == LevelChoice::automatic ? body.level : settings.level;
  return level == LevelChoice::full;
}

// The first plane only: what a signature is measured for.
void add_first_plane(Manager& manager, const Scene& scene) {
  for (const SceneGround& ground : scene.ground)
    if (const auto* plane = std::get_if<GroundPlane>(&ground)) {
      manager.add_plane(plane->normal, plane->offset_m, plane->material);
      return;
    }
}

}  // namespace

SignatureFunction make_signature_function(ProgressLine& line) {
  return [&line, memory = std::make_shared<Memory>()](const Shape& shape, const ContactLaw& law) {
    auto& known = (*memory)[{shape.content_hash, law.restitution, law.friction}];
    if (!known) known = find_or_measure(shape, law, line);
    return known;
  };
}

void fetch_signatures(const Scene& scene, const RunSettings& settings) {
  std::set<std::pair<std::uint64_t, MaterialId>> seen;
  for (const SceneBody& body : scene.bodies) {
    if (stays_full(body.definition, settings)) continue;
    if (!seen.emplace(body.definition.shape->content_hash, body.definition.material).second) continue;
    ManagerSettings alone;
    alone.signatures = settings.signatures;
    alone.model = settings.model ? settings.model : scene.model;
    Manager manager(alone);
    manager.materials() = scene.materials;
    add_first_plane(manager, scene);
    BodyDefinition definition = body.definition;
    definition.level = LevelChoice::statistical;
    manager.add_body(definition);
    manager.step(1e-3);
  }
}

}  // namespace lodestone
