#include "reference/hull/hull.h"

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>

#include "reference/error.h"

namespace lodestone {
namespace {

/// A corner must stand out from the rest by this much × size: points on a face or an edge of the hull are no
/// corners.
constexpr double kLeastProtrusion = 1e-10;

using Faces = std::vector<std::array<int, 3>>;

/// Owns one run of Qhull (its reentrant interface) and the stream that swallows its messages.
class QhullRun {
 public:
  explicit QhullRun(std::vector<Vec3> points)
      : points_(std::move(points)), messages_(open_memstream(&text_, &length_)) {
    qh_zero(&qh_, messages_);
    char command[] = "qhull Qt";  // Qt: triangulated
    exit_code_ = qh_new_qhull(&qh_, 3, int(points_.size()), points_.data()->data(), False, command, nullptr,
                              messages_);
  }
  ~QhullRun() {
    qh_freeqhull(&qh_, !qh_ALL);
    int left = 0, total = 0;
    qh_memfreeshort(&qh_, &left, &total);
    std::fclose(messages_);
    std::free(text_);
  }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;

  bool succeeded() const { return exit_code_ == 0; }

  /// Indices into the points, counter-clockwise seen from outside.
  Faces faces() {
    Faces found;
    qhT* qh = &qh_;  // the name that Qhull's macros expect
    facetT* facet;
    FORALLfacets {
      std::array<int, 3> face{};
      vertexT *vertex, **vertexp;
      int corner = 0;
      FOREACHvertex_(facet->vertices) if (corner < 3) face[corner++] = qh_pointid(qh, vertex->point);
      const Vec3 &a = points_[face[0]], &b = points_[face[1]], &c = points_[face[2]];
      if ((b - a).cross(c - a).dot(Vec3::Map(facet->normal)) < 0.0) std::swap(face[1], face[2]);
      found.push_back(face);
    }
    return found;
  }

 private:
  std::vector<Vec3> points_;
  char* text_ = nullptr;
  std::size_t length_ = 0;
  FILE* messages_;
  qhT qh_{};
  int exit_code_ = 0;
};

Faces find_hull_faces(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  std::vector<Vec3> centred(points.begin(), points.end());
  for (Vec3& point : centred) point -= box.center();  // Qhull's tolerances grow with the coordinates
  QhullRun run(std::move(centred));
  if (!run.succeeded())
    throw InputError("hull: found points that lie in a plane, expected a solid's corners");
  return run.faces();
}

/// The edge graph, each run in ascending order.
void connect_neighbors(Hull& hull) {
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const auto& face : hull.faces)
    for (int i = 0; i < 3; ++i) {
      edges.push_back({face[i], face[(i + 1) % 3]});
      edges.push_back({face[(i + 1) % 3], face[i]});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  hull.neighbor_start.assign(hull.vertices.size() + 1, 0);
  for (const auto& [from, to] : edges) {
    ++hull.neighbor_start[from + 1];
    hull.neighbor.push_back(to);
  }
  for (std::size_t i = 1; i < hull.neighbor_start.size(); ++i)
    hull.neighbor_start[i] += hull.neighbor_start[i - 1];
}

void collect_incident_faces(Hull& hull) {
  std::vector<std::pair<int, int>> incidences;  // vertex, face
  for (int face = 0; face < int(hull.faces.size()); ++face)
    for (const int vertex : hull.faces[face]) incidences.emplace_back(vertex, face);
  std::ranges::sort(incidences);
  hull.face_start.assign(hull.vertices.size() + 1, 0);
  for (const auto& [vertex, face] : incidences) {
    ++hull.face_start[vertex + 1];
    hull.incident_face.push_back(face);
  }
  std::partial_sum(hull.face_start.begin(), hull.face_start.end(), hull.face_start.begin());
}

/// The hull of `points` with every vertex that Qhull finds, in the order of `points`.
Hull make_raw_hull(std::span<const Vec3> points) {
  Hull hull;
  hull.faces = find_hull_faces(points);
  std::map<int, int> index_of;
  for (const auto& face : hull.faces)
    for (int i : face) index_of.try_emplace(i);
  for (auto& [point, index] : index_of) {
    index = int(hull.vertices.size());
    hull.vertices.push_back(points[point]);
  }
  for (auto& face : hull.faces)
    for (int& i : face) i = index_of.at(i);
  connect_neighbors(hull);
  collect_incident_faces(hull);
  return hull;
}

/// How far each vertex stands out from its neighbours along the mean normal of its faces: zero on a face or
/// an edge.
std::vector<double> measure_protrusions(const Hull& hull) {
  std::vector<Vec3> normals(hull.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : hull.faces) {
    const Vec3 normal =
        (hull.vertices[b] - hull.vertices[a]).cross(hull.vertices[c] - hull.vertices[a]).normalized();
    for (int i : {a, b, c}) normals[i] += normal;
  }
  std::vector<double> protrusions(hull.vertices.size());
  for (int i = 0; i < int(protrusions.size()); ++i) {
    const Vec3 normal = normals[i].normalized();
    double highest = -1e300;
    for (int j : hull.neighbors(i))
      highest = std::max(highest, normal.dot(hull.vertices[j] - hull.vertices[i]));
    protrusions[i] = -highest;
  }
  return protrusions;
}

/// The vertices of `hull` less those that are no corners. Of two neighbours only one goes at a time: each may
/// be redundant only because of the other.
std::vector<Vec3> drop_flat_vertices(const Hull& hull) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : hull.vertices) box.extend(vertex);
  const double least = kLeastProtrusion * box.sizes().maxCoeff();
  const std::vector<double> protrusions = measure_protrusions(hull);
  std::vector<bool> dropped(hull.vertices.size(), false);
  std::vector<Vec3> kept;
  for (int i = 0; i < int(dropped.size()); ++i) {
    const auto neighbors = hull.neighbors(i);
    dropped[i] = protrusions[i] < least &&
                 std::none_of(neighbors.begin(), neighbors.end(), [&](int j) { return dropped[j]; });
    if (!dropped[i]) kept.push_back(hull.vertices[i]);
  }
  return kept;
}

