/// app/lab/cost_row.h: a row of cost.csv: an error against a named reference, and the time measured in the same run.
///   Units  in the rows.   Errors  bad_input if the file cannot be written.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// NaN in values that do not apply.
struct CostRow {
  std::string subject;  ///< what was measured, on which object
  std::string model;
  std::string knob;      ///< name of the varied setting, with its unit
  double setting = 0.0;  ///< [unit in `knob`]
  std::string error_name;
  double error = 0.0;  ///< [unit in `unit`]
  std::string unit;    ///< of the error
  std::string reference;
  double median_us = std::numeric_limits<double>::quiet_NaN();  ///< of one call: all points of the shell
  double p99_us = std::numeric_limits<double>::quiet_NaN();
  double bytes = std::numeric_limits<double>::quiet_NaN();  ///< [bytes]
};

/// @returns the smallest value that a share `share` (0..1) of the values do not exceed; 1 gives the largest. @pre values is not empty.
[[nodiscard]] double at_share(std::vector<double> values, double share);

/// @returns the CPU time [s] of the calling thread: a run in lockstep starts no other.
[[nodiscard]] double cpu_now() noexcept;

/// @returns a table in Markdown: a line of heads, then a line for each row.
[[nodiscard]] std::string markdown_table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& cells);

/// Columns subject, model, knob, setting, error_name, error, unit, reference, median_us, p99_us, bytes.
[[nodiscard]] Status write_cost_csv(std::span<const CostRow> rows, const std::string& path);

}  // namespace burrhole
