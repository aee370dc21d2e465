#include <fmt/format.h>

#include <filesystem>

#include "app/cli/command_text.h"
#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/cli/given_paths.h"
#include "app/cli/progress.h"
#include "app/scene/volume_scene.h"
#include "core/base/output_file.h"
#include "core/base/units.h"
#include "core/measure/approach.h"
#include "core/voxel/vdb_grids.h"
#include "volumes/export_bone.h"
#include "volumes/import_bone.h"
#include "volumes/read/number_text.h"
#include "volumes/write/planned_line.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  SceneOption input;  ///< a scene, or a volume
  std::string output, field, restore, unit, series;
  bool undrilled = false, crop = false, quiet = false, force = false;
};

/// The bone of a scene or of a file; of a scene also where it is drilled.
struct Source {
  std::shared_ptr<const BoneModel> bone;
  std::optional<ApproachScene> approach;
};

/// @returns whether the input is a scene: the name of a shipped one, or a TOML file with the tables of one (a raw volume has none).
bool is_scene(const std::string& input) {
  const std::string path = find_scene(input);
  if (path != input) return true;
  if (!lower(path).ends_with(".toml")) return false;
  const auto document = TomlDocument::load(path);
  if (!document) return true;  // its error has line and column
  Issues ignored;
  const TableReader root = document->root(ignored);
  return root.has("volume") || root.has("tool") || root.has("approach");
}

/// @returns whether a .vdb file of this program says what tools have left of its bone.
bool has_remaining(const std::string& path) {
  const auto content = read_vdb(path);
  return content &&
         std::any_of(content->grids.begin(), content->grids.end(), [](const FloatVdb& grid) { return grid.name() == "remaining"; });
}

/// @returns an error for files of which the names show that they are of another kind.
Status check_names(const Options& option) {
  const std::string& input = option.input.scene;
  if (lower(input).ends_with(".sqlite"))
    return bad_input(fmt::format("is a recorded session and holds no bone: burrhole session {} --csv prints its rows", input), input);
  if (lower(option.output).ends_with(".seg.nrrd") && option.field != "labels")
    return bad_input("is the name of a segmentation of 3D Slicer, which holds labels: add --field labels, or end in .nrrd alone",
                     option.output);
  return {};
}

Status check_paths(const Options& option) {
  const fs::path output(option.output);
  if (const Status folder = check_folder_of(option.output); !folder) return folder;
  std::error_code ignored;
  for (const std::string& read : {option.input.scene, option.restore})
    if (!read.empty() && fs::equivalent(read, output, ignored))
      return bad_input("is the file that is read: choose another name", option.output);
  if (!option.force && fs::exists(output, ignored)) return bad_input("is there already: choose another name, or --force", option.output);
  return {};
}

/// Options of a bone have no effect on a planned line.
Status check_markups(const Options& option) {
  if (option.field.empty() && option.restore.empty() && !option.undrilled && !option.crop) return {};
  return bad_input("a planned line holds no bone: leave out --field, --undrilled, --crop and --restore", option.output);
}

ExportRequest request_of(const Options& option) {
  ExportRequest out{.path = option.output, .undrilled = option.undrilled, .crop = option.crop};
  const auto& names = export_field_names();
  const auto found = std::find(names.begin(), names.end(), option.field);
  if (found != names.end()) out.field = static_cast<ExportField>(found - names.begin());
  return out;
}

Result<Source> load_volume(const Options& option, Progress& progress) {
  const std::string& path = option.input.scene;
  if (!option.input.sets.empty()) return bad_input("--set is for scenes, and this is a volume", path);
  ImportRequest request{path, {}, {}};
  request.read.series = option.series;
  if (!option.unit.empty()) request.read.unit = length_unit(option.unit);
  request.read.progress = [&](double share) { progress.show(share, "reading"); };
  const bool own = lower(path).ends_with(".vdb") && option.unit.empty();
  auto imported = import_bone(request, [&](const std::string& line) { progress.say(line); });
  if (!imported) {
    Error error = imported.error();
    if (own && has_remaining(path)) error.message += "; it holds changes alone: export the scene, with --restore " + path;
    return error;
  }
  return Source{std::move(imported->bone), std::nullopt};
}

/// @returns the error of an input that is not there, with the nearest shipped scene.
Error input_not_found(const std::string& input) {
  const auto near = nearest_name(fs::path(input).stem().string(), shipped_names("scenes"));
  return bad_input("there is no such file, and no shipped scene of that name" +
                       (near ? "; did you mean \"" + *near + "\"?" : std::string(" (burrhole scenes lists them)")),
                   input);
}

std::optional<Source> load_source(const Options& option, Progress& progress, int& exit_code) {
  std::error_code ignored;
  if (!fs::exists(find_scene(option.input.scene), ignored)) {
    exit_code = report(input_not_found(option.input.scene));
    return std::nullopt;
  }
  if (is_scene(option.input.scene)) {
    if (!option.unit.empty() || !option.series.empty()) {
      exit_code = report(bad_input("--unit and --series are for volumes: a scene has keys for them", option.input.scene));
      return std::nullopt;
    }
    auto loaded = load_or_report(option.input, exit_code, option.quiet);
    if (!loaded) return std::nullopt;
    return Source{std::move(loaded->bone), std::move(loaded->scene.approach)};
  }
  auto source = load_volume(option, progress);
  if (source) return std::move(*source);
  exit_code = report(source.error());
  return std::nullopt;
}

