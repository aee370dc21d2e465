// Sliding: its figures by hand, a closed-form plane, what gradient-plane and voxmap must show, table and picture.
#include "app/lab/sliding.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "core/base/units.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/voxmap_contact.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

const Vec3 kUp(0.0, 0.0, 1.0);

/// Coarser and shorter than the full table: a second.
SlidingOptions quick() {
  SlidingOptions options;
  options.tool_folder = test::in_source("app/tools");
  options.tilts_deg = {0.0, 5.0, 25.0, 45.0};
  options.pitch = 0.5 * kMillimetre;
  options.length = 3.0 * kMillimetre;
  options.lanes = 2;
  return options;
}

std::vector<SlidingRow> measured(const SlidingOptions& options, const std::vector<SlidingSubject>& subjects) {
  auto rows = measure_sliding(options, subjects);
  if (!rows) FAIL(rows.error().text());
  return std::move(rows).value();
}

const std::vector<SlidingRow>& quick_rows() {
  static const std::vector<SlidingRow> rows = [] {
    auto subjects = sliding_subjects(quick());
    if (!subjects) FAIL(subjects.error().text());
    return measured(quick(), *subjects);
  }();
  return rows;
}

/// A subject that reads no voxel.
SlidingSubject closed_form(const std::string& name, ForceAt force) {
  return {name, [force = std::move(force)](const SlidingBone&) { return force; }};
}

SlidingSubject one_point_voxmap(const Vec3& tool_vector) {
  PointShell shell;
  shell.positions = {Vec3(0.0)};
  shell.inward_normals = {tool_vector};
  shell.cutting = {1};
  auto model = VoxmapContact::create({}, std::move(shell));
  REQUIRE(model.ok());
  const std::shared_ptr<const PenaltyModel> shared = std::move(model).value();
  return {"one point", [shared](const SlidingBone& bone) -> ForceAt {
            return [shared, view = &bone.voxels](const Pose& pose) {
              ContactResult result;
              shared->evaluate(*view, pose, result);
              return result.wrench.force;
            };
          }};
}

}  // namespace

TEST_CASE("sliding: the figures of a sawtooth are those of its closed form") {
  // 0, 1, 2, 3, 0, 1, 2, 3 along the normal: three steps of 1, one of 3, three of 1; mean 1.5.
  std::vector<Vec3> forces;
  for (int n = 0; n < 8; ++n) forces.push_back(static_cast<double>(n % 4) * kUp);
  const SlideFigures saw = slide_figures(forces, kUp);
  CHECK(saw.largest_step == 3.0);
  CHECK(std::abs(saw.rms_step - std::sqrt((6.0 + 9.0) / 7.0)) <= 1e-15);
  CHECK(saw.ripple == 2.0);
  CHECK(saw.mean == 1.5);
  // Across the normal: steps count, ripple does not.
  const SlideFigures across = slide_figures(std::vector<Vec3>{{0.0, 0.0, 1.0}, {0.0, 0.5, 1.0}}, kUp);
  CHECK(across.largest_step == 0.5);
  CHECK(across.ripple == 0.0);
  CHECK(std::isnan(slide_figures(std::vector<Vec3>(3, Vec3(0.0)), kUp).ripple));
  CHECK(slide_figures({}, kUp).largest_step == 0.0);
  CHECK(slide_figures(std::vector<Vec3>{kUp}, kUp).rms_step == 0.0);
}

TEST_CASE("sliding: a closed-form spring on the tilted plane shows no step, so the path is at constant depth") {
  const SlidingOptions options = quick();
  for (const double tilt : options.tilts_deg) {
    CAPTURE(tilt);
    SlidingOptions one = options;
    one.tilts_deg = {tilt};
    const Vec3 normal(std::sin(tilt * kDegree), 0.0, std::cos(tilt * kDegree));
    const auto spring = [normal](const Pose& pose) { return -2000.0 * glm::dot(pose.translation, normal) * normal; };
    const std::vector<SlidingRow> rows = measured(one, {closed_form("spring", spring)});
    REQUIRE(rows.size() == options.depths_voxel.size());
    for (const SlidingRow& row : rows) {
      CHECK(row.largest_step_N <= 1e-13);  // roundings of about a newton
      CHECK(row.ripple <= 1e-13);
    }
    // Sabotage: a plane half a degree off is seen.
    const Vec3 off(std::sin((tilt + 0.5) * kDegree), 0.0, std::cos((tilt + 0.5) * kDegree));
    const auto lame = [off](const Pose& pose) { return -2000.0 * glm::dot(pose.translation, off) * off; };
    CHECK(measured(one, {closed_form("lame", lame)}).front().largest_step_N > 1e-4);
  }
}

