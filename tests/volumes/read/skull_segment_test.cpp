// The layers of a skull, against phantoms with known borders at the spacing, blur and noise of both scanners of the real data: Dice of each
// layer, distance of each border; a shell of one material has one label; and the checks fail on wrong labels.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/base/units.h"
#include "tests/volumes/read/scanned_skull.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/layer_profile.h"
#include "volumes/read/skull_segment.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kMm = kMillimetre;
constexpr double kSurfaceHu = 325.0;  // the middle of the default band

struct Device {
  const char* name;
  Scanner scanner;
};

/// Spacing of the real scans. The blur is that of a clinical kernel (10 % of the contrast at about 8 line pairs per cm: 0.4 mm) and of a bone
/// kernel; the noise is 15 and 60 HU, as the standard deviation in brain of the cadaver's scan and in the head phantom's (assumption).
std::array<Device, 2> devices() {
  Scanner coarse, fine;
  coarse.spacing = Vec3(0.94e-3, 0.94e-3, 1.88e-3);
  coarse.blur = 0.4e-3;
  coarse.noise = 15.0;
  coarse.phase = 0.3;
  fine.spacing = Vec3(0.4512e-3, 0.4512e-3, 1.0e-3);
  fine.blur = 0.3e-3;
  fine.noise = 60.0;
  fine.phase = 0.3;
  return {Device{"0.94 x 0.94 x 1.88 mm", coarse}, Device{"0.45 x 0.45 x 1 mm", fine}};
}

/// What may be expected of a border. The value of a voxel is a mean over its box, of variance h^2 / 12 on each axis, and interpolation adds as
/// much again: the edge of a layer is blurred by s = sqrt(blur^2 + h^2 / 6), h the voxel's mean edge. Linear interpolation of samples a
/// distance h apart is off by at most h^2 / 8 times the second derivative, 0.242 / s^2 of the height of the edge, where the slope is
/// 0.399 / s of it: the place of a level by 0.076 h^2 / s. The levels themselves come from peaks that are interpolated in the same way: twice
/// that. Noise n changes the place by n s sqrt(2 pi) / 600 HU over the root of the number of columns averaged, 4 pi (2.5 mm)^2 / 1 mm^2 = 79:
/// below 0.02 mm. Reading labels of voxels of 0.3 mm adds a quarter of their edge. The surface of bone is the place of 325 HU, not that of
/// half of the table's height: it lies outside the true one by s times the quantile of (325 - 40) / (1500 - 40) = 0.195, 0.86 s, to which
/// the interpolation and the voxels are added.
struct Expected {
  double border, surface;  // [m]
};
Expected expected_of(const Scanner& s) {
  const double h = std::cbrt(s.spacing.x * s.spacing.y * s.spacing.z), blur = std::sqrt(s.blur * s.blur + h * h / 6.0);
  const double read = 0.02e-3 + 0.25 * 0.3e-3, place = 0.076 * h * h / blur;
  return {2.0 * place + read, place + read + 0.86 * blur};
}
/// Two borders that are off by a and b, one of them inwards: of a layer of thickness t at least t - a - b is labelled, and no more than t. So
/// the Dice coefficient is at least 2 (t - a - b) / (2 t - a - b).
double least_dice(double t, double a, double b) { return 2.0 * (t - a - b) / (2.0 * t - a - b); }

using Labelling = std::function<VoxelLabel(const Vec3&, bool)>;

struct Quality {
  std::map<VoxelLabel, double> dice;
  std::array<double, 4> border{};  // [m] mean distance of the borders: outer surface, two between layers, inner surface
};

