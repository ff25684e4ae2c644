#include "reference/mesh/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace lodestone {
namespace {

/// Sum of squared distances to planes, each weighted by its face's area.
struct Quadric {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  double weight = 0.0;

  Quadric& operator+=(const Quadric& other) {
    sum += other.sum;
    weight += other.weight;
    return *this;
  }
  double mean_square_at(const Vec3& point) const {
    const Eigen::Vector4d p = point.homogeneous();
    return weight > 0.0 ? std::max(0.0, p.dot(sum * p)) / weight : 0.0;
  }
};

/// Vertex `from` moved onto `to`. Out of date once either vertex has changed since.
struct Collapse {
  double cost = 0.0;
  int from = 0, to = 0;
  int from_version = 0, to_version = 0;
  friend bool operator>(const Collapse& a, const Collapse& b) {
    return std::tie(a.cost, a.from, a.to) > std::tie(b.cost, b.from, b.to);
  }
};

class Collapser {
 public:
  explicit Collapser(const Mesh& mesh)
      : mesh_(mesh),
        faces_of_(mesh.vertices.size()),
        quadrics_(mesh.vertices.size()),
        versions_(mesh.vertices.size(), 0),
        left_(int(mesh.faces.size())) {
    for (int face = 0; face < left_; ++face) add_face(face);
    for (int vertex = 0; vertex < int(faces_of_.size()); ++vertex) offer_collapses_of(vertex);
  }

  double run(int faces) {
    double worst = 0.0;
    while (left_ > faces && !offers_.empty()) {
      const Collapse best = offers_.top();
      offers_.pop();
      if (versions_[best.from] != best.from_version || versions_[best.to] != best.to_version ||
          !is_safe(best))
        continue;
      worst = std::max(worst, best.cost);
      apply(best);
    }
    return std::sqrt(worst);
  }

  Mesh result() const {
    Mesh kept{mesh_.vertices, {}};
    std::copy_if(mesh_.faces.begin(), mesh_.faces.end(), std::back_inserter(kept.faces),
                 [](const auto& face) { return face[0] >= 0; });
    return kept;
  }

 private:
  const Vec3& at(int vertex) const { return mesh_.vertices[vertex]; }

  Vec3 cross_of(const std::array<int, 3>& face) const {
    return (at(face[1]) - at(face[0])).cross(at(face[2]) - at(face[0]));
  }

  void add_face(int face) {
    const auto& corners = mesh_.faces[face];
    const Vec3 cross = cross_of(corners);
    Eigen::Vector4d plane;
    plane << cross.stableNormalized(), 0.0;
    plane[3] = -plane.head<3>().dot(at(corners[0]));
    const Quadric quadric{cross.norm() * plane * plane.transpose(), cross.norm()};
    for (int vertex : corners) {
      faces_of_[vertex].push_back(face);
      quadrics_[vertex] += quadric;
    }
  }

  std::vector<int> neighbors_of(int vertex) const {
    std::vector<int> neighbors;
    for (int face : faces_of_[vertex])
      for (int other : mesh_.faces[face])
        if (other != vertex) neighbors.push_back(other);
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
    return neighbors;
  }

  void offer(int from, int to) {
    Quadric both = quadrics_[from];
    both += quadrics_[to];
    offers_.push({both.mean_square_at(at(to)), from, to, versions_[from], versions_[to]});
  }

  void offer_collapses_of(int vertex) {
    for (int other : neighbors_of(vertex)) {
      offer(vertex, other);
      offer(other, vertex);
    }
  }

  /// The link condition (the two ends share just the two corners opposite their edge), and no face turned
  /// over.
  bool is_safe(const Collapse& collapse) const {
    const std::vector<int> a = neighbors_of(collapse.from), b = neighbors_of(collapse.to);
    std::vector<int> shared;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    const bool is_tetrahedron = a.size() == 3 && b.size() == 3;
    const bool is_closed_fan = a.size() == faces_of_[collapse.from].size();
    if (shared.size() != 2 || is_tetrahedron || !is_closed_fan) return false;
    return std::none_of(faces_of_[collapse.from].begin(), faces_of_[collapse.from].end(),
                        [&](int face) { return turns_over(mesh_.faces[face], collapse); });
  }

  bool turns_over(const std::array<int, 3>& face, const Collapse& collapse) const {
    if (std::find(face.begin(), face.end(), collapse.to) != face.end()) return false;  // it goes
    std::array<int, 3> after = face;
    std::replace(after.begin(), after.end(), collapse.from, collapse.to);
    const Vec3 old_cross = cross_of(face), new_cross = cross_of(after);
    return new_cross.dot(old_cross) <= 0.1 * new_cross.norm() * old_cross.norm();
  }

  void apply(const Collapse& collapse) {
    for (int face : faces_of_[collapse.from]) {
      auto& corners = mesh_.faces[face];
      if (std::find(corners.begin(), corners.end(), collapse.to) == corners.end()) {
        std::replace(corners.begin(), corners.end(), collapse.from, collapse.to);
        faces_of_[collapse.to].push_back(face);
        continue;
      }
      for (int vertex : corners)
        if (vertex != collapse.from) std::erase(faces_of_[vertex], face);
      corners = {-1, -1, -1};
      --left_;
    }
    faces_of_[collapse.from].clear();
    quadrics_[collapse.to] += quadrics_[collapse.from];
    ++versions_[collapse.from];
    ++versions_[collapse.to];
    offer_collapses_of(collapse.to);
  }

  Mesh mesh_;  ///< a face that is gone has −1 for corners
  std::vector<std::vector<int>> faces_of_;
  std::vector<Quadric> quadrics_;
  std::vector<int> versions_;
  int left_;
  std::priority_queue<Collapse, std::vector<Collapse>, std::greater<>> offers_;
};

}  // namespace

Mesh collapse_edges(const Mesh& mesh, int faces, double* error) {
  Collapser collapser(mesh);
  const double worst = collapser.run(faces);
  if (error) *error = worst;
  return collapser.result();
}

}  // namespace lodestone
