/// volumes/phantom/phantom.h: generated bone and its closed form.
///   Frame      bone frame.   Units  SI.   Errors  see make_phantom().   Thread  any.
///   Occupancy  0.5 - d / (2 w) clamped to 0..1: d the true distance, w = pitch * (|nx| + |ny| + |nz|), n the normal there. All corners of
///   a
///              cell that the surface passes lie within w of it and are not clamped, so trilinear interpolation places the 0.5 level of a
///              plane of any tilt exactly on the plane. Curved surfaces deviate by pitch^2 / (4 radius), edges by a fraction of a voxel.
///              (A ramp of one voxel is sharper, but deviates by up to 0.09 voxel even on a level plane.)
///   Hardness   that of the material wherever occupancy is > 0, not reduced in partial voxels; 0 elsewhere.
///   Soft       skull_patch only, else empty; the same ramp: 1 - occupancy across the inner surface of the bone, 0 above the bone.
///   Labels     by the centre of the voxel.
///   Source     own derivation.
#pragma once

#include "volumes/phantom/phantom_spec.h"
#include "volumes/phantom/truth.h"

namespace burrhole {

struct Phantom {
  PhantomSpec spec;
  Truth truth;
  DenseBone bone;
};

/// Generates the bone. The same spec gives the same bits on every machine. @returns the first error of validate(spec), with all errors in
/// its message, or ErrorCode::unavailable if the memory for the grid cannot be allocated. About 13 bytes and 50 ns per voxel.
[[nodiscard]] Result<Phantom> make_phantom(const PhantomSpec& spec);

}  // namespace burrhole
