#include "volumes/read/slice_stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

constexpr double kUnitLength = 1e-3;    // directions are decimal text, often of five digits: 1e-3 rad moves a corner of a head by 0.1 mm
constexpr double kSpacingShare = 1e-4;  // pixel spacings of one stack may differ by this share: 0.02 mm over 200 mm
constexpr double kSamePlace = 0.001;    // [mm] slices closer than this are at one position
constexpr double kStepShare = 0.01;     // [-] a step may differ from the median by this share
constexpr double kStepSlack = 0.01;     // [mm] and by this much, as positions are rounded decimals
constexpr double kMostOffPlace =
    0.1;                           // [-] largest distance of a slice from its position in the affine, as a share of the shortest voxel edge
constexpr double kFarthest = 1e6;  // [mm] largest coordinate of a scanner

/// A stack during the checks: everything along the normal of the first slice.
struct Axis {
  Vec3 row, column, normal;
  char letter = 'z';  ///< patient axis nearest to the normal, for messages
  int component = 2;
};

struct Steps {
  std::vector<Vec3> between;  ///< [mm] from slice n to slice n + 1, sorted
  double rule = 0.0;          ///< [mm] median along the normal; unlike the mean it is robust against a few gaps
  double slant = 1.0;         ///< [-] length of a step along the table over that along the normal: above 1 with a tilted gantry
};

bool directions_usable(const SlicePlane& s) {
  return std::abs(glm::length(s.row) - 1.0) < kUnitLength && std::abs(glm::length(s.column) - 1.0) < kUnitLength &&
         std::abs(glm::dot(s.row, s.column)) < kUnitLength;
}

std::optional<std::string> error_of_plane(const SlicePlane& s) {
  const bool finite =
      is_finite(s.position) && is_finite(s.row) && is_finite(s.column) && std::isfinite(s.column_spacing) && std::isfinite(s.row_spacing);
  if (!finite) return "a slice's position, direction or pixel spacing is not finite";
  if (glm::length(s.position) > kFarthest) return fmt::format("a slice lies {:.4g} mm from the origin", glm::length(s.position));
  if (s.columns < 1 || s.rows < 1) return fmt::format("a slice has {} x {} pixels", s.columns, s.rows);
  if (s.column_spacing <= 0.0 || s.row_spacing <= 0.0)
    return fmt::format("pixel spacing {:.4g} x {:.4g} mm must be above 0", s.column_spacing, s.row_spacing);
  if (!directions_usable(s))
    return fmt::format(
        "row and column directions are not perpendicular unit vectors: lengths {:.4f} and {:.4f}, cosine between them {:.4f}",
        glm::length(s.row), glm::length(s.column), glm::dot(s.row, s.column));
  return std::nullopt;
}

bool same_orientation(const SlicePlane& a, const SlicePlane& b) {
  return glm::length(a.row - b.row) < kUnitLength && glm::length(a.column - b.column) < kUnitLength;
}

bool same_spacing(const SlicePlane& a, const SlicePlane& b) {
  return std::abs(a.column_spacing - b.column_spacing) <= kSpacingShare * a.column_spacing &&
         std::abs(a.row_spacing - b.row_spacing) <= kSpacingShare * a.row_spacing;
}

/// Checks the slices for one stack, independent of their positions.
std::optional<std::string> error_of_mixture(const std::vector<SlicePlane>& slices) {
  const SlicePlane& first = slices.front();
  std::size_t sizes = 0, turned = 0, spacings = 0;
  for (const SlicePlane& s : slices) {
    sizes += s.columns != first.columns || s.rows != first.rows ? 1 : 0;
    turned += same_orientation(s, first) ? 0 : 1;
    spacings += same_spacing(s, first) ? 0 : 1;
  }
  const std::size_t all = slices.size();
  if (sizes > 0) return fmt::format("mixed sizes: {} of {} slices are not {} x {} pixels", sizes, all, first.columns, first.rows);
  if (turned > 0) return fmt::format("mixed orientations: {} of {} slices are turned against the first", turned, all);
  if (spacings > 0)
    return fmt::format("mixed pixel spacings: {} of {} slices do not have {:.4g} x {:.4g} mm", spacings, all, first.column_spacing,
                       first.row_spacing);
  return std::nullopt;
}

Axis axis_of(const SlicePlane& s) {
  Axis axis;
  axis.row = glm::normalize(s.row);
  // Exactly perpendicular to the row: otherwise the rounding of the text would appear as shear.
  axis.column = glm::normalize(s.column - axis.row * glm::dot(axis.row, s.column));
  axis.normal = glm::cross(axis.row, axis.column);
  for (int c = 0; c < 3; ++c)
    if (std::abs(axis.normal[c]) > std::abs(axis.normal[axis.component]) + 1e-9) axis.component = c;
  axis.letter = "xyz"[axis.component];
  return axis;
}

std::vector<std::size_t> sorted_along(const std::vector<SlicePlane>& slices, const Vec3& normal) {
  std::vector<double> height(slices.size());
  std::transform(slices.begin(), slices.end(), height.begin(), [&](const SlicePlane& s) { return glm::dot(s.position, normal); });
  std::vector<std::size_t> order(slices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return height[a] < height[b]; });
  return order;
}

