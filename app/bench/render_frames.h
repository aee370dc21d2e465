/// app/bench/render_frames.h: how many pictures a second a back end of OpenGL draws, for machines with a GPU; docs/gpu.md.
#pragma once

#include <string>

#include "app/bench/bench.h"

namespace burrhole {

/// What `render --gl BACKEND` asks for.
struct FramesAsked {
  std::string gl;                   ///< word of --gl
  int width = 1920, height = 1080;  ///< [pixels]
  std::string csv;                  ///< file to write
};

/// Volumes of 128^3, 256^3 and 512^3 voxels (quick: 64^3), by first hit and as translucent bone, whole pictures read back, by the clock.
/// Writes the CSV and adds rows. @returns ErrorCode::unavailable where that back end is not.
[[nodiscard]] Status bench_frames(Bench& bench, const FramesAsked& asked);

}  // namespace burrhole
