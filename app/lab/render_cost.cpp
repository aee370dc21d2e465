#include "app/lab/render_cost.h"

#include <time.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <tuple>

#include "app/lab/image_metrics.h"
#include "app/lab/pareto.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "app/view/display_config.h"
#include "app/view/quality.h"
#include "app/view/texels.h"

namespace burrhole {
namespace {

const DrawingQuality kShipped{.supersample = 2};  // the default of scenes
const DrawingQuality kPlain{.finish = false};     // one ray per pixel
constexpr double kFine = 0.125;                   // [voxel]
constexpr int kFineBisections = 12;               // 1/32768 of a voxel

DrawingQuality fine(DrawingQuality quality) {
  quality.step_voxels = kFine;
  quality.bisections = kFineBisections;
  return quality;
}

double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
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
  Subject out{name, make_volume_view(voxmap, true), make_precise_texels(voxmap), {}, {}};
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

// ---- renderers ----

/// A renderer with a volume; an error is kept until it is read.
class Stand {
 public:
  static Result<Stand> create(const RenderCostOptions& options, RenderOptions how, const VolumeView& volume, const FrameView& view) {
    how.gl = options.gl;
    how.keep_picture = false;  // each picture is timed completely
    how.appearance.tissue = how.appearance.occlusion = !how.slices && !how.translucent;
    auto renderer = Renderer::create(how);
    if (!renderer) return renderer.error();
    if (Status set = renderer->set_volume(volume); !set) return set.error();
    return Stand(std::move(renderer).value(), view, options.width, options.height);
  }
  Result<Image> draw(const DrawingQuality& quality) {
    if (Status set = renderer_.set_quality(quality); !set) return set.error();
    return renderer_.draw(view_, width_, height_);
  }
  [[nodiscard]] double bytes() const {
    return static_cast<double>(renderer_.counters().volume_bytes + renderer_.counters().skip_map_bytes);
  }
  [[nodiscard]] std::string driver() const { return renderer_.driver(); }

 private:
  Stand(Renderer renderer, const FrameView& view, int width, int height)
      : renderer_(std::move(renderer)), view_(view), width_(width), height_(height) {}
  Renderer renderer_;
  FrameView view_;
  int width_, height_;
};

struct Drawn {
  Image image;
  double median_us = 0.0, p99_us = 0.0, over_shipped = 0.0;
};

/// Draws one picture untimed, then times pictures interleaved with the shipped options, of which a third suffices.
Result<Drawn> draw_timed(Stand& stand, const DrawingQuality& quality, Stand& shipped, int frames) {
  const auto timed = [](Stand& which, const DrawingQuality& how, std::vector<double>& times) -> Result<Image> {
    const double start = cpu_us();
    auto image = which.draw(how);
    times.push_back(cpu_us() - start);
    return image;
  };
  Drawn out;
  std::vector<double> times, baseline;
  for (const auto& [which, how] : {std::pair{&stand, &quality}, std::pair{&shipped, &kShipped}})
    if (const auto image = which->draw(*how); !image) return image.error();
  for (int n = 0; n < frames; ++n) {
    if (n % 3 == 0)
      if (const auto image = timed(shipped, kShipped, baseline); !image) return image.error();
    auto image = timed(stand, quality, times);
    if (!image) return image.error();
    out.image = std::move(image).value();
  }
  out.median_us = at_share(times, 0.5);
  out.p99_us = at_share(times, 0.99);
  out.over_shipped = out.median_us / at_share(baseline, 0.5);
  return out;
}

// ---- rows ----

/// The option that a row is about.
struct Knob {
  std::string model, name;
  double setting = 0.0;
};

class Table {
 public:
  explicit Table(std::string subject) : subject_(std::move(subject)) {}

