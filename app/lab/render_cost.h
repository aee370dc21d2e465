/// app/lab/render_cost.h: accuracy and CPU time of drawing: pictures of the shipped renderer, one drawing option after another, against the
///   best quality.
///   Scene   the shipped parietal bone from the scene's camera, as loaded and after drilling through it; without the tool.
///   References  drawn by the same renderer from float texels at 1/8 voxel with 12 bisections:
///           "same rays"  one ray per pixel, without finish: errors of sampling and texels;
///           "best"       4 x 4 rays per pixel, with finish: all errors that a viewer sees.
///   Times   CPU time of all threads of the process [us] per picture, read-back included; interleaved with pictures of the shipped options.
///   Units   in the names.   Errors  unavailable.   Thread  one; threads of OpenGL are counted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/render/renderer.h"

namespace burrhole {

struct RenderCostOptions {
  std::string share_folder;       ///< contains scenes/ and tools/
  int width = 400, height = 300;  ///< [pixels]
  int frames = 9;                 ///< timed per setting
  bool front = true;              ///< all combinations of options, for the Pareto front; otherwise each option alone
  bool drilled = true;            ///< also after drilling
  GlBackend gl = GlBackend::automatic;
  std::function<void(double, const std::string&)> progress{};  ///< share done 0..1; may be empty
};

/// A measured picture.
struct DrawnPoint {
  std::string subject;
  std::string method;  ///< "rays", "slices" or "translucent"
  DrawingQuality quality;
  double slices_per_voxel = 0.0;                                                   ///< [slices/voxel] of method "slices"
  double median_us = 0.0, over_shipped = 0.0, psnr = 0.0, ssim = 0.0, flip = 0.0;  ///< [us], [-], [dB], [-], [-]
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

/// Points of one method, combined over the subjects: mean cost relative to the cheapest, smallest PSNR.
struct ParetoRow {
  DrawingQuality quality;
  double cost = 0.0, psnr = 0.0;  ///< [-], [dB]
};
[[nodiscard]] std::vector<ParetoRow> front_of(const std::vector<DrawnPoint>& points, const std::string& method);

/// Writes cost.csv, render.svg, render.html, the pictures and, if Pareto fronts were measured, quality_front.inc (compiled into the
/// program) into a folder. `unavailable` without gnuplot: the CSV is written.
[[nodiscard]] Status write_render_cost(const RenderCost& cost, const std::string& folder);

}  // namespace burrhole
