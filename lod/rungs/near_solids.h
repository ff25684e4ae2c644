// Stage 3d: which parts of the ground, but for planes, the bodies there may touch. Looked for on all threads.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/solid_contacts.h"
#include "lod/ground/ground_jobs.h"

namespace lodestone {

/// Whether boxes, meshes and other parts of the ground stop it.
bool meets_solids(const BodyProperties& own);

class NearSolids {
 public:
  NearSolids(const Ground& ground, JobRunner jobs) : ground_(ground), jobs_(std::move(jobs)) {}

  /// Of `bodies` (slots), each of which is told whether there are any, what may close within `time` s,
  /// `after` so many of the step.
  void find(const ContactScene& scene, std::span<const std::int32_t> bodies, double after, double time,
            SolidSearch search);
  /// Of `bodies`, more than the `known` ones of whom they were found. What was found of these holds.
  void find_more(const ContactScene& scene, std::span<const std::int32_t> bodies,
                 std::span<const std::int32_t> known, double after, double time);

  /// Calls body(begin, end) for pieces of [0, count) of the bodies of whom these were last found, who move
  /// among them: on all threads, but where only this one can ask for the ground.
  template <class Body>
  void run_among(std::int64_t count, std::int64_t grain, const Body& body) const {
    run_on_ground(ground_, jobs_, by_rays_, count, grain, body);
  }

  std::span<const SolidContact> contacts() const { return found_.contacts; }  ///< body by body
  const FacesBelow& faces() const { return found_.faces; }

 private:
  struct Found {
    std::vector<SolidContact> contacts;
    FacesBelow faces;
    void begin(std::size_t slots) { contacts.clear(), faces.faces.clear(), faces.run.assign(slots, {}); }
    void append(std::int32_t slot, std::span<const SolidContact> of_it, std::span<const HalfSpace> below);
  };
  /// Of some bodies, one after the other: how many there are up to the end of each.
  struct Piece {
    std::vector<SolidContact> contacts;
    std::vector<HalfSpace> faces;
    std::vector<std::pair<std::size_t, std::size_t>> ends;
    void clear() { contacts.clear(), faces.clear(), ends.clear(); }
  };
  bool make_ground(const ContactScene& scene, std::span<const std::int32_t> bodies, double time) const;
  void find_of(const ContactScene& scene, std::int32_t slot, double after, double time, SolidSearch search,
               Piece& piece) const;

  const Ground& ground_;
  JobRunner jobs_;
  bool by_rays_ = false;
  Found found_, known_;
  std::vector<Piece> pieces_;
  Piece more_;
  std::vector<std::int32_t> place_of_known_;  // of each slot in known_.contacts, −1 else: but while more
                                              // bodies are added
};

}  // namespace lodestone
