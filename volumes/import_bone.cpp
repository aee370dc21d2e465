#include "volumes/import_bone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/units.h"
#include "core/measure/largest_part.h"
#include "volumes/read/label_volume.h"
#include "volumes/read/readable_path.h"
#include "volumes/read/skull_segment.h"

namespace burrhole {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kImportSchema = 2;
constexpr double kMegabyte = 1e6;
constexpr float kBoneLevel = 0.5f;  // as BoneModel::bone_voxels()

Error at(Error error, const std::string& path) {
  if (error.place.empty()) error.place = path;
  return error;
}

/// An error of a label volume, or of its table, at the key that names the file, if there is one: the file's own place goes into the text then.
Error of_labels(const Error& error, const BoneOptions& bone) {
  const std::string& table = bone.label_files.table;
  const std::string& place = !table.empty() && error.place.starts_with(table) ? bone.places.label_table : bone.places.labels;
  return place.empty() ? error : Error{error.code, error.text(), place};
}

/// Estimated bytes of the three fields, and of the nodes of the sparse grids.
double likely_bytes(const BoneGrid& grid) {
  // A node of each upper level of an OpenVDB grid: 16^3 and 32^3 pointers, with two bits for each.
  constexpr double kFields = 3.0, kNodes = 1.1, kRoots = (16.0 * 16.0 * 16.0 + 32.0 * 32.0 * 32.0) * (sizeof(void*) + 0.25);
  return kFields * (kNodes * sizeof(float) * grid.bone_share * grid.dims.x * grid.dims.y * grid.dims.z + kRoots);
}

/// @returns the number of bone voxels that were drilled away before the bone was saved.
std::uint64_t drilled_voxels(const BoneModel& bone) {
  if (bone.drilled() == nullptr) return 0;
  std::uint64_t out = 0;
  std::vector<float> occupancy(kBlockVoxels);
  bone.drilled()->for_each_block([&](const Vec3i& block, const BlockValues& remaining) {
    bone.read_occupancy(box_of_block(block), occupancy);
    for (std::size_t n = 0; n < occupancy.size(); ++n)
      out += occupancy[n] >= kBoneLevel && occupancy[n] * remaining[n] < kBoneLevel ? 1 : 0;
  });
  return out;
}

void describe_bone(const BoneModel& bone, ImportReport& report) {
  report.bone_dims = bone.dims();
  report.bone_spacing = bone.bone_from_index().mean_edge();
  report.bone_edges = describe_grid(bone.bone_from_index()).spacing;
  report.bone_voxels = bone.bone_voxels();
  report.bone_share = static_cast<double>(bone.bone_voxels()) / static_cast<double>(bone.bounds().count());
  report.bytes = bone.bytes();
  if (const std::uint64_t removed = drilled_voxels(bone); removed > 0) {
    report.bone_voxels -= removed;
    report.bone_share = static_cast<double>(report.bone_voxels) / static_cast<double>(bone.bounds().count());
    report.scan.assumed.push_back(fmt::format("the bone was drilled before it was saved: {} of its bone voxels are removed", removed));
  }
  if (bone.bone_voxels() == 0) return;
  const auto [lo, hi] = bounds_of(bone.bone_box(), bone.bone_from_index());
  report.bone_lo = lo;
  report.bone_hi = hi;
}

bool is_vdb(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".vdb";
}

/// @returns the error of a reading that shall stop, without a report of its progress.
Status goes_on(const ReadOptions& read) {
  ReadOptions stop;
  stop.stop = read.stop;
  return advance(stop, 0.0);
}

bool shapes_bone(const BoneOptions& bone) {
  return bone.band || bone.hu_offset || bone.spacing || bone.region || !bone.hardness.empty() || bone.segment ||
         !bone.label_files.volume.empty();
}

std::optional<Enclosure> enclosure_of(const BoneModel& bone, const std::optional<BoneSite>& site) {
  if (!site) return std::nullopt;
  const BoneSamples samples{bone.dims(), bone.bone_from_index(), bone.bone_box(),
                            [&](const Vec3i& v) { return bone.occupancy(v) >= kBoneLevel; }};
  return measure_enclosure(samples, site->entry, site->axis);
}

/// Of all of the scan, whatever is kept of it. @param surface [unit of the values] from which a voxel is bone.
std::optional<Enclosure> enclosure_of(const Scan& scan, double surface, const std::optional<BoneSite>& site) {
  if (!site) return std::nullopt;
  const VoxelBox all{Vec3i(0), scan.dims};
  BoneSamples samples{scan.dims, scan.bone_from_index, {}, [&](const Vec3i& v) { return scan.values[all.offset_of(v)] >= surface; }};
  for_each_voxel(all, [&](const Vec3i& v) {
    if (samples.is_bone(v)) samples.bone_box.include(v);
  });
  return measure_enclosure(samples, site->entry, site->axis);
}

/// The bone model at the path, or nothing if the file is not a bone model of this program.
Result<std::optional<ImportedBone>> load_own(const ImportRequest& request) {
  auto bone = BoneModel::load(request.path);
  if (!bone) {
    if (request.read.unit) return std::optional<ImportedBone>();
    Error error = at(bone.error(), request.path);
    if (error.message.starts_with("is not a bone model"))
      error.message += "; a .vdb of another program needs a unit (--unit; unit in a scene)";
    return error;
  }
  if (request.read.unit || !request.read.series.empty() || shapes_bone(request.bone))
    return bad_input(
        "is a bone model already and is used unchanged: leave out unit, series, band, offset, hardness, spacing, region, layers and labels",
        request.path);
  ImportedBone out;
  out.bone = *bone;
  out.report.source = request.path;
  out.report.scan.format = "bone model (OpenVDB)";
  std::istringstream notes((*bone)->notes());
  for (std::string line; std::getline(notes, line);) out.report.scan.assumed.push_back(line);
  out.report.dims = (*bone)->dims();
  out.report.grid = describe_grid((*bone)->bone_from_index());
  describe_bone(**bone, out.report);
  out.report.enclosure = enclosure_of(**bone, request.site);
  return std::optional<ImportedBone>(std::move(out));
}

/// Moves a bone model into a temporary file if it is to be kept there.
Result<ImportedBone> place_own(const ImportRequest& request, ImportedBone own) {
  if (!request.accept) return own;
  const auto storage = request.accept({own.bone->dims(), own.bone->bone_from_index(), false, 1.0, own.bone->bytes()}, 0);
  if (!storage) return storage.error();
  if (!storage->is_paged()) return own;
  auto paged = own.bone->paged(*storage);
  if (!paged) return paged.error();
  own.bone = std::move(paged).value();
  return own;
}

/// An option that the format does not use is likely a misunderstanding, so it is an error.
Status check_use(const ImportRequest& request, const ReadScan& read) {
  const bool dicom = read.report.format.starts_with("DICOM"), given = read.scan.quantity == Quantity::occupancy;
  const bool grids = read.report.format.starts_with("OpenVDB");
  const auto refuse = [&](const char* what, const char* why) { return bad_input(fmt::format("{} {}", what, why), request.path); };
  if (request.read.unit && !given)
    return refuse("a unit (--unit; unit in a scene)", "is for meshes and other programs' .vdb: this file has its own");
  if (!request.read.series.empty() && !dicom && !grids) return refuse("a series", "is for DICOM folders and .vdb files");
  if (!request.read.keep.empty() && !dicom) return refuse("fields to keep", "are for DICOM");
  if (given && (request.bone.band || request.bone.hu_offset || !request.bone.hardness.empty()))
    return refuse("a band, an offset or a hardness table", "is for scans: this file has occupancy and no density");
  if (given && request.bone.segment) return refuse("a search for layers", "is for scans: this file has occupancy and no density");
  return {};
}

std::vector<double> in_mm(const Vec3& v) { return {v.x / kMillimetre, v.y / kMillimetre, v.z / kMillimetre}; }
std::string size_text(const Vec3i& dims) { return fmt::format("{} x {} x {}", dims.x, dims.y, dims.z); }
std::string mm_text(const Vec3& v) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", v.x / kMillimetre, v.y / kMillimetre, v.z / kMillimetre);
}

