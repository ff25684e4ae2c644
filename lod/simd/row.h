// Four floats side by side, which any processor adds at once: what a contact reads of a body and adds to it.
#pragma once

#include "lod/simd/wide_loop.h"

namespace lodestone::lane {

/// As it lies in memory.
struct alignas(16) Row {
  float x = 0.0f, y = 0.0f, z = 0.0f, w = 0.0f;
};

/// As it is computed with.
#if defined(__GNUC__)
using RowLanes = float __attribute__((vector_size(16)));
LODESTONE_INLINE RowLanes lanes_of(const Row& row) { return __builtin_bit_cast(RowLanes, row); }
LODESTONE_INLINE Row row_of(RowLanes lanes) { return __builtin_bit_cast(Row, lanes); }
/// (1, 1, 1, w).
LODESTONE_INLINE RowLanes only_w(RowLanes lanes) {
  return __builtin_shufflevector(lanes, RowLanes{1.0f, 1.0f, 1.0f, 1.0f}, 4, 4, 4, 3);
}
#else
using RowLanes = Row;
LODESTONE_INLINE RowLanes operator+(RowLanes a, RowLanes b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}
LODESTONE_INLINE RowLanes operator-(RowLanes a, RowLanes b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
}
LODESTONE_INLINE RowLanes operator*(RowLanes a, RowLanes b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z, a.w * b.w};
}
LODESTONE_INLINE RowLanes operator*(float s, RowLanes a) { return {s * a.x, s * a.y, s * a.z, s * a.w}; }
LODESTONE_INLINE RowLanes lanes_of(const Row& row) { return row; }
LODESTONE_INLINE Row row_of(RowLanes lanes) { return lanes; }
LODESTONE_INLINE RowLanes only_w(RowLanes lanes) { return {1.0f, 1.0f, 1.0f, lanes.w}; }
#endif

LODESTONE_INLINE void add_to(Row& row, RowLanes more) { row = row_of(lanes_of(row) + more); }

}  // namespace lodestone::lane
