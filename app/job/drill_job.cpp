#include "app/job/drill_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <tuple>

#include "app/job/bone_exports.h"
#include "app/job/folder_lock.h"
#include "app/job/run_folder.h"
#include "app/report/drill_report.h"
#include "app/report/file.h"
#include "app/report/tip_speed.h"
#include "app/stage/result_files.h"
#include "app/view/driver_text.h"
#include "core/base/cpu_model.h"
#include "core/base/hash.h"
#include "core/base/physics_version.h"
#include "core/base/units.h"
#include "core/measure/approach_check.h"
#include "haptics/servo/realtime.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

std::string now_iso8601() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// The pictures of a run, by the names that RunLog and Simulation give them.
struct Caption {
  const char *name, *text;
};
constexpr Caption kCaptions[] = {
    {"overview", "Before: the whole body and the bit"},
    {"before", "Before: the bit above the entry point"},
    {"during", "At half the thickness of the bone"},
    {"breakthrough", "Breakthrough: bone and bit in section through the axis; the part of the bit that cuts is orange, the rest grey"},
    {"after", "After: the hole from above"},
    {"cutaway", "After: section through the axis"}};
constexpr const char* kOpenAxis =
    "no bone is on the axis at the start: it was drilled through before; the figures are those of this run alone";

/// @param through the bone is drilled through. @param removed_mm3 of it.
std::string caption_of(const std::string& file, bool through, double removed_mm3) {
  const std::string name = fs::path(file).stem().string();
  if (name == "after" && !through)
    return removed_mm3 > 0.0 ? "After: the cut from above; it does not go through" : "After: the bone from above; nothing was cut";
  const auto found = std::ranges::find(kCaptions, name, &Caption::name);
  return found != std::end(kCaptions) ? found->text : name;
}

std::string setting_of(const Scene& scene, bool by_user) {
  std::string out = fmt::format("{:.0f} rpm, ", scene.tool.spin / kRevPerMinute);
  if (scene.feed_hand && !scene.feed_hand->push)
    out += fmt::format("{:g} mm/s of feed", scene.feed_hand->feed / kMillimetre);
  else if (scene.goal_hand)
    out += fmt::format("a user's hand of at most {:g} N", scene.hand.push);
  else
    out += fmt::format("{:g} N of thrust{}", scene.hand.push, by_user ? " until a user took the drill over" : "");
  for (const EffectPlans::Item& item : scene.effects.items())
    if (const std::string setting = item.plan->setting(); !setting.empty()) out += ", " + setting;
  return out + ".";
}

std::vector<DrillReport::Made> made_rows(const RunProvenance& made) {
  const auto listed = [](const std::vector<std::string>& texts) {
    return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
  };
  std::vector<DrillReport::Made> out{{"Program", made.program},
                                     {"Date", made.date},
                                     {"Machine", made.machine},
                                     {"Overrides of the scene", listed(made.overrides)},
                                     {"Overrides of the tool", listed(made.tool_overrides)}};
  for (const auto& [region, factor] : made.erosion_factors)
    out.push_back({"Erosion factor of the " + region, fmt::format("{:.4g} per revolution", factor)});
  out.push_back({"Hash of the scene", made.scene_hash});
  out.push_back({"Hash of the tool", made.tool_hash});
  if (made.volume_hash) out.push_back({"Hash of the volume", *made.volume_hash});
  return out;
}

