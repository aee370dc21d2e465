/// app/cli/picture_sink.h: the engine's display made of the offscreen renderer: pictures as PNG files of one folder.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/job/picture_sink.h"
#include "app/view/tip_slices.h"

namespace burrhole::cli {

struct PictureAsked {
  std::string folder;                              ///< of the pictures; empty: none is written
  std::string gl = "auto";                         ///< a word of --gl
  std::string shader_folder{};                     ///< of --shader-dir; empty: the shaders as built in
  std::function<void(const std::string&)> tell{};  ///< one line when a budget has chosen the quality; may be empty
};

/// @param display how bone is drawn. @returns ErrorCode::unavailable where no such OpenGL or no renderer is, bad_input for a faulty shader.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig& display, const PictureAsked& asked);

/// Slices as one PNG file, side by side with labels, the tool's outline and a scale bar; needs no OpenGL.
[[nodiscard]] Status write_tip_slices(const std::string& file, const TipSlices& slices);

}  // namespace burrhole::cli
