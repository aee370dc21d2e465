/// app/job/picture_sink.h: interface of a display that writes pictures to files. The program implements it; a window or a client may too.
///   Thread  the one that runs the simulation's frame step.   Errors  unavailable.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/job/summary.h"
#include "app/view/display_config.h"
#include "app/view/frame_step.h"

namespace burrhole {

class PictureSink : public FrameSink {
 public:
  /// Waits until the pictures drawn so far are in their files. @returns the paths, or the error of the first that could not be written; draw()
  /// returns that error too.
  [[nodiscard]] virtual Result<std::vector<std::string>> files() = 0;
  [[nodiscard]] virtual std::string driver() const = 0;  ///< name of the renderer, one line
  /// Renderer and drawing quality for summary.json. A quality chosen by a budget is known after the first picture.
  [[nodiscard]] virtual RunSummary::Display display() const = 0;
};

/// Creates a sink that writes into a folder. @param folder empty: pictures are drawn and hashed, not written. unavailable: no renderer.
using MakePictureSink = std::function<Result<std::unique_ptr<PictureSink>>(const DisplayConfig& display, const std::string& folder)>;

}  // namespace burrhole