DrillReport make_report(const LoadedScene& loaded, Simulation& simulation, const RunSummary& summary,
                        const std::vector<std::string>& pictures) {
  DrillReport r;
  r.title = summary.title;
  r.scene = summary.scene;
  if (summary.provenance) r.made = made_rows(*summary.provenance);
  for (const RunSample& sample : simulation.samples()) {  // none are kept with plots off
    r.time_s.push_back(sample.time);
    r.force_N.push_back(sample.force);
    r.depth_mm.push_back(sample.depth * 1e3);
  }
  const auto rate = static_cast<int>(1.0 / simulation.stage().contact_period + 0.5);
  r.speed_mm_s = tip_speed(r.time_s, r.depth_mm, static_cast<std::size_t>(std::max(2, rate / 10)));
  for (const RunSummary::Layer& layer : summary.layers) {
    for (const auto& [from, to] : layer.spans_mm) r.layers.push_back({layer.name, from, to});
    r.layer_rows.push_back({layer.name, layer.thickness_mm, layer.time_s, layer.mean_N, layer.peak_N, layer.removed_mass_mm3});
  }
  std::ranges::sort(r.layers, {}, &DrillReport::Layer::from_mm);
  constexpr std::string_view kExplained[] = {"breakthrough", "passed", "refused", kUnrecordedEvent};  // whose texts are long
  for (const RunEvent& event : simulation.events()) {
    const bool alone = event.text.empty() || std::ranges::find(kExplained, event.kind) != std::end(kExplained);
    r.events.push_back({event.time, alone ? event.kind : event.kind + ": " + event.text});
  }
  r.setting = setting_of(loaded.scene, summary.by_user);
  r.thickness_mm = summary.thickness_mm;
  r.depth_mm_at_breakthrough = summary.depth_mm;
  r.plunge_mm = summary.plunge_mm;
  r.beyond_mm = summary.beyond_mm;
  r.peak_force_N = summary.peak_force_N;
  r.angle_deg = summary.angle_deg;
  r.removed_mm3 = summary.removed_mm3;
  r.removed_mass_mm3 = summary.removed_mass_mm3;
  r.hole_diameter_mm = summary.hole_diameter_mm;
  r.inner_diameter_mm = summary.inner_diameter_mm;
  r.breakthrough_s = summary.breakthrough_s;
  r.tip_out_s = summary.tip_out_s;
  r.support_lost_s = summary.support_lost_s;
  const RunOutcome outcome = outcome_of(summary);
  r.result = name_of(outcome.result);
  r.reason = outcome.reason;
  r.flags = flag_names(outcome.flags);
  r.through = outcome.result == DrillResult::drilled_through;
  for (const std::string& file : pictures) r.pictures.push_back({file, caption_of(file, r.through, summary.removed_mm3)});
  for (const Stage::MadeEffect& made : simulation.stage().effects()) {
    std::vector<ValueMap> maps = made.effect->maps();
    std::ranges::move(maps, std::back_inserter(r.maps));
  }
  r.outcome = outcome_text(summary);
  r.plunge_limit_mm = summary.limits.plunge_mm;
  if (summary.cleared_share) r.cleared_percent = 100.0 * *summary.cleared_share;
  r.warnings = summary.warnings;
  r.duration_s = summary.duration_s;
  for (const auto& [name, t] : summary.timing)
    if (t.count > 0) r.timing.push_back({name, t.count, t.p50_us, t.p99_us, t.p999_us, t.max_us});
  if (summary.live)
    for (const MissedSteps& clock : summary.live->steps) r.missed.push_back({clock.clock, clock.missed, clock.all});
  r.hashes = {{"voxels", summary.voxel_hash}, {"forces", summary.force_hash}};
  if (!summary.image_hash.empty()) r.hashes.push_back({"image", summary.image_hash});
  return r;
}

std::string date_of(const DrillJob& job) { return job.created.empty() ? now_iso8601() : job.created; }

/// A file that a session holds, as an event of its kind. Its folder may name a patient, and a replay reads the session alone.
struct SessionFile {
  const char* kind;
  std::string name, text;
};

/// Reads them before the first file of the run, which may move one of them aside.
Result<std::vector<SessionFile>> read_session_files(const LoadedScene& loaded, const DrillJob& job, const Stage& stage) {
  std::vector<SessionFile> out;
  if (!stage.record_path()) return out;
  for (const auto& [kind, path, limit] :
       {std::tuple{"restore", job.restore_path, kCheckpointInput}, std::tuple{"markups", loaded.scene.approach.markups, kMarkupsInput}}) {
    if (path.empty()) continue;
    auto text = read_file(path, limit);
    if (!text) return text.error();
    out.push_back({kind, fs::path(path).filename().string(), std::move(text).value()});
  }
  return out;
}

