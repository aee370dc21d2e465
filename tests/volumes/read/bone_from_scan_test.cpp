#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/units.h"
#include "tests/support/plain_trilinear.h"
#include "volumes/read/bone_from_scan.h"

using namespace burrhole;

namespace {

constexpr double kMm = kMillimetre;

Scan make_scan(const Vec3i& dims, const Affine& bone_from_index, const std::function<double(const Vec3&)>& hu_at) {
  Scan scan{dims, bone_from_index, Quantity::hounsfield, {}};
  for_each_voxel({Vec3i(0), dims}, [&](const Vec3i& v) { scan.values.push_back(static_cast<float>(hu_at(bone_from_index * Vec3(v)))); });
  return scan;
}

/// Ball of 1000 HU in tissue of 40 HU, blurred by a scanner: error function across the surface, sigma 0.5 mm.
constexpr double kBallRadius = 9.0 * kMm, kSigma = 0.5 * kMm;
double ball_hu(const Vec3& p) {
  const double d = glm::length(p) - kBallRadius;
  return 40.0 + 960.0 * 0.5 * std::erfc(d / (std::sqrt(2.0) * kSigma));
}

/// Twin of the sampling, written for one point at a time: fields of the model at the eight corners.
double occupancy_at(const BoneModel& bone, const Vec3& p_bone) {
  return test::plain_trilinear(bone.bone_from_index().inverse() * p_bone, [&](const Vec3i& v) { return bone.occupancy(v); });
}

/// Distance from the middle at which a ray meets the 0.5 level.
double level_along(const std::function<double(const Vec3&)>& field, double level, const Vec3& direction) {
  double inside = 0.5 * kBallRadius, outside = 1.4 * kBallRadius;
  for (int n = 0; n < 50; ++n) (field(direction * (0.5 * (inside + outside))) >= level ? inside : outside) = 0.5 * (inside + outside);
  return 0.5 * (inside + outside);
}

std::vector<Vec3> directions() {
  std::vector<Vec3> out;
  for (int n = 0; n < 200; ++n) {  // golden spiral
    const double z = 1.0 - (2.0 * n + 1.0) / 200.0, turn = 2.399963229728653 * n;
    out.push_back({std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z});
  }
  return out;
}

/// Largest distance along 200 rays between the model's 0.5 level and the ball's own 325 HU level.
double surface_error(const BoneModel& bone) {
  double worst = 0.0;
  for (const Vec3& d : directions()) {
    const double felt = level_along([&](const Vec3& p) { return occupancy_at(bone, p); }, 0.5, d);
    const double real = level_along(ball_hu, 325.0, d);
    worst = std::max(worst, std::abs(felt - real));
  }
  return worst;
}

const Affine kMillimetreGrid{Mat3(0.5 * kMm, 0, 0, 0, 0.5 * kMm, 0, 0, 0, 1.0 * kMm), Vec3(-12.0 * kMm)};
Scan ball_scan() { return make_scan({49, 49, 25}, kMillimetreGrid, ball_hu); }

}  // namespace

TEST_CASE("density: the check values of the k-Wave line, and never below zero") {
  // Values as tabled with the four lines, to the unit they are printed in.
  CHECK(std::abs(density_of_hounsfield(0) - 1012) < 0.5);
  CHECK(std::abs(density_of_hounsfield(300) - 1210) < 0.5);
  CHECK(std::abs(density_of_hounsfield(1000) - 1674) < 0.5);
  CHECK(std::abs(density_of_hounsfield(1500) - 2005) < 0.5);
  CHECK(density_of_hounsfield(-1000) == 0.0);
  CHECK(density_of_hounsfield(-3024) == 0.0);
  CHECK(hardness_of_hounsfield(40) == 0.0);
  CHECK(hardness_of_hounsfield(3000) == 1.0);
}

TEST_CASE("hardness table: linear between corners, flat outside") {
  const std::vector<HardnessPoint> table{{100, 0.2}, {300, 0.6}, {500, 0.5}};
  CHECK(hardness_of_table(table, 0) == 0.2);
  CHECK(std::abs(hardness_of_table(table, 200) - 0.4) < 1e-15);
  CHECK(std::abs(hardness_of_table(table, 400) - 0.55) < 1e-15);
  CHECK(hardness_of_table(table, 900) == 0.5);
}

