#include "app/lab/cost_row.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>

#include "app/report/csv.h"

namespace burrhole {

double at_share(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

Status write_cost_csv(std::span<const CostRow> rows, const std::string& path) {
  CsvTable table({"subject", "model", "knob", "setting", "error_name", "error", "unit", "reference", "median_us", "p99_us", "bytes"});
  for (const CostRow& row : rows)
    table.add_row({row.subject, row.model, row.knob, row.setting, row.error_name, row.error, row.unit, row.reference, row.median_us,
                   row.p99_us, row.bytes});
  return table.write(path);
}

std::string markdown_table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& cells) {
  std::string out = "| " + fmt::format("{}", fmt::join(heads, " | ")) + " |\n|";
  for (std::size_t n = 0; n < heads.size(); ++n) out += "---|";
  out += "\n";
  for (const std::vector<std::string>& line : cells) out += "| " + fmt::format("{}", fmt::join(line, " | ")) + " |\n";
  return out;
}

double cpu_now() noexcept {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace burrhole