/// Creates the session of a run, before the first tick. @returns nothing if the scene has no [record] or there is no output folder.
Result<std::optional<SessionWriter>> open_session(const LoadedScene& loaded, const DrillJob& job, const Stage& stage,
                                                  const PictureSink* sink, const std::vector<SessionFile>& files) {
  if (!stage.record_path() || job.folder.empty()) return std::optional<SessionWriter>();
  SessionMeta meta;
  meta.program = BH_VERSION;
  // A replay needs the folder where a scan is named relative to it.
  meta.scene_path = loaded.scene.volume.scan ? loaded.scene.file : fs::path(loaded.scene.file).filename().string();
  meta.scene = loaded.scene.text;
  meta.tool = loaded.tool_text;
  meta.seed = loaded.scene.hand.seed;
  meta.physics_version = kPhysicsVersion;
  meta.cpu = cpu_model();
  if (sink != nullptr) meta.renderer = sink->driver();
  meta.created = date_of(job);
  const std::string path = (fs::path(job.folder) / *stage.record_path()).string();
  auto session = SessionWriter::create(path, meta, session_layout(stage));
  if (!session) return session.error();
  for (const SessionFile& file : files)
    if (Status noted = session->event({0.0, 0, file.kind, file.name, file.text}); !noted) return noted.error();
  return std::optional<SessionWriter>(std::move(session).value());
}

RunProvenance provenance_of(const LoadedScene& loaded, const DrillJob& job, bool drilled_before) {
  RunProvenance out = burrhole::provenance_of(loaded, date_of(job), drilled_before);
  if (!job.folder.empty()) out.scene_place = place_of_scene(loaded.scene.file, job.folder, job.shipped_scenes);
  return out;
}

/// @returns a line on a breakthrough that an undo, a reset or a restore took back: it happened, and the figures of the hole do not show it.
std::optional<std::string> undone_warning(const Simulation& simulation, const RunSummary& summary) {
  if (summary.breakthrough_s) return std::nullopt;
  const auto& events = simulation.events();
  const auto first = std::ranges::find(events, "breakthrough", &RunEvent::kind);
  if (first == events.end()) return std::nullopt;
  return fmt::format("the bone was drilled through at {:.3f} s before bone was brought back; the tip came {:.2f} mm beyond the bone",
                     first->time, std::max(0.0, simulation.progress().undone * 1e3 - summary.thickness_mm));
}

/// @returns the hash of the bone as loaded, of one that is read from a file: a replay reads it again.
std::string volume_of(const RunSummary& summary) {
  const bool read = !summary.volume_format.starts_with("phantom:");
  return read && summary.provenance ? summary.provenance->volume_hash.value_or("") : std::string();
}

Status close_session(SessionWriter& session, const RunSummary& summary, const Simulation& simulation) {
  for (const auto& [kind, value] : {std::pair{"voxels", summary.voxel_hash}, std::pair{"forces", summary.force_hash},
                                    std::pair{"sent", hash_text(simulation.sent_hash())}, std::pair{"image", summary.image_hash},
                                    std::pair{"sound", simulation.sound_hash()}, std::pair{"volume", volume_of(summary)}})
    if (!value.empty())
      if (Status noted = session.hash({kind, value}); !noted) return noted;
  return session.close();
}

/// @returns how results of an earlier run are set aside.
EarlierResultsConfig earlier_results_of(const LoadedScene& loaded, const DrillJob& job, const Stage& stage) {
  EarlierResultsConfig out{.folder = job.folder, .session = stage.record_path(), .inputs = {}, .writes_bone = loaded.scene.output.bone};
  if (!job.restore_path.empty()) out.inputs.push_back(job.restore_path);
  if (const auto& scan = loaded.scene.volume.scan) out.inputs.push_back(scan->request.path);
  return out;
}

/// The output folder while a run has it. The lock is given back last.
struct Outputs {
  FolderLock lock;
  EarlierResults earlier;
  std::optional<SessionWriter> session;
};

