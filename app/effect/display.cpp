// [display]: pictures of the bone and the tool. Texels of changed boxes are sent to the display, then a picture is drawn.

#include <fmt/format.h>

#include <cmath>

#include "app/effect/display_mesh.h"
#include "app/effect/display_skin.h"
#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "app/view/bone_mesh.h"
#include "app/view/detail.h"
#include "app/view/display_config.h"
#include "app/view/picture_memory.h"
#include "app/view/stereo.h"
#include "app/view/texture_file.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "volumes/phantom/head_bone.h"
#include "volumes/phantom/head_shape.h"

namespace burrhole {
namespace {

/// Reads the points of [[display.transfer]]; the default shows translucent bone, brighter where it is thin.
TransferFunction read_transfer(TableReader& table) {
  TransferFunction out;
  for (TableReader& row : table.tables(
           "transfer",
           "points of the piecewise linear transfer function from density to opacity and tint; default: opacity 0 up to a density of 0.3, "
           "then linear to 0.25 per mm at 1")) {
    TransferPoint point;
    point.density = row.number("density", {.fallback = std::nullopt, .min = 0.0, .max = 1.0},
                               "density of bone, occupancy x remaining: 0 empty, 1 full");
    point.extinction = row.number("opacity_per_mm", {.fallback = std::nullopt, .min = 0.0, .max = 1000.0, .to_si = 1.0 / kMillimetre},
                                  "extinction: light is attenuated by exp(-value) per millimetre");
    const auto tint = row.numbers("tint", std::vector<double>{1.0, 1.0, 1.0}, 3, {.min = 0.0, .max = 1.0},
                                  "red, green and blue, multiplied by the tissue's colour");
    point.tint = Vec3(tint[0], tint[1], tint[2]);
    if (!out.empty() && point.density <= out.back().density) row.fault("density", "must be larger than the one before");
    row.finish();
    out.push_back(point);
  }
  if (out.empty()) out = {{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 0.25 / kMillimetre}};
  return out;
}

/// Reads the quality: key by key, or by a budget. @param rays bone is drawn by ray casting. @param finish it is drawn as a surface.
void read_quality(TableReader& table, bool rays, bool finish, DisplayConfig& out) {
  const std::string choice =
      table.choice("quality", "fixed", {"fixed", "auto"},
                   "fixed: by the keys of this table; auto: the most accurate quality that is predicted to meet budget_ms on this "
                   "machine");
  if (choice == "auto") {
    if (!rays) table.fault("quality", "needs method = \"raycast\"");
    out.budget = table.number("budget_ms", above_zero(100.0, 1e-3, 1e5), "time of a picture for which the quality is chosen");
    for (const char* key : {"step_voxels", "bisections", "finish", "supersample", "resolution"})
      if (table.has(key)) table.fault(key, "is chosen by quality = \"auto\": remove one of the two");
    return;
  }
  DrawingQuality& quality = out.quality;
  if (rays)
    quality.step_voxels =
        table.number("step_voxels", {.fallback = 0.5, .min = 0.0, .max = 1.0, .min_open = true}, "distance of samples along a ray");
  if (finish) {
    quality.bisections = static_cast<int>(
        table.integer("bisections", quality.bisections, 0, 16, "bisections of the ray step that hits bone; each halves the error"));
    quality.finish =
        table.boolean("finish", true, "smoothed normals and soft highlights, and ambient occlusion if enabled; false: plain lighting");
  }
  quality.supersample =
      static_cast<int>(table.integer("supersample", quality.supersample, 1, 4, "rays along each edge of a pixel, for anti-aliasing"));
  quality.resolution =
      table.number("resolution", {.fallback = 1.0, .min = 0.25, .max = 1.0}, "share of width and height that is drawn and then scaled up");
}

/// Reads the keys of light and tissue. Those that only ray-cast surfaces support are read for these alone.
Appearance read_appearance(TableReader& table, const DisplayConfig& display) {
  const bool surface = draws_detail(display), translucent = !display.transfer.empty(), mesh = display.method == "mesh";
  Appearance out;
  out.labels = table.boolean("label_colours", true, "colours by tissue and mineral density; false: one ivory colour");
  if (!translucent && !mesh &&
      table.choice("normals", "texture", {"texture", "recomputed"},
                   "texture: normals as stored with the texels; recomputed: from density differences in the shader") == "recomputed")
    out.normals = NormalSource::recomputed;
  const auto read_specular = [&] { out.specular = table.boolean("specular", false, "specular highlights of a wet surface"); };
  if (mesh) read_specular();
  if (!surface) return out;
  out.tissue =
      table.choice("tissue", "procedural", {"procedural", "plain"},
                   "procedural: details of original surface, cut bone, pores of diploe and vessels on dura; plain: colours only") ==
      "procedural";
  out.occlusion = table.boolean("ambient_occlusion", true, "ambient occlusion");
  out.shadow = table.boolean("shadow", false, "shadows of bone and tool on bone");
  read_specular();
  return out;
}

Vec3 read_color(TableReader& table, const char* key, const Vec3& fallback, const char* about) {
  const auto rgb = table.numbers(key, std::vector<double>{fallback.x, fallback.y, fallback.z}, 3, {.min = 0.0, .max = 1.0}, about);
  return {rgb[0], rgb[1], rgb[2]};
}

CutConfig read_cut(TableReader& table) {
  CutConfig out;
  const std::string kind =
      table.choice("cut", "none", {"none", "plane", "tip"},
                   "clips the bone; plane: at the plane of cut_point_mm and cut_normal; tip: at the plane through the tool's tip "
                   "that is perpendicular to the view");
  if (kind == "none") return out;
  out.kind = kind == "tip" ? CutKind::tip : CutKind::plane;
  if (out.kind == CutKind::tip) return out;
  const NumberRule millimetres{.fallback = std::nullopt, .min = -5000.0, .max = 5000.0, .to_si = kMillimetre};
  const auto point = table.numbers("cut_point_mm", std::nullopt, 3, millimetres, "point of the plane, bone frame");
  const auto normal = table.numbers("cut_normal", std::nullopt, 3, {.fallback = std::nullopt, .min = -1e6, .max = 1e6},
                                    "normal towards the side that is clipped, bone frame; any length above 0");
  out.point = {point[0], point[1], point[2]};
  out.normal = {normal[0], normal[1], normal[2]};
  if (glm::length(out.normal) == 0.0) table.fault("cut_normal", "must not be zero");
  return out;
}

std::optional<WorkbenchView> read_workbench(TableReader& table) {
  const auto height = table.optional_number(
      "workbench_mm", above_zero(0.0, kMillimetre, 5000.0),
      "height of a screen at the camera's target, on which bone is shown at its true size and place for a head before it: the haptic "
      "workbench of [AcostaLiu07]; absent: the camera's own distance and field");
  if (!height) return std::nullopt;
  WorkbenchView out{.height = *height};
  const NumberRule millimetres{.fallback = std::nullopt, .min = -5000.0, .max = 5000.0, .to_si = kMillimetre};
  const auto head = table.numbers("head_mm", std::vector<double>{0.0, 0.0, 500.0}, 3, millimetres,
                                  "midway between the eyes, from the middle of the screen: right, up, towards the viewer");
  out.head = {head[0], head[1], head[2]};
  if (!(out.head.z > 0.0)) table.fault("head_mm", "must have a third number above 0: the head is in front of the screen");
  out.mirrored = table.boolean("mirrored", false, "the screen is seen in a mirror: the picture is upside down");
  return out;
}

StereoView read_stereo(TableReader& table, double distance) {
  StereoView out;
  const std::string mode = table.choice("stereo", "off", {"off", "side-by-side", "top-bottom", "anaglyph", "quad"},
                                        "pictures of two eyes in one, each eye with the pixels of the key size; anaglyph: for red and cyan "
                                        "glasses; quad: each eye in a buffer "
                                        "of its own, in a window whose driver has them");
  out.workbench = read_workbench(table);
  if (mode == "off") return out;
  constexpr double kPupils = 63.0 * kMillimetre;  // mean of adults: Dodgson, Proc. SPIE 5291 (2004)
  out.mode = stereo_mode(mode);
  out.separation = table
                       .optional_number("eye_separation_mm", above_zero(0.0, kMillimetre, 200.0),
                                        "distance between the eyes; default distance_mm / 30, of a workbench 63")
                       .value_or(out.workbench ? kPupils : distance / 30.0);
  if (out.workbench) return out;
  out.screen = table
                   .optional_number("screen_mm", above_zero(0.0, kMillimetre, 5000.0),
                                    "distance from the eyes to the plane without parallax; default distance_mm")
                   .value_or(distance);
  return out;
}

/// Reads what pictures show beside the bone as it is known.
void read_marks(TableReader& table, const VolumeScene& volume, DisplayConfig& out) {
  const bool scan = volume.scan.has_value(), head = volume.phantom && volume.phantom->kind == PhantomKind::head;
  out.orientation = table.boolean("orientation_mark", true, "directions A P L R S I of a head or scan") && (scan || head);
  out.inset = table.boolean("inset", out.inset, "a small picture of a whole head beside those of its site");
  out.assumed_brain = table.boolean("assumed_brain", true, "dura and brain are drawn under the bone of a scan, which holds none") && scan;
}

/// Reads what surrounds the bone in pictures.
void read_scenery(TableReader& table, const StageConfig& scene, DisplayConfig& out) {
  out.overview = table.optional_number("overview_mm", above_zero(0.0, kMillimetre, 5000.0),
                                       "distance of the camera in the picture overview, the first of a run, which shows all that is drawn; "
                                       "absent: no such picture");
  out.table = table.boolean("table", out.table, "a table under what is drawn, across the approach axis");
  const auto drape = table.optional_choice(
      "drape", {"square", "round"}, "a cloth over the head of \"phantom:head\", with a square or round window at the entry; absent: none");
  if (!drape) return;
  const auto& phantom = scene.volume.phantom;
  if (!phantom || phantom->kind != PhantomKind::head) return table.fault("drape", "needs volume.source = \"phantom:head\"");
  out.drape.emplace();
  out.drape->round = *drape == "round";
  // Texels of cut bone reach three coarse voxels beyond the region; those of cloth are sent once.
  const double side = std::max(phantom->region.x, phantom->region.y) + 6.0 * phantom->surroundings;
  const double least = out.drape->round ? std::sqrt(2.0) * side : side;
  const double window =
      table.number("drape_window_mm", {.fallback = std::ceil(least / kMillimetre), .min = 1.0, .max = 200.0, .to_si = kMillimetre},
                   "width of that window; default: the least that shows the region of the bone");
  if (window < least - 1e-9)
    table.fault("drape_window_mm",
                fmt::format("must be at least {:.3g}, so that the cloth leaves the region of the bone free", least / kMillimetre));
  out.drape->window = window;
}

DisplayConfig read_display(TableReader& table, const StageConfig& scene) {
  DisplayConfig out;
  out.method = table.choice(
      "method", "raycast", {"raycast", "slices", "mesh"},
      "how bone is drawn: ray casting, slices blended back to front, or a mesh of triangles that is updated where bone changes");
  if (out.method == "raycast") {
    const std::string shading =
        table.choice("shading", "surface", {"surface", "translucent"},
                     "surface: bone as an opaque surface; translucent: as a translucent volume with a transfer function");
    if (shading == "translucent") out.transfer = read_transfer(table);
  }
  if (out.method == "slices") {
    out.slices_per_voxel = table.number("slices_per_voxel", {.fallback = out.slices_per_voxel, .min = 0.0, .max = 8.0, .min_open = true},
                                        "slices per voxel along the volume axis nearest to the direction of view");
    out.opacity_correction = table.boolean(
        "opacity_correction", out.opacity_correction,
        "true: a density is the opacity of a path of one mean voxel edge; false: that of one slice, at any distance between slices, as in "
        "[AcostaLiu07]");
  }
  read_quality(table, out.method == "raycast", out.method == "raycast" && out.transfer.empty(), out);
  out.appearance = read_appearance(table, out);
  if (out.method == "mesh") read_mesh_colors(table, scene, out);
  out.background.top = read_color(table, "background_top", out.background.top, "red, green and blue of the background at the upper edge");
  out.background.bottom =
      read_color(table, "background_bottom", out.background.bottom, "red, green and blue of the background at the lower edge");
  const auto size = table.numbers("size", std::vector<double>{static_cast<double>(out.width), static_cast<double>(out.height)}, 2,
                                  {.min = 16, .max = 8192}, "width and height of a picture in pixels");
  out.width = static_cast<int>(size[0]);
  out.height = static_cast<int>(size[1]);
  out.upload_budget = static_cast<std::size_t>(table.integer(
                          "upload_budget_kb", static_cast<std::int64_t>(out.upload_budget / 1024), 1, 4'000'000,
                          "largest amount of changed texels sent for one picture, in 1024 bytes; the rest is sent for the next ones")) *
                      1024;
  out.upload_time =
      table.number("upload_budget_ms", {.fallback = out.upload_time * 1e3, .min = 0.0, .max = 1000.0, .to_si = 1e-3},
                   "limit of the wall time for computing these texels; with a limit pictures differ from run to run; 0: no limit");
  out.azimuth = table.number(
      "azimuth_deg", {.fallback = out.azimuth / kDegree, .min = -360, .max = 360, .to_si = kDegree},
      "direction from target to camera: angle about +z of the approach frame, from its -y towards its +x; the target is on the "
      "approach axis, 0.8 of the thickness of the bone below the entry");
  out.elevation = table.number("elevation_deg", {.fallback = out.elevation / kDegree, .min = -89, .max = 89, .to_si = kDegree},
                               "direction from target to camera: angle above the xy plane of the approach frame");
  out.distance =
      table.number("distance_mm", above_zero(out.distance / kMillimetre, kMillimetre, 5000.0), "distance of the camera from that target");
  out.whole_voxels = static_cast<std::size_t>(table.integer(
      "whole_voxels", static_cast<std::int64_t>(out.whole_voxels), 1000, 1'000'000'000,
      "largest texture of the whole bone; a larger bone is drawn at coarser voxels, and by method = \"raycast\" with shading = "
      "\"surface\" a part around the entry, or where bone is cut, at its own voxels"));
  if (draws_detail(out))
    out.detail = table.number("detail_mm", above_zero(out.detail / kMillimetre, kMillimetre, 500.0), "edge of that part");
  out.scale_bar =
      table.boolean("scale_bar", out.scale_bar, "draws a scale bar; its length is exact at the distance of the camera's target");
  out.cut = read_cut(table);
  out.stereo = read_stereo(table, out.distance);
  read_marks(table, scene.volume, out);
  read_scenery(table, scene, out);
  out.appearance.drape = out.drape.has_value();
  read_skin(table, scene, out);
  return out;
}

/// @returns the names of the options of light and tissue that are enabled.
std::string appearance_text(const Appearance& appearance) {
  std::string out;
  const auto add = [&out](bool on, const char* name) {
    if (on) out += std::string(", ") + name;
  };
  add(appearance.tissue, "tissue");
  add(appearance.occlusion, "ambient occlusion");
  add(appearance.shadow, "shadow");
  add(appearance.specular, "specular");
  add(!appearance.labels, "one colour");
  add(appearance.normals == NormalSource::recomputed, "normals recomputed");
  return out;
}

std::string method_text(const DisplayConfig& display) {
  const std::string appearance = appearance_text(display.appearance);
  if (!display.transfer.empty()) return fmt::format("{}, translucent{}", display.method, appearance);
  if (display.method != "slices") return display.method + (draws_textures(display) ? ", textures" : "") + appearance;
  return fmt::format("slices, {:g} a voxel{}{}", display.slices_per_voxel, display.opacity_correction ? "" : ", opacity a slice",
                     appearance);
}

/// @returns the grids of a head phantom; nothing for another bone.
std::optional<HeadGrid> head_of(const StageConfig& config) {
  const auto& phantom = config.volume.phantom;
  if (!phantom || phantom->kind != PhantomKind::head) return std::nullopt;
  return head_grid(*phantom);
}

/// Volumes that are drawn.
struct Levels {
  int factor = 1;  ///< [voxels] of the bone, edge of a voxel of the whole volume
  bool has_detail = false;
  std::uint64_t voxels = 0;  ///< of all volumes
};

Levels levels_of(const DisplayConfig& display, const BoneShape& bone, const std::optional<HeadGrid>& head) {
  Levels out;
  if (head) {
    out.factor = head->factor;
    out.has_detail = draws_detail(display);
    out.voxels = VoxelBox{Vec3i(0), head->coarse_dims}.count() + (out.has_detail ? head->region.count() : 0);
    return out;
  }
  out.factor = coarse_factor(bone.dims, display.whole_voxels);
  out.voxels = VoxelBox{Vec3i(0), out.factor == 1 ? bone.dims : CoarseBone::dims_of(bone.dims, out.factor)}.count();
  out.has_detail = out.factor > 1 && draws_detail(display);
  if (out.has_detail)
    out.voxels += place_detail(bone.dims, out.factor, Vec3(bone.dims / 2), detail_edge(display, bone.bone_from_index)).box.count();
  return out;
}

std::string levels_text(const DisplayConfig& display, const BoneShape& bone, const std::optional<HeadGrid>& head) {
  const Levels levels = levels_of(display, bone, head);
  if (levels.factor == 1) return {};
  const double edge = bone.bone_from_index.mean_edge() / kMillimetre;
  if (head)
    return fmt::format(", the head at voxels of {:.3g} mm{}", levels.factor * edge,
                       levels.has_detail ? fmt::format(" and the region at {:.3g} mm", edge) : std::string());
  std::string out = fmt::format(", the whole bone at voxels of {:.3g} mm", levels.factor * edge);
  if (levels.has_detail) out += fmt::format(" and {:.3g} mm around the entry at {:.3g} mm", display.detail / kMillimetre, edge);
  return out;
}

/// @returns the options of cut, stereo and scale bar.
std::string picture_text(const DisplayConfig& display) {
  std::string out;
  if (display.cut.kind != CutKind::none) out += display.cut.kind == CutKind::tip ? ", cut at the tip" : ", cut at a plane";
  if (display.stereo.mode != StereoMode::off)
    out += fmt::format(", {} of two eyes {:.3g} mm apart", stereo_name(display.stereo.mode), display.stereo.separation / kMillimetre);
  if (const auto& bench = display.stereo.workbench)
    out += fmt::format(", workbench of {:.3g} mm{}", bench->height / kMillimetre, bench->mirrored ? ", mirrored" : "");
  if (display.table) out += ", on a table";
  if (display.drape) out += fmt::format(", draped, window of {:.3g} mm", display.drape->window / kMillimetre);
  if (display.skin) out += fmt::format(", skin with an opening of {:.3g} mm", display.skin->window / kMillimetre);
  if (display.overview) out += ", an overview first";
  return out + (display.scale_bar ? ", scale bar" : "");
}

class DisplayEffect final : public Effect {
 public:
  explicit DisplayEffect(FrameStep frame) : frame_(std::move(frame)) {}
  FrameStep& frame() noexcept { return frame_; }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::frame, "display", "frame", [](void* self, const Tick&) { static_cast<DisplayEffect*>(self)->run(); }, this);
    picture_ = step.now(slots::kPicture);
    error_ = step.now(slots::kPictureError);
    return {};
  }
  void report(Figures& out) const override {
    out.add("uploaded_texels", frame_.texels_sent());
    out.add("image", hash_text(frame_.image_hash()));
  }
  std::vector<NamedTimer> timers() const override {
    return {{"texels", &frame_.timers().texels, false}, {"upload", &frame_.timers().upload, true}};
  }

