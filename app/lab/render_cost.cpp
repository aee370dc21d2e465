#include "app/lab/render_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <tuple>

#include "app/lab/image_metrics.h"
#include "app/lab/render_stand.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "app/view/display_config.h"
#include "app/view/quality.h"
#include "app/view/texels.h"

namespace burrhole {
namespace {

const DrawingQuality kPlain{.finish = false};  // one ray per pixel
constexpr double kFine = 0.125;                // [voxel]
constexpr int kFineBisections = 12;            // 1/32768 of a voxel
constexpr double kNone = Drawn::kNone;

DrawingQuality fine(DrawingQuality quality) {
  quality.step_voxels = kFine;
  quality.bisections = kFineBisections;
  return quality;
}

// ---- subjects ----

/// Texels rounded to a texture of this many bits; 0: not rounded.
struct TexelBits {
  int normal = 0, density = 0;
};

float rounded(float value, int bits) {
  if (bits == 0) return value;
  const double top = std::ldexp(1.0, bits) - 1.0;
  return static_cast<float>(std::round(value * top) / top);
}

struct Subject {
  std::string name;
  VolumeView volume;      // 8-bit texels
  PreciseTexels precise;  // the same in floats
  FrameView view;
  TransferFunction transfer;
  std::string text;  // of scene and tool

  [[nodiscard]] VolumeView in_floats(const TexelBits& bits) const {
    VolumeView out = volume;
    out.precise = precise;
    for (float& seen : out.precise.field) seen = rounded(seen, bits.density);
    for (glm::vec4& texel : out.precise.normal_opacity)
      texel = {rounded(texel.x, bits.normal), rounded(texel.y, bits.normal), rounded(texel.z, bits.normal), rounded(texel.w, bits.density)};
    return out;
  }
};

Subject make_subject(const std::string& name, const LoadedScene& loaded, Voxmap& voxmap, const Approach& approach) {
  const Pose& world_from_bone = loaded.scene.volume.world_from_bone;
  Subject out{name, make_volume_view(voxmap, true), make_precise_texels(voxmap), {}, {}, loaded.scene.text + loaded.tool_text};
  out.view = make_frame_view(*loaded.scene.find<DisplayConfig>(), world_from_bone, world_from_bone * approach.bone_from_approach,
                             approach.thickness, false);
  // As a scene with shading = "translucent" and the default transfer function.
  out.transfer = {{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 250.0}};
  return out;
}

/// The shipped scene; drilled: through the bone, with a sharper tool, so that it takes seconds.
Result<Subject> load_subject(const RenderCostOptions& options, bool drilled) {
  auto document = TomlDocument::load(options.share_folder + "/scenes/parietal.toml");
  if (!document) return document.error();
  if (drilled)
    if (Status set = document->set("tool.erosion_scale=10"); !set) return set.error();
  Issues issues;
  const auto loaded = load_scene(*document, {.tool_folders = {options.share_folder + "/tools"}}, issues);
  if (!loaded) return issues.front();
  if (!drilled) {
    const auto approach = make_approach(*loaded->bone, loaded->scene.approach);
    if (!approach) return approach.error();
    auto voxmap = Voxmap::create(loaded->bone, {});
    if (!voxmap) return voxmap.error();
    return make_subject("skull patch", *loaded, *voxmap, *approach);
  }
  std::atomic<bool> stop{false};
  SimulationOptions run;
  run.stop = &stop;
  run.progress = [&](double, const DrillProgress& progress) { stop = progress.breakthrough_time.has_value(); };
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, run, issues);
  if (!simulation) return issues.front();
  if (Status ran = simulation->run(); !ran) return ran.error();
  if (!simulation->progress().breakthrough_time) return Error{ErrorCode::internal, "the shipped scene was not drilled through", {}};
  return make_subject("drilled hole", *loaded, simulation->voxmap(), simulation->approach());
}

// ---- rows ----

/// The option that a row is about.
struct Knob {
  std::string model, name;
  double setting = 0.0;
};

using References = std::vector<std::pair<std::string, const Image*>>;

/// PSNR [dB], SSIM and FLIP against one reference.
struct Metrics {
  double psnr = kNone, ssim = kNone, flip = kNone;
};

/// The result of a setting: what is kept of a picture.
struct Scored {
  double median_us = kNone, p99_us = kNone, over_shipped = kNone;  // NaN if it was not timed
  std::vector<Metrics> against;                                    // in the order of the references
};
constexpr std::size_t kTimes = 3, kMetrics = 3;

Study::Figures figures_of(const Drawn& drawn, const References& references) {
  Study::Figures out{drawn.median_us, drawn.p99_us, drawn.over_shipped};
  for (const auto& [name, image] : references)
    out.insert(out.end(), {psnr(drawn.image, *image), ssim(drawn.image, *image), flip(drawn.image, *image)});
  return out;
}

Scored scored_of(const Study::Figures& f) {
  Scored out{f[0], f[1], f[2], {}};
  for (std::size_t n = kTimes; n < f.size(); n += kMetrics) out.against.push_back({f[n], f[n + 1], f[n + 2]});
  return out;
}

class Table {
 public:
  explicit Table(std::string subject) : subject_(std::move(subject)) {}

