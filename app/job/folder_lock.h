/// app/job/folder_lock.h: an output folder belongs to one process at a time: a run, a study, a comparison, a film.
///   The file .burrhole-run in the folder is locked meanwhile, and holds the number and start of the process. The lock ends with the process,
///   however it ends. On a file system without locks nothing is locked.
///   Thread  any.   Errors  bad_input: another process has the folder, or the file cannot be written.   Source  flock(2).
#pragma once

#include <string>

#include "core/base/result.h"

namespace burrhole {

class FolderLock {
 public:
  /// @param folder exists. An empty name locks nothing. @param option that names the folder, for errors.
  [[nodiscard]] static Result<FolderLock> take(const std::string& folder, const char* option = "--out");
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) = delete;
  ~FolderLock();

 private:
  FolderLock(std::string path, int file) : path_(std::move(path)), file_(file) {}
  std::string path_;
  int file_ = -1;
};

}  // namespace burrhole
