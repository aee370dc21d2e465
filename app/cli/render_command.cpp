#include <fmt/format.h>

#include <filesystem>

#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/cli/given_paths.h"
#include "app/cli/picture_sink.h"
#include "app/cli/volume_picture.h"
#include "app/cli/volume_source.h"
#include "app/run/simulation.h"
#include "app/scene/memory_plan.h"
#include "app/scene/volume_scene.h"
#include "app/view/display_config.h"
#include "app/view/driver_text.h"
#include "app/view/picture_memory.h"
#include "core/base/units.h"
#include "volumes/export_bone.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kSliceHalfWidth = 20e-3;  ///< [m] of slices through the tip

struct Options {
  SceneOption scene;
  std::string image = "burrhole.png", size, camera, method, restore, unit, gl = "auto", shader_folder;
  std::string mesh;  ///< value of --export; empty: a picture is drawn
  bool cut = false, no_tool = false, overview = false, slices_through_tip = false;
  bool stereo = false, workbench = false;  ///< the options were given
  std::optional<double> depth_mm;
};

Status apply_view(const Options& option, DisplayConfig& display) {
  if (!option.method.empty()) display.method = option.method;
  if (display.method != "raycast") {
    display.transfer.clear();
    display.budget.reset();
    // Slices and meshes do not support it.
    display.appearance.tissue = display.appearance.occlusion = display.appearance.shadow = false;
  }
  if (!draws_surface(display)) display.skin.reset();
  if (!option.size.empty()) {
    const auto size = split_numbers(option.size, 'x', 2);
    if (!size || !((*size)[0] >= 16 && (*size)[0] <= 8192 && (*size)[1] >= 16 && (*size)[1] <= 8192))
      return bad_input("--size " + option.size + " must be WIDTHxHEIGHT, each in [16, 8192]");
    display.width = static_cast<int>((*size)[0]);
    display.height = static_cast<int>((*size)[1]);
  }
  if (!option.camera.empty()) {
    const auto camera = split_numbers(option.camera, ',', 3);
    if (!camera || !((*camera)[2] > 0.0) || !(std::abs((*camera)[1]) < 90.0))
      return bad_input("--camera " + option.camera + " must be AZIMUTH,ELEVATION,DISTANCE in degrees and mm");
    display.azimuth = (*camera)[0] * kDegree;
    display.elevation = (*camera)[1] * kDegree;
    display.distance = (*camera)[2] * kMillimetre;
    if (option.overview) display.overview = display.distance;
  }
  display.only_overviews = option.overview;
  if (option.overview && !display.overview) return bad_input("--overview needs --camera or display.overview_mm");
  return {};
}

/// @returns world_from_tool at the start of the scene, or with the tip at --depth-mm below the entry.
Pose tool_pose(const Options& option, Simulation& simulation, const Scene& scene) {
  if (!option.depth_mm) return simulation.contact_state().world_from_tool;
  const Pose world_from_approach = scene.volume.world_from_bone * simulation.approach().bone_from_approach;
  return world_from_approach * Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, -*option.depth_mm * kMillimetre)};
}

/// Writes the surface of a bone in place of a picture.
Status export_mesh(const Options& option, const Voxmap& voxmap) {
  ExportRequest request{.path = option.mesh, .ball = true};
  request.begin = catch_all_signals;
  request.stop = &stop_requested();
  const auto done = export_bone(voxmap, request);
  if (!done) return done.error();
  print(fmt::format("{}: {}, surface of the bone by ball pivoting, {} triangles, mm in LPS, {:.1f} MB\n", option.mesh, done->format,
                    done->triangles, static_cast<double>(done->bytes) * 1e-6));
  return {};
}

/// @returns the error of a path of --export that cannot be a mesh.
Status check_mesh_path(const std::string& path) {
  const auto format = export_format(path);
  if (format && (*format == "STL" || *format == "PLY" || *format == "OBJ")) return {};
  return bad_input("--export " + path + " must end in .stl, .ply or .obj; burrhole export writes voxels");
}

/// The same of a scene: as loaded, or as a checkpoint has it.
Status export_scene(const Options& option, const LoadedScene& loaded) {
  auto voxmap = Voxmap::create(loaded.bone, {});
  if (!voxmap) return voxmap.error();
  if (!option.restore.empty())
    if (Status restored = voxmap->restore(option.restore); !restored) return restored;
  return export_mesh(option, *voxmap);
}

