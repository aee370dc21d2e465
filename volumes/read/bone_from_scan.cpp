#include "volumes/read/bone_from_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/parallel.h"
#include "core/base/units.h"
#include "core/voxel/block_store.h"
#include "volumes/read/label_volume.h"
#include "volumes/read/memory_check.h"
#include "volumes/read/resample.h"
#include "volumes/read/skull_segment.h"

namespace burrhole {
namespace {

constexpr std::array<double, 2> kBoneHu{250.0, 400.0};
constexpr double kMeshHardness = 0.8;  // [-] of a mesh or a fog volume, which have no density: the default of a phantom
constexpr int kSlab = 8;               // layers per step: the edge of an OpenVDB leaf
constexpr std::array<double, 2> kOccupancyBand{0.0, 1.0};
constexpr double kLabelledShare = 1.5;  // [-] of the memory of bone with labels of soft tissue, dura and brain around it

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
                    "file's own values (--bone-hu LO,HI; bone_hu in a scene); if they are HU all the same, --hu-offset 0",
                    facts.min, facts.max,
                    scan.quantity == Quantity::other ? "by modality or RescaleType of the file" : "no air near -1000, nor HU + 1024"));
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

/// Slices far apart miss the tables of a skull, which are 1 to 2 mm thick: what lies between them is a guess, however fine the grid.
void report_thick_slices(const Scan& scan, const BoneGrid& grid, std::vector<std::string>& assumed) {
  constexpr double kThick = 3e-3;  // [m]
  if (!grid.resampled) return;
  const double fine = grid.bone_from_index.mean_edge();
  double apart = 0.0;  // [m] the coarsest
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (scan.dims[axis] > 1) apart = std::max(apart, glm::length(scan.bone_from_index.linear[axis]));
  if (apart < kThick || apart < 2.0 * fine) return;
  assumed.push_back(
      fmt::format("slices are {:.1f} mm apart: voxels of {:.2g} mm show no more than they do, and a thin table between two "
                  "slices is missing",
                  apart / kMillimetre, fine / kMillimetre));
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

/// Row by row on all cores; first the occupancy of a row, then the hardness of its bone.
void classify(const Slab& slab, const Rule& rule, DenseBone& out) {
  const Vec3i size = slab.padded();
  const std::ptrdiff_t dy = size.x, dz = std::ptrdiff_t{size.x} * size.y;
  const float middle = static_cast<float>(0.5 * (rule.band[0] + rule.band[1]));
  const float half_band = static_cast<float>(0.5 * (rule.band[1] - rule.band[0]));
  const float offset = static_cast<float>(rule.offset);
  for_each_number(slab.dims.z * slab.dims.y, [&](int row) {
    const int j = row % slab.dims.y, k = row / slab.dims.y, width = slab.dims.x;
    const float* v = slab.values.data() + (k + 1) * dz + (j + 1) * dy + 1;
    const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    float* occupancy = out.occupancy.data() + at;
    float most = 0.0f;
    for (int i = 0; i < width; ++i) {
      const float here = v[i];
      // A value that is NaN was not needed (resample.h): no step to it, and no bone there. Comparisons with it are false.
      const auto step = [&](std::ptrdiff_t d) {
        const float up = std::abs(v[i + d] - here), down = std::abs(v[i - d] - here);
        const float some = up > 0.0f ? up : 0.0f;
        return down > some ? down : some;
      };
      const auto ramp = [&] { return std::max(half_band, step(1) + step(dy) + step(dz)); };
      const float share = rule.given_occupancy ? here : 0.5f + (here + offset - middle) / (2.0f * ramp());
      occupancy[i] = share > 0.0f ? std::min(share, 1.0f) : 0.0f;
      most = std::max(most, occupancy[i]);
    }
    if (most == 0.0f) {
      std::fill_n(out.hardness.data() + at, width, 0.0f);
      std::fill_n(out.labels.data() + at, width, static_cast<std::uint8_t>(VoxelLabel::none));
      return;
    }
    for (int i = 0; i < width; ++i) {
      const bool has_bone = occupancy[i] > 0.0f;
      out.hardness[at + static_cast<std::size_t>(i)] = has_bone ? rule.hardness_at(static_cast<double>(v[i] + offset)) : 0.0f;
      out.labels[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(occupancy[i] >= 0.5f ? VoxelLabel::bone : VoxelLabel::none);
    }
  });
}

Affine scan_from(const Scan& scan, const BoneGrid& grid) { return scan.bone_from_index.inverse() * grid.bone_from_index; }

/// Air counts as soft tissue in the direction of surfaces, two widths of the band below its middle, and a slope of an eighth of the band from
/// slice to slice is flat: in HU, 25 and 10 per mm in slices 1.9 mm apart. Outside the scan: no bone, independent of the lowest value.
ResampleRule resample_rule(const Scan& scan, const Rule& rule, const BoneGrid& grid, double lowest) {
  const double width = rule.band[1] - rule.band[0], middle = 0.5 * (rule.band[0] + rule.band[1]) - rule.offset;
  return {.slices = {.factor = slice_factor(scan, grid.bone_from_index.mean_edge()),
                     .low = middle - 2.0 * width,
                     .flat = 0.125 * width / glm::length(scan.bone_from_index.linear[2])},
          .nothing = static_cast<float>(std::min(lowest, rule.band[0] - rule.offset)),
          .middle = middle,
          .half_band = 0.5 * width};
}

/// Estimated share of the voxels of the grid in blocks of 8^3 with bone: those that a bone voxel of the scan reaches,
/// and at least a voxel of the grid, since occupancy is above 0 that far beyond the surface. Blocks at the end of the grid count as whole ones, as they take memory.
double share_near_bone(const Scan& scan, const Rule& rule, const BoneGrid& grid) {
  const VoxelBox all{Vec3i(0), scan.dims}, blocks{Vec3i(0), (grid.dims + (kBlockEdge - 1)) / kBlockEdge};
  const auto middle = static_cast<float>(0.5 * (rule.band[0] + rule.band[1]) - rule.offset);
  const Affine grid_from_scan = grid.bone_from_index.inverse() * scan.bone_from_index;
  Vec3 half(0.0);  // trilinear interpolation carries a value as far as the next voxel of the scan
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t axis = 0; axis < 3; ++axis) half[c] += std::abs(grid_from_scan.linear[axis][c]);
  half = glm::max(half, Vec3(1.0));
  std::vector<std::uint8_t> has_bone(blocks.count());
  for_each_voxel(all, [&](const Vec3i& v) {
    if (!(scan.values[all.offset_of(v)] > middle)) return;
    const Vec3 at = grid_from_scan * Vec3(v);
    const Vec3 lo = glm::ceil(at - half), hi = glm::floor(at + half);
    const VoxelBox reached = VoxelBox{floor_int(lo / double{kBlockEdge}), floor_int(hi / double{kBlockEdge}) + 1}.intersect(blocks);
    for_each_voxel(reached, [&](const Vec3i& block) { has_bone[blocks.offset_of(block)] = 1; });
  });
  const auto count = static_cast<double>(std::count(has_bone.begin(), has_bone.end(), std::uint8_t{1}));
  return count * static_cast<double>(kBlockVoxels) / static_cast<double>(VoxelBox{Vec3i(0), grid.dims}.count());
}

/// Labels of layers and of the user, which replace those of classify().
struct Labelling {
  std::optional<SkullSegment> segment;
  std::shared_ptr<const LabelVolume> user;

  void apply(const VoxelBox& where, const Affine& bone_from_index, DenseBone& out) const {
    if (!segment && !user) return;
    for_each_number(where.size().z * where.size().y, [&](int row) {
      const Vec3i size = where.size();
      for (int i = 0; i < size.x; ++i) {
        const std::size_t n = static_cast<std::size_t>(row) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(i);
        const Vec3 p = bone_from_index * Vec3(where.lo + Vec3i(i, row % size.y, row / size.y));
        if (segment) out.labels[n] = static_cast<std::uint8_t>(segment->label(p, out.occupancy[n] >= 0.5f));
        if (const VoxelLabel own = user ? user->at(p) : VoxelLabel::none; own != VoxelLabel::none)
          out.labels[n] = static_cast<std::uint8_t>(own);
      }
    });
  }
};

/// Finds the layers, and adds what was found to the report.
Result<Labelling> make_labelling(const Scan& scan, const BoneOptions& options, const Meaning& meaning, std::vector<std::string>& assumed) {
  Labelling out;
  if (options.segment) {
    if (!meaning.hounsfield)
      return bad_input("the layers of the skull are found by HU, and these values are not in HU: leave out --segment (layers in a scene)");
    out.segment = SkullSegment::find(scan, meaning.offset, 0.5 * (meaning.band[0] + meaning.band[1]), *options.segment);
    assumed.push_back(segment_text(out.segment->facts()));
  }
  if (options.labels) {
    out.user = options.labels;
    for (const NamedLabel& label : out.user->table) assumed.push_back(note_of(label));
  }
  return out;
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
  const double share = options.region || scan.quantity == Quantity::occupancy ? 1.0 : 0.0;
  if (!options.spacing) return BoneGrid{scan.dims, scan.bone_from_index, false, share};
  const double pitch = *options.spacing;
  auto [lo, hi] = bounds_of({Vec3i(0), scan.dims}, scan.bone_from_index);
  if (options.region) {
    const Vec3 low = options.region->centre - 0.5 * options.region->size, high = options.region->centre + 0.5 * options.region->size;
    if (glm::any(glm::greaterThan(low, hi)) || glm::any(glm::lessThan(high, lo)))
      return bad_input(fmt::format("the region round {} mm lies outside the scan, which spans {} to {} mm", mm_text(options.region->centre),
                                   mm_text(lo), mm_text(hi)),
                       options.places.region);
    // On the voxels of the whole scan, so that a region has the values of the whole.
    lo += pitch * glm::max(glm::ceil((low - lo) / pitch - 1e-6), 0.0);
    hi = glm::min(hi, high);
  }
  const Vec3 count = glm::floor((hi - lo) / pitch + 1e-6) + 1.0;
  if (const double voxels = count.x * count.y * count.z; voxels > kMaxResampledVoxels)
    return bad_input(
        fmt::format("{:.0f} x {:.0f} x {:.0f} voxels of {:g} mm are {:.0f} M, more than {:.0f} M: take a coarser spacing, or a "
                    "region (--region-mm with --centre-mm; region_mm in a scene)",
                    count.x, count.y, count.z, pitch / kMillimetre, voxels / 1e6, kMaxResampledVoxels / 1e6),
        options.places.spacing);
  return BoneGrid{Vec3i(count), Affine::scaling(pitch, lo), true, share};
}

std::uint64_t slab_bytes(const Scan& scan, const BoneGrid& grid) noexcept {
  // Of a voxel of a layer: ten layers of values of the scan, eight of the bone's fields, and layers of the scan on the grid's other axes.
  constexpr std::uint64_t kBytes = 250;
  const std::uint64_t slabs = kBytes * VoxelBox{Vec3i(0), {grid.dims.x, grid.dims.y, 1}}.count();
  if (!grid.resampled) return slabs;
  return slabs + resampler_bytes(scan, slice_factor(scan, grid.bone_from_index.mean_edge()), scan_from(scan, grid));
}

Result<double> find_hu_offset(const Scan& scan, const BoneOptions& options) {
  if (scan.values.empty() || scan.quantity == Quantity::occupancy) return bad_input("the scan has no values in HU");
  std::vector<std::string> assumed;
  const auto meaning = find_meaning(scan, collect_facts(scan.values), options, assumed);
  if (!meaning) return meaning.error();
  if (!meaning->hounsfield) return bad_input("the values of the scan are not in HU");
  return meaning->offset;
}

Result<BoneFromScan> make_bone(const Scan& scan, const BoneOptions& options, std::vector<std::string>& assumed,
                               const ChooseStorage& place) {
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
  auto grid = plan_grid(scan, options);
  if (!grid) return grid.error();

  const bool given = scan.quantity == Quantity::occupancy;
  const Rule rule{given ? kOccupancyBand : meaning.band, meaning.offset, given, meaning.hounsfield, options.hardness};
  grid->bone_share = share_near_bone(scan, rule, *grid);
  if (options.segment) grid->bone_share = std::min(1.0, kLabelledShare * grid->bone_share);
  auto labelling = make_labelling(scan, options, meaning, assumed);
  if (!labelling) return labelling.error();
  const Result<BoneStorage> storage = place ? place(*grid) : BoneStorage();
  if (!storage) return storage.error();
  auto builder = BoneModelBuilder::create(grid->dims, grid->bone_from_index, *storage);
  if (!builder) return builder.error();
  const std::optional<double> memory = available_memory();
  std::optional<Resampler> resampler;
  if (grid->resampled) resampler.emplace(scan, resample_rule(scan, rule, *grid, facts.min), scan_from(scan, *grid), grid->dims);
  Slab slab;
  DenseBone part;
  for (int k = 0; k < grid->dims.z; k += kSlab) {
    const VoxelBox where{{0, 0, k}, {grid->dims.x, grid->dims.y, std::min(k + kSlab, grid->dims.z)}};
    slab.dims = where.size();
    slab.values.resize(VoxelBox{Vec3i(0), slab.padded()}.count());
    if (resampler)
      resampler->fill(k, where.hi.z, slab.values);
    else
      fill_native(scan, k, slab);
    part.occupancy.resize(where.count());
    part.hardness.resize(where.count());
    part.labels.resize(where.count());
    classify(slab, rule, part);
    labelling->apply(where, grid->bone_from_index, part);
    if (const Status added = builder->add(where, part); !added) return added.error();
    if (const auto error = memory_error(static_cast<double>(builder->bytes()), memory)) return Error{ErrorCode::unavailable, *error, {}};
  }
  report_cut_region(options, *grid, assumed);
  if (!given) report_thick_slices(scan, *grid, assumed);
  BoneFromScan out;
  out.has_values = !given;
  out.value_min = facts.min + meaning.offset;
  out.value_max = facts.max + meaning.offset;
  out.hu_offset = meaning.offset;
  out.hounsfield = meaning.hounsfield;
  out.surface = 0.5 * (rule.band[0] + rule.band[1]) - rule.offset;
  if (labelling->segment) out.segment = std::make_shared<const SegmentFacts>(labelling->segment->facts());
  out.bone = builder->finish(fmt::format("{}", fmt::join(assumed, "\n")));
  if (const Status read = out.bone->read_status(); !read) return read.error();
  if (out.bone->bone_voxels() > 0) return out;
  return bad_input(fmt::format("no bone: values from {:g} to {:g} do not exceed the middle of the band {:g} to {:g}", out.value_min,
                               out.value_max, rule.band[0], rule.band[1]),
                   options.band ? options.places.band : std::string());
}

}  // namespace burrhole
