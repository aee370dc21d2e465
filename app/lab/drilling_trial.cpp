#include "app/lab/drilling_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "app/lab/cost_row.h"
#include "app/lab/drilling_partial.h"
#include "app/lab/drilling_wall.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kPlate = 4e-3, kPatch = 5e-3;    // [m] thickness of bone
constexpr double kMargin = 2e-3;                  // [m] of bone beside the hole
constexpr double kAbove = 1.5e-3, kBelow = 1e-3;  // [m] of air in the grid
constexpr double kPast = 0.5e-3;                  // [m] of the widest part beyond the bone, on the bench
constexpr double kFeedFrom = 0.4, kFeedTo = 0.9;  // [-] of the thickness
constexpr double kFeedWindow = 0.2;               // [s]
constexpr double kWallFrom = 0.3, kWallTo = 0.7;  // [-] of the thickness

double thickness_of(DrillingBone bone) { return bone == DrillingBone::patch ? kPatch : kPlate; }
double inset_of(const DrillingBit& bit) { return 0.5 * bit.swept.radius; }
double mm(double metres) { return metres / kMillimetre; }

std::string volume_table(const DrillingBit& bit, DrillingBone bone) {
  const double across = mm(2.0 * (bit.swept.radius + kMargin)), thick = mm(thickness_of(bone));
  const double width = bone == DrillingBone::edge ? across + 2.0 : across;  // a block has air beside it
  std::string out =
      fmt::format("[volume]\nextent_mm = [{:g}, {:g}, {:g}]\nabove_mm = {:g}\n", width, width, thick + mm(kAbove + kBelow), mm(kAbove));
  switch (bone) {
    case DrillingBone::plate:
      return out + fmt::format("source = \"phantom:plate\"\nthickness_mm = {:g}\n", thick);
    case DrillingBone::edge:
      return out + fmt::format("source = \"phantom:block\"\nblock_mm = [{:g}, {:g}, {:g}]\n", across, across, thick);
    case DrillingBone::patch:
      return out + fmt::format("source = \"phantom:skull_patch\"\nthickness_mm = {:g}\n", thick);
  }
  return out;
}

std::string hand_table(const DrillingBit& bit, DrillingBone bone, DrillingHand hand) {
  if (hand == DrillingHand::script) return "[hand]\n";
  const HandScriptConfig script;
  // The rim of the bit meets the curved inner surface deeper than its axis does.
  const double sag = bone == DrillingBone::patch ? 0.5 * bit.swept.radius * bit.swept.radius / PhantomSpec{}.curvature : 0.0;
  return fmt::format("[hand]\nkind = \"feed\"\nfeed_mm_per_s = {:g}\npush_N = {:g}\nstop_mm = {:g}\n", mm(script.feed), script.push,
                     mm(thickness_of(bone) + bit.widest_at + sag + kPast));
}

double closed_form(const DrillingBit& bit, DrillingBone bone) {
  const double thick = thickness_of(bone);
  switch (bone) {
    case DrillingBone::plate:
      return through_plate(bit.swept, thick);
    case DrillingBone::edge:
      return through_edge(bit.swept, thick, inset_of(bit));
    case DrillingBone::patch:
      return through_shell(bit.swept, thick, PhantomSpec{}.curvature);
  }
  return 0.0;
}

/// Mean and ripple of the feed between two depths [m], after `from_s` [s].
void measure_feed(const std::vector<RunSample>& samples, double from_s, double from, double to, DrillingResult& out) {
  std::vector<double> feeds;
  const RunSample* start = nullptr;
  for (const RunSample& sample : samples) {
    if (sample.depth > to) break;
    if (sample.time < from_s || sample.depth < from) continue;
    if (start == nullptr) {
      start = &sample;
    } else if (sample.time - start->time >= kFeedWindow - 1e-9) {
      feeds.push_back(mm(sample.depth - start->depth) / (sample.time - start->time));
      start = &sample;
    }
  }
  if (feeds.size() < 4) return;
  double sum = 0.0;
  for (const double feed : feeds) sum += feed;
  out.feed_mm_s = sum / static_cast<double>(feeds.size());
  out.ripple_percent = 100.0 * (at_share(feeds, 0.95) - at_share(feeds, 0.05)) / out.feed_mm_s;
}

