// Where a manager has its signatures from, and when.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "reference/material.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Supplies the signature of a shape under a contact law, when a first statistical body needs it.
using SignatureFunction = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&)>;

/// When a signature is had that a body needs for the first time.
enum class SignatureTiming : std::uint8_t {
  /// in_step from a source that was given, in_background where it is measured or found in the cache.
  automatic,
  in_step,  ///< the step waits for it: the same levels in every run
  /// By threads of the lowest priority; until it is there the body is at `support` without settling clips, or
  /// full where the policy wants that.
  in_background,
};

}  // namespace lodestone
