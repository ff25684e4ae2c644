// The ground that the spheres of a step are near, or come to be near within it: its planes, and faces of its
// parts as planes, each for the sphere near it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/solid_contacts.h"
#include "lod/ground/ground_jobs.h"
#include "lod/tables/sphere_ground.h"
#include "lod/tables/sphere_scene.h"
#include "reference/state_archive.h"

namespace lodestone {

class NearGround {
 public:
  struct Carried {
    std::int64_t place = 0;
    Vec3 velocity, angular_velocity;  // of the ground below
  };

  explicit NearGround(const SphereScene& scene) : scene_(scene) {}

  /// A step begins, with the planes that all may meet.
  void begin_step();
  /// Of the spheres at places [begin, end): what they are near of the ground's parts, as planes. In ascending
  /// order.
  void find_faces(std::int64_t begin, std::int64_t end, const JobRunner& jobs);
  /// And who may meet a plane or such a face in this step: find_near_ground(). From several threads.
  void find_near(std::int64_t begin, std::int64_t end, Simd simd);

  bool any() const { return !ground_.planes().empty() || !faces_.empty(); }
  const SphereGround& planes() const { return planes_; }  ///< in the order of plane()
  /// The ground's, then faces.
  const HalfSpace& plane(std::int32_t number) const {
    const auto own = std::int32_t(ground_.planes().size());
    return number < own ? ground_.planes()[std::size_t(number)] : faces_[std::size_t(number - own)];
  }
  int faces() const { return int(faces_.size()); }
  /// All that a sphere may meet; until the next call on this thread.
  std::span<const HalfSpace> planes_of(std::int64_t place) const;
  /// Calls visit(number) with the faces that the sphere is near.
  template <class Visit>
  void each_face_of(std::int64_t place, const Visit& visit) const {
    if (const Near* near = find(place))
      for (std::int32_t face = near->begin; face < near->end; ++face)
        visit(std::int32_t(ground_.planes().size()) + face);
  }
  /// `way`, m, less what of it would bring the sphere's hull into the ground.
  Vec3 above_faces(std::int64_t place, const Vec3& way) const;
  /// The number of that which its centre is least above; of a sphere near ground that moves.
  std::int32_t nearest_face(std::int64_t place) const;
  /// Whether planes stand for all that the hull of a sphere that is alone may meet of the ground's parts.
  bool is_even(std::int64_t place) const;
  /// Whether planes do not tell how it goes on.
  bool is_cornered(std::int64_t place) const;
  std::span<const std::int32_t> cornered() const { return cornered_; }  ///< slots of these
  std::span<const Carried> carried() const { return carried_; }         ///< by place: near ground that moves
  const Carried* carrying(std::int64_t place) const;                    ///< null where none of that is near
  /// m: how far from its centre a body of that speed (m/s) looks for the ground.
  double reach_of(std::int64_t place, double speed) const;

  // After the bodies have moved, of those that touch others.
  void keep_above_planes(std::int64_t begin, std::int64_t end);
  void keep_above_faces();

  void archive(StateArchive& a) { a(cornered_); }

 private:
  struct Near {
    std::int64_t place = 0;
    std::int32_t begin = 0, end = 0;  // in faces_
    bool even = false;                // as is_even
    bool cornered = false;            // as is_cornered
    bool above = false;               // its centre was, of all, where the step began, and none moves
  };

  const Near* find(std::int64_t place) const;
  /// What some spheres are near, one after the other.
  struct Look {
    std::vector<HalfSpace> faces;
    std::vector<const GroundPart*> parts;  // of each of these, where it may move
    std::vector<Near> near;                // in these
    std::vector<Carried> carried;
    void clear() { faces.clear(), parts.clear(), near.clear(), carried.clear(); }
  };
  bool make_ground(std::int64_t begin, std::int64_t end) const;
  double farthest_speed(std::int64_t place) const;
  void look_below(std::int64_t place, Look& found) const;
  void take(const Look& found);
  bool find_planes_of(std::int64_t place, std::vector<HalfSpace>& faces) const;
  bool find_bridged_plane(std::int64_t place, std::span<const GroundNear> near,
                          std::vector<HalfSpace>& faces) const;
  bool is_in_corner(std::int64_t place, std::span<const GroundNear> near, double margin) const;
  void lift_out(std::int64_t place, const HalfSpace& plane, double lift);

  const SphereScene& scene_;
  const StatisticalSettings& settings_ = scene_.settings;
  const Ground& ground_ = scene_.ground;
  const MaterialTable& materials_ = scene_.materials;
  const SphereKinds& kinds_ = scene_.kinds;
  const StepConstants& constants_ = scene_.constants;
  Spheres& spheres_ = scene_.spheres;
  SphereStep& step_ = scene_.step;

  SphereGround planes_;
  std::vector<HalfSpace> faces_;        // each for the sphere near it
  std::vector<Near> near_;              // by place
  std::vector<std::int32_t> cornered_;  // slots
  std::vector<Carried> carried_;        // by place
  std::vector<Look> looks_;
};

}  // namespace lodestone
