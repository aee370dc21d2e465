/// core/contact/surface_view.h: the surface data in a published copy of the window, for the probe and the constrained tool.
///   Frame  that of the window's bone.   Thread  one reader; the view is valid as long as the copy.
#pragma once

#include <optional>

#include "core/contact/surface_probe.h"
#include "core/voxel/coarse_distance.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// Bone as the constrained tool reads it. The pointees must outlive the view.
struct SurfaceView {
  RecordView records;
  const std::uint8_t* stiffness = nullptr;  ///< [-] relative, 255 is 1 (contact_window.h); dense over records.box; null: 1 everywhere
  Pose world_from_bone;
  const CoarseDistance* coarse = nullptr;  ///< bounds the distance of bone outside the records; null: nothing is known there
};

/// The records of the copy, of either precision; both pointers are null where it has none.
[[nodiscard]] RecordView record_view(const ContactWindow& window, const Affine& bone_from_index) noexcept;

/// The same with stiffness and with the pose of bone in the world; empty where the copy has no records.
[[nodiscard]] std::optional<SurfaceView> surface_view(const ContactWindow& window, const Affine& bone_from_index,
                                                      const Pose& world_from_bone, const CoarseDistance* coarse = nullptr) noexcept;

}  // namespace burrhole
