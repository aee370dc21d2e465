/// core/contact/surface_view.h: what a published copy of the window holds of the surface, as the probe and the constrained tool read it.
///   Frame  as the window's bone.   Thread  one reader; the view ends with the copy.
#pragma once

#include <optional>

#include "core/contact/constrained_tool.h"
#include "core/contact/surface_probe.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// The copy's records, of either precision; both pointers null where it carries none.
[[nodiscard]] RecordView record_view(const ContactWindow& window, const Affine& bone_from_index) noexcept;

/// The same with stiffness, placed in the world; nothing where the copy carries no records.
[[nodiscard]] std::optional<SurfaceView> surface_view(const ContactWindow& window, const Affine& bone_from_index,
                                                      const Pose& world_from_bone) noexcept;

}  // namespace burrhole
