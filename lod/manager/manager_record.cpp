#include <fmt/format.h>

#include <cstring>
#include <string_view>
#include <variant>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

// The chunks of a recording, one after the other. One that is cut short, as where the program ended, is the
// end; a damaged one throws.
class Chunks {
 public:
  explicit Chunks(std::span<const std::byte> bytes) : left_(bytes) {
    if (left_.size() < kRecordingMagic.size() ||
        std::memcmp(left_.data(), kRecordingMagic.data(), kRecordingMagic.size()) != 0)
      throw_input_error("recording", "no LODEREC3 at its beginning", "what set_record() writes");
    left_ = left_.subspan(kRecordingMagic.size());
  }
  bool next() {
    ChunkHead head;
    if (left_.size() < sizeof head) return breaks_off_ = !left_.empty(), false;
    std::memcpy(&head, left_.data(), sizeof head);
    left_ = left_.subspan(sizeof head);
    if (!head.has_true_length()) throw_damage();
    if (head.length > left_.size()) return breaks_off_ = true, false;
    chunk_ = left_.first(head.length);
    left_ = left_.subspan(head.length);
    if (!head.fits(chunk_)) throw_damage();
    ++number_, place_ += sizeof head + head.length;
    return true;
  }
  StateArchive chunk() const { return {chunk_, {}}; }
  bool breaks_off() const { return breaks_off_; }  ///< known once there is no next one

 private:
  [[noreturn]] void throw_damage() const {
    throw_input_error("recording", fmt::format("damage in chunk {}, at byte {}", number_, place_),
                      "bytes of its checksum");
  }

  std::span<const std::byte> left_, chunk_;
  int number_ = 1;                              // of the chunk that is read or comes next
  std::size_t place_ = kRecordingMagic.size();  // bytes before it
  bool breaks_off_ = false;
};

template <class... T>
std::tuple<T...> read(StateArchive& chunk) {
  std::tuple<T...> values;
  std::apply([&](T&... each) { chunk(each...); }, values);
  return values;
}

// With the reader's own functions, where the recorded one had any.
PolicySettings read_policy(StateArchive& chunk, const PolicySettings& readers) {
  RecordedPolicy recorded;
  chunk(recorded);
  PolicySettings& policy = recorded.settings;
  const auto check = [](bool has, std::string_view what) {
    if (!has)
      throw_input_error("recording", fmt::format("a policy with a function for `{}`", what),
                        "one in the manager's own policy");
  };
  if (recorded.visible) check(bool(policy.visible = readers.visible), "visible");
  if (recorded.significance) check(bool(policy.significance = readers.significance), "significance");
  return policy;
}

// One that is null, or where one body's state is not as recorded.
std::optional<BodyId> find_other(const Levels& levels, const std::vector<std::uint32_t>& recorded) {
  const std::vector<std::uint32_t> now = body_hashes(levels), order = levels.bodies.in_order_of_creation();
  for (std::size_t i = 0; i < std::min(now.size(), recorded.size()); ++i)
    if (now[i] != recorded[i]) return levels.bodies.id(order[i]);
  return now.size() == recorded.size() ? std::nullopt : std::optional(BodyId{});
}

}  // namespace

void Manager::set_record(RecordFunction write) {
  std::vector<std::byte> begin = write ? snapshot() : std::vector<std::byte>();
  impl_->recorder.set(std::move(write), std::move(begin));
}

