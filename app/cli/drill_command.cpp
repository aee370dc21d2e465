#include <fmt/format.h>

#include <csignal>

#include "app/cli/drilling.h"
#include "app/cli/front.h"
#include "app/cli/progress.h"
#include "app/job/drill_job.h"

namespace burrhole::cli {
namespace {

std::atomic<bool> stop_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void on_signal(int) { stop_flag.store(true, std::memory_order_relaxed); }

void print_figures(const RunSummary& s) {
  const auto mm = [](const std::optional<double>& value) { return value ? fmt::format("{:.2f} mm", *value) : std::string("-"); };
  fmt::print(stderr,
             "thickness {:.2f} mm, breakthrough at {} deep, plunge {}, hole {} outside, {} inside, peak force {:.1f} N, {:.1f} s drilled "
             "in {:.1f} s\n{}\n",
             s.thickness_mm, mm(s.depth_mm), mm(s.plunge_mm), mm(s.hole_diameter_mm), mm(s.inner_diameter_mm), s.peak_force_N, s.duration_s,
             s.wall_s, outcome_text(s));
}

}  // namespace

const std::atomic<bool>& stop_requested() { return stop_flag; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | SA_RESETHAND;  // a second Ctrl-C ends at once
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

Result<RunSummary> drill_scene(const LoadedScene& loaded, const DrillingFiles& files, bool quiet, const LiveAsked& asked) {
  Progress progress(quiet);
  DrillJob job;
  job.folder = files.folder;
  job.restore_path = files.restore_path;
  job.live = asked.live;
  job.require_realtime = asked.require_realtime;
  job.stop = &stop_flag;
  job.warn = [&](const std::string& text) { fmt::print(stderr, "{}: warning: {}\n", loaded.scene.file, text); };
  if (!quiet) job.say = [](const std::string& text) { fmt::print(stderr, "{}\n", text); };
  job.progress = [&](double share, const std::string& text) { progress.show(share, text); };
  job.make_sink = [&](const DisplayConfig& display, const std::string& folder) {
    return make_picture_sink(
        display, {.folder = folder, .gl = files.gl, .shader_folder = files.shader_folder, .tell = [quiet](const std::string& line) {
                    if (!quiet) fmt::print(stderr, "quality: {}\n", line);
                  }});
  };
  if (!files.inputs.empty()) {
    Issues issues;
    auto inputs = load_inputs(files.inputs, loaded.scene, scene_context(), issues);
    if (!inputs) return issues.front();
    job.inputs = std::move(*inputs);
  }
  return drill(loaded, job);
}

void add_drill(CLI::App& app, int& exit_code) {
  struct Options {
    SceneOption scene;
    DrillingFiles files{.folder = "out", .restore_path = {}};
    LiveAsked asked;
    bool json = false, quiet = false, offscreen = false;
  };
  CLI::App* command = add_command(
      app, "drill", kDrillGroup,
      {.summary = "Drills a scene and writes pictures, figures and a report",
       .about = "The main job. Runs the scene offscreen, in lockstep, and leaves in a folder: pictures, the bone as it was left, a "
                "session that can be replayed, summary.json with every figure, and report.html. The same scene gives the same bits. "
                "With --live servo, contact and bone run on threads against the clock, as with a device in the hand; the session then "
                "holds what each step took, and replays to the same bits. Ctrl-C ends the run cleanly with what was done so far.",
       .examples = {"burrhole drill parietal --out out/parietal",
                    "burrhole drill parietal --set tool.spin_rpm=800 --set hand.push_N=35 --out out/harder",
                    "burrhole drill parietal --live --out out/live", "burrhole drill parietal --json --quiet | jq .drilling"},
       .exits = "Exit 130 after Ctrl-C, 4 where a scene asks for pictures and no OpenGL can be had, or --require-realtime is refused."});
  auto option = std::make_shared<Options>();
  option->scene.add_to(*command);
  command->add_option("--out", option->files.folder, "folder for the results")->type_name(kFolderValue)->capture_default_str();
  command->add_option("--restore", option->files.restore_path, "start from this checkpoint: the bone.vdb of an earlier run")
      ->type_name(kFileValue);
  command
      ->add_option(
          "--inputs", option->files.inputs,
          "TOML file of timed inputs: spin, tool, undo, checkpoint, ... (docs/inputs.md)")
      ->type_name(kFileValue);
  add_simd_option(*command);
  add_gl_option(*command, option->files.gl);
  add_shader_option(*command, option->files.shader_folder);
  command->add_flag("--live", option->asked.live, "on threads against the clock instead of in lockstep");
  command->add_flag("--require-realtime", option->asked.require_realtime, "end where the system refuses real-time priority (with --live)");
  command->add_flag("--offscreen", option->offscreen, "no window (this version never opens one)");
  command->add_flag("--json", option->json, "print summary.json on stdout, and nothing else there");
  command->add_flag("--quiet", option->quiet, "no progress on stderr");
  command->callback([option, &exit_code] {
    if (option->asked.require_realtime && !option->asked.live) {
      exit_code = report(bad_input("--require-realtime asks for what only --live needs"));
      return;
    }
    const auto loaded = load_or_report(option->scene, exit_code, option->quiet);
    if (!loaded) return;
    if (!option->quiet)
      for (const std::string& warning : make_plan(*loaded).warnings) fmt::print(stderr, "{}: warning: {}\n", loaded->scene.file, warning);
    catch_signals();
    const auto summary = drill_scene(*loaded, option->files, option->quiet, option->asked);
    if (!summary) {
      exit_code = report(summary.error());
      return;
    }
    if (!option->quiet) print_figures(*summary);
    if (option->json) print(summary_json(*summary));
    exit_code = summary->end == "stopped" ? kInterrupted : kDone;
  });
}

}  // namespace burrhole::cli