/// Takes the folder and opens what is written while the run goes on. After an error the results of an earlier run are as they were.
Result<Outputs> open_outputs(const LoadedScene& loaded, const DrillJob& job, const Stage& stage, const PictureSink* sink, SoundOut& sound) {
  if (Status kept = check_source(loaded, job.folder); !kept) return kept.error();
  if (is_set(job.stop)) return Error{ErrorCode::unavailable, kNeverBegan, {}};
  auto lock = take_output_folder(job.folder);
  if (!lock) return lock.error();
  const auto files = read_session_files(loaded, job, stage);
  if (!files) return files.error();
  auto earlier = EarlierResults::set_aside(earlier_results_of(loaded, job, stage));
  if (!earlier) return earlier.error();
  if (Status opened = sound.open(); !opened) return opened.error();
  auto session = open_session(loaded, job, stage, sink, *files);
  if (!session) return session.error();
  if (Status dropped = earlier->drop(); !dropped) return dropped.error();
  return Outputs{std::move(lock).value(), std::move(earlier).value(), std::move(session).value()};
}

Status write_results(const LoadedScene& loaded, Simulation& simulation, const RunSummary& summary, const std::vector<std::string>& pictures,
                     const std::string& folder) {
  const auto in_folder = [&](const char* name) { return (fs::path(folder) / name).string(); };
  const OutputScene& output = loaded.scene.output;
  // Of a bone in a temporary file only the changes can be saved.
  const SavedBone saves = output.whole_bone && !loaded.bone->file_bytes() ? SavedBone::whole : SavedBone::changes;
  if (output.bone)
    if (Status saved = simulation.voxmap().save(in_folder(kBoneFile), saves); !saved) return saved;
  if (Status written = write_file(in_folder(kSummaryFile), summary_json(summary)); !written) return written;
  if (!output.report) return {};
  return write_drill_report(make_report(loaded, simulation, summary, pictures), in_folder(kReportFile));
}

/// Warns of what was found after a run. An open axis and latched faults were warned of when they appeared.
void add_warnings(const DrillJob& job, const std::vector<std::string>& found, RunSummary& summary) {
  for (const std::string& line : found) {
    if (job.warn) job.warn(line);
    summary.warnings.push_back(without_folders(line));
  }
  if (summary.open_axis) summary.warnings.emplace_back(kOpenAxis);
  std::ranges::copy(summary.latched_faults, std::back_inserter(summary.warnings));
}

BoneExports::Config exports_of(const LoadedScene& loaded, const DrillJob& job) {
  return {job.folder, loaded.bone, [&job](const std::string& line, bool failed) {
            if (job.user != nullptr)
              job.user->hear(line, failed);
            else if (job.say && !failed)  // an error is the run's
              job.say(line);
          }};
}

/// @returns the line on a run that an error ended.
std::string early_end(const Simulation& simulation, const Error& error) {
  return without_folders(fmt::format("an error ended the run at {:.3f} s: {}", simulation.time(), error.text()));
}

}  // namespace

InputTools tools_of(const std::vector<Input>& inputs) {
  InputTools out{.inputs = !inputs.empty(), .texts = {}};
  for (const Input& input : inputs)
    if (input.kind == InputKind::tool && std::ranges::find(out.texts, input.text, &ToolText::name) == out.texts.end())
      out.texts.push_back({input.text, input.data});
  return out;
}

std::optional<std::vector<Input>> load_inputs(const std::string& path, const Scene& scene, const SceneContext& context, Issues& issues) {
  const auto document = TomlDocument::load(path);
  if (!document) {
    issues.push_back(document.error());
    return std::nullopt;
  }
  auto inputs = read_inputs(*document, scene.servo_hz, issues);
  if (!inputs) return std::nullopt;
  for (Input& input : *inputs) {
    if (input.kind != InputKind::tool) continue;
    auto text = read_tool_text(input.text, scene.file, context);
    if (text)
      input.data = std::move(text).value();
    else
      issues.push_back(bad_input(text.error().message, path));
  }
  if (!issues.empty()) return std::nullopt;
  return inputs;
}

