// Settling clips out of settling trials.
#pragma once

#include <span>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

struct SettlingRecord;

/// Makes `count` clips of the records that choose_clips picks, with their entries. The signature's rest poses
/// must be there.
void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature);

}  // namespace lodestone
