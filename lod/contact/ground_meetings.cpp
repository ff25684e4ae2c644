#include "lod/contact/ground_meetings.h"

#include <algorithm>

namespace lodestone {
namespace {

Tipping find_tipping(const ContactScene& scene, const SolverBody& body, const Vec3& normal, double time) {
  const double falling = std::max(0.0, -scene.world.gravity.dot(normal));
  if (body.inverse_mass == 0.0) return {};
  return {body.angular_velocity * time, body.inverse_inertia * (falling * time * time / body.inverse_mass)};
}

void find_points(const ContactScene& scene, const SolverBody& solver_body, double time, StatisticalBody& body,
                 GroundMeeting& meeting) {
  const Vec3& normal = meeting.plane->normal;
  if (body.is_sphere()) {
    const double radius = body.sphere_radius;
    meeting.found.contact[0] = {-radius * normal, meeting.height - radius};
    meeting.found.count = 1;
  } else {
    meeting.found = find_hull_contacts(*scene.kind_of(body).shape, body.orientation, normal, meeting.height,
                                       meeting.margin, body.support_hint, {},
                                       find_tipping(scene, solver_body, normal, time));
  }
}

}  // namespace

void GroundMeetings::find(const ContactScene& scene, std::span<const Participant> participants,
                          std::span<const SolverBody> bodies, const FacesBelow& faces, double time,
                          double margin, const JobRunner& jobs) {
  meetings_.clear();
  first_.assign(1, 0);
  for (std::size_t i = 0; i < participants.size(); ++i) {
    const Participant p = participants[i];
    const auto add = [&](const HalfSpace& plane, std::size_t number) {
      const StatisticalBody& body = scene.body(p);
      const double radius = scene.kind_of(body).shape->radius, height = plane.height_of(body.position),
                   spin_speed = body.is_sphere() ? 0.0 : bodies[i].angular_velocity.norm() * radius,
                   falling = std::max(0.0, -bodies[i].velocity.dot(plane.normal)),
                   way = margin * radius + (falling + 0.5 * spin_speed) * time;
      if (height <= (body.is_sphere() ? double(body.sphere_radius) : radius) + way)
        meetings_.push_back({std::int32_t(i), &plane, number, height, way, {}});
    };
    if (p.is_statistical() && !scene.asleep(p) && !scene.properties(p).kinematic) {
      const BodyProperties& own = scene.properties(p);
      for (std::size_t number = 0; number < scene.world.planes.size(); ++number)
        if (meets_ground(own, scene.world.planes[number].bits)) add(scene.world.planes[number], number);
      std::size_t number = kFirstFace;
      for (const HalfSpace& face : faces.of(std::int32_t(p.index()))) add(face, number++);
    }
    first_.push_back(std::uint32_t(meetings_.size()));
  }
  // Of a job: those of a body one after the other, as each leaves a hint.
  constexpr std::int64_t kBodies = 128;
  run_in_pieces(jobs, std::int64_t(participants.size()), kBodies, [&](std::int64_t begin, std::int64_t end) {
    for (std::uint32_t i = first_[std::size_t(begin)]; i < first_[std::size_t(end)]; ++i) {
      const auto index = std::size_t(meetings_[i].index);
      find_points(scene, bodies[index], time, scene.body(participants[index]), meetings_[i]);
    }
  });
}

std::span<const GroundMeeting> GroundMeetings::of(std::size_t index) const {
  if (index + 1 >= first_.size()) return {};
  return std::span(meetings_).subspan(first_[index], first_[index + 1] - first_[index]);
}

}  // namespace lodestone
