#include "tools/scene_signatures.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "signature/signature_source.h"
#include "tools/interrupt.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

using SignatureKey = std::tuple<std::uint64_t, double, double>;  // shape, restitution, friction
using Memory = std::map<SignatureKey, std::shared_ptr<const Signature>>;

bool stays_full(const BodyDefinition& body, const RunSettings& settings) {
  const LevelChoice level = settings.level == LevelChoice::automatic ? body.level : settings.level;
  return level == LevelChoice::full || (level == LevelChoice::automatic && body.least_rung == Rung::full);
}

// Of what a signature is measured on: the first plane, as the manager has it.
MaterialId ground_material(const Scene& scene) {
  for (const SceneGround& ground : scene.ground)
    if (const auto* plane = std::get_if<GroundPlane>(&ground)) return plane->material;
  return 0;
}

}  // namespace

SignatureFunction make_signature_function(ProgressLine& line, bool use_cache) {
  return [&line, use_cache, memory = std::make_shared<Memory>()](const Shape& shape, const ContactLaw& law) {
    auto& known = (*memory)[{shape.content_hash, law.restitution, law.friction}];
    if (known) return known;
    SignatureSourceSettings source;
    source.use_cache = use_cache;
    source.warn = warn;
    source.progress = [&](const std::string& stage, double fraction) {
      line.show(fmt::format("signature of {}: {}", shape.name, stage), fraction);
      throw_if_interrupted();
    };
    return known = find_or_measure_signature(shape, law, source).signature;
  };
}

void fetch_signatures(const Scene& scene, const RunSettings& settings) {
  if (!settings.signatures) return;  // the manager finds its own, in the background
  const MaterialId ground = ground_material(scene);
  std::set<std::pair<std::uint64_t, MaterialId>> seen;
  for (const SceneBody& body : scene.bodies) {
    const BodyDefinition& definition = body.definition;
    if (stays_full(definition, settings)) continue;
    if (seen.emplace(definition.shape->content_hash, definition.material).second)
      settings.signatures(*definition.shape, scene.materials.law(definition.material, ground));
  }
}

}  // namespace lodestone
