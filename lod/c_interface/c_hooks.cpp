// What a caller gets to see: log, profile, drawing.
#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

namespace {

DrawSettings drawing_of(const lodestone_draw_settings* given) {
  if (!given) return {};
  const lodestone_draw_settings& s = *given;
  return {.bodies = s.bodies,
          .contacts = s.contacts,
          .bounds = s.bounds,
          .colors = {color(s.colors[0]), color(s.colors[1]), color(s.colors[2])},
          .contact_color = color(s.contact_color),
          .bounds_color = color(s.bounds_color),
          .normal_length = s.normal_length};
}

}  // namespace

lodestone_result lodestone_set_log(lodestone_manager* manager,
                                   void (*log)(void* context, lodestone_log_level level, const char* text),
                                   void* context) {
  return guarded([&] {
    if (log)
      of(manager).set_log([log, context](LogLevel level, std::string_view text) {
        log(context, lodestone_log_level(level), std::string(text).c_str());
      });
    else
      of(manager).set_log({});
  });
}

lodestone_result lodestone_set_profile(lodestone_manager* manager,
                                       void (*begin)(void* context, const char* zone),
                                       void (*end)(void* context, const char* zone), void* context) {
  return guarded([&] {
    ProfileHooks hooks;  // zones' names are literals, so that data() ends in a zero
    if (begin) hooks.begin = [begin, context](std::string_view zone) { begin(context, zone.data()); };
    if (end) hooks.end = [end, context](std::string_view zone) { end(context, zone.data()); };
    of(manager).set_profile(std::move(hooks));
  });
}

lodestone_draw_settings lodestone_default_draw_settings(void) {
  const DrawSettings s;
  return {s.bodies,
          s.contacts,
          s.bounds,
          {color(s.colors[0]), color(s.colors[1]), color(s.colors[2])},
          color(s.contact_color),
          color(s.bounds_color),
          s.normal_length};
}

lodestone_result lodestone_draw(const lodestone_manager* manager,
                                void (*line)(void* context, lodestone_vec3 from, lodestone_vec3 to,
                                             lodestone_color color),
                                void (*point)(void* context, lodestone_vec3 at, lodestone_color color),
                                void* context, const lodestone_draw_settings* settings) {
  return guarded([&] {
    DebugDrawer drawer;
    if (line)
      drawer.line = [&](const Vec3& from, const Vec3& to, DebugColor of_line) {
        line(context, vec3(from), vec3(to), color(of_line));
      };
    if (point)
      drawer.point = [&](const Vec3& at, DebugColor of_point) { point(context, vec3(at), color(of_point)); };
    of(manager).draw(drawer, drawing_of(settings));
  });
}
