#include "core/tool/cutting_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/tool/erosion_points.h"

namespace burrhole {
namespace {

/// An empty table around the bounds, or the error. @param revolved one plane, x the radius.
Result<CuttingField> make_table(const Bounds& bounds, const CuttingFieldSize& size, bool revolved) {
  if (!(size.pitch > 0.0) || !std::isfinite(size.pitch) || !(size.margin >= 0.0) || !std::isfinite(size.margin))
    return Error{ErrorCode::out_of_range, "pitch and margin of a cutting field must be numbers, the pitch above 0", {}};
  CuttingField field;
  field.pitch = size.pitch;
  field.margin = size.margin;
  field.bounds = bounds;
  Vec3 cells = glm::ceil((bounds.hi - bounds.lo + 2.0 * size.margin) / size.pitch) + 1.0;
  if (revolved) cells.x = std::ceil((bounds.hi.x + size.margin) / size.pitch) + 1.0, cells.y = 1.0;
  if (!is_finite(cells) || !(cells.x * cells.y * cells.z <= static_cast<double>(kMaxCuttingNodes)) ||
      glm::any(glm::lessThan(cells, Vec3(2.0, revolved ? 1.0 : 2.0, 2.0))))
    return Error{ErrorCode::out_of_range,
                 fmt::format("a cutting field of pitch {:g} mm would hold more than {} nodes", size.pitch * 1e3, kMaxCuttingNodes),
                 {}};
  field.dims = Vec3i(cells);
  field.revolved = revolved;
  field.origin = 0.5 * (bounds.lo + bounds.hi) - 0.5 * size.pitch * (cells - 1.0);
  if (revolved) field.origin.x = field.origin.y = 0.0;
  const std::size_t count = VoxelBox{Vec3i(0), field.dims}.count();
  field.distance.resize(count);
  field.factor.assign(count, 0.0f);
  return field;
}

/// Extends factors outwards layer by layer: a node without a factor takes the mean of its six neighbours that have one.
void extend_factors(CuttingField& field) {
  const VoxelBox all{Vec3i(0), field.dims};
  const int layers = static_cast<int>(std::ceil(field.margin / field.pitch)) + 1;
  std::vector<std::pair<std::size_t, float>> found;
  std::vector<Vec3i> empty;
  for_each_voxel(all, [&](const Vec3i& v) {
    if (field.factor[all.offset_of(v)] == 0.0f) empty.push_back(v);
  });
  for (int layer = 0; layer < layers && !empty.empty(); ++layer) {
    found.clear();
    std::erase_if(empty, [&](const Vec3i& v) {
      float sum = 0.0f, count = 0.0f;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          Vec3i next = v;
          next[axis] += side;
          const float there = all.contains(next) ? field.factor[all.offset_of(next)] : 0.0f;
          sum += there;
          count += there > 0.0f ? 1.0f : 0.0f;
        }
      if (count > 0.0f) found.emplace_back(all.offset_of(v), sum / count);
      return count > 0.0f;
    });
    for (const auto& [at, value] : found) field.factor[at] = value;
  }
}

/// Linear interpolation lies above a convex function, such as the distance to a convex solid: on average over a cell by a twelfth of the
/// second differences along its axes. Subtracting this at the nodes removes the bias, also on rounded edges.
void take_off_bias(CuttingField& field) {
  const VoxelBox all{Vec3i(0), field.dims};
  const std::size_t row = static_cast<std::size_t>(field.dims.x), slab = row * static_cast<std::size_t>(field.dims.y);
  const std::vector<float> plain = field.distance;
  const Vec3i rim(field.revolved ? 0 : 1, field.revolved ? 0 : 1, 1);
  for_each_voxel({rim, field.dims - Vec3i(1, rim.y, 1)}, [&](const Vec3i& v) {
    const std::size_t at = all.offset_of(v);
    float bend = 0.0f;
    const auto add = [&](std::size_t low, std::size_t high) { bend += plain[low] - 2.0f * plain[at] + plain[high]; };
    add(v.x > 0 ? at - 1 : at + 1, at + 1);  // on the axis of a solid of revolution both neighbours are the same
    if (!field.revolved) add(at - row, at + row);
    add(at - slab, at + slab);
    field.distance[at] -= bend / 12.0f;
  });
}

/// One cutting region: its solid without the passive regions listed before it.
struct Piece {
  std::vector<Solid> solid;  ///< one
  std::vector<OutlinePiece> outline;
  std::vector<std::size_t> passive_before;  ///< indices into the pieces
};

/// The cutting part of a bit made of regions.
class CuttingSolid {
 public:
  [[nodiscard]] static Result<CuttingSolid> create(const ToolSpec& spec) {
    CuttingSolid out(spec);
    if (out.simple_) return out;
    for (const Solid& solid : out.solids_) {
      auto outline = make_outline({&solid, 1});
      if (!outline) return outline.error();
      out.pieces_.push_back({{solid}, std::move(outline).value(), {}});
    }
    for (std::size_t n = 0; n < out.pieces_.size(); ++n)
      for (std::size_t m = 0; m < n; ++m)
        if (!out.cuts(m)) out.pieces_[n].passive_before.push_back(m);
    return out;
  }

