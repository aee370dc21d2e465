/// app/cli/film.h: writes the frames of a run's film: as PNG files in a folder, or as a video by ffmpeg.
///   Thread  one at a time.   Errors  bad_input: a file or folder cannot be written; unavailable: there is no ffmpeg, or it fails.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole::cli {

class FilmWriter {
 public:
  /// @param path ends in .mp4, .mkv or .webm: a video; without an ending, or if it exists: a folder. The first frame makes the folder, and
  /// removes the frames of an earlier film from it.
  /// The folder belongs to this process while the writer lives. @param rate [1/s] frames a second, > 0. @param run_folder that of the run's
  /// results, which the run itself takes; empty: none.
  [[nodiscard]] static Result<std::unique_ptr<FilmWriter>> create(const std::string& path, int rate, const std::string& run_folder);
  virtual ~FilmWriter() = default;
  /// Adds a frame. All frames must have the size of the first.
  [[nodiscard]] virtual Status add(const Image& image) = 0;
  /// Completes the film. A video has its name from then on; if this is not called, none is left. Without a frame an earlier film is removed.
  [[nodiscard]] virtual Status finish() = 0;
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }

 protected:
  std::size_t frames_ = 0;
};

}  // namespace burrhole::cli
