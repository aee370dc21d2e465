/// app/lab/contact_rig.h: a phantom in every form that a run may publish to contact, with the shipped voxmap and windows.
///   Frame  world = bone frame.   Units  SI.   Errors  those of the phantom spec.   Thread  one.
#pragma once

#include <memory>

#include "core/contact/contact_view.h"
#include "core/contact/surface_view.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {

class ContactRig {
 public:
  /// The window contains the whole phantom and a margin of ten voxels; fits_window() holds. @returns errors of the
  /// spec.
  [[nodiscard]] static Result<ContactRig> create(const PhantomSpec& spec);

  [[nodiscard]] const Truth& truth() const noexcept { return *truth_; }
  /// Published by a scene with `model = "gradient-plane"`: packed words, and the density that `voxmap` reads.
  [[nodiscard]] ContactView word_view() const { return {words_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// The plain form: density and gradient as floats, per point.
  [[nodiscard]] ContactView float_view() const { return {floats_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// The storage of the paper.
  [[nodiscard]] ContactView vdb_view() const { return {*grids_, bone_from_index_, Pose{}}; }
  /// Published by a scene with `model = "mesh"`.
  [[nodiscard]] ContactView mesh_view() const { return {mesh_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// Published by a scene with `model = "surface"`.
  [[nodiscard]] SurfaceView surface_view() const;
  [[nodiscard]] double word_bytes() const { return bytes_of(*words_); }  ///< [bytes] of one published copy
  [[nodiscard]] double float_bytes() const { return bytes_of(*floats_); }
  [[nodiscard]] double mesh_bytes() const;  ///< [bytes] of one published copy

 private:
  ContactRig() = default;
  [[nodiscard]] double bytes_of(const ContactWindowPublisher& publisher) const;
  std::unique_ptr<Truth> truth_;
  Affine bone_from_index_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> words_, floats_, mesh_, records_;
  std::unique_ptr<VdbContactGrids> grids_;
};

}  // namespace burrhole