/// Draws slices through the tip. They need no renderer, so the simulation is built without [display].
Status draw_slices(const Options& option, LoadedScene& loaded, const fs::path& image) {
  const DisplayConfig display = *loaded.scene.find<DisplayConfig>();
  (void)loaded.scene.effects.remove("display");
  SimulationOptions options;
  options.restore_path = option.restore;
  options.runs = false;
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!simulation) return issues.front();
  const Pose bone_from_tool = loaded.scene.volume.world_from_bone.inverse() * tool_pose(option, *simulation, loaded.scene);
  const auto make = [&](int size) {
    return make_tip_slices(simulation->voxmap(), loaded.tool.mesh, bone_from_tool, kSliceHalfWidth, size);
  };
  return write_tip_slices(
      image.string(), display.width, display.height, make,
      {"cross: the tip of the bit", "orange: the bit as it erodes", "grey: occupancy x hardness,", "of what bone remains"});
}

/// The options of this command may ask for more pixels, or a mesh, than the scene did when its bone was placed.
Status check_memory_limit(const LoadedScene& loaded) {
  const Scene& scene = loaded.scene;
  if (!scene.memory_limit) return {};
  const MemoryPlan plan = plan_memory(scene, loaded.tool, shape_of(*loaded.bone, scene.approach), 0, {});
  if (plan.peak <= *scene.memory_limit) return {};
  return bad_input(
      "limits.memory_mb is exceeded: the picture may need " + plan.text() + " (a smaller --size or another --method needs less)",
      scene.memory_place);
}

Status draw_scene(const Options& option, LoadedScene& loaded) {
  if (!option.mesh.empty()) return export_scene(option, loaded);
  if (!loaded.scene.effects.has("display")) add_effect(loaded.scene, "display");
  DisplayConfig& display = *loaded.scene.find<DisplayConfig>();
  const std::uint64_t planned = picture_bytes(display);
  const std::string method = display.method;
  if (Status applied = apply_view(option, display); !applied) return applied;
  if (picture_bytes(display) > planned || display.method != method)
    if (Status fits = check_memory_limit(loaded); !fits) return fits;
  const fs::path image(option.image);
  if (image.extension() != ".png") return bad_input("--image " + option.image + " must end in .png");
  if (option.slices_through_tip) return draw_slices(option, loaded, image);
  auto sink = make_picture_sink(display, {.folder = image.has_parent_path() ? image.parent_path().string() : ".",
                                          .gl = option.gl,
                                          .shader_folder = option.shader_folder,
                                          .report = [](const std::string& line) { note(fmt::format("quality: {}\n", line)); }});
  if (!sink) return sink.error();
  SimulationOptions options;
  options.sink = sink->get();
  options.restore_path = option.restore;
  options.runs = false;
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!simulation) return issues.front();
  note(fmt::format("{}\n", driver_text((*sink)->driver())));
  const std::optional<Pose> tool = option.no_tool ? std::nullopt : std::optional(tool_pose(option, *simulation, loaded.scene));
  if (Status drawn = simulation->stage().draw(image.stem().string(), tool, option.cut); !drawn) return drawn;
  const auto files = (*sink)->files();
  if (!files) return files.error();
  return loaded.bone->read_status();
}

/// Options that name a part of a scene. @returns bad_input if one was given for a volume.
Status check_volume_options(const Options& option) {
  const std::pair<bool, const char*> scene_only[] = {{option.stereo, "--stereo"},
                                                     {option.workbench, "--workbench"},
                                                     {!option.scene.unsets.empty(), "--unset"},
                                                     {!option.scene.tool_sets.empty(), "--set-tool"},
                                                     {option.overview, "--overview"},
                                                     {!option.restore.empty(), "--restore"},
                                                     {option.no_tool, "--no-tool"},
                                                     {option.depth_mm.has_value(), "--depth-mm"},
                                                     {option.slices_through_tip, "--slices-through-tip"}};
  for (const auto& [given, name] : scene_only)
    if (given)
      return bad_input(fmt::format("{} needs a scene: {} is a volume, which has no tables, no bit and no approach; leave {} out", name,
                                   option.scene.scene, name));
  return {};
}

/// Draws a volume in place of a scene: all of its bone, from anterior left above, or with --cut a section seen along its normal.
Status draw_volume(const Options& option) {
  if (Status valid = check_volume_options(option); !valid) return valid;
  VolumePicture picture;
  picture.gl = option.gl;
  picture.shader_folder = option.shader_folder;
  picture.view.cut = option.cut;
  if (option.cut) {  // a sagittal section, from the patient's left
    picture.view.azimuth = 90.0 * kDegree;
    picture.view.elevation = 0.0;
  }
  if (Status applied = apply_view(option, picture.display); !applied) return applied;
  if (!option.camera.empty()) {
    picture.view.azimuth = picture.display.azimuth;
    picture.view.elevation = picture.display.elevation;
    picture.view.distance = picture.display.distance;
  }
  const fs::path image(option.image);
  if (image.extension() != ".png") return bad_input("--image " + option.image + " must end in .png");
  std::vector<std::string> sets = option.scene.sets;
  if (!option.unit.empty()) sets.push_back("volume.unit=\"" + option.unit + "\"");
  const auto volume = read_volume_for_picture(option.scene.scene, sets);
  if (!volume) return volume.error();
  if (!option.mesh.empty()) {
    const auto voxmap = Voxmap::create(volume->bone, {});
    return voxmap ? export_mesh(option, *voxmap) : Status(voxmap.error());
  }
  picture.display.orientation = knows_directions(volume->report);
  const auto driver = write_volume_picture(image.string(), *volume->bone, picture);
  if (!driver) return driver.error();
  note(fmt::format("{}\n", driver_text(*driver)));
  return {};
}

