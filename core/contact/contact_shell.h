/// core/contact/contact_shell.h: a point shell in the layout for vector kernels: single precision, one array per coordinate, spatial
///   neighbours adjacent in memory, cutting points first.
///   Frame  tool frame.   Units  SI.   Thread  built once, read by contact.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/line_vector.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Each array is padded to a multiple of kShellPad with copies of its last point, so that a kernel never reads beyond the end.
inline constexpr std::size_t kShellPad = 16;

struct ContactShellPart {
  LineVector<float> x, y, z;         ///< [m], padded
  std::vector<std::uint32_t> point;  ///< index into the source shell, not padded
  [[nodiscard]] std::size_t size() const noexcept { return point.size(); }
};

struct ContactShell {
  ContactShellPart cutting, passive;
  double reach = 0.0;  ///< [m] largest distance of a point from the tool origin
};

/// Sorts along a Morton curve with cells of `cell` [m] (use the voxel edge). Points of one cell keep the order of the shell.
[[nodiscard]] ContactShell make_contact_shell(const PointShell& shell, double cell);

/// @returns every n-th point of a part, n the smallest with which at most `most` points are left. Points of a shell are in spatial order, so
/// they are spread evenly.
[[nodiscard]] ContactShellPart even_part(const ContactShellPart& from, std::size_t most);
/// Copies the positions of those points again, after the points of `from` moved. Never allocates.
void copy_even_part(const ContactShellPart& from, std::size_t most, ContactShellPart& to) noexcept;

}  // namespace burrhole
