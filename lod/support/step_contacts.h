// Which of a hull's vertices meet the ground in a contact step.
#pragma once

#include <array>
#include <span>
#include <utility>

#include "lod/contact/ground_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/statistical/step_world.h"
#include "lod/support/hull_impacts.h"

namespace lodestone {

/// What held a vertex in the contact step before: where the solver begins in the next.
struct HeldVertices {
  std::array<std::pair<std::int32_t, Vec3>, 3 * kMaxGroundContacts> impulse;  ///< by vertex, N s over mass
  int count = 0;
  bool rolls = false;   ///< onto a vertex that was none of these
  bool wedged = false;  ///< between planes that look against each other
  Vec3 find(std::int32_t vertex) const {
    for (int i = 0; i < count; ++i)
      if (impulse[i].first == vertex) return impulse[i].second;
    return Vec3::Zero();
  }
};

/// The contacts of a step: of each plane in reach the vertices that may meet it.
struct StepContacts {
  static constexpr std::size_t kCapacity = 3 * kMaxGroundContacts;
  std::array<GroundContact, kCapacity> contact;
  std::array<std::int32_t, kCapacity> vertex;
  std::array<int, kCapacity> plane;
  std::size_t count = 0;
  double deepest = 0.0;  ///< m, 0 or less
  int deepest_plane = -1;
  std::array<bool, kCapacity> due;  ///< it was to strike where the step begins
  std::span<GroundContact> contacts() { return std::span(contact).first(count); }
  void add(const GroundContact& c, std::int32_t of_vertex, int of_plane) {
    contact[count] = c;
    vertex[count] = of_vertex;
    due[count] = false;
    plane[count++] = of_plane;
  }
};

/// Of a vertex with a plane. `rotation`: body axes to the world's.
GroundContact vertex_contact(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                             const Mat3& rotation, std::int32_t vertex, int plane_index);

/// For a body that gravity has been given to.
void find_step_contacts(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                        const OnGround& on, double time, double least_margin, const HeldVertices& held,
                        StepContacts& found);

/// With what the contacts gave, `on` being the motion then: the vertex that has sunk in deepest by the step's
/// end, if it is none of those found, and those next to it on the hull that have, too. A round surface rolls
/// onto them: held as they are, they raise the body by its motion, where a lift out of the ground would add
/// energy. Returns how many.
int add_sinking(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const OnGround& on,
                double time, StepContacts& found);

}  // namespace lodestone
