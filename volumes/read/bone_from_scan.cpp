#include "volumes/read/bone_from_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr std::array<double, 2> kBoneHu{250.0, 400.0};
constexpr double kMeshHardness = 0.8;  // [-] of a mesh or a fog volume, which have no density: the default of a phantom
constexpr int kSlab = 8;               // layers per step: the edge of an OpenVDB leaf
constexpr std::array<double, 2> kOccupancyBand{0.0, 1.0};

// ---- interpretation of the values ----

/// Shares of the voxels with values >= -1100: scanners fill the area outside the field of view with any lower value.
struct ValueFacts {
  double min = 0.0, max = 0.0;
  double air_share = 0.0;  ///< from -1100 to -900
  double low_share = 0.0;  ///< from -1100 to -1
  // In a scan stored as HU + 1024, soft tissue lies between 900 and 1200, and few voxels between air and fat.
  double tissue_share = 0.0;  ///< from 900 to 1200
  double gap_share = 0.0;     ///< from 450 to 750
};

ValueFacts collect_facts(std::span<const float> values) {
  constexpr float kPadding = -1100.0f;
  ValueFacts out;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  out.min = static_cast<double>(*low);
  out.max = static_cast<double>(*high);
  std::size_t real = 0, air = 0, negative = 0, tissue = 0, gap = 0;
  for (const float v : values) {
    if (v < kPadding) continue;
    ++real;
    air += v <= -900.0f ? 1 : 0;
    negative += v < 0.0f ? 1 : 0;
    tissue += v >= 900.0f && v <= 1200.0f ? 1 : 0;
    gap += v >= 450.0f && v <= 750.0f ? 1 : 0;
  }
  const double count = static_cast<double>(std::max<std::size_t>(real, 1));
  out.air_share = static_cast<double>(air) / count;
  out.low_share = static_cast<double>(negative) / count;
  out.tissue_share = static_cast<double>(tissue) / count;
  out.gap_share = static_cast<double>(gap) / count;
  return out;
}

struct Meaning {
  bool hounsfield = false;
  double offset = 0.0;
  std::array<double, 2> band = kBoneHu;
};

/// Air fills a large part of a scan of a head, and a part of any scan. Random 16-bit numbers have 0.3 % in this range.
bool holds_air(const ValueFacts& facts) {
  constexpr double kAirShare = 0.01;
  return facts.air_share > kAirShare;
}

bool is_offset_scan(const ValueFacts& facts) {
  // Two head CTs stored in this way have 18 and 27 % of tissue, 10 and 15 times the share of the gap. An MR of the same range has 1 %, less
  // than in its gap.
  constexpr double kTissueShare = 0.02, kOverGap = 3.0, kNoise = 1e-3;
  return facts.low_share < kNoise && facts.max > 1200.0 && facts.tissue_share > kTissueShare &&
         facts.tissue_share > kOverGap * facts.gap_share;
}

/// HU, HU + 1024, or the unit of the file, which requires a band.
Result<Meaning> find_meaning(const Scan& scan, const ValueFacts& facts, const BoneOptions& options, std::vector<std::string>& assumed) {
  Meaning out;
  if (options.band) out.band = *options.band;
  if (options.hu_offset || scan.quantity == Quantity::hounsfield) {
    out.hounsfield = true;
    out.offset = options.hu_offset.value_or(0.0);
  } else if (scan.quantity == Quantity::unknown && is_offset_scan(facts)) {
    out.hounsfield = true;
    out.offset = -1024.0;
    assumed.push_back(fmt::format("values from {:g} to {:g} with {:.0f} % between 900 and 1200 are taken as HU + 1024", facts.min,
                                  facts.max, 100.0 * facts.tissue_share));
  } else if (scan.quantity == Quantity::unknown && holds_air(facts)) {
    out.hounsfield = true;
    assumed.push_back(fmt::format("values from {:g} to {:g}, {:.0f} % of them air near -1000, are taken as HU", facts.min, facts.max,
                                  100.0 * facts.air_share));
  } else if (options.band) {
    assumed.push_back("values are not in HU: they are compared with the given band unchanged");
  } else {
    return bad_input(
        fmt::format("values from {:g} to {:g} are not Hounsfield units ({}); if there is bone in them, name its band in the "
                    "file's own values (--bone-hu LO,HI; bone_hu in a scene), or --hu-offset",
                    facts.min, facts.max, scan.quantity == Quantity::other ? "the file says so" : "no air near -1000, nor HU + 1024"));
  }
  return out;
}