TEST_CASE("make_bone: the felt surface is the scan's own, to a fraction of a voxel, as scanned and refined") {
  std::vector<std::string> assumed;
  const auto native = make_bone(ball_scan(), {}, assumed);
  REQUIRE(native);
  BoneOptions options;
  options.spacing = 0.25 * kMm;
  const auto fine = make_bone(ball_scan(), options, assumed);
  REQUIRE(fine);
  CHECK(fine->bone->dims() == Vec3i(97));
  const double of_native = surface_error(*native->bone), of_fine = surface_error(*fine->bone);
  MESSAGE("0.5 level against 325 HU: native ", of_native / kMm, " mm, refined ", of_fine / kMm, " mm");
  // An edge of sigma = half a slice, sampled at every phase of the slice on a line: Catmull-Rom misses the 325 HU level by up to 0.118 mm,
  // linear interpolation by up to 0.160 mm; the import, along surfaces, must not exceed the former. Beside that, the two ends of a cell have ramps of different widths: a tenth of the finer voxel.
  CHECK(of_native < 0.160 * kMm + 0.1 * 0.5 * kMm);
  CHECK(of_fine < 0.118 * kMm + 0.1 * 0.25 * kMm);
}

TEST_CASE("make_bone: slices far apart are reported where finer voxels are asked for") {
  const auto lines = [](double apart, bool fine) {
    const Scan scan = make_scan(
        {49, 49, 9}, {Mat3(Vec3(kMm, 0, 0), Vec3(0, kMm, 0), Vec3(0, 0, apart)), Vec3(-24 * kMm, -24 * kMm, -4 * apart)}, ball_hu);
    BoneOptions options;
    if (fine) options.spacing = 0.5 * kMm;
    std::vector<std::string> assumed;
    REQUIRE(make_bone(scan, options, assumed));
    return std::ranges::count_if(assumed, [](const std::string& line) { return line.find("mm apart") != std::string::npos; });
  };
  CHECK(lines(7.4 * kMm, true) == 1);
  CHECK(lines(7.4 * kMm, false) == 0);  // as scanned: no voxel is finer than the slices
  CHECK(lines(1.9 * kMm, true) == 0);
}

TEST_CASE("make_bone: a ramp of the band alone is off by more, so the widened one is needed") {
  // Sabotage twin: the same scan, classified by the band only.
  const Scan scan = ball_scan();
  DenseBone plain{scan.dims, scan.bone_from_index, {}, {}, {}, {}};
  for (const float v : scan.values) plain.occupancy.push_back(std::clamp((v - 250.0f) / 150.0f, 0.0f, 1.0f));
  plain.hardness.assign(plain.occupancy.size(), 0.5f);
  const auto bone = BoneModel::create(plain);
  REQUIRE(bone);
  CHECK(surface_error(**bone) > 0.2 * kMm);
}

TEST_CASE("make_bone: voxels far from the surface are exactly 0 and 1, hardness is by density, soft tissue has none") {
  std::vector<std::string> assumed;
  const auto made = make_bone(ball_scan(), {}, assumed);
  REQUIRE(made);
  const Affine index = kMillimetreGrid.inverse();
  const Vec3i middle(index * Vec3(0.0)), corner(1);
  CHECK(made->bone->occupancy(middle) == 1.0f);
  CHECK(made->bone->label(middle) == VoxelLabel::bone);
  CHECK(made->bone->occupancy(corner) == 0.0f);
  float hardness[1] = {0.0f};
  made->bone->read_hardness({middle, middle + 1}, hardness);
  CHECK(std::abs(static_cast<double>(hardness[0]) - (1674.0 - 1100.0) / 800.0) < 1e-3);  // density is tabled to the unit
  made->bone->read_hardness({corner, corner + 1}, hardness);
  CHECK(hardness[0] == 0.0f);
  // Bone box: the ball, to a voxel.
  CHECK(glm::length(bounds_of(made->bone->bone_box(), made->bone->bone_from_index()).hi - Vec3(kBallRadius)) < std::sqrt(3.0) * 1.0 * kMm);
}

TEST_CASE("make_bone: a region lies on the voxels of the whole and has its values") {
  std::vector<std::string> assumed;
  BoneOptions options;
  options.spacing = 0.37 * kMm;
  const auto whole = make_bone(ball_scan(), options, assumed);
  REQUIRE(whole);
  const BoneModel& all = *whole->bone;
  for (const double off : {0.0, 0.123, 0.3}) {
    options.region = BoneRegion{Vec3(1.0 + off, -2.0, 3.0 + 2.0 * off) * kMm, Vec3(9.0, 7.0, 8.0) * kMm};
    const auto part = make_bone(ball_scan(), options, assumed);
    REQUIRE(part);
    const BoneModel& region = *part->bone;
    const Vec3 place = all.bone_from_index().inverse() * region.bone_from_index().offset;
    const Vec3i at(glm::round(place));
    CHECK(glm::length(place - Vec3(at)) < 1e-6);
    CHECK(glm::all(glm::lessThanEqual(region.bone_from_index().offset, options.region->centre)));
    double worst = 0.0, most = 0.0;
    for_each_voxel(region.bounds(), [&](const Vec3i& v) {
      worst = std::max(worst, std::abs(static_cast<double>(region.occupancy(v) - all.occupancy(at + v))));
      most = std::max(most, static_cast<double>(region.occupancy(v)));
    });
    CHECK(most == 1.0);
    // At the faces of the region the ramp knows neighbours outside it, as that of the whole does.
    CHECK(worst < 1e-5);  // floats of 1000 HU, rounded at places that differ by 1e-16 m
  }
}

