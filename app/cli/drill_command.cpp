#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>

#include "app/cli/drilling.h"
#include "app/cli/front.h"
#include "app/cli/progress.h"
#include "app/engine/realtime.h"
#include "app/engine/simulation.h"
#include "app/report/drill_report.h"
#include "app/report/file.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> stop_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void on_signal(int) { stop_flag.store(true, std::memory_order_relaxed); }

std::string now_iso8601() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string layer_name(VoxelLabel label) {
  switch (label) {
    case VoxelLabel::bone:
      return "bone";
    case VoxelLabel::outer_table:
      return "outer table";
    case VoxelLabel::diploe:
      return "diploe";
    case VoxelLabel::inner_table:
      return "inner table";
    case VoxelLabel::none:
    case VoxelLabel::dura:
    case VoxelLabel::brain:
    case VoxelLabel::forbidden:
      return {};
  }
  return {};
}

std::string caption_of(const std::string& file) {
  const std::string name = fs::path(file).stem().string();
  if (name == "before") return "Before: the bit above the entry point";
  if (name == "during") return "Half way through the bone";
  if (name == "breakthrough") return "Breakthrough, cut open through the axis";
  if (name == "after") return "After: the hole from above";
  if (name == "cutaway") return "Cut open through the axis";
  return name;
}

/// Speed of the tip over a tenth of a second: shorter spans show the servo, not the surgeon.
std::vector<double> speeds(const std::vector<RunSample>& samples, std::size_t span) {
  std::vector<double> out(samples.size(), 0.0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const std::size_t a = n < span / 2 ? 0 : n - span / 2;
    const std::size_t b = std::min(samples.size() - 1, n + span / 2);
    if (b > a) out[n] = (samples[b].depth - samples[a].depth) / (samples[b].time - samples[a].time) * 1e3;
  }
  return out;
}

std::string setting_of(const Scene& scene) {
  std::string out = fmt::format("{:.0f} rpm, {:g} N of thrust", scene.tool.spin / kRevPerMinute, scene.hand.push);
  if (scene.contact) {
    const ContactModelKind model = scene.contact->model;
    out += std::string(", contact ") + (model == ContactModelKind::surface  ? "surface"
                                        : model == ContactModelKind::voxmap ? "voxmap"
                                                                            : "gradient-plane");
  }
  if (scene.erosion) {
    const ErosionConfig& erosion = scene.erosion->config;
    out += std::string(", erosion law ") +
           (erosion.law == ErosionLaw::rate     ? "rate"
            : erosion.law == ErosionLaw::energy ? "energy"
                                                : "per-update") +
           (erosion.subvoxel ? ", sub-voxel" : ", whole voxels");
  }
  return out + ".";
}

DrillReport make_report(const LoadedScene& loaded, Simulation& simulation, const RunSummary& summary,
                        const std::vector<std::string>& pictures) {
  DrillReport r;
  r.title = loaded.scene.title;
  r.scene = loaded.scene.file;
  r.tool = loaded.tool.title;
  for (const RunSample& sample : simulation.samples()) {
    r.time_s.push_back(sample.time);
    r.force_N.push_back(sample.force);
    r.depth_mm.push_back(sample.depth * 1e3);
  }
  const int rate = loaded.scene.contact ? loaded.scene.contact->rate_hz : loaded.scene.servo_hz;
  r.speed_mm_s = speeds(simulation.samples(), static_cast<std::size_t>(std::max(2, rate / 10)));
  for (const Approach::Layer& layer : simulation.approach().layers)
    if (const std::string name = layer_name(layer.label); !name.empty()) r.layers.push_back({name, layer.from * 1e3, layer.to * 1e3});
  for (const RunEvent& event : simulation.events())
    r.events.push_back({event.time, event.kind == "hand" ? "hand: " + event.text : event.kind});
  r.setting = setting_of(loaded.scene);
  for (const std::string& file : pictures) r.pictures.push_back({file, caption_of(file)});
  r.thickness_mm = summary.thickness_mm;
  r.depth_mm_at_breakthrough = summary.depth_mm;
  r.plunge_mm = summary.plunge_mm;
  r.peak_force_N = summary.peak_force_N;
  r.angle_deg = summary.angle_deg;
  r.removed_mm3 = summary.removed_mm3;
  r.removed_mass_mm3 = summary.removed_mass_mm3;
  r.hole_diameter_mm = summary.hole_diameter_mm;
  r.inner_diameter_mm = summary.inner_diameter_mm;
  r.breakthrough_s = summary.breakthrough_s;
  r.outcome = outcome_text(summary);
  r.warnings = summary.warnings;
  r.duration_s = summary.duration_s;
  for (const auto& [name, t] : summary.timing)
    if (t.count > 0) r.timing.push_back({name, t.count, t.p50_us, t.p99_us, t.p999_us, t.max_us});
  r.hashes = {{"voxels", summary.voxel_hash}, {"forces", summary.force_hash}};
  if (!summary.image_hash.empty()) r.hashes.push_back({"image", summary.image_hash});
  return r;
}

