/// core/contact/surface_probe_kernel.h: the vector kernel of surface_probe: all points of one part of a shell against the records of a
///   window.
///   Frame  coordinates relative to the window's corner, for the accuracy of single precision.   Units  voxel edges; stored steps where
///          stated.
#pragma once

#include <cstdint>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// Input of the kernel of every target.
struct ProbeJob {
  const std::int8_t* records8;  // channels of records: distance, nx, ny, nz, and so on; exactly one of the two is set
  const std::int16_t* records16;
  std::int32_t row, slab;  // offsets [records] between rows and between slabs
  float lo[3], hi[3];      // [voxels] points p with lo <= p < hi have eight known records
  float linear[9];         // [voxels/m] of window coordinates from tool frame, column by column
  float offset[3];         // [voxels] of window coordinates
  float metric[12];    // [-] four per axis: 0, and the weights of the normal's changes in the correction for curvature, in stored steps
  bool straight;       // per axis only the weight of its own component is not 0
  float steps_a_edge;  // [1/voxel] stored distance steps per voxel edge
  float normal_scale;  // [-] length of one stored step of a normal
  float look_ahead;  // [voxels] largest distance of a hit, in voxel edges
  float slack;       // [voxels] largest distance of a point from the centre of its voxel, in voxel edges
};

/// Appends the hits, in the order of the part's points, and their blocks. `hits.nearest` becomes the least stored distance read, if that is
/// less.
void probe_points(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) noexcept;

}  // namespace burrhole