TEST_CASE("make_bone: one slab, many slabs and odd sizes give the same fields as the voxel on its own") {
  // The plain twin: each voxel by the formula of the header, from the whole scan.
  const Vec3i dims(7, 5, 19);
  Scan scan{dims, Affine::scaling(kMm, Vec3(0.0)), Quantity::hounsfield, {}};
  unsigned state = 1;
  for (std::size_t n = 0; n < VoxelBox{Vec3i(0), dims}.count(); ++n) {
    state = state * 1664525u + 1013904223u;
    scan.values.push_back(static_cast<float>(state >> 20) - 1000.0f);
  }
  std::vector<std::string> assumed;
  const auto made = make_bone(scan, {}, assumed);
  REQUIRE(made);
  const VoxelBox box{Vec3i(0), dims};
  double worst = 0.0;
  for_each_voxel(box, [&](const Vec3i& v) {
    const auto hu = [&](Vec3i w) { return static_cast<double>(scan.values[box.offset_of(glm::clamp(w, Vec3i(0), dims - 1))]); };
    double steps = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      Vec3i d(0);
      d[c] = 1;
      steps += std::max(std::abs(hu(v + d) - hu(v)), std::abs(hu(v - d) - hu(v)));
    }
    const double expected = std::clamp(0.5 + (hu(v) - 325.0) / (2.0 * std::max(75.0, steps)), 0.0, 1.0);
    worst = std::max(worst, std::abs(expected - static_cast<double>(made->bone->occupancy(v))));
  });
  CHECK(worst < 1e-6);  // floats near 1
}

TEST_CASE("make_bone: HU + 1024 is found out and reported; values that mean nothing are refused") {
  Scan offset = ball_scan();
  offset.quantity = Quantity::unknown;
  for (float& v : offset.values) v += 1024.0f;
  std::vector<std::string> assumed;
  const auto made = make_bone(offset, {}, assumed);
  REQUIRE(made);
  CHECK(made->hu_offset == -1024.0);
  CHECK(assumed.size() == 1);

  Scan window = ball_scan();
  window.quantity = Quantity::unknown;
  for (float& v : window.values) v = v / 4.0f;
  const auto refused = make_bone(window, {}, assumed);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("not Hounsfield units") != std::string::npos);
  BoneOptions options;
  options.band = {62.5, 100.0};
  const auto banded = make_bone(window, options, assumed);
  REQUIRE(banded);
  CHECK(surface_error(*banded->bone) < 0.2 * kMm);  // as the native one above

  Scan soft = ball_scan();
  for (float& v : soft.values) v = std::min(v, 300.0f);
  const auto none = make_bone(soft, {}, assumed);
  REQUIRE_FALSE(none);
  CHECK(none.error().message.find("no bone") != std::string::npos);
}

TEST_CASE("plan_grid: a region is cut to the scan, a miss and a giant are refused with the numbers") {
  const Scan scan = ball_scan();
  BoneOptions options;
  options.region = BoneRegion{Vec3(0, 0, 9 * kMm), Vec3(8 * kMm)};
  CHECK_FALSE(plan_grid(scan, options));  // no spacing
  options.spacing = 0.5 * kMm;
  const auto grid = plan_grid(scan, options);
  REQUIRE(grid);
  CHECK(grid->dims == Vec3i(17, 17, 15));  // the scan ends at z = 12 mm
  CHECK(glm::length(grid->bone_from_index * Vec3(0.0) - Vec3(-4, -4, 5) * kMm) < 1e-12);
  options.region->centre = Vec3(0, 0, 90 * kMm);
  CHECK_FALSE(plan_grid(scan, options));
  options.region.reset();
  options.spacing = 0.01 * kMm;
  const auto giant = plan_grid(scan, options);
  REQUIRE_FALSE(giant);
  CHECK(giant.error().message.find("M") != std::string::npos);
}

