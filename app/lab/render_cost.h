/// app/lab/render_cost.h: measures the error of pictures and the CPU time of the renderer for each drawing option.
///   Scene   the shipped parietal bone, as loaded and after drilling, from the scene's camera, without the tool.
///   References  two pictures by the same renderer, with 32-bit float texels, a ray step of 1/8 voxel and 12 bisections of the hit:
///           "same rays"  one ray per pixel, without finish: shows errors of sampling and texels;
///           "best"       4 x 4 rays per pixel, with finish: shows all visible errors.
///           Translucent bone has two references of its own, drawn translucent with the same texels and step: one ray and 4 x 4 rays per
///           pixel. Slices are compared with the references of the surface.
///   Times   CPU time of all threads of the process [us] per picture, read-back included. Time on a GPU is not included, so times are
///           meaningful for software OpenGL only. Runs are interleaved with pictures at the default options of a scene, to cancel drift of
///           the clock rate.
///   Errors  unavailable (no OpenGL, no gnuplot); those of the scene.   Thread  one.
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/study.h"
#include "app/render/renderer.h"

namespace burrhole {

struct RenderCostOptions {
  std::string share_folder;       ///< contains scenes/ and tools/
  int width = 400, height = 300;  ///< [pixels]
  int frames = 9;                 ///< timed per setting
  bool pareto = true;             ///< true: in addition, combinations of options, for the Pareto fronts; false: one option varied at a time
  bool drilled = true;            ///< true: also after drilling
  GlBackend gl = GlBackend::automatic;
  Study* study = nullptr;  ///< runs the trials, one per setting and subject; null: nothing is kept. References are drawn in any case
};
[[nodiscard]] std::size_t count_of_trials(const RenderCostOptions& options) noexcept;

/// Cost and error of one setting on one subject: slices, and the combinations of options.
struct DrawnPoint {
  std::string subject;  ///< state of the scene: "skull patch" (as loaded) or "drilled hole"
  std::string method;   ///< "rays", "slices" or "translucent"
  DrawingQuality quality;
  double slices_per_voxel = 0.0;              ///< [slices/voxel] of method "slices"
  double median_us = 0.0;                     ///< [us] CPU time of a picture
  double over_shipped = 0.0;                  ///< [-] median time over the median time of the default options of a scene
  double psnr = 0.0, ssim = 0.0, flip = 0.0;  ///< [dB], [-], [-] against "best", translucent bone: its own 4 x 4 rays; FLIP 0: equal
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

/// @returns ErrorCode::unavailable without OpenGL; errors of the scene.
[[nodiscard]] Result<RenderCost> measure_render_cost(const RenderCostOptions& options);

/// A setting on the Pareto front.
struct ParetoRow {
  DrawingQuality quality;
  double cost = 0.0;  ///< [-] relative to the cheapest setting, mean over the subjects
  double psnr = 0.0;  ///< [dB] smallest over the subjects
};
/// @returns the Pareto front of cost and PSNR over the settings of one method, cheapest first.
[[nodiscard]] std::vector<ParetoRow> pareto_rows(const std::vector<DrawnPoint>& points, const std::string& method);

/// Writes cost.csv, the pictures and render.html into a folder. If Pareto fronts were measured, it also writes their plot render.svg and
/// quality_front.inc, which is compiled into the program after it is copied to app/view; without gnuplot it then writes cost.csv and
/// quality_front.inc only and returns `unavailable`. Without Pareto fronts gnuplot is not used.
[[nodiscard]] Status write_render_cost(const RenderCost& cost, const std::string& folder);

}  // namespace burrhole
