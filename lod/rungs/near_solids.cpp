#include "lod/rungs/near_solids.h"

#include "lod/contact/solid_search.h"

namespace lodestone {

bool meets_solids(const BodyProperties& own) { return !own.kinematic && meets_ground(own); }

void NearSolids::Found::append(std::int32_t slot, std::span<const SolidContact> of_it,
                               std::span<const HalfSpace> below) {
  contacts.insert(contacts.end(), of_it.begin(), of_it.end());
  const auto begin = std::int32_t(faces.faces.size());
  faces.faces.insert(faces.faces.end(), below.begin(), below.end());
  faces.run[std::size_t(slot)] = {begin, std::int32_t(faces.faces.size())};
}

void NearSolids::find(const ContactScene& scene, std::span<const std::int32_t> bodies, double after,
                      double time, SolidSearch search) {
  if (!ground_.has_parts()) return found_.begin(0);
  found_.begin(scene.bodies.size());  // who is woken last is asked about, too
  const auto count = std::int64_t(bodies.size());
  by_rays_ = make_ground(scene, bodies, time);
  find_on_ground(ground_, jobs_, by_rays_, count, pieces_, [&](std::int64_t i, Piece& piece) {
    find_of(scene, bodies[std::size_t(i)], after, time, search, piece);
  });
  for (std::int64_t i = 0; i < count; ++i) {
    const Piece& piece = pieces_[std::size_t(i / kBodiesOfAPiece)];
    const auto place = std::size_t(i % kBodiesOfAPiece);
    const auto [contact, face] = place > 0 ? piece.ends[place - 1] : std::pair<std::size_t, std::size_t>();
    const auto [contacts_end, faces_end] = piece.ends[place];
    found_.append(bodies[std::size_t(i)], std::span(piece.contacts).subspan(contact, contacts_end - contact),
                  std::span(piece.faces).subspan(face, faces_end - face));
  }
}

// Who touched nothing has moved alone since then: to find a contact of his now would move him once more.
void NearSolids::find_more(const ContactScene& scene, std::span<const std::int32_t> bodies,
                           std::span<const std::int32_t> known, double after, double time) {
  if (!ground_.has_parts()) return;
  std::swap(found_, known_);
  found_.begin(scene.bodies.size());
  place_of_known_.resize(scene.bodies.size(), -1);
  const std::span<const SolidContact> all = known_.contacts;
  std::size_t place = 0;
  const auto is_of = [&](std::size_t i, std::int32_t slot) { return i < all.size() && all[i].slot == slot; };
  for (const std::int32_t slot : known)
    for (place_of_known_[std::size_t(slot)] = std::int32_t(place); is_of(place, slot);) ++place;
  for (const std::int32_t slot : bodies) {
    if (const std::int32_t first = place_of_known_[std::size_t(slot)]; first >= 0) {
      auto end = std::size_t(first);
      while (is_of(end, slot)) ++end;
      found_.append(slot, all.subspan(std::size_t(first), end - std::size_t(first)), known_.faces.of(slot));
      continue;
    }
    more_.clear();
    find_of(scene, slot, after, time, SolidSearch::all, more_);
    found_.append(slot, more_.contacts, more_.faces);
  }
  for (const std::int32_t slot : known) place_of_known_[std::size_t(slot)] = -1;
}

// All that they may come near, whatever strikes them in that time. Whether some of it is known by rays.
bool NearSolids::make_ground(const ContactScene& scene, std::span<const std::int32_t> bodies,
                             double time) const {
  constexpr double kStruck = 3.0;  // over its reach if nothing strikes it
  bool by_rays = false;
  for (const std::int32_t slot : bodies) {
    const StatisticalBody& body = scene.bodies[std::size_t(slot)];
    if (!meets_solids(scene.world.properties_of(body.owner))) continue;
    const Shape& shape = *scene.kind_of(body).shape;
    const double way = seeker_of(body, shape, slot, time).way +
                       scene.acceleration(Participant::statistical(std::size_t(slot))).norm() * time * time;
    by_rays |= ground_.make_near(body.position, kStruck * (shape.radius + way));
  }
  return by_rays;
}

void NearSolids::find_of(const ContactScene& scene, std::int32_t slot, double after, double time,
                         SolidSearch search, Piece& piece) const {
  StatisticalBody& body = scene.bodies[std::size_t(slot)];
  const std::size_t before = piece.contacts.size();
  if (const BodyProperties& own = scene.world.properties_of(body.owner); meets_solids(own)) {
    const MetGround ground(ground_, own);
    const BodyKind& kind = scene.kind_of(body);
    StatisticalBody seeker = body;
    if (search == SolidSearch::one_of_a_part)  // of the whole step
      seeker.velocity += time * scene.gravity(Participant::statistical(std::size_t(slot)));
    if (body.is_sphere())
      find_sphere_contacts(seeker, kind, slot, ground, after, time, piece.contacts, piece.faces);
    else
      find_solid_contacts(seeker, kind, slot, ground, after, time, piece.contacts, piece.faces, search);
  }
  piece.ends.emplace_back(piece.contacts.size(), piece.faces.size());
  body.on_solid = piece.contacts.size() > before;
}

}  // namespace lodestone
