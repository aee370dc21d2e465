#include "app/lab/surface_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "app/report/plot.h"
#include "core/base/random.h"
#include "core/contact/surface_view.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

struct Shape {
  std::string name;
  PhantomSpec spec;
};

std::vector<Shape> shapes_at(double pitch) {
  PhantomSpec plate;
  plate.kind = PhantomKind::plate;
  plate.pitch = pitch;
  plate.extent = Vec3(0.012, 0.012, 0.012);
  plate.above = 0.005;
  plate.thickness = 0.004;
  plate.plate_normal = Vec3(0.4, 0.25, 1.0);
  PhantomSpec ball = plate;
  ball.kind = PhantomKind::sphere;
  ball.sphere_radius = 0.004;
  PhantomSpec patch = plate;
  patch.kind = PhantomKind::skull_patch;
  patch.extent = Vec3(0.016, 0.016, 0.014);
  patch.thickness = 0.007;
  return {{"tilted plate", plate}, {"ball of 4 mm", ball}, {"skull patch", patch}};
}

/// Positions within a voxel of the surface and more than two voxels from any edge, where the closed form of the normal is valid.
std::vector<Vec3> places_near(const Truth& truth, const VoxelBox& valid, const Affine& bone_from_index, double pitch,
                              const SurfaceAccuracyOptions& options) {
  std::vector<Vec3> out;
  const Vec3 lo(valid.lo), size(valid.size() - 1);
  for (std::uint64_t n = 0; out.size() < options.points && n < 200 * options.points; ++n) {
    const auto random = [&](std::uint64_t axis) { return uniform01(options.seed, 3 * n + axis); };
    const Vec3 p = bone_from_index * (lo + size * Vec3(random(0), random(1), random(2)));
    const SurfaceDistance here = truth.nearest(p);
    if (std::abs(here.signed_distance) > pitch) continue;
    const Vec3 foot = p - here.normal * here.signed_distance;
    bool plain = true;
    for (const double reach : {2.0, 4.0})
      for_each_voxel({Vec3i(-1), Vec3i(2)}, [&](const Vec3i& aside) {
        const Vec3 along = Vec3(aside) - here.normal * glm::dot(here.normal, Vec3(aside));
        plain = plain && glm::dot(truth.normal(foot + along * (reach * pitch)), here.normal) > 0.5;
      });
    if (plain) out.push_back(p);
  }
  return out;
}

/// One bone with its records published as for contact.
struct Records {
  std::unique_ptr<Voxmap> voxmap;
  std::unique_ptr<ContactWindowPublisher> publisher;
  [[nodiscard]] RecordView view() const { return record_view(publisher->exchange().latest(), voxmap->bone().bone_from_index()); }
};

Result<Records> publish(const DenseBone& dense, RecordPrecision precision) {
  auto bone = BoneModel::create(dense);
  if (!bone) return bone.error();
  auto voxmap = Voxmap::create(std::move(bone).value(), {});
  if (!voxmap) return voxmap.error();
  Records out;
  out.voxmap = std::make_unique<Voxmap>(std::move(voxmap).value());
  if (Status placed = out.voxmap->place_window(out.voxmap->bone().bounds().grown(2)); !placed) return placed.error();
  out.publisher = std::make_unique<ContactWindowPublisher>(
      *out.voxmap, ContactFields{.density = false, .gradient = false, .words = false, .records = precision});
  out.publisher->publish(*out.voxmap);
  return out;
}

struct Errors {
  std::vector<double> distance, normal;  // [voxel], [deg]
};

Errors errors_at(const std::vector<Vec3>& places, const RecordView& view, const Truth& truth) {
  Errors out;
  const Affine index_from_bone = view.bone_from_index.inverse();
  const double edge = view.bone_from_index.mean_edge();
  for (const Vec3& p : places) {
    const auto found = sample_records(view, index_from_bone * p);
    if (!found) continue;
    const SurfaceDistance true_one = truth.nearest(p);
    out.distance.push_back(std::abs(found->distance - true_one.signed_distance / edge));
    out.normal.push_back(std::acos(std::clamp(glm::dot(found->normal, true_one.normal), -1.0, 1.0)) * 180.0 / std::numbers::pi);
  }
  return out;
}

/// Microseconds of each query of all positions by the shipped probe.
std::vector<double> times_of(const std::vector<Vec3>& places, const RecordView& view, int repeats) {
  PointShell shell;
  shell.positions = places;
  shell.inward_normals.assign(places.size(), Vec3(0.0, 0.0, 1.0));
  shell.cutting.assign(places.size(), 1);
  const ContactShell points = make_contact_shell(shell, view.bone_from_index.mean_edge());
  const Affine index_from_tool = view.bone_from_index.inverse();
  ProbeHits hits;
  hits.reserve(places.size());
  std::vector<double> out;
  for (int n = -1; n < repeats; ++n) {  // the first is a warm-up
    hits.clear();
    const auto start = std::chrono::steady_clock::now();
    probe_surface(view, points.cutting, index_from_tool, 1.0, hits);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    if (n >= 0) out.push_back(took.count());
  }
  return out;
}