Steps steps_of(const std::vector<Vec3>& sorted, const Vec3& normal) {
  Steps steps;
  std::vector<double> lengths;
  for (std::size_t n = 1; n < sorted.size(); ++n) {
    steps.between.push_back(sorted[n] - sorted[n - 1]);
    lengths.push_back(glm::dot(steps.between.back(), normal));
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  steps.rule = *middle;
  const Vec3 all = sorted.back() - sorted.front();
  if (const double height = glm::dot(all, normal); height > 0.0) steps.slant = glm::length(all) / height;
  return steps;
}

std::optional<std::string> error_of_doubles(const Steps& steps, const std::vector<Vec3>& sorted, const Axis& axis) {
  std::size_t doubles = 0, first = 0;
  for (std::size_t n = 0; n < steps.between.size(); ++n)
    if (glm::dot(steps.between[n], axis.normal) < kSamePlace && doubles++ == 0) first = n;
  if (doubles == 0) return std::nullopt;
  return fmt::format("two slices at one place: {} of {} slices lie where another does, the first at {} = {:.1f} mm", doubles, sorted.size(),
                     axis.letter, sorted[first][axis.component]);
}

/// Gaps and uneven steps. A whole multiple of the median step is reported as missing slices.
std::optional<std::string> error_of_gaps(const Steps& steps, const std::vector<Vec3>& sorted, const Axis& axis) {
  std::size_t off = 0, first = 0, missing = 0;
  bool whole = true;
  for (std::size_t n = 0; n < steps.between.size(); ++n) {
    const double step = glm::dot(steps.between[n], axis.normal);
    const double allowed = kStepShare * steps.rule + kStepSlack;
    if (std::abs(step - steps.rule) <= allowed) continue;
    if (off++ == 0) first = n;
    const double times = std::min(std::round(step / steps.rule), 1e6);
    whole = whole && times > 1.5 && std::abs(step - times * steps.rule) <= allowed * times;
    missing += static_cast<std::size_t>(std::max(times - 1.0, 0.0));
  }
  if (off == 0) return std::nullopt;
  const std::string where = fmt::format("step {:.2f} mm where {:.2f} mm is the rule, after {} = {:.1f} mm",
                                        glm::dot(steps.between[first], axis.normal) * steps.slant, steps.rule * steps.slant, axis.letter,
                                        sorted[first][axis.component]);
  if (!whole) return fmt::format("{} of {} slice steps are uneven; the first: {}", off, steps.between.size(), where);
  const std::size_t all = sorted.size() + missing, number = first + 2;
  if (missing == 1) return fmt::format("slice {} of {} is missing: {}", number, all, where);
  return fmt::format("{} of {} slices are missing in {} {}, the first after slice {}: {}", missing, all, off, off == 1 ? "gap" : "gaps",
                     number - 1, where);
}

/// Sideways drift may be steady (gantry tilt) but not uneven. Errors too small to detect in one step must not accumulate.
std::optional<std::string> error_of_drift(const std::vector<Vec3>& sorted, const Axis& axis, const Vec3& step, double shortest_edge) {
  const double allowed = kMostOffPlace * shortest_edge + kStepSlack;
  double worst = 0.0;
  std::size_t at = 0;
  for (std::size_t n = 0; n < sorted.size(); ++n) {
    const double off = glm::length(sorted[n] - (sorted[0] + static_cast<double>(n) * step));
    if (off > worst) worst = off, at = n;
  }
  if (worst <= allowed) return std::nullopt;
  const Vec3 off = sorted[at] - (sorted[0] + static_cast<double>(at) * step);
  const double along = glm::dot(off, axis.normal);
  return fmt::format(
      "slices drift unevenly: slice {} of {} lies {:.2f} mm sideways and {:.2f} mm along the stack from where even steps put it", at + 1,
      sorted.size(), glm::length(off - along * axis.normal), along);
}

}  // namespace

Result<SliceStack> stack_slices(const std::vector<SlicePlane>& slices, double single_slice_mm) {
  if (slices.empty()) return bad_input("there is no slice");
  for (const SlicePlane& s : slices)
    if (const auto error = error_of_plane(s)) return bad_input(*error);
  if (const auto error = error_of_mixture(slices)) return bad_input(*error);

  const SlicePlane& front = slices.front();
  const Axis axis = axis_of(front);
  SliceStack stack;
  stack.order = sorted_along(slices, axis.normal);
  std::vector<Vec3> sorted;
  for (const std::size_t n : stack.order) sorted.push_back(slices[n].position);

  Vec3 step = axis.normal * single_slice_mm;
  if (slices.size() == 1) {
    if (!std::isfinite(single_slice_mm) || single_slice_mm <= 0.0) return bad_input("there is one slice, and its thickness is unknown");
  } else {
    const Steps steps = steps_of(sorted, axis.normal);
    if (const auto error = error_of_doubles(steps, sorted, axis)) return bad_input(*error);
    if (const auto error = error_of_gaps(steps, sorted, axis)) return bad_input(*error);
    step = (sorted.back() - sorted.front()) / static_cast<double>(sorted.size() - 1);
    const double shortest = std::min({front.column_spacing, front.row_spacing, glm::length(step)});
    if (const auto error = error_of_drift(sorted, axis, step, shortest)) return bad_input(*error);
  }
  stack.tilt = std::atan2(glm::length(glm::cross(axis.normal, step)), glm::dot(axis.normal, step));
  stack.bone_from_index.linear = Mat3(axis.row * front.column_spacing, axis.column * front.row_spacing, step) * kMillimetre;
  stack.bone_from_index.offset = sorted.front() * kMillimetre;
  if (const auto error = affine_error(stack.bone_from_index)) return bad_input(*error);
  return stack;
}

}  // namespace burrhole
