/// core/contact/surface_probe_kernel.h: SIMD kernel of surface_probe: looks up distance and normal of the bone's surface at all points of one
///   part of a shell.
///   Frame  index coordinates relative to the window's corner, for the accuracy of single precision.
///   Units  voxel edges, or quanta: the smallest stored difference of a distance or a normal.   Errors  none.   Thread  contact.
#pragma once

#include <cstdint>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// Input of the kernel, the same for every instruction set.
struct ProbeJob {
  const std::int8_t* records8;  // four values per record: distance (positive outside bone), nx, ny, nz; exactly one of the two is set
  const std::int16_t* records16;
  std::int32_t row, slab;  // [records] stride of rows (j) and of slabs (k)
  float lo[3], hi[3];      // [voxels] all eight voxels around a point p with lo <= p < hi have valid records
  float linear[9];         // [voxels/m] linear part of the map from tool frame to window coordinates, column-major
  float offset[3];         // [voxels] its offset
  // For each index axis a: {g, wx, wy, wz}. w.n [distance quanta] is -1/2 of the slope of the distance along a where the stored normal is n.
  // The first two g [1/distance quanta] say how much of a convex edge a cell holds: for axes with w.dn < 0 the larger of -g0 w.dn - 2 and
  // g1 |dd + w.(n0 + n1)| - 1, between 0 and 1; dn and dd are the changes of normal and distance along a, n0 and n1 the normals at both
  // sides.
  float metric[12];            // g, and w [-] distance quanta per normal quantum
  float cut_lo[3], cut_hi[3];  // [voxels] cells from cut_lo, before cut_hi, may hold a cut surface
  bool any_cut;                // there are such cells
  bool diagonal;               // only component a of w is not 0: grid axes parallel to those of the bone frame
  float steps_per_edge;        // [quanta] of distance per voxel edge
  float normal_scale;          // [-] length of one quantum of a normal
  float look_ahead;            // [voxel edges] points farther from the surface are no hits
  float slack;  // [voxel edges] largest difference of distance between a point and the centre of its voxel, rounding included
};

/// Appends the hits, in the order of the part's points, and the bounds of each block of hits (HitBlocks). Sets hits.nearest to the smallest
/// stored distance read, if that is smaller.
void probe_points(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) noexcept;

}  // namespace burrhole