  /// Three metrics against each reference, and the time relative to the shipped options.
  void add(const Knob& knob, const Scored& scored, double bytes, const References& references) {
    CostRow row{.subject = subject_,
                .model = knob.model,
                .knob = knob.name,
                .setting = knob.setting,
                .error_name = {},
                .unit = {},
                .reference = {}};
    const bool timed = !std::isnan(scored.median_us);
    if (timed) {
      row.median_us = scored.median_us;
      row.p99_us = scored.p99_us;
      row.bytes = bytes;
    }
    const auto put = [&](const char* name, double error, const char* unit, const std::string& reference) {
      row.error_name = name;
      row.error = error;
      row.unit = unit;
      row.reference = reference;
      rows_.push_back(row);
    };
    for (std::size_t n = 0; n < references.size(); ++n) {
      put("psnr", scored.against[n].psnr, "dB", references[n].first);
      put("ssim", scored.against[n].ssim, "-", references[n].first);
      put("flip", scored.against[n].flip, "-", references[n].first);
    }
    if (timed) put("time_over_shipped", scored.over_shipped, "-", "shipped knobs, same run");
  }
  [[nodiscard]] const std::vector<CostRow>& rows() const { return rows_; }

 private:
  std::string subject_;
  std::vector<CostRow> rows_;
};

const std::string kSameRays = "same rays, 1/8 voxel, float texels";
const std::string kBest = "4 x 4 rays, finish, 1/8 voxel, float texels";

/// Everything that is measured on one subject.
class SubjectRun {
 public:
  SubjectRun(const RenderCostOptions& options, Subject subject, Study& study, RenderCost& out)
      : options_(options), subject_(std::move(subject)), study_(study), table_(subject_.name), out_(out) {}

  Status run() {
    for (const auto part :
         {&SubjectRun::references, &SubjectRun::sampling, &SubjectRun::texels, &SubjectRun::slices, &SubjectRun::translucent})
      if (Status done = (this->*part)(); !done) return done;
    if (options_.pareto)
      if (Status done = combinations(); !done) return done;
    out_.rows.insert(out_.rows.end(), table_.rows().begin(), table_.rows().end());
    return {};
  }

 private:
  [[nodiscard]] Result<Stand> stand(RenderOptions how, const VolumeView& volume) const {
    return Stand::create(options_.gl, std::move(how), volume, {subject_.view, options_.width, options_.height});
  }
  void keep_picture(const std::string& name, const std::string& caption, const Image& image) {
    const std::string prefix = subject_.name == "skull patch" ? "patch_" : "hole_";
    out_.pictures.push_back({prefix + name, subject_.name + ": " + caption, image});
  }

