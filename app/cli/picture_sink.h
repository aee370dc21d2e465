/// app/cli/picture_sink.h: the engine's display made of the offscreen renderer: pictures as PNG files of one folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/engine/frame_step.h"
#include "app/engine/tip_slices.h"

namespace burrhole::cli {

/// A sink that also tells which files it wrote. `folder` empty: draws and counts, writes nothing.
class PictureSink : public FrameSink {
 public:
  [[nodiscard]] virtual const std::vector<std::string>& files() const = 0;
  [[nodiscard]] virtual std::string driver() const = 0;  ///< what draws, in one line
};

/// @param display how bone is drawn. @param gl a word of --gl. @returns ErrorCode::unavailable where no such OpenGL or no renderer is.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> make_picture_sink(const std::string& folder, const DisplayScene& display,
                                                                     const std::string& gl);

/// Slices as one PNG file, side by side with labels, the tool's outline and a scale bar; needs no OpenGL.
[[nodiscard]] Status write_tip_slices(const std::string& file, const TipSlices& slices);

}  // namespace burrhole::cli
