/// app/cli/recorded_scene.h: the scene of a recorded session, for replays.
///   Thread  main.   Errors  those of load_scene(); bad_input for a file that cannot be written.
#pragma once

#include <string>

#include "app/scene/load.h"
#include "app/session/session.h"

namespace burrhole::cli {

/// @param display whether pictures will be drawn; otherwise [display] is removed. @param ticks of the session, which set the duration.
[[nodiscard]] Result<LoadedScene> load_recorded(const SessionReader& session, std::size_t ticks, bool display);

/// @returns why a replay's voxels and forces could not be expected to be equal; empty when they could.
[[nodiscard]] std::string why_different(const SessionMeta& meta);

/// A temporary file for a file that a session holds.
class RecordedFile {
 public:
  RecordedFile() = default;
  RecordedFile(const RecordedFile&) = delete;
  RecordedFile& operator=(const RecordedFile&) = delete;
  ~RecordedFile();
  /// Writes that of the events of a kind, if there is one: "restore", the checkpoint from which the run started, or "markups", its plan.
  [[nodiscard]] Status write(const SessionReader& session, const std::string& kind);
  [[nodiscard]] const std::string& path() const { return path_; }  ///< empty: none

 private:
  std::string path_;
};

}  // namespace burrhole::cli
