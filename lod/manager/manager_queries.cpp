#include <fmt/format.h>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"

namespace lodestone {
namespace {

constexpr std::int64_t kGrain = 32;  // questions of a job

Sweep sweep_of(const Ray& ray, double radius = 0.0) {
  check_finite(ray.from, "begin of a ray");
  check_finite(ray.direction, "direction of a ray");
  const double norm = ray.direction.stableNorm();
  if (!(norm > 0.0)) throw_input_error("direction of a ray", "zero", "a direction");
  if (!(ray.length >= 0.0))
    throw_input_error("length of a ray", fmt::format("{:g} m", ray.length), "0 or more");
  return {ray.from, ray.direction / norm, ray.length, radius};
}
Sweep sweep_of(const SphereSweep& sphere) {
  check_positive(sphere.radius, "radius of a sphere");
  return sweep_of(sphere.ray, sphere.radius);
}

Volume volume_of(const SphereVolume& sphere) {
  check_finite(sphere.center, "center of a sphere");
  check_positive(sphere.radius, "radius of a sphere");
  return {.center = sphere.center, .reach = sphere.radius};
}
Volume volume_of(const BoxVolume& box) {
  check_finite(box.position, "position of a box");
  for (const double side : box.sides) check_positive(side, "side of a box");
  return {.center = box.position,
          .reach = 0.5 * box.sides.norm(),
          .is_box = true,
          .axes = checked(box.orientation, "orientation of a box").toRotationMatrix(),
          .half = 0.5 * box.sides};
}

// All of them are looked at before the first is asked.
template <class Question, class Make>
auto each_of(std::span<const Question> questions, const Make& make) {
  std::vector<decltype(make(questions[0]))> made;
  made.reserve(questions.size());
  for (const Question& question : questions) made.push_back(make(question));
  return made;
}

void find_firsts(QueryScene& scene, const JobRunner& jobs, std::span<const Sweep> sweeps,
                 std::span<std::optional<QueryHit>> firsts, const QueryFilter& filter) {
  if (firsts.size() != sweeps.size())
    throw_input_error("hits", fmt::format("room for {}", firsts.size()), fmt::to_string(sweeps.size()));
  const QueryScene::Asked asked = scene.prepare(filter);
  run_in_pieces(jobs, std::int64_t(sweeps.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      firsts[std::size_t(i)] = scene.first(sweeps[std::size_t(i)], asked);
  });
}

template <class Question, class Ask>
void find_lists(QueryScene& scene, const JobRunner& jobs, std::span<const Question> questions,
                std::span<std::vector<QueryHit>> lists, const QueryFilter& filter, const Ask& ask) {
  if (lists.size() != questions.size())
    throw_input_error("lists of hits", fmt::format("room for {}", lists.size()),
                      fmt::to_string(questions.size()));
  const QueryScene::Asked asked = scene.prepare(filter);
  run_in_pieces(jobs, std::int64_t(questions.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      lists[std::size_t(i)].clear();
      (scene.*ask)(questions[std::size_t(i)], asked, lists[std::size_t(i)]);
    }
  });
}

}  // namespace

std::optional<QueryHit> Manager::cast_ray(const Ray& ray, const QueryFilter& filter) const {
  const Sweep sweep = sweep_of(ray);
  return impl_->queries.first(sweep, impl_->queries.prepare(filter));
}

std::optional<QueryHit> Manager::sweep_sphere(const SphereSweep& sphere, const QueryFilter& filter) const {
  const Sweep sweep = sweep_of(sphere);
  return impl_->queries.first(sweep, impl_->queries.prepare(filter));
}

void Manager::cast_rays(std::span<const Ray> rays, std::span<std::optional<QueryHit>> firsts,
                        const QueryFilter& filter) const {
  find_firsts(impl_->queries, *impl_->jobs, each_of(rays, [](const Ray& ray) { return sweep_of(ray); }),
              firsts, filter);
}

void Manager::sweep_spheres(std::span<const SphereSweep> spheres, std::span<std::optional<QueryHit>> firsts,
                            const QueryFilter& filter) const {
  find_firsts(impl_->queries, *impl_->jobs,
              each_of(spheres, [](const SphereSweep& sphere) { return sweep_of(sphere); }), firsts, filter);
}

void Manager::cast_rays_through(std::span<const Ray> rays, std::span<std::vector<QueryHit>> hits,
                                const QueryFilter& filter) const {
  const std::vector<Sweep> sweeps = each_of(rays, [](const Ray& ray) { return sweep_of(ray); });
  find_lists(impl_->queries, *impl_->jobs, std::span<const Sweep>(sweeps), hits, filter, &QueryScene::all);
}

void Manager::sweep_spheres_through(std::span<const SphereSweep> spheres,
                                    std::span<std::vector<QueryHit>> hits, const QueryFilter& filter) const {
  const std::vector<Sweep> sweeps =
      each_of(spheres, [](const SphereSweep& sphere) { return sweep_of(sphere); });
  find_lists(impl_->queries, *impl_->jobs, std::span<const Sweep>(sweeps), hits, filter, &QueryScene::all);
}

void Manager::overlap_spheres(std::span<const SphereVolume> spheres, std::span<std::vector<QueryHit>> hits,
                              const QueryFilter& filter) const {
  const std::vector<Volume> volumes =
      each_of(spheres, [](const SphereVolume& sphere) { return volume_of(sphere); });
  find_lists(impl_->queries, *impl_->jobs, std::span<const Volume>(volumes), hits, filter,
             &QueryScene::overlaps);
}

void Manager::overlap_boxes(std::span<const BoxVolume> boxes, std::span<std::vector<QueryHit>> hits,
                            const QueryFilter& filter) const {
  const std::vector<Volume> volumes = each_of(boxes, [](const BoxVolume& box) { return volume_of(box); });
  find_lists(impl_->queries, *impl_->jobs, std::span<const Volume>(volumes), hits, filter,
             &QueryScene::overlaps);
}

}  // namespace lodestone
