/// app/bench/growth_run.h: one run of the area growth: a plate of bone across a volume of a given edge is made, drilled, drawn and restored.
///   Each run has a process of its own, so that its peak memory is that of one volume, and all volumes start from the same state.
///   Units  SI unless named.   Thread  main.   Errors  those of scene and simulation; unavailable without OpenGL.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Times of steps are medians over the run, by the clock; all others are CPU times of all threads, medians where they are repeated.
struct GrowthRun {
  // Costs.
  double load = 0.0;         ///< [s] the bone model and the simulation are made
  double drilling = 0.0;     ///< [s] the whole run, without pictures
  double contact = 0.0;      ///< [s] of a contact tick
  double bone_step = 0.0;    ///< [s] of the removal in a bone step
  double publishing = 0.0;   ///< [s] of the publishing in a bone step
  double undo = 0.0;         ///< [s] the hole is undone, and published
  double first = 0.0;        ///< [s] texels of the whole volume, upload, shaders, and the first picture
  double picture = 0.0;      ///< [s] a picture of which all pixels are drawn
  double texels = 0.0;       ///< [s] texels that one bone step changes are made and sent
  double model_bytes = 0.0;  ///< [bytes] of the bone model
  double peak = 0.0;         ///< [bytes] peak resident memory of the process up to the end of drilling
  double peak_drawn = 0.0;   ///< [bytes] the same with pictures

  // Results.
  double bone_voxels = 0.0;           ///< [voxels] of the bone model
  double removed = 0.0;               ///< [m^3] of solid bone
  double depth = 0.0;                 ///< [m] of the tip below the entry at the end
  std::vector<double> forces;         ///< [N] magnitude at each contact tick
  std::vector<std::uint64_t> hashes;  ///< of `remaining` round the entry: when drilled, and after the undo
};

/// @returns the edges of the volumes that the area compares [voxels].
[[nodiscard]] std::vector<int> growth_edges();

/// @param edge of the volume [voxels], a multiple of 64. @param quick a tenth of the time in bone, and fewer repetitions.
[[nodiscard]] Result<GrowthRun> run_growth(int edge, bool quick);
/// run_growth() in this process; its result goes to stdout, for run_growth_apart(). @returns the error of the run.
[[nodiscard]] Status print_growth(int edge, bool quick);
/// run_growth() in a new process of this program at the SIMD level in use. internal: the process failed; its message is on stderr.
[[nodiscard]] Result<GrowthRun> run_growth_apart(int edge, bool quick);

}  // namespace burrhole
