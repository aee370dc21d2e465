#include "app/bench/growth_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/bench/bench_scene.h"
#include "app/bench/stopwatch.h"
#include "app/render/renderer.h"
#include "app/report/file.h"
#include "app/report/scratch_folder.h"
#include "core/base/hash.h"
#include "core/base/simd.h"

extern char** environ;

namespace burrhole {
namespace {

constexpr double kVoxel = 0.25e-3;                      // [m]
constexpr int kThickness = 28;                          // [voxels] of the plate
constexpr int kTile = 64;                               // [voxels] edge of the boxes in which the plate is made
constexpr double kApproach = 0.6, kInBone = 1.0;        // [s]
constexpr int kHashed = 20;                             // [voxels] half the edge of the compared box round the entry
constexpr double kSmall = 1e-6, kKibi = 1024.0;         // s per us; bytes per KiB
constexpr int kRepetitions = 5, kQuickRepetitions = 2;  // of what is timed after drilling

/// As the shipped scenes, with a tool that a volume of 16 mm contains. The camera is near, so that pictures of all volumes show the same.
constexpr const char* kScene = R"(title = "Plate across a volume"
duration_s = 60.0
[volume]
source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [16.0, 16.0, 16.0]
thickness_mm = 7.0
[tool]
name = "round_burr_4mm"
spin_rpm = 20000.0
erosion_scale = 5.0
[approach]
entry_mm = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, -1.0]
[hand]
kind = "script"
push_N = 12.0
tremor_mm = 0.04
[contact]
model = "surface"
[erosion]
law = "rate"
[display]
method = "raycast"
size = [400, 300]
distance_mm = 14.0
)";

/// @returns the CPU time of all threads [s].
template <class F>
double seconds_of(F&& f) {
  const double start = cpu_seconds();
  f();
  return cpu_seconds() - start;
}

/// @returns the peak resident memory of this process [bytes].
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kilobytes = 0.0;
      status >> kilobytes;
      return kilobytes * kKibi;
    }
  return 0.0;
}

/// One tile of the plate, with a layer on either side in which occupancy rises as in a phantom (volumes/phantom/phantom.h).
DenseBone make_tile() {
  DenseBone out;
  out.dims = {kTile, kTile, kThickness + 2};
  const std::size_t layer = static_cast<std::size_t>(kTile) * kTile;
  for (int k = 0; k < out.dims.z; ++k) {
    const int outside = std::min(k, out.dims.z - 1 - k);  // 0 in the outermost layer
    out.occupancy.insert(out.occupancy.end(), layer, outside == 0 ? 0.25f : outside == 1 ? 0.75f : 1.0f);
  }
  out.hardness.assign(out.occupancy.size(), 0.8f);
  for (const float occupancy : out.occupancy)
    out.labels.push_back(static_cast<std::uint8_t>(occupancy < 0.5f ? VoxelLabel::none : VoxelLabel::bone));
  return out;
}

/// Only the layers that hold bone exist at any time. The upper face is at z = 0, and x and y are centred on it.
Result<std::shared_ptr<const BoneModel>> make_plate(int edge) {
  const int lowest = edge / 2 - kThickness / 2;  // layer of the plate
  const double centre = 0.5 * (edge - 1);
  Affine bone_from_index;
  bone_from_index.linear = Mat3(kVoxel);
  bone_from_index.offset = -kVoxel * Vec3(centre, centre, lowest + kThickness - 0.5);
  auto builder = BoneModelBuilder::create(Vec3i(edge), bone_from_index);
  if (!builder) return builder.error();
  const DenseBone tile = make_tile();
  for (int j = 0; j < edge; j += kTile)
    for (int i = 0; i < edge; i += kTile) {
      const Vec3i lo(i, j, lowest - 1);
      if (Status added = builder->add({lo, lo + tile.dims}, tile); !added) return added.error();
    }
  return builder->finish();
}

