// Recession of a face against closed forms: mass, position, and shape, for tools that enter bone from outside, and for one placed inside.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/random.h"
#include "core/drill/cut_face.h"
#include "tests/core/drill/subvoxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

// [-] per voxel of the width of a face, by which 20 restored pieces of drilling may differ from one in one go: each finds the face anew from
// the density, where it is a ramp as wide as the face. At first nothing was removed by such pieces.
constexpr double kRestored = 0.08;
constexpr double kFactor = 0.1, kSpin = 1000.0 / 60.0, kRate = kFactor * kSpin;  // [1/rev], [rev/s], [1/s] at hardness 1

/// A plate whose face lies at `top` [voxels] along k, bone below it. The density is linear across it, so that its 0.5 level is exact.
struct Plate {
  double soft = 1.0;       ///< [voxels] width of the density's slope across the face: a scan blurs it over several
  double voxel = 0.25e-3;  ///< [m]
  double across = 7e-3;    ///< [m]
  double top = 20.3;       ///< [voxels]
  float hardness = 1.0f;
  [[nodiscard]] Voxmap make() const {
    const int n = static_cast<int>(std::ceil(across / voxel)) + 16;
    DenseBone dense;
    dense.dims = Vec3i(n, n, static_cast<int>(std::ceil(top)) + 20);
    dense.bone_from_index = Affine::scaling(voxel, Vec3(0.0));
    for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
      dense.occupancy.push_back(static_cast<float>(std::clamp(0.5 + 0.5 * (top - v.z) / soft, 0.0, 1.0)));
      dense.hardness.push_back(hardness);
    });
    return voxmap_of(dense);
  }
  [[nodiscard]] Vec3 middle() const { return Vec3(Vec3(0.5, 0.5, 0.0) * (std::ceil(across / voxel) + 16.0)) + Vec3(0.13, -0.21, top); }
};

/// A tool over the middle of a plate, its tip `deep` [m] below the face.
SweptSolid over(const Plate& plate, bool ball, double radius, double deep) {
  SweptSolid solid{.ball = ball, .radius = radius, .height = 6e-3, .voxel = plate.voxel};
  solid.from = upright_pose(plate.voxel, plate.middle() - Vec3(0.0, 0.0, deep / plate.voxel));
  return solid;
}

/// Dwells for `seconds`. @returns the removed volume [m^3].
double dwell(Voxmap& voxmap, Erosion& erosion, const SweptSolid& solid, double seconds, int steps) {
  return drill(voxmap, erosion, {solid.from, solid.from}, kSpin, seconds, steps).mass;
}

/// Depth of the face below the plate's [m], at a place aside of the tool's axis [m], sought within two voxels of `expected` [m].
double face_depth(const Voxmap& voxmap, const Plate& plate, double expected, const Vec3& aside = Vec3(0.0)) {
  const Vec3 down(0.0, 0.0, -1.0);
  return expected + plate.voxel * surface_offset(voxmap.window(), plate.middle() + (aside + down * expected) / plate.voxel, down);
}

/// Bone [m] that is gone from the column of voxels next to the tool's axis.
double loss_of_column(const Voxmap& voxmap, const Plate& plate) {
  const MasterWindow& window = voxmap.window();
  Vec3i v(glm::round(plate.middle()));
  double sum = 0.0;
  for (v.z = window.box.lo.z; v.z < window.box.hi.z; ++v.z) {
    const std::size_t n = window.box.offset_of(v);
    sum += static_cast<double>(window.occupancy[n]) * (1.0 - static_cast<double>(window.remaining[n]));
  }
  return sum * plate.voxel;
}

/// Depth [m] of the face from the node of the cut surface two voxels below the plate's face.
double felt_depth(const Voxmap& voxmap, const Plate& plate) {
  const Vec3i v = Vec3i(glm::round(plate.middle())) - Vec3i(0, 0, 2);
  const CutSurface::Block* const block = voxmap.cut().find(block_of(v));
  REQUIRE(block != nullptr);
  return (plate.top - v.z + static_cast<double>(block->at(v).distance())) * plate.voxel;
}

}  // namespace

