/// app/lab/contact_rig.h: a phantom held up to contact in both storages, the shipped voxmap and window between.
///   Frame  world = bone frame.   Units  SI.   Thread  one.
#pragma once

#include <memory>

#include "core/contact/constrained_tool.h"
#include "core/contact/contact_view.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {

class ContactRig {
 public:
  /// The window holds the whole phantom and ten voxels round it, at most kMaxWindowEdge - 20 voxels a side. Faults of the spec pass through.
  [[nodiscard]] static Result<ContactRig> create(const PhantomSpec& spec);

  [[nodiscard]] const Truth& truth() const noexcept { return *truth_; }
  [[nodiscard]] ContactView window_view() const { return {publisher_->exchange().latest(), bone_from_index_, Pose{}}; }
  /// The same copy as the constrained tool reads it: 16-bit records of its surface.
  [[nodiscard]] SurfaceView surface_view() const;
  [[nodiscard]] ContactView vdb_view() const { return {*grids_, bone_from_index_, Pose{}}; }
  [[nodiscard]] double window_bytes() const;  ///< of one published copy

 private:
  ContactRig() = default;
  std::unique_ptr<Truth> truth_;
  Affine bone_from_index_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::unique_ptr<VdbContactGrids> grids_;
};

}  // namespace burrhole
