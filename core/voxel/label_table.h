/// core/voxel/label_table.h: names and colours of tissue labels. Those of the user are lines of BoneModel::notes(), so files keep them.
///   Line   label NUMBER #RRGGBB NAME, the number from VoxelLabel::first_user on.   Errors none: other lines are skipped.   Thread any.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/voxel/bone_model.h"

namespace burrhole {

using LabelColor = std::array<std::uint8_t, 3>;  ///< red, green, blue

struct NamedLabel {
  VoxelLabel label = VoxelLabel::none;
  std::string name;
  LabelColor color{};
};

/// Labels of the user, by ascending number.
using LabelTable = std::vector<NamedLabel>;

/// @returns the line of a label in the notes of a bone model.
[[nodiscard]] std::string note_of(const NamedLabel& label);
[[nodiscard]] LabelTable labels_of(const std::string& notes);

/// @returns the name of a layer or label, as reports write it; empty for what is no bone and has no name of the user.
[[nodiscard]] std::string label_name(VoxelLabel label, const LabelTable& table);
/// @returns the n-th colour of labels without one of their own.
[[nodiscard]] LabelColor palette_color(std::size_t n) noexcept;

}  // namespace burrhole