// ---- the grid ----

std::string mm_text(const Vec3& v) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", v.x / kMillimetre, v.y / kMillimetre, v.z / kMillimetre);
}

/// A region that extends beyond the scan is cut at its end, with a line in the report: the cut resembles an edge of the bone.
void report_cut_region(const BoneOptions& options, const BoneGrid& grid, std::vector<std::string>& assumed) {
  if (!options.region) return;
  const Vec3 size = Vec3(grid.dims - 1) * *options.spacing;
  if (glm::all(glm::greaterThan(size, options.region->size - 2.0 * *options.spacing))) return;
  assumed.push_back(fmt::format("the scan ends within the region: {} mm of {} mm are there", mm_text(size), mm_text(options.region->size)));
}

// ---- values on the grid, slab by slab ----

/// Layers [k_lo - 1, k_hi + 1) of the grid, with a margin of one voxel; outside the scan its border is repeated.
struct Slab {
  Vec3i dims{0};  ///< of the grid, without margins
  std::vector<float> values;

  [[nodiscard]] Vec3i padded() const { return {dims.x + 2, dims.y + 2, dims.z + 2}; }
};

void fill_native(const Scan& scan, int k_lo, Slab& slab) {
  const Vec3i size = slab.padded();
  std::size_t n = 0;
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j) {
      const auto from = glm::clamp(Vec3i(0, j - 1, k_lo + k - 1), Vec3i(0), scan.dims - 1);
      const float* row = scan.values.data() + VoxelBox{Vec3i(0), scan.dims}.offset_of(from);
      slab.values[n++] = row[0];
      std::copy_n(row, scan.dims.x, slab.values.data() + n);
      n += static_cast<std::size_t>(scan.dims.x);
      slab.values[n++] = row[scan.dims.x - 1];
    }
}

/// Catmull-Rom weights of the four voxels around a fraction t: interpolating, exact for quadratics. At an edge as wide as a slice it moves
/// the surface by up to 0.12 slices; linear interpolation moves it by up to 0.16 slices.
struct CubicAxis {
  std::array<std::ptrdiff_t, 4> offset;
  std::array<double, 4> weight;

  CubicAxis(double at, int size, std::ptrdiff_t stride) {
    const double p = std::clamp(at, 0.0, static_cast<double>(size - 1));
    const int base = std::min(static_cast<int>(p), std::max(size - 2, 0));
    const double t = p - base, t2 = t * t, t3 = t2 * t;
    weight = {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t), 0.5 * (t3 - t2)};
    for (std::size_t n = 0; n < 4; ++n) offset[n] = stride * std::clamp(base + static_cast<int>(n) - 1, 0, size - 1);
  }
};

/// Outside the outer faces of the scan's voxels the value is `nothing`; in their outer halves it is that of the border.
float sample(const Scan& scan, const Vec3& index, float nothing) {
  if (glm::any(glm::lessThan(index, Vec3(-0.5))) || glm::any(glm::greaterThan(index, Vec3(scan.dims) - 0.5))) return nothing;
  const std::ptrdiff_t row = scan.dims.x, layer = row * scan.dims.y;
  const CubicAxis x(index.x, scan.dims.x, 1), y(index.y, scan.dims.y, row), z(index.z, scan.dims.z, layer);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    double plane = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const float* v = scan.values.data() + z.offset[k] + y.offset[j];
      double line = 0.0;
      for (std::size_t i = 0; i < 4; ++i) line += x.weight[i] * static_cast<double>(v[x.offset[i]]);
      plane += y.weight[j] * line;
    }
    sum += z.weight[k] * plane;
  }
  return static_cast<float>(sum);
}

void fill_resampled(const Scan& scan, const Affine& scan_from_grid, float nothing, int k_lo, Slab& slab) {
  const Vec3i size = slab.padded();
  std::size_t n = 0;
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) slab.values[n++] = sample(scan, scan_from_grid * Vec3(i - 1, j - 1, k_lo + k - 1), nothing);
}

// ---- occupancy and hardness ----

