/// app/lab/contact_rig.h: a phantom held up to contact in every form that a run may publish, the shipped voxmap and windows between.
///   Frame  world = bone frame.   Units  SI.   Thread  one.
#pragma once

#include <memory>

#include "core/contact/contact_view.h"
#include "core/contact/surface_view.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {

class ContactRig {
 public:
  /// The window holds the whole phantom and ten voxels round it, at most kMaxWindowEdge - 20 voxels a side. Faults of the spec pass
  /// through.
  [[nodiscard]] static Result<ContactRig> create(const PhantomSpec& spec);

  [[nodiscard]] const Truth& truth() const noexcept { return *truth_; }
  /// What a scene with `model = "gradient-plane"` publishes: packed words, and the density that `voxmap` reads, too.
  [[nodiscard]] ContactView word_view() const { return {words_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// The plain form: density and gradient in floats, point by point.
  [[nodiscard]] ContactView float_view() const { return {floats_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// The paper's storage.
  [[nodiscard]] ContactView vdb_view() const { return {*grids_, bone_from_index_, Pose{}}; }
  /// What a scene with `model = "surface"` publishes.
  [[nodiscard]] SurfaceView surface_view() const;
  [[nodiscard]] double word_bytes() const { return bytes_of(*words_); }  ///< of one published copy
  [[nodiscard]] double float_bytes() const { return bytes_of(*floats_); }

 private:
  ContactRig() = default;
  [[nodiscard]] double bytes_of(const ContactWindowPublisher& publisher) const;
  std::unique_ptr<Truth> truth_;
  Affine bone_from_index_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> words_, floats_, records_;
  std::unique_ptr<VdbContactGrids> grids_;
};

}  // namespace burrhole