std::string spans_text(const Vec3& lo, const Vec3& hi) {
  const Vec3 a = lo / kMillimetre, b = hi / kMillimetre;
  return fmt::format("x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f} mm", a.x, b.x, a.y, b.y, a.z, b.z);
}

/// Meshes, fog volumes and bone models have occupancy values only.
bool knows_values(const ImportReport& report) { return report.facts.has_values; }

Json spread_json(const LayerSpread& s) {
  return {{"low_quartile", s.low / kMillimetre}, {"median", s.median / kMillimetre}, {"high_quartile", s.high / kMillimetre}};
}

Json layers_json(const ImportReport& r) {
  if (!r.facts.segment) return nullptr;
  const SegmentFacts& f = *r.facts.segment;
  const auto litres = [](double cubic_metres) { return cubic_metres * 1e3; };
  return {
      {"layers", f.layers},
      {"places", f.columns},
      {"layered_share", f.layered_share},
      {"thickness_mm", spread_json(f.thickness)},
      {"outer_table_mm", spread_json(f.outer_table)},
      {"diploe_mm", spread_json(f.diploe)},
      {"inner_table_mm", spread_json(f.inner_table)},
      {"blur_mm", spread_json(f.blur)},
      {"dip", f.dip},
      {"table_HU", f.table},
      {"diploe_HU", f.marrow},
      {"litres", {{"air", litres(f.air)}, {"soft_tissue", litres(f.soft)}, {"bone", litres(f.bone)}, {"inside_skull", litres(f.cavity)}}}};
}

