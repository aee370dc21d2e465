/// app/report/drill_report.h: report of one drilled burrhole on one page, for the trainee: results, and errors of the trainee.
///   Units  in the names of the members. Values that do not apply are empty and are not shown.   Frame  none.
///   Errors  bad_input with the path.   Thread  any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/value_map.h"

namespace burrhole {

struct DrillReport {
  /// A layer of bone along the axis, as loaded; depth from the entry point.
  struct Layer {
    std::string name;
    double from_mm = 0.0, to_mm = 0.0;
  };
  /// What the drilling of a layer took.
  struct LayerRow {
    std::string name;
    double thickness_mm = 0.0, time_s = 0.0;
    std::optional<double> mean_N, peak_N;
    double removed_mm3 = 0.0;
  };
  struct Event {
    double time_s = 0.0;
    std::string text;
  };
  struct Picture {
    std::string png_path;
    std::string caption;
  };
  /// Duration of one step of the loop, per call.
  struct Timing {
    std::string name;
    std::int64_t count = 0;
    double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;
  };
  /// Steps of one clock of a live run.
  struct Missed {
    std::string clock;
    std::uint64_t missed = 0, all = 0;  ///< all includes the missed ones
  };
  struct Hash {
    std::string name, value;
  };

  /// A line on what made the results.
  struct Made {
    std::string name, value;
  };

  std::string title;                  ///< of the run, with the bit in use
  std::string scene;                  ///< file name of the scene
  std::vector<Made> made;             ///< version, date, machine, overrides, erosion factors, hashes of the inputs
  std::string setting;                ///< the settings of the run, in one line
  std::string result, reason;         ///< word of the result and its criterion with numbers; not shown if empty
  std::vector<std::string> flags;     ///< words of the flags of the result
  bool through = true;                ///< the result is that the bone was drilled through
  std::string outcome;                ///< end of a run that is not through, in one sentence
  std::vector<std::string> warnings;  ///< warnings of the scene

  // Time series; each has the size of time_s or is empty.
  std::vector<double> time_s;
  std::vector<double> force_N;     ///< magnitude of the force of bone on the tool
  std::vector<double> depth_mm;    ///< of the tip along the axis from the entry, inwards positive
  std::vector<double> speed_mm_s;  ///< of the tip along the axis, inwards positive

  std::vector<Layer> layers;
  std::vector<LayerRow> layer_rows;
  std::vector<Event> events;
  std::vector<Picture> pictures;
  std::vector<ValueMap> maps;  ///< of effects, such as the temperature of bone

  std::optional<double> thickness_mm, depth_mm_at_breakthrough, plunge_mm, beyond_mm, peak_force_N, angle_deg;
  std::optional<double> removed_mm3, removed_mass_mm3, hole_diameter_mm, inner_diameter_mm;
  std::optional<double> breakthrough_s, tip_out_s, support_lost_s, duration_s;
  std::optional<double> cleared_percent;  ///< [%] of the bit's cross-section that is clear of bone
  double plunge_limit_mm = 0.5;           ///< a larger plunge is shown as an alert; drill() sets it from the scene

  std::vector<Timing> timing;
  std::vector<Missed> missed;  ///< of a live run: servo, contact, simulation
  std::vector<Hash> hashes;
};

/// Figures of the exit from the bone; absent if they do not apply.
struct ExitFigures {
  std::optional<double> breakthrough_s{};  ///< absent where a core is left
  std::optional<double> tip_out_s{};       ///< at which the tip was beyond the bone as loaded
  std::optional<double> support_lost_s{};  ///< at which the loss of support began (core/measure/support_loss.h); absent: there was none
  std::optional<double> plunge_mm{};
};
/// @returns a sentence without its full stop on a bone that was drilled through.
[[nodiscard]] std::string exit_sentence(const ExitFigures& exit);
/// @returns the page. Without gnuplot a sentence replaces the plot; a picture that cannot be read is an error (bad_input).
[[nodiscard]] Result<std::string> make_drill_report(const DrillReport& report);

/// Writes make_drill_report() to a file.
[[nodiscard]] Status write_drill_report(const DrillReport& report, const std::string& path);

}  // namespace burrhole
