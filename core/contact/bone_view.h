/// core/contact/bone_view.h: one copy of bone as each reader needs it: voxels for penalty models, surface records for the constrained tool.
///   Frame  world for the results of the views.   Thread  one reader; the view is valid as long as the copy.
#pragma once

#include <optional>

#include "core/contact/contact_view.h"
#include "core/contact/surface_view.h"

namespace burrhole {

struct BoneView {
  ContactView voxels;                      ///< for penalty models and the drill monitor
  std::optional<SurfaceView> surface;      ///< for the constrained tool; empty where the copy has no surface records
  Pose world_from_bone;                    ///< of both views
  const CoarseDistance* coarse = nullptr;  ///< bounds the distance of bone outside the window; null: nothing is known there
};

}  // namespace burrhole
