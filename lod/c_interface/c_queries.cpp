// What a step did to bodies, and what is where.
#include <optional>

#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

namespace {

QueryFilter filter_of(const lodestone_query_filter* filter) {
  if (!filter) return {};
  return {.categories = filter->categories,
          .bodies = filter->bodies,
          .ground = filter->ground,
          .callers = filter->callers,
          .except = body(filter->except)};
}

Ray ray_of(const lodestone_ray& ray) { return {vec3(ray.from), vec3(ray.direction), ray.length}; }
SphereSweep sweep_of(const lodestone_ray& ray) { return {ray_of(ray), ray.radius}; }
bool is_thin(const lodestone_ray& ray) { return ray.radius == 0.0; }
bool is_thick(const lodestone_ray& ray) { return !is_thin(ray); }
bool is_sphere(const lodestone_volume& volume) {
  return volume.sides.x == 0.0 && volume.sides.y == 0.0 && volume.sides.z == 0.0;
}
lodestone_hit hit_of(const QueryHit& hit) {
  return {side(hit.who), vec3(hit.point), vec3(hit.normal), hit.distance};
}

// Asks about those of `all` that `select` chooses, as `make` has them, and gives each answer to `take` with
// its place among all.
template <class Question, class Answer, class Given, class Select, class Make, class Ask, class Take>
void ask_some(std::span<const Given> all, const Select& select, const Make& make, const Ask& ask,
              const Take& take) {
  std::vector<Question> questions;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (select(all[i])) questions.push_back(make(all[i])), places.push_back(i);
  std::vector<Answer> answers(questions.size());
  if (!questions.empty()) ask(questions, answers);
  for (std::size_t i = 0; i < places.size(); ++i) take(places[i], answers[i]);
}

void tell(std::span<const std::vector<QueryHit>> hits,
          void (*found)(void* context, std::size_t question, const lodestone_hit* hit), void* context) {
  for (std::size_t i = 0; i < hits.size(); ++i)
    for (const QueryHit& hit : hits[i]) {
      const lodestone_hit as_c = hit_of(hit);
      found(context, i, &as_c);
    }
}

}  // namespace

lodestone_result lodestone_rung_changes(lodestone_manager* manager, const lodestone_rung_change** changes,
                                        size_t* count) {
  return guarded([&] {
    const std::span<const RungChange> found = of(manager).rung_changes();
    manager->rung_changes.clear();
    for (const RungChange& change : found)
      manager->rung_changes.push_back(
          {body(change.body), lodestone_rung(change.from), lodestone_rung(change.to)});
    give(changes, static_cast<const lodestone_rung_change*>(manager->rung_changes.data()));
    give(count, found.size());
  });
}

lodestone_result lodestone_contact_events(lodestone_manager* manager, const lodestone_contact_event** events,
                                          size_t* count) {
  return guarded([&] {
    const std::span<const ContactEvent> found = of(manager).contact_events();
    manager->contact_events.clear();
    for (const ContactEvent& event : found)
      manager->contact_events.push_back({lodestone_contact_phase(event.phase), side(event.first),
                                         side(event.second), vec3(event.point), vec3(event.normal),
                                         event.impulse, event.speed});
    give(events, static_cast<const lodestone_contact_event*>(manager->contact_events.data()));
    give(count, found.size());
  });
}

lodestone_query_filter lodestone_default_filter(void) {
  const QueryFilter filter;
  return {filter.categories, filter.bodies, filter.ground, filter.callers, body(filter.except)};
}

lodestone_result lodestone_cast_rays(const lodestone_manager* manager, const lodestone_ray* rays,
                                     size_t count, const lodestone_query_filter* filter, bool* met,
                                     lodestone_hit* hits) {
  return guarded([&] {
    const Manager& asked = of(manager);
    const std::span<const lodestone_ray> all = list(rays, count, "rays");
    std::vector<std::optional<QueryHit>> firsts(count);
    const QueryFilter passes = filter_of(filter);
    const auto take = [&](std::size_t place, const std::optional<QueryHit>& hit) { firsts[place] = hit; };
    ask_some<Ray, std::optional<QueryHit>>(
        all, is_thin, ray_of,
        [&](const auto& questions, auto& answers) { asked.cast_rays(questions, answers, passes); }, take);
    ask_some<SphereSweep, std::optional<QueryHit>>(
        all, is_thick, sweep_of,
        [&](const auto& questions, auto& answers) { asked.sweep_spheres(questions, answers, passes); }, take);
    for (std::size_t i = 0; i < count; ++i) {
      if (met) met[i] = firsts[i].has_value();
      if (hits && firsts[i]) hits[i] = hit_of(*firsts[i]);
    }
  });
}

lodestone_result lodestone_cast_rays_through(const lodestone_manager* manager, const lodestone_ray* rays,
                                             size_t count, const lodestone_query_filter* filter,
                                             void (*found)(void* context, size_t ray,
                                                           const lodestone_hit* hit),
                                             void* context) {
  return guarded([&] {
    const Manager& asked = of(manager);
    need(found, "found");
    const std::span<const lodestone_ray> all = list(rays, count, "rays");
    std::vector<std::vector<QueryHit>> hits(count);
    const QueryFilter passes = filter_of(filter);
    const auto take = [&](std::size_t place, std::vector<QueryHit>& of_one) {
      hits[place] = std::move(of_one);
    };
    ask_some<Ray, std::vector<QueryHit>>(
        all, is_thin, ray_of,
        [&](const auto& questions, auto& answers) { asked.cast_rays_through(questions, answers, passes); },
        take);
    ask_some<SphereSweep, std::vector<QueryHit>>(
        all, is_thick, sweep_of,
        [&](const auto& questions, auto& answers) {
          asked.sweep_spheres_through(questions, answers, passes);
        },
        take);
    tell(hits, found, context);
  });
}

lodestone_result lodestone_overlap(const lodestone_manager* manager, const lodestone_volume* volumes,
                                   size_t count, const lodestone_query_filter* filter,
                                   void (*found)(void* context, size_t volume, const lodestone_hit* hit),
                                   void* context) {
  return guarded([&] {
    const Manager& asked = of(manager);
    need(found, "found");
    const std::span<const lodestone_volume> all = list(volumes, count, "volumes");
    std::vector<std::vector<QueryHit>> hits(count);
    const QueryFilter passes = filter_of(filter);
    const auto take = [&](std::size_t place, std::vector<QueryHit>& of_one) {
      hits[place] = std::move(of_one);
    };
    ask_some<SphereVolume, std::vector<QueryHit>>(
        all, is_sphere,
        [](const lodestone_volume& v) {
          return SphereVolume{vec3(v.position), v.radius};
        },
        [&](const auto& questions, auto& answers) { asked.overlap_spheres(questions, answers, passes); },
        take);
    ask_some<BoxVolume, std::vector<QueryHit>>(
        all, [](const lodestone_volume& v) { return !is_sphere(v); },
        [](const lodestone_volume& v) {
          return BoxVolume{vec3(v.sides), vec3(v.position), quat(v.orientation)};
        },
        [&](const auto& questions, auto& answers) { asked.overlap_boxes(questions, answers, passes); }, take);
    tell(hits, found, context);
  });
}
