/// volumes/phantom/phantom.h: generated bone beside its closed form.
///   Occupancy  0.5 - d / (2 w) clamped to 0..1: d the true distance, w = pitch * (|nx| + |ny| + |nz|), n the normal there. A cell that the
///              surface passes has its corners within w of it, so none is clamped, and trilinear interpolation puts the 0.5 level of a
///              plane of any tilt exactly on it; curved surfaces are off by pitch^2 / (4 radius), edges by a fraction of a voxel.
///              (A ramp of one voxel looks crisper and is off by up to 0.09 voxel even on a level plane.)
///   Hardness   the material's wherever occupancy is above 0, not thinned by the partial voxel; 0 elsewhere.
///   Soft       skull_patch only, else empty; ramped alike: 1 - occupancy across the bone's inner surface, 0 above the bone.
///   Labels     by the voxel's centre.
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

/// Generates the bone. Same spec, same bits, on every machine. @returns the first fault of validate(spec), all faults in its message, or
/// ErrorCode::unavailable if the memory for the grid cannot be had. About 13 bytes and 50 ns a voxel.
[[nodiscard]] Result<Phantom> make_phantom(const PhantomSpec& spec);

}  // namespace burrhole
