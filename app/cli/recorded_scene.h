/// app/cli/recorded_scene.h: the scene of a recorded session, for replays.
///   Thread  main.   Errors  those of load_scene(); bad_input for a file that cannot be written.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/report/scratch_folder.h"
#include "app/scene/load.h"
#include "app/session/session.h"

namespace burrhole::cli {

/// @returns the session file of a folder of results, or the path itself if it is none. bad_input: the folder holds no session.
[[nodiscard]] Result<std::string> session_of(const std::string& file_or_folder);

/// @param display whether pictures will be drawn; otherwise [display] is removed. @param ticks of the session, which set the duration.
[[nodiscard]] Result<LoadedScene> load_recorded(const SessionReader& session, std::size_t ticks, bool display);

/// @returns the hash of the scene's bone now and in the recorded run, "volume" of the session's hashes; nothing where it was generated, or the
/// session has none.
struct BoneHashes {
  std::string recorded, now;
};
[[nodiscard]] std::optional<BoneHashes> bone_hashes(const SessionReader& session, const LoadedScene& loaded);
/// @returns one line if the bone that the scene names is not that of the recorded run; empty if it is, or if that is not known.
[[nodiscard]] std::string changed_bone(const SessionReader& session, const LoadedScene& loaded);

/// @returns why a replay's voxels and forces could not be expected to be equal; empty when they could.
[[nodiscard]] std::string why_different(const SessionMeta& meta);

/// A file that a session holds, in a temporary folder.
class RecordedFile {
 public:
  /// Writes that of the events of a kind, if there is one: "restore", the checkpoint from which the run started, or "markups", its plan.
  [[nodiscard]] Status write(const SessionReader& session, const std::string& kind);
  [[nodiscard]] const std::string& path() const { return path_; }  ///< empty: none

 private:
  std::unique_ptr<ScratchFolder> folder_;
  std::string path_;
};

}  // namespace burrhole::cli
