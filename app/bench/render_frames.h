/// app/bench/render_frames.h: measures pictures per second of an OpenGL back end, for machines with a GPU; see docs/gpu.md.
///   Thread  main.   Errors  unavailable, bad_input for a file that cannot be written.
#pragma once

#include <string>

#include "app/bench/bench.h"

namespace burrhole {

/// Arguments of `render --gl BACKEND`.
struct FramesRequest {
  std::string gl;                   ///< value of --gl
  int width = 1920, height = 1080;  ///< [pixels]
  std::string csv;                  ///< file to write
};

/// Draws volumes of 128^3, 256^3 and 512^3 voxels (quick: 64^3), by first hit, as translucent bone and as a mesh; each picture is complete and
/// read back. Then the same with a change of 20^3 voxels before each picture. Wall time. Writes the CSV and adds rows. @returns unavailable if the build or machine lacks that back end.
[[nodiscard]] Status bench_frames(Bench& bench, const FramesRequest& request);

}  // namespace burrhole