/// The session of a run, opened before the first tick; nothing when the scene has no [record] or nothing is written.
Result<std::optional<SessionWriter>> open_session(const LoadedScene& loaded, const DrillingFiles& files, bool live) {
  if (!loaded.scene.record || files.folder.empty()) return std::optional<SessionWriter>();
  SessionMeta meta;
  meta.program = BH_VERSION;
  meta.scene_path = loaded.scene.file;
  meta.scene = loaded.scene.text;
  meta.tool = loaded.tool_text;
  meta.seed = loaded.scene.hand.seed;
  meta.created = now_iso8601();
  const std::string path = (fs::path(files.folder) / loaded.scene.record->path).string();
  const SessionLayout layout = session_layout(loaded.scene, live);
  auto session = SessionWriter::create(path, meta, layout.columns, loaded.scene.servo_hz, layout.streams);
  if (!session) return session.error();
  if (!files.restore_path.empty()) {
    auto checkpoint = read_file(files.restore_path);
    if (!checkpoint) return checkpoint.error();
    if (Status noted = session->event({0.0, 0, "restore", files.restore_path, std::move(checkpoint).value()}); !noted) return noted.error();
  }
  return std::optional<SessionWriter>(std::move(session).value());
}

Status close_session(SessionWriter& session, const RunSummary& summary, std::uint64_t sent_hash) {
  for (const auto& [kind, value] : {std::pair{"voxels", summary.voxel_hash}, std::pair{"forces", summary.force_hash},
                                    std::pair{"sent", fmt::format("{:016x}", sent_hash)}, std::pair{"image", summary.image_hash}})
    if (!value.empty())
      if (Status noted = session.hash({kind, value}); !noted) return noted;
  return session.close();
}

Status make_folder(const std::string& folder) {
  if (folder.empty()) return {};
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    return bad_input("the output folder cannot be made: " + (error ? error.message() : "not a folder"), folder);
  // Ask by doing: permissions of a folder say little for root, on a read-only medium or a full disk.
  const std::string probe = (fs::path(folder) / ".burrhole-probe.tmp").string();
  if (Status written = write_file(probe, ""); !written) return bad_input("the output folder cannot be written to", folder);
  fs::remove(probe, error);
  return {};
}

/// A picture of an earlier run must not pass for one of this run, which may not come as far.
void remove_old_pictures(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  for (const char* name : {"before.png", "during.png", "breakthrough.png", "after.png", "cutaway.png"})
    fs::remove(fs::path(folder) / name, ignored);
}

Status write_results(const LoadedScene& loaded, Simulation& simulation, const RunSummary& summary, const std::vector<std::string>& pictures,
                     const std::string& folder) {
  const auto in_folder = [&](const char* name) { return (fs::path(folder) / name).string(); };
  if (Status saved = simulation.voxmap().save(in_folder("bone.vdb")); !saved) return saved;
  if (Status written = write_file(in_folder("summary.json"), summary_json(summary)); !written) return written;
  return write_drill_report(make_report(loaded, simulation, summary, pictures), in_folder("report.html"));
}

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
  SimulationOptions options;
  options.restore_path = files.restore_path;
  options.stop = &stop_flag;
  options.live = asked.live;
  options.require_realtime = asked.require_realtime;
  options.warn = [](const std::string& text) { fmt::print(stderr, "warning: {}\n", text); };
  // Everything that can refuse is asked before the first file is written.
  if (asked.live && asked.require_realtime)
    if (std::string refused = realtime_refusal(); !refused.empty()) return Error{ErrorCode::unavailable, std::move(refused), {}};
  std::unique_ptr<PictureSink> sink;
  if (loaded.scene.display) {
    auto made = make_picture_sink(
        *loaded.scene.display,
        {.folder = files.folder, .gl = files.gl, .shader_folder = files.shader_folder, .tell = [quiet](const std::string& line) {
           if (!quiet) fmt::print(stderr, "quality: {}\n", line);
         }});
    if (!made) return made.error();
    sink = std::move(made).value();
    options.sink = sink.get();
  }
  Progress progress(quiet);
  double thickness = 1.0;  // [m] known once the approach is
  options.progress = [&](double time, const DrillProgress& p) {
    progress.show(std::max(p.deepest / thickness * 0.95, time / loaded.scene.duration),
                  fmt::format("{:5.1f} s  depth {:6.2f} mm", time, p.depth * 1e3));
  };
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!simulation) return issues.front();
  thickness = simulation->approach().thickness;
  if (sink && !quiet) fmt::print(stderr, "pictures by {}\n", sink->driver());
  if (simulation->approach().from_inside && !quiet)
    fmt::print(stderr, "{}: warning: the axis points out of the skull: brain or dura lies before the entry\n", loaded.scene.file);
  if (Status made = make_folder(files.folder); !made) return made.error();
  remove_old_pictures(files.folder);
  auto session = open_session(loaded, files, asked.live);
  if (!session) return session.error();
  if (*session) simulation->set_session(&**session);

  const auto start = std::chrono::steady_clock::now();
  if (Status ran = simulation->run(); !ran) return ran.error();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RunSummary summary = make_summary(loaded, *simulation, make_plan(loaded), wall);
  if (sink) summary.display = sink->display();
  if (*session)
    if (Status closed = close_session(**session, summary, simulation->sent_hash()); !closed) return closed.error();
  if (!files.folder.empty())
    if (Status written = write_results(loaded, *simulation, summary, sink ? sink->files() : std::vector<std::string>(), files.folder);
        !written)
      return written.error();
  return summary;
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