struct Rule {
  std::array<double, 2> band;
  double offset = 0.0;
  bool given_occupancy = false;  ///< the values are occupancy
  bool hounsfield = false;
  std::vector<HardnessPoint> table;

  [[nodiscard]] float hardness_at(double value) const {
    return static_cast<float>(!table.empty() ? hardness_of_table(table, value)
                              : hounsfield   ? hardness_of_hounsfield(value)
                                             : kMeshHardness);
  }
};

void classify(const Slab& slab, const Rule& rule, DenseBone& out) {
  const Vec3i size = slab.padded();
  const std::ptrdiff_t dx = 1, dy = size.x, dz = std::ptrdiff_t{size.x} * size.y;
  const float middle = static_cast<float>(0.5 * (rule.band[0] + rule.band[1]));
  const float half_band = static_cast<float>(0.5 * (rule.band[1] - rule.band[0]));
  const float offset = static_cast<float>(rule.offset);
  std::size_t n = 0;
  for (int k = 0; k < slab.dims.z; ++k)
    for (int j = 0; j < slab.dims.y; ++j) {
      const float* v = slab.values.data() + (k + 1) * dz + (j + 1) * dy + 1;
      for (int i = 0; i < slab.dims.x; ++i, ++v, ++n) {
        const float here = *v;
        const auto step = [&](std::ptrdiff_t d) { return std::max(std::abs(v[d] - here), std::abs(v[-d] - here)); };
        const float ramp = rule.given_occupancy ? half_band : std::max(half_band, step(dx) + step(dy) + step(dz));
        const float value = here + offset;
        const float occupancy = std::clamp(0.5f + (value - middle) / (2.0f * ramp), 0.0f, 1.0f);
        out.occupancy[n] = occupancy;
        out.hardness[n] = occupancy > 0.0f ? rule.hardness_at(static_cast<double>(value)) : 0.0f;
        out.labels[n] = static_cast<std::uint8_t>(occupancy >= 0.5f ? VoxelLabel::bone : VoxelLabel::none);
      }
    }
}

}  // namespace

double density_of_hounsfield(double hu) noexcept {
  const double h = std::max(hu + 1000.0, 0.0);
  const double density = h < 930.0    ? 1.025793 * h - 5.6804
                         : h < 1098.0 ? 0.908271 * h + 103.6151
                         : h < 1260.0 ? 0.510837 * h + 539.9977
                                      : 0.662537 * h + 348.8556;
  return std::max(density, 0.0);
}

double hardness_of_hounsfield(double hu) noexcept { return std::clamp((density_of_hounsfield(hu) - 1100.0) / 800.0, 0.0, 1.0); }

double hardness_of_table(const std::vector<HardnessPoint>& table, double value) noexcept {
  if (table.empty()) return 0.0;
  const auto above = std::upper_bound(table.begin(), table.end(), value, [](double v, const HardnessPoint& p) { return v < p.value; });
  if (above == table.begin()) return table.front().hardness;
  if (above == table.end()) return table.back().hardness;
  const HardnessPoint &a = *(above - 1), &b = *above;
  return a.hardness + (b.hardness - a.hardness) * (value - a.value) / (b.value - a.value);
}

Bounds bounds_of(const VoxelBox& box, const Affine& bone_from_index) {
  return bounds_under(bone_from_index, {Vec3(box.lo), Vec3(box.hi - 1)});
}

Status check_options(const BoneOptions& options) {
  if (options.band && !(std::isfinite((*options.band)[0]) && std::isfinite((*options.band)[1]) && (*options.band)[0] < (*options.band)[1]))
    return bad_input(fmt::format("the band of bone must increase: {:g}, {:g}", (*options.band)[0], (*options.band)[1]));
  if (options.region && !options.spacing)
    return bad_input("a region is cut out by resampling: it needs a spacing (--spacing-mm; spacing_mm in a scene)");
  return {};
}

