/// tests/core/contact/words_twin.h: gradient_plane over packed words once more, one point and one voxel at a time, from the text of
/// packed_plane.h and contact_words.h: no vectors, no leaps, no short cuts; shares no code with core but the types.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/penalty_model.h"

namespace burrhole::contact_test {

struct WordsTwin {
  VoxelBox box;
  std::span<const std::uint32_t> words;
  Affine world_from_index, index_from_world;
  double stiffness = 2000.0;
  bool paper = false;
  int max_march = 64, max_ascent = 64;
  bool trust_leaps = false;  ///< sabotage: takes the leap of a word for twice what it says

  /// Points in the order of their sums.
  [[nodiscard]] ContactResult operator()(const PointShell& shell, std::span<const std::uint32_t> order, const Pose& world_from_tool) const;
};

}  // namespace burrhole::contact_test
