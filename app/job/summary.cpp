#include "app/job/summary.h"

#include <sys/resource.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/hash.h"
#include "core/base/units.h"
#include "core/measure/cross_section.h"
#include "core/measure/layer_loads.h"
#include "core/voxel/label_table.h"

namespace burrhole {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json display_json(const std::optional<RunSummary::Display>& display) {
  if (!display) return nullptr;
  const DrawingQuality& q = display->quality;
  return {{"backend", display->backend},
          {"version", display->version},
          {"renderer", display->renderer},
          {"quality",
           {{"step_voxels", q.step_voxels},
            {"bisections", q.bisections},
            {"finish", q.finish},
            {"supersample", q.supersample},
            {"resolution", q.resolution}}},
          {"budget_ms", optional_number(display->budget_ms)},
          {"expected_ms", optional_number(display->expected_ms)}};
}

Json provenance_json(const std::optional<RunProvenance>& made) {
  if (!made) return nullptr;
  Json factors = Json::object();
  for (const auto& [region, factor] : made->erosion_factors) factors[region] = factor;
  return {{"program", made->program},
          {"date", made->date},
          {"machine", made->machine},
          {"overrides", made->overrides},
          {"tool_overrides", made->tool_overrides},
          {"erosion_factors_per_rev", factors},
          {"drilled_before", made->drilled_before},
          {"scene_place", text_or_null(made->scene_place)},
          {"hash",
           {{"scene", made->scene_hash}, {"tool", made->tool_hash}, {"volume", made->volume_hash ? Json(*made->volume_hash) : Json()}}}};
}

Json live_json(const RunSummary& s) {
  if (!s.live) return nullptr;
  Json out = {{"servo_ticks_missed", s.missed},           {"contact_ticks_missed", s.live->contact_missed},
              {"bone_steps_missed", s.live->bone_missed}, {"rows_not_recorded", s.live->unrecorded},
              {"servo_faults", s.live->faults},           {"force_left_N", s.live->force_left ? Json(*s.live->force_left) : Json()}};
  for (const MissedSteps& clock : s.live->steps) out["steps"][clock.clock] = {{"missed", clock.missed}, {"all", clock.all}};
  return out;
}

const char* end_name(RunEnd end) {
  switch (end) {
    case RunEnd::done:
      return "done";
    case RunEnd::duration:
      return "duration";
    case RunEnd::stopped:
      return "stopped";
  }
  return "";
}

void add_drilling(RunSummary& out, Simulation& simulation) {
  constexpr double kMm = 1e3, kMm3 = 1e9;
  const DrillProgress& progress = simulation.progress();
  const HoleMeasure hole = measure_hole(simulation.voxmap(), simulation.approach());
  const auto in_mm = [&](const std::optional<double>& metres) { return metres ? std::optional(*metres * kMm) : std::nullopt; };
  out.removed_mm3 = hole.removed * kMm3;
  out.removed_mass_mm3 = hole.removed_mass * kMm3;
  out.hole_diameter_mm = in_mm(hole.outer_diameter);
  if (progress.breakthrough_depth) out.inner_diameter_mm = in_mm(hole.inner_diameter);  // no hole in the inner surface before
  out.thickness_mm = simulation.approach().thickness * kMm;
  out.angle_deg = simulation.approach().angle / kDegree;
  out.peak_force_N = simulation.stage().servo->largest_output();
  out.reached_mm = (progress.deepest > -1.0 ? progress.deepest : progress.depth) * kMm;  // an undo may be the last that happens
  out.open_axis = progress.open_axis;
  const Pose world_from_approach = simulation.stage().world_from_approach();
  out.entry_mm = world_from_approach.translation * kMm;
  out.axis = world_from_approach.rotate(Vec3(0.0, 0.0, -1.0));
  out.depth_mm = in_mm(progress.breakthrough_depth);
  out.breakthrough_s = progress.breakthrough_time;
  if (progress.loss) {
    out.support_lost_s = progress.loss->time;
    out.support_lost_mm = progress.loss->depth * kMm;
  }
  if (progress.passed_time || progress.open_axis) out.beyond_mm = std::max(0.0, out.reached_mm - out.thickness_mm);
  if (progress.passed_time) out.plunge_mm = progress.loss ? progress.loss->plunge * kMm : 0.0;
  out.passed_s = progress.passed_time;
  out.tip_out_s = progress.out_time;
  if (progress.passed_time) out.removed_at_passing = progress.removed_at_passing;
  if (progress.largest_ahead > -1.0) out.largest_ahead_mm = progress.largest_ahead * kMm;
}

std::uint64_t count_of(const StepTimer& timer) { return static_cast<std::uint64_t>(timer.timing().count); }

void add_costs(RunSummary& out, Simulation& simulation, const Plan& plan) {
  const std::vector<TimedStep> timings = simulation.timings();
  for (const TimedStep& step : timings) out.timing.emplace_back(step.name, step.timing);
  if (simulation.live()) {
    const LiveReport& live = *simulation.live();
    out.timing.insert(out.timing.end(), {{"servo_late", live.servo_late.timing()}, {"contact_late", live.contact_late.timing()}});
    out.missed = live.servo_skipped;
    out.live = RunSummary::Live{live.contact_skipped,
                                live.bone_skipped,
                                live.unrecorded,
                                {{"servo", live.servo_skipped, live.ticks},
                                 {"contact", live.contact_skipped, live.contact_skipped + count_of(live.contact)},
                                 {"simulation", live.bone_skipped, live.bone_skipped + count_of(live.bone)}},
                                live.faults,
                                simulation.stage().figure("device", "shown_force_N")};
  }
  for (const PlanRow& row : plan.rows) {
    RunSummary::EffectCost cost{row.table, row.step, charged_us(timings, row.table), row.bytes, {}};
    for (const Stage::MadeEffect& made : simulation.stage().effects())
      if (made.table == row.table) made.effect->report(cost.figures);
    out.effects.push_back(std::move(cost));
  }
}

/// Measures the cross-section of the bit, if the scene removes bone.
void add_section(RunSummary& out, Simulation& simulation) {
  if (!simulation.stage().needs.removes) return;
  const DrillProgress& progress = simulation.progress();
  const CrossSection section = leading_section(simulation.stage().tool->erosion);
  out.section_mm2 = section.area() * 1e6;
  out.section_radius_mm = section.radius * 1e3;
  out.section_on_axis = section.on_axis;
  const auto measured = measure_section(simulation.voxmap(), simulation.approach(), section, progress.deepest);
  if (!measured) return;
  out.cleared_share = measured->cleared;
  out.uncut_share = measured->uncut;
}

/// A bit that was pushed through uncut bone, or began above an open hole, plunges from the inner surface on; one that skated off does not plunge.
void add_outcome(RunSummary& out, Simulation& simulation) {
  add_section(out, simulation);
  const auto count = [&](const char* name) { return static_cast<std::uint64_t>(simulation.stage().figure("contact", name).value_or(0.0)); };
  out.contact_degraded = count("degraded");
  out.contact_evaluations = count("evaluations");
  out.contact_flags = simulation.contact_flags();
  out.aside_mm = simulation.progress().largest_aside * 1e3;
  out.latched_faults = fault_warnings(simulation);
  out.brought_back =
      !out.breakthrough_s && std::ranges::find(simulation.events(), "breakthrough", &RunEvent::kind) != simulation.events().end();
  const DrillResult result = outcome_of(out).result;
  if (out.open_axis || result == DrillResult::passed_uncut) out.plunge_mm = out.beyond_mm;
  if (out.bone_moves || (!out.breakthrough_s && result == DrillResult::skated_off)) out.plunge_mm.reset();
}

/// Layers of one label are one row, as the tip may meet a table twice.
void add_layers(RunSummary& out, Simulation& simulation) {
  const std::array<double, 256> removed = removed_by_label(simulation.voxmap());
  const LabelTable table = labels_of(simulation.voxmap().bone().notes());
  std::map<VoxelLabel, std::size_t> rows;
  const auto row_of = [&](VoxelLabel label) -> RunSummary::Layer* {
    const std::string name = label_name(label, table);
    if (name.empty()) return nullptr;
    const auto [found, added] = rows.try_emplace(label, out.layers.size());
    if (added)
      out.layers.push_back({.name = name, .mean_N = {}, .peak_N = {}, .removed_mass_mm3 = 1e9 * removed[static_cast<std::size_t>(label)]});
    return &out.layers[found->second];
  };
  for (const LayerLoad& load : simulation.layer_loads()) {
    RunSummary::Layer* const row = row_of(load.label);
    if (row == nullptr) continue;
    row->thickness_mm += 1e3 * (load.to - load.from);
    row->spans_mm.emplace_back(1e3 * load.from, 1e3 * load.to);
    if (load.time <= 0.0) continue;
    const double before = row->mean_N.value_or(0.0) * row->time_s;
    row->time_s += load.time;
    row->mean_N = (before + load.impulse) / row->time_s;
    row->peak_N = std::max(row->peak_N.value_or(0.0), load.peak);
  }
  for (std::size_t n = 0; n < removed.size(); ++n)
    if (removed[n] > 0.0) (void)row_of(static_cast<VoxelLabel>(n));
}

Json layers_json(const RunSummary& s) {
  Json out = Json::array();
  for (const RunSummary::Layer& layer : s.layers)
    out.push_back({{"name", layer.name},
                   {"thickness_mm", layer.thickness_mm},
                   {"time_s", layer.time_s},
                   {"mean_force_N", optional_number(layer.mean_N)},
                   {"peak_force_N", optional_number(layer.peak_N)},
                   {"removed_mass_mm3", layer.removed_mass_mm3}});
  return out;
}

Json figures_json(const Figures& figures) {
  Json out = Json::object();
  for (const auto& row : figures.rows()) std::visit([&](const auto& value) { out[row.first] = value; }, row.second);
  return out;
}

}  // namespace