/// On voxels of 0.3 mm, and on lines through the centre in 300 directions.
Quality measure(const Skull& skull, const BoneModel& bone, const Labelling& label) {
  Quality out;
  std::map<VoxelLabel, std::size_t> both, ours, truth;
  const Affine& map = bone.bone_from_index();
  const auto is_bone = [&](const Vec3i& v) { return bone.occupancy(v) >= 0.5f; };
  for_each_voxel(bone.bounds(), [&](const Vec3i& v) {
    const Vec3 p = map * Vec3(v);
    if (glm::length(p) < skull.radius - 10e-3 || glm::length(p) > skull.radius + 2e-3) return;
    const VoxelLabel a = label(p, is_bone(v)), b = skull.label(p);
    ++ours[a];
    ++truth[b];
    if (a == b) ++both[a];
  });
  const std::array layers{VoxelLabel::outer_table, VoxelLabel::diploe, VoxelLabel::inner_table};
  for (const VoxelLabel layer : layers)
    out.dice[layer] = 2.0 * static_cast<double>(both[layer]) / static_cast<double>(ours[layer] + truth[layer]);
  const Affine index = map.inverse();
  constexpr int kLines = 300;
  for (std::uint64_t n = 0; n < kLines; ++n) {
    const Vec3 way = glm::normalize(Vec3(uniform11(7, 3 * n), uniform11(7, 3 * n + 1), uniform11(7, 3 * n + 2)));
    std::array<double, 4> found{};
    std::array<double, 3> seen{};
    constexpr double kStep = 0.05e-3;
    double first = -1.0, last = 0.0;
    for (double depth = -3e-3; depth < 11e-3; depth += kStep) {
      const Vec3 p = way * (skull.radius - depth);
      const bool solid = is_bone(voxel_of(index * p));
      const VoxelLabel here = label(p, solid);
      for (std::size_t l = 0; l < 3; ++l) seen[l] += here == layers[l] ? kStep : 0.0;
      if (!solid) continue;
      if (first < -0.5) first = depth;
      last = depth;
    }
    found = {first, first + seen[0], last - seen[2], last};
    for (std::size_t b = 0; b < 4; ++b) out.border[b] += std::abs(found[b] - skull.borders()[b]) / kLines;
  }
  return out;
}

/// @returns the number of measures that are worse than expected.
int count_failures(const Skull& skull, const Scanner& scanner, const Quality& q) {
  const Expected e = expected_of(scanner);
  int out = 0;
  out += q.dice.at(VoxelLabel::outer_table) < least_dice(skull.outer_table, e.surface, e.border) ? 1 : 0;
  out += q.dice.at(VoxelLabel::diploe) < least_dice(skull.diploe, e.border, e.border) ? 1 : 0;
  out += q.dice.at(VoxelLabel::inner_table) < least_dice(skull.inner_table, e.border, e.surface) ? 1 : 0;
  for (const std::size_t b : {std::size_t{1}, std::size_t{2}}) out += q.border[b] > e.border ? 1 : 0;
  for (const std::size_t b : {std::size_t{0}, std::size_t{3}}) out += q.border[b] > e.surface ? 1 : 0;
  return out;
}

BoneOptions options_of(double spacing, const SegmentOptions& segment = {}) {
  BoneOptions out;
  out.spacing = spacing;
  out.segment = std::make_shared<const SegmentOptions>(segment);
  return out;
}

BoneFromScan import(const Scan& scan, const BoneOptions& options) {
  std::vector<std::string> assumed;
  auto made = make_bone(scan, options, assumed);
  REQUIRE(made);
  return std::move(made).value();
}

void print(const char* name, const Skull& skull, const Scanner& scanner, const Quality& q) {
  const Expected e = expected_of(scanner);
  fmt::print(
      "{}: Dice outer {:.3f} (least {:.3f}), diploe {:.3f} ({:.3f}), inner {:.3f} ({:.3f}); borders {:.3f} {:.3f} {:.3f} {:.3f} mm (most "
      "{:.3f}, {:.3f})\n",
      name, q.dice.at(VoxelLabel::outer_table), least_dice(skull.outer_table, e.surface, e.border), q.dice.at(VoxelLabel::diploe),
      least_dice(skull.diploe, e.border, e.border), q.dice.at(VoxelLabel::inner_table), least_dice(skull.inner_table, e.border, e.surface),
      q.border[0] / kMm, q.border[1] / kMm, q.border[2] / kMm, q.border[3] / kMm, e.surface / kMm, e.border / kMm);
}

}  // namespace

TEST_CASE("segment: layers of a phantom are found at the spacing and noise of both scanners, and wrong labels are not") {
  for (const Device& device : devices()) {
    CAPTURE(device.name);
    const Skull skull;
    const Scan scan = scan_skull(skull, device.scanner);
    const BoneFromScan made = import(scan, options_of(0.3e-3));
    const BoneModel& bone = *made.bone;
    const Affine index = bone.bone_from_index().inverse();
    const Quality own = measure(skull, bone, [&](const Vec3& p, bool) { return bone.label(voxel_of(index * p)); });
    print(device.name, skull, device.scanner, own);
    CHECK(count_failures(skull, device.scanner, own) == 0);
    REQUIRE(made.segment);
    CHECK(made.segment->layers == 3);
    CHECK(made.segment->layered_share > 0.9);
    const Expected e = expected_of(device.scanner);
    CHECK(std::abs(made.segment->outer_table.median - skull.outer_table) < e.border);
    CHECK(std::abs(made.segment->inner_table.median - skull.inner_table) < e.border);
    CHECK(std::abs(made.segment->diploe.median - skull.diploe) < e.border);

    // Sabotage: the labels of places half a millimetre and a mean voxel's edge further out; tables exchanged; no layers at all.
    const auto segment = SkullSegment::find(scan, 0.0, kSurfaceHu, {});
    const double off = 2.0 * e.border + 0.5e-3;
    CHECK(count_failures(skull, device.scanner, measure(skull, bone, [&](const Vec3& p, bool solid) {
                           return segment.label(p + off * glm::normalize(p), solid);
                         })) > 0);
    CHECK(count_failures(skull, device.scanner, measure(skull, bone, [&](const Vec3& p, bool solid) {
                           const VoxelLabel l = segment.label(p, solid);
                           return l == VoxelLabel::outer_table   ? VoxelLabel::inner_table
                                  : l == VoxelLabel::inner_table ? VoxelLabel::outer_table
                                                                 : l;
                         })) > 0);
    CHECK(count_failures(skull, device.scanner,
                         measure(skull, bone, [&](const Vec3&, bool solid) { return solid ? VoxelLabel::bone : VoxelLabel::none; })) > 0);
  }
}

