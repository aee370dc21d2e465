#include "volumes/read/scan_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/units.h"
#include "volumes/read/scan.h"

namespace burrhole {
namespace {

constexpr double kShortest = 1e-6, kLongest = 1.0;  // [m] edges of a voxel
constexpr double kFlattest = 1e-3;                  // volume of the cell over that of the box with the same edges

/// Angle between a unit vector and the line of another, from 0 to pi/2; from sine and cosine, so that small angles are accurate.
double angle_to_line(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), std::abs(glm::dot(a, b))); }

}  // namespace

GridShape describe_grid(const Affine& bone_from_index) noexcept {
  GridShape out;
  for (int c = 0; c < 3; ++c) {
    out.spacing[c] = glm::length(bone_from_index.linear[c]);
    out.direction[c] = bone_from_index.linear[c] / out.spacing[c];
  }
  for (int c = 0; c < 3; ++c) {
    const double between = angle_to_line(out.direction[c], out.direction[(c + 1) % 3]);
    out.shear = std::max(out.shear, 90.0 * kDegree - between);
    double nearest = 90.0 * kDegree;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 unit(0.0);
      unit[axis] = 1.0;
      nearest = std::min(nearest, angle_to_line(out.direction[c], unit));
    }
    out.oblique = std::max(out.oblique, nearest);
  }
  out.mirrored = glm::determinant(bone_from_index.linear) < 0.0;
  return out;
}

std::optional<std::string> affine_error(const Affine& bone_from_index) {
  double box = 1.0;
  for (int c = 0; c < 3; ++c) {
    const Vec3 edge = bone_from_index.linear[c];
    if (!is_finite(edge)) return "the voxel-to-patient map is not finite";
    const double length = glm::length(edge);
    if (length < kShortest || length > kLongest)
      return fmt::format("voxels are {:.4g} mm long on axis {}; between 0.001 and 1000 mm is read", length / kMillimetre, "ijk"[c]);
    box *= length;
  }
  if (!is_finite(bone_from_index.offset)) return "the origin is not finite";
  if (bone_from_index.cell_volume() < kFlattest * box) return "two index axes run in the same direction: voxels are flat";
  return std::nullopt;
}

std::optional<std::string> dims_error(std::int64_t i, std::int64_t j, std::int64_t k) {
  for (const std::int64_t edge : {i, j, k})
    if (edge < 1 || edge > std::numeric_limits<int>::max()) return fmt::format("sizes {} x {} x {} are not those of a volume", i, j, k);
  if (static_cast<double>(i) * static_cast<double>(j) * static_cast<double>(k) > kMaxScanVoxels)
    return fmt::format("{} x {} x {} voxels are more than the {:.0f} that are read", i, j, k, kMaxScanVoxels);
  return std::nullopt;
}

Affine lps_from_ras(const Affine& ras_from_index) noexcept {
  const Mat3 flip(Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1));
  return {flip * ras_from_index.linear, flip * ras_from_index.offset};
}

}  // namespace burrhole
