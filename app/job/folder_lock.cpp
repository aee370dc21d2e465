#include "app/job/folder_lock.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "app/stage/result_files.h"
#include "core/base/descriptor.h"

namespace burrhole {
namespace {

/// @returns what the file says of the run that has it.
std::string owner_of(int file) {
  std::array<char, 128> text{};
  const ssize_t size = repeat_interrupted([&] { return pread(file, text.data(), text.size(), 0); });
  std::string out(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out.empty() ? "another process" : out;
}

Error failed(const std::string& path, const char* what) { return bad_input(std::string(what) + ": " + std::strerror(errno), path); }

}  // namespace

Result<FolderLock> FolderLock::take(const std::string& folder, const char* option) {
  if (folder.empty()) return FolderLock({}, -1);
  const std::string path = (std::filesystem::path(folder) / kLockFile).string();
  for (;;) {
    const int file = open_descriptor(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW, 0644);
    if (file < 0) return failed(path, "the output folder cannot be locked by this file (if no run uses it, remove it)");
    FolderLock lock(path, file);
    if (repeat_interrupted([&] { return flock(file, LOCK_EX | LOCK_NB); }) != 0) {
      lock.path_.clear();  // it is the other's
      const bool cannot = errno == ENOLCK || errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL;
      if (cannot) return lock;  // a file system without locks
      if (errno != EWOULDBLOCK) return failed(path, "the output folder cannot be locked");
      return bad_input(fmt::format("the output folder is in use by {}: give another one by {}", owner_of(file), option), folder);
    }
    // Its last owner may have removed the file between open() and flock().
    struct stat opened {
    }, present{};
    if (fstat(file, &opened) != 0 || stat(path.c_str(), &present) != 0 || opened.st_ino != present.st_ino ||
        opened.st_dev != present.st_dev) {
      lock.path_.clear();
      continue;
    }
    const std::string text = fmt::format("process {} since {:%Y-%m-%d %H:%M:%S} UTC\n", getpid(), fmt::gmtime(std::time(nullptr)));
    const bool emptied = repeat_interrupted([&] { return ftruncate(file, 0); }) == 0;
    if (!emptied || repeat_interrupted([&] { return pwrite(file, text.data(), text.size(), 0); }) != static_cast<ssize_t>(text.size()))
      return failed(path, "the output folder cannot be locked");
    return lock;
  }
}

FolderLock::FolderLock(FolderLock&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {
  other.path_.clear();
}

FolderLock::~FolderLock() {
  if (file_ < 0) return;
  if (!path_.empty()) unlink(path_.c_str());  // before the lock ends, so that nobody else's file is removed
  close(file_);
}

}  // namespace burrhole
