// From C's values to ours and back, and how a function of the C interface fails.
#pragma once

#include <new>
#include <string>
#include <vector>

#include "lod/lodestone_c.h"
#include "lod/manager.h"
#include "reference/error.h"

struct lodestone_shape {
  std::shared_ptr<const lodestone::Shape> shape;
};

struct lodestone_signature {
  std::shared_ptr<const lodestone::Signature> signature;
};

struct lodestone_manager {
  lodestone::Manager manager;
  std::vector<lodestone_rung_change> rung_changes = {};  // of the last step, once asked for
  std::vector<lodestone_contact_event> contact_events = {};
  std::string replayed = {};  // of the last replay, in words
};

namespace lodestone::c {

/// What lodestone_error() says on this thread.
void set_error(std::string_view text);

/// Runs `act`; what it throws becomes a result.
template <class Act>
lodestone_result guarded(const Act& act) noexcept {
  try {
    act();
    return LODESTONE_OK;
  } catch (const InputError& error) {
    set_error(error.what());
    return LODESTONE_BAD_INPUT;
  } catch (const std::bad_alloc&) {
    set_error("out of memory");
    return LODESTONE_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    set_error(error.what());
  } catch (...) {
    set_error("an exception that is none of the library's");
  }
  return LODESTONE_FAILED;
}

template <class T>
T& need(T* pointer, const char* what) {
  if (!pointer) throw_input_error(what, "null", "an address");
  return *pointer;
}
inline Manager& of(lodestone_manager* manager) { return need(manager, "manager").manager; }
inline const Manager& of(const lodestone_manager* manager) { return need(manager, "manager").manager; }

template <class T>
std::span<T> list(T* first, std::size_t count, const char* what) {
  if (count > 0) need(first, what);
  return {first, count};
}
template <class T>
void give(T* to, const T& value) {
  if (to) *to = value;
}

/// Makes a handle, once it is known where to put it.
template <class Handle, class Make>
lodestone_result make_handle(Handle** to, const Make& make) noexcept {
  return guarded([&] {
    Handle*& handle = need(to, "where the handle shall go");
    handle = new Handle{make()};
  });
}

/// An enumerator of C's as ours, which have the same numbers.
template <class Ours, class Theirs>
Ours enumerator(Theirs value, Ours last, const char* what) {
  if (int(value) < 0 || int(value) > int(last))
    throw InputError(std::string(what) + ": found " + std::to_string(int(value)) + ", expected 0 to " +
                     std::to_string(int(last)));
  return Ours(int(value));
}

inline Vec3 vec3(const lodestone_vec3& v) { return {v.x, v.y, v.z}; }
inline Quat quat(const lodestone_quat& q) { return {q.w, q.x, q.y, q.z}; }
inline lodestone_vec3 vec3(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline lodestone_quat quat(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline BodyId body(lodestone_body id) { return {id.index, id.generation}; }
inline lodestone_body body(BodyId id) { return {id.index, id.generation}; }
inline GroundId ground(lodestone_ground id) { return {id.index, id.generation}; }
inline lodestone_ground ground(GroundId id) { return {id.index, id.generation}; }
inline RigidState state(const lodestone_state& s) {
  return {vec3(s.position), quat(s.orientation), vec3(s.velocity), vec3(s.angular_velocity)};
}
inline lodestone_state state(const RigidState& s) {
  return {vec3(s.position), quat(s.orientation), vec3(s.velocity), vec3(s.angular_velocity)};
}
BodyProperties properties(const lodestone_properties& p);
lodestone_properties properties(const BodyProperties& p);
TablesOptions tables(const lodestone_tables_options& o);
lodestone_tables_options tables(const TablesOptions& o);
lodestone_color color(const DebugColor& color);
DebugColor color(const lodestone_color& color);
lodestone_contact_side side(const ContactSide& side);
Mesh mesh(const lodestone_vec3* vertices, std::size_t vertex_count, const std::int32_t* faces,
          std::size_t face_count);
std::vector<std::shared_ptr<const Shape>> shapes(const lodestone_shape* const* shapes, std::size_t count);

}  // namespace lodestone::c