/// @returns the exit code; names the picture, or the error.
int end_of(const Status& drawn, const Options& option) {
  if (!drawn) return report(drawn.error());
  if (option.mesh.empty()) print_line("picture: " + option.image);
  return kDone;
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "render", kDrillGroup,
      {.summary = "Draws one picture of a scene or of a volume",
       .about =
           "Draws the scene offscreen into one PNG file: the bone as loaded, or with --restore the drilled bone of an earlier run, from "
           "the scene's camera or from --camera. In place of a scene it takes what burrhole import reads, a file or a folder, and draws "
           "all of its bone from anterior left, or with --cut a sagittal section from the left; with --camera the section that faces the "
           "camera most.",
       .examples = {"burrhole render parietal --image before.png", "burrhole render head.nrrd --image head.png",
                    "burrhole render parietal --restore out/bone.vdb --cut --camera 35,20,60 --image hole.png",
                    "burrhole render parietal --restore out/bone.vdb --slices-through-tip --depth-mm 4 --image slices.png"},
       .exits = "Exit 4 if there is no OpenGL."});
  auto option = std::make_shared<Options>();
  option->scene.add_to(*command);
  add_stereo_options(*command, option->scene);
  command->add_option("--unit", option->unit, "of a volume: unit of length of a mesh or another program's .vdb, which carry none")
      ->check(CLI::IsMember(length_unit_names()));
  command->add_option("--image", option->image, "PNG file to write")->type_name(kFileValue)->capture_default_str();
  command->add_option("--export", option->mesh, "write the bone as a closed mesh by ball pivoting, in place of a picture: .stl .ply .obj")
      ->type_name(kFileValue);
  command->add_option("--size", option->size, "size in pixels; default: the scene's")->type_name("WIDTHxHEIGHT");
  command->add_option("--camera", option->camera, "degrees, degrees, mm to the entry, or to the middle of a volume; default: the scene's")
      ->type_name("AZIMUTH,ELEVATION,DISTANCE");
  command->add_option("--method", option->method, "how bone is drawn; default: the scene's")
      ->type_name("METHOD")
      ->check(CLI::IsMember({"raycast", "slices", "mesh"}));
  command->add_option("--restore", option->restore, "checkpoint: the bone.vdb of an earlier run, or its folder")
      ->transform([](const std::string& given) { return bone_of(given); })
      ->type_name(kFileValue);
  add_gl_option(*command, option->gl);
  add_shader_option(*command, option->shader_folder);
  command->add_flag("--cut", option->cut, "section through the axis");
  command->add_flag("--overview", option->overview, "all that is drawn, from the distance of --camera or display.overview_mm");
  command->add_flag("--no-tool", option->no_tool, "without the bit");
  command->add_option("--depth-mm", option->depth_mm, "depth of the bit's tip below the entry; default: the start pose of the scene")
      ->type_name("MM")
      ->check(number_in(-100.0, 100.0));
  command->add_flag("--slices-through-tip", option->slices_through_tip,
                    "three slices of 40 mm through the tip, grey by density, instead of a perspective view");
  command->callback([option, command, &exit_code] {
    option->stereo = command->count("--stereo") > 0;
    option->workbench = command->count("--workbench") > 0;
    if (const Status valid = option->mesh.empty() ? Status() : check_mesh_path(option->mesh); !valid) {
      exit_code = report(valid.error());
      return;
    }
    if (is_volume(find_scene(option->scene.scene))) {
      exit_code = end_of(draw_volume(*option), *option);
      return;
    }
    if (!option->unit.empty()) {
      exit_code = report(bad_input("--unit is for a volume; a scene has volume.unit"));
      return;
    }
    auto loaded = load_or_report(option->scene, exit_code);
    if (!loaded) return;
    if (!loaded->paged_note.empty()) print_warning(loaded->scene.file, "[limits] " + loaded->paged_note);
    exit_code = end_of(draw_scene(*option, *loaded), *option);
  });
}

}  // namespace burrhole::cli