TEST_CASE("segment: a shell of one material has one layer, at the noise of both scanners") {
  for (const Device& device : devices()) {
    CAPTURE(device.name);
    Skull skull;
    skull.diploe_hu = skull.table_hu;
    const BoneFromScan made = import(scan_skull(skull, device.scanner), options_of(1e-3));
    REQUIRE(made.segment);
    CHECK(made.segment->layers == 1);
    CHECK(made.segment->layered_share < 0.1);
    bool layered = false;
    for_each_voxel(made.bone->bounds(), [&](const Vec3i& v) {
      const VoxelLabel label = made.bone->label(v);
      layered = layered || (label >= VoxelLabel::outer_table && label <= VoxelLabel::inner_table);
    });
    CHECK_FALSE(layered);
  }
}

TEST_CASE("segment: soft tissue lies outside, dura and brain inside, and air has no label") {
  const Skull skull;
  const Scan scan = scan_skull(skull, devices()[0].scanner);
  const auto segment = SkullSegment::find(scan, 0.0, kSurfaceHu, {});
  const auto at = [&](double depth, bool solid) {
    return segment.label((skull.radius - depth) * glm::normalize(Vec3(0.3, -0.5, 0.8)), solid);
  };
  CHECK(at(-3.0 * kMm, false) == VoxelLabel::soft_tissue);
  CHECK(at(-7.0 * kMm, false) == VoxelLabel::none);
  CHECK(at(1.0 * kMm, true) == VoxelLabel::outer_table);
  CHECK(at(3.9 * kMm, true) == VoxelLabel::diploe);
  CHECK(at(6.3 * kMm, true) == VoxelLabel::inner_table);
  // The inner surface at 325 HU lies at most surface(expected) below the true one.
  const double below = skull.thickness() + expected_of(devices()[0].scanner).surface;
  CHECK(at(below + 2.0 * kMm, false) == VoxelLabel::brain);
  bool dura = false;
  for (double depth = skull.thickness() - 0.5 * kMm; depth < below + 0.5 * kMm; depth += 0.05 * kMm)
    dura = dura || at(depth, false) == VoxelLabel::dura;
  CHECK(dura);
  CHECK(at(30.0 * kMm, false) == VoxelLabel::none);
  const double cavity = 4.0 / 3.0 * 3.14159265 * std::pow(skull.radius - skull.thickness(), 3);
  // Cubes of 2.5 mm that hold bone do not count: up to a cube and its diagonal, 5 mm, of 38 mm.
  CHECK(segment.facts().cavity < cavity);
  CHECK(segment.facts().cavity > cavity * std::pow(33.0 / 38.0, 3));
}

TEST_CASE("segment: a headrest round the skull encloses nothing, though there is more space between the two than in the skull") {
  const Skull skull;
  Scan scan = scan_skull(skull, devices()[0].scanner);
  const auto alone = SkullSegment::find(scan, 0.0, kSurfaceHu, {});
  const VoxelBox all{Vec3i(0), scan.dims};
  for_each_voxel(all, [&](const Vec3i& v) {
    const Vec3i last = scan.dims - 1 - v;
    if (std::min({v.x, v.y, last.x, last.y}) < 2) scan.values[all.offset_of(v)] = 1000.0f;  // four walls, 4 mm beyond the skin
  });
  const auto segment = SkullSegment::find(scan, 0.0, kSurfaceHu, {});
  CHECK(segment.facts().cavity == alone.facts().cavity);
  CHECK(segment.facts().layered_share == doctest::Approx(alone.facts().layered_share).epsilon(0.02));
  for (const double depth : {-7.0, -3.0, 1.0, 3.9, 6.3, 10.0, 30.0}) {
    CAPTURE(depth);
    const bool solid = depth > 0.0 && depth < 7.0;
    const Vec3 at = (skull.radius - depth * kMm) * glm::normalize(Vec3(0.3, -0.5, 0.8));
    CHECK(segment.label(at, solid) == alone.label(at, solid));
  }
}

