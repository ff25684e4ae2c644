#include "reference/ode/piece_contacts.h"

#include <algorithm>

#include "reference/hull/hull_manifold.h"

namespace lodestone {
namespace {

constexpr double kRestingDepth = 2e-5;  // × radius
constexpr double kWithin = 1e-5;        // × radius: as deep as this in a piece is inside it

RigidState state_of(const Pieces& body, const Piece& piece) {
  return {.position = body.state.position + body.state.orientation * piece.center,
          .orientation = body.state.orientation};
}

bool is_within(const Hull& hull, const Vec3& point, double margin) {
  for (int i = 0; i < int(hull.faces.size()); ++i)
    if (hull.face_normals[i].dot(point - hull.vertices[hull.faces[i][0]]) > -margin) return false;
  return true;
}

/// Whether `point` (world), on the surface of `own`, is inside another piece of the body.
bool is_internal(const Pieces& body, const Piece& own, const Vec3& point) {
  return std::ranges::any_of(body.pieces, [&](const Piece& piece) {
    if (&piece == &own) return false;
    const RigidState state = state_of(body, piece);
    return is_within(piece.shape->hull, state.orientation.conjugate() * (point - state.position),
                     kWithin * piece.shape->radius);
  });
}

void find_contacts(const Pieces& first, const Piece& a, const Pieces& second, const Piece& b,
                   std::vector<ContactPoint>& contacts) {
  const RigidState of_a = state_of(first, a), of_b = state_of(second, b);
  if ((of_a.position - of_b.position).norm() > a.shape->radius + b.shape->radius) return;
  const auto overlap = find_hull_overlap(*a.shape, of_a, *b.shape, of_b);
  if (!overlap) return;
  const std::size_t before = contacts.size();
  find_hull_manifold(*a.shape, of_a, *b.shape, of_b, *overlap, contacts);
  const auto internal = [&](const ContactPoint& contact) {
    const Vec3 half = 0.5 * contact.depth * contact.normal;
    return is_internal(first, a, contact.point - half) || is_internal(second, b, contact.point + half);
  };
  contacts.erase(std::remove_if(contacts.begin() + std::ptrdiff_t(before), contacts.end(), internal),
                 contacts.end());
  const double resting = kRestingDepth * std::min(a.shape->radius, b.shape->radius);
  for (std::size_t i = before; i < contacts.size(); ++i) contacts[i].depth -= resting;
}

}  // namespace

void find_contacts_of_pieces(const Pieces& first, const Pieces& second, std::vector<ContactPoint>& contacts) {
  for (const Piece& a : first.pieces)
    for (const Piece& b : second.pieces) find_contacts(first, a, second, b, contacts);
}

}  // namespace lodestone
