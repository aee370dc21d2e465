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
  std::vector<std::pair<std::string, std::string>> overrides;          ///< keys of scene and tool with their values; see compared_rows()
  std::string scene_place;                                             ///< hash of the path of the scene; empty: unknown
  std::vector<std::pair<std::string, std::string>> used;               ///< bit, spin and push of the run, by their keys of the scene
  std::vector<std::pair<std::string, std::optional<double>>> figures;  ///< names with units; nothing: null in summary.json
  std::string volume_format;                                           ///< as in summary.json
  std::optional<double> spacing_mm;                                    ///< of the voxels
  std::vector<double> time_s, force_N;                                 ///< of the session: ticks of the servo, force on the hand
  std::vector<double> depth_time_s, depth_mm;                          ///< ticks of contact; depth empty without an approach
  std::string no_curves;                                               ///< why there are none; empty: there are
  bool damaged = false;                                                ///< its session is, which is why there are no curves
  std::vector<std::string> pictures;                                   ///< names without ending, in alphabetical order
};

/// @param path a folder with summary.json, or that file. A run without a session, or with a damaged one, has no curves.
[[nodiscard]] Result<RunResults> read_run(const std::string& path);

/// @returns whether two runs drilled the same bone, so that their pictures can be compared: by the hashes of the voxels, or by one scene whose
/// overrides of the volume are equal, the size of voxels apart. What is not known counts as the same.
[[nodiscard]] bool has_same_bone(const RunResults& a, const RunResults& b);

/// A row of the comparison; empty cells do not apply.
struct ComparedRow {
  std::string name;
  std::vector<std::string> cells;  ///< one a run
  std::string difference;          ///< second run minus first, of two runs
  bool differs = false;
  bool is_setting = false;  ///< a key that was overridden: shown whole
};
/// @returns the rows in this order: title and scene; each key of scene, or of the tool's file, that was overridden and differs, with "scene's" or
/// "tool's" where a run did not override it (bit, spin and push: the value of each run, if it differs for any reason); results; figures;
/// and last program, machine, date, hashes and wall time.
[[nodiscard]] std::vector<ComparedRow> compared_rows(std::span<const RunResults> runs);
/// @returns the rows as text in columns; "*" marks a row whose values differ.
[[nodiscard]] std::string comparison_text(std::span<const RunResults> runs);
/// @returns {schema, runs[{name, facts{}, settings{}, figures{}}]}; settings are bit, spin, push and the keys that were overridden.
[[nodiscard]] std::string comparison_json(std::span<const RunResults> runs);

struct ComparedPicture {
  std::string png_path, caption;
};
/// One view that runs share.
struct ComparedView {
  std::vector<ComparedPicture> pictures;  ///< of the first run, then of each run that differs, with the difference
  std::string same;                       ///< one sentence on the runs without a difference; empty: there is none
};
/// Writes compare.svg (force and depth of all runs over time) and compare.html into a folder: table, curves, pictures. Without gnuplot or curves, a sentence
/// replaces the plot.
[[nodiscard]] Status write_comparison(std::span<const RunResults> runs, const std::vector<ComparedView>& views, const std::string& folder);

}  // namespace burrhole
