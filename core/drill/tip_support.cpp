#include "core/drill/tip_support.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/drill/cut_face.h"
#include "core/tool/tool_surface.h"

namespace burrhole {
namespace {

constexpr float kBone = 0.5f;   // [-] density
constexpr double kAhead = 0.5;  // [voxel edges]

/// @returns whether bone is at a place. @param at set to the voxel beside it that has most of that bone.
bool has_bone(const MasterWindow& window, const Vec3& index, std::size_t& at) noexcept {
  const Vec3 low(window.box.lo), high(window.box.hi - 1);
  if (!(index.x >= low.x && index.y >= low.y && index.z >= low.z && index.x < high.x && index.y < high.y && index.z < high.z)) return false;
  const Vec3i v = floor_int(index);
  const Vec3 part = index - Vec3(v);
  double density = 0.0, most = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i step(corner & 1, corner >> 1 & 1, corner >> 2);
    const double weight =
        (step.x != 0 ? part.x : 1.0 - part.x) * (step.y != 0 ? part.y : 1.0 - part.y) * (step.z != 0 ? part.z : 1.0 - part.z);
    const std::size_t here = window.box.offset_of(v + step);
    const double part_of = weight * static_cast<double>(window.density[here]);
    density += part_of;
    if (part_of <= most) continue;
    most = part_of;
    at = here;
  }
  return density >= static_cast<double>(kBone);
}

}  // namespace

TipSupport::TipSupport(const Tool& tool, const DrillRegions& regions, double spacing) {
  const ErosionPoints& points = tool.erosion;
  if (points.size() == 0) return;
  const int stride = std::max(1, static_cast<int>(std::lround(spacing / points.pitch)));
  std::unordered_set<std::int64_t> seen;
  for (std::size_t n = 0; n < points.size(); ++n) {  // sorted by height: the first of a column is its lowest
    const Vec3& p = points.positions[n];
    const auto i = static_cast<std::int64_t>(std::floor(p.x / points.pitch)), j = static_cast<std::int64_t>(std::floor(p.y / points.pitch));
    if (i % stride != 0 || j % stride != 0 || !(points.factors[n] > 0.0f) || !seen.insert(i * (std::int64_t{1} << 32) + j).second) continue;
    const bool tip = tool.surface->region_at(p) == regions.inner;
    places_.push_back({p - Vec3(0.0, 0.0, 0.5 * points.pitch), 1.0 / static_cast<double>(points.factors[n]), tip});
    tip_count_ += tip ? 1 : 0;
  }
  tip_area_ = static_cast<double>(tip_count_) * points.pitch * points.pitch * stride * stride;
}

TipLoad TipSupport::measure(const MasterWindow& window, const Affine& index_from_tool, double engaged, float soft) const noexcept {
  const Vec3 up = index_from_tool.linear * Vec3(0.0, 0.0, 1.0);  // [voxels per m]
  const double edge = 1.0 / glm::length(up);
  const Vec3 ahead = -kAhead * edge * up, behind = engaged * up;
  double tip = 0.0, all = 0.0;
  std::size_t supported = 0;
  for (const Place& place : places_) {
    const Vec3 at = index_from_tool * place.at;
    std::size_t voxel = 0;
    if (!has_bone(window, at, voxel) && !has_bone(window, at + ahead, voxel) && !has_bone(window, at + behind, voxel)) continue;
    const float hardness = window.hardness[voxel];
    if (hardness < soft) continue;
    const double load = place.per_e * static_cast<double>(std::max(hardness, CutFace::kLeastHardness));
    all += load;
    if (!place.tip) continue;
    tip += load;
    ++supported;
  }
  return {.supported = tip_count_ > 0 ? static_cast<double>(supported) / static_cast<double>(tip_count_) : 0.0,
          .share = all > 0.0 ? tip / all : 0.0};
}

}  // namespace burrhole
