#include "reference/ode/box_tree.h"

#include <algorithm>
#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost's own, of each other
#include <boost/geometry/algorithms/covered_by.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/iterator/function_output_iterator.hpp>

namespace lodestone {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::point<double, 3, bg::cs::cartesian>;
using Box = bg::model::box<Point>;
using Value = std::pair<Box, std::uint32_t>;
struct SameNumber {
  bool operator()(const Value& a, const Value& b) const { return a.second == b.second; }
};
using Tree = bg::index::rtree<Value, bg::index::quadratic<16>, bg::index::indexable<Value>, SameNumber>;

constexpr double kMargin = 0.05;    // of its longest side, about what moves
constexpr double kForesight = 8.0;  // moves like the last one that the tree need not hear of

Point point_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Box box_of(const Eigen::AlignedBox3d& box) { return {point_of(box.min()), point_of(box.max())}; }
// Without a floating-point exception: an endless box is none.
bool is_finite(const Eigen::AlignedBox3d& box) {
  return box.min().array().isFinite().all() && box.max().array().isFinite().all();
}

}  // namespace

struct BoxTree::Impl {
  Tree tree;
  std::vector<Eigen::AlignedBox3d> held;  // by number; empty where it is not in the tree
  std::vector<std::uint32_t> endless;

  void hold(std::uint32_t number, const Eigen::AlignedBox3d& box) {
    if (number >= held.size()) held.resize(number + 1);
    held[number] = box;
  }
};

BoxTree::BoxTree() : impl_(std::make_unique<Impl>()) {}
BoxTree::~BoxTree() = default;

void BoxTree::add(std::span<const Entry> entries) {
  std::vector<Value> values;
  for (const auto& [number, box] : entries) {
    if (!is_finite(box)) {
      impl_->endless.push_back(number);
      continue;
    }
    impl_->hold(number, box);
    values.emplace_back(box_of(box), number);
  }
  // Packed anew, a box takes a third of the time that it takes to be put in by itself.
  if (values.size() > impl_->tree.size() / 2) {
    values.insert(values.end(), impl_->tree.begin(), impl_->tree.end());
    impl_->tree = Tree(values);
  } else {
    impl_->tree.insert(values);
  }
}

void BoxTree::remove(std::uint32_t number) {
  if (std::erase(impl_->endless, number) > 0) return;
  impl_->tree.remove(Value(box_of(impl_->held[number]), number));
  impl_->held[number].setEmpty();
}

void BoxTree::move(std::uint32_t number, const Eigen::AlignedBox3d& before, const Eigen::AlignedBox3d& now) {
  const bool in_tree = number < impl_->held.size() && !impl_->held[number].isEmpty();
  if (in_tree && impl_->held[number].contains(now)) return;
  remove(number);
  Eigen::AlignedBox3d wide = now;
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMargin * now.sizes().maxCoeff());
  wide.min() += kForesight * (now.min() - before.min()).cwiseMin(0.0) - margin;
  wide.max() += kForesight * (now.max() - before.max()).cwiseMax(0.0) + margin;
  if (!is_finite(wide)) return impl_->endless.push_back(number);
  impl_->hold(number, wide);
  impl_->tree.insert(Value(box_of(wide), number));
}

void BoxTree::find(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const {
  found.insert(found.end(), impl_->endless.begin(), impl_->endless.end());
  const auto note = [&](const Value& value) { found.push_back(value.second); };
  impl_->tree.query(bg::index::intersects(box_of(box)), boost::make_function_output_iterator(note));
}

}  // namespace lodestone
