/// app/job/picture_sink.h: a display that keeps pictures as files. Implemented by whoever draws: the program, a window, a client.
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
  /// Paths of the pictures written so far.
  [[nodiscard]] virtual const std::vector<std::string>& files() const = 0;
  [[nodiscard]] virtual std::string driver() const = 0;  ///< what draws, in one line
  /// The same for summary.json, with the quality that pictures have; where a budget chooses it, the first picture does.
  [[nodiscard]] virtual RunSummary::Display display() const = 0;
};

/// Makes a sink for pictures of a folder. @param folder empty: pictures are drawn and hashed, not written. Errors: unavailable where nothing
/// can draw.
using MakePictureSink = std::function<Result<std::unique_ptr<PictureSink>>(const DisplayConfig& display, const std::string& folder)>;

}  // namespace burrhole
