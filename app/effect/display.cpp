// [display]: pictures of the bone and the tool. Boxes of voxels that changed go to the textures, then a picture is drawn.

#include <fmt/format.h>

#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "app/view/display_config.h"
#include "core/base/units.h"
#include "core/config/rules.h"

namespace burrhole {
namespace {

/// Corners of [[display.transfer]]; without any, a bone that glows through where it is thin.
TransferFunction read_transfer(TableReader& table) {
  TransferFunction out;
  for (TableReader& row :
       table.tables("transfer", "corners of the line from density to what it does to light; by their default bone is hazy")) {
    TransferPoint point;
    point.density = row.number("density", {.fallback = std::nullopt, .min = 0.0, .max = 1.0}, "of bone, as left: 0 none, 1 whole");
    point.extinction = row.number("opacity_per_mm", {.fallback = std::nullopt, .min = 0.0, .max = 1000.0, .to_si = 1.0 / kMillimetre},
                                  "light falls by exp(-this) a millimetre");
    const auto tint = row.numbers("tint", std::vector<double>{1.0, 1.0, 1.0}, 3, {.min = 0.0, .max = 1.0},
                                  "red, green and blue, times the tissue's own colour");
    point.tint = Vec3(tint[0], tint[1], tint[2]);
    if (!out.empty() && point.density <= out.back().density) row.fault("density", "must be larger than the one before");
    row.finish();
    out.push_back(point);
  }
  if (out.empty()) out = {{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 0.25 / kMillimetre}};
  return out;
}

/// What a picture may cost, key by key or by a budget; `rays`: bone is drawn by rays, `finish`: by its surface.
void read_quality(TableReader& table, bool rays, bool finish, DisplayConfig& out) {
  const std::string choice = table.choice("quality", "fixed", {"fixed", "auto"},
                                          "by the keys of this table, or the best that this machine draws within budget_ms");
  if (choice == "auto") {
    if (!rays) table.fault("quality", "is for method = \"raycast\"");
    out.budget = table.number("budget_ms", above_zero(100.0, 1e-3, 1e5), "time of a picture that the quality is chosen for");
    for (const char* key : {"step_voxels", "bisections", "finish", "supersample", "resolution"})
      if (table.has(key)) table.fault(key, "is what quality = \"auto\" chooses: leave out one of the two");
    return;
  }
  DrawingQuality& quality = out.quality;
  if (rays)
    quality.step_voxels =
        table.number("step_voxels", {.fallback = 0.5, .min = 0.0, .max = 1.0, .min_open = true}, "distance of samples along a ray");
  if (finish) {
    quality.bisections =
        static_cast<int>(table.integer("bisections", quality.bisections, 0, 16, "halvings of the step in which a ray met bone"));
    quality.finish = table.boolean("finish", true, "smooth normals, and ambient occlusion if it is on; false: the light alone");
  }
  quality.supersample =
      static_cast<int>(table.integer("supersample", quality.supersample, 1, 4, "rays along each side of a pixel, which smooth edges"));
  quality.resolution =
      table.number("resolution", {.fallback = 1.0, .min = 0.25, .max = 1.0}, "share of width and height that is drawn, then enlarged");
}

/// Keys of light and tissue. What only an opaque surface drawn by rays can show is asked for there alone.
LookView read_looks(TableReader& table, bool surface, bool translucent) {
  LookView out;
  out.labels = table.boolean("label_colours", true, "colours by tissue and mineral density; false: all of one ivory");
  if (!translucent && table.choice("normals", "texture", {"texture", "recomputed"},
                                   "from the normals sent, or from differences of the density") == "recomputed")
    out.normals = NormalSource::recomputed;
  if (!surface) return out;
  out.tissue = table.choice("tissue", "procedural", {"procedural", "plain"},
                            "old surface unlike cut bone, pores in diploe, vessels on dura; or plain colours") == "procedural";
  out.occlusion = table.boolean("ambient_occlusion", true, "less light in hollows");
  out.shadow = table.boolean("shadow", false, "bone throws a shadow on bone");
  out.specular = table.boolean("specular", false, "the glint of a wet surface");
  return out;
}

Vec3 read_color(TableReader& table, const char* key, const Vec3& fallback, const char* about) {
  const auto rgb = table.numbers(key, std::vector<double>{fallback.x, fallback.y, fallback.z}, 3, {.min = 0.0, .max = 1.0}, about);
  return {rgb[0], rgb[1], rgb[2]};
}

CutConfig read_cut(TableReader& table) {
  CutConfig out;
  const std::string kind = table.choice("cut", "none", {"none", "plane", "tip"},
                                        "cuts pictures open: at a plane, or at the depth of the tool's tip, square to the view");
  if (kind == "none") return out;
  out.kind = kind == "tip" ? CutKind::tip : CutKind::plane;
  if (out.kind == CutKind::tip) return out;
  const NumberRule millimetres{.fallback = std::nullopt, .min = -5000.0, .max = 5000.0, .to_si = kMillimetre};
  const auto point = table.numbers("cut_point_mm", std::nullopt, 3, millimetres, "a point of the plane, in the bone's frame");
  const auto normal = table.numbers("cut_normal", std::nullopt, 3, {.fallback = std::nullopt, .min = -1e6, .max = 1e6},
                                    "towards the side that is cut away, in the bone's frame; of any length but 0");
  out.point = {point[0], point[1], point[2]};
  out.normal = {normal[0], normal[1], normal[2]};
  if (glm::length(out.normal) == 0.0) table.fault("cut_normal", "must not be zero");
  return out;
}

StereoView read_stereo(TableReader& table, double distance) {
  StereoView out;
  const std::string mode =
      table.choice("stereo", "off", {"off", "side-by-side", "top-bottom", "anaglyph"},
                   "two eyes in one picture, each of `size`; an anaglyph is for red and cyan glasses", {"quad-buffered"});
  if (mode == "off") return out;
  out.mode = mode == "anaglyph" ? StereoMode::anaglyph : mode == "top-bottom" ? StereoMode::top_bottom : StereoMode::side_by_side;
  out.separation = table
                       .optional_number("eye_separation_mm", above_zero(0.0, kMillimetre, 200.0),
                                        "between the eyes; a thirtieth of distance_mm unless said")
                       .value_or(distance / 30.0);
  out.screen = table
                   .optional_number("screen_mm", above_zero(0.0, kMillimetre, 5000.0),
                                    "from the eyes to the plane that seems to lie in the screen; distance_mm unless said")
                   .value_or(distance);
  return out;
}

DisplayConfig read_display(TableReader& table) {
  DisplayConfig out;
  out.method = table.choice("method", "raycast", {"raycast", "slices"},
                            "how bone is drawn: by rays to its surface, or by slices blended back to front", {"mesh"});
  if (out.method == "raycast") {
    const std::string shading = table.choice("shading", "surface", {"surface", "translucent"},
                                             "bone as an opaque surface, or as a body that light passes, by a transfer function");
    if (shading == "translucent") out.transfer = read_transfer(table);
  }
  if (out.method == "slices") {
    out.slices_per_voxel = table.number("slices_per_voxel", {.fallback = out.slices_per_voxel, .min = 0.0, .max = 8.0, .min_open = true},
                                        "slices for each voxel along the view's axis");
    out.opacity_correction =
        table.boolean("opacity_correction", out.opacity_correction,
                      "opacity is per voxel edge, whatever the distance between slices; false: per slice, as in the paper");
  }
  read_quality(table, out.method == "raycast", out.method == "raycast" && out.transfer.empty(), out);
  out.looks = read_looks(table, out.method == "raycast" && out.transfer.empty(), !out.transfer.empty());
  out.background.top = read_color(table, "background_top", out.background.top, "red, green and blue behind the upper edge");
  out.background.bottom = read_color(table, "background_bottom", out.background.bottom, "and behind the lower edge");
  const auto size = table.numbers("size", std::vector<double>{static_cast<double>(out.width), static_cast<double>(out.height)}, 2,
                                  {.min = 16, .max = 8192}, "width and height of a picture in pixels");
  out.width = static_cast<int>(size[0]);
  out.height = static_cast<int>(size[1]);
  out.upload_budget =
      static_cast<std::size_t>(table.integer("upload_budget_kb", static_cast<std::int64_t>(out.upload_budget / 1024), 1, 4'000'000,
                                             "changed texels sent for one picture; the rest follows with the next ones")) *
      1024;
  out.upload_time = table.number("upload_budget_ms", {.fallback = out.upload_time * 1e3, .min = 0.0, .max = 1000.0, .to_si = 1e-3},
                                 "time for making them, by the clock, so pictures may differ from run to run; 0: as long as it takes");
  out.azimuth = table.number("azimuth_deg", {.fallback = out.azimuth / kDegree, .min = -360, .max = 360, .to_si = kDegree},
                             "angle of the camera round the axis, from the patient's -y");
  out.elevation = table.number("elevation_deg", {.fallback = out.elevation / kDegree, .min = -89, .max = 89, .to_si = kDegree},
                               "angle of the camera above the entry's tangent plane");
  out.distance =
      table.number("distance_mm", above_zero(out.distance / kMillimetre, kMillimetre, 5000.0), "distance of the camera from the entry");
  out.scale_bar =
      table.boolean("scale_bar", out.scale_bar, "a bar of a length that fits, to scale at the distance of the camera's target");
  out.cut = read_cut(table);
  out.stereo = read_stereo(table, out.distance);
  return out;
}

/// What is in the shader beyond the light of the paper.
std::string looks_text(const LookView& looks) {
  std::string out;
  const auto add = [&out](bool on, const char* name) {
    if (on) out += std::string(", ") + name;
  };
  add(looks.tissue, "tissue");
  add(looks.occlusion, "ambient occlusion");
  add(looks.shadow, "shadow");
  add(looks.specular, "specular");
  add(!looks.labels, "one colour");
  add(looks.normals == NormalSource::recomputed, "normals recomputed");
  return out;
}

std::string method_text(const DisplayConfig& display) {
  const std::string looks = looks_text(display.looks);
  if (!display.transfer.empty()) return fmt::format("{}, translucent{}", display.method, looks);
  if (display.method != "slices") return display.method + looks;
  return fmt::format("slices, {:g} a voxel{}{}", display.slices_per_voxel, display.opacity_correction ? "" : ", opacity a slice", looks);
}

/// What a picture shows beside the bone, and how often it is drawn.
std::string picture_text(const DisplayConfig& display) {
  std::string out;
  if (display.cut.kind != CutKind::none) out += display.cut.kind == CutKind::tip ? ", cut at the tip" : ", cut at a plane";
  if (display.stereo.mode != StereoMode::off)
    out += fmt::format(", {} of two eyes {:.3g} mm apart",
                       display.stereo.mode == StereoMode::anaglyph     ? "anaglyph"
                       : display.stereo.mode == StereoMode::top_bottom ? "top-bottom"
                                                                       : "side-by-side",
                       display.stereo.separation / kMillimetre);
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
    out.add("image", fmt::format("{:016x}", frame_.image_hash()));
  }
  std::vector<NamedTimer> timers() const override {
    return {{"texels", &frame_.timers().texels, false}, {"upload", &frame_.timers().upload, true}};
  }

