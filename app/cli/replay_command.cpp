#include <fmt/format.h>

#include "app/cli/commands.h"
#include "app/cli/drill_window.h"
#include "app/cli/drilling.h"
#include "app/cli/film.h"
#include "app/cli/picture_sink.h"
#include "app/cli/progress.h"
#include "app/cli/recorded_scene.h"
#include "app/cli/scene_bar.h"
#include "app/job/wav_file.h"
#include "app/run/live_replay.h"
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

/// Says that rows of a session were lost. @returns the exit code.
int rows_were_lost(const std::string& session) {
  print_line(session +
             ": nothing was compared: rows of the recorded run were lost, since its log was full, so its steps cannot be repeated; "
             "record it again with fewer other programs, or a lower servo_hz");
  return kCheckFailed;
}

struct Comparison {
  std::string name, recorded, replayed;
  [[nodiscard]] bool same() const { return recorded == replayed; }
};

struct ReplayOptions {
  std::string session, gl = "auto";
  std::string wav;  ///< file for the sound; empty: none
  FilmOptions film;
  bool quiet = false, stills = false;
};

struct Replayed {
  bool lacks_rows = false;  // then nothing else is set
  std::vector<Comparison> rows;
  std::string changed_bone;  // one line; empty: the bone is that of the run
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

/// @returns the writer of --video; null without it.
Result<std::unique_ptr<FilmWriter>> film_of(const ReplayOptions& option, const LoadedScene& loaded) {
  if (option.film.path.empty()) return std::unique_ptr<FilmWriter>();
  if (loaded.scene.find<DisplayConfig>() == nullptr)
    return bad_input("--video: the recorded scene has no table [display]: record a run with pictures", option.session);
  return make_film(loaded.scene, option.film);
}

Status finish_film(FilmWriter* film, const ReplayOptions& option) {
  if (film == nullptr) return {};
  if (Status finished = film->finish(); !finished) return finished;
  if (film->frames() == 0)
    print_warning(option.session, "the session ends before the first frame of its film: none was written; a higher --video-fps gives one");
  else if (!option.quiet)
    note(fmt::format("film: {} frames, {} a second, in {}\n", film->frames(), option.film.fps, option.film.path));
  return {};
}

Result<Replayed> replay(const ReplayOptions& option) {
  const std::string& path = option.session;
  auto session = SessionReader::open(path);
  if (!session) return session.error();
  if (lacks_rows(*session)) return Replayed{.lacks_rows = true, .rows = {}, .changed_bone = {}, .recorded = {}, .renderer = {}};
  auto hand = RecordedHand::create(*session);
  if (!hand) return Error{hand.error().code, hand.error().message, path};
  auto loaded = load_recorded(*session, hand->ticks(), option.stills || !option.film.path.empty());
  if (!loaded) return loaded.error();
  const auto film = film_of(option, *loaded);
  if (!film) return film.error();

  SimulationOptions options;
  if (*film) options.film_hz = option.film.fps;
  options.hand = &*hand;
  options.stop = &stop_requested();
  Progress progress(option.quiet);
  options.progress = [&](double time, const DrillProgress& p) {
    progress.show(time / loaded->scene.duration, progress_text(time, p.depth));
  };
  RecordedFile checkpoint;
  if (Status written = checkpoint.write(*session, "restore"); !written) return written.error();
  options.restore_path = checkpoint.path();
  options.history = !session->inputs().empty();
  ReplayedSound sound;
  const auto* sounds = session->stream(kAudioStream) != nullptr ? loaded->scene.find<SoundConfig>() : nullptr;
  if (sounds != nullptr) {
    if (Status opened = sound.open(option.wav, sounds->sample_rate); !opened) return opened.error();
    options.sound = &sound;
  } else if (!option.wav.empty()) {
    return bad_input("--wav: the session has no sound: leave --wav out, or record a run whose scene has the table [sound]", path);
  }
  std::unique_ptr<PictureSink> sink;
  if (const auto* display = loaded->scene.find<DisplayConfig>(); display != nullptr) {
    auto made = make_picture_sink(*display, {.folder = {}, .gl = option.gl, .film = film->get(), .bar = bar_of(loaded->scene)});
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
  if (Status filmed = finish_film(film->get(), option); !filmed) return filmed.error();
  std::vector<Comparison> rows;
  if (const auto bone = bone_hashes(*session, *loaded)) rows.push_back({"volume", bone->recorded, bone->now});
  for (const Comparison& row :
       std::vector<Comparison>{{"voxels", recorded_hash(*session, "voxels"), hash_text(simulation->voxmap().hash())},
                               {"forces", recorded_hash(*session, "forces"), hash_text(simulation->force_hash())},
                               {"sent", recorded_hash(*session, "sent"), hash_text(simulation->sent_hash())}})
    rows.push_back(row);
  if (Status finished = sound.finish(); !finished) return finished.error();
  if (sounds != nullptr) rows.push_back({"sound", recorded_hash(*session, "sound"), simulation->sound_hash()});
  if (sink && option.stills)
    for (std::size_t n = 0; n < session->stills().size(); ++n) {
      const SessionStill& still = session->stills()[n];
      const bool drawn = n < simulation->redrawn().size();
      rows.push_back({"still " + still.name, still.hash, drawn ? simulation->redrawn()[n].hash : std::string("(not reached)")});
    }
  return Replayed{false, std::move(rows), changed_bone(*session, *loaded), session->meta(), sink ? sink->driver() : std::string()};
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  struct Options : ReplayOptions {
    bool view = false, allow_partial = false;
    WindowOptions window;
  };
  CLI::App* command = add_command(
      app, "replay", kDrillGroup,
      {.summary = "Runs a recorded session again and compares the results bit for bit",
       .about = "Runs the same steps with the recorded hand motion and compares voxels, contact forces and forces "
                "sent to the hand with those of the recorded run. The session contains scene, tool and "
                "checkpoint; only the scan of an imported bone is read from its file. With --view it is shown in a window "
                "with a time line: run, pause, step, speed, jump.",
       .examples = {"burrhole replay out/session.sqlite", "burrhole replay out/session.sqlite --view",
                    "burrhole replay out/session.sqlite --video session.mp4"},
       .exits = "Exit 3 if the bone that the scene names, voxels or forces differ, or if nothing could be compared because the "
                "recorded run was cut short (not "
                "with --allow-partial) or rows of it were lost, 4 if --view finds no display or a video needs ffmpeg, 130 after Ctrl-C."});
  auto option = std::make_shared<Options>();
  command->add_option("session", option->session, "session file, or folder of results")->type_name(kFileValue)->required();
  add_simd_option(*command);
  command->add_flag("--stills", option->stills, "draw the recorded pictures again and compare them too (same CPU and driver)");
  add_gl_option(*command, option->gl);
  CLI::Option* wav =
      command->add_option("--wav", option->wav, "write the sound of a session with [sound] into this file")->type_name(kFileValue);
  CLI::Option* video = add_film_options(*command, option->film);
  command->add_flag("--force", option->film.replace, "replace the frames in the folder of --video")->needs(video);
  command->add_flag("--view", option->view, "show the session in a window")->excludes("--stills")->excludes(wav)->excludes(video);
  add_view_options(*command, option->window);
  command->add_flag("--allow-partial", option->allow_partial, "exit 0 also if the recorded run was cut short and has nothing to compare");
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, &exit_code] {
    catch_signals();
    const auto path = session_of(option->session);
    if (!path) {
      exit_code = report(path.error());
      return;
    }
    option->session = *path;
    if (option->view) {
      const auto viewed = view_session_in_window(option->session, option->window, option->quiet);
      exit_code = !viewed ? report(viewed.error()) : *viewed == ViewedSession::different ? kCheckFailed : kDone;
      if (viewed && *viewed == ViewedSession::without_results) exit_code = nothing_compared(option->session, option->allow_partial);
      if (viewed && *viewed == ViewedSession::lacking_rows) exit_code = rows_were_lost(option->session);
      if (exit_code == kDone && stop_requested().load()) exit_code = kInterrupted;
      return;
    }
    const auto replayed = replay(*option);
    if (!replayed) {
      exit_code = report(replayed.error());
      return;
    }
    if (replayed->lacks_rows) {
      exit_code = rows_were_lost(option->session);
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
    if (!replayed->changed_bone.empty()) print_line(replayed->changed_bone);
    if (const std::string why = why_different(*replayed); compared && exit_code == kCheckFailed && !why.empty()) print(why + "\n");
  });
}

}  // namespace burrhole::cli