Json series_json(const ScanReport& scan) {
  Json rows = Json::array();
  for (const SeriesLine& s : scan.series)
    rows.push_back({{"name", s.name},
                    {"modality", s.modality},
                    {"dims", {s.dims.x, s.dims.y, s.dims.z}},
                    {"spacing_mm", in_mm(s.spacing)},
                    {"direction", s.direction},
                    {"taken", s.taken},
                    {"fault", s.error.empty() ? Json(nullptr) : Json(s.error)}});
  return rows;
}

std::string series_text(const SeriesLine& s) {
  return fmt::format("  series {:<5} {} {:<9} {:>15} {:>24}{}{}\n", s.name, s.modality, s.direction, size_text(s.dims), mm_text(s.spacing),
                     s.taken ? "  <- taken" : "", s.error.empty() ? "" : "  not usable: " + s.error);
}

}  // namespace

bool knows_directions(const ImportReport& report) {
  return std::ranges::none_of(report.scan.assumed, [](const std::string& line) { return line.find("LPS") != std::string::npos; });
}

Result<ImportedBone> import_bone(const ImportRequest& given, const std::function<void(const std::string&)>& say) {
  if (const Status checked = check_options(given.bone); !checked) return at(checked.error(), given.path);
  const auto path = readable_path(given.path);
  if (!path) return path.error();
  ImportRequest request = given;
  request.path = *path;
  const auto accept = [&](const Scan& scan) -> Status {
    const auto grid = plan_grid(scan, request.bone);
    // What cannot be planned is refused when the bone is made.
    if (!grid) return {};
    const auto accepted = request.accept(*grid, sizeof(float) * VoxelBox{Vec3i(0), scan.dims}.count() + slab_bytes(scan, *grid));
    return accepted ? Status() : Status(accepted.error());
  };
  if (std::error_code ignored; is_vdb(request.path) && std::filesystem::exists(request.path, ignored)) {
    auto own = load_own(request);
    if (!own) return own.error();
    if (*own) return place_own(request, std::move(**own));
  }
  ReadOptions read_options = request.read;
  read_options.by_values = request.bone.band.has_value();
  if (request.accept) read_options.accept = accept;
  auto read = read_scan(request.path, read_options);
  if (!read) return at(read.error(), request.path);
  if (const Status fits = check_use(request, *read); !fits) return fits.error();
  const Scan& scan = read->scan;
  ImportedBone out;
  out.report.source = request.path;
  out.report.scan = std::move(read->report);
  Result<BoneStorage> storage = BoneStorage();
  const auto place = [&](const BoneGrid& grid) {
    out.report.resampled = grid.resampled;
    if (say)
      say(fmt::format("{} voxels read, {:.1f} MB; bone of {} voxels takes about {:.1f} MB", size_text(scan.dims),
                      static_cast<double>(scan.values.size() * sizeof(float)) / kMegabyte, size_text(grid.dims),
                      likely_bytes(grid) / kMegabyte));
    if (Status on = goes_on(request.read); !on) return storage = on.error();
    if (request.accept) storage = request.accept(grid, sizeof(float) * scan.values.size() + slab_bytes(scan, grid));
    return storage;
  };
  BoneOptions bone = request.bone;
  // A mesh was sampled at the requested spacing already.
  const std::string& format = out.report.scan.format;
  const bool sampled = !format.starts_with("OpenVDB") && !format.starts_with("NRRD") && !format.starts_with("NIfTI");
  if (scan.quantity == Quantity::occupancy && sampled && request.read.pitch && !bone.region) bone.spacing.reset();
  if (!bone.label_files.volume.empty()) {
    auto labels = read_label_volume(bone.label_files, scan);
    if (!labels) return of_labels(labels.error(), bone);
    bone.labels = std::make_shared<const LabelVolume>(std::move(labels).value());
  }
  auto made = make_bone(scan, bone, out.report.scan.assumed, place);
  if (!storage) return storage.error();
  if (!made) return at(made.error(), request.path);
  out.report.dims = scan.dims;
  out.report.grid = describe_grid(scan.bone_from_index);
  out.bone = std::move(made->bone);
  out.report.facts = std::move(*made);
  out.report.enclosure = enclosure_of(scan, out.report.facts.surface, request.site);
  describe_bone(*out.bone, out.report);
  return out;
}

