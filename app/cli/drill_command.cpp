#include <fmt/format.h>

#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string_view>

#include "app/cli/commands.h"
#include "app/cli/drill_window.h"
#include "app/cli/drilling.h"
#include "app/cli/film.h"
#include "app/cli/given_paths.h"
#include "app/cli/progress.h"
#include "app/cli/scene_bar.h"
#include "app/job/drill_job.h"
#include "app/job/earlier_run.h"
#include "app/job/expectation.h"
#include "app/stage/result_files.h"

namespace burrhole::cli {
namespace {

std::atomic<bool> stop_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void on_signal(int) { stop_flag.store(true, std::memory_order_relaxed); }

extern "C" void end_on_signal(int) {
  constexpr std::string_view kText = "\nstopped: nothing was written\n";
  static_cast<void>(!::write(STDERR_FILENO, kText.data(), kText.size()));  // a closed standard error changes nothing
  ::_exit(kInterrupted);
}

void handle_signals(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = flags;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void print_figures(const RunSummary& s) {
  const auto mm = [](const std::optional<double>& value) { return value ? fmt::format("{:.2f} mm", *value) : std::string("-"); };
  note(fmt::format(
      "thickness {:.2f} mm, breakthrough at a depth of {}, plunge {}, hole {} outside, {} inside, peak force {:.1f} N, {:.1f} s simulated "
      "in {:.1f} s\n{}\n",
      s.thickness_mm, mm(s.depth_mm), mm(s.plunge_mm), mm(s.hole_diameter_mm), mm(s.inner_diameter_mm), s.peak_force_N, s.duration_s,
      s.wall_s, outcome_text(s)));
}

/// Receives sound for a run that only measures it.
class NoSpeaker final : public SoundSink {
 public:
  void write(std::span<const float>) noexcept override {}
};

/// @returns the error of options that exclude each other, or of a folder that is none.
Status check_options(const LiveMode& mode, const DrillingFiles& files) {
  if (mode.require_realtime && !mode.live) return bad_input("--require-realtime is valid only with --live: add it");
  if (mode.live && !files.film.path.empty())
    return bad_input("--video is not valid with --live: film the session afterwards, by burrhole replay --video");
  std::error_code ignored;
  if (std::filesystem::exists(files.folder, ignored) && !std::filesystem::is_directory(files.folder, ignored))
    return bad_input("the output folder is a file: give another by --out", files.folder);
  return {};
}

Result<bool> decide_window(WindowOptions& window, SceneOption& scene, bool by_script, bool quiet) {
  if (by_script && (window.asked || window.light || window.text_scale != 1.0))
    return bad_input(
        "--window, --light and --text-scale are not valid with --offscreen, --no-pictures, --json, --live, --video or --inputs");
  const auto windowed = by_script ? Result<bool>(false) : prepare_window(window, scene, quiet);
  if (windowed && !*windowed && window.demonstration && !quiet)
    note("--demo: no window: the scene's own hand drills offscreen, for the time of the scene\n");
  return windowed;
}

Result<std::vector<ExpectedTerm>> parse_if_given(const std::optional<std::string>& expect) {
  if (!expect) return std::vector<ExpectedTerm>();
  return parse_expectation(*expect);
}

}  // namespace

const std::atomic<bool>& stop_requested() { return stop_flag; }

void catch_signals() {
  handle_signals(on_signal, SA_RESTART | SA_RESETHAND);  // a second Ctrl-C ends the program
  // A terminal that is closed may send more than one; nohup has the signal ignored.
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

void catch_all_signals() {
  catch_signals();
  handle_signals(on_signal, 0);  // a wait for the other end of a pipe ends, since no second signal would end it
}

void end_at_signals() { handle_signals(end_on_signal, 0); }

Result<RunSummary> drill_scene(const LoadedScene& loaded, const DrillingFiles& files, bool quiet, const LiveMode& mode) {
  Progress progress(quiet);
  DrillJob job;
  job.folder = files.folder;
  job.restore_path = files.restore_path;
  job.shipped_scenes = shipped_folder("scenes");
  job.live = mode.live;
  job.require_realtime = mode.require_realtime;
  job.stop = &stop_flag;
  job.warn = [&](const std::string& text) { print_warning(loaded.scene.file, text); };
  if (!quiet) job.say = print_line;
  job.progress = [&](double share, const std::string& text) { progress.show(share, text); };
  // A run without outputs is one whose steps are timed: its sound is made for nobody.
  if (files.folder.empty()) job.make_speaker = [](int) { return std::make_unique<NoSpeaker>(); };
  std::unique_ptr<FilmWriter> film;
  if (!files.film.path.empty()) {
    if (loaded.scene.find<DisplayConfig>() == nullptr)
      return bad_input("--video needs the table [display]: add it to the scene", loaded.scene.file);
    auto made = make_film(loaded.scene, files.film);
    if (!made) return made.error();
    film = std::move(made).value();
    job.film_hz = files.film.fps;
  }
  job.make_sink = [&](const DisplayConfig& display, const std::string& folder) {
    return make_picture_sink(display, {.folder = folder,
                                       .gl = files.gl,
                                       .shader_folder = files.shader_folder,
                                       .film = film.get(),
                                       .report =
                                           [quiet](const std::string& line) {
                                             if (!quiet) note(fmt::format("quality: {}\n", line));
                                           },
                                       .bar = bar_of(loaded.scene)});
  };
  if (!files.inputs.empty()) {
    Issues issues;
    auto inputs = load_inputs(files.inputs, loaded.scene, scene_context(), issues);
    if (!inputs) return issues.front();
    job.inputs = std::move(*inputs);
  }
  auto summary = drill(loaded, job);
  if (!summary || !film) return summary;
  if (Status finished = film->finish(); !finished) return finished.error();
  if (film->frames() == 0)
    print_warning(
        loaded.scene.file,
        "the run ended before the first frame of its film: none was written; a longer duration_s or a higher --video-fps gives one");
  else if (!quiet)
    note(fmt::format("film: {} frames, {} a second, in {}\n", film->frames(), files.film.fps, files.film.path));
  return summary;
}

namespace {

struct DrillOptions {
  SceneOption scene;
  DrillingFiles files{.folder = "out", .restore_path = {}};
  LiveMode mode;
  WindowOptions window;
  std::optional<std::string> expect;
  bool json = false, quiet = false, offscreen = false, force = false;
};

/// Runs the command once its arguments are parsed.
void run_drill(DrillOptions& option, int& exit_code) {
  if (const Status valid = check_options(option.mode, option.files); !valid) {
    exit_code = report(valid.error());
    return;
  }
  auto expected = parse_if_given(option.expect);
  if (!expected) {
    exit_code = report(expected.error());
    return;
  }
  const bool by_script = option.offscreen || option.scene.no_pictures || option.json || option.mode.live ||
                         !option.files.film.path.empty() || !option.files.inputs.empty();
  const auto windowed = decide_window(option.window, option.scene, by_script, option.quiet);
  if (!windowed) {
    exit_code = report(windowed.error());
    return;
  }
  option.mode.live = option.mode.live || *windowed;
  option.files.film.replace = option.force;
  option.files.film.run_folder = option.files.folder;
  const auto loaded = load_or_report(option.scene, exit_code, option.quiet, option.mode.live, option.files.inputs);
  if (!loaded) return;
  if (!option.force)
    if (const Status free = check_earlier_run(*loaded, option.files.folder, shipped_folder("scenes")); !free) {
      exit_code = report(free.error());
      return;
    }
  for (const std::string& warning : make_plan(*loaded).warnings) print_warning(loaded->scene.file, warning);
  catch_signals();
  const auto summary = *windowed ? drill_scene_in_window(*loaded, option.window, option.files, option.quiet)
                                 : drill_scene(*loaded, option.files, option.quiet, option.mode);
  if (!summary) {
    exit_code = report(summary.error());
    if (summary.error().message == kNeverBegan) exit_code = kInterrupted;
    return;
  }
  if (!option.quiet) print_figures(*summary);
  const std::vector<std::string> missed = missed_terms(*expected, *summary);
  for (const std::string& line : missed) print_line(loaded->scene.file + ": " + line);
  if (!option.quiet) {
    const std::string page = (std::filesystem::path(option.files.folder) / kReportFile).string();
    std::error_code ignored;
    print_line("results in " + (std::filesystem::exists(page, ignored) ? page : option.files.folder));
    print_line(result_line(*summary));
  }
  if (option.json) print(summary_json(*summary));
  exit_code = missed.empty() ? kDone : kCheckFailed;
  if (summary->end == "stopped" && stop_requested()) exit_code = kInterrupted;  // a person may end a demonstration
}

}  // namespace

Result<std::unique_ptr<FilmWriter>> make_film(const Scene& scene, const FilmOptions& options) {
  if (scene.servo_hz % options.fps != 0)
    return bad_input(fmt::format("--video-fps {} does not divide the servo rate, {} Hz: give a divisor of it", options.fps, scene.servo_hz),
                     scene.file);
  return FilmWriter::create(options);
}

CLI::Option* add_film_options(CLI::App& command, FilmOptions& film) {
  CLI::Option* video =
      command.add_option("--video", film.path, "also draws a film: a folder of frames, or .mp4, .mkv or .webm, which needs ffmpeg")
          ->type_name("PATH");
  command.add_option("--video-fps", film.fps, "frames of the film per second of drilling; divides the servo rate")
      ->check(CLI::Range(1, 1000))
      ->needs("--video")
      ->capture_default_str();
  return video;
}

void add_drill(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "drill", kDrillGroup,
      {.summary = "Drills a scene, in a window or offscreen, and writes pictures, figures and a report",
       .about = "Where there is a display, opens a window in which you drill with mouse, keyboard or game pad (docs/window.md). Without a "
                "display, and with --offscreen, the scene's own hand drills offscreen, in lockstep, and equal scenes give bit-identical "
                "results. Either way it writes into a folder: pictures, the drilled bone, a session that can be replayed, summary.json "
                "with all figures, and report.html. Tables of the scene turn each off but summary.json. With --live the servo, contact "
                "and simulation loops run on threads in real time, as in the window. The session then records the inputs of each step, and "
                "a replay is bit-identical too. Ctrl-C ends the run cleanly and writes the results so far.",
       .examples = {"burrhole drill parietal --out out/parietal", "burrhole drill parietal --offscreen --out out/parietal",
                    "burrhole drill parietal --set tool.spin_rpm=800 --set hand.push_N=35 --out out/harder",
                    "burrhole drill parietal --video out/parietal.mp4", "burrhole drill parietal --live --out out/live",
                    "burrhole drill parietal --json --quiet | jq .drilling",
                    "burrhole drill parietal --offscreen --expect 'through, plunge<1.5mm'"},
       .exits = "Exit 3 if --expect does not hold; 130 after Ctrl-C; 4 if a scene needs pictures and there is no OpenGL, if a video needs "
                "ffmpeg and it is missing or "
                "fails, or if --require-realtime is refused."});
  auto option = std::make_shared<DrillOptions>();
  option->scene.add_to(*command);
  add_stereo_options(*command, option->scene);
  command->add_option("--out", option->files.folder, "folder for the results")->type_name(kFolderValue)->capture_default_str();
  command->add_option("--restore", option->files.restore_path, "start from this checkpoint: the bone.vdb of an earlier run, or its folder")
      ->transform([](const std::string& given) { return bone_of(given); })
      ->type_name(kFileValue);
  command->add_option("--inputs", option->files.inputs, "TOML file of timed inputs: spin, tool, undo, checkpoint, ... (docs/inputs.md)")
      ->type_name(kFileValue);
  add_simd_option(*command);
  add_gl_option(*command, option->files.gl);
  add_shader_option(*command, option->files.shader_folder);
  add_film_options(*command, option->files.film);
  command->add_flag("--live", option->mode.live, "on threads in real time instead of in lockstep");
  command->add_flag("--require-realtime", option->mode.require_realtime, "exit if the system refuses real-time priority (with --live)");
  command->add_flag("--offscreen", option->offscreen, "no window: the scene's own hand drills");
  command->add_flag("--no-pictures", option->scene.no_pictures,
                    "offscreen and without [display]: needs no OpenGL, other results are the same");
  command->add_flag("--force", option->force, "replace results of another scene or of other settings, and frames of a film");
  add_window_options(*command, option->window);
  command->add_option("--expect", option->expect, "exit 3 unless all hold: results, 'no FLAG', FIGURE<VALUE UNIT (burrhole docs outcome)")
      ->type_name("TERMS")
      ->join(',');
  command->add_flag("--json", option->json, "print only summary.json on stdout");
  command->add_flag("--quiet", option->quiet, "no progress and no result on stderr, only warnings and errors");
  command->callback([option, &exit_code] { run_drill(*option, exit_code); });
}

}  // namespace burrhole::cli
