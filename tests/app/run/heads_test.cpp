// The shipped scenes on real heads: breakthrough at the thickness that a ray through the scan itself has.

#include <doctest/doctest.h>

#include <cmath>

#include "app/job/summary.h"
#include "tests/support/drill_scene.h"
#include "tests/support/plain_trilinear.h"
#include "tests/support/real_data.h"
#include "tests/support/source_folder.h"
#include "volumes/read/scan.h"

namespace burrhole::test {
namespace {

/// Length [m] of the first stretch at or above 325 HU ahead of a point 15 mm above the entry, by small steps through the scan's own voxels.
/// The plain twin of the thickness: no resampling, no occupancy, no bisection.
double ray_thickness(const Scan& scan, double offset, const ApproachScene& approach) {
  constexpr double kStep = 0.01e-3, kAbove = 15e-3, kFar = 40e-3, kSurface = 325.0;
  const Affine index_from_bone = scan.bone_from_index.inverse();
  const auto hu = [&](const Vec3& p_bone) {
    const VoxelBox box{Vec3i(0), scan.dims};
    return test::plain_trilinear(index_from_bone * p_bone, [&](const Vec3i& v) {
      return box.contains(v) ? static_cast<double>(scan.values[box.offset_of(v)]) + offset : 0.0;
    });
  };
  double in = -1.0;
  for (double s = -kAbove; s < kFar; s += kStep) {
    const bool bone = hu(approach.entry + approach.axis * s) >= kSurface;
    if (bone && in < 0.0) in = s;
    if (!bone && in >= 0.0) return s - in;
  }
  return 0.0;
}

void drill_head(const char* name) {
  (void)real_data();  // the scenes find it by themselves
  auto document = TomlDocument::load(test::in_source("app/scenes/") + name + ".toml");
  REQUIRE(document);
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  (void)loaded->scene.effects.remove("display");  // no picture is looked at here
  REQUIRE(loaded->import.has_value());
  const ScanScene source = *loaded->scene.volume.scan;
  const double offset = loaded->import->facts.hu_offset;

  DrillRun run(std::move(*loaded));
  run.run();
  CHECK(run.simulation().end() == RunEnd::done);
  const DrillProgress& p = run.simulation().progress();
  REQUIRE(p.breakthrough_depth.has_value());
  const auto scan = read_scan(source.request.path, {});
  REQUIRE(scan);
  const double ray = ray_thickness(scan->scan, offset, run.loaded().scene.approach);
  MESSAGE(std::string(name) << ": ray " << ray * 1e3 << " mm, thickness " << run.simulation().approach().thickness * 1e3
                            << " mm, breakthrough at " << *p.breakthrough_depth * 1e3 << " mm after " << *p.breakthrough_time
                            << " s, angle " << run.simulation().approach().angle * 57.2957795 << " degrees");
  CHECK(ray > 3e-3);
  // The refined surface is the scan's own to a tenth of its voxel (see bone_from_scan_test), at both ends.
  CHECK(std::abs(run.simulation().approach().thickness - ray) < 0.4e-3);
  // The tip leaves when the last engaged layer, F/K = 0.2 mm, is in the bit; with the 0.4 mm above and a voxel 0.85 mm.
  CHECK(std::abs(*p.breakthrough_depth - ray) < 0.85e-3);
  CHECK(p.removed_at_passing >= 1.0 - (0.2e-3 + 0.5 * run.voxel()) / ray);
  const RunSummary summary = make_summary(run.loaded(), run.simulation(), make_plan(run.loaded()), 1.0);
  MESSAGE(result_line(summary) << "; plunge " << summary.plunge_mm.value_or(-1.0) << " mm");
  CHECK(outcome_of(summary).result == DrillResult::drilled_through);
  CHECK((outcome_of(summary).flags & kFlagPlunged) == 0);  // its own limit
  // The outer drill cuts at full thrust until the hand releases it, so support ends with the release, not at breakthrough.
  REQUIRE(summary.plunge_mm.has_value());
  CHECK(*summary.plunge_mm < 0.1);
  REQUIRE(summary.beyond_mm.has_value());
  CHECK(*summary.beyond_mm > 1.0);
  REQUIRE(summary.support_lost_s.has_value());
  CHECK(*summary.support_lost_s > *summary.breakthrough_s + 1.0);
}

}  // namespace

TEST_CASE("heads: the head phantom's CT is drilled through") { drill_head("head_phantom"); }
TEST_CASE("heads: the cadaver's CT is drilled through") { drill_head("cadaver_head"); }

}  // namespace burrhole::test
