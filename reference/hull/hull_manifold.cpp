#include "reference/hull/hull_manifold.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kRounding = 1e-9;  // × size
constexpr double kSteep = 1e-9;     // of a normal along the contact's: a face that stands along that
constexpr int kMostCorners = 64;    // of a hull; beyond it those nearest to the deepest one, by edges

/// In the frame of the contact: z along the way out of the upper body, or against it for the lower one, so
/// that the tip is the lowest point of either.
struct Face {
  Vec3 normal, point;  // outward, of unit length
};
struct Edge {
  Vec3 from, to;
};

/// The part of a hull that lies deeper than the other body's tip: its corners there, and the faces and edges
/// around them.
class Tip {
 public:
  /// `rotation`: from the body's axes into the contact's frame, in which the body's centre of mass is
  /// `center`. Takes what lies below `height`.
  Tip(const Shape& shape, const Mat3& rotation, const Vec3& center, double height)
      : hull_(shape.hull), rotation_(rotation), center_(center) {
    const Vec3 down = rotation.transpose() * -Vec3::UnitZ();
    corners_.push_back(find_support(hull_, down, shape.support_map.find_start(down)));
    for (std::size_t i = 0; i < corners_.size() && corners_.size() < kMostCorners; ++i)
      visit_neighbors(corners_[i], height);
    for (const int corner : corners_) points_.push_back(place(corner));
    collect_faces();
    collect_edges();
  }

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<Edge>& edges() const { return edges_; }

  /// How far below `point`, a corner of the other's tip, this hull's surface is; negative where the point is
  /// outside. One that came out above, through a thin hull's back, has the whole way to go.
  double depth_below(const Vec3& point, double rounding) const {
    double least = 1e300, to_top = 1e300;  // m, to the surfaces below and, negative beyond it, above
    for (const Face& face : faces_) {
      const double inside = face.normal.dot(face.point - point), up = face.normal.z();
      if (inside < -rounding && up < kSteep) return -1.0;
      if (inside < -rounding) to_top = std::min(to_top, inside / up);
      if (up < -kSteep) least = std::min(least, inside / -up);
    }
    return least + to_top < 0.0 ? -1.0 : least;
  }

 private:
  Vec3 place(int vertex) const { return center_ + rotation_ * hull_.vertices[vertex]; }

  void visit_neighbors(int corner, double height) {
    for (const int next : hull_.neighbors(corner))
      if (place(next).z() < height && std::ranges::find(corners_, next) == corners_.end())
        corners_.push_back(next);
  }
  void collect_faces() {
    std::vector<int> faces;
    for (const int corner : corners_)
      faces.insert(faces.end(), hull_.faces_of(corner).begin(), hull_.faces_of(corner).end());
    std::ranges::sort(faces);
    faces.erase(
        std::unique(faces.begin(), faces.end()),
        faces.end());  // here as elsewhere not std::ranges', whose subranges clang 14 does not compile
    for (const int face : faces)
      faces_.push_back({rotation_ * hull_.face_normals[face], place(hull_.faces[face][0])});
  }
  void collect_edges() {
    for (std::size_t i = 0; i < corners_.size(); ++i)
      for (const int next : hull_.neighbors(corners_[i])) {
        const auto other = std::ranges::find(corners_, next) - corners_.begin();
        if (other > std::ptrdiff_t(i))
          edges_.push_back({points_[i], place(next)});  // once where both ends are in the tip
      }
  }

  const Hull& hull_;
  Mat3 rotation_;
  Vec3 center_;
  std::vector<int> corners_;
  std::vector<Vec3> points_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
};

/// Two axes beside `z` (unit), as rows of the rotation into their frame.
Mat3 frame_along(const Vec3& z) {
  Mat3 frame;
  frame.row(0) = z.unitOrthogonal();
  frame.row(2) = z;
  frame.row(1) = z.cross(frame.row(0).transpose());
  return frame;
}

const Mat3 kMirror = Vec3(1, 1, -1).asDiagonal();  // turns the lower body's tip downwards

/// Where two edges cross, seen along z: the points of both.
std::optional<std::pair<Vec3, Vec3>> find_crossing(const Edge& a, const Edge& b) {
  const Vec3 along_a = a.to - a.from, along_b = b.to - b.from, between = b.from - a.from;
  const auto cross = [](const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); };
  const double turn = cross(along_a, along_b);
  if (std::abs(turn) < 1e-9 * along_a.norm() * along_b.norm()) return {};
  const double on_a = cross(between, along_b) / turn, on_b = cross(between, along_a) / turn;
  if (on_a < 0.0 || on_a > 1.0 || on_b < 0.0 || on_b > 1.0) return {};
  return std::pair(Vec3(a.from + on_a * along_a), Vec3(b.from + on_b * along_b));
}

/// In the contact's frame the first body is above, the second below; the second's tip is held upside down.
class Manifold {
 public:
  Manifold(const Tip& upper, const Tip& lower, double rounding)
      : upper_(upper), lower_(lower), rounding_(rounding) {}

  struct Found {
    Vec3 point;
    double depth;
  };
  std::vector<Found> find() {
    for (const Vec3& corner : upper_.points())
      add_corner(corner, lower_.depth_below(kMirror * corner, rounding_));
    for (const Vec3& corner : lower_.points())
      add_mirrored(kMirror * corner, upper_.depth_below(kMirror * corner, rounding_));
    for (const Edge& a : upper_.edges())
      for (const Edge& b : lower_.edges())
        if (const auto crossing = find_crossing(a, {kMirror * b.from, kMirror * b.to}))
          add_corner(crossing->first, crossing->second.z() - crossing->first.z());
    return found_;
  }

 private:
  void add_corner(const Vec3& corner, double depth) {
    if (depth >= 0.0) found_.push_back({corner + 0.5 * depth * Vec3::UnitZ(), depth});
  }
  void add_mirrored(const Vec3& corner, double depth) {
    if (depth >= 0.0) found_.push_back({corner - 0.5 * depth * Vec3::UnitZ(), depth});
  }

  const Tip &upper_, &lower_;
  double rounding_;
  std::vector<Found> found_;
};

}  // namespace

void find_hull_manifold(const Shape& first, const RigidState& first_state, const Shape& second,
                        const RigidState& second_state, const HullOverlap& overlap,
                        std::vector<ContactPoint>& contacts) {
  const double rounding = kRounding * std::min(first.radius, second.radius);
  const Mat3 frame = frame_along(overlap.direction);
  const Mat3 first_axes = frame * first_state.orientation.toRotationMatrix();
  const Mat3 second_axes = kMirror * frame * second_state.orientation.toRotationMatrix();
  // About the first body: each tip takes what is deeper than the other's lowest point.
  const Vec3 second_center = kMirror * frame * (second_state.position - first_state.position);
  const auto lowest = [](const Shape& shape, const Mat3& axes, const Vec3& center) {
    const Vec3 down = axes.transpose() * -Vec3::UnitZ();
    return center.z() +
           (axes * shape.hull.vertices[find_support(shape.hull, down, shape.support_map.find_start(down))])
               .z();
  };
  const Tip upper(first, first_axes, Vec3::Zero(), -lowest(second, second_axes, second_center) + rounding);
  const Tip lower(second, second_axes, second_center, -lowest(first, first_axes, Vec3::Zero()) + rounding);
  for (const auto& [point, depth] : Manifold(upper, lower, rounding).find())
    contacts.push_back({first_state.position + frame.transpose() * point, overlap.direction,
                        std::min(depth, overlap.depth)});
}

}  // namespace lodestone