TEST_CASE("cut face: under a flat end at rest the face follows with 1 - exp(-e s t / h) of the overlap") {
  for (const float hardness : {1.0f, 0.4f})
    for (const double voxel : {0.2e-3, 0.3125e-3}) {
      const Plate plate{.voxel = voxel, .top = 4.66e-3 / voxel, .hardness = hardness};
      const SweptSolid solid = over(plate, false, 2e-3, 0.3e-3);
      Voxmap voxmap = plate.make();
      Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
      const double mass = dwell(voxmap, erosion, solid, 0.5, 50);
      const double gone = 0.3e-3 * (1.0 - std::exp(-kRate * 0.5 / static_cast<double>(hardness)));
      CHECK(std::abs(felt_depth(voxmap, plate) - gone) < 1e-3 * voxel);       // floats and 1/4096 voxel of the first distance
      CHECK(std::abs(face_depth(voxmap, plate, gone) - gone) < 0.1 * voxel);  // felt and drawn agree within a tenth of a voxel
      // Density is a ramp 2 kRamp = 1.5 voxels wide, and the sum of such a ramp over a column of voxels differs from the place of its middle by
      // up to f (1 - f) / 3 = 1/12 voxel, f = 1/2 the odd part of its width. Where the plate's slope is another, scaling it takes up to 1/20 more.
      const double column = loss_of_column(voxmap, plate);
      CHECK(std::abs(column - gone) < (1.0 / 12.0 + 1.0 / 20.0) * voxel);
      // At the rim the table of distances is rounded by half its pitch, a quarter of a voxel. There, within what is left o q of the overlap o, the distance
      // is that to the side, and a face that recedes along its normal alone leaves a fillet: half the depth over o q, of the area a share o q / R.
      const double rounded = 2.0 * 0.25 * voxel / 2e-3, fillet = (0.3e-3 - gone) / 2e-3, share = mass / (std::numbers::pi * 4e-6 * column);
      CHECK(share < 1.0 + rounded);
      CHECK(share > 1.0 - rounded - fillet);
    }
}

TEST_CASE("cut face: a flat end that is fed lags by v h / (e s) (1 - exp(-e s t / h)), at 50 Hz and at 500 Hz") {
  const Plate plate;
  SweptSolid solid = over(plate, false, 2e-3, 0.0);
  const double speed = 0.5e-3, time = 4.0;
  solid.way = Vec3(0.0, 0.0, -speed * time / plate.voxel);
  const double lag = speed / kRate * (1.0 - std::exp(-kRate * time));
  for (const int rate : {50, 500}) {
    Voxmap voxmap = plate.make();
    Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
    (void)drill(voxmap, erosion, solid.path(), kSpin, time, static_cast<int>(time) * rate);
    // A step takes the pose at its end, half a step early.
    const double early = 0.5 * speed / rate;
    // A fiftieth of a voxel is the ripple of the ramp of density.
    CHECK(std::abs(speed * time - face_depth(voxmap, plate, speed * time - lag) - lag) < 0.02 * plate.voxel + early);
  }
}

TEST_CASE("cut face: a flat end leaves a flat floor up to the wall; by the normal alone it would leave a fillet") {
  const Plate plate{.voxel = 0.2e-3, .top = 23.4};
  SweptSolid solid = over(plate, false, 2e-3, 0.0);
  const double speed = 0.5e-3, time = 4.0, lag = speed / kRate;
  solid.way = Vec3(0.0, 0.0, -speed * time / plate.voxel);
  const auto floor_near_wall = [&](const Vec3& reaction) {
    Voxmap voxmap = plate.make();
    Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
    for (int n = 0; n < 400; ++n) {
      const ErosionPath part{solid.path().at(n / 400.0), solid.path().at((n + 1) / 400.0)};
      voxmap.commit(erosion.step(voxmap, part, CuttingLoad{.spin = kSpin, .reaction = reaction}, 0.01).changed);
    }
    const double floor = speed * time - lag;
    return face_depth(voxmap, plate, floor) - face_depth(voxmap, plate, floor, Vec3(1.75e-3, 0.0, 0.0));
  };
  // 0.25 mm, 1.25 voxels, from the wall.
  CHECK(std::abs(floor_near_wall(Vec3(0.0, 0.0, 1.0))) < 0.1 * plate.voxel);
  // Sabotage: a force across the axis never finds the floor along it. The fillet there is lag ln(1 + lag / 0.25 mm) - lag high.
  CHECK(floor_near_wall(Vec3(1.0, 0.0, 0.0)) > 0.5 * (lag * std::log(1.0 + lag / 0.25e-3)) - 0.5 * 0.25e-3);
  CHECK(floor_near_wall(Vec3(1.0, 0.0, 0.0)) > 0.1 * plate.voxel);
}

