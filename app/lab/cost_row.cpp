#include "app/lab/cost_row.h"

#include "app/report/csv.h"

namespace burrhole {

Status write_cost_csv(std::span<const CostRow> rows, const std::string& path) {
  CsvTable table({"subject", "model", "knob", "setting", "error_name", "error", "unit", "reference", "median_us", "p99_us", "bytes"});
  for (const CostRow& row : rows)
    table.add_row({row.subject, row.model, row.knob, row.setting, row.error_name, row.error, row.unit, row.reference, row.median_us,
                   row.p99_us, row.bytes});
  return table.write(path);
}

}  // namespace burrhole