  Status references() {
    auto shipped = stand({}, subject_.volume);
    if (!shipped) return shipped.error();
    shipped_ = std::make_unique<Stand>(std::move(shipped).value());
    out_.driver = shipped_->driver();
    auto floats = stand({}, subject_.in_floats({}));
    if (!floats) return floats.error();
    auto plain = floats->draw(fine(kPlain)), best = floats->draw(fine({.supersample = 4}));
    if (!plain) return plain.error();
    if (!best) return best.error();
    plain_ = std::move(plain).value();
    best_ = std::move(best).value();
    keep_picture("best", "the reference \"best\"", best_);
    const auto drawn = shipped_->draw(kShippedQuality);
    if (!drawn) return drawn.error();
    keep_picture("shipped", "as shipped", *drawn);
    return {};
  }

  /// Draws a setting with `with`, unless an earlier call did. @param times of a setting are measured if `frames` > 0.
  Result<Scored> score(const Knob& knob, Stand& with, const DrawingQuality& quality, int frames, const References& references) {
    StudyTrial trial{.key = {},
                     .name = fmt::format("{}, {}, {} {:g}", subject_.name, knob.model, knob.name, knob.setting),
                     .figures = kTimes + kMetrics * references.size()};
    trial.key.add("render").add(trial.name).add(subject_.text).add(out_.driver).add(options_.width).add(options_.height).add(frames);
    trial.key.add(quality.step_voxels).add(quality.bisections).add(quality.finish ? 1.0 : 0.0).add(quality.supersample);
    trial.key.add(quality.resolution);
    const auto figures = study_.run(trial, [&]() -> Result<Study::Figures> {
      const auto drawn = frames > 0 ? draw_timed(with, quality, *shipped_, frames) : draw_once(with, quality);
      if (!drawn) return drawn.error();
      return figures_of(*drawn, references);
    });
    if (!figures) return figures.error();
    return scored_of(*figures);
  }

  Status add_rays(const std::string& knob, double setting, const DrawingQuality& quality, const std::string& model) {
    References references{{kBest, &best_}};
    if (fine(quality) == fine(kPlain)) references.insert(references.begin(), {kSameRays, &plain_});
    const Knob about{model, knob, setting};
    const auto scored = score(about, *shipped_, quality, options_.frames, references);
    if (!scored) return scored.error();
    table_.add(about, *scored, shipped_->bytes(), references);
    return {};
  }

  /// Step, bisections, finish, rays per pixel and resolution, each alone.
  Status sampling() {
    for (const double step : {1.0, 0.5, 0.25, 0.125}) {
      DrawingQuality quality = kPlain;
      quality.step_voxels = step;
      quality.bisections = 4;
      if (Status done = add_rays("step [voxel]", step, quality, "rays, 4 bisections, no finish"); !done) return done;
    }
    for (const int bisections : {0, 1, 2, 4, 6, 8}) {
      DrawingQuality quality = kPlain;
      quality.step_voxels = 1.0;
      quality.bisections = bisections;
      if (Status done = add_rays("bisections", bisections, quality, "rays, step 1 voxel, no finish"); !done) return done;
    }
    for (const int side : {1, 2, 3, 4})
      for (const bool finish : {false, true})
        if (Status done = add_rays("rays along a pixel's side", side, {.finish = finish, .supersample = side},
                                   finish ? "rays, finish" : "rays, no finish");
            !done)
          return done;
    for (const double resolution : {0.25, 0.5, 0.75})
      if (Status done = add_rays("resolution", resolution, {.resolution = resolution}, "rays, finish"); !done) return done;
    return {};
  }