/// The renderer of the program, without files.
class GrowthSink final : public FrameSink {
 public:
  explicit GrowthSink(Renderer renderer) : renderer_(std::move(renderer)) {}
  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    if (Status set = renderer_.set_volume(volume); !set) return set;
    return renderer_.set_tool(tool);
  }
  void update(const TexelBox& texels) override { renderer_.update(texels); }
  Status move_detail(const DetailView& view) override { return renderer_.set_detail(view); }
  void forget() override { renderer_.forget(); }
  /// Without drawing, a picture consists of making and sending texels.
  void set_drawing(bool draws) noexcept { draws_ = draws; }
  Status draw(const std::string&, const FrameView& view, int width, int height, Hash64& hash) override {
    if (!draws_) return {};
    const auto image = renderer_.draw(view, width, height);
    if (!image) return image.error();
    for (const Rgba8& p : image->pixels) hash.add(std::uint64_t{p.r} << 16 | std::uint64_t{p.g} << 8 | std::uint64_t{p.b});
    return {};
  }

 private:
  Renderer renderer_;
  bool draws_ = true;
};

/// One simulation, its steps called as in `burrhole drill`.
class Drilling {
 public:
  Drilling(LoadedScene& loaded, Simulation& simulation, bool quick)
      : loaded_(&loaded), simulation_(&simulation), stage_(&simulation.stage()), steps_(*stage_), quick_(quick) {}

  void drill(GrowthRun& out) {
    const double seconds = kApproach + (quick_ ? 0.1 : 1.0) * kInBone;
    const auto ticks = static_cast<std::uint64_t>(std::llround(seconds / stage_->period));
    out.drilling = seconds_of([&] {
      while (steps_.ticks() < ticks) {
        steps_.tick();
        if (steps_.ran_contact()) out.forces.push_back(glm::length(stage_->contact->state().on_hand.force));
      }
    });
    out.contact = kSmall * simulation_->timing("contact").p50_us;
    out.bone_step = kSmall * simulation_->timing("erosion").p50_us;
    out.publishing = kSmall * simulation_->timing("publish").p50_us;
    out.removed = stage_->bone->removed_mass();
    out.depth = simulation_->progress().depth;
    out.hashes.push_back(hash_round_entry());
  }

  /// Pictures between further bone steps.
  Status draw(GrowthRun& out) {
    const DisplayConfig& display = *loaded_->scene.find<DisplayConfig>();
    RenderOptions options = make_render_options(display.quality, display.appearance);
    options.growth_is_reported = true;
    auto renderer = Renderer::create(options);
    if (!renderer) return renderer.error();
    sink_ = std::make_unique<GrowthSink>(std::move(renderer).value());
    Status status;
    out.first = seconds_of([&] {
      auto made =
          FrameStep::create(display, stage_->config.volume.world_from_bone, stage_->approach, *stage_->tool, *stage_->voxmap, *sink_);
      status = made ? Status() : Status(made.error());
      if (!made) return;
      frame_.emplace(std::move(made).value());
      status = picture();
    });
    std::vector<double> whole, texels;
    for (int n = 0; status.ok() && n < repetitions(); ++n) {
      sink_->forget();
      whole.push_back(seconds_of([&] { status = picture(); }));
    }
    sink_->set_drawing(false);
    for (int n = 0; status.ok() && n < repetitions(); ++n) {
      do steps_.tick();
      while (!steps_.ran_bone());
      texels.push_back(seconds_of([&] { status = picture(); }));
    }
    if (!status.ok()) return status;
    out.picture = median(whole);
    out.texels = median(texels);
    return {};
  }

  /// Undoes the hole, and what restored it.
  Status undo(GrowthRun& out) {
    if (Status stored = stage_->checkpoint("drilled"); !stored) return stored;
    std::vector<double> undone;
    for (int n = 0; n < repetitions(); ++n) {
      if (n > 0)
        if (Status restored = stage_->restore("drilled"); !restored) return restored;
      Result<bool> done = false;
      undone.push_back(seconds_of([&] { done = stage_->undo(); }));
      if (!done) return done.error();
      if (!*done) return Error{ErrorCode::internal, "there was nothing to undo", {}};
    }
    out.undo = median(undone);
    out.hashes.push_back(hash_round_entry());
    return {};
  }

