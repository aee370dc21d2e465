#include <fmt/format.h>

#include <algorithm>

#include "app/lab/drilling_convergence.h"
#include "app/report/csv.h"
#include "app/report/file.h"
#include "app/report/html.h"

namespace burrhole {
namespace {

struct Column {
  const char *measure, *head;
};
constexpr Column kColumns[] = {{"volume_off_percent", "volume [%]"}, {"mass_off_percent", "mass [%]"}, {"time_off_percent", "time [%]"},
                               {"plunge_off_mm", "plunge [mm]"},     {"early_stops", "early stops"},   {"time_not_falling", "slower"}};

/// One line per case; a value beyond its bound is marked, with the bound.
std::vector<std::vector<std::string>> lines_of(const std::vector<StabilityRow>& rows, const std::string& mark) {
  std::vector<std::vector<std::string>> out;
  for (const StabilityRow& row : rows) {
    if (out.empty() || out.back().front() != row.subject) {
      out.push_back({row.subject});
      out.back().resize(1 + std::size(kColumns), "-");
    }
    const auto column = std::ranges::find_if(kColumns, [&](const Column& one) { return row.measure == one.measure; });
    const std::string value = fmt::format("{:.3g}", row.value);
    out.back()[1 + static_cast<std::size_t>(column - std::begin(kColumns))] =
        row.pass ? value : fmt::format("{0}{1} > {2:.3g}{0}", mark, value, row.bound);
  }
  return out;
}

std::vector<std::string> heads() {
  std::vector<std::string> out{"hole"};
  for (const Column& column : kColumns) out.emplace_back(column.head);
  return out;
}

std::string verdict(const std::vector<StabilityRow>& rows) {
  const auto failed = std::ranges::count_if(rows, [](const StabilityRow& row) { return !row.pass; });
  return fmt::format("{} of {} figures are within their bounds.", rows.size() - static_cast<std::size_t>(failed), rows.size());
}

std::string markdown(const std::vector<StabilityRow>& rows) {
  std::string out = verdict(rows) + "\n\n";
  const auto line = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) out += "| " + cell + " ";
    out += "|\n";
  };
  line(heads());
  for (std::size_t n = 0; n <= std::size(kColumns); ++n) out += "|---";
  out += "|\n";
  for (const std::vector<std::string>& cells : lines_of(rows, "**")) line(cells);
  return out;
}

}  // namespace

Status write_convergence(const std::vector<StabilityRow>& rows, const std::string& folder) {
  CsvTable table({"case", "model", "measure", "value", "bound", "pass"});
  for (const StabilityRow& row : rows) table.add_row({row.subject, row.model, row.measure, row.value, row.bound, row.pass});
  if (Status written = table.write(folder + "/convergence.csv"); !written) return written;
  if (Status written = write_file(folder + "/convergence.md", markdown(rows)); !written) return written;
  HtmlPage html("Does the hole depend on the discretisation?",
                "Drilled holes by voxel edge and erosion rate against the closed form or the finest run; " + verdict(rows));
  html.table(heads(), lines_of(rows, ""));
  return write_file(folder + "/convergence.html", html.text());
}

}  // namespace burrhole
