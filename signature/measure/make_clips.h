// Settling clips out of settling trials.
#pragma once

#include <span>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

struct SettlingRecord;

/// Makes clips of the first `count` records that rest, with their entries.
void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature);

}  // namespace lodestone
