#include "app/view/heat_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/view/clipped_patch.h"
#include "core/base/bounds.h"
#include "core/base/color_ramp.h"

namespace burrhole {
namespace {

constexpr double kSeen = 1.0 / 128.0;  // [-] of the scale, change of a cell that is drawn
constexpr double kFarBelow = -1.0;     // [-] of the scale: the place of no dose, and where nothing is known

Rgba8 color_at(double place) {
  const RampColor color = ramp_color(place);
  return {color.r, color.g, color.b, 0};
}

}  // namespace

double place_on_scale(const HeatPictureConfig& config, double value) noexcept {
  if (config.quantity != HeatQuantity::dose) return (value - config.lowest) / (config.highest - config.lowest);
  if (!(value > 0.0)) return kFarBelow;
  return std::max(kFarBelow, 0.5 + std::log(value / config.damage_dose) / (2.0 * std::log(kDoseSpan)));
}

ColorBar color_bar(const HeatPictureConfig& config) {
  ColorBar out;
  constexpr int kParts = 4;
  if (config.quantity == HeatQuantity::dose) {
    out.title = "thermal dose, CEM43 (min)";
    for (int n = 0; n <= kParts; ++n)
      out.marks.emplace_back(n / 4.0, fmt::format("{:.3g}", config.damage_dose * std::pow(kDoseSpan, n / 2.0 - 1.0)));
    return out;
  }
  out.title = config.quantity == HeatQuantity::peak ? "highest temperature so far (C)" : "temperature (C)";
  for (int n = 0; n <= kParts; ++n)
    out.marks.emplace_back(n / 4.0, fmt::format("{:.3g}", config.lowest + n / 4.0 * (config.highest - config.lowest)));
  return out;
}

HeatPicture::HeatPicture(const HeatField& field, const BoneCells& cells, const VoxelBox& voxels, const Affine& bone_from_index, double body,
                         const HeatPictureConfig& config)
    : field_(&field), cells_(cells), bone_from_index_(bone_from_index), body_(body), config_(config), density_(voxels) {}

double HeatPicture::place(const Vec3i& cell) const noexcept {
  switch (config_.quantity) {
    case HeatQuantity::dose:
      return place_on_scale(config_, static_cast<double>(field_->dose(cell)));
    case HeatQuantity::peak:
      return place_on_scale(config_, body_ + static_cast<double>(field_->peak(cell)));
    case HeatQuantity::temperature:
      break;
  }
  return place_on_scale(config_, body_ + static_cast<double>(field_->rise(cell)));
}

VoxelBox HeatPicture::cells_on_scale() const noexcept {
  VoxelBox out;
  for_each_voxel(field_->domain(), [&](const Vec3i& cell) {
    if (field_->share(cell) >= HeatField::kLeastShare && place(cell) >= 0.0) out.include(cell);
  });
  return out;
}

bool HeatPicture::differs(bool exactly) const noexcept {
  if (!(next_.cells == shown_.cells)) return true;
  if (exactly) return next_.place != shown_.place || next_.share != shown_.share || next_.density != shown_.density;
  for (std::size_t n = 0; n < next_.place.size(); ++n)
    if (std::abs(next_.place[n] - shown_.place[n]) > static_cast<float>(kSeen)) return true;
  return bone_moved_ && next_.density != shown_.density;
}

bool HeatPicture::copy_for_picture(bool exactly) {
  next_.cells = cells_on_scale();
  if (!next_.cells.empty()) next_.cells = next_.cells.grown(1).intersect(field_->domain());
  next_.place.resize(next_.cells.count());
  next_.share.resize(next_.cells.count());
  std::size_t at = 0;
  for_each_voxel(next_.cells, [&](const Vec3i& cell) {
    const float share = field_->share(cell);
    next_.share[at] = share >= HeatField::kLeastShare ? share : 0.0f;
    next_.place[at++] = static_cast<float>(place(cell));
  });
  next_.voxels = next_.cells.empty() ? VoxelBox{} : cells_.voxels_of(next_.cells).intersect(density_.box());
  density_.copy(next_.voxels, next_.density);
  const bool changed = !copied_ || differs(exactly);
  bone_moved_ = false;
  copied_ = true;
  if (changed) std::swap(shown_, next_);
  return changed;
}

void HeatPicture::append_mesh(AddedMesh& out) const { append_heat(shown_, cells_, bone_from_index_, out); }

std::optional<double> place_at(const HeatCopy& copy, const BoneCells& cells, const Vec3& index) noexcept {
  const Vec3 at = cells.place_of(index);
  const Vec3i base = floor_int(at);
  const Vec3 part = at - Vec3(base);
  double sum = 0.0, weights = 0.0;
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3i corner = cell_corner(n), cell = base + corner;
    if (!copy.cells.contains(cell)) continue;
    const Vec3 near = glm::mix(1.0 - part, part, Vec3(corner));
    const std::size_t offset = copy.cells.offset_of(cell);
    const double weight = near.x * near.y * near.z * static_cast<double>(copy.share[offset]);
    sum += weight * static_cast<double>(copy.place[offset]);
    weights += weight;
  }
  if (!(weights > 0.0)) return std::nullopt;
  return sum / weights;
}

void append_heat(const HeatCopy& copy, const BoneCells& cells, const Affine& bone_from_index, AddedMesh& out) {
  if (copy.cells.empty()) return;
  const TriangleMesh mesh = make_bone_patch({.box = copy.voxels, .density = copy.density, .bone_from_index = bone_from_index});
  const Affine index_from_bone = bone_from_index.inverse();
  std::vector<double> places;
  places.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) places.push_back(place_at(copy, cells, index_from_bone * Vec3(p)).value_or(kFarBelow));
  const std::size_t before = out.vertices.size();
  append_clipped(
      mesh, places, [](const Vec3f&, double place) { return color_at(place); }, out);
  out.unlit.resize(before, 0);
  out.unlit.resize(out.vertices.size(), kHeatUnlit);
}

}  // namespace burrhole
