/// core/contact/contact_shell.h: a point shell laid out for vector look-ups: single precision, one array a coordinate, points near each
///   other in space near each other in memory, cutting points first.
///   Frame  tool frame.   Units  SI.   Thread  built once, read by contact.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/line_vector.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Arrays are padded to a multiple of kShellPad with copies of the last point of their part, so that a kernel never reads past an end.
inline constexpr std::size_t kShellPad = 16;

struct ContactShellPart {
  LineVector<float> x, y, z;         ///< [m], padded
  std::vector<std::uint32_t> point;  ///< index into the shell it was made from, not padded
  [[nodiscard]] std::size_t size() const noexcept { return point.size(); }
};

struct ContactShell {
  ContactShellPart cutting, passive;
  double reach = 0.0;  ///< [m] greatest distance of a point from the tool origin
};

/// Sorted along a Morton curve of cells of `cell` [m] (a voxel's edge is right). Equal cells keep the shell's order.
[[nodiscard]] ContactShell make_contact_shell(const PointShell& shell, double cell);

}  // namespace burrhole
