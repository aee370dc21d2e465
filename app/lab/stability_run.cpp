#include "app/lab/stability_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <thread>

#include "app/lab/stability_rig.h"
#include "app/report/decimate.h"
#include "core/base/units.h"
#include "core/config/toml.h"

namespace burrhole {
namespace {

constexpr std::size_t kPart = 100'000;  // [samples] a long run is evaluated in parts of this length
constexpr std::size_t kBuckets = 300;   // of a picture

std::uint64_t ticks_of(const StabilityCase& of, double period) {
  return of.ticks > 0 ? of.ticks : static_cast<std::uint64_t>(std::llround(of.duration / period));
}

/// Runs to the end. `judge` is called with each part of the run.
Status run_parts(StabilityRig& rig, const StabilityCase& of, std::size_t part, const std::function<void(const StabilityTrace&)>& judge) {
  StabilityTrace trace{.period = rig.period(), .samples = {}};
  const std::uint64_t ticks = ticks_of(of, rig.period());
  trace.samples.reserve(std::min<std::size_t>(ticks, part));
  for (std::uint64_t n = 0; n < ticks; ++n) {
    rig.tick(trace.samples);
    if (trace.samples.size() < part && n + 1 < ticks) continue;
    judge(trace);
    trace.samples.clear();
  }
  return {};
}

std::vector<StabilityCheck> checks_for(const StabilityCase& of, const StabilityModel& model) {
  std::vector<StabilityCheck> out;
  for (const StabilityCheck& check : of.checks)
    if (check.models == ForModels::all || model.constrained) out.push_back(check);
  return out;
}

/// Whether any tick of this part is in the span of the check.
bool touches(const StabilityTrace& trace, const TimeSpan& span) {
  return std::any_of(trace.samples.begin(), trace.samples.end(), [&](const StabilitySample& s) { return span.holds(s.time); });
}

void draw(const StabilityTrace& trace, StabilityOutcome& out) {
  std::vector<double> time, force;
  for (const StabilitySample& s : trace.samples) {
    time.push_back(s.time);
    force.push_back(glm::length(s.force));
  }
  for (const std::size_t n : decimate(time, force, kBuckets)) {
    out.time_s.push_back(time[n]);
    out.force_N.push_back(force[n]);
    out.depth_mm.push_back(trace.samples[n].depth / kMillimetre);
  }
}

/// The runs, in the order of the results.
struct Job {
  const StabilityCase* subject;
  const StabilityModel* model;
};

Error unknown(const std::string& kind, const std::string& name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return bad_input(fmt::format("there is no {} \"{}\"{}; there are {}", kind, name, near ? "; did you mean \"" + *near + "\"?" : "",
                               fmt::join(known, ", ")));
}

Result<std::vector<Job>> jobs_of(const std::vector<StabilityCase>& cases, const StabilityOptions& options) {
  std::vector<Job> out;
  std::vector<std::string> models, names;
  for (const StabilityModel& model : stability_models()) models.push_back(model.name);
  for (const StabilityCase& subject : cases) names.push_back(subject.name);
  if (!options.only_model.empty() && std::ranges::find(models, options.only_model) == models.end())
    return unknown("model", options.only_model, models);
  if (!options.only_case.empty() && std::ranges::find(names, options.only_case) == names.end())
    return unknown("hard case", options.only_case, names);
  for (const StabilityCase& subject : cases) {
    if (!options.only_case.empty() && subject.name != options.only_case) continue;
    for (const StabilityModel& model : stability_models()) {
      if (!options.only_model.empty() && model.name != options.only_model) continue;
      if (options.sabotage && (&model != stability_models().data() || subject.sabotage.what.empty())) continue;
      out.push_back({&subject, &model});
    }
  }
  if (out.empty())
    return bad_input("the hard case \"" + options.only_case + "\" has no sabotage for this model: leave --sabotage out, or run another");
  return out;
}

}  // namespace

Result<StabilityTrace> trace_of(const StabilityCase& of, const StabilityModel& model, bool sabotaged) {
  auto rig = StabilityRig::create(of, model, sabotaged);
  if (!rig) return rig.error();
  StabilityTrace out;
  if (Status ran = run_parts(**rig, of, SIZE_MAX, [&](const StabilityTrace& trace) { out = trace; }); !ran) return ran.error();
  return out;
}

StabilityOutcome run_stability_case(const StabilityCase& of, const StabilityModel& model, bool sabotaged) {
  StabilityOutcome out{.subject = of.name, .model = model.name};
  auto rig = StabilityRig::create(of, model, sabotaged);
  if (!rig) {
    out.error = rig.error().text();
    return out;
  }
  const std::vector<StabilityCheck> checks = checks_for(of, model);
  const TraceContext context = (*rig)->context();
  for (const StabilityCheck& check : checks)
    out.rows.push_back({of.name, model.name, std::string(name_of(check.measure)), 0.0, bound_of(check, context), true});
  out.points = static_cast<double>((*rig)->points());
  std::vector<bool> judged(checks.size(), false);
  const Status ran = run_parts(**rig, of, kPart, [&](const StabilityTrace& trace) {
    if (out.time_s.empty()) draw(trace, out);
    for (std::size_t n = 0; n < checks.size(); ++n) {
      judged[n] = judged[n] || touches(trace, checks[n].span);
      const double value = measure(trace, checks[n], context);
      if (std::isnan(value) || value > out.rows[n].value) out.rows[n].value = value;
    }
  });
  if (!ran) out.error = ran.error().text();
  // A check without a tick would always pass.
  for (std::size_t n = 0; n < checks.size(); ++n)
    if (!judged[n]) out.error = "no tick lies in the time for which " + out.rows[n].measure + " is asked";
  for (StabilityRow& row : out.rows) row.pass = row.value <= row.bound;
  return out;
}

Result<std::vector<StabilityOutcome>> run_stability(const StabilityOptions& options,
                                                    const std::function<void(double, const std::string&)>& progress) {
  const std::vector<StabilityCase> cases = stability_cases(options.long_runs);
  const auto jobs = jobs_of(cases, options);
  if (!jobs) return jobs.error();
  std::vector<StabilityOutcome> out(jobs->size());
  std::atomic<std::size_t> next{0}, done{0};
  std::mutex reporting;
  const auto work = [&] {
    for (std::size_t n = next++; n < jobs->size(); n = next++) {
      const Job& job = (*jobs)[n];
      out[n] = run_stability_case(*job.subject, *job.model, options.sabotage);
      const std::scoped_lock lock(reporting);
      progress(static_cast<double>(++done) / static_cast<double>(jobs->size()), job.subject->name + ", " + job.model->name);
    }
  };
  const std::size_t asked = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const std::size_t count = std::min(asked, jobs->size());
  std::vector<std::thread> threads;
  for (std::size_t n = 1; n < count; ++n) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return out;
}

}  // namespace burrhole
