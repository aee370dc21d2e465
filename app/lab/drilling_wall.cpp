#include "app/lab/drilling_wall.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/trilinear.h"
#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

constexpr int kAzimuths = 72, kDepths = 12;
constexpr double kBeyond = 1e-3;  // [m] where the search for the wall begins
constexpr double kStep = 0.2;     // [voxels] of the search

/// Density round the hole, read once.
class Density {
 public:
  Density(const Voxmap& voxmap, const Approach& approach, const WallBand& band)
      : index_from_approach_(voxmap.bone().bone_from_index().inverse() * Affine::from_pose(approach.bone_from_approach)) {
    const double reach = band.radius + kBeyond;
    const auto [lo, hi] = bounds_under(index_from_approach_, {Vec3(-reach, -reach, -band.to), Vec3(reach, reach, -band.from)});
    box_ = VoxelBox{floor_int(lo) - 1, floor_int(hi) + 3};
    values_.resize(box_.count());
    voxmap.read_density(box_, values_);
  }
  [[nodiscard]] double at(double azimuth, double radius, double depth) const {
    return trilinear(box_, values_.data(), index_from_approach_ * Vec3(radius * std::cos(azimuth), radius * std::sin(azimuth), -depth));
  }

 private:
  Affine index_from_approach_;
  VoxelBox box_;
  std::vector<float> values_;
};

/// Radius [m] of the outermost face that bone turns to the axis.
std::optional<double> radius_at(const Density& density, double azimuth, double depth, const WallBand& band, double step) {
  double outside = band.radius + kBeyond, solid = density.at(azimuth, outside, depth);
  if (solid < kSurfaceLevel) return std::nullopt;
  while (outside > step) {
    const double next = density.at(azimuth, outside - step, depth);
    if (next < kSurfaceLevel) return outside - step * (solid - kSurfaceLevel) / (solid - next);
    outside -= step;
    solid = next;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> wall_roughness(const Voxmap& voxmap, const Approach& approach, const WallBand& band) {
  const Density density(voxmap, approach, band);
  const double step = kStep * voxmap.bone().bone_from_index().mean_edge();
  // 1, cos, sin, and the same times depth: orthogonal over even azimuths and depths that are symmetric about the middle.
  constexpr std::size_t kForms = 6;
  std::vector<std::array<double, kForms>> forms;
  std::vector<double> radii;
  std::array<double, kForms> dot{}, square{};
  for (int k = 0; k < kDepths; ++k)
    for (int a = 0; a < kAzimuths; ++a) {
      const double azimuth = 2.0 * std::numbers::pi * (a + 0.5) / kAzimuths, share = (k + 0.5) / kDepths;
      const auto radius = radius_at(density, azimuth, band.from + share * (band.to - band.from), band, step);
      if (!radius) return std::nullopt;
      const double c = std::cos(azimuth), s = std::sin(azimuth), z = share - 0.5;
      forms.push_back({1.0, c, s, z, z * c, z * s});
      radii.push_back(*radius);
      for (std::size_t n = 0; n < kForms; ++n) {
        dot[n] += *radius * forms.back()[n];
        square[n] += forms.back()[n] * forms.back()[n];
      }
    }
  double sum = 0.0;
  for (std::size_t m = 0; m < radii.size(); ++m) {
    double off = radii[m];
    for (std::size_t n = 0; n < kForms; ++n) off -= dot[n] / square[n] * forms[m][n];
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(radii.size()));
}

}  // namespace burrhole