TEST_CASE("segment: no skull is found in a scan without a cavity, and bone then has one label") {
  Scan scan;
  scan.quantity = Quantity::hounsfield;
  scan.dims = Vec3i(40);
  scan.bone_from_index = Affine::scaling(kMm, Vec3(0.0));
  const VoxelBox all{Vec3i(0), scan.dims};
  scan.values.assign(all.count(), -1000.0f);
  for_each_voxel({Vec3i(10), Vec3i(30)}, [&](const Vec3i& v) { scan.values[all.offset_of(v)] = 1000.0f; });
  const BoneFromScan made = import(scan, [] {
    BoneOptions o;
    o.segment = std::make_shared<const SegmentOptions>();
    return o;
  }());
  REQUIRE(made.segment);
  CHECK(made.segment->layers == 0);
  CHECK(made.bone->label(Vec3i(20)) == VoxelLabel::bone);
}

TEST_CASE("segment: values that are not in HU are refused") {
  Scan scan = scan_skull({}, devices()[0].scanner);
  scan.quantity = Quantity::other;
  BoneOptions options = options_of(1e-3);
  options.band = {250.0, 400.0};
  std::vector<std::string> assumed;
  CHECK_FALSE(make_bone(scan, options, assumed));
}

TEST_CASE("segment: each option changes what is found") {
  const Skull skull;
  const Scan scan = scan_skull(skull, devices()[0].scanner);
  const auto facts = [&](const SegmentOptions& o) { return SkullSegment::find(scan, 0.0, kSurfaceHu, o).facts(); };
  const SegmentFacts base = facts({});
  CHECK(facts({.air = -100.0}).air > base.air);
  CHECK(facts({.least_dip = 0.9}).layers == 1);
  CHECK(facts({.least_table = 3e-3}).inner_table.median > 2.9e-3);
  CHECK(facts({.smoothing = 6e-3}).outer_table.high - facts({.smoothing = 6e-3}).outer_table.low <
        base.outer_table.high - base.outer_table.low);
  CHECK(facts({.blur = 0.2e-3}).blur.median == 0.2e-3);
  const Vec3 way = glm::normalize(Vec3(0.3, -0.5, 0.8));
  const auto thick = SkullSegment::find(scan, 0.0, kSurfaceHu, {.dura = 3e-3});
  CHECK(thick.label((skull.radius - skull.thickness() - 2.5 * kMm) * way, false) == VoxelLabel::dura);
}

TEST_CASE("layer profile: borders of a blurred profile of closed form are found within a tenth of a millimetre") {
  // Samples of 0.25 mm of a Gaussian blur: no noise, so what remains is the sampling, h^2 / (8 s) = 0.02 mm, and the end of the iteration.
  for (const double blur : {0.3e-3, 0.6e-3, 0.9e-3})
    for (const double outer : {1.2e-3, 2.4e-3}) {
      CAPTURE(blur);
      CAPTURE(outer);
      const double inner = 1.7e-3, thickness = 8e-3;
      const auto step = [&](double x) { return 0.5 * std::erfc(-x / (blur * std::sqrt(2.0))); };
      LayerProfile p{-3e-3, 0.25e-3, {}};
      for (double d = -3e-3; d < 11.01e-3; d += 0.25e-3)
        p.values.push_back(static_cast<float>(40.0 + 1460.0 * step(d) - 600.0 * step(d - outer) + 600.0 * step(d - thickness + inner) -
                                              1460.0 * step(d - thickness)));
      const LayerBorders b = find_layers(p, {.thickness = thickness, .most_value = 1650.0, .blur = blur});
      REQUIRE(b.is_layered);
      CHECK(std::abs(b.outer_edge) < 0.1e-3);
      CHECK(std::abs(b.outer - outer) < 0.1e-3);
      CHECK(std::abs(b.inner - (thickness - inner)) < 0.1e-3);
      CHECK(std::abs(b.inner_edge - thickness) < 0.1e-3);
      const LayerBorders estimated = find_layers(p, {.thickness = thickness, .most_value = 1650.0});
      CHECK(estimated.blur == doctest::Approx(blur).epsilon(0.2));
    }
}
