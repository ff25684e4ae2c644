#include "lod/c_interface/c_values.h"

#include <filesystem>

#include "lod/version.h"
#include "signature/signature_file.h"
#include "signature/signature_source.h"

namespace lodestone::c {
namespace {

std::string& error_text() {
  thread_local std::string text;
  return text;
}

}  // namespace

void set_error(std::string_view text) {
  try {
    error_text() = text;
  } catch (const std::bad_alloc&) {
    error_text().clear();  // there is no memory for the words either
  }
}

BodyProperties properties(const lodestone_properties& p) {
  return {.category = p.category,
          .collide = p.collide,
          .gravity = p.gravity,
          .linear_damping = p.linear_damping,
          .angular_damping = p.angular_damping,
          .max_angular_speed = p.max_angular_speed,
          .kinematic = p.kinematic,
          .allow_sleep = p.allow_sleep};
}

lodestone_properties properties(const BodyProperties& p) {
  return {p.category,    p.collide,        p.gravity,         p.kinematic,
          p.allow_sleep, p.linear_damping, p.angular_damping, p.max_angular_speed};
}

TablesOptions tables(const lodestone_tables_options& o) {
  return {.interpolate = o.interpolate,
          .draw_height = o.draw_height,
          .radius_update_interval = o.radius_update_interval,
          .rest_poses = o.rest_poses,
          .nearest_rest_pose = o.nearest_rest_pose,
          .paper_pair_rule = o.paper_pair_rule,
          .published = o.published};
}

lodestone_tables_options tables(const TablesOptions& o) {
  return {o.interpolate,     o.draw_height, o.radius_update_interval, o.rest_poses, o.nearest_rest_pose,
          o.paper_pair_rule, o.published};
}

lodestone_color color(const DebugColor& color) { return {color.red, color.green, color.blue}; }
DebugColor color(const lodestone_color& color) { return {color.red, color.green, color.blue}; }

lodestone_contact_side side(const ContactSide& side) {
  return {lodestone_contact_kind(side.kind),
          body(side.body),
          ground(side.ground),
          side.geom,
          side.callers,
          side.material};
}

Mesh mesh(const lodestone_vec3* vertices, std::size_t vertex_count, const std::int32_t* faces,
          std::size_t face_count) {
  Mesh mesh;
  for (const lodestone_vec3& vertex : list(vertices, vertex_count, "vertices"))
    mesh.vertices.push_back(vec3(vertex));
  const std::span<const std::int32_t> corners = list(faces, 3 * face_count, "faces");
  for (std::size_t i = 0; i < face_count; ++i)
    mesh.faces.push_back({corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]});
  return mesh;
}

std::vector<std::shared_ptr<const Shape>> shapes(const lodestone_shape* const* given, std::size_t count) {
  std::vector<std::shared_ptr<const Shape>> found;
  for (const lodestone_shape* shape : list(given, count, "shapes"))
    found.push_back(need(shape, "a shape").shape);
  return found;
}

}  // namespace lodestone::c

using namespace lodestone;
using namespace lodestone::c;

const char* lodestone_error(void) { return error_text().c_str(); }
const char* lodestone_version(void) { return LODESTONE_VERSION_STRING; }

void lodestone_set_assertion_handler(void (*handler)(void* context, const char* message), void* context) {
  if (handler)
    set_assertion_handler([=](std::string_view message) { handler(context, std::string(message).c_str()); });
  else
    set_assertion_handler({});
}

namespace {

lodestone_result make(lodestone_shape** to, const auto& make_it) {
  return make_handle(to, [&] { return std::make_shared<const Shape>(make_it()); });
}

}  // namespace

lodestone_result lodestone_make_box(const char* name, lodestone_vec3 sides, lodestone_shape** shape) {
  return make(shape, [&] { return make_shape(&need(name, "name"), lodestone::make_box(vec3(sides))); });
}

lodestone_result lodestone_make_sphere(double radius, lodestone_shape** shape) {
  return make(shape, [&] { return make_sphere_shape(radius); });
}

lodestone_result lodestone_make_mesh(const char* name, const lodestone_vec3* vertices, size_t vertex_count,
                                     const int32_t* faces, size_t face_count, lodestone_shape** shape) {
  return make(shape, [&] {
    return make_shape(&need(name, "name"), mesh(vertices, vertex_count, faces, face_count));
  });
}

lodestone_result lodestone_load_mesh(const char* file, double size, lodestone_shape** shape) {
  return make(shape, [&] {
    Mesh loaded = load_mesh(&need(file, "file"));
    return make_shape(file, size == 0.0 ? std::move(loaded) : scale_to_size(std::move(loaded), size));
  });
}

void lodestone_release_shape(lodestone_shape* shape) { delete shape; }

lodestone_result lodestone_load_signature(const char* file, lodestone_signature** signature) {
  return make_handle(signature, [&] {
    return std::make_shared<const Signature>(load_signature(std::filesystem::path(&need(file, "file"))));
  });
}

lodestone_result lodestone_read_signature(const void* bytes, size_t size, lodestone_signature** signature) {
  return make_handle(signature, [&] {
    return std::make_shared<const Signature>(
        load_signature(list(static_cast<const std::byte*>(bytes), size, "bytes")));
  });
}

lodestone_result lodestone_find_or_measure_signature(const lodestone_shape* shape, double restitution,
                                                     double friction, int32_t threads,
                                                     lodestone_signature** signature) {
  return make_handle(signature, [&] {
    if (threads < 0) throw InputError("threads: found " + std::to_string(threads) + ", expected 0 or more");
    SignatureSourceSettings settings;
    settings.threads = threads;
    return find_or_measure_signature(*need(shape, "shape").shape, {restitution, friction}, settings)
        .signature;
  });
}

void lodestone_release_signature(lodestone_signature* signature) { delete signature; }