double first_contact(const Simulation& simulation) {
  const auto& events = simulation.events();
  const auto lean = std::ranges::find_if(events, [](const RunEvent& event) { return event.kind == "hand" && event.text == "lean"; });
  return lean == events.end() ? DrillingResult::kNone : lean->time;
}

void measure(const DrillingTrial& trial, const DrillingBit& bit, const LoadedScene& loaded, Simulation& simulation, DrillingResult& out) {
  const RunSummary& s = out.summary;
  const double contact = first_contact(simulation), thick = simulation.approach().thickness;
  const bool crown = bit.swept.bore > 0.0;
  if (const auto& passed = crown ? s.passed_s : s.breakthrough_s) {
    out.drilled_s = *passed - contact;
    if (trial.hand == DrillingHand::script) out.plunge_mm = s.plunge_mm.value_or(DrillingResult::kNone);
  }
  measure_feed(simulation.samples(), contact + loaded.scene.hand.ramp, kFeedFrom * thick, kFeedTo * thick, out);
  if (trial.hand != DrillingHand::bench) return;
  out.volume_mm3 = closed_form(bit, trial.bone) / (kMillimetre * kMillimetre * kMillimetre);
  if (trial.bone == DrillingBone::edge) return;
  if (const auto rough = wall_roughness(simulation.voxmap(), simulation.approach(), {kWallFrom * thick, kWallTo * thick, bit.swept.radius}))
    out.roughness_um = *rough * 1e6;
}

std::string text_of(const DrillingTrial& trial) {
  std::string out = fmt::format("{}, {}, {}", trial.bit, name_of(trial.bone), trial.hand == DrillingHand::bench ? "bench" : "script");
  for (const auto* sets : {&trial.sets, &trial.tool_sets})
    for (const std::string& set : *sets) out += ", " + set;
  return out;
}

Status set_all(TomlDocument& document, const std::vector<std::string>& sets) {
  for (const std::string& assignment : sets)
    if (Status set = document.set(assignment); !set) return set;
  return {};
}

}  // namespace

const char* name_of(DrillingBone bone) noexcept {
  switch (bone) {
    case DrillingBone::plate:
      return "plate";
    case DrillingBone::edge:
      return "block edge";
    case DrillingBone::patch:
      return "skull patch";
  }
  return "";
}

const DrillingBit* bit_of(const DrillingTrial& trial) { return trial.own ? trial.own.get() : find_drilling_bit(trial.bit); }

std::string drilling_scene(const DrillingTrial& trial) {
  const DrillingBit& bit = *bit_of(trial);
  const double across = 2.0 * (bit.swept.radius + kMargin);
  const double aside = trial.bone == DrillingBone::edge ? mm(0.5 * across - inset_of(bit)) : 0.0;
  return "title = \"" + text_of({.bit = trial.bit, .bone = trial.bone, .hand = trial.hand}) + "\"\nduration_s = 90\n" +
         volume_table(bit, trial.bone) +
         fmt::format("[tool]\nname = \"bit\"\nspin_rpm = 1000\n[approach]\nentry_mm = [{:g}, 0, 0]\n", aside) +
         hand_table(bit, trial.bone, trial.hand) + "[contact]\n[erosion]\n";
}

Result<LoadedScene> load_drilling(const DrillingTrial& trial, const std::string& tool_folder) {
  const DrillingBit* bit = bit_of(trial);
  if (bit == nullptr) return bad_input("the drilling study has no bit \"" + trial.bit + "\"; it has " + drilling_bit_names());
  auto tool_text = drilling_bit_text(*bit, tool_folder);
  if (!tool_text) return tool_text.error();
  auto tool = TomlDocument::parse(*tool_text, trial.bit);
  if (!tool) return tool.error();
  if (Status set = set_all(*tool, trial.tool_sets); !set) return set.error();
  auto scene = TomlDocument::parse(drilling_scene(trial), text_of(trial));
  if (!scene) return scene.error();
  if (Status set = set_all(*scene, trial.sets); !set) return set.error();
  LoadOptions options;
  options.tool_text = tool->to_text();
  Issues issues;
  auto loaded = load_scene(*scene, {}, issues, options);
  if (!loaded) return issues.front();
  return std::move(*loaded);
}

