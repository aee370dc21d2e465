/// app/lab/cost_row.h: one line of cost.csv: an error against a named reference beside the time of the same run.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// NaN where a figure does not apply.
struct CostRow {
  std::string subject;  ///< what was measured, on what
  std::string model;
  std::string knob;  ///< with its unit
  double setting = 0.0;
  std::string error_name;
  double error = 0.0;
  std::string unit;  ///< of the error
  std::string reference;
  double median_us = std::numeric_limits<double>::quiet_NaN();  ///< of one call: all points of the shell
  double p99_us = std::numeric_limits<double>::quiet_NaN();
  double bytes = std::numeric_limits<double>::quiet_NaN();
};

/// The value that `share` (0..1) of them do not exceed, of at least one value; 1 is the largest.
[[nodiscard]] double at_share(std::vector<double> values, double share);

/// Columns subject, model, knob, setting, error_name, error, unit, reference, median_us, p99_us, bytes.
[[nodiscard]] Status write_cost_csv(std::span<const CostRow> rows, const std::string& path);

}  // namespace burrhole