  [[nodiscard]] double distance(const Vec3& p) const {
    if (simple_) return signed_distance(solids_, spec_->outline, p);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < pieces_.size(); ++n) {
      if (!cuts(n)) continue;
      double d = signed_distance(pieces_[n].solid, pieces_[n].outline, p);
      for (const std::size_t m : pieces_[n].passive_before) d = std::max(d, -signed_distance(pieces_[m].solid, pieces_[m].outline, p));
      least = std::min(least, d);
    }
    return std::max(least, skin(p));
  }
  [[nodiscard]] Bounds bounds() const {
    std::optional<Bounds> all;
    for (std::size_t n = 0; n < solids_.size(); ++n) {
      if (!cuts(n)) continue;
      const Bounds box = solids_[n].bounds();
      all = all ? Bounds{glm::min(all->lo, box.lo), glm::max(all->hi, box.hi)} : box;
    }
    return all.value_or(Bounds{});
  }
  [[nodiscard]] bool revolves() const { return std::ranges::all_of(solids_, &Solid::revolves); }
  [[nodiscard]] bool cuts_at_all() const {
    for (std::size_t n = 0; n < solids_.size(); ++n)
      if (cuts(n)) return true;
    return false;
  }

 private:
  explicit CuttingSolid(const ToolSpec& spec) : spec_(&spec), solids_(spec.solids()) {
    for (std::size_t n = 0; n < solids_.size(); ++n) simple_ = simple_ && cuts(n) && !has_blind_face(spec.regions[n].erosion);
  }
  [[nodiscard]] bool cuts(std::size_t n) const { return spec_->regions[n].erosion.base > 0.0; }
  [[nodiscard]] static bool has_blind_face(const ErosionRule& rule) {
    const std::array<Face, 8> faces{Face::bottom,  Face::side,   Face::top,     Face::inner,
                                    Face::minus_x, Face::plus_x, Face::minus_y, Face::plus_y};
    return rule.interior == 0.0 || std::any_of(faces.begin(), faces.end(), [&](Face face) { return rule.of_face(face) == 0.0; });
  }
  /// Below a face with factor 0, nothing cuts down to the depth of the skin; with an interior factor of 0, nothing cuts below the skin.
  [[nodiscard]] double skin(const Vec3& p) const {
    const double none = -std::numeric_limits<double>::infinity();
    const NearestFace near = find_nearest_face(solids_, spec_->outline, p);
    const ErosionRule& rule = spec_->regions[near.solid].erosion;
    if (rule.base <= 0.0 || !has_blind_face(rule)) return none;
    const double d = signed_distance(solids_, spec_->outline, p);
    const double below_face = rule.of_face(near.face) == 0.0 ? d + rule.skin : none;
    return std::max(below_face, rule.interior == 0.0 ? -d - rule.skin : none);
  }

  const ToolSpec* spec_;
  std::vector<Solid> solids_;
  std::vector<Piece> pieces_;
  bool simple_ = true;  ///< one body that cuts on all faces
};

}  // namespace

CuttingFieldSize cutting_field_size(double voxel_edge, double least_radius) noexcept {
  // On a ball pitch^2 (2 / R) / 8 <= 0.005 voxel, R in voxels. Margin: sqrt(3) voxels, half a sub-step and a reserve for rounding.
  const double pitch = std::clamp(std::sqrt(0.02 * least_radius / voxel_edge), 0.125, 0.5);
  return {.pitch = pitch * voxel_edge, .margin = 4.0 * voxel_edge};
}

namespace {

Result<CuttingField> fill_table(Result<CuttingField> field, const std::function<double(const Vec3&)>& signed_distance,
                                const std::function<double(const Vec3&)>& factor) {
  if (!field) return field;
  std::size_t at = 0;
  for_each_voxel({Vec3i(0), field->dims}, [&](const Vec3i& v) {
    const Vec3 p = field->origin + field->pitch * Vec3(v);
    const double d = signed_distance(p);
    field->distance[at] = static_cast<float>(d);
    if (d <= 0.0) field->factor[at] = static_cast<float>(factor(p));
    ++at;
  });
  extend_factors(*field);
  take_off_bias(*field);
  return field;
}

}  // namespace

Result<CuttingField> make_cutting_field(const Bounds& bounds, const std::function<double(const Vec3&)>& signed_distance,
                                        const std::function<double(const Vec3&)>& factor, const CuttingFieldSize& size) {
  return fill_table(make_table(bounds, size, false), signed_distance, factor);
}

Result<CuttingField> make_cutting_field(const ToolSpec& spec, const CuttingFieldSize& size) {
  const auto solid = CuttingSolid::create(spec);
  if (!solid) return solid.error();
  if (!solid->cuts_at_all()) return CuttingField{};
  return fill_table(
      make_table(solid->bounds(), size, solid->revolves()), [&](const Vec3& p) { return solid->distance(p); },
      [&](const Vec3& p) { return erosion_factor_at(spec, p); });
}

}  // namespace burrhole