std::vector<std::string> fault_warnings(const Simulation& simulation) {
  std::vector<std::string> out;
  for (const RunEvent& event : simulation.events())
    if (event.kind == "fault")
      out.push_back(fmt::format("servo: {} at {:.3f} s: the force on the hand was zero from then on", event.text, event.time));
  return out;
}

RunSummary make_summary(const LoadedScene& loaded, Simulation& simulation, const Plan& plan, double wall_s) {
  RunSummary out;
  out.scene = std::filesystem::path(loaded.scene.file).filename().string();
  out.title = run_title(loaded);
  const Tool& tool = *simulation.stage().tool;
  const Needs& needs = simulation.stage().needs;
  out.tool = tool.name;
  out.spin_rpm = loaded.scene.tool.spin / kRevPerMinute;
  out.push_N = loaded.scene.hand.push;
  out.bench = loaded.scene.feed_hand.has_value();
  out.by_user = loaded.scene.goal_hand.has_value();
  out.bone_moves = simulation.stage().contact->bone_moves();
  for (const std::string& warning : plan.warnings) out.warnings.push_back(without_folders(warning));
  out.limits = loaded.scene.outcome;
  out.end = end_name(simulation.end());
  out.dims = loaded.bone->dims();
  out.spacing_mm = loaded.bone->bone_from_index().mean_edge() / kMillimetre;
  out.bone_voxels = loaded.bone->bone_voxels();
  out.volume_bytes = simulation.voxmap().bytes();
  if (loaded.import) {
    out.volume_format = loaded.import->scan.format;
    for (const std::string& line : loaded.import->scan.assumed) out.assumed.push_back(without_folders(line));
    if (loaded.import->enclosure) out.enclosed_share = loaded.import->enclosure->share;
  } else {
    out.volume_format = "phantom:" + std::string(phantom_name(loaded.scene.volume.phantom->kind));
  }
  out.haptic_points = needs.feels ? tool.shell.size() : 0;
  out.erosion_points = needs.removes ? tool.erosion.size() : 0;
  out.duration_s = simulation.time();
  out.wall_s = wall_s;
  add_drilling(out, simulation);
  add_layers(out, simulation);
  add_costs(out, simulation, plan);
  add_outcome(out, simulation);
  if (const FrameStep* frame = simulation.frame_step()) out.uploaded_texels = frame->texels_sent();
  out.window_copies = simulation.bone_step().window_copies();
  out.points_outside = simulation.bone_step().points_outside();
  out.voxel_hash = hash_text(simulation.voxmap().hash());
  out.force_hash = hash_text(simulation.force_hash());
  if (const auto image = simulation.image_hash()) out.image_hash = hash_text(*image);
  out.peak_bytes = peak_bytes();
  out.predicted_bytes = plan.memory.peak;
  out.bone_file_bytes = loaded.bone->file_bytes();
  return out;
}

