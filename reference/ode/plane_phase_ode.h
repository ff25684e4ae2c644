// Contact points of a body with a plane: of its hull's vertices, its spheres, or its mesh as plain ODE finds
// them.
#pragma once

#include <vector>

#include "reference/contact_point.h"
#include "reference/ode/bodies_ode.h"
#include "reference/ode/plane_contacts.h"
#include "reference/ode/timed_contacts.h"

namespace lodestone::ode {

struct Plane {
  Vec3 normal;
  double offset;  ///< m
  MaterialId material;
  dGeomID geom;
  unsigned category = ~0u, collide = ~0u;  ///< bits
  OdeGroundId id{};                        ///< null: the caller's
};

/// The step to come.
struct PlaneStep {
  double duration = 0.0;  ///< s
  Vec3 gravity = Vec3::Zero();
};

class PlanePhase {
 public:
  explicit PlanePhase(const OdeSettings& settings) : settings_(settings) {}

  /// Appends to `points` the contacts of `body`; `law` is that of the body and the plane. Where `body` is
  /// answered at its own time (Body::impact) that is set, for the first of its planes only.
  void find(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
            std::vector<ContactPoint>& points);

  /// Contacts left out beyond OdeSettings::max_contacts_per_pair.
  std::int64_t dropped() const { return dropped_; }

 private:
  void find_hull_points(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
                        std::vector<ContactPoint>& points);
  void append_early_and_deep(const Body& body, const Plane& plane, const PlaneStep& step,
                             std::vector<ContactPoint>& points) const;
  void append_timed(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
                    std::vector<ContactPoint>& points) const;
  void find_sphere_points(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
                          std::vector<ContactPoint>& points);
  void find_mesh_points(const Body& body, const Plane& plane, std::vector<ContactPoint>& points) const;
  double nearing(const Body& body, const Plane& plane, const PlaneStep& step) const;
  bool is_timed(const Body& body, const PlaneStep& step) const;
  void keep_widest(const Body& body, std::vector<ContactPoint>& points);

  OdeSettings settings_;
  PlaneContactFinder plane_contacts_;
  std::vector<NearPoint> near_;
  std::int64_t dropped_ = 0;
};

}  // namespace lodestone::ode
