/// app/lab/render_cost.h: what drawing costs: pictures of the shipped renderer, knob by knob, against the best that can be drawn, beside
///   their CPU time.
///   Scene   the shipped parietal bone from the scene's camera, as loaded and after a hole was drilled through it; without the tool.
///   References  drawn by the same renderer from texels in floats at 1/8 voxel with 12 bisections:
///           "same rays"  one ray a pixel, without finish: what sampling and texels lose;
///           "best"       4 x 4 rays a pixel, with finish: what a viewer loses.
///   Times   CPU time of all threads of the process [us] a picture, read back; a picture with the shipped knobs by turns in the same run.
///   Thread  one; OpenGL's own threads are counted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/render/renderer.h"

namespace burrhole {

struct RenderCostOptions {
  std::string share_folder;  ///< holds scenes/ and tools/
  int width = 400, height = 300;
  int frames = 9;       ///< timed for each setting
  bool front = true;    ///< all combinations of knobs, for the Pareto front; otherwise each knob alone
  bool drilled = true;  ///< also after drilling
  GlBackend gl = GlBackend::automatic;
  std::function<void(double, const std::string&)> progress{};  ///< share done 0..1; may be empty
};

/// A picture of the front's figures.
struct DrawnPoint {
  std::string subject;
  std::string method;  ///< "rays", "slices" or "translucent"
  DrawingQuality quality;
  double slices_per_voxel = 0.0;  ///< of slices
  double median_us = 0.0, over_shipped = 0.0, psnr = 0.0, ssim = 0.0, flip = 0.0;
};

struct NamedImage {
  std::string name, caption;
  Image image;
};

struct RenderCost {
  std::vector<CostRow> rows;
  std::vector<DrawnPoint> points;
  std::vector<NamedImage> pictures;
  std::string driver;
};

/// @returns ErrorCode::unavailable without OpenGL.
[[nodiscard]] Result<RenderCost> measure_render_cost(const RenderCostOptions& options);

/// Points of one method with their costs and accuracies put together over the subjects: mean cost over that of the cheapest, least PSNR.
struct FrontRow {
  DrawingQuality quality;
  double cost = 0.0, psnr = 0.0;
};
[[nodiscard]] std::vector<FrontRow> front_of(const std::vector<DrawnPoint>& points, const std::string& method);

/// cost.csv, render.svg, render.html, the pictures and, where fronts were measured, quality_front.inc (built into the program) into a
/// folder. `unavailable` without gnuplot: the CSV is then there.
[[nodiscard]] Status write_render_cost(const RenderCost& cost, const std::string& folder);

}  // namespace burrhole