 private:
  void run() {
    **error_ =
        picture_->film ? frame_.film(*picture_->world_from_tool) : frame_.draw(*picture_->name, picture_->world_from_tool, picture_->cut);
  }

  FrameStep frame_;
  const Picture* picture_ = nullptr;
  Status* const* error_ = nullptr;
};

/// The effect without a sink: `check`, or a run without output.
class NoDisplay final : public Effect {
 public:
  Status bind(StepGraph&) override { return {}; }
};

// [bytes] of Mesa's software driver with its compiler: resident memory of a run that draws 64 x 48 pixels, less that of one that draws
// nothing.
constexpr std::uint64_t kDriverBytes = 91'000'000;
// [bytes] of the skin: its lattice, its mesh, and the triangles that Mesa's software driver sorts into tiles; 58 to 73 MB measured, of pictures
// of 64 x 48 and 1200 x 900 pixels with four rays each. A scan that is read again takes its own memory in addition, for a moment.
constexpr std::uint64_t kSkinBytes = 65'000'000;

/// @returns the memory of a bone at every factor-th voxel; 0 for the bone itself. Thin bone: the exponent measured on two heads with factors
/// of 2 to 6 is 2.38 to 2.47.
std::uint64_t coarse_bytes(const BoneShape& bone, int factor) {
  constexpr double kExponent = 2.4;
  return factor == 1 ? 0 : static_cast<std::uint64_t>(static_cast<double>(bone.in_memory) / std::pow(factor, kExponent));
}