// What follows from the vertices.
void derive(Hull& hull) {
  hull.face_normals.clear();
  hull.face_normals.reserve(hull.faces.size());
  for (int face = 0; face < int(hull.faces.size()); ++face)
    hull.face_normals.push_back(hull.area_vector(face).normalized());
  hull.lanes = {};
  for (const Vec3& vertex : hull.vertices) {
    hull.lanes.x.push_back(float(vertex.x()));
    hull.lanes.y.push_back(float(vertex.y()));
    hull.lanes.z.push_back(float(vertex.z()));
  }
}

}  // namespace

void transform_hull(Hull& hull, const Vec3& origin, double factor) {
  for (Vec3& vertex : hull.vertices) vertex = factor * (vertex - origin);
  derive(hull);
}

Hull make_hull(std::span<const Vec3> points) {
  if (points.size() < 4)
    throw InputError(fmt::format("hull: found {} points, expected at least 4", points.size()));
  for (const Vec3& point : points)
    if (!point.allFinite())
      throw InputError(fmt::format("hull: found a point at ({}, {}, {}), expected finite ones", point.x(),
                                   point.y(), point.z()));
  Hull hull = make_raw_hull(points);
  for (auto corners = drop_flat_vertices(hull); corners.size() < hull.vertices.size();
       corners = drop_flat_vertices(hull)) {
    if (corners.size() < 4)
      throw InputError("hull: found points that lie in a plane, expected a solid's corners");
    hull = make_raw_hull(corners);
  }
  derive(hull);
  return hull;
}

Hull make_prism_hull(const std::array<Vec3, 3>& corners, const std::array<Vec3, 3>& below) {
  static const Hull connected = [] {
    Hull hull;
    hull.vertices.resize(6);
    hull.faces = {{0, 2, 4}, {1, 5, 3}, {0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}, {4, 5, 1}, {4, 1, 0}};
    connect_neighbors(hull);
    collect_incident_faces(hull);
    return hull;
  }();
  Hull hull = connected;
  for (std::size_t i = 0; i < 3; ++i)
    hull.vertices[2 * i] = corners[i], hull.vertices[2 * i + 1] = corners[i] + below[i];
  derive(hull);
  return hull;
}

}  // namespace lodestone
