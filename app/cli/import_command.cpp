#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/command_text.h"
#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/cli/progress.h"
#include "app/cli/volume_picture.h"
#include "app/scene/volume_scene.h"
#include "app/view/driver_text.h"
#include "core/base/output_file.h"
#include "core/base/units.h"
#include "core/measure/drill_site.h"
#include "core/voxel/saved_remaining.h"
#include "core/voxel/vdb_grids.h"
#include "core/voxel/voxmap.h"
#include "volumes/import_bone.h"
#include "volumes/read/skull_segment.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string input, volume, series, unit, band, offset, spacing, region, centre, overview, suggest, gl = "auto";
  std::vector<std::string> keep;
  std::string labels, label_table;
  bool json = false, quiet = false, force = false, volume_given = false, segment = false;
};

/// @returns the numbers of an option, each in [min, max]; bad_input with the option's name otherwise.
Result<std::vector<double>> numbers_of(const std::string& option, const std::string& text, std::size_t count, double min, double max) {
  const auto numbers = split_numbers(text, ',', count);
  const auto fits = [&](double x) { return x >= min && x <= max; };
  if (!numbers || !std::all_of(numbers->begin(), numbers->end(), fits))
    return bad_input(fmt::format("{} {} must be {}, each in [{:g}, {:g}]", option, text,
                                 count == 1 ? "a number" : fmt::format("{} numbers separated by commas", count), min, max));
  return *numbers;
}

Vec3 in_metres(const std::vector<double>& mm) { return Vec3(mm[0], mm[1], mm[2]) * kMillimetre; }

Status read_bone_options(const Options& option, BoneOptions& bone) {
  constexpr double kFar = 1e5;
  if (!option.band.empty()) {
    const auto band = numbers_of("--bone-hu", option.band, 2, -1e6, 1e6);
    if (!band) return band.error();
    bone.band = {(*band)[0], (*band)[1]};
  }
  if (!option.offset.empty()) {
    const auto offset = numbers_of("--hu-offset", option.offset, 1, -kFar, kFar);
    if (!offset) return offset.error();
    bone.hu_offset = (*offset)[0];
  }
  if (!option.spacing.empty()) {
    const auto spacing = numbers_of("--spacing-mm", option.spacing, 1, 0.01, 20.0);
    if (!spacing) return spacing.error();
    bone.spacing = (*spacing)[0] * kMillimetre;
  }
  if (option.region.empty() != option.centre.empty())
    return bad_input("--region-mm and --centre-mm must be given together: size and centre of a box");
  if (option.region.empty()) return {};
  const auto size = numbers_of("--region-mm", option.region, 3, 1.0, 1000.0);
  if (!size) return size.error();
  const auto centre = numbers_of("--centre-mm", option.centre, 3, -kFar, kFar);
  if (!centre) return centre.error();
  bone.region = BoneRegion{in_metres(*centre), in_metres(*size)};
  return {};
}

/// @returns bad_input with the path if a file is there already and may not be replaced.
Status check_free(const std::string& path, bool force) {
  std::error_code ignored;
  if (force || !fs::exists(path, ignored)) return {};
  return bad_input("is there already: choose another name, or --force", path);
}

/// @returns the file of the overview: the path itself, or overview.png in a folder.
std::string overview_file(const std::string& path) {
  return fs::path(path).extension() == ".png" ? path : (fs::path(path) / "overview.png").string();
}

/// Checks the output paths before the long read. @returns bad_input if a file cannot be written there.
Status check_output(const Options& option) {
  const std::string& volume = option.volume;
  if (!option.overview.empty())
    if (Status is_free = check_free(overview_file(option.overview), option.force); !is_free) return is_free;
  if (volume.empty()) return option.volume_given ? Status(bad_input("--volume is empty: it names the file to write")) : Status();
  if (fs::path(volume).extension() != ".vdb") return bad_input("--volume " + volume + " must end in .vdb");
  if (const Status folder = check_folder_of(volume); !folder) return folder;
  return check_free(volume, option.force);
}

/// Makes the folder of the overview. @returns bad_input if the path is neither a folder nor ends in .png.
Status make_overview_folder(const std::string& path) {
  if (fs::path(path).extension() == ".png") return {};
  std::error_code error;
  fs::create_directories(path, error);
  return fs::is_directory(path) ? Status() : Status(bad_input("--overview " + path + " must end in .png or be a folder"));
}

/// @returns the box around the largest part of the bone.
Bounds part_box(const ImportReport& report, const BoneModel& bone) {
  return report.largest ? Bounds{report.largest->lo, report.largest->hi} : bounds_of(bone.bone_box(), bone.bone_from_index());
}