void find_largest_part(const BoneModel& bone, ImportReport& report) {
  if (bone.bone_voxels() == 0) return;
  const LargestPart::Extent extent = LargestPart(bone).extent(bone);
  const Bounds box = bounds_of(extent.box, bone.bone_from_index());
  report.largest = {box.lo, box.hi, static_cast<double>(extent.voxels) / static_cast<double>(bone.bone_voxels())};
}

std::string import_json(const ImportReport& r) {
  Json largest = nullptr;
  if (r.largest) largest = {{"share", r.largest->share}, {"from_mm", in_mm(r.largest->lo)}, {"to_mm", in_mm(r.largest->hi)}};
  Json direction = Json::array();
  for (std::size_t c = 0; c < 3; ++c) direction.push_back({r.grid.direction[c].x, r.grid.direction[c].y, r.grid.direction[c].z});
  Json skipped = Json::array(), kept = Json::object();
  for (const Skipped& s : r.scan.skipped) skipped.push_back({{"reason", s.reason}, {"count", s.count}});
  for (const KeptField& field : r.scan.kept) kept[field.name] = field.value;
  Json values = nullptr;
  if (knows_values(r))
    values = {{"min", r.facts.value_min},
              {"max", r.facts.value_max},
              {"unit", r.facts.hounsfield ? Json("HU") : Json(nullptr)},
              {"offset", r.facts.hu_offset}};
  return Json{{"schema", kImportSchema},
              {"source", r.source},
              {"format", r.scan.format},
              {"series", series_json(r.scan)},
              {"dims", {r.dims.x, r.dims.y, r.dims.z}},
              {"spacing_mm", in_mm(r.grid.spacing)},
              {"direction", direction},
              {"shear_deg", r.grid.shear / kDegree},
              {"oblique_deg", r.grid.oblique / kDegree},
              {"values", values},
              {"bone",
               {{"dims", {r.bone_dims.x, r.bone_dims.y, r.bone_dims.z}},
                {"spacing_mm", in_mm(r.bone_edges)},
                {"voxels", r.bone_voxels},
                {"share", r.bone_share},
                {"from_mm", in_mm(r.bone_lo)},
                {"to_mm", in_mm(r.bone_hi)},
                {"largest_part", largest},
                {"bytes", r.bytes}}},
              {"layers", layers_json(r)},
              {"assumed", r.scan.assumed},
              {"skipped", skipped},
              {"kept", kept}}
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

std::string import_text(const ImportReport& r) {
  std::string text = fmt::format("{}: {}\n", r.source, r.scan.format);
  for (const SeriesLine& s : r.scan.series) text += series_text(s);
  text += fmt::format("  voxels     {}, {}\n", size_text(r.dims), mm_text(r.grid.spacing));
  for (std::size_t c = 0; c < 3; ++c)
    text += fmt::format("  {}          runs along ({:.4f}, {:.4f}, {:.4f})\n", "ijk"[c], r.grid.direction[c].x, r.grid.direction[c].y,
                        r.grid.direction[c].z);
  text += fmt::format("  shear      {:.2f} deg{}\n", r.grid.shear / kDegree, r.grid.shear > 1e-4 ? ", kept (gantry tilt)" : "");
  if (r.grid.oblique > 1e-4) text += fmt::format("  oblique    {:.2f} deg off the patient's axes\n", r.grid.oblique / kDegree);
  if (knows_values(r))
    text += fmt::format("  values     {:g} to {:g}{}\n", r.facts.value_min, r.facts.value_max, r.facts.hounsfield ? " HU" : " (not HU)");
  text += fmt::format("  bone       {} voxels{}, {} of them bone ({:.2f} %), {:.1f} MB\n", size_text(r.bone_dims),
                      r.resampled ? fmt::format(" of {:.3g} mm", r.bone_spacing / kMillimetre) : " as they are", r.bone_voxels,
                      100.0 * r.bone_share, static_cast<double>(r.bytes) / kMegabyte);
  if (glm::any(glm::greaterThan(r.bone_hi, r.bone_lo)))
    text += fmt::format("  bone spans {} (patient: left, posterior, superior)\n", spans_text(r.bone_lo, r.bone_hi));
  if (r.largest && r.largest->share < 1.0)
    text += fmt::format("  its largest connected part spans {}, {:.2f} % of it; the rest, a head rest for example, is bone too\n",
                        spans_text(r.largest->lo, r.largest->hi), 100.0 * r.largest->share);
  for (const std::string& line : r.scan.assumed) text += "  assumed    " + line + "\n";
  for (const Skipped& s : r.scan.skipped) text += fmt::format("  skipped    {} x {}\n", s.count, s.reason);
  for (const KeptField& field : r.scan.kept) text += fmt::format("  kept       {} = {}\n", field.name, field.value);
  return text;
}

}  // namespace burrhole