class DisplayPlan final : public ConfigPlan<DisplayPlan, DisplayConfig> {
 public:
  DisplayPlan(TableReader& table, const StageConfig& scene) { config_ = read_display(table, scene); }

  PlanRow row(const PlanContext& context) const override {
    // A texel, and the same with the distances that rays skip, twice; or a mesh. The pixels: picture_bytes().
    const std::uint64_t a_texel = kTexelBytes + sizeof(Rgba8) + (config_.appearance.tissue ? sizeof(TissueTexel) : 0);
    // A voxel of the window, of which the largest part may change at once: texels and the densities that they are made from.
    constexpr std::uint64_t kChangeBytes = 9;
    const std::optional<HeadGrid> head = head_of(context.config);
    const Levels levels = levels_of(config_, context.bone, head);
    const std::uint64_t coarse = head ? 0 : coarse_bytes(context.bone, levels.factor);  // that of a head belongs to the volume
    // At the start the texels are in memory and in the textures.
    const bool mesh = config_.method == "mesh";
    const bool textured = draws_textures(config_);
    const std::uint64_t bone = mesh ? mesh_bytes(levels.voxels, textured) : levels.voxels * (a_texel + 2);
    const std::uint64_t images = textured ? texture_bytes(config_.textures) : 0;
    const std::uint64_t drawn = bone + images + coarse + kDriverBytes + (config_.skin ? kSkinBytes : 0);
    const std::string budget = config_.budget ? fmt::format(", quality for {:g} ms a picture", *config_.budget * 1e3) : std::string();
    return {.table = "display",
            .clock = Clock::frame,
            .step = mesh ? "changed boxes to the mesh, one picture" : "changed boxes to the texture, one picture",
            .needs = "changed boxes, tool pose",
            .gives = "pictures",
            .detail = fmt::format("{}{}{}, {} x {} pixels{}, at events", method_text(config_), levels_text(config_, context.bone, head),
                                  picture_text(config_), config_.width, config_.height, budget),
            .bytes = drawn + picture_bytes(config_) + context.window_voxels * kChangeBytes,
            .start_bytes = drawn + levels.voxels * (a_texel + (textured ? sizeof(TissueTexel) : 0))};
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    if (stage.outside().sink == nullptr) return std::unique_ptr<Effect>(std::make_unique<NoDisplay>());
    DisplayConfig display = config_;
    if (display.drape) display.drape->body = [](const Vec3& p) { return HeadShape::hull(p); };
    if (display.skin)
      if (Status found = find_skin(stage.config.volume, *display.skin); !found) return found.error();
    auto frame =
        FrameStep::create(display, stage.config.volume.world_from_bone, stage.approach, *stage.tool, *stage.voxmap, *stage.outside().sink);
    if (!frame) return frame.error();
    auto effect = std::make_unique<DisplayEffect>(std::move(frame).value());
    stage.offer_frame(effect->frame());
    return std::unique_ptr<Effect>(std::move(effect));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& scene, Issues&) {
  return std::make_unique<DisplayPlan>(table, scene);
}

}  // namespace

EffectEntry display_effect() {
  return {"display",
          "pictures; without it none is drawn",
          read,
          {"method = \"slices\"", "method = \"mesh\"", "method = \"mesh\"\ncolour = \"plain\"",
           "method = \"mesh\"\nexterior_texture = \"bone\"\ninterior_texture = \"apple\"",
           "method = \"mesh\"\nexterior_texture = \"cucumber\"\ntexture_axis = \"x\"\ncolour = \"texture\"",
           "method = \"mesh\"\nexterior_texture = \"bone\"\ntexture_axis = \"y\"\ncolour = \"voxel\"", "quality = \"auto\"",
           "cut = \"plane\"\ncut_point_mm = [0, 0, 0]\ncut_normal = [0, -1, 0]", "cut = \"tip\"", "stereo = \"side-by-side\"",
           "stereo = \"top-bottom\"", "stereo = \"anaglyph\"", "stereo = \"quad\"", "workbench_mm = 300", "tissue = \"plain\"",
           "normals = \"recomputed\"", "shading = \"translucent\"\n[[display.transfer]]\ndensity = 0\nopacity_per_mm = 0"}};
}

}  // namespace burrhole
