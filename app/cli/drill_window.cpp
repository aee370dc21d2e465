#include "app/cli/drill_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/audio/speaker.h"
#include "app/cli/recorded_scene.h"
#include "app/cli/scene_bar.h"
#include "app/render/renderer.h"
#include "app/run/live_replay.h"
#include "app/session/recorded_hand.h"
#include "app/window/session_view.h"
#include "app/window/text_scale.h"
#include "app/window/window_run.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsersHand = R"(hand={kind="mouse"})";
constexpr const char* kUsersTime = "duration_s=3600";  // a person ends the run; a session holds an hour

/// @returns why a scene does not open a window by itself; empty: it does. Reads the kind of its hand, and the push of a script.
std::string why_not(const TomlDocument& document, std::string& kind, double& push) {
  Issues ignored;
  TableReader root = document.root(ignored);
  if (!root.has("display")) return "the scene has no [display]";
  if (root.has("device")) return "the scene has a [device]";
  auto hand = root.table("hand", "");
  kind = hand ? hand->text("kind", "script", "") : "script";
  if (kind != "script" && kind != "mouse" && kind != "feed") return "hand.kind is \"" + kind + "\"";
  if (hand && kind == "script") push = hand->number("push_N", {.fallback = HandConfig{}.push}, "");
  return {};
}

/// The scene's tool first, then the shipped ones in the order of their names.
std::vector<ToolText> tools_for(const LoadedScene& loaded) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(share_folder()) / "tools", ignored))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  std::erase(names, loaded.tool.name);
  std::vector<ToolText> out{{loaded.tool.name, loaded.tool_text}};
  for (const std::string& name : names)
    if (auto text = read_tool_text(name, loaded.scene.file, scene_context())) out.push_back({name, std::move(text).value()});
  return out;
}

MakeWindowSink sink_maker(const std::string& shader_folder, const Scene& scene) {
  return [shader_folder, bar = bar_of(scene)](const DisplayConfig& display, const std::string& folder,
                                              GlContext context) -> Result<WindowSinkParts> {
    auto made = make_window_sink(display, {.folder = folder, .shader_folder = shader_folder, .bar = bar}, std::move(context));
    if (!made) return made.error();
    return WindowSinkParts{std::move(made->sink), made->renderer};
  };
}

ViewerConfig viewer_config(const WindowOptions& options, const std::string& folder) {
  ViewerConfig out;
  out.light = options.light;
  out.text_scale = options.text_scale;
  out.folder = folder;
  return out;
}

}  // namespace

void add_view_options(CLI::App& command, WindowOptions& options) {
  command.add_flag("--light", options.light, "a window with dark letters on a light ground");
  command.add_option("--text-scale", options.text_scale, "size of the window's letters")
      ->check(number_in(kSmallestText, kLargestText))
      ->capture_default_str();
}

void add_window_options(CLI::App& command, WindowOptions& options) {
  command.add_flag("--window", options.asked, "in a window, or not at all; by default a window opens where there is a display");
  command.add_flag("--demo", options.demonstration, "the scene's own hand drills; in the window for up to an hour, until you take over");
  add_view_options(command, options);
}

Result<bool> prepare_window(WindowOptions& options, SceneOption& scene, bool quiet) {
  if (!has_display()) {
    if (options.asked)
      return Error{ErrorCode::unavailable,
                   "there is no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set; --offscreen drills without one",
                   {}};
    return false;
  }
  const auto document = scene.document();
  if (!document) return document.error();
  std::string kind;
  if (const std::string why = why_not(*document, kind, options.reference_push); !why.empty()) {
    if (options.asked) return bad_input("no window: " + why, document->file_name());
    if (!quiet) note(fmt::format("no window: {}\n", why));
    return false;
  }
  const auto is_set = [&](const char* key) {
    return std::ranges::any_of(scene.sets, [&](const std::string& set) { return set.starts_with(key); });
  };
  if (options.demonstration && kind != "script")
    return bad_input(fmt::format("--demo needs a script, and hand.kind is \"{}\": leave --demo out{}", kind,
                                 kind == "mouse" ? ", or --set hand.kind=script" : ""),
                     document->file_name());
  if (kind != "mouse" && !options.demonstration)
    scene.sets.insert(scene.sets.begin(), kUsersHand);  // else the scene has a person's hand already
  if (!is_set("duration_s")) scene.sets.emplace_back(kUsersTime);
  return true;
}

