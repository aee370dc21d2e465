/// app/cli/picture_sink.h: the engine's display made of the offscreen renderer: pictures as PNG files of one folder.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/engine/frame_step.h"
#include "app/engine/summary.h"
#include "app/engine/tip_slices.h"

namespace burrhole::cli {

/// A sink that also tells which files it wrote. `folder` empty: draws and counts, writes nothing.
class PictureSink : public FrameSink {
 public:
  [[nodiscard]] virtual const std::vector<std::string>& files() const = 0;
  [[nodiscard]] virtual std::string driver() const = 0;  ///< what draws, in one line
  /// The same for summary.json, with the quality that pictures have; where a budget chooses it, the first picture does.
  [[nodiscard]] virtual RunSummary::Display display() const = 0;
};

struct PictureAsked {
  std::string folder;                              ///< of the pictures; empty: none is written
  std::string gl = "auto";                         ///< a word of --gl
  std::string shader_folder{};                     ///< of --shader-dir; empty: the shaders as built in
  std::function<void(const std::string&)> tell{};  ///< one line when a budget has chosen the quality; may be empty
};

/// @param display how bone is drawn. @returns ErrorCode::unavailable where no such OpenGL or no renderer is, bad_input for a faulty shader.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayScene& display, const PictureAsked& asked);

/// Slices as one PNG file, side by side with labels, the tool's outline and a scale bar; needs no OpenGL.
[[nodiscard]] Status write_tip_slices(const std::string& file, const TipSlices& slices);

}  // namespace burrhole::cli
