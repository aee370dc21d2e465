/// app/report/drill_report.h: one drilled burrhole on one page, for the trainee: what was done, and what went wrong.
///   Units  as the names say. What does not apply is left empty and is then not shown.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

struct DrillReport {
  /// A layer of bone along the axis, as loaded; depth from the entry point.
  struct Layer {
    std::string name;
    double from_mm = 0.0, to_mm = 0.0;
  };
  struct Event {
    double time_s = 0.0;
    std::string text;
  };
  struct Picture {
    std::string png_path;
    std::string caption;
  };
  /// What one step of the loop cost, per call.
  struct Timing {
    std::string name;
    std::int64_t count = 0;
    double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;
  };
  struct Hash {
    std::string name, value;
  };

  std::string title;  ///< of the scene
  std::string scene;  ///< its file
  std::string tool;
  std::string setting;                ///< what was chosen for the run, in a line
  std::string outcome;                ///< how a run ended that did not break through, in a sentence
  std::vector<std::string> warnings;  ///< of the scene

  // Over time; sizes equal that of time_s, or empty.
  std::vector<double> time_s;
  std::vector<double> force_N;     ///< magnitude of what bone exerts on the tool
  std::vector<double> depth_mm;    ///< of the tip along the axis from the entry, inwards positive
  std::vector<double> speed_mm_s;  ///< of the tip along the axis, inwards positive

  std::vector<Layer> layers;
  std::vector<Event> events;
  std::vector<Picture> pictures;

  std::optional<double> thickness_mm, depth_mm_at_breakthrough, plunge_mm, peak_force_N, angle_deg;
  std::optional<double> removed_mm3, removed_mass_mm3, hole_diameter_mm, inner_diameter_mm;
  std::optional<double> breakthrough_s, duration_s;
  double plunge_limit_mm = 0.5;  ///< a plunge beyond this is shown as a fault; the thinnest dura is about 0.3 mm, so this is generous

  std::vector<Timing> timing;
  std::int64_t missed = 0;  ///< ticks that came late
  std::vector<Hash> hashes;
};

/// @returns the page. Without gnuplot the page says so in place of the plot; a picture that cannot be read is an error.
[[nodiscard]] Result<std::string> make_drill_report(const DrillReport& report);

/// make_drill_report into a file.
[[nodiscard]] Status write_drill_report(const DrillReport& report, const std::string& path);

}  // namespace burrhole