void Manager::Impl::do_call(Manager& manager, Call call, StateArchive& chunk,
                            std::span<const std::shared_ptr<const Shape>> shapes) {
  const auto with = [&]<class Result, class... T>(Result (Manager::*function)(T...)) {
    std::apply([&](auto&&... values) { (manager.*function)(values...); },
               read<std::remove_cvref_t<T>...>(chunk));
  };
  switch (call) {
    case Call::begin: {
      std::vector<std::byte> snapshot;
      chunk(snapshot);
      return manager.restore(snapshot, shapes);
    }
    case Call::add_body: {
      ShapeName name;
      BodyDefinition definition;
      chunk(name, definition.state, definition.material, definition.mass, definition.level,
            definition.importance, definition.properties, definition.user_data, definition.events,
            definition.least_rung, definition.greatest_rung);
      definition.shape = find_shape(name, shapes, levels.bodies);
      if (!definition.shape)
        throw_input_error("recording", words_of(name), "a shape that is given, or that a body here has");
      manager.add_body(definition);
      return;
    }
    case Call::add_static_mesh: {
      const auto [vertices, faces, material] =
          read<std::vector<Vec3>, std::vector<std::array<int, 3>>, MaterialId>(chunk);
      manager.add_static_mesh({vertices, faces}, material);
      return;
    }
    case Call::set_positions: {
      const auto [positions] = read<std::vector<Vec3>>(chunk);
      return manager.set_viewpoints(std::span<const Vec3>(positions));
    }
    case Call::set_viewpoints: {
      const auto [viewpoints] = read<std::vector<Viewpoint>>(chunk);
      return manager.set_viewpoints(std::span<const Viewpoint>(viewpoints));
    }
    case Call::make_group: {
      const auto [bodies] = read<std::vector<BodyId>>(chunk);
      manager.make_group(bodies);
      return;
    }
    case Call::add_plane:
      return with(&Manager::add_plane);
    case Call::add_static_box:
      return with(&Manager::add_static_box);
    case Call::set_rung_range:
      return with(&Manager::set_rung_range);
    case Call::dissolve_group:
      return with(&Manager::dissolve_group);
    case Call::move_ground:
      return with(&Manager::move_ground);
    case Call::remove_ground:
      return with(&Manager::remove_ground);
    case Call::remove_body:
      return with(&Manager::remove_body);
    case Call::set_level:
      return with(&Manager::set_level);
    case Call::set_importance:
      return with(&Manager::set_importance);
    case Call::set_state:
      return with(&Manager::set_state);
    case Call::set_user_data:
      return with(&Manager::set_user_data);
    case Call::set_body_events:
      return with(static_cast<void (Manager::*)(BodyId, bool)>(&Manager::set_events));
    case Call::set_properties:
      return with(&Manager::set_properties);
    case Call::add_force:
      return with(&Manager::add_force);
    case Call::add_impulse:
      return with(&Manager::add_impulse);
    case Call::sleep:
      return with(&Manager::sleep);
    case Call::wake:
      return with(&Manager::wake);
    case Call::set_gravity:
      return with(&Manager::set_gravity);
    case Call::set_full_substeps:
      return with(&Manager::set_full_substeps);
    case Call::set_policy:
      return manager.set_policy(read_policy(chunk, choose.policy()));
    case Call::step:
    case Call::callers_step:
      break;
  }
}

ReplayResult Manager::replay(std::span<const std::byte> recording,
                             std::span<const std::shared_ptr<const Shape>> shapes) {
  ReplayResult result;
  bool begun = false;
  Chunks chunks(recording);
  while (chunks.next()) {
    StateArchive chunk = chunks.chunk();
    Call call = Call::begin;
    chunk(call);
    if (call > kLastCall || (!begun && call != Call::begin))
      throw_input_error("recording", fmt::format("call {}", int(call)),
                        begun ? fmt::format("0 … {}", int(kLastCall)) : "a snapshot at its beginning");
    begun = true;
    if (call != Call::step && call != Call::callers_step) {
      impl_->do_call(*this, call, chunk, shapes);
      continue;
    }
    const auto [dt, recorded] = read<double, std::vector<std::uint32_t>>(chunk);
    if (call == Call::step) {
      step(dt);
    } else {
      before_world_step(dt);
      callers::step(impl_->callers_world, dt);
      after_world_step();
    }
    ++result.steps;
    const std::optional<BodyId> other = find_other(impl_->levels, recorded);
    if (!other) continue;
    result.same = false, result.body = *other;
    result.text = *other ? fmt::format("step {} of the recording: body {} ({}) is not as it was recorded",
                                       result.steps, other->index, shape(*other).name)
                         : fmt::format("step {} of the recording: there are {} bodies, not {}", result.steps,
                                       bodies(), recorded.size());
    return result;
  }
  if (!begun) throw_input_error("recording", "no beginning", "the snapshot that it begins with");
  result.text = result.steps == 0 ? "no step is recorded"
                                  : fmt::format("all {} steps are as they were recorded", result.steps);
  if (chunks.breaks_off()) result.text += "; the recording breaks off after that";
  return result;
}

}  // namespace lodestone
