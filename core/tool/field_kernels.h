/// core/tool/field_kernels.h: SIMD interpolation of a cutting field at lists of places.
///   Frame  nodes of the cutting field.   Units  as each member states.   Errors  none.   Thread  any.
///   Bits  equal to FieldSampler::distance() at every SIMD level.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/tool/cutting_field.h"

namespace burrhole {

/// Lists are read and written in whole vectors: they need this many entries beyond the last one.
inline constexpr std::size_t kFieldPad = 16;

/// A cutting field. Valid while the field is.
struct FieldJob {
  const float* distance;   ///< [m] of the nodes
  const float* factor;     ///< [1/rev] of the nodes
  std::int32_t row, slab;  ///< [nodes] offsets of a row and of a slab
  float end[3];            ///< [nodes] last node of each axis
  float margin, pitch;     ///< [m] of the field
  bool revolved;           ///< the table is one plane: x the radius
};

[[nodiscard]] FieldJob field_job(const CuttingField& field) noexcept;

/// Places as arrays.
struct PlaceList {
  std::size_t count;
  const float *x, *y, *z;  ///< [nodes]
};

/// Writes the distance [m] at each place; outside the table a lower bound that is at least the margin.
void sample_field(const FieldJob& job, const PlaceList& places, float* out) noexcept;

}  // namespace burrhole