/// Draws slices and a view of the bone, with the box around its largest part.
Status draw_overview(const Options& option, const BoneModel& bone, const ImportReport& report) {
  if (bone.bone_voxels() == 0) return bad_input("has no bone to draw: give the band of its bone by --bone-hu LO,HI", option.input);
  if (Status made = make_overview_folder(option.overview); !made) return made;
  const std::string file = overview_file(option.overview);
  VolumePicture picture;
  picture.gl = option.gl;
  picture.display.orientation = knows_directions(report);
  picture.display.height = picture.display.width;
  const auto driver = write_volume_sheet(file, bone, part_box(report, bone), picture);
  if (!driver) return driver.error();
  if (!option.quiet) note(fmt::format("{}\n{} written\n", driver_text(*driver), file));
  return {};
}

/// A site, and what a person must know of it.
struct SuggestedSite {
  DrillSite site;
  double moved = 0.0;  ///< [m] from the point that was given
  double edge = 0.0;   ///< [m] to the nearest end of the volume, from the axis within the bone
};

/// @returns the warning of a site near the end of the volume; empty elsewhere.
std::string edge_warning(const SuggestedSite& found) {
  constexpr double kNear = 0.010;  // [m] half of a 14 mm perforator, and a rim of 3 mm in which the bone is known
  if (found.edge >= kNear) return {};
  return fmt::format("the volume ends {:.1f} mm from the hole, and bone beyond it is missing: choose a point further inside",
                     found.edge / kMillimetre);
}

