#include "core/measure/enclosure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr double kSearch = 20e-3;       // [m] of the outer surface about the entry, and
constexpr double kThickest = 60e-3;     // [m] of bone, and
constexpr double kGap = 2e-3;           // [m] without bone that does not end it: all as in make_approach()
constexpr double kFinest = 0.25e-3;     // [m] least step along a direction
constexpr int kDirections = 2000;       // [-] a share of 0.8 is then known to 0.01
constexpr std::ptrdiff_t kMostCut = 3;  // [-] faces of the grid through which bone is cut: a body is cut above and below
constexpr double kLeastShown = 0.25;    // [-] of the directions

/// Bone at points of the bone frame: that of the nearest voxel.
class Grid {
 public:
  explicit Grid(const BoneSamples& bone)
      : bone_(&bone), index_from_bone_(bone.bone_from_index.inverse()), step_(std::max(0.5 * bone.bone_from_index.mean_edge(), kFinest)) {
    for (int axis = 0; axis < 3; ++axis) {
      cut_[2 * static_cast<std::size_t>(axis)] = bone.bone_box.lo[axis] <= 0;
      cut_[2 * static_cast<std::size_t>(axis) + 1] = bone.bone_box.hi[axis] >= bone.dims[axis];
    }
  }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] std::ptrdiff_t cut_faces() const { return std::ranges::count(cut_, true); }
  [[nodiscard]] bool is_bone(const Vec3& point) const {
    const Vec3i v(glm::round(index_from_bone_ * point));
    return holds(v) && bone_->is_bone(v);
  }

  enum class Meets { bone, nothing, end };
  struct First {
    Meets what;
    double distance;  // [m] to it
  };
  /// What is met first along a direction: bone, nothing up to a face without bone, or the end of the grid where bone is cut.
  [[nodiscard]] First first_along(const Vec3& from, const Vec3& direction) const {
    const Vec3 start = index_from_bone_ * from, advance = index_from_bone_.linear * direction * step_;
    for (double n = 0.0;; n += 1.0) {
      const Vec3 at = start + n * advance;
      const Vec3i v(glm::round(at));
      if (!holds(v)) return {cut_[face_beyond(v)] ? Meets::end : Meets::nothing, n * step_};
      if (bone_->is_bone(v)) return {Meets::bone, n * step_};
    }
  }

 private:
  [[nodiscard]] bool holds(const Vec3i& v) const {
    return glm::all(glm::greaterThanEqual(v, Vec3i(0))) && glm::all(glm::lessThan(v, bone_->dims));
  }
  /// Faces are numbered axis by axis, the lower one first.
  [[nodiscard]] std::size_t face_beyond(const Vec3i& v) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (v[axis] < 0) return 2 * static_cast<std::size_t>(axis);
      if (v[axis] >= bone_->dims[axis]) return 2 * static_cast<std::size_t>(axis) + 1;
    }
    return 0;
  }

  const BoneSamples* bone_;
  Affine index_from_bone_;
  double step_;  // [m]
  std::array<bool, 6> cut_{};
};

/// @returns the depth [m] at which the bone on the axis ends; nothing if there is none or it does not end.
std::optional<double> inner_surface(const Grid& grid, const Vec3& entry, const Vec3& axis) {
  const auto is_bone = [&](double depth) { return grid.is_bone(entry + axis * depth); };
  double depth = -kSearch;
  while (depth < kSearch && !is_bone(depth)) depth += grid.step();
  if (depth >= kSearch) return std::nullopt;
  const double end = depth + kThickest, gap = std::max(kGap, 1.5 * grid.step());
  for (double last = depth; depth < end; depth += grid.step()) {
    if (is_bone(depth))
      last = depth;
    else if (depth > last + gap)
      return last;
  }
  return std::nullopt;
}

/// Direction n of kDirections on a sphere, evenly: equal steps of height, turned by the golden angle.
Vec3 direction_of(int n) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double z = 1.0 - (2.0 * n + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
  return {r * std::cos(golden * n), r * std::sin(golden * n), z};
}

}  // namespace

std::optional<Enclosure> measure_enclosure(const BoneSamples& bone, const Vec3& entry, const Vec3& axis) {
  const Grid grid(bone);
  if (grid.cut_faces() >= kMostCut) return std::nullopt;
  const auto inner = inner_surface(grid, entry, axis);
  if (!inner) return std::nullopt;
  Enclosure out;
  for (double below = grid.step(); below < Enclosure::kProbeDepth; below += grid.step()) {
    if (grid.is_bone(entry + axis * (*inner + below))) return out;
    out.depth = below;
  }
  out.depth = Enclosure::kProbeDepth;
  std::vector<double> met;
  int open = 0;
  for (int n = 0; n < kDirections; ++n) {
    const Grid::First found = grid.first_along(entry + axis * (*inner + Enclosure::kProbeDepth), direction_of(n));
    if (found.what == Grid::Meets::bone) met.push_back(found.distance);
    open += found.what == Grid::Meets::nothing ? 1 : 0;
  }
  const double shown = static_cast<double>(met.size()) + open;
  if (shown < kLeastShown * kDirections) return std::nullopt;
  out.share = static_cast<double>(met.size()) / shown;
  if (met.empty()) return out;
  const auto ninth = met.begin() + static_cast<std::ptrdiff_t>(met.size() * 9 / 10);
  std::ranges::nth_element(met, ninth);
  out.reach = *ninth;
  return out;
}

}  // namespace burrhole
