#include "reference/hull/resting_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace lodestone {
namespace {

constexpr double kSameHeight = 1e-9;  // × size
constexpr double kSameFace = 0.998;   // cosine between a normal that was measured and the face's own

double angle_between(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(a.dot(b), -1.0, 1.0)); }

/// Height of the centre of mass over a plane that turns from normal `from` to `to` about `pivot`: A cos t + B
/// sin t, t up to `turn`.
struct Turning {
  double a, b, turn;
  Turning(const Vec3& from, const Vec3& to, const Vec3& pivot)
      : a(-from.dot(pivot)), b(0.0), turn(angle_between(from, to)) {
    const Vec3 across = to - to.dot(from) * from;
    if (across.squaredNorm() > 0.0) b = -across.normalized().dot(pivot);
  }
  double at(double t) const { return a * std::cos(t) + b * std::sin(t); }
  double top() const { return std::atan2(b, a); }  // t of the greatest height
  double highest() const {
    const double t = top();
    return t > 0.0 && t < turn ? std::hypot(a, b) : std::max(at(0.0), at(turn));
  }
};

struct Join {
  double pass;
  int first, second;
};

}  // namespace

RestingFaces::RestingFaces(const Hull& hull) : hull_(hull) {
  find_triangles();
  join_parts();
}

void RestingFaces::find_triangles() {
  triangles_at_.resize(hull_.vertices.size());
  std::map<std::array<int, 2>, int> triangle_of_edge;
  double size = 0.0;
  for (const auto& face : hull_.faces) {
    const Vec3 &a = hull_.vertices[face[0]], &b = hull_.vertices[face[1]], &c = hull_.vertices[face[2]];
    const Vec3 normal = -(b - a).cross(c - a).normalized();
    for (int i = 0; i < 3; ++i) {
      triangle_of_edge[{face[i], face[(i + 1) % 3]}] = int(triangles_.size());
      triangles_at_[face[i]].push_back(int(triangles_.size()));
    }
    triangles_.push_back({face, {}, normal, -normal.dot(a)});
    size = std::max({size, a.norm(), b.norm(), c.norm()});
  }
  slack_ = kSameHeight * size;
  for (Triangle& t : triangles_)
    for (int i = 0; i < 3; ++i) t.across[i] = triangle_of_edge.at({t.corner[(i + 1) % 3], t.corner[i]});
}

// The tree's leaves are the triangles; whoever goes up from a leaf meets ever higher passes, so the part that
// can be walked below a height is the last ancestor before the first pass above it (part_below). Kruskal's
// algorithm over the edges, lowest pass first. A part whose lowest triangle is lower than the pass at which
// it joins another holds a stable face; of the two the higher then has its pass.
void RestingFaces::join_parts() {
  std::vector<Join> joins;
  for (int t = 0; t < int(triangles_.size()); ++t)
    for (int i = 0; i < 3; ++i)
      if (const int other = triangles_[t].across[i]; other > t)
        joins.push_back(
            {Turning(triangles_[t].normal, triangles_[other].normal, hull_.vertices[triangles_[t].corner[i]])
                 .highest(),
             t, other});
  std::ranges::stable_sort(joins, {}, &Join::pass);

  parts_.resize(triangles_.size());
  std::vector<std::vector<int>> stable(triangles_.size());  // stable triangles of each part
  std::vector<double> pass_of(triangles_.size(), std::numeric_limits<double>::infinity());
  for (int t = 0; t < int(triangles_.size()); ++t) parts_[t].lowest = t;
  const auto whole_of = [&](int part) {
    while (parts_[part].parent >= 0) part = parts_[part].parent;
    return part;
  };
  const auto note_stable = [&](int part) {
    if (stable[part].empty()) stable[part].push_back(parts_[part].lowest);
  };
  for (const Join& join : joins) {
    int low = whole_of(join.first), high = whole_of(join.second);
    if (low == high) continue;
    const auto height_of = [&](int part) { return triangles_[parts_[part].lowest].height; };
    if (height_of(high) < height_of(low)) std::swap(low, high);
    if (join.pass > height_of(high) + slack_) {
      note_stable(low), note_stable(high);
      pass_of[parts_[high].lowest] = join.pass;
    }
    const int both = int(parts_.size());
    parts_[low].parent = parts_[high].parent = both;
    parts_[low].pass = parts_[high].pass = join.pass;
    Part part{.lowest = parts_[low].lowest};
    stable.push_back(std::move(stable[low]));
    stable.back().insert(stable.back().end(), stable[high].begin(), stable[high].end());
    for (const int t : stable.back())
      part.spread =
          std::max(part.spread, angle_between(triangles_[t].normal, triangles_[part.lowest].normal));
    parts_.push_back(part);
  }
  note_stable(int(parts_.size()) - 1);

  std::vector<int>& found = stable.back();
  std::ranges::stable_sort(found, {}, [&](int t) { return triangles_[t].height; });
  face_of_.assign(triangles_.size(), -1);
  for (const int t : found) {
    face_of_[t] = int(faces_.size());
    faces_.push_back({triangles_[t].normal, triangles_[t].height, pass_of[t]});
  }
}

