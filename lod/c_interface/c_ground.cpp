// Materials, ground, and bodies of the caller's own that the manager looks after.
#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

lodestone_result lodestone_add_material(lodestone_manager* manager, double restitution, double friction,
                                        double density, int32_t* material) {
  return guarded([&] {
    give(material, std::int32_t(of(manager).materials().add({restitution, friction, density})));
  });
}

lodestone_result lodestone_replace_material(lodestone_manager* manager, int32_t material, double restitution,
                                            double friction, double density) {
  return guarded([&] { of(manager).materials().replace(material, {restitution, friction, density}); });
}

lodestone_result lodestone_set_contact_law(lodestone_manager* manager, int32_t first, int32_t second,
                                           double restitution, double friction) {
  return guarded([&] { of(manager).materials().set_law(first, second, {restitution, friction}); });
}

lodestone_result lodestone_add_plane(lodestone_manager* manager, lodestone_vec3 normal, double offset,
                                     int32_t material, lodestone_ground* added) {
  return guarded([&] { give(added, ground(of(manager).add_plane(vec3(normal), offset, material))); });
}

lodestone_result lodestone_add_static_box(lodestone_manager* manager, lodestone_vec3 sides,
                                          lodestone_vec3 position, lodestone_quat orientation,
                                          int32_t material, lodestone_ground* added) {
  return guarded([&] {
    give(added, ground(of(manager).add_static_box(vec3(sides), vec3(position), quat(orientation), material)));
  });
}

lodestone_result lodestone_add_static_mesh(lodestone_manager* manager, const lodestone_vec3* vertices,
                                           size_t vertex_count, const int32_t* faces, size_t face_count,
                                           int32_t material, lodestone_ground* added) {
  return guarded([&] {
    give(added,
         ground(of(manager).add_static_mesh(mesh(vertices, vertex_count, faces, face_count), material)));
  });
}

lodestone_result lodestone_move_ground(lodestone_manager* manager, lodestone_ground id,
                                       const lodestone_state* to) {
  return guarded([&] { of(manager).move_ground(ground(id), state(need(to, "state"))); });
}

lodestone_result lodestone_remove_ground(lodestone_manager* manager, lodestone_ground id) {
  return guarded([&] { of(manager).remove_ground(ground(id)); });
}

lodestone_result lodestone_include_body(lodestone_manager* manager, dxBody* ode_body) {
  return guarded([&] { of(manager).include_body(ode_body); });
}

lodestone_result lodestone_exclude_body(lodestone_manager* manager, dxBody* ode_body) {
  return guarded([&] { of(manager).exclude_body(ode_body); });
}

bool lodestone_is_valid_ground(const lodestone_manager* manager, lodestone_ground id) {
  return manager && manager->manager.valid(ground(id));
}
