/// app/cli/film.h: writes the frames of a run's film: as PNG files in a folder, or as a video by ffmpeg.
///   Thread  one at a time.   Errors  bad_input: a file or folder cannot be written; unavailable: there is no ffmpeg, or it fails.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {
struct Scene;
}

namespace burrhole::cli {

/// Values of --video, --video-fps and --force.
struct FilmOptions {
  std::string path;        ///< a folder or a video file; empty: no film
  int fps = 25;            ///< [1/s] frames, of simulated time
  bool replace = false;    ///< frames in the folder are replaced
  std::string run_folder;  ///< that of the run's results, which the run itself takes; empty: none
};

class FilmWriter {
 public:
  /// @param options path ends in .mp4, .mkv or .webm: a video; without an ending, or if it exists: a folder, which the first frame makes and
  /// which belongs to this process while the writer lives. A folder that holds files with names of frames is refused unless `replace` is set:
  /// then the first frame removes them.
  [[nodiscard]] static Result<std::unique_ptr<FilmWriter>> create(const FilmOptions& options);
  virtual ~FilmWriter() = default;
  /// Adds a frame. All frames must have the size of the first.
  [[nodiscard]] virtual Status add(const Image& image) = 0;
  /// Completes the film. A video has its name from then on; if this is not called, none is left. Without a frame what is there stays.
  [[nodiscard]] virtual Status finish() = 0;
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }

 protected:
  std::size_t frames_ = 0;
};

/// @returns the writer of a film of a scene's run; bad_input also if the frames do not divide the servo rate. @pre the scene has [display].
[[nodiscard]] Result<std::unique_ptr<FilmWriter>> make_film(const Scene& scene, const FilmOptions& options);

}  // namespace burrhole::cli