// The largest part that can be walked from `triangle` without getting above `height`.
int RestingFaces::part_below(int triangle, double height) const {
  int part = triangle;
  while (parts_[part].parent >= 0 && parts_[part].pass <= height) part = parts_[part].parent;
  return part;
}

int RestingFaces::find_certain(const Vec3& normal, double energy_height, double same_angle) const {
  const int vertex = find_support(hull_, -normal);
  for (const int t : triangles_at_[vertex]) {
    if (Turning(normal, triangles_[t].normal, hull_.vertices[vertex]).highest() > energy_height) continue;
    const Part& part = parts_[part_below(t, energy_height)];
    return part.spread <= same_angle ? face_of_[part.lowest] : -1;
  }
  return -1;
}

int RestingFaces::find_quasistatic(const Vec3& normal) const {
  const int triangle = roll(tip(normal));
  return face_of_[parts_[part_below(triangle, triangles_[triangle].height + slack_)].lowest];
}

bool RestingFaces::holds(const Vec3& normal, const Vec3& down) const {
  const Triangle* through = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles_) {
    const double speed = -t.normal.dot(down);
    if (speed > 0.0 && t.height < nearest * speed) nearest = t.height / speed, through = &t;
  }
  return through && through->normal.dot(normal) > kSameFace;
}

// Over the vertex that it stands on until an edge, over that until a face.
int RestingFaces::tip(const Vec3& normal) const {
  const int vertex = find_support(hull_, -normal);
  const Vec3& pivot = hull_.vertices[vertex];
  const Vec3 falling = (pivot - normal.dot(pivot) * normal).normalized();
  int first = -1, second = -1;
  double least_turn = 1e300;
  for (const int t : triangles_at_[vertex])
    for (int i = 0; i < 3; ++i) {
      if (triangles_[t].corner[i] != vertex) continue;
      const Vec3 edge = hull_.vertices[triangles_[t].corner[(i + 1) % 3]] - pivot;
      const double turn = std::atan2(std::max(0.0, normal.dot(edge)), -falling.dot(edge));
      if (turn < least_turn) least_turn = turn, first = t, second = triangles_[t].across[i];
    }
  const Vec3 on_edge = std::cos(least_turn) * normal + std::sin(least_turn) * falling;
  const Turning over(triangles_[first].normal, triangles_[second].normal, pivot);
  return angle_between(triangles_[first].normal, on_edge) > over.top() ? second : first;
}

// From face to face over the edge that the foot of the centre of mass lies farthest beyond; each is lower
// than the one before.
int RestingFaces::roll(int triangle) const {
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const Triangle& t = triangles_[triangle];
    const Vec3 foot = -t.height * t.normal;
    int over = -1;
    double farthest = slack_;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = hull_.vertices[t.corner[k]], &b = hull_.vertices[t.corner[(k + 1) % 3]];
      const double beyond = (b - a).normalized().cross(t.normal).dot(a - foot);
      if (beyond > farthest) farthest = beyond, over = k;
    }
    if (over < 0) return triangle;
    triangle = t.across[over];
  }
  return triangle;
}

}  // namespace lodestone