Result<RunSummary> drill(const LoadedScene& loaded, const DrillJob& job) {
  SimulationOptions options;
  options.restore_path = job.restore_path;
  options.stop = job.stop;
  options.live = job.live;
  options.require_realtime = job.require_realtime;
  options.warn = job.warn;
  options.inputs = job.inputs;
  options.user = job.user;
  options.history = !job.inputs.empty() || job.user != nullptr;
  options.film_hz = job.film_hz;
  options.samples = !job.folder.empty() && loaded.scene.output.report && loaded.scene.output.plots;
  if (job.live && job.require_realtime)
    if (std::string refused = realtime_refusal(); !refused.empty()) return Error{ErrorCode::unavailable, std::move(refused), {}};
  Issues issues;  // of the tools that the inputs name, which would otherwise end the run when they are applied
  InputTools input_tools = tools_of(job.inputs);
  input_tools.inputs = options.history;
  const Plan plan = make_run_plan(loaded, job.live, input_tools, issues);
  if (!issues.empty()) return issues.front();
  if (job.warn)
    for (std::size_t n = plan.scene_warnings; n < plan.warnings.size(); ++n) job.warn(plan.warnings[n]);
  std::unique_ptr<PictureSink> sink;
  if (const auto* display = loaded.scene.find<DisplayConfig>(); display != nullptr && job.make_sink) {
    auto made = job.make_sink(*display, job.folder);
    if (!made) return made.error();
    sink = std::move(made).value();
    options.sink = sink.get();
  }
  BoneExports exports(exports_of(loaded, job));
  options.export_bone = [&](const Voxmap& bone, double time, const std::string& format) { return exports.begin(bone, time, format); };
  SoundOut sound(loaded.scene.find<SoundConfig>(), job.folder, job.make_speaker);
  options.sound = sound.sink();
  double thickness = 1.0;  // [m] set when the simulation exists
  std::unique_ptr<Simulation> simulation;
  options.progress = [&](double time, const DrillProgress& p) {
    if (job.watch && !job.live) job.watch(*simulation);
    if (job.progress) job.progress(std::max(p.deepest / thickness * 0.95, time / loaded.scene.duration), progress_text(time, p.depth));
  };
  simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!simulation) return issues.front();
  thickness = simulation->approach().thickness;
  if (sink && job.say) job.say(driver_text(sink->driver()));
  if (simulation->progress().open_axis && job.warn) job.warn(kOpenAxis);
  if (const auto wrong = leaves_skull(*loaded.bone, simulation->approach()); wrong && job.warn) job.warn(*wrong);
  auto outputs = open_outputs(loaded, job, simulation->stage(), sink.get(), sound);
  if (!outputs) return outputs.error();
  if (outputs->session) simulation->set_session(&*outputs->session);
  if (job.begin) job.begin(*simulation);
  RunProvenance made = provenance_of(loaded, job, simulation->voxmap().starts_drilled());
  const auto start = std::chrono::steady_clock::now();
  const Status ran = simulation->run();
  // A run that an error ends has results too, unless bone could not be read: those of minutes are not lost for one picture.
  if (!ran && (simulation->time() == 0.0 || !simulation->voxmap().bone().read_status())) return ran.error();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Status sounded = sound.finish(), exported = exports.finish();
  RunSummary summary = make_summary(loaded, *simulation, plan, wall);
  summary.provenance = std::move(made);
  summary.by_user = summary.by_user || (job.user != nullptr && job.user->took_over());
  std::vector<std::string> found;
  simulation->stage().warn(found);
  if (const auto left = simulation->inputs_left(); !left.empty() && job.user == nullptr)
    found.push_back(fmt::format("the run ended at {:.3f} s, before {} of {} inputs; the next was due at {:.3f} s", simulation->time(),
                                left.size(), job.inputs.size(), static_cast<double>(left.front().tick) / loaded.scene.servo_hz));
  if (auto undone = undone_warning(*simulation, summary)) found.push_back(std::move(*undone));
  std::ranges::move(outcome_warnings(summary), std::back_inserter(found));
  add_warnings(job, found, summary);
  if (!ran) summary.warnings.push_back(early_end(*simulation, ran.error()));  // the caller reports the error itself
  if (sink) summary.display = sink->display();
  Status closed;
  if (outputs->session) closed = ran ? close_session(*outputs->session, summary, *simulation) : outputs->session->close();
  auto pictures = sink ? sink->files() : std::vector<std::string>();
  Status written;
  if (!job.folder.empty())
    written = write_results(loaded, *simulation, summary, pictures ? *pictures : std::vector<std::string>(), job.folder);
  if (ran && written) outputs->earlier.replaced();
  for (const Status& done : {ran, closed, pictures ? Status() : Status(pictures.error()), written, sounded, exported})
    if (!done) return done.error();
  return summary;
}

}  // namespace burrhole