  /// Bits of a texture, emulated in floats (without times), and sources of normals.
  Status texels() {
    const auto against_plain = [&](Stand& with, const Knob& knob, const DrawingQuality& quality, bool timed) -> Status {
      const References references{{kSameRays, &plain_}};
      const auto scored = score(knob, with, quality, timed ? options_.frames : 0, references);
      if (!scored) return scored.error();
      table_.add(knob, *scored, with.bytes(), references);
      return {};
    };
    for (const auto& [bits, model] :
         {std::pair{TexelBits{8, 8}, "normals of 8 bits"}, std::pair{TexelBits{8, 16}, "normals of 8 bits"},
          std::pair{TexelBits{16, 8}, "normals of 16 bits"}, std::pair{TexelBits{16, 16}, "normals of 16 bits"}}) {
      auto with = stand({}, subject_.in_floats(bits));
      if (!with) return with.error();
      const Knob knob{std::string("rays, 1/8 voxel, ") + model, "density [bits]", static_cast<double>(bits.density)};
      if (Status done = against_plain(*with, knob, fine(kPlain), false); !done) return done;
    }
    if (Status done = against_plain(*shipped_, {"rays, 1/8 voxel, as shipped", "density [bits]", 16.0}, fine(kPlain), true); !done)
      return done;
    auto differences = stand({.appearance = {.normals = NormalSource::recomputed}}, subject_.volume);
    if (!differences) return differences.error();
    if (Status done = against_plain(*shipped_, {"rays, no finish, stored normals", "step [voxel]", kPlain.step_voxels}, kPlain, true);
        !done)
      return done;
    return against_plain(*differences, {"rays, no finish, normals by differences", "step [voxel]", kPlain.step_voxels}, kPlain, true);
  }

  static Result<Drawn> draw_once(Stand& with, const DrawingQuality& quality) {
    auto image = with.draw(quality);
    if (!image) return image.error();
    return Drawn{std::move(image).value()};
  }

  /// @param best metrics against the picture of the highest quality.
  void add_point(const std::string& method, const DrawingQuality& quality, double per_voxel, const Scored& scored, const Metrics& best) {
    out_.points.push_back(
        {subject_.name, method, quality, per_voxel, scored.median_us, scored.over_shipped, best.psnr, best.ssim, best.flip});
  }

  Status keep_drawn(const std::string& name, const std::string& caption, Stand& with, const DrawingQuality& quality) {
    const auto image = with.draw(quality);
    if (!image) return image.error();
    keep_picture(name, caption, *image);
    return {};
  }

  Status slices() {
    for (const double per_voxel : {0.5, 1.0, 2.0}) {
      auto with = stand({.slices = SliceOptions{.per_voxel = per_voxel}}, subject_.volume);
      if (!with) return with.error();
      const Knob knob{"slices", "slices a voxel", per_voxel};
      const References references{{kSameRays, &plain_}, {kBest, &best_}};
      const auto scored = score(knob, *with, kPlain, std::max(1, options_.frames / 3), references);
      if (!scored) return scored.error();
      table_.add(knob, *scored, with->bytes(), references);
      add_point("slices", kPlain, per_voxel, *scored, scored->against.back());
      if (per_voxel != 1.0) continue;
      if (Status kept = keep_drawn("slices", "the paper's way, one slice a voxel", *with, kPlain); !kept) return kept;
    }
    return {};
  }

  Status translucent() {
    auto floats = stand({.finish = false, .translucent = subject_.transfer}, subject_.in_floats({}));
    if (!floats) return floats.error();
    const auto plain = floats->draw(fine(kPlain));
    if (!plain) return plain.error();
    auto with = stand({.finish = false, .translucent = subject_.transfer}, subject_.volume);
    if (!with) return with.error();
    for (const double step : {1.0, 0.5, 0.25}) {
      DrawingQuality quality = kPlain;
      quality.step_voxels = step;
      const Knob knob{"translucent", "step [voxel]", step};
      const References references{{kSameRays, &*plain}};
      const auto scored = score(knob, *with, quality, options_.frames, references);
      if (!scored) return scored.error();
      table_.add(knob, *scored, with->bytes(), references);
      if (step != 0.5) continue;
      if (Status kept = keep_drawn("translucent", "translucent, half a voxel a step", *with, quality); !kept) return kept;
    }
    if (!options_.pareto) return {};
    const auto best = floats->draw(fine({.finish = false, .supersample = 4}));
    if (!best) return best.error();
    for (const DrawingQuality& size : sizes())
      for (const double step : {1.0, 0.5, 0.25}) {
        DrawingQuality quality = size;
        quality.finish = false;
        quality.step_voxels = step;
        const auto scored = score(combination("translucent", quality), *with, quality, options_.frames, {{kBest, &*best}});
        if (!scored) return scored.error();
        add_point("translucent", quality, 0.0, *scored, scored->against.front());
      }
    return {};
  }