TEST_CASE("cut face: the bone inside a ball at rest falls as exp(-e s t), within the curvature, at every voxel size") {
  const double radius = 3e-3, deep = 0.4e-3;
  const double cap = std::numbers::pi * deep * deep * (3.0 * radius - deep) / 3.0;
  for (const double voxel : {0.15e-3, 0.2e-3, 0.3125e-3}) {
    const Plate plate{.voxel = voxel, .top = 4.7e-3 / voxel};
    const SweptSolid solid = over(plate, true, radius, deep);
    Voxmap voxmap = plate.make();
    Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
    const double mass = dwell(voxmap, erosion, solid, 0.6, 60);
    CHECK(missing_mass(voxmap) == doctest::Approx(mass).epsilon(1e-6));
    // Thin overlaps: the error is of the order of the depth over the radius, a seventh; a third of it at the mean depth. So two sizes of voxels may
    // differ by twice that.
    CHECK(mass == doctest::Approx(cap * (1.0 - std::exp(-kRate * 0.6))).epsilon(0.05));
  }
}

TEST_CASE("cut face: the far side of a thin plate is left alone until the tool is there") {
  // A plate of 1.5 mm, on nothing.
  Plate plate{.voxel = 0.25e-3};
  const int bottom = static_cast<int>(plate.top) - 6;
  const int n = static_cast<int>(std::ceil(plate.across / plate.voxel)) + 16;
  DenseBone dense;
  dense.dims = Vec3i(n, n, static_cast<int>(std::ceil(plate.top)) + 20);
  dense.bone_from_index = Affine::scaling(plate.voxel, Vec3(0.0));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    dense.occupancy.push_back(v.z < bottom ? 0.0f : static_cast<float>(std::clamp(0.5 + 0.5 * (plate.top - v.z), 0.0, 1.0)));
    dense.hardness.push_back(1.0f);
  });
  Voxmap voxmap = voxmap_of(dense);
  SweptSolid solid = over(plate, false, 2e-3, 0.0);
  const double speed = 0.5e-3, time = 2.4;  // the tip stops 0.3 mm above the far side, and the face 0.3 mm further up
  solid.way = Vec3(0.0, 0.0, -speed * time / plate.voxel);
  Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
  (void)drill(voxmap, erosion, solid.path(), kSpin, time, 240);
  const double lag = speed / kRate * (1.0 - std::exp(-kRate * time));
  CHECK(std::abs(speed * time - face_depth(voxmap, plate, speed * time - lag) - lag) < 0.03 * plate.voxel + 0.5 * speed * 0.01);
  for (const Vec3& aside : {Vec3(0.0), Vec3(1e-3, 0.0, 0.0)}) {
    const Vec3 p = plate.middle() + aside / plate.voxel;
    CHECK(density_at(voxmap.window(), Vec3(p.x, p.y, bottom)) == 1.0);
  }
}

TEST_CASE("cut face: bone round a tool that was placed inside it thins out by the law, and what is removed is what is missing") {
  const SolidCase one{.ball = true, .radius = 6.0, .way = 0.0, .seed = 3};
  const SweptSolid solid = random_solid(one);
  Voxmap voxmap = block_for(one);
  Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
  // Voxels decay whose centres are inside, by the share of the ramp: in the depth s [voxels] w = 1/2 + s / (2 kRamp). So the outer half of the ramp
  // is left, 8.6 % of the ball at first.
  const auto thinned = [&](double time) {
    constexpr double kStep = 1e-3, kHalf = static_cast<double>(CutFace::kRamp);  // [voxels]
    double sum = 0.0;
    for (double s = 0.5 * kStep; s < one.radius; s += kStep) {
      const double inside = std::min(1.0, 0.5 + 0.5 * s / kHalf), r = one.radius - s;
      sum += (1.0 - std::exp(-kRate * time * inside)) * 4.0 * std::numbers::pi * r * r * kStep;
    }
    return sum * std::pow(solid.voxel, 3.0);
  };
  double mass = 0.0;
  for (int n = 1; n <= 3; ++n) {
    mass += drill(voxmap, erosion, {solid.from, solid.from}, kSpin, 0.1, 10).mass;
    // A ball of 6 voxels holds 905 centres within 2 %; those at its rim count by half.
    CHECK(mass == doctest::Approx(thinned(0.1 * n)).epsilon(0.02));
    CHECK(std::abs(missing_mass(voxmap) / mass - 1.0) < 1e-6);
  }
}