TEST_CASE("sliding: gradient-plane is steady on a level plate on the grid, and on no tilted one") {
  int level = 0, tilted = 0;
  for (const SlidingRow& row : quick_rows()) {
    if (row.model != "gradient-plane") continue;
    ++(row.tilt_deg == 0.0 ? level : tilted);
    CAPTURE(row.tilt_deg);
    CAPTURE(row.depth_voxel);
    // Sums of the same depths in the same order; only the roundings of the positions change.
    if (row.tilt_deg == 0.0) {
      CHECK(row.largest_step_N <= 1e-12);
      CHECK(row.ripple <= 1e-12);
    } else {
      CHECK(row.largest_step_N > 1e-3);
    }
    CHECK(row.rms_step_N <= row.largest_step_N);
  }
  CHECK(level > 0);
  CHECK(tilted > 0);
}

TEST_CASE("sliding: the mesh is steady on a plate of any tilt") {
  // The 0.5 level of a plane is exact (phantom.h). A plane through corners of 3e-9 m of rounding tilts by up to 7e-5 (mesh_contact_test.cpp),
  // as does its normal: of 2000 N/m at 0.7 mm. The average changes as a point joins at depth 0: only the deepest is judged.
  constexpr double kSteady = 2000.0 * (3e-9 + 7e-5 * 0.5e-3 + 7e-5 * 0.7e-3);
  int judged = 0;
  for (const SlidingRow& row : quick_rows()) {
    if (row.model != "mesh, deepest") continue;
    ++judged;
    CAPTURE(row.tilt_deg);
    CAPTURE(row.depth_voxel);
    CHECK(row.largest_step_N <= 2.0 * kSteady);
    CHECK(std::abs(row.mean_N / row.true_N - 1.0) < 1e-3);
  }
  CHECK(judged == 8);
}

TEST_CASE("sliding: the constrained tool of the mesh is steady on a plate of any tilt, and carries what the true force is") {
  // As for the deepest point; in series with the spring of 2000 N/m bone of 20e6 N/m takes 1e-4 of the force, and the planes have a
  // tolerance of 0.002 voxel, 1 um.
  constexpr double kSteady = 2000.0 * (3e-9 + 7e-5 * 0.5e-3 + 7e-5 * 0.7e-3 + 1e-6);
  int judged = 0;
  for (const SlidingRow& row : quick_rows()) {
    if (row.model != "mesh, held") continue;
    ++judged;
    CAPTURE(row.tilt_deg);
    CAPTURE(row.depth_voxel);
    CHECK(row.largest_step_N <= 2.0 * kSteady);
    CHECK(std::abs(row.mean_N / row.true_N - 1.0) < 1e-3 + 1e-6 * 2000.0 / row.true_N);
  }
  CHECK(judged == 8);
}

TEST_CASE("sliding: the original voxmap steps at voxel boundaries even on a level plate") {
  std::map<std::string, int> judged;
  for (const SlidingRow& row : quick_rows()) {
    if (row.tilt_deg != 0.0 || !row.model.starts_with("voxmap")) continue;
    CAPTURE(row.model);
    ++judged[row.model];
    CHECK(row.largest_step_N > 1e-3);
    CHECK(row.ripple > 0.01);
  }
  CHECK(judged.size() == 3);  // both plane voxels, three ways to stack
}

namespace {

/// One model's rows against those of every other form of voxmap: how many were compared, and where its step over the mean is above a tenth
/// of theirs.
struct Smoothness {
  int compared = 0, rougher = 0;
};

Smoothness against_voxmap(const std::string& model) {
  const auto share = [](const SlidingRow& row) { return row.largest_step_N / row.mean_N; };
  Smoothness out;
  for (const SlidingRow& ours : quick_rows()) {
    if (ours.model != model) continue;
    for (const SlidingRow& theirs : quick_rows()) {
      if (!theirs.model.starts_with("voxmap") || theirs.model == model) continue;
      if (theirs.tilt_deg != ours.tilt_deg || theirs.depth_voxel != ours.depth_voxel) continue;
      if (!(theirs.mean_N > 0.0)) continue;  // its plane lies deeper than the tool
      ++out.compared;
      out.rougher += share(ours) <= 0.1 * share(theirs) ? 0 : 1;
    }
  }
  return out;
}

}  // namespace

TEST_CASE("sliding: surface steps by a tenth of what the original voxmap does at most, on every tilt") {
  const Smoothness surface = against_voxmap("surface");
  CHECK(surface.compared >= 16);
  CHECK(surface.rougher == 0);
  // Sabotage: the same check refuses the other models, each form of voxmap among them, nearly everywhere. Where gradient-plane does not
  // step at all (level, on the grid) it passes as it should.
  for (const char* other : {"gradient-plane", "voxmap, own voxel, sum limited", "voxmap, surface voxel, average"}) {
    CAPTURE(other);
    const Smoothness rough = against_voxmap(other);
    CHECK(rough.compared >= 12);
    CHECK(rough.rougher > rough.compared / 2);
  }
}