  /// Three metrics against each reference, and the time relative to the shipped options.
  void add(const Knob& knob, const Drawn& drawn, double bytes, const std::vector<std::pair<std::string, const Image*>>& references,
           bool timed = true) {
    CostRow row{.subject = subject_,
                .model = knob.model,
                .knob = knob.name,
                .setting = knob.setting,
                .error_name = {},
                .unit = {},
                .reference = {}};
    if (timed) {
      row.median_us = drawn.median_us;
      row.p99_us = drawn.p99_us;
      row.bytes = bytes;
    }
    const auto put = [&](const char* name, double error, const char* unit, const std::string& reference) {
      row.error_name = name;
      row.error = error;
      row.unit = unit;
      row.reference = reference;
      rows_.push_back(row);
    };
    for (const auto& [name, image] : references) {
      put("psnr", psnr(drawn.image, *image), "dB", name);
      put("ssim", ssim(drawn.image, *image), "-", name);
      put("flip", flip(drawn.image, *image), "-", name);
    }
    if (timed) put("time_over_shipped", drawn.over_shipped, "-", "shipped knobs, same run");
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
  SubjectRun(const RenderCostOptions& options, Subject subject, std::function<void(const std::string&)> step, RenderCost& out)
      : options_(options), subject_(std::move(subject)), step_(std::move(step)), table_(subject_.name), out_(out) {}

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
    return Stand::create(options_, std::move(how), volume, subject_.view);
  }
  void keep_picture(const std::string& name, const std::string& caption, const Image& image) {
    const std::string prefix = subject_.name == "skull patch" ? "patch_" : "hole_";
    out_.pictures.push_back({prefix + name, subject_.name + ": " + caption, image});
  }

  Status references() {
    step_("references");
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
    const auto drawn = shipped_->draw(kShipped);
    if (!drawn) return drawn.error();
    keep_picture("shipped", "as shipped", *drawn);
    return {};
  }

  Status add_rays(const std::string& knob, double setting, const DrawingQuality& quality, const std::string& model) {
    const auto drawn = draw_timed(*shipped_, quality, *shipped_, options_.frames);
    if (!drawn) return drawn.error();
    std::vector<std::pair<std::string, const Image*>> references{{kBest, &best_}};
    if (fine(quality) == fine(kPlain)) references.insert(references.begin(), {kSameRays, &plain_});
    table_.add({model, knob, setting}, *drawn, shipped_->bytes(), references);
    return {};
  }