TEST_CASE("cut face: after a restore drilling continues within a fiftieth of what is removed") {
  const Plate plate;
  const SweptSolid solid = over(plate, true, 3e-3, 0.4e-3);
  const auto run = [&](bool restored) {
    Voxmap voxmap = plate.make();
    Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
    double mass = dwell(voxmap, erosion, solid, 0.3, 30);
    if (restored) {
      voxmap.write_back();
      CHECK_FALSE(voxmap.cut().empty());
      voxmap.put_blocks({});
      CHECK(voxmap.cut().empty());
    }
    return mass + dwell(voxmap, erosion, solid, 0.3, 30);
  };
  const double plain = run(false);
  CHECK(std::abs(run(true) / plain - 1.0) < 0.02);
}

TEST_CASE("cut face: drilling that is restored again and again removes as much as in one go, from a ball's hole and from a blurred face") {
  for (const double soft : {1.0, 3.0}) {
    const Plate plate{.soft = soft};
    const SweptSolid solid = over(plate, true, 3e-3, 0.4e-3);
    const auto run = [&](bool restored) {
      Voxmap voxmap = plate.make();
      Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
      double mass = 0.0, least = 1.0;
      for (int piece = 0; piece < 20; ++piece) {
        const double removed = dwell(voxmap, erosion, solid, 0.02, 2);
        mass += removed;
        least = std::min(least, removed);
        voxmap.write_back();
        if (restored) voxmap.put_blocks({});
      }
      CHECK(least > 0.0);
      return mass;
    };
    const double plain = run(false), pieces = run(true);
    CAPTURE(soft);
    MESSAGE("in pieces " << pieces / plain << " of what is removed in one go");
    CHECK(std::abs(pieces / plain - 1.0) < kRestored * soft);
  }
}

TEST_CASE("cut face: a removal that is made anew in the middle of a hole, as for a change of tool, goes on where the other ended") {
  const Plate plate;
  SweptSolid solid = over(plate, false, 2e-3, 0.0);
  // At a tenth of a voxel a step, one of ten steps finds a new layer of nodes ahead.
  const int before = 40, after = 50;
  const Vec3 step(0.0, 0.0, -0.1);
  const auto go_on = [&](Voxmap& voxmap, Erosion& erosion, int from, int to) {
    for (int n = from; n < to; ++n) {
      SweptSolid now = solid;
      now.from.offset += step * static_cast<double>(n);
      now.way = step;
      (void)drill(voxmap, erosion, now.path(), kSpin, 0.05, 1);
    }
  };
  for (int phase = 0; phase < 10; ++phase) {
    Voxmap one = plate.make(), two = plate.make();
    const auto made = [&] { return subvoxel_erosion(solid, static_cast<float>(kFactor)); };
    Erosion whole = made(), first = made(), second = made();
    go_on(one, whole, 0, before + phase + after);
    go_on(two, first, 0, before + phase);
    go_on(two, second, before + phase, before + phase + after);
    // The end is flat, so a lag is exact whatever it is searched from: floats remain, of lags of half a voxel and more.
    CHECK(std::abs(felt_depth(one, plate) - felt_depth(two, plate)) < 1e-3 * plate.voxel);
    float most = 0.0f;
    for_each_voxel(one.window().box, [&](const Vec3i& v) {
      const Vec3 aside = (Vec3(v) - plate.middle()) * plate.voxel;
      if (std::hypot(aside.x, aside.y) > solid.radius - 2.0 * plate.voxel) return;  // at the rim D bends
      const std::size_t n = one.window().box.offset_of(v);
      most = std::max(most, std::abs(one.window().remaining[n] - two.window().remaining[n]));
    });
    CHECK(most < 2e-3f);
  }
}

