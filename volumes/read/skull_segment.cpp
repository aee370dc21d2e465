#include "volumes/read/skull_segment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "volumes/read/layer_profile.h"
#include "volumes/read/skull_cavity.h"
#include "volumes/read/skull_columns.h"

namespace burrhole {
namespace {

constexpr double kPitch = 1.0e-3;                        // [m] of the columns, and edge of the cells that find them
constexpr double kOutside = 3e-3;                        // [m] of a profile beyond the surface
constexpr double kInside = 9e-3;                         // [m] of a profile below it: half of the thickest skull with layers
constexpr double kProfileStep = 0.25e-3;                 // [m]
constexpr double kSoftReach = 4e-3, kBrainReach = 6e-3;  // [m] labels beyond the outer and the inner surface
constexpr double kLeastLayered = 0.1;                    // [-] of the columns; below, bone has one label
constexpr double kMajority = 0.5;                        // [-] of the columns around a place
constexpr auto kSamples = static_cast<std::size_t>((kOutside + kInside) / kProfileStep + 1.5);

/// Profiles of a column from both surfaces; each starts kOutside beyond the surface.
struct Profiles {
  std::array<float, kSamples> down{}, up{};
};

std::vector<Profiles> sample_profiles(const Scan& scan, double hu_offset, const std::vector<WallColumn>& columns) {
  const Affine scan_from_bone = scan.bone_from_index.inverse();
  std::vector<Profiles> out(columns.size());
  for_each_number(static_cast<int>(columns.size()), [&](int n) {
    const WallColumn& c = columns[static_cast<std::size_t>(n)];
    Profiles& p = out[static_cast<std::size_t>(n)];
    for (std::size_t s = 0; s < kSamples; ++s) {
      const double depth = static_cast<double>(s) * kProfileStep - kOutside;
      p.down[s] = static_cast<float>(scan_value(scan, scan_from_bone * (c.entry + depth * c.inward)) + hu_offset);
      p.up[s] = static_cast<float>(scan_value(scan, scan_from_bone * (c.entry + (c.thickness - depth) * c.inward)) + hu_offset);
    }
  });
  return out;
}

/// The whole profile of a wall of a thickness: the halves from both surfaces, blended over a millimetre in the middle.
LayerProfile join(const Profiles& p, double thickness) {
  constexpr double kBlend = 1e-3;  // [m]
  LayerProfile down{-kOutside, kProfileStep, {p.down.begin(), p.down.end()}}, up{-kOutside, kProfileStep, {p.up.begin(), p.up.end()}};
  LayerProfile out{-kOutside, kProfileStep, {}};
  const auto count = static_cast<std::size_t>((thickness + 2.0 * kOutside) / kProfileStep + 1.0);
  for (std::size_t n = 0; n < count; ++n) {
    const double depth = out.depth_of(static_cast<double>(n));
    const double share = std::clamp((depth - 0.5 * thickness) / kBlend + 0.5, 0.0, 1.0);
    out.values.push_back(static_cast<float>((1.0 - share) * down.at(depth) + share * up.at(thickness - depth)));
  }
  return out;
}

/// A column after the averages along the surface.
struct Found {
  LayerBorders borders;
  double thickness = 0.0;
};

std::vector<Found> find_borders(const std::vector<WallColumn>& columns, const std::vector<Profiles>& profiles, const Neighbours& around,
                                const SegmentOptions& options, double most_value) {
  std::vector<Found> out(columns.size());
  for_each_number(static_cast<int>(columns.size()), [&](int number) {
    const auto n = static_cast<std::size_t>(number);
    std::array<double, kSamples> down{}, up{};
    double weights = 0.0, thickness = 0.0;
    around.visit(n, [&](std::size_t m, double distance) {
      const double x = distance / options.smoothing, weight = portable_exp(-0.5 * x * x);
      weights += weight;
      thickness += weight * columns[m].thickness;
      for (std::size_t s = 0; s < kSamples; ++s) {
        down[s] += weight * static_cast<double>(profiles[m].down[s]);
        up[s] += weight * static_cast<double>(profiles[m].up[s]);
      }
    });
    Profiles mean;
    for (std::size_t s = 0; s < kSamples; ++s) {
      mean.down[s] = static_cast<float>(down[s] / weights);
      mean.up[s] = static_cast<float>(up[s] / weights);
    }
    out[n].thickness = thickness / weights;
    out[n].borders = find_layers(join(mean, out[n].thickness), {.thickness = out[n].thickness,
                                                                .least_dip = options.least_dip,
                                                                .least_table = options.least_table,
                                                                .most_value = most_value,
                                                                .blur = options.blur.value_or(0.0)});
  });
  return out;
}

/// A tenth above the largest value of nearly all columns: a table thinner than the blur is not taken as denser than that.
double largest_table(const std::vector<Profiles>& profiles) {
  constexpr double kShare = 0.98, kAbove = 1.1;
  std::vector<float> peaks;
  for (const Profiles& p : profiles) peaks.push_back(*std::ranges::max_element(p.down));
  if (peaks.empty()) return 0.0;
  const auto at = peaks.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(peaks.size() - 1));
  std::nth_element(peaks.begin(), at, peaks.end());
  return kAbove * static_cast<double>(*at);
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

template <class F>
std::vector<double> collect(const std::vector<Found>& found, bool layered_only, const F& f) {
  std::vector<double> out;
  for (const Found& one : found)
    if (one.borders.is_layered || !layered_only) out.push_back(f(one));
  return out;
}

template <class F>
LayerSpread spread(const std::vector<Found>& found, bool layered_only, const F& f) {
  std::vector<double> values = collect(found, layered_only, f);
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

void describe_columns(const std::vector<Found>& found, SegmentFacts& out) {
  out.columns = found.size();
  const auto layered = std::ranges::count_if(found, [](const Found& f) { return f.borders.is_layered; });
  out.layered_share = found.empty() ? 0.0 : static_cast<double>(layered) / static_cast<double>(found.size());
  out.layers = found.empty() ? 0 : out.layered_share >= kLeastLayered ? 3 : 1;
  out.thickness = spread(found, false, [](const Found& f) { return f.thickness; });
  out.blur = spread(found, true, [](const Found& f) { return f.borders.blur; });
  out.outer_table = spread(found, true, [](const Found& f) { return f.borders.outer - f.borders.outer_edge; });
  out.diploe = spread(found, true, [](const Found& f) { return f.borders.inner - f.borders.outer; });
  out.inner_table = spread(found, true, [](const Found& f) { return f.borders.inner_edge - f.borders.inner; });
  out.dip = spread(found, false, [](const Found& f) { return f.borders.dip; }).median;
  out.table = spread(found, true, [](const Found& f) { return f.borders.table_value; }).median;
  out.marrow = spread(found, true, [](const Found& f) { return f.borders.diploe_value; }).median;
}

/// The columns as they label voxels: borders averaged once more along the surface, over those that have layers.
std::vector<SkullSegment::Column> make_columns(const std::vector<WallColumn>& columns, const std::vector<Found>& found,
                                               const Neighbours& around, const SegmentOptions& options) {
  std::vector<SkullSegment::Column> out(columns.size());
  for_each_number(static_cast<int>(columns.size()), [&](int number) {
    const auto n = static_cast<std::size_t>(number);
    double all = 0.0, layered = 0.0, outer = 0.0, inner = 0.0;
    around.visit(n, [&](std::size_t m, double distance) {
      const double x = distance / options.smoothing, weight = portable_exp(-0.5 * x * x);
      all += weight;
      const LayerBorders& b = found[m].borders;
      if (!b.is_layered) return;
      layered += weight;
      outer += weight * b.outer;
      inner += weight * (found[m].thickness - b.inner);
    });
    SkullSegment::Column& c = out[n];
    c.entry = columns[n].entry;
    c.inward = columns[n].inward;
    c.thickness = columns[n].thickness;
    c.layered = layered / all;
    if (layered <= 0.0) return;
    c.outer = std::max(outer / layered, options.least_table);
    c.inner = std::max(inner / layered, options.least_table);
  });
  return out;
}

void add_volumes(const Scan& scan, double hu_offset, double surface, double air, const SkullCavity& cavity, SegmentFacts& out) {
  const double voxel = scan.bone_from_index.cell_volume();
  std::size_t airs = 0, bones = 0;
  for (const float v : scan.values) {
    const double hu = static_cast<double>(v) + hu_offset;
    airs += hu < air ? 1 : 0;
    bones += hu >= surface ? 1 : 0;
  }
  out.air = voxel * static_cast<double>(airs);
  out.bone = voxel * static_cast<double>(bones);
  out.soft = voxel * static_cast<double>(scan.values.size() - airs - bones);
  out.cavity = cavity.volume();
}

}  // namespace

std::string segment_text(const SegmentFacts& f) {
  if (f.layers == 0) return "layers: no skull that encloses a space was found, so bone has one label";
  const auto mm = [](double metres) { return metres * 1e3; };
  const std::string wall = fmt::format("the skull is {:.1f} mm thick (median of {} places)", mm(f.thickness.median), f.columns);
  if (f.layers == 1) return fmt::format("layers: one: {}; {:.0f} % of the places have tables and diploe", wall, 100.0 * f.layered_share);
  return fmt::format(
      "layers: outer table {:.1f} mm, diploe {:.1f} mm, inner table {:.1f} mm (medians of {:.0f} % of the places), blur {:.2f} mm; {}; "
      "dura "
      "and brain below it are assumed to lie on its inner surface",
      mm(f.outer_table.median), mm(f.diploe.median), mm(f.inner_table.median), 100.0 * f.layered_share, mm(f.blur.median), wall);
}

SkullSegment SkullSegment::find(const Scan& scan, double hu_offset, double surface, const SegmentOptions& options) {
  SkullSegment out;
  out.scan_ = &scan;
  out.hu_offset_ = hu_offset;
  out.scan_from_bone_ = scan.bone_from_index.inverse();
  out.options_ = options;
  const TissueLevels levels{options.air - hu_offset, surface - hu_offset};
  const SkullCavity cavity = SkullCavity::find(scan, levels);
  std::vector<WallColumn> columns;
  if (!cavity.empty()) columns = find_columns(scan, levels, cavity, kPitch, options.smoothing);
  if (!columns.empty()) {
    const std::vector<Profiles> profiles = sample_profiles(scan, hu_offset, columns);
    const Neighbours around(columns, 2.0 * std::max(options.smoothing, 0.1 * kPitch));
    const std::vector<Found> found = find_borders(columns, profiles, around, options, largest_table(profiles));
    describe_columns(found, out.facts_);
    out.columns_ = make_columns(columns, found, around, options);
    out.place_columns();
  } else {
    out.facts_.layers = 0;
  }
  add_volumes(scan, hu_offset, surface, options.air, cavity, out.facts_);
  return out;
}

/// Each cell near a column knows the column whose line passes nearest to its centre.
void SkullSegment::place_columns() {
  const double most = kSoftReach + kBrainReach + 25e-3;
  Vec3 lo = columns_.front().entry, hi = lo;
  for (const Column& c : columns_) {
    lo = glm::min(lo, c.entry);
    hi = glm::max(hi, c.entry);
  }
  origin_ = lo - most;
  blocks_size_ = floor_int((hi - lo + 2.0 * most) / (kPitch * kBlock)) + 1;
  const VoxelBox blocks{Vec3i(0), blocks_size_};
  blocks_.resize(blocks.count());
  std::unordered_map<std::size_t, std::vector<float>> distances;
  for (std::size_t n = 0; n < columns_.size(); ++n) {
    const Column& c = columns_[n];
    for (double depth = -kSoftReach - kPitch; depth < c.thickness + kBrainReach + kPitch; depth += 0.5 * kPitch) {
      const Vec3i middle = floor_int((c.entry + depth * c.inward - origin_) / kPitch);
      for_each_voxel({middle - 1, middle + 2}, [&](const Vec3i& cell) {
        const Vec3i block = cell / kBlock;
        const VoxelBox inside{Vec3i(0), Vec3i(kBlock)};
        const std::size_t b = blocks.offset_of(block), at = inside.offset_of(cell - block * kBlock);
        if (!blocks_[b]) {
          blocks_[b] = std::make_unique<Block>(inside.count(), -1);
          distances[b].assign(inside.count(), 1e9f);
        }
        const Vec3 from = origin_ + (Vec3(cell) + 0.5) * kPitch - c.entry;
        const auto distance = static_cast<float>(glm::length(from - glm::dot(from, c.inward) * c.inward));
        float& best = distances[b][at];
        if (distance >= best) return;
        best = distance;
        (*blocks_[b])[at] = static_cast<std::int32_t>(n);
      });
    }
  }
}

std::int32_t SkullSegment::column_at(const Vec3i& cell) const noexcept {
  const VoxelBox blocks{Vec3i(0), blocks_size_}, inside{Vec3i(0), Vec3i(kBlock)};
  if (glm::any(glm::lessThan(cell, Vec3i(0)))) return -1;
  const Vec3i block = cell / kBlock;
  if (!blocks.contains(block)) return -1;
  const auto& found = blocks_[blocks.offset_of(block)];
  return found ? (*found)[inside.offset_of(cell - block * kBlock)] : -1;
}

VoxelLabel SkullSegment::label(const Vec3& p_bone, bool is_bone) const noexcept {
  const VoxelLabel alone = is_bone ? VoxelLabel::bone : VoxelLabel::none;
  if (columns_.empty()) return alone;
  const Vec3 at = (p_bone - origin_) / kPitch - 0.5;
  const Vec3i base = floor_int(at);
  const Vec3 t = at - Vec3(base);
  double weights = 0.0, depth = 0.0, thickness = 0.0, outer = 0.0, inner = 0.0, layered = 0.0, with_layers = 0.0;
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3i corner(static_cast<int>(n & 1u), static_cast<int>((n >> 1) & 1u), static_cast<int>(n >> 2));
    const std::int32_t number = column_at(base + corner);
    if (number < 0) continue;
    const Column& c = columns_[static_cast<std::size_t>(number)];
    double weight = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) weight *= corner[axis] != 0 ? t[axis] : 1.0 - t[axis];
    weights += weight;
    depth += weight * glm::dot(p_bone - c.entry, c.inward);
    thickness += weight * c.thickness;
    layered += weight * c.layered;
    if (c.outer <= 0.0) continue;
    with_layers += weight;
    outer += weight * c.outer;
    inner += weight * c.inner;
  }
  if (weights < 0.2) return alone;
  depth /= weights;
  thickness /= weights;
  if (!is_bone) return label_outside(p_bone, depth, thickness);
  if (facts_.layers < 3 || with_layers <= 0.0 || layered / weights < kMajority) return VoxelLabel::bone;
  // Bone beside the wall of the skull, such as a process on its outer side.
  if (depth < -kSoftReach || depth > thickness + kSoftReach) return VoxelLabel::bone;
  outer = std::min(outer / with_layers, 0.5 * thickness);
  inner = std::min(inner / with_layers, 0.5 * thickness);
  if (depth <= outer) return VoxelLabel::outer_table;
  return depth >= thickness - inner ? VoxelLabel::inner_table : VoxelLabel::diploe;
}

VoxelLabel SkullSegment::label_outside(const Vec3& p_bone, double depth, double thickness) const noexcept {
  const double below = depth - thickness;
  if (depth < -kSoftReach || below > kBrainReach) return VoxelLabel::none;
  if (scan_value(*scan_, scan_from_bone_ * p_bone) + hu_offset_ < options_.air) return VoxelLabel::none;
  if (depth <= 0.5 * thickness) return depth <= kPitch ? VoxelLabel::soft_tissue : VoxelLabel::none;
  if (below < -kPitch) return VoxelLabel::none;
  return below <= options_.dura ? VoxelLabel::dura : VoxelLabel::brain;
}

}  // namespace burrhole
