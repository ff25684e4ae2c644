// Which bodies of a crowd meet which planes of the ground, and in what points: found for many of them side by
// side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/contact_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/solid_contacts.h"
#include "lod/jobs.h"

namespace lodestone {

/// Numbers of what bodies touch besides planes, for what is remembered of contacts.
inline constexpr std::size_t kFirstSolid = 1 << 16, kFirstFace = 1u << 31;

struct GroundMeeting {
  std::int32_t index = 0;  ///< of the body, among the participants
  const HalfSpace* plane = nullptr;
  std::size_t number = 0;  ///< of the plane, for what is remembered of its contacts
  double height = 0.0,
         margin = 0.0;  ///< m: of its centre over the plane; a point with a gap up to it may touch
  HullContacts found;   ///< the lowest of its points, some perhaps beyond the margin
};

class GroundMeetings {
 public:
  /// Of those participants that are statistical, move and are not let through, with the planes and `faces`,
  /// in a step of `time` seconds. `bodies`: their velocities, one each. `margin`: over R.
  void find(const ContactScene& scene, std::span<const Participant> participants,
            std::span<const SolverBody> bodies, const FacesBelow& faces, double time, double margin,
            const JobRunner& jobs);
  /// Those of a participant; of one that came after they were found, none.
  std::span<const GroundMeeting> of(std::size_t index) const;

 private:
  std::vector<GroundMeeting> meetings_;  // those of a body in a row
  std::vector<std::uint32_t> first_;     // of each participant
};

}  // namespace lodestone