TEST_CASE("make_bone: a sheared scan keeps its shear, and refining straightens it in the right place") {
  const Affine sheared{Mat3(1, 0, 0, 0, 1, 0, 0.3, 0.1, 1.2) * kMm, Vec3(-14, -14, -14) * kMm};
  const Scan scan = make_scan({37, 31, 25}, sheared, ball_hu);
  std::vector<std::string> assumed;
  const auto native = make_bone(scan, {}, assumed);
  REQUIRE(native);
  CHECK(native->bone->bone_from_index().linear == sheared.linear);
  BoneOptions options;
  options.spacing = 0.5 * kMm;
  const auto fine = make_bone(scan, options, assumed);
  REQUIRE(fine);
  // As above with slices 1.2 mm apart; the error of the cubic grows with the third power: 0.118 * 1.2^3.
  CHECK(surface_error(*fine->bone) < 0.2 * kMm);
}

TEST_CASE("make_bone: bone at the scan's border neither grows nor vanishes when an oblique scan is refined") {
  for (const double degrees : {0.0, 15.0, 30.0}) {
    const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
    const Affine turned{Mat3(1, 0, 0, 0, c, s, 0, -s, c) * kMm, Vec3(0.0)};
    const Scan block = make_scan({30, 30, 30}, turned, [](const Vec3&) { return 1000.0; });
    BoneOptions options;
    options.spacing = 0.5 * kMm;
    std::vector<std::string> assumed;
    const auto made = make_bone(block, options, assumed);
    REQUIRE(made);
    const double volume = static_cast<double>(made->bone->bone_voxels()) * 0.125;  // [mm3]
    // Voxel cells of 30^3, less what the grid, which spans the centres, leaves of the outer halves: all of it when straight.
    MESSAGE(degrees << " degrees: " << volume << " mm3");
    CHECK(volume <= 30.0 * 30.0 * 30.0 * 1.02);  // counting half-millimetre voxels on a turned face: 2 %
    CHECK(volume >= 29.0 * 29.0 * 29.0);
  }
}

TEST_CASE("make_bone: one absurd voxel does not change the hardness of the others") {
  Scan hot = ball_scan();
  hot.values.front() = 1e9f;
  std::vector<std::string> assumed;
  const auto made = make_bone(hot, {}, assumed), plain = make_bone(ball_scan(), {}, assumed);
  REQUIRE(made);
  REQUIRE(plain);
  const Vec3i middle(kMillimetreGrid.inverse() * Vec3(0.0));
  float hardness[1] = {0.0f}, expected[1] = {0.0f};
  made->bone->read_hardness({middle, middle + 1}, hardness);
  plain->bone->read_hardness({middle, middle + 1}, expected);
  CHECK(hardness[0] == expected[0]);
  CHECK(hardness[0] > 0.5f);
}

TEST_CASE("make_bone: padding does not pass for air, nor a spread of arbitrary numbers for HU") {
  Scan padded = ball_scan();
  padded.quantity = Quantity::unknown;
  const VoxelBox box{Vec3i(0), padded.dims};
  for_each_voxel(box, [&](const Vec3i& v) {
    float& value = padded.values[box.offset_of(v)];
    value = glm::length(Vec3(v) - Vec3(24, 24, 12)) > 26.0 ? -2000.0f : value + 1024.0f;  // outside the field of view
  });
  std::vector<std::string> assumed;
  const auto made = make_bone(padded, {}, assumed);
  REQUIRE(made);
  CHECK(made->hu_offset == -1024.0);

  Scan swapped = ball_scan();  // the other byte order
  swapped.quantity = Quantity::unknown;
  unsigned state = 7;
  for (float& value : swapped.values) {
    state = state * 1664525u + 1013904223u;
    value = static_cast<float>(static_cast<int>(state >> 16) - 32768);
  }
  CHECK_FALSE(make_bone(swapped, {}, assumed));
}

TEST_CASE("make_bone: a band is in HU where the scan is, and in the file's own values where it is not") {
  Scan offset = ball_scan();
  offset.quantity = Quantity::unknown;
  for (float& v : offset.values) v += 1024.0f;
  BoneOptions options;
  options.band = {250.0, 400.0};  // the default said aloud changes nothing
  std::vector<std::string> assumed;
  const auto said = make_bone(offset, options, assumed), unsaid = make_bone(offset, {}, assumed);
  REQUIRE(said);
  REQUIRE(unsaid);
  CHECK(said->hounsfield);
  CHECK(said->bone->bone_voxels() == unsaid->bone->bone_voxels());
}

TEST_CASE("make_bone: what was assumed goes with the bone, and a region that the scan does not fill is reported") {
  BoneOptions options;
  options.spacing = 0.5 * kMm;
  options.region = BoneRegion{Vec3(0, 0, 9 * kMm), Vec3(8 * kMm)};
  std::vector<std::string> assumed{"something"};
  const auto made = make_bone(ball_scan(), options, assumed);
  REQUIRE(made);
  CHECK(made->bone->notes().starts_with("something\nthe scan ends within the region: (8.0, 8.0, 7.0) mm"));
}
