/// core/contact/surface_probe_kernel.h: the vector part of surface_probe: all points of one part of a shell against the records of a
///   window.
///   Frame  coordinates relative to the window's corner, so that single precision is enough.   Units  voxel edges, stored steps where said.
#pragma once

#include <cstdint>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// What every target's kernel is told.
struct ProbeJob {
  const std::int8_t* records8;  // channels of records: distance, nx, ny, nz, and so on; one of the two
  const std::int16_t* records16;
  std::int32_t row, slab;  // records
  float lo[3], hi[3];      // points p with lo <= p < hi have eight known records
  float linear[9];         // column by column
  float offset[3];
  float metric[12];    // four an axis: 0 and the weights of the normal's changes along it in what bends the distance, in stored steps
  bool straight;       // of an axis only that of its own component is not 0
  float steps_a_edge;  // of the stored distance
  float normal_scale;
  float look_ahead;  // [voxel edges]
  float slack;       // [voxel edges] a voxel's centre is at most this far from any point of its cell
};

/// Appends the hits, in the order of the part's points, and their blocks. `hits.nearest` becomes the least stored distance that was read,
/// if that is less.
void probe_points(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) noexcept;

}  // namespace burrhole
