#include "lod/tables/tables_traffic.h"

namespace lodestone {
namespace {

template <class... Arrays>
double row(const Arrays&... arrays) {
  return (0.0 + ... + double(sizeof arrays[0]));
}

double of_start(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  const SphereStep& s = t.step;
  const double read = row(b.x, b.y, b.z, b.vx, b.vy, b.vz, b.lx, b.ly, b.lz, b.qw, b.qx, b.qy, b.qz, b.radius,
                          b.kind, b.pose, b.motion, b.since_crowded);
  return read + row(b.radius, s.reach, s.p, s.u, s.s, s.gap, s.on_ground, s.plane) +
         (t.ground ? 0.0 : row(s.a, s.d));
}

// The bounds; the cells; how many lie in each; and into them.
double of_cells(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  const double ball = row(b.x, b.y, b.z), cell = sizeof(std::uint32_t), kept = 5.0 * sizeof(float);
  return (ball + row(t.step.reach)) + (ball + cell) + cell + (cell + ball + row(t.step.reach) + kept) +
         3.0 * cell;  // and the cells themselves, as many as bodies
}

double of_search(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  return 5.0 * sizeof(float) + row(b.x, b.y, b.z, b.vx, b.vy, b.vz, b.radius, b.kind);
}

// Brings the impulses that are known from the last step.
double of_begin(const TablesTraffic& t) {
  return row(t.spheres.kind, t.spheres.owner, t.spheres.known_begin, t.spheres.known_count) +
         2.0 * row(t.step.p);
}

double of_sort_ground(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  const SphereStep& s = t.step;
  return row(b.vx, b.vy, b.vz, b.held, b.kind, b.motion, s.plane, s.s, s.a, s.d) +
         2.0 * row(s.p, s.on_ground);
}

// A round of contacts, and then of the ground's.
double of_sweep(const TablesTraffic& t) {
  const SphereStep& s = t.step;
  const double contacts = row(t.spheres.kind, s.p) + 2.0 * row(s.a);
  return contacts + 2.0 * row(s.p, s.a) + (t.ground ? row(s.gap, s.plane, s.on_ground) : 0.0);
}

double of_last_sweep(const TablesTraffic& t) {
  return row(t.spheres.kind, t.spheres.radius, t.step.p) + 2.0 * row(t.step.u, t.step.a, t.step.s, t.step.d);
}

double of_remember(const TablesTraffic& t) {
  return 2.0 * row(t.spheres.known_count) + row(t.spheres.owner, t.spheres.known_begin);
}

double of_finish(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  const SphereStep& s = t.step;
  const double moved = 2.0 * row(b.x, b.y, b.z, b.vx, b.vy, b.vz, b.lx, b.ly, b.lz, b.qw, b.qx, b.qy, b.qz,
                                 b.twice_energy, b.motion, b.since_crowded, b.crowded_for);
  const double rows = row(b.kind, s.p, s.a, s.s, s.d) + 2.0 * row(s.on_ground);
  return moved + rows + (t.ground ? row(b.pose, b.radius, b.held, s.gap, s.plane, s.a, s.s, s.d) : 0.0);
}

double of_rest(const TablesTraffic& t) {
  const Spheres& b = t.spheres;
  return row(b.vx, b.vy, b.vz, b.lx, b.ly, b.lz, b.qw, b.qx, b.qy, b.qz, b.kind, b.since_crowded, t.step.d,
             t.step.p) +
         2.0 * row(b.quiet);
}

}  // namespace

double count_bytes_moved(const TablesTraffic& t) {
  double of_body = of_start(t) + of_finish(t);
  if (t.pair_phase) of_body += of_cells(t) + of_search(t);
  if (t.ground) of_body += of_sort_ground(t);
  if (t.rest) of_body += of_rest(t);
  double of_contacts = 0.0;
  if (t.contacts.count() > 0) {
    of_body += of_begin(t) + (t.sweeps - 1) * of_sweep(t) + of_last_sweep(t) + of_remember(t);
    // Found, begun and swept; known contacts are read, and written anew.
    of_contacts = double(t.contacts.count()) *
                  ((2.0 + t.sweeps) * double(t.contacts.bytes_each()) + 2.0 * sizeof(KnownContact));
  }
  return of_body * double(t.spheres.awake) + of_contacts;
}

}  // namespace lodestone