Result<BoneGrid> plan_grid(const Scan& scan, const BoneOptions& options) {
  if (const Status checked = check_options(options); !checked) return checked.error();
  if (!options.spacing) return BoneGrid{scan.dims, scan.bone_from_index, false};
  const double pitch = *options.spacing;
  auto [lo, hi] = bounds_of({Vec3i(0), scan.dims}, scan.bone_from_index);
  if (options.region) {
    const Vec3 low = options.region->centre - 0.5 * options.region->size, high = options.region->centre + 0.5 * options.region->size;
    if (glm::any(glm::greaterThan(low, hi)) || glm::any(glm::lessThan(high, lo)))
      return bad_input(fmt::format("the region round {} mm lies outside the scan, which spans {} to {} mm", mm_text(options.region->centre),
                                   mm_text(lo), mm_text(hi)));
    lo = glm::max(lo, low);
    hi = glm::min(hi, high);
  }
  const Vec3 count = glm::floor((hi - lo) / pitch + 1e-6) + 1.0;
  if (const double voxels = count.x * count.y * count.z; voxels > kMaxResampledVoxels)
    return bad_input(
        fmt::format("{:.0f} x {:.0f} x {:.0f} voxels of {:g} mm are {:.0f} M, more than {:.0f} M: take a coarser spacing, or a "
                    "region (--region-mm with --centre-mm; region_mm in a scene)",
                    count.x, count.y, count.z, pitch / kMillimetre, voxels / 1e6, kMaxResampledVoxels / 1e6));
  return BoneGrid{Vec3i(count), Affine::scaling(pitch, lo), true};
}

Result<BoneFromScan> make_bone(const Scan& scan, const BoneOptions& options, std::vector<std::string>& assumed,
                               const std::function<void(const BoneGrid&)>& before) {
  if (scan.values.empty() || scan.values.size() != VoxelBox{Vec3i(0), scan.dims}.count()) return bad_input("the scan has no voxels");
  const ValueFacts facts = collect_facts(scan.values);
  Meaning meaning;
  if (scan.quantity == Quantity::occupancy) {
    assumed.push_back(fmt::format("hardness is {:g} everywhere: the file has no density", kMeshHardness));
  } else {
    auto found = find_meaning(scan, facts, options, assumed);
    if (!found) return found.error();
    meaning = *found;
    if (!meaning.hounsfield && options.hardness.empty())
      assumed.push_back(fmt::format("hardness is {:g} everywhere: values that are not in HU give no density", kMeshHardness));
  }
  const auto grid = plan_grid(scan, options);
  if (!grid) return grid.error();
  if (before) before(*grid);
  auto builder = BoneModelBuilder::create(grid->dims, grid->bone_from_index);
  if (!builder) return builder.error();

  const bool given = scan.quantity == Quantity::occupancy;
  const Rule rule{given ? kOccupancyBand : meaning.band, meaning.offset, given, meaning.hounsfield, options.hardness};
  // Outside the scan: no bone, independent of the lowest value of the scan.
  const double nothing = std::min(facts.min, rule.band[0] - meaning.offset);
  const Affine scan_from_grid = scan.bone_from_index.inverse() * grid->bone_from_index;
  for (int k = 0; k < grid->dims.z; k += kSlab) {
    const VoxelBox where{{0, 0, k}, {grid->dims.x, grid->dims.y, std::min(k + kSlab, grid->dims.z)}};
    Slab slab{where.size(), {}};
    slab.values.resize(VoxelBox{Vec3i(0), slab.padded()}.count());
    if (grid->resampled)
      fill_resampled(scan, scan_from_grid, static_cast<float>(nothing), k, slab);
    else
      fill_native(scan, k, slab);
    DenseBone part;
    part.occupancy.resize(where.count());
    part.hardness.resize(where.count());
    part.labels.resize(where.count());
    classify(slab, rule, part);
    if (const Status added = builder->add(where, part); !added) return added.error();
  }
  report_cut_region(options, *grid, assumed);
  BoneFromScan out;
  out.has_values = !given;
  out.value_min = facts.min + meaning.offset;
  out.value_max = facts.max + meaning.offset;
  out.hu_offset = meaning.offset;
  out.hounsfield = meaning.hounsfield;
  out.bone = builder->finish(fmt::format("{}", fmt::join(assumed, "\n")));
  if (out.bone->bone_voxels() > 0) return out;
  return bad_input(fmt::format("no bone: values from {:g} to {:g} do not exceed the middle of the band {:g} to {:g}", out.value_min,
                               out.value_max, rule.band[0], rule.band[1]));
}

}  // namespace burrhole