struct SurfaceFigure {
  const char *name, *unit;
};
constexpr std::array kErrors{SurfaceFigure{"distance_median", "voxel"}, SurfaceFigure{"distance_worst", "voxel"},
                             SurfaceFigure{"normal_median", "deg"}, SurfaceFigure{"normal_worst", "deg"}};
constexpr std::size_t kFigures = kErrors.size() + 2;  // and the median and the 99th percentile of the times [us]
constexpr std::array kPrecisions{RecordPrecision::bits8, RecordPrecision::bits16};

/// @returns the errors in the order of kErrors, then the times.
Result<Study::Figures> measure_shape(const Shape& shape, RecordPrecision precision, double pitch, const SurfaceAccuracyOptions& options) {
  const auto phantom = make_phantom(shape.spec);
  if (!phantom) return phantom.error();
  const auto records = publish(phantom->bone, precision);
  if (!records) return records.error();
  const RecordView view = records->view();
  const std::vector<Vec3> places = places_near(phantom->truth, view.valid, view.bone_from_index, pitch, options);
  const Errors errors = errors_at(places, view, phantom->truth);
  if (errors.distance.empty()) return Error{ErrorCode::internal, "no place near the surface of the " + shape.name, {}};
  const std::vector<double> times = times_of(places, view, options.repeats);
  return Study::Figures{at_share(errors.distance, 0.5), at_share(errors.distance, 1.0), at_share(errors.normal, 0.5),
                        at_share(errors.normal, 1.0),   at_share(times, 0.5),           at_share(times, 0.99)};
}

StudyTrial trial_of(const Shape& shape, RecordPrecision precision, double pitch, const SurfaceAccuracyOptions& options) {
  StudyTrial out{.key = {}, .name = fmt::format("{}, voxels of {:g} mm", shape.name, pitch * 1e3), .figures = kFigures};
  out.key.add("surface").add(shape.name).add(precision == RecordPrecision::bits8 ? 8.0 : 16.0).add(pitch);
  out.key.add(static_cast<double>(options.points)).add(options.repeats).add(static_cast<double>(options.seed));
  return out;
}

}  // namespace

std::size_t count_of_trials(const SurfaceAccuracyOptions& options) {
  std::size_t count = 0;
  for (const double pitch : options.pitches) count += shapes_at(pitch).size() * kPrecisions.size();
  return count;
}

Result<std::vector<CostRow>> measure_surface_accuracy(const SurfaceAccuracyOptions& options) {
  Study own({}, count_of_trials(options));
  Study& study = options.study != nullptr ? *options.study : own;
  std::vector<CostRow> rows;
  for (const double pitch : options.pitches)
    for (const Shape& shape : shapes_at(pitch))
      for (const RecordPrecision precision : kPrecisions) {
        const auto figures =
            study.run(trial_of(shape, precision, pitch, options), [&] { return measure_shape(shape, precision, pitch, options); });
        if (!figures) return figures.error();
        CostRow row{.subject = "surface of a " + shape.name,
                    .model = precision == RecordPrecision::bits8 ? "records of 8 bits" : "records of 16 bits",
                    .knob = "spacing_mm",
                    .setting = pitch * 1e3,
                    .error_name = {},
                    .unit = {},
                    .reference = "closed form"};
        row.median_us = (*figures)[kErrors.size()];
        row.p99_us = (*figures)[kErrors.size() + 1];
        row.bytes = precision == RecordPrecision::bits8 ? sizeof(Record8) : sizeof(Record16);
        for (std::size_t n = 0; n < kErrors.size(); ++n) {
          row.error_name = kErrors[n].name;
          row.error = (*figures)[n];
          row.unit = kErrors[n].unit;
          rows.push_back(row);
        }
      }
  return rows;
}

Status write_surface_accuracy(const std::vector<CostRow>& rows, const std::string& folder) {
  if (Status written = write_cost_csv(rows, folder + "/cost.csv"); !written) return written;
  Plot plot;
  plot.x_label = "edge of a voxel [mm]";
  plot.panel_height_px = 230;
  for (const auto& [name, label] :
       {std::pair{"distance_worst", "largest distance error [voxel]"}, std::pair{"normal_median", "median normal error [deg]"}})
    for (const std::string bits : {"8 bits", "16 bits"}) {
      PlotPanel panel;
      panel.y_label = bits + ": " + label;
      panel.from_zero = true;
      for (const CostRow& row : rows) {
        if (row.error_name != name || row.model != "records of " + bits) continue;
        const std::string shape = row.subject.substr(std::string("surface of a ").size());
        auto series = std::ranges::find(panel.series, shape, &PlotSeries::name);
        if (series == panel.series.end()) series = panel.series.insert(series, PlotSeries{shape, {}, {}});
        series->x.insert(series->x.begin(), row.setting);  // pitches decrease, the axis increases
        series->y.insert(series->y.begin(), row.error);
      }
      plot.panels.push_back(std::move(panel));
    }
  return write_svg(plot, folder + "/surface_error.svg");
}

}  // namespace burrhole