 private:
  [[nodiscard]] int repetitions() const noexcept { return quick_ ? kQuickRepetitions : kRepetitions; }
  Status picture() {
    frame_->gather_rest(stage_->bone->turned());
    return frame_->draw("growth", stage_->contact->state().world_from_tool, false);
  }
  /// Of `remaining` in steps of 2^-14: between volumes its last bits may differ, as index coordinates are rounded differently.
  [[nodiscard]] std::uint64_t hash_round_entry() const {
    const Vec3i middle = stage_->voxmap->bone().dims() / 2;
    const VoxelBox box{middle - kHashed, middle + kHashed};
    std::vector<float> remaining(box.count());
    stage_->voxmap->read_remaining(box, remaining);
    Hash64 hash;
    for (const float value : remaining) hash.add(std::round(0x1p14 * static_cast<double>(value)));
    return hash.value();
  }

  LoadedScene* loaded_;
  Simulation* simulation_;
  Stage* stage_;
  Lockstep steps_;
  bool quick_;
  std::unique_ptr<GrowthSink> sink_;
  std::optional<FrameStep> frame_;
};

/// Calls f(name, member) for each member of a run, so that writer and reader agree.
template <class Run, class F>
void for_each_member(Run& run, F&& f) {
  f("load", run.load);
  f("drilling", run.drilling);
  f("contact", run.contact);
  f("bone_step", run.bone_step);
  f("publishing", run.publishing);
  f("undo", run.undo);
  f("first", run.first);
  f("picture", run.picture);
  f("texels", run.texels);
  f("model_bytes", run.model_bytes);
  f("peak", run.peak);
  f("peak_drawn", run.peak_drawn);
  f("bone_voxels", run.bone_voxels);
  f("removed", run.removed);
  f("depth", run.depth);
  f("forces", run.forces);
  f("hashes", run.hashes);
}

}  // namespace

Result<GrowthRun> run_growth(int edge, bool quick) {
  auto loaded = load_scene_text(kScene, "growth");
  if (!loaded) return loaded.error();
  GrowthRun out;
  std::unique_ptr<Simulation> simulation;
  Issues issues;
  Status status;
  out.load = seconds_of([&] {
    auto bone = make_plate(edge);
    status = bone ? Status() : Status(bone.error());
    if (!bone) return;
    (*loaded)->bone = std::move(bone).value();
    SimulationOptions options;
    options.history = true;
    simulation = Simulation::create((*loaded)->scene, (*loaded)->bone, (*loaded)->tool, options, issues);
  });
  if (!status.ok()) return status.error();
  if (!simulation) return issues.front();
  out.model_bytes = static_cast<double>((*loaded)->bone->bytes());
  out.bone_voxels = static_cast<double>((*loaded)->bone->bone_voxels());
  Drilling drilling(**loaded, *simulation, quick);
  drilling.drill(out);
  out.peak = peak_memory();
  if (Status drawn = drilling.draw(out); !drawn) return drawn.error();
  if (Status undone = drilling.undo(out); !undone) return undone.error();
  out.peak_drawn = peak_memory();
  return out;
}

Status print_growth(int edge, bool quick) {
  auto run = run_growth(edge, quick);
  if (!run) return run.error();
  nlohmann::json json;
  for_each_member(*run, [&](const char* name, const auto& member) { json[name] = member; });
  fmt::print("{}\n", json.dump());
  return {};
}

Result<GrowthRun> run_growth_apart(int edge, bool quick) {
  const ScratchFolder folder;
  std::error_code ignored;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", ignored).string(), file = folder.file("run.json");
  std::vector<std::string> words{program, "--growth-edge", std::to_string(edge)};
  if (const std::string level = simd_in_use(); level != "portable") words.insert(words.end(), {"--simd", level});
  if (quick) words.emplace_back("--quick");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = 0;
  const int code = ::posix_spawn(&child, program.c_str(), &streams, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  int status = 0;
  while (code == 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  constexpr int kNoOpenGl = 4;  // exit code of the program
  if (code == 0 && WIFEXITED(status) && WEXITSTATUS(status) == kNoOpenGl) return Error{ErrorCode::unavailable, "growth needs OpenGL", {}};
  const auto text = read_file(file);
  const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
  if (code != 0 || status != 0 || !json.is_object())
    return Error{ErrorCode::internal, fmt::format("the run of a volume of {} voxels per edge failed", edge), {}};
  GrowthRun out;
  for_each_member(out, [&](const char* name, auto& member) { json.at(name).get_to(member); });
  return out;
}

}  // namespace burrhole
