#include "app/lab/stability_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "app/report/csv.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

const StabilityModel& default_model() { return stability_models().front(); }

/// Cases in the order of the runs.
std::vector<std::string> subjects_of(std::span<const StabilityOutcome> outcomes) {
  std::vector<std::string> out;
  for (const StabilityOutcome& outcome : outcomes)
    if (std::ranges::find(out, outcome.subject) == out.end()) out.push_back(outcome.subject);
  return out;
}

std::map<std::string, StabilityCase> cases_by_name() {
  std::map<std::string, StabilityCase> out;
  for (StabilityCase& one : stability_cases()) out.emplace(one.name, std::move(one));
  return out;
}

std::string figure(double value) { return fmt::format("{:.3g}", value); }

/// "slot: cycle_mm 0.3 (bound 0.1)" for every failure of a model.
std::vector<std::string> findings_of(std::span<const StabilityOutcome> outcomes, const std::string& model) {
  std::vector<std::string> out;
  for (const StabilityOutcome& outcome : outcomes) {
    if (outcome.model != model) continue;
    std::string what = outcome.error;
    for (const StabilityRow& row : outcome.rows)
      if (!row.pass) what += fmt::format("{}{} {} (bound {})", what.empty() ? "" : ", ", row.measure, figure(row.value), figure(row.bound));
    if (!what.empty()) out.push_back(outcome.subject + ": " + what);
  }
  return out;
}

/// "`attractive_force_N`: rest 0.37 (0.05), ...", one entry per measure in the order of first failure; bounds in brackets.
std::vector<std::string> failures_by_measure(std::span<const StabilityOutcome> outcomes, const std::string& model) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&](const std::string& measure, const std::string& text) {
    auto found = std::ranges::find(lines, measure, &std::pair<std::string, std::string>::first);
    if (found == lines.end()) found = lines.insert(lines.end(), {measure, {}});
    found->second += (found->second.empty() ? "" : ", ") + text;
  };
  for (const StabilityOutcome& outcome : outcomes) {
    if (outcome.model != model) continue;
    if (!outcome.error.empty()) add("not run", outcome.subject + " (" + outcome.error + ")");
    for (const StabilityRow& row : outcome.rows)
      if (!row.pass) add(row.measure, fmt::format("{} {} ({})", row.subject, figure(row.value), figure(row.bound)));
  }
  std::vector<std::string> out;
  for (const auto& [measure, text] : lines) out.push_back(fmt::format("`{}`: {}", measure, text));
  return out;
}

/// Force over time, one line per model.
std::string picture(std::span<const StabilityOutcome> outcomes, const std::string& subject) {
  Plot plot{.x_label = "time [s]", .panels = {{.y_label = "force [N]", .series = {}, .bands = {}, .from_zero = true}}, .events = {}};
  for (const StabilityOutcome& outcome : outcomes)
    if (outcome.subject == subject && !outcome.time_s.empty())
      plot.panels.front().series.push_back({outcome.model, outcome.time_s, outcome.force_N});
  if (plot.panels.front().series.empty()) return {};
  auto drawn = draw_svg(plot);
  return drawn ? *drawn : std::string();
}

/// Rows: checks of a case; columns: models; failures are marked. The default model has all checks of a case, in order; a penalty model has
/// some of them.
void add_table(HtmlPage& page, std::span<const StabilityOutcome> outcomes, const std::string& subject) {
  std::vector<std::string> columns{"measure", "bound"};
  std::vector<std::vector<std::string>> rows;
  std::vector<const StabilityOutcome*> shown;
  for (const StabilityOutcome& outcome : outcomes)
    if (outcome.subject == subject) shown.push_back(&outcome);
  for (const StabilityOutcome* outcome : shown) columns.push_back(outcome->model);
  std::vector<std::size_t> at(shown.size(), 0);
  for (const StabilityRow& row : shown.front()->rows) {
    rows.push_back({row.measure, figure(row.bound)});
    for (std::size_t n = 0; n < shown.size(); ++n) {
      const bool has = at[n] < shown[n]->rows.size() && shown[n]->rows[at[n]].measure == row.measure;
      rows.back().push_back(has ? figure(shown[n]->rows[at[n]].value) + (shown[n]->rows[at[n]].pass ? "" : " fails") : "");
      at[n] += has ? 1 : 0;
    }
  }
  page.table(columns, rows);
}

}  // namespace

bool default_model_failed(std::span<const StabilityOutcome> outcomes) noexcept {
  return std::ranges::any_of(outcomes, [](const StabilityOutcome& outcome) {
    return outcome.model == default_model().name &&
           (!outcome.error.empty() || std::ranges::any_of(outcome.rows, [](const StabilityRow& row) { return !row.pass; }));
  });
}

Status write_stability_csv(std::span<const StabilityOutcome> outcomes, const std::string& path) {
  CsvTable table({"case", "model", "measure", "value", "bound", "pass"});
  for (const StabilityOutcome& outcome : outcomes)
    for (const StabilityRow& row : outcome.rows) table.add_row({row.subject, row.model, row.measure, row.value, row.bound, row.pass});
  return table.write(path);
}

Status write_stability_page(std::span<const StabilityOutcome> outcomes, const std::string& path) {
  const auto cases = cases_by_name();
  HtmlPage page("Hard cases", "Bounds of difficult contact situations, for each contact model");
  page.heading("What fails");
  for (const StabilityModel& model : stability_models()) {
    const std::vector<std::string> findings = findings_of(outcomes, model.name);
    if (std::ranges::none_of(outcomes, [&](const StabilityOutcome& o) { return o.model == model.name; })) continue;
    page.paragraph(model.name + (findings.empty() ? ": nothing" : ":"));
    for (const std::string& finding : findings) page.paragraph(finding);
  }
  for (const std::string& subject : subjects_of(outcomes)) {
    page.heading(subject);
    if (const auto found = cases.find(subject); found != cases.end()) page.paragraph(found->second.shows);
    if (const std::string svg = picture(outcomes, subject); !svg.empty()) page.svg(svg, "force on the hand");
    add_table(page, outcomes, subject);
  }
  return write_file(path, page.text());
}

std::string stability_markdown(std::span<const StabilityOutcome> outcomes) {
  std::string out = "## The cases\n\n| case | what it shows | injected error | measure that must fail |\n|---|---|---|---|\n";
  for (const StabilityCase& one : stability_cases()) {
    const bool broken = !one.sabotage.what.empty();
    out += fmt::format("| `{}` | {} | {} | {} |\n", one.name, one.shows, broken ? one.sabotage.what : "-",
                       broken ? fmt::format("`{}`", name_of(one.sabotage.must_fail)) : "-");
  }
  out +=
      "\n## What fails for which model\n\nCase, value and (bound), rounded to three digits. A case that appears twice has two spans of "
      "time, such as there and back.\n";
  for (const StabilityModel& model : stability_models()) {
    if (std::ranges::none_of(outcomes, [&](const StabilityOutcome& o) { return o.model == model.name; })) continue;
    const std::vector<std::string> lines = failures_by_measure(outcomes, model.name);
    out += fmt::format("\n**{}**{}\n", model.name, lines.empty() ? ": nothing." : "");
    for (const std::string& line : lines) out += "- " + line + "\n";
  }
  return out;
}

}  // namespace burrhole
