// Where a manager gets its signatures, and when. A signature is what the statistical rungs know of a shape
// under a contact law.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "reference/material.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Supplies the signature of a shape under a contact law, once, when the first body needs it. It is called on
/// the thread that steps or restores, or in the background by one other thread. One that was measured for
/// another shape (scaled copies are the same shape) is an InputError of the step. Null: there is none; the
/// policy then keeps such bodies off `tables`, at `support` they have no settling clips, and a step throws
/// InputError if the caller, or ManagerSettings::model, wants one at `tables`.
using SignatureFunction = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&)>;

/// When a manager gets a signature that a body needs for the first time.
enum class SignatureTiming : std::uint8_t {
  /// in_step if ManagerSettings::signatures was given, in_background if signatures are measured or found in
  /// the cache.
  automatic,
  in_step,  ///< the step waits for it, so that bodies have the same levels in every run
  /// Threads of the lowest priority get it. Until it is there the body is at `support` without settling
  /// clips, or full if the policy or the caller wants that.
  in_background,
};

}  // namespace lodestone
