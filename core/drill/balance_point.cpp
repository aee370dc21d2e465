#include "core/drill/balance_point.h"

#include <algorithm>

#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr double kAhead = 0.5;  // [voxels]

bool has_bone(const MasterWindow& window, const Vec3& index) noexcept {
  const Vec3 low(window.box.lo), high(window.box.hi - 1);
  if (!(index.x >= low.x && index.y >= low.y && index.z >= low.z && index.x < high.x && index.y < high.y && index.z < high.z)) return false;
  return trilinear(window.box, window.density.data(), index) >= 0.5;
}

}  // namespace

BalancePoint::BalancePoint(const Tool& tool) {
  const PointShell& shell = tool.shell;
  const auto cutting = static_cast<std::size_t>(std::ranges::count_if(shell.cutting, [](std::uint8_t cuts) { return cuts != 0; }));
  const std::size_t stride = std::max<std::size_t>(1, (cutting + kMostPlaces - 1) / kMostPlaces);
  std::size_t number = 0;
  for (std::size_t n = 0; n < shell.size(); ++n)
    if (shell.cutting[n] != 0 && number++ % stride == 0) places_.push_back({shell.positions[n], -shell.inward_normals[n]});
  if (places_.empty()) return;
  for (const Place& place : places_) middle_ += place.at / static_cast<double>(places_.size());
  for (const Place& place : places_) radius_ += glm::length(place.at - middle_) / static_cast<double>(places_.size());
}

Balance BalancePoint::measure(const MasterWindow& window, const Affine& index_from_tool) const noexcept {
  Balance out;
  Vec3 sum(0.0);
  for (const Place& place : places_) {
    const Vec3 step = index_from_tool.linear * place.outward;
    // Half a voxel along the outward direction, in index coordinates, whatever the edges of the voxel.
    if (!has_bone(window, index_from_tool * place.at + kAhead * glm::normalize(step))) continue;
    sum += place.at - middle_;
    ++out.count;
  }
  if (out.count == 0) return out;
  const Vec3 b = sum / static_cast<double>(out.count);
  const double size = glm::length(b);
  if (size > 0.0) out.towards = b / std::max(size, kLeast * radius_);
  return out;
}

}  // namespace burrhole
