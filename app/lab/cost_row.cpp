#include "app/lab/cost_row.h"

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

}  // namespace burrhole
