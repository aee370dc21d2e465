#include "app/engine/import.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/units.h"

namespace burrhole {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kImportSchema = 1;
constexpr double kMegabyte = 1e6;

Error at(Error error, const std::string& path) {
  if (error.place.empty()) error.place = path;
  return error;
}

/// Fields and labels of every voxel: what the sparse grids come to if all of it were bone.
double most_bytes(const Vec3i& dims) { return 3.0 * sizeof(float) * dims.x * dims.y * dims.z; }

void describe_bone(const BoneModel& bone, ImportReport& report) {
  report.bone_dims = bone.dims();
  report.bone_spacing = bone.bone_from_index().mean_edge();
  report.bone_voxels = bone.bone_voxels();
  report.bytes = bone.bytes();
}

Result<ImportedBone> load_own(const ImportRequest& request) {
  auto bone = BoneModel::load(request.path);
  if (!bone) {
    Error error = at(bone.error(), request.path);
    error.message += " (another program's .vdb is read when its unit of length is given)";
    return error;
  }
  if (request.bone.spacing || request.bone.region || request.bone.band)
    return bad_input("is a bone model already: it is taken as it is, without band, spacing or region", request.path);
  ImportedBone out;
  out.bone = *bone;
  out.report.source = request.path;
  out.report.scan.format = "bone model (OpenVDB)";
  out.report.dims = (*bone)->dims();
  out.report.grid = describe_grid((*bone)->bone_from_index());
  out.report.facts.bone_share = static_cast<double>((*bone)->bone_voxels()) / static_cast<double>((*bone)->bounds().count());
  describe_bone(**bone, out.report);
  return out;
}

std::vector<double> in_mm(const Vec3& v) { return {v.x / kMillimetre, v.y / kMillimetre, v.z / kMillimetre}; }
std::string size_text(const Vec3i& dims) { return fmt::format("{} x {} x {}", dims.x, dims.y, dims.z); }
std::string mm_text(const Vec3& v) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", v.x / kMillimetre, v.y / kMillimetre, v.z / kMillimetre);
}

/// Meshes, fog volumes and bone models have no values but occupancy.
bool knows_values(const ImportReport& report) { return report.facts.has_values; }

Json series_json(const ScanReport& scan) {
  Json rows = Json::array();
  for (const SeriesLine& s : scan.series)
    rows.push_back({{"name", s.name},
                    {"modality", s.modality},
                    {"dims", {s.dims.x, s.dims.y, s.dims.z}},
                    {"spacing_mm", in_mm(s.spacing)},
                    {"direction", s.direction},
                    {"taken", s.taken},
                    {"fault", s.fault.empty() ? Json(nullptr) : Json(s.fault)}});
  return rows;
}

std::string series_text(const SeriesLine& s) {
  return fmt::format("  series {:<5} {} {:<9} {:>15} {:>24}{}{}\n", s.name, s.modality, s.direction, size_text(s.dims), mm_text(s.spacing),
                     s.taken ? "  <- taken" : "", s.fault.empty() ? "" : "  not usable: " + s.fault);
}

}  // namespace

Result<ImportedBone> import_bone(const ImportRequest& request, const std::function<void(const std::string&)>& say) {
  if (std::filesystem::path(request.path).extension() == ".vdb" && !request.read.unit) return load_own(request);
  auto read = read_scan(request.path, request.read);
  if (!read) return at(read.error(), request.path);
  const auto grid = plan_grid(read->scan, request.bone);
  if (!grid) return at(grid.error(), request.path);
  if (say)
    say(fmt::format("{} voxels read, {:.1f} MB; bone of {} voxels takes at most {:.1f} MB", size_text(read->scan.dims),
                    static_cast<double>(read->scan.values.size() * sizeof(float)) / kMegabyte, size_text(grid->dims),
                    most_bytes(grid->dims) / kMegabyte));
  ImportedBone out;
  out.report.source = request.path;
  out.report.scan = std::move(read->report);
  auto made = make_bone(read->scan, request.bone, out.report.scan.assumed);
  if (!made) return at(made.error(), request.path);
  out.report.dims = read->scan.dims;
  out.report.grid = describe_grid(read->scan.bone_from_index);
  out.bone = std::move(made->bone);
  out.report.facts = std::move(*made);
  describe_bone(*out.bone, out.report);
  return out;
}

std::string import_json(const ImportReport& r) {
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
                {"spacing_mm", r.bone_spacing / kMillimetre},
                {"voxels", r.bone_voxels},
                {"share", r.facts.bone_share},
                {"from_mm", in_mm(r.facts.bone_lo)},
                {"to_mm", in_mm(r.facts.bone_hi)},
                {"bytes", r.bytes}}},
              {"assumed", r.scan.assumed},
              {"skipped", skipped},
              {"kept", kept}}
             .dump(2) +
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
  text += fmt::format("  bone       {} voxels of {:.3g} mm, {} of them bone ({:.2f} %), {:.1f} MB\n", size_text(r.bone_dims),
                      r.bone_spacing / kMillimetre, r.bone_voxels, 100.0 * r.facts.bone_share, static_cast<double>(r.bytes) / kMegabyte);
  if (glm::any(glm::greaterThan(r.facts.bone_hi, r.facts.bone_lo)))
    text += fmt::format("  bone spans x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f} mm (patient: left, posterior, superior)\n",
                        r.facts.bone_lo.x / kMillimetre, r.facts.bone_hi.x / kMillimetre, r.facts.bone_lo.y / kMillimetre,
                        r.facts.bone_hi.y / kMillimetre, r.facts.bone_lo.z / kMillimetre, r.facts.bone_hi.z / kMillimetre);
  for (const std::string& line : r.scan.assumed) text += "  assumed    " + line + "\n";
  for (const Skipped& s : r.scan.skipped) text += fmt::format("  skipped    {} x {}\n", s.count, s.reason);
  for (const KeptField& field : r.scan.kept) text += fmt::format("  kept       {} = {}\n", field.name, field.value);
  return text;
}

}  // namespace burrhole