Result<RunSummary> drill_scene_in_window(const LoadedScene& loaded, const WindowOptions& options, const DrillingFiles& files, bool quiet) {
  WindowRun run;
  run.job.folder = files.folder;
  run.job.restore_path = files.restore_path;
  run.job.shipped_scenes = shipped_folder("scenes");
  run.job.stop = &stop_requested();
  run.job.warn = [&](const std::string& text) { print_warning(loaded.scene.file, text); };
  if (!quiet) run.job.say = print_line;
  if (loaded.scene.find<SoundConfig>() != nullptr) Speaker::silence_libraries();
  run.job.make_speaker = [&](int sample_rate) -> std::unique_ptr<SoundSink> {
    auto speaker = Speaker::open(sample_rate, [quiet](std::uint64_t underruns, std::uint64_t dropped) {
      if (!quiet) note(fmt::format("sound: {} underruns, {} blocks dropped\n", underruns, dropped));
    });
    if (speaker) return std::move(speaker).value();
    print_warning(loaded.scene.file, "[sound] is not heard: " + speaker.error().message);
    return nullptr;
  };
  run.make_sink = sink_maker(files.shader_folder, loaded.scene);
  run.start.tools = tools_for(loaded);
  run.start.tool = loaded.tool.name;
  run.start.reference_push = options.reference_push;
  run.start.demonstration = options.demonstration;
  if (!quiet)
    run.figures = [](const WindowFigures& f) {
      constexpr double kMs = 1e3;
      note(fmt::format(
          "window: {:.0f} pictures a second while the drill ran, {:.0f} while the view turned; a picture {:.0f} ms (p95 {:.0f}), from "
          "input to picture {:.0f} ms (p95 {:.0f}), refined {:.0f} ms (p95 {:.0f}) after the last change\n",
          f.drilling.per_second(), f.turning.per_second(), kMs * f.picture.at(0.5), kMs * f.picture.at(0.95), kMs * f.latency.at(0.5),
          kMs * f.latency.at(0.95), kMs * f.refined.at(0.5), kMs * f.refined.at(0.95)));
    };
  run.viewer = viewer_config(options, files.folder);
  return drill_in_window(loaded, std::move(run));
}

Result<ViewedSession> view_session_in_window(const std::string& path, const WindowOptions& options, bool quiet) {
  if (!has_display())
    return Error{ErrorCode::unavailable,
                 "there is no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set; leave --view out to replay without one",
                 {}};
  auto session = SessionReader::open(path);
  if (!session) return session.error();
  if (lacks_rows(*session)) return ViewedSession::lacking_rows;
  if (!has_order(*session))
    return bad_input("a session of schema 1 cannot be shown: it has no order of steps; leave --view out to replay it", path);
  auto hand = RecordedHand::create(*session);
  if (!hand) return Error{hand.error().code, hand.error().message, path};
  if (hand->ticks() == 0) return bad_input("the session has no motion to show: record a longer run", path);
  auto loaded = load_recorded(*session, hand->ticks(), true);
  if (!loaded) return loaded.error();
  if (loaded->scene.find<DisplayConfig>() == nullptr)
    return bad_input("the session's scene has no [display], so there is nothing to show: leave --view out to replay it", path);
  RecordedFile checkpoint;
  if (Status written = checkpoint.write(*session, "restore"); !written) return written.error();
  SessionView view;
  view.restore_path = checkpoint.path();
  view.make_sink = sink_maker({}, loaded->scene);
  view.viewer = viewer_config(options, fs::absolute(path).parent_path().string());
  view.stop = &stop_requested();
  if (!quiet) view.say = print_line;
  if (const std::string changed = changed_bone(*session, *loaded); !changed.empty()) print_line(changed);
  const auto viewed = view_session(*session, *loaded, view);
  if (!viewed) return viewed.error();
  const auto is_compared = [](const SessionHash& hash) { return hash.kind == "voxels" || hash.kind == "forces" || hash.kind == "sent"; };
  if (std::ranges::none_of(session->hashes(), is_compared)) return ViewedSession::without_results;
  if (viewed->same) return ViewedSession::shown;
  print_line(path + ": bone or forces differ from those of the run");
  if (const std::string why = why_different(session->meta()); !why.empty()) print_line(why);
  return ViewedSession::different;
}

}  // namespace burrhole::cli
