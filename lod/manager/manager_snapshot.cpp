// A manager as bytes, and back to the bit. First a header that says for whom it is, so that nothing is
// changed by what does not fit; then the shapes by name; then what each owner of state archives.
#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <cstring>
#include <string_view>

#include "lod/manager/manager_impl.h"
#include "lod/support/clip_player.h"
#include "lod/version.h"
#include "reference/error.h"
#include "reference/state_archive.h"

namespace lodestone {
namespace {

constexpr double kAnyStep = 1.0 / 60.0;  // s; the next step sees anew what moves

using Shapes = std::vector<std::shared_ptr<const Shape>>;

// What a reader must have alike.
struct Circumstances {
  std::uint64_t seed = 0, materials = 0, planes = 0, parts = 0, gravity = 0;
  std::uint32_t sleeping = 0, callers_world = 0;
};

struct Header {
  std::array<char, 8> magic = {'L', 'O', 'D', 'E', 'S', 'N', 'A', 'P'};
  std::uint32_t format = 25, version = LODESTONE_VERSION;
  // Sizes of what goes as it lies in memory: a build with other ones is no reader.
  std::array<std::uint16_t, 8> layout = {sizeof(void*),           sizeof(BodyRecord),   sizeof(BodyLevel),
                                         sizeof(StatisticalBody), sizeof(ClipPlayback), sizeof(StepReport),
                                         sizeof(StepCounts),      sizeof(OdeContact)};
  Circumstances circumstances;
  std::uint64_t shapes = 0, bytes = 0, checksum = 0;  // how many; how long the state is; of shapes and state
};

template <class T>
std::uint64_t mix(std::uint64_t hash, const T& value) {
  return XXH64(&value, sizeof value, hash);
}

Circumstances circumstances_of(const Levels& levels, bool callers_world) {
  Circumstances found{.seed = levels.statistical_settings.seed,
                      .sleeping = levels.statistical_settings.sleeping,
                      .callers_world = callers_world};
  const MaterialTable& materials = levels.materials;
  for (MaterialId i = 0; i < materials.size(); ++i)
    for (MaterialId j = 0; j < materials.size(); ++j)
      found.materials =
          mix(mix(found.materials, materials.law(i, j).restitution), materials.law(i, j).friction);
  if (callers_world) {  // his ground is his, and his gravity, which is not ours to set
    for (const double part : levels.statistical_settings.gravity) found.gravity = mix(found.gravity, part);
    return found;
  }
  found.parts = levels.ground.parts();
  for (const HalfSpace& plane : levels.ground.planes()) {
    for (const double part :
         {plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset, double(plane.material)})
      found.planes = mix(found.planes, part);
  }
  return found;
}

void check_alike(const Circumstances& written, const Circumstances& here) {
  const auto check = [](bool alike, std::string_view found, std::string_view expected) {
    if (!alike)
      throw_input_error("snapshot", fmt::format("one of a manager with {}", found),
                        fmt::format("one with {}", expected));
  };
  const auto world = [](bool callers) { return callers ? "a world of the caller's" : "a world of its own"; };
  const auto sleep = [](bool sleeping) { return sleeping ? "sleeping" : "no sleeping"; };
  check(written.callers_world == here.callers_world, world(written.callers_world), world(here.callers_world));
  check(written.seed == here.seed, fmt::format("seed {}", written.seed), fmt::format("seed {}", here.seed));
  check(written.sleeping == here.sleeping, sleep(written.sleeping), sleep(here.sleeping));
  check(written.gravity == here.gravity, "another gravity", "the gravity here");
  check(written.materials == here.materials, "other materials", "the materials here");
  check(written.planes == here.planes, "other planes", "the planes here");
  check(written.parts == here.parts, fmt::format("{} static boxes and meshes", written.parts),
        fmt::format("the {} here", here.parts));
}

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

Header read_header(std::span<const std::byte> bytes) {
  Header header;
  const Header expected;
  if (bytes.size() < sizeof header)
    throw_input_error("snapshot", fmt::format("{} bytes", bytes.size()),
                      fmt::format("at least the {} of its header", sizeof header));
  std::memcpy(static_cast<void*>(&header), bytes.data(), sizeof header);
  if (header.magic != expected.magic)
    throw_input_error("snapshot", "no LODESNAP at its beginning", "what snapshot() returns");
  if (header.format != expected.format || header.version != expected.version ||
      header.layout != expected.layout)
    throw_input_error(
        "snapshot",
        fmt::format("one of another build of Lodestone (format {}, version {})", header.format,
                    header.version),
        fmt::format("one of this build (format {}, version {})", expected.format, expected.version));
  const std::size_t left = bytes.size() - sizeof header;
  if (header.shapes > left / sizeof(ShapeName) || header.bytes != left - header.shapes * sizeof(ShapeName))
    throw_input_error("snapshot", fmt::format("{} bytes", bytes.size()), "as many as its header says");
  if (header.checksum != checksum(bytes.subspan(sizeof header)))
    throw_input_error("snapshot", "another checksum than its header has", "undamaged bytes");
  return header;
}

// Those named at the beginning of `bytes`, among the shapes given and those of bodies here.
Shapes find_shapes(std::span<const std::byte> bytes, std::size_t count,
                   std::span<const std::shared_ptr<const Shape>> given, const BodyTable& bodies) {
  Shapes found;
  for (std::size_t i = 0; i < count; ++i) {
    ShapeName name;
    std::memcpy(&name, bytes.data() + i * sizeof name, sizeof name);
    found.push_back(find_shape(name, given, bodies));
    if (!found.back())
      throw_input_error("snapshot", words_of(name), "a shape that is given, or that a body here has");
  }
  return found;
}

// What the statistical bodies move by, found under the laws under which it was before.
std::vector<std::shared_ptr<const Signature>> archive_signatures(StateArchive& a, Levels& levels) {
  struct Asked {
    std::shared_ptr<const Shape> shape;
    ContactLaw law;
    bool tables = false;
    void archive(StateArchive& b) { b(shape, law, tables); }
  };
  std::vector<Asked> asked;
  std::vector<std::shared_ptr<const Signature>> found;
  if (!a.reading() && levels.statistical)
    for (const KindSignature& kind : levels.statistical->signatures()) {
      asked.push_back({kind.shape, levels.signatures.law_of(*kind.signature), kind.tables});
      found.push_back(kind.signature);
    }
  a(asked);
  if (!a.reading()) return found;
  for (const Asked& one : asked) {
    found.push_back(levels.signatures.find(*one.shape, one.law));
    if (found.back() && !(one.tables && found.back()->collision_heights.mean.empty())) continue;
    throw InputError(fmt::format(
        "snapshot: the signature of shape {} (restitution {}, friction {}), by which bodies move: found {}, "
        "expected one{}",
        one.shape->name, one.law.restitution, one.law.friction,
        found.back() ? "one without collision heights" : "none here",
        one.tables ? " with collision heights, which tables needs" : ""));
  }
  return found;
}

void append(std::vector<std::byte>& bytes, const void* from, std::size_t count) {
  const std::size_t before = bytes.size();
  bytes.resize(before + count);
  if (count > 0) std::memcpy(bytes.data() + before, from, count);
}

}  // namespace

// The full level first: it refuses what does not fit before anything has changed.
void Manager::Impl::archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures) {
  a(levels.full);
  Vec3 gravity = levels.statistical_settings.gravity;
  a(gravity);
  if (a.reading() && !callers_world) levels.use_gravity(gravity);
  a(levels.ground);
  const SpaceMirror* const mirror = levels.full.world() ? levels.full.world()->callers_space() : nullptr;
  if (mirror) levels.callers.ground.archive(a, *mirror);
  levels.callers.bodies.archive(a, mirror);
  a(levels.bodies, levels.now, levels.woken, levels.eased, levels.put_off, report, costs, choose, step_levels,
    changes, left_places, events);
  if (a.reading()) queries.forget_all(), levels.forget_places(), audit.forget_watched();
  bool has_statistical = levels.statistical != nullptr;
  a(has_statistical);
  if (!has_statistical && a.reading()) levels.statistical.reset();
  if (!has_statistical) return;
  if (!levels.statistical)
    levels.statistical =
        std::make_unique<StatisticalLevel>(levels.statistical_settings, levels.ground, levels.materials);
  levels.statistical->archive(a, signatures);
}