Result<DrillingResult> run_drilling(const DrillingTrial& trial, const std::string& tool_folder) {
  const auto loaded = load_drilling(trial, tool_folder);
  if (!loaded) return loaded.error();
  std::vector<double> cpu_us;
  double last = 0.0;
  SimulationOptions options;
  options.progress = [&](double, const DrillProgress&) {
    const double now = cpu_now();
    cpu_us.push_back((now - last) * 1e6);
    last = now;
  };
  Issues issues;
  const auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, options, issues);
  if (!simulation) return issues.front();
  const auto start = std::chrono::steady_clock::now();
  const double cpu = last = cpu_now();
  if (Status ran = simulation->run(); !ran) return ran.error();
  DrillingResult out;
  out.cpu_s = cpu_now() - cpu;
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.summary = make_summary(*loaded, *simulation, make_plan(*loaded), out.wall_s);
  if (!cpu_us.empty()) {
    out.median_us = at_share(cpu_us, 0.5);
    out.p99_us = at_share(cpu_us, 0.99);
  }
  measure(trial, *bit_of(trial), *loaded, *simulation, out);
  return out;
}

Result<std::vector<DrillingResult>> run_drillings(const std::vector<DrillingTrial>& trials, const DrillingRuns& runs) {
  std::vector<std::size_t> unique, place;  // trials that are run, and the position there of each trial
  for (std::size_t n = 0; n < trials.size(); ++n) {
    const auto same = std::ranges::find_if(unique, [&](std::size_t m) { return trials[m] == trials[n]; });
    place.push_back(static_cast<std::size_t>(same - unique.begin()));
    if (same == unique.end()) unique.push_back(n);
  }
  PartialDrillings partial(runs.partial, runs.tool_folder);
  std::vector<std::optional<Result<DrillingResult>>> results(unique.size());
  std::size_t left = 0;
  for (std::size_t n = 0; n < unique.size(); ++n) {
    if (auto earlier = partial.find(trials[unique[n]]))
      results[n] = std::move(*earlier);
    else
      ++left;
  }
  if (runs.say && left < unique.size())
    runs.say(
        fmt::format("{} of {} holes were drilled by an earlier call that was interrupted and are not drilled again (--fresh drills all)",
                    unique.size() - left, unique.size()));
  if (runs.say && left > 1 && !runs.partial.empty())
    runs.say(fmt::format("{} holes to drill; each is kept, so after an interrupt the same command goes on from there", left));
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed{false};
  std::mutex reporting;
  Status kept;
  const auto work = [&] {
    for (std::size_t n = next++; n < unique.size() && !failed; n = next++) {
      if (results[n]) continue;  // of an earlier call
      const DrillingTrial& trial = trials[unique[n]];
      Result<DrillingResult> result = run_drilling(trial, runs.tool_folder);
      if (!result) failed = true;
      const std::scoped_lock lock(reporting);
      if (result && kept) kept = partial.add(trial, *result);
      if (!kept) failed = true;  // the holes so far are in the file; the rest would be lost
      results[n] = std::move(result);
      if (runs.progress) runs.progress(static_cast<double>(++done) / static_cast<double>(left), text_of(trial));
    }
  };
  const std::size_t asked = runs.threads > 0 ? runs.threads : std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (std::size_t n = 1; n < std::min(asked, unique.size()); ++n) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results)
    if (result && !*result) return result->error();
  if (!kept) return kept.error();
  std::vector<DrillingResult> out;
  for (const std::size_t at : place) out.push_back(**results[at]);
  return out;
}

}  // namespace burrhole