Status export_plan(const Options& option, const Source& source) {
  if (!source.approach) return bad_input("a planned line is that of a scene, and this is a volume", option.input.scene);
  const auto approach = make_approach(*source.bone, *source.approach);
  if (!approach) return approach.error();
  const Pose& pose = approach->bone_from_approach;
  const PlannedLine line{pose.translation, source.approach->target.value_or(pose * Vec3(0.0, 0.0, -approach->thickness))};
  if (Status written = write_planned_line(option.output, line); !written) return written;
  const Vec3 entry = line.entry / kMillimetre, target = line.target / kMillimetre;
  print(fmt::format("{}: entry ({:.2f}, {:.2f}, {:.2f}), target ({:.2f}, {:.2f}, {:.2f}) mm, LPS\n", option.output, entry.x, entry.y,
                    entry.z, target.x, target.y, target.z));
  return {};
}

std::string report_text(const Options& option, const ExportReport& done, bool drilled) {
  const std::string size = fmt::format("{:.1f} MB", static_cast<double>(done.bytes) * 1e-6);
  const char* state = drilled ? "as drilled" : "as loaded";
  if (done.triangles > 0)
    return fmt::format("{}: {}, surface of the bone {}, {} triangles, mm in LPS, {}\n", option.output, done.format, state, done.triangles,
                       size);
  return fmt::format("{}: {}, {} of the bone {}, {} x {} x {} voxels, {}\n", option.output, done.format,
                     done.format == "OpenVDB" ? "all fields"
                     : option.field.empty()   ? "density"
                                              : option.field.c_str(),
                     state, done.dims.x, done.dims.y, done.dims.z, size);
}

Status export_volume(const Options& option, const Source& source, Progress& progress) {
  auto voxmap = Voxmap::create(source.bone, {});
  if (!voxmap) return voxmap.error();
  if (!option.restore.empty())
    if (Status restored = voxmap->restore(option.restore); !restored) return restored;
  ExportRequest request = request_of(option);
  request.progress = [&](double share) { progress.show(share, "writing"); };
  request.stop = &stop_requested();
  request.begin = catch_all_signals;
  const auto done = export_bone(*voxmap, request);
  if (!done) return done.error();
  print(report_text(option, *done, voxmap->blocks().size() > 0 && !option.undrilled));
  return {};
}

int export_input(const Options& option) {
  if (const Status names = check_names(option); !names) return report(names.error());
  const bool plan = is_markups_path(option.output);
  const Status valid = plan ? check_markups(option) : check_request(request_of(option));
  if (!valid) return report(valid.error());
  if (const Status paths = check_paths(option); !paths) return report(paths.error());
  if (option.undrilled && !option.restore.empty())
    return report(bad_input("--restore and --undrilled exclude each other: with the hole, or without it"));
  end_at_signals();  // the surface of a bone, for example, takes long and writes nothing
  Progress progress(option.quiet, kReadingDelay);
  int exit_code = kDone;
  const auto source = load_source(option, progress, exit_code);
  if (!source) return exit_code;
  const Status done = plan ? export_plan(option, *source) : export_volume(option, *source, progress);
  if (done) return kDone;
  const int failed = report(done.error());
  return stop_requested() ? kInterrupted : failed;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "export", kSceneGroup,
      {.summary = "Writes a bone, its surface or the planned line for other programs",
       .about =
           "INPUT is the bone.vdb of a run, any volume that import reads, or a scene. The ending of the output chooses what is written: "
           ".nrrd, .nii or .nii.gz voxels; .vdb all fields, which this program reads again; .stl, .ply or .obj the surface; .mrk.json or "
           ".fcsv entry and target of a scene's approach, for 3D Slicer. Coordinates are mm in the patient's LPS, in NIfTI RAS. "
           "docs/export.md has a Python example.",
       .examples = {"burrhole export out/bone.vdb -o drilled.nii.gz", "burrhole export out/bone.vdb -o before.nrrd --undrilled",
                    "burrhole export out/bone.vdb -o labels.nii.gz --field labels --crop", "burrhole export out/bone.vdb -o skull.stl",
                    "burrhole export my_scene.toml --restore out/bone.vdb -o drilled.nrrd", "burrhole export parietal -o plan.mrk.json"},
       .exits = "Exit 130 after Ctrl-C: a file that was there is kept, and no part of a new one is left."});
  auto option = std::make_shared<Options>();
  command->add_option("input", option->input.scene, "bone.vdb of a run, volume that import reads, scene file, or name of a shipped scene")
      ->type_name(kFileValue)
      ->required();
  command->add_option("-o,--out", option->output, "file to write: .nrrd .nii .nii.gz .vdb .stl .ply .obj .mrk.json .fcsv")
      ->type_name(kFileValue)
      ->required();
  command->add_option("--field", option->field, "what the voxels hold: density, hardness, remaining or labels (default density)")
      ->type_name("FIELD")
      ->check(CLI::IsMember(export_field_names()));
  command->add_flag("--undrilled", option->undrilled, "the bone as loaded, without holes");
  command->add_flag("--crop", option->crop, "only the box round the bone; it stays where it is in the patient");
  command->add_option("--restore", option->restore, "checkpoint with the holes: the bone.vdb of a run of this bone, or its folder")
      ->transform([](const std::string& given) { return bone_of(given); })
      ->type_name(kFileValue);
  command->add_option("--set", option->input.sets, "override a key of a scene, e.g. --set volume.spacing_mm=0.5 (repeatable)")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--unit", option->unit, "unit of length of a mesh or another program's .vdb, which carry none")
      ->check(CLI::IsMember(length_unit_names()));
  command->add_option("--series", option->series, "series of a DICOM folder, or grid of another program's .vdb; default: the best");
  command->add_flag("--force", option->force, "replace a file of that name");
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, &exit_code] { exit_code = export_input(*option); });
}

}  // namespace burrhole::cli
