/// app/job/bone_exports.h: files of the bone as it is at a moment of a run. The bone is copied while the clocks stand; a thread writes the file.
///   Frame   as volumes/export_bone.h.   Units  SI; names of files hold the time [s].
///   Memory  the blocks that tools have changed, and what export_bone() takes. The predicted memory of a run does not include it.
///   Errors  bad_input: no output folder, unknown format, and those of export_bone(); unavailable: no thread.   Thread  one.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "core/base/result.h"
#include "core/voxel/voxmap.h"
#include "volumes/export_bone.h"

namespace burrhole {

/// Writes a file of the bone: a mesh by ball pivoting, as the mesh that is drawn; by dual contouring where the bone is too long for that. A path
/// that cannot be written is found before a mesh is made. @param made called when there is what the file shall hold, before it is written; may
/// be empty. Errors as export_bone(), and those of an exception.
[[nodiscard]] Result<ExportReport> write_bone(const Voxmap& bone, const std::string& path, const std::function<void()>& made = {});

class BoneExports {
 public:
  struct Config {
    std::string folder;                                               ///< of the outputs; empty: none
    std::shared_ptr<const BoneModel> bone;                            ///< as loaded
    std::function<void(const std::string& line, bool failed)> say{};  ///< of each file, from another thread; may be empty
  };
  explicit BoneExports(Config config) : config_(std::move(config)) {}
  BoneExports(const BoneExports&) = delete;
  BoneExports& operator=(const BoneExports&) = delete;
  ~BoneExports() { (void)finish(); }

  /// Copies the bone and begins a file; waits for the one before.
  /// @param bone written back (Voxmap::write_back()); it may change afterwards. @param time [s] of the run.
  /// @param format ending of the file without its dot. @returns the file's name.
  [[nodiscard]] Result<std::string> begin(const Voxmap& bone, double time, const std::string& format);
  /// Waits until all files are written. @returns the first error of a file.
  [[nodiscard]] Status finish();

 private:
  [[nodiscard]] Result<std::unique_ptr<Voxmap>> copy_of(const Voxmap& bone) const;
  void write(const Voxmap& bone, const std::string& name);

  Config config_;
  std::unique_ptr<Voxmap> copy_;
  Status written_;  // of the thread; read when it has ended
  std::thread writing_;
};

}  // namespace burrhole