std::string summary_json(const RunSummary& s) {
  Json json;
  json["schema"] = kSummarySchema;
  json["scene"] = s.scene;
  json["title"] = s.title;
  json["provenance"] = provenance_json(s.provenance);
  const RunOutcome outcome = outcome_of(s);
  json["result"] = name_of(outcome.result);
  json["reason"] = outcome.reason;
  json["flags"] = flag_names(outcome.flags);
  json["end"] = s.end;
  json["outcome"] = outcome_text(s);
  json["warnings"] = s.warnings;
  json["duration_s"] = s.duration_s;
  json["wall_s"] = s.wall_s;
  json["volume"] = {{"format", s.volume_format},
                    {"dims", {s.dims.x, s.dims.y, s.dims.z}},
                    {"spacing_mm", s.spacing_mm},
                    {"bone_voxels", s.bone_voxels},
                    {"bytes", s.volume_bytes},
                    {"assumed", s.assumed},
                    {"enclosed_share", optional_number(s.enclosed_share)}};
  json["tool"] = {{"name", s.tool},
                  {"spin_rpm", s.spin_rpm},
                  {"push_N", s.push_N},
                  {"haptic_points", s.haptic_points},
                  {"erosion_points", s.erosion_points}};
  json["approach"] = {{"entry_mm", {s.entry_mm.x, s.entry_mm.y, s.entry_mm.z}}, {"axis", {s.axis.x, s.axis.y, s.axis.z}}};
  json["drilling"] = {{"removed_mm3", s.removed_mm3},
                      {"removed_mass_mm3", s.removed_mass_mm3},
                      {"hole_diameter_mm", optional_number(s.hole_diameter_mm)},
                      {"inner_diameter_mm", optional_number(s.inner_diameter_mm)},
                      {"depth_mm", optional_number(s.depth_mm)},
                      {"reached_mm", s.reached_mm},
                      {"thickness_mm", s.thickness_mm},
                      {"axis_open_at_start", s.open_axis},
                      {"breakthrough_s", optional_number(s.breakthrough_s)},
                      {"plunge_mm", optional_number(s.plunge_mm)},
                      {"support_lost_s", optional_number(s.support_lost_s)},
                      {"support_lost_mm", optional_number(s.support_lost_mm)},
                      {"beyond_mm", optional_number(s.beyond_mm)},
                      {"plunge_limit_mm", s.limits.plunge_mm},
                      {"cleared_share", optional_number(s.cleared_share)},
                      {"uncut_share", optional_number(s.uncut_share)},
                      {"aside_mm", s.aside_mm},
                      {"section_mm2", s.section_mm2 > 0.0 ? Json(s.section_mm2) : Json()},
                      {"peak_force_N", s.peak_force_N},
                      {"angle_deg", s.angle_deg},
                      {"passed_s", optional_number(s.passed_s)},
                      {"tip_out_s", optional_number(s.tip_out_s)},
                      {"axis_removed_at_passing", optional_number(s.removed_at_passing)},
                      {"largest_ahead_of_engagement_mm", optional_number(s.largest_ahead_mm)}};
  json["layers"] = layers_json(s);
  for (const auto& [name, t] : s.timing)
    json["timing"][name] = {{"count", t.count}, {"p50_us", t.p50_us}, {"p99_us", t.p99_us}, {"p999_us", t.p999_us}, {"max_us", t.max_us}};
  json["timing"]["missed"] = s.missed;
  json["live"] = live_json(s);
  json["display"] = display_json(s.display);
  json["memory"] = {{"peak_bytes", s.peak_bytes},
                    {"predicted_bytes", s.predicted_bytes},
                    {"bone_file_bytes", s.bone_file_bytes ? Json(*s.bone_file_bytes) : Json(nullptr)}};
  json["effects"] = Json::array();
  for (const RunSummary::EffectCost& effect : s.effects)
    json["effects"].push_back({{"name", effect.name},
                               {"steps", {effect.step}},
                               {"time_us", effect.time_us},
                               {"bytes", effect.bytes},
                               {"figures", figures_json(effect.figures)}});
  json["counters"] = {{"uploaded_texels", s.uploaded_texels},
                      {"window_copies", s.window_copies},
                      {"erosion_points_outside", s.points_outside},
                      {"contact_flags", s.contact_flags}};
  json["hash"] = {{"voxels", s.voxel_hash}, {"forces", s.force_hash}, {"image", text_or_null(s.image_hash)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_json(const LoadedScene& loaded, const Plan& plan, const RunSummary* measured) {
  Json json;
  json["schema"] = kSummarySchema;
  json["scene"] = loaded.scene.file;
  json["effects"] = Json::array();
  for (std::size_t n = 0; n < plan.rows.size(); ++n) {
    const PlanRow& row = plan.rows[n];
    json["effects"].push_back({{"name", row.table},
                               {"steps", {row.step}},
                               {"clock", name_of(row.clock)},
                               {"rate_hz", row.rate_hz > 0.0 ? Json(row.rate_hz) : Json(nullptr)},
                               {"needs", row.needs},
                               {"gives", row.gives},
                               {"detail", row.detail},
                               {"time_us", measured != nullptr ? Json(measured->effects[n].time_us) : Json(nullptr)},
                               {"bytes", row.bytes}});
  }
  json["not_built"] = plan.not_built;
  json["memory"] = {{"predicted_bytes", plan.memory.peak}};
  json["warnings"] = plan.warnings;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace burrhole