nlohmann::ordered_json site_json(const SuggestedSite& found) {
  const DrillSite& site = found.site;
  const auto list = [](const Vec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  return {{"entry_mm", list(site.entry / kMillimetre)},
          {"axis", list(site.axis)},
          {"thickness_mm", site.thickness / kMillimetre},
          {"moved_mm", found.moved / kMillimetre},
          {"volume_edge_mm", found.edge / kMillimetre}};
}

/// Prints the report, and the site if one was asked for: its TOML alone goes to stdout then, so that it can be appended to a scene.
void print_results(const Options& option, const ImportReport& report, const std::optional<SuggestedSite>& site) {
  if (option.json) {
    auto json = nlohmann::ordered_json::parse(import_json(report));
    if (site) json["suggested"] = site_json(*site);
    return print(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  if (!site) return print(import_text(report));
  if (!option.quiet) note(import_text(report));
  const std::string warning = edge_warning(*site);
  if (!warning.empty()) note(fmt::format("{}: warning: {}\n", report.source, warning));
  print(fmt::format(
      "# {:.2f} mm of bone along the axis; the entry is {:.1f} mm from the point that was given. This table replaces the scene's "
      "own [approach].\n{}{}",
      site->site.thickness / kMillimetre, site->moved / kMillimetre, warning.empty() ? "" : "# Warning: " + warning + ".\n",
      approach_text(site->site)));
}

/// Saves a bone, with what was drilled of it. A stop ends the writing, which may take long.
Status save_bone(const std::shared_ptr<const BoneModel>& bone, const std::string& path) {
  std::vector<const FloatVdb*> grids = bone->grids();
  FloatVdb remaining(kRemainingGrid, 1.0f);
  if (bone->drilled() != nullptr) {
    const auto voxmap = Voxmap::create(bone, {});
    if (!voxmap) return voxmap.error();
    voxmap->blocks().for_each_block(
        [&](const Vec3i& block, const BlockValues& values) { remaining.write_box(box_of_block(block), values); });
    grids.push_back(&remaining);
  }
  return write_vdb(path, bone->dims(), bone->bone_from_index(), grids, bone->notes(), &stop_requested());
}

int report_stopped(const std::string& volume) {
  note(fmt::format("{}: stopped after it was written: the rest was not done\n", volume));
  return kInterrupted;
}

int import_input(const Options& option) {
  ImportRequest request{option.input, {}, {}};
  request.read.series = option.series;
  request.read.keep = option.keep;
  if (!option.unit.empty()) request.read.unit = length_unit(option.unit);
  if (const Status read = read_bone_options(option, request.bone); !read) return report(read.error());
  request.read.pitch = request.bone.spacing;
  if (option.segment) request.bone.segment = std::make_shared<const SegmentOptions>();
  request.bone.label_files = {option.labels, option.label_table};
  if (option.labels.empty() && !option.label_table.empty())
    return report(bad_input("--label-table needs --labels: the volume that it names labels of"));
  if (const Status fits = check_output(option); !fits) return report(fits.error());
  std::optional<Vec3> near;
  if (!option.suggest.empty()) {
    const auto point = numbers_of("--suggest", option.suggest, 3, -1e5, 1e5);
    if (!point) return report(point.error());
    near = in_metres(*point);
  }

  Progress progress(option.quiet, kReadingDelay);
  request.read.progress = [&](double share) { progress.show(share, "reading"); };
  auto imported = import_bone(request, [&](const std::string& line) { progress.say(line); });
  if (!imported) return report(imported.error());
  if (!option.volume.empty()) {
    catch_signals();  // while there is a temporary file
    if (const Status written = save_bone(imported->bone, option.volume); !written) {
      const int failed = report(written.error());
      return stop_requested() ? kInterrupted : failed;
    }
    if (stop_requested()) return report_stopped(option.volume);
  }
  const BoneModel& bone = *imported->bone;
  find_largest_part(bone, imported->report);
  if (!option.overview.empty())
    if (const Status drawn = draw_overview(option, bone, imported->report); !drawn) return report(drawn.error());
  if (stop_requested()) return report_stopped(option.volume);
  std::optional<SuggestedSite> site;
  if (near) {
    const auto found = suggest_site(bone, *near);
    if (!found) return report(Error{found.error().code, found.error().message, imported->report.source});
    site = {*found, glm::length(found->entry - *near), distance_to_edge(bone, *found)};
  }
  print_results(option, imported->report, site);
  return kDone;
}

}  // namespace

void add_import(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "import", kSceneGroup,
      {.summary = "Converts a scan or mesh into a bone model and reports its properties and assumptions",
       .about =
           "Reads DICOM (a folder or a file), NIfTI, NRRD, MetaImage, a raw volume described by a TOML file, a closed mesh, or a .vdb. "
           "Checks positions of slices, sizes and lengths; keeps shear and gantry tilt; does not copy data that identify a patient. "
           "Without --volume it prints the report only. --overview draws the bone. --suggest prints a table [approach]: an entry near a "
           "point, "
           "and the axis square to the bone there; it replaces the scene's own [approach]. A scene may also name the scan itself as "
           "[volume] source.",
       .examples = {"burrhole import scan/", "burrhole import scan/ --series 3 --volume head.vdb",
                    "burrhole import scan/ --overview head.png", "burrhole import scan/ --suggest 62,80,790 >> scene_without_approach.toml",
                    "burrhole import scan/ --spacing-mm 0.3 --region-mm 48,48,48 --centre-mm 54,100,797 --volume site.vdb",
                    "burrhole import scan/ --segment --spacing-mm 0.5 --volume layers.vdb",
                    "burrhole import skull.stl --unit mm --spacing-mm 0.5 --volume skull.vdb"},
       .exits = ""});
  auto option = std::make_shared<Options>();
  command->add_option("input", option->input, "DICOM folder or file, NIfTI, NRRD, MetaImage, a raw volume's .toml, STL, OBJ, PLY, .vdb")
      ->required();
  command->add_option("--volume", option->volume, "bone model to write; a scene names it as [volume] source")->type_name("OUT.vdb");
  command->add_option("--series", option->series,
                      "series of a DICOM folder (by its name in the report) or grid of a .vdb; default: the best");
  command->add_option("--unit", option->unit, "unit of length of a mesh or another program's .vdb, which carry none")
      ->check(CLI::IsMember(length_unit_names()));
  command->add_option("--bone-hu", option->band, "values of occupancy 0 and 1, in HU or the file's own unit (default 250,400 HU)")
      ->type_name("LO,HI");
  command
      ->add_option("--hu-offset", option->offset,
                   "added to every value to convert it to HU, e.g. -1024 (default: determined from the scan)")
      ->type_name("HU");
  command->add_option("--spacing-mm", option->spacing, "resample to cubes of this edge (default: no resampling)")->type_name("MM");
  command->add_option("--region-mm", option->region, "crop to a box of this size; with --centre-mm and --spacing-mm")->type_name("X,Y,Z");
  command->add_option("--centre-mm", option->centre, "centre of that box, patient coordinates (left, posterior, superior)")
      ->type_name("X,Y,Z");
  command->add_flag("--segment", option->segment,
                    "label the layers of the skull: outer table, diploe, inner table, and dura and brain below");
  command->add_option("--labels", option->labels, "label volume on the grid of the scan: NRRD (.seg.nrrd), NIfTI and others")
      ->type_name(kFileValue);
  command->add_option("--label-table", option->label_table, "names and colours of these labels: a label description file of ITK-SNAP")
      ->type_name(kFileValue);
  command->add_option("--keep", option->keep, "copy this DICOM field into the report, e.g. PatientID (repeatable)")
      ->type_name("KEYWORD")
      ->allow_extra_args(false);
  command
      ->add_option("--overview", option->overview, "draw three slices and a 3D view with the box around the bone; a PNG file, or a folder")
      ->type_name(kFileValue);
  command->add_option("--suggest", option->suggest, "print [approach] for the place of the skull nearest to this point, LPS in mm")
      ->type_name("X,Y,Z");
  add_gl_option(*command, option->gl);
  command->add_flag("--force", option->force, "replace the files of --volume and --overview");
  command->add_flag("--json", option->json, "print only the report on stdout, as JSON");
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, command, &exit_code] {
    option->volume_given = command->count("--volume") > 0;
    exit_code = import_input(*option);
  });
}

}  // namespace burrhole::cli