TEST_CASE("cut face: law energy removes mu F v_rel dt of work, whatever the rate and the voxel") {
  const double force = 20.0, time = 0.05;
  for (const double voxel : {0.2e-3, 0.3125e-3})
    for (const double rate : {500.0, 2000.0}) {
      const Plate plate{.voxel = voxel, .top = 4.7e-3 / voxel, .hardness = 0.5f};
      const SweptSolid solid = over(plate, true, 3e-3, 0.4e-3);
      Voxmap voxmap = plate.make();
      Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor), {.law = ErosionLaw::energy, .subvoxel = true});
      const auto steps = static_cast<int>(std::lround(time * rate));
      double mass = 0.0, energy = 0.0, work = 0.0;
      for (int n = 0; n < steps; ++n) {
        const ErosionOutcome outcome = erosion.step(voxmap, {solid.from, solid.from}, CuttingLoad{kSpin, force}, time / steps);
        voxmap.commit(outcome.changed);
        mass += outcome.removed_mass;
        energy += outcome.energy;
        work += 0.5 * force * 2.0 * std::numbers::pi * kSpin * outcome.rubbing_radius * time / steps;
      }
      CHECK(energy == doctest::Approx(mass * 1e8 * 0.5).epsilon(1e-6));
      // What a step lacks is carried to the next, so of all but the last step, 1 / steps. The radius at which a step rubs is that of the step before: a hundredth
      // over a fiftieth of a second.
      CHECK(energy == doctest::Approx(work).epsilon(1.0 / steps + 0.01));
      CHECK(mass > 0.3e-9);
    }
}

TEST_CASE("cut face: law energy spends the work of a load that rises from nothing, on a sharp face and on a blurred one") {
  constexpr int kSteps = 100;
  constexpr double kDt = 0.002, kMost = 0.5;  // [s], [N]
  for (const double soft : {1.0, 3.0}) {
    const Plate plate{.soft = soft, .voxel = 0.3125e-3, .top = 20.3};
    Voxmap voxmap = plate.make();
    const SweptSolid shape = over(plate, true, 3e-3, 0.0);
    Erosion erosion = subvoxel_erosion(shape, static_cast<float>(kFactor), {.law = ErosionLaw::energy, .subvoxel = true});
    double energy = 0.0, work = 0.0;
    for (int n = 1; n <= kSteps; ++n) {
      const double share = static_cast<double>(n) / kSteps;
      const SweptSolid solid = over(plate, true, 3e-3, share * 0.3 * plate.voxel);
      const ErosionOutcome outcome = erosion.step(voxmap, {solid.from, solid.from}, CuttingLoad{kSpin, share * kMost}, kDt);
      voxmap.commit(outcome.changed);
      energy += outcome.energy;
      work += 0.5 * share * kMost * 2.0 * std::numbers::pi * kSpin * outcome.rubbing_radius * kDt;
    }
    // What a step lacks or exceeds is carried to the next, so the last step's work, 2 / steps of all, is the most that can be missing.
    CHECK(energy == doctest::Approx(work).epsilon(2.0 / kSteps));
  }
}

TEST_CASE("cut face: in the air inside a tool no face overlaps it by more than it is deep in bone") {
  const double deep = 0.3;  // [voxels]
  for (const double radius : {0.4e-3, 0.8e-3, 2e-3}) {
    const Plate plate{.top = 20.3};
    Voxmap voxmap = plate.make();
    const SweptSolid solid = over(plate, false, radius, deep * plate.voxel);
    const auto field = field_of(solid, static_cast<float>(kFactor));
    CutFace face(field);
    static_cast<void>(face.find(voxmap, solid.from, {0.0, 0.0, 1.0}));
    const FaceNodes& nodes = face.nodes();
    REQUIRE(nodes.count > 0);
    // The distance to the plate is exact. That to the tool is interpolated, and changes by no more than the way to the corners of a cell.
    const double error = std::sqrt(0.75) * field->pitch / plate.voxel;
    for (std::size_t n = 0; n < nodes.count; ++n)
      if (nodes.base[n] >= 0.0f) CHECK(-static_cast<double>(nodes.tool[n] + nodes.cut[n]) < deep + error);
  }
}

