#include <fmt/format.h>

#include "app/cli/commands.h"
#include "app/cli/drill_window.h"
#include "app/cli/drilling.h"
#include "app/cli/picture_sink.h"
#include "app/cli/progress.h"
#include "app/cli/recorded_scene.h"
#include "app/job/wav_file.h"
#include "app/run/simulation.h"
#include "app/session/recorded_hand.h"
#include "core/base/cpu_model.h"
#include "core/base/hash.h"
#include "core/sound/drill_sound.h"

namespace burrhole::cli {
namespace {

std::string recorded_hash(const SessionReader& session, const std::string& kind) {
  for (const SessionHash& hash : session.hashes())
    if (hash.kind == kind) return hash.value;
  return {};
}

/// Says that a session has no results. @returns the exit code.
int nothing_compared(const std::string& session, bool allow_partial) {
  print_line(session + ": nothing was compared: the recorded run was cut short, so the session has no results" +
             (allow_partial ? "" : " (--allow-partial accepts that)"));
  return allow_partial ? kDone : kCheckFailed;
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
  if (std::string why = cli::why_different(meta); !why.empty()) return why;
  if (!replayed.renderer.empty() && !meta.renderer.empty() && (meta.renderer != replayed.renderer || meta.cpu != cpu_model()))
    return fmt::format("recorded with {} on {}: equal pictures are promised for equal renderers and processors only", meta.renderer,
                       meta.cpu);
  return {};
}

/// Receives the sound of a replay: for its hash, and for a file if one is requested.
class ReplayedSound final : public SoundSink {
 public:
  [[nodiscard]] Status open(const std::string& file, int sample_rate) {
    if (file.empty()) return {};
    auto made = WavFile::create(file, sample_rate);
    if (!made) return made.error();
    wav_ = std::move(made).value();
    return {};
  }
  void write(std::span<const float> samples) noexcept override {
    if (wav_ != nullptr) wav_->write(samples);
  }
  [[nodiscard]] Status finish() { return wav_ != nullptr ? wav_->finish() : Status(); }

 private:
  std::unique_ptr<WavFile> wav_;
};

/// @param stills draws the recorded pictures again. @param gl of --gl. @param wav file for the sound; empty: none.
Result<Replayed> replay(const std::string& path, bool quiet, bool stills, const std::string& gl, const std::string& wav) {
  auto session = SessionReader::open(path);
  if (!session) return session.error();
  auto hand = RecordedHand::create(*session);
  if (!hand) return Error{hand.error().code, hand.error().message, path};
  auto loaded = load_recorded(*session, hand->ticks(), stills);
  if (!loaded) return loaded.error();

  SimulationOptions options;
  options.hand = &*hand;
  options.stop = &stop_requested();
  Progress progress(quiet);
  options.progress = [&](double time, const DrillProgress& p) {
    progress.show(time / loaded->scene.duration, fmt::format("{:5.1f} s  depth {:6.2f} mm", time, p.depth * 1e3));
  };
  RecordedFile checkpoint;
  if (Status written = checkpoint.write(*session, "restore"); !written) return written.error();
  options.restore_path = checkpoint.path();
  options.history = !session->inputs().empty();
  ReplayedSound sound;
  const auto* sounds = session->stream(kAudioStream) != nullptr ? loaded->scene.find<SoundConfig>() : nullptr;
  if (sounds != nullptr) {
    if (Status opened = sound.open(wav, sounds->sample_rate); !opened) return opened.error();
    options.sound = &sound;
  } else if (!wav.empty()) {
    return bad_input("--wav: the session has no sound: leave --wav out, or record a run whose scene has the table [sound]", path);
  }
  std::unique_ptr<PictureSink> sink;
  if (const auto* display = loaded->scene.find<DisplayConfig>(); display != nullptr) {
    auto made = make_picture_sink(*display, {.folder = {}, .gl = gl});
    if (!made) return made.error();
    sink = std::move(made).value();
    options.sink = sink.get();
  }
  Issues issues;
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
  if (Status finished = sound.finish(); !finished) return finished.error();
  if (sounds != nullptr) rows.push_back({"sound", recorded_hash(*session, "sound"), simulation->sound_hash()});
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
    std::string gl = "auto", wav;
    bool quiet = false, stills = false, view = false, allow_partial = false;
    WindowOptions window;
  };
  CLI::App* command = add_command(
      app, "replay", kDrillGroup,
      {.summary = "Runs a recorded session again and compares the results bit for bit",
       .about = "Runs the same steps with the recorded hand motion and compares voxels, contact forces and forces "
                "sent to the hand with those of the recorded run. The session contains scene, tool and "
                "checkpoint; only the scan of an imported bone is read from its file. With --view it is shown in a window "
                "with a time line: run, pause, step, speed, jump.",
       .examples = {"burrhole replay out/session.sqlite", "burrhole replay out/session.sqlite --view"},
       .exits = "Exit 3 if voxels or forces differ, or if nothing could be compared because the recorded run was cut short (not "
                "with --allow-partial), 4 if --view finds no display, 130 after Ctrl-C."});
  auto option = std::make_shared<Options>();
  command->add_option("session", option->session, "session file of an earlier drill")->type_name(kFileValue)->required();
  add_simd_option(*command);
  command->add_flag("--stills", option->stills, "draw the recorded pictures again and compare them too (same CPU and driver)");
  add_gl_option(*command, option->gl);
  CLI::Option* wav =
      command->add_option("--wav", option->wav, "write the sound of a session with [sound] into this file")->type_name(kFileValue);
  command->add_flag("--view", option->view, "show the session in a window")->excludes("--stills")->excludes(wav);
  add_view_options(*command, option->window);
  command->add_flag("--allow-partial", option->allow_partial, "exit 0 also if the recorded run was cut short and has nothing to compare");
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, &exit_code] {
    catch_signals();
    if (option->view) {
      const auto viewed = view_session_in_window(option->session, option->window, option->quiet);
      exit_code = !viewed ? report(viewed.error()) : *viewed == ViewedSession::different ? kCheckFailed : kDone;
      if (viewed && *viewed == ViewedSession::without_results) exit_code = nothing_compared(option->session, option->allow_partial);
      if (exit_code == kDone && stop_requested().load()) exit_code = kInterrupted;
      return;
    }
    const auto replayed = replay(option->session, option->quiet, option->stills, option->gl, option->wav);
    if (!replayed) {
      exit_code = report(replayed.error());
      return;
    }
    if (stop_requested().load()) {
      exit_code = kInterrupted;
      return;
    }
    exit_code = kDone;
    bool compared = false;
    for (const Comparison& row : replayed->rows) {
      const bool known = !row.recorded.empty();
      compared = compared || known;
      print(fmt::format("{:<7} recorded {}  replayed {}  {}\n", row.name, known ? row.recorded : "(none: the run was cut short)",
                        row.replayed,
                        !known       ? "not comparable"
                        : row.same() ? "same"
                                     : "DIFFERENT"));
      if (known && !row.same()) exit_code = kCheckFailed;
    }
    if (!compared) exit_code = nothing_compared(option->session, option->allow_partial);
    if (const std::string why = why_different(*replayed); compared && exit_code == kCheckFailed && !why.empty()) print(why + "\n");
  });
}

}  // namespace burrhole::cli