std::vector<std::byte> Manager::snapshot() const {
  if (impl_->waits_for_world_step)
    throw_input_error("snapshot", "one between before_world_step and after_world_step", "none");
  // To write in room that grows takes long. A body of a heap takes more, one that sleeps less.
  constexpr std::size_t kOfOneBody = 1024;
  StateArchive state(
      std::max(impl_->last_snapshot + impl_->last_snapshot / 8, kOfOneBody * impl_->levels.bodies.indices()));
  const auto held = impl_->queries.hold_ground();
  const auto signatures = archive_signatures(state, impl_->levels);
  impl_->choose.groups().archive_detached(state);
  impl_->archive(state, signatures);  // which changes nothing where it writes
  impl_->last_snapshot = state.bytes().size();
  Header header;
  std::vector<std::byte> bytes;
  bytes.reserve(sizeof header + state.shapes().size() * sizeof(ShapeName) + state.bytes().size());
  append(bytes, &header, sizeof header);
  for (const std::shared_ptr<const Shape>& shape : state.shapes()) {
    const ShapeName name = name_of(*shape);
    append(bytes, &name, sizeof name);
  }
  append(bytes, state.bytes().data(), state.bytes().size());
  header.circumstances = circumstances_of(impl_->levels, impl_->callers_world != nullptr);
  header.shapes = state.shapes().size(), header.bytes = state.bytes().size(),
  header.checksum = checksum(std::span(bytes).subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

void Manager::restore(std::span<const std::byte> snapshot,
                      std::span<const std::shared_ptr<const Shape>> shapes) {
  Levels& levels = impl_->levels;
  if (impl_->waits_for_world_step)
    throw_input_error("restore", "one between before_world_step and after_world_step", "none");
  const Header header = read_header(snapshot);
  impl_->follow_gravity();
  check_alike(header.circumstances, circumstances_of(levels, impl_->callers_world != nullptr));
  const std::span<const std::byte> body = snapshot.subspan(sizeof header);
  StateArchive state(body.subspan(header.shapes * sizeof(ShapeName)),
                     find_shapes(body, header.shapes, shapes, levels.bodies));
  const auto signatures = archive_signatures(state, levels);
  impl_->choose.groups().archive_detached(state);
  // Contacts are remembered with the parts of his ground; twice, so that what was put back stands there.
  for (int i = 0; i < 2; ++i) levels.follow_callers_space(kAnyStep, kAnyStep);
  levels.look_away();
  impl_->archive(state, signatures);
  check_that(state.at_end(), "a snapshot is read to its end");
  impl_->choose.groups().join_restored();
  if (impl_->recorder.on())
    impl_->recorder.note(Call::begin, std::vector<std::byte>(snapshot.begin(), snapshot.end()));
}

}  // namespace lodestone
