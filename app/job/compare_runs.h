/// app/job/compare_runs.h: results of several runs side by side: a table, and curves over each other.
///   Frame  none: depth is along the axis of drilling, from the entry.   Units  in the names.
///   Errors  bad_input with the path: no results there, or a damaged summary.json.   Thread  any.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Results of one run, read from its folder.
struct RunResults {
  std::string name;  ///< as given
  std::string folder;
  std::vector<std::pair<std::string, std::string>> facts;              ///< title, result, program, overrides, ...
  std::vector<std::pair<std::string, std::optional<double>>> figures;  ///< names with units; nothing: null in summary.json
  std::vector<double> time_s, force_N, depth_mm;                       ///< of the session; depth empty without an approach
  std::string no_curves;                                               ///< why there are none; empty: there are
  bool damaged = false;                                                ///< its session is, which is why there are no curves
  std::vector<std::string> pictures;                                   ///< names without ending, in alphabetical order
};

/// @param path a folder with summary.json, or that file. A run without a session, or with a damaged one, has no curves.
[[nodiscard]] Result<RunResults> read_run(const std::string& path);

/// A row of the comparison; empty cells do not apply.
struct ComparedRow {
  std::string name;
  std::vector<std::string> cells;  ///< one a run
  std::string difference;          ///< second run minus first, of two runs
  bool differs = false;
};
[[nodiscard]] std::vector<ComparedRow> compared_rows(std::span<const RunResults> runs);
/// @returns the rows as text in columns; "*" marks a row whose values differ.
[[nodiscard]] std::string comparison_text(std::span<const RunResults> runs);
/// @returns {schema, runs[{name, facts{}, figures{}}]}.
[[nodiscard]] std::string comparison_json(std::span<const RunResults> runs);

/// A picture of the page.
struct ComparedPicture {
  std::string png_path, caption;
};
/// Writes compare.svg (force and depth of all runs over time) and compare.html into a folder. Without gnuplot or curves, a sentence
/// replaces the plot.
[[nodiscard]] Status write_comparison(std::span<const RunResults> runs, const std::vector<ComparedPicture>& pictures,
                                      const std::string& folder);

}  // namespace burrhole