  /// Step, bisections, finish, rays per pixel and resolution, each alone.
  Status sampling() {
    step_("step and bisections");
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
    step_("finish, rays a pixel, resolution");
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
    step_("texels and normals");
    const auto against_plain = [&](Stand& with, const Knob& knob, const DrawingQuality& quality, bool timed) -> Status {
      const auto drawn = timed ? draw_timed(with, quality, *shipped_, options_.frames) : draw_once(with, quality);
      if (!drawn) return drawn.error();
      table_.add(knob, *drawn, with.bytes(), {{kSameRays, &plain_}}, timed);
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

  Result<Drawn> draw_once(Stand& with, const DrawingQuality& quality) {
    auto image = with.draw(quality);
    if (!image) return image.error();
    return Drawn{std::move(image).value()};
  }

  void add_point(const std::string& method, const DrawingQuality& quality, double per_voxel, const Drawn& drawn, const Image& best) {
    out_.points.push_back({subject_.name, method, quality, per_voxel, drawn.median_us, drawn.over_shipped, psnr(drawn.image, best),
                           ssim(drawn.image, best), flip(drawn.image, best)});
  }

  Status slices() {
    step_("slices");
    for (const double per_voxel : {0.5, 1.0, 2.0}) {
      auto with = stand({.slices = SliceOptions{.per_voxel = per_voxel}}, subject_.volume);
      if (!with) return with.error();
      const auto drawn = draw_timed(*with, kPlain, *shipped_, std::max(1, options_.frames / 3));
      if (!drawn) return drawn.error();
      table_.add({"slices", "slices a voxel", per_voxel}, *drawn, with->bytes(), {{kSameRays, &plain_}, {kBest, &best_}});
      add_point("slices", kPlain, per_voxel, *drawn, best_);
      if (per_voxel == 1.0) keep_picture("slices", "the paper's way, one slice a voxel", drawn->image);
    }
    return {};
  }

  Status translucent() {
    step_("translucent bone");
    auto floats = stand({.finish = false, .translucent = subject_.transfer}, subject_.in_floats({}));
    if (!floats) return floats.error();
    const auto plain = floats->draw(fine(kPlain));
    if (!plain) return plain.error();
    auto with = stand({.finish = false, .translucent = subject_.transfer}, subject_.volume);
    if (!with) return with.error();
    for (const double step : {1.0, 0.5, 0.25}) {
      DrawingQuality quality = kPlain;
      quality.step_voxels = step;
      const auto drawn = draw_timed(*with, quality, *shipped_, options_.frames);
      if (!drawn) return drawn.error();
      table_.add({"translucent", "step [voxel]", step}, *drawn, with->bytes(), {{kSameRays, &*plain}});
      if (step == 0.5) keep_picture("translucent", "translucent, half a voxel a step", drawn->image);
    }
    if (!options_.pareto) return {};
    step_("combinations, translucent");
    const auto best = floats->draw(fine({.finish = false, .supersample = 4}));
    if (!best) return best.error();
    for (const DrawingQuality& size : sizes())
      for (const double step : {1.0, 0.5, 0.25}) {
        DrawingQuality quality = size;
        quality.finish = false;
        quality.step_voxels = step;
        const auto drawn = draw_timed(*with, quality, *shipped_, options_.frames);
        if (!drawn) return drawn.error();
        add_point("translucent", quality, 0.0, *drawn, *best);
      }
    return {};
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
      step_(fmt::format("combinations, {0} x {0} rays a pixel, resolution {1:g}", size.supersample, size.resolution));
      for (const bool finish : {false, true})
        for (const auto& [step, bisections] : {std::pair{1.0, 0}, std::pair{1.0, 4}, std::pair{0.5, 5}, std::pair{0.25, 8}}) {
          const DrawingQuality quality{step, bisections, finish, size.supersample, size.resolution};
          const auto drawn = draw_timed(*shipped_, quality, *shipped_, options_.frames);
          if (!drawn) return drawn.error();
          add_point("rays", quality, 0.0, *drawn, best_);
        }
    }
    return {};
  }

  const RenderCostOptions& options_;
  Subject subject_;
  std::function<void(const std::string&)> step_;
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

Result<RenderCost> measure_render_cost(const RenderCostOptions& options) {
  RenderCost out;
  std::vector<bool> kinds{false};
  if (options.drilled) kinds.push_back(true);
  const double steps = static_cast<double>(kinds.size()) * (options.pareto ? 15.0 : 7.0);
  double done = 0.0;
  const auto step = [&](const std::string& what) {
    if (options.progress) options.progress(std::min(1.0, done++ / steps), what);
  };
  for (const bool drilled : kinds) {
    step(drilled ? "drilling" : "loading");
    auto subject = load_subject(options, drilled);
    if (!subject) return subject.error();
    if (Status ran = SubjectRun(options, std::move(subject).value(), step, out).run(); !ran) return ran.error();
  }
  add_point_rows(out);
  return out;
}

std::vector<ParetoRow> pareto_rows(const std::vector<DrawnPoint>& points, const std::string& method) {
  struct Sum {
    ParetoRow row;
    int count = 0;
  };
  std::vector<Sum> sums;
  for (const DrawnPoint& point : points) {
    if (point.method != method) continue;
    auto sum = std::ranges::find_if(sums, [&](const Sum& one) { return one.row.quality == point.quality; });
    if (sum == sums.end()) sum = sums.insert(sum, Sum{{point.quality, 0.0, point.psnr}, 0});
    sum->row.cost += point.over_shipped;
    sum->row.psnr = std::min(sum->row.psnr, point.psnr);
    ++sum->count;
  }
  std::vector<PricedPoint> priced;
  for (Sum& sum : sums) {
    sum.row.cost /= sum.count;
    priced.push_back({sum.row.cost, sum.row.psnr});
  }
  std::vector<ParetoRow> front;
  for (const std::size_t n : pareto_front(priced)) front.push_back(sums[n].row);
  const double first = front.empty() ? 1.0 : front.front().cost;
  for (ParetoRow& row : front) row.cost /= first;
  return front;
}

}  // namespace burrhole