TEST_CASE("cut face: blocks that the tool cannot have reached are passed over, with the same faces as if all were visited") {
  const Plate plate{.top = 20.3};
  Voxmap whole = plate.make(), quick = plate.make();
  const SweptSolid solid = over(plate, true, 2e-3, 0.0);
  const auto field = field_of(solid, static_cast<float>(kFactor));
  const FieldSampler sampler(*field);
  CutFace all(field), some(field);
  std::size_t most = 0;
  for (std::uint64_t n = 0; n < 150; ++n) {
    const auto by = [&](std::uint64_t counter) { return 2.0 * uniform01(7, 8 * n + counter) - 1.0; };
    // Fed by a twentieth of a voxel a step, with a tremor of a fifth; every 20th step a jump of up to two voxels; tilted to and fro.
    const double far = n % 20 == 19 ? 2.0 : 0.2;
    const Vec3 aside(far * by(0), far * by(1), far * by(2) - 0.05 * static_cast<double>(n) - 0.5);
    const Quat tilt = glm::angleAxis(0.05 * by(3), glm::normalize(Vec3(by(4), by(5), 0.1)));
    const Affine pose{Mat3(glm::mat3_cast(tilt)) * solid.from.linear, solid.from.offset + aside};
    all.visit_all();
    CHECK(all.find(whole, pose, {0.0, 0.0, 1.0}) == some.find(quick, pose, {0.0, 0.0, 1.0}));
    const FaceNodes &a = all.nodes(), &b = some.nodes();
    REQUIRE(a.count == b.count);
    most = std::max(most, a.count);
    bool same = true;
    for (std::size_t m = 0; m < a.count; ++m)
      same = same && a.at[m] == b.at[m] && a.tool[m] == b.tool[m] && a.cut[m] == b.cut[m] && a.behind[m] == b.behind[m];
    CHECK(same);
    // Each voxel by itself: distances of the plain sampler, the two nearest cases of rounding left out.
    std::set<std::uint32_t> found;
    for (std::size_t m = 0; m < a.count; ++m) found.insert(a.at[m]);
    const Affine place = Affine::scaling(1.0 / field->pitch, -field->origin / field->pitch) * pose.inverse();
    std::size_t missed = 0;
    for_each_voxel(whole.window().erodible_box(), [&](const Vec3i& v) {
      const CutSurface::Block* const block = whole.cut().find(block_of(v));
      if (block == nullptr || !block->at(v).set()) return;
      const float tool = sampler.distance(Vec3f(place * Vec3(v))) / static_cast<float>(plate.voxel), cut = block->at(v).cut;
      const bool empty = cut > CutFace::kFree && whole.window().occupancy[whole.window().box.offset_of(v)] == 0.0f;
      const bool overlaps = !empty && cut > -3.4f && tool < CutFace::kFollow - 1e-3f && tool + cut < -1e-3f;
      missed += overlaps && !found.contains(static_cast<std::uint32_t>(whole.window().box.offset_of(v))) ? 1 : 0;
    });
    CHECK(missed == 0);
    const double turns = 1.05;  // a tenth of the overlap
    (void)all.recede(turns), (void)some.recede(turns);
    all.keep(), some.keep();
  }
  CHECK(most > 1000);
}

TEST_CASE("cut face: create asks for a field and a law that fits; voxels beyond the window are counted and left alone") {
  const Plate plate;
  SweptSolid solid = over(plate, true, 3e-3, 0.4e-3);
  const ErosionPoints points = solid.points(0.5 * plate.voxel, 0.1f);
  CHECK(Erosion::create({.subvoxel = true}, points).error().message == "sub-voxel removal needs the cutting field of its tool");
  CHECK(Erosion::create({.law = ErosionLaw::per_update, .subvoxel = true}, points, field_of(solid, 0.1f)).error().message ==
        "sub-voxel removal needs law rate or law energy");
  Voxmap voxmap = plate.make();
  Erosion erosion = subvoxel_erosion(solid, static_cast<float>(kFactor));
  solid.from.offset.x = 3.0;  // half of the ball is beyond the window
  const Drilling drilling = drill(voxmap, erosion, {solid.from, solid.from}, kSpin, 0.1, 10);
  CHECK(drilling.outside > 0);
  CHECK(missing_mass(voxmap) == doctest::Approx(drilling.mass).epsilon(1e-6));
}