 private:
  void run() { **error_ = frame_.draw(*picture_->name, picture_->world_from_tool, picture_->cut); }

  FrameStep frame_;
  const Picture* picture_ = nullptr;
  Status* const* error_ = nullptr;
};

/// Where nothing draws: `check`, or a run that writes nothing.
class NoDisplay final : public Effect {
 public:
  Status bind(StepGraph&) override { return {}; }
};

class DisplayPlan final : public ConfigPlan<DisplayPlan, DisplayConfig> {
 public:
  explicit DisplayPlan(TableReader& table) { config_ = read_display(table); }

  PlanRow row(const PlanContext& context) const override {
    const std::uint64_t a_voxel = kTexelBytes + sizeof(Rgba8) + (config_.looks.tissue ? sizeof(TissueTexel) : 0);
    const std::string budget = config_.budget ? fmt::format(", quality for {:g} ms a picture", *config_.budget * 1e3) : std::string();
    return {.table = "display",
            .clock = Clock::frame,
            .step = "changed boxes to the texture, one picture",
            .needs = "changed boxes, tool pose",
            .gives = "pictures",
            .detail = fmt::format("{}{}, {} x {} pixels{}, at events", method_text(config_), picture_text(config_), config_.width,
                                  config_.height, budget),
            .bytes = context.bone.bounds().count() * a_voxel};
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    if (stage.outside().sink == nullptr) return std::unique_ptr<Effect>(std::make_unique<NoDisplay>());
    auto frame =
        FrameStep::create(config_, stage.config.volume.world_from_bone, stage.approach, *stage.tool, *stage.voxmap, *stage.outside().sink);
    if (!frame) return frame.error();
    auto effect = std::make_unique<DisplayEffect>(std::move(frame).value());
    stage.offer_frame(effect->frame());
    return std::unique_ptr<Effect>(std::move(effect));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<DisplayPlan>(table); }

}  // namespace

EffectEntry display_effect() {
  return {"display",
          "pictures; without it none is drawn",
          read,
          {"method = \"slices\"", "quality = \"auto\"", "cut = \"plane\"\ncut_point_mm = [0, 0, 0]\ncut_normal = [0, -1, 0]",
           "cut = \"tip\"", "stereo = \"side-by-side\"", "stereo = \"top-bottom\"", "stereo = \"anaglyph\"", "tissue = \"plain\"",
           "normals = \"recomputed\"", "shading = \"translucent\"\n[[display.transfer]]\ndensity = 0\nopacity_per_mm = 0"}};
}

}  // namespace burrhole
