#include "app/bench/records_rows.h"

#include <fmt/format.h>

#include "core/voxel/surface_records.h"

namespace burrhole {
namespace {

/// @returns a plate of bone with a blind hole of 11 mm diameter, voxel edge 0.25 mm.
MasterWindow make_drilled_window() {
  MasterWindow window;
  window.box = {Vec3i(0), Vec3i(96)};
  for_each_voxel(window.box, [&](const Vec3i& v) {
    const double beside = std::hypot(v.x - 48.2, v.y - 47.6) - 22.0, under = 30.2 - v.z;
    const double inside = std::min({70.3 - v.z, v.z - 8.0, std::max(beside, under)});
    window.density.push_back(static_cast<float>(std::clamp(0.5 + 0.5 * inside, 0.0, 1.0)));
  });
  return window;
}

std::span<const std::byte> bytes_in(const SurfaceRecords& records) {
  return std::visit([](const auto& all) { return bytes_of(all); }, records.records());
}

}  // namespace

void bench_records(Bench& bench) {
  const MasterWindow drilled = make_drilled_window();
  const VoxelBox cut{{60, 38, 36}, {80, 58, 56}};
  // Before the cut, the box at the wall of the hole is filled with bone.
  MasterWindow before = drilled;
  for_each_voxel(cut, [&](const Vec3i& v) { before.density[before.box.offset_of(v)] = 1.0f; });
  for (const RecordPrecision precision : {RecordPrecision::bits8, RecordPrecision::bits16}) {
    const std::string name = fmt::format("surface records of {} bits: update after 20^3 voxels of a wall over rebuild of 96^3",
                                         precision == RecordPrecision::bits8 ? 8 : 16);
    SurfaceRecords fresh(Affine::scaling(0.25e-3, Vec3(0.0)), precision), kept(Affine::scaling(0.25e-3, Vec3(0.0)), precision);
    fresh.rebuild(drilled);
    kept.rebuild(before);
    (void)kept.update(drilled, cut);
    if (!bench.agree(name, bytes_in(fresh), bytes_in(kept))) continue;
    const Side rebuild{{}, [&] { fresh.rebuild(drilled); }}, update{{}, [&] { (void)kept.update(drilled, cut); }};
    const Medians medians = bench.time(rebuild, update);
    bench.add_speed_up(name, "us", 1e6, medians);
    bench.add_absolute(fmt::format("surface records of {} bits: update after 20^3 voxels", precision == RecordPrecision::bits8 ? 8 : 16),
                       "ms", 1e3 * medians.value, true, {0.5, 0.2});
  }
}

}  // namespace burrhole
