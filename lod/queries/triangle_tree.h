// The triangles of a mesh in a tree of boxes, to be asked what a ray, a moving sphere or a box meets. Made
// once for each shape.
#pragma once

#include <optional>
#include <vector>

#include "lod/queries/triangle_questions.h"
#include "reference/mesh/box_hierarchy.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

class TriangleTree {
 public:
  /// Faces counter-clockwise seen from outside.
  explicit TriangleTree(const Mesh& mesh);

  template <class Question>
  Question ask(Question question) const {
    tree_.visit_places([&](const Eigen::AlignedBox3d& box) { return question.may_meet(box); },
                       [&](std::int32_t place) { question.ask(triangles_[std::size_t(place)]); });
    return question;
  }
  /// Whether a point lies inside a closed mesh.
  bool contains(const Vec3& point) const;

 private:
  BoxHierarchy tree_;
  std::vector<Triangle> triangles_;  // by their places there
  Eigen::AlignedBox3d bounds_;
};

}  // namespace lodestone