  static Knob combination(const std::string& method, const DrawingQuality& quality) {
    return {"combinations, " + method, "rays a pixel", quality.supersample * quality.resolution};
  }

  /// Rays per pixel and resolution, fewest rays first.
  static std::vector<DrawingQuality> sizes() {
    std::vector<DrawingQuality> out;
    for (const auto& [resolution, side] : {std::pair{0.25, 1}, std::pair{0.5, 1}, std::pair{0.75, 1}, std::pair{1.0, 1}, std::pair{0.75, 2},
                                           std::pair{1.0, 2}, std::pair{1.0, 3}})
      out.push_back({.supersample = side, .resolution = resolution});
    return out;
  }

  Status combinations() {
    for (const DrawingQuality& size : sizes()) {
      for (const bool finish : {false, true})
        for (const auto& [step, bisections] : {std::pair{1.0, 0}, std::pair{1.0, 4}, std::pair{0.5, 5}, std::pair{0.25, 8}}) {
          const DrawingQuality quality{step, bisections, finish, size.supersample, size.resolution};
          const auto scored = score(combination("rays", quality), *shipped_, quality, options_.frames, {{kBest, &best_}});
          if (!scored) return scored.error();
          add_point("rays", quality, 0.0, *scored, scored->against.front());
        }
    }
    return {};
  }

  const RenderCostOptions& options_;
  Subject subject_;
  Study& study_;
  Table table_;
  RenderCost& out_;
  std::unique_ptr<Stand> shipped_;
  Image plain_, best_;
};

void add_point_rows(RenderCost& out) {
  for (const DrawnPoint& point : out.points) {
    if (point.method == "slices") continue;  // has its own rows
    const double side = point.quality.supersample * point.quality.resolution;
    CostRow row{.subject = point.subject,
                .model = point.method + ", " + quality_text(point.quality, point.method == "translucent"),
                .knob = "rays a pixel",
                .setting = side * side,
                .error_name = {},
                .unit = {},
                .reference = point.method == "rays" ? kBest : "4 x 4 rays, 1/8 voxel, float texels",
                .median_us = point.median_us};
    for (const auto& [name, value, unit] :
         {std::tuple{"psnr", point.psnr, "dB"}, std::tuple{"ssim", point.ssim, "-"}, std::tuple{"flip", point.flip, "-"},
          std::tuple{"time_over_shipped", point.over_shipped, "-"}}) {
      row.error_name = name;
      row.error = value;
      row.unit = unit;
      out.rows.push_back(row);
    }
  }
}

}  // namespace

std::size_t count_of_trials(const RenderCostOptions& options) noexcept {
  constexpr std::size_t kAlone = 21 + 7 + 3 + 3;        // of a subject: sampling, texels, slices, translucent
  constexpr std::size_t kCombined = 7 * 2 * 4 + 7 * 3;  // rays, translucent
  return (options.drilled ? 2 : 1) * (kAlone + (options.pareto ? kCombined : 0));
}

Result<RenderCost> measure_render_cost(const RenderCostOptions& options) {
  Study own({}, count_of_trials(options));
  Study& study = options.study != nullptr ? *options.study : own;
  RenderCost out;
  std::vector<bool> kinds{false};
  if (options.drilled) kinds.push_back(true);
  for (const bool drilled : kinds) {
    auto subject = load_subject(options, drilled);
    if (!subject) return subject.error();
    if (Status ran = SubjectRun(options, std::move(subject).value(), study, out).run(); !ran) return ran.error();
  }
  BH_ASSERT(study.done() == count_of_trials(options));
  add_point_rows(out);
  return out;
}

}  // namespace burrhole
