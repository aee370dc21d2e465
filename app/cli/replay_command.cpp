#include <fmt/format.h>

#include <unistd.h>

#include <filesystem>

#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/cli/picture_sink.h"
#include "app/cli/progress.h"
#include "app/report/file.h"
#include "app/run/simulation.h"
#include "app/session/recorded_hand.h"
#include "core/base/cpu_model.h"
#include "core/base/hash.h"
#include "core/base/physics_version.h"

namespace burrhole::cli {
namespace {

std::string recorded_hash(const SessionReader& session, const std::string& kind) {
  for (const SessionHash& hash : session.hashes())
    if (hash.kind == kind) return hash.value;
  return {};
}

/// A temporary file for the checkpoint stored in a session, as OpenVDB reads files only.
class CheckpointFile {
 public:
  [[nodiscard]] Status write(const std::string& bytes) {
    path_ = (std::filesystem::temp_directory_path() / fmt::format("burrhole-replay-{}.vdb", getpid())).string();
    return write_file(path_, bytes);
  }
  ~CheckpointFile() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

Result<LoadedScene> load_recorded(const SessionReader& session, std::size_t ticks, bool stills, Issues& issues) {
  auto document = TomlDocument::parse(session.meta().scene, session.meta().scene_path);
  if (!document) return document.error();
  (void)document->rename();  // keys of earlier versions
  auto loaded = load_scene(*document, scene_context(), issues, {.tool_text = session.meta().tool, .progress = {}, .say = {}});
  if (!loaded) return issues.front();
  if (!stills) (void)loaded->scene.effects.remove("display");
  loaded->scene.duration = static_cast<double>(ticks) / loaded->scene.servo_hz;
  return std::move(*loaded);
}

struct Comparison {
  std::string name, recorded, replayed;
  [[nodiscard]] bool same() const { return recorded == replayed; }
};

struct Replayed {
  std::vector<Comparison> rows;
  SessionMeta recorded;
  std::string renderer;  // of this replay; empty without pictures
};

/// @returns why equal results could not be expected; empty when they could.
std::string why_different(const Replayed& replayed) {
  const SessionMeta& meta = replayed.recorded;
  if (meta.physics_version != kPhysicsVersion)
    return fmt::format("recorded with physics version {}, replayed with {}: equal results are promised for equal versions only",
                       meta.physics_version, kPhysicsVersion);
  if (!replayed.renderer.empty() && !meta.renderer.empty() && (meta.renderer != replayed.renderer || meta.cpu != cpu_model()))
    return fmt::format("recorded with {} on {}: equal pictures are promised for equal renderers and processors only", meta.renderer,
                       meta.cpu);
  return {};
}

/// @param stills draws the recorded pictures again. @param gl of --gl.
Result<Replayed> replay(const std::string& path, bool quiet, bool stills, const std::string& gl) {
  auto session = SessionReader::open(path);
  if (!session) return session.error();
  auto hand = RecordedHand::create(*session);
  if (!hand) return Error{hand.error().code, hand.error().message, path};
  Issues issues;
  auto loaded = load_recorded(*session, hand->ticks(), stills, issues);
  if (!loaded) return loaded.error();

  SimulationOptions options;
  options.hand = &*hand;
  options.stop = &stop_requested();
  Progress progress(quiet);
  options.progress = [&](double time, const DrillProgress& p) {
    progress.show(time / loaded->scene.duration, fmt::format("{:5.1f} s  depth {:6.2f} mm", time, p.depth * 1e3));
  };
  CheckpointFile checkpoint;
  for (const SessionEvent& event : session->events()) {
    if (event.kind != "restore") continue;
    if (Status written = checkpoint.write(event.data); !written) return written.error();
    options.restore_path = checkpoint.path();
  }
  options.history = !session->inputs().empty();
  std::unique_ptr<PictureSink> sink;
  if (const auto* display = loaded->scene.find<DisplayConfig>(); display != nullptr) {
    auto made = make_picture_sink(*display, {.folder = {}, .gl = gl});
    if (!made) return made.error();
    sink = std::move(made).value();
    options.sink = sink.get();
  }
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, options, issues);
  if (!simulation) return issues.front();
  if (has_order(*session)) {
    if (Status ran = simulation->run_recorded(*session, *hand); !ran) return Error{ran.error().code, ran.error().message, path};
  } else if (Status ran = simulation->run(); !ran) {
    return ran.error();
  }
  std::vector<Comparison> rows{{"voxels", recorded_hash(*session, "voxels"), hash_text(simulation->voxmap().hash())},
                               {"forces", recorded_hash(*session, "forces"), hash_text(simulation->force_hash())},
                               {"sent", recorded_hash(*session, "sent"), hash_text(simulation->sent_hash())}};
  if (sink)
    for (std::size_t n = 0; n < session->stills().size(); ++n) {
      const SessionStill& still = session->stills()[n];
      const bool drawn = n < simulation->redrawn().size();
      rows.push_back({"still " + still.name, still.hash, drawn ? simulation->redrawn()[n].hash : std::string("(not reached)")});
    }
  return Replayed{std::move(rows), session->meta(), sink ? sink->driver() : std::string()};
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  struct Options {
    std::string session;
    std::string gl = "auto";
    bool quiet = false, stills = false;
  };
  CLI::App* command =
      add_command(app, "replay", kDrillGroup,
                  {.summary = "Runs a recorded session again and compares the results bit for bit",
                   .about = "Runs the same steps with the recorded hand motion and compares voxels, contact forces and forces "
                            "sent to the hand with those of the recorded run. The session contains scene, tool and "
                            "checkpoint; only the scan of an imported bone is read from its file.",
                   .examples = {"burrhole replay out/session.sqlite"},
                   .exits = "Exit 3 if voxels or forces differ, 130 after Ctrl-C."});
  auto option = std::make_shared<Options>();
  command->add_option("session", option->session, "session file of an earlier drill")->type_name(kFileValue)->required();
  add_simd_option(*command);
  command->add_flag("--stills", option->stills, "draw the recorded pictures again and compare them too (same CPU and driver)");
  add_gl_option(*command, option->gl);
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, &exit_code] {
    catch_signals();
    const auto replayed = replay(option->session, option->quiet, option->stills, option->gl);
    if (!replayed) {
      exit_code = report(replayed.error());
      return;
    }
    if (stop_requested().load()) {
      exit_code = kInterrupted;
      return;
    }
    exit_code = kDone;
    for (const Comparison& row : replayed->rows) {
      const bool known = !row.recorded.empty();
      print(fmt::format("{:<7} recorded {}  replayed {}  {}\n", row.name, known ? row.recorded : "(none: the run was cut short)",
                        row.replayed,
                        !known       ? "not comparable"
                        : row.same() ? "same"
                                     : "DIFFERENT"));
      if (known && !row.same()) exit_code = kCheckFailed;
    }
    if (const std::string why = why_different(*replayed); exit_code == kCheckFailed && !why.empty()) print(why + "\n");
  });
}

}  // namespace burrhole::cli