TEST_CASE("sliding: surface gives the closed form's force, to a tenth of a voxel") {
  const double tenth = kSlidingStiffness * 0.1 * quick().pitch;
  bool others_off = false;
  for (const SlidingRow& row : quick_rows()) {
    CAPTURE(row.tilt_deg);
    CAPTURE(row.depth_voxel);
    CHECK(std::abs(row.true_N - kSlidingStiffness * row.depth_voxel * quick().pitch) <= 1e-12);  // the order of two products
    const bool close = std::abs(row.mean_N - row.true_N) <= tenth;
    if (row.model == "surface") CHECK(close);
    if (row.model == "voxmap, surface voxel, average") others_off |= !close;
  }
  CHECK(others_off);  // sabotage: an average is refused
}

TEST_CASE("sliding: one leaning point on a level plate steps by k s sin(lean), less a step's fall") {
  // [AcostaLiu07] figure 4 in closed form: the plane jumps by s N_x at a boundary and falls by k N_x a metre between.
  SlidingOptions options = quick();
  options.tilts_deg = {0.0};
  options.depths_voxel = {0.9};
  const double lean = 30.0 * kDegree;
  // The lane's turn about the axis carries the vector round it: one lane, and the share of the vector along the way is asked for.
  options.lanes = 1;
  Vec3 along(0.0);
  const SlidingSubject probe = closed_form("probe", [&](const Pose& pose) {
    along = pose.rotation * Vec3(std::sin(lean), 0.0, std::cos(lean));
    return kUp;
  });
  (void)measured(options, {probe});
  const std::vector<SlidingRow> rows = measured(options, {one_point_voxmap({std::sin(lean), 0.0, std::cos(lean)})});
  // Depth is 0.4 voxel cos(lean) give or take half a voxel sin(lean): above zero throughout.
  CHECK(std::abs(rows.front().largest_step_N - 2000.0 * std::abs(along.x) * (options.pitch - options.step)) <= 1e-12);
}

TEST_CASE("sliding: rows come one a tilt, depth and model, each with its time") {
  const auto& rows = quick_rows();
  CHECK(rows.size() == 4 * 2 * 8);
  std::map<std::string, int> seen;
  for (const SlidingRow& row : rows) {
    ++seen[row.model];
    CHECK(row.median_us > 0.0);
    CHECK(row.p99_us >= row.median_us);
  }
  CHECK(seen.size() == 8);
  const std::vector<CostRow> cost = sliding_cost_rows(rows, "round_burr_4mm");
  REQUIRE(cost.size() == 4 * rows.size());
  CHECK(cost[0].subject == "sliding, round_burr_4mm, 0.8 voxel deep");
  CHECK(cost[0].error_name == "mean_force_off");
  CHECK(cost[0].error == rows[0].mean_N - rows[0].true_N);
  CHECK(cost[1].error_name == "largest_step");
  CHECK(cost[1].error == rows[0].largest_step_N);
  CHECK(cost[3].error_name == "ripple");
}

TEST_CASE("sliding: the picture is written") {
  const TemporaryFolder folder;
  const Status written = write_sliding(quick_rows(), folder.path().string());
  if (!written.ok() && written.error().code == ErrorCode::unavailable) {
    MESSAGE("skipped: there is no gnuplot");
    return;
  }
  REQUIRE(written.ok());
  CHECK(std::filesystem::file_size(folder.file("sliding.svg")) > 1000);
  CHECK_FALSE(write_sliding({}, folder.path().string()).ok());
}

TEST_CASE("sliding: what cannot be measured is refused with a reason") {
  const auto message = [](auto change) {
    SlidingOptions options = quick();
    change(options);
    const auto rows = measure_sliding(options, std::vector{closed_form("none", [](const Pose&) { return kUp; })});
    return rows.ok() ? std::string("ok") : rows.error().message;
  };
  CHECK(message([](auto& o) { o.tilts_deg.clear(); }) == "sliding needs a tilt and a depth");
  CHECK(message([](auto& o) { o.lanes = 0; }) == "sliding needs at least one lane");
  CHECK(message([](auto& o) { o.tilts_deg = {75.0}; }) == "a tilt must be in [0, 60] degrees");
  CHECK(message([](auto& o) { o.depths_voxel = {5.0}; }) == "a depth must be above 0 and under 2 mm, half the plate");
  CHECK(message([](auto& o) { o.length = 0.1; }) == "a slide must be above 0 and at most 8 mm long");
  CHECK(message([](auto& o) { o.step = 1e-12; }) == "a step must be above 0 and at most a slide, which has at most a million of them");
  CHECK_FALSE(measure_sliding(quick(), {}).ok());
  SlidingOptions lost = quick();
  lost.tool = "no_such_tool";
  CHECK_FALSE(sliding_subjects(lost).ok());
}
