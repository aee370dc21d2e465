#include "core/voxel/bone_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/resource.h>
#include <sys/statfs.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>
#include <vector>

namespace burrhole {
namespace {

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6); }

std::string text_of(int number) { return std::generic_category().message(number); }

/// The text of an error says how large the file is predicted to be, and what to do.
Error no_room(const BoneStorage& storage, const std::string& what) {
  const std::string needed =
      storage.expected_bytes > 0 ? fmt::format("; it needs about {}", megabytes(storage.expected_bytes)) : std::string();
  return {ErrorCode::unavailable,
          fmt::format("the temporary file of the bone in {} {}{}; TMPDIR may name another folder", storage.folder, what, needed),
          {}};
}

/// Opens a file without a name; where the file system has none, a file whose name is removed at once.
int open_unnamed(const std::string& folder) {
#ifdef O_TMPFILE
  if (const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600); descriptor >= 0) return descriptor;
#endif
  const std::string path = folder + "/burrhole-bone-XXXXXX";
  std::vector<char> name(path.begin(), path.end());
  name.push_back('\0');
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) unlink(name.data());
  return descriptor;
}

/// Bytes that may be written to a file by this process; beyond them the system ends it by a signal.
std::uint64_t process_limit() noexcept {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::numeric_limits<std::uint64_t>::max() / 2;
  return limit.rlim_cur;
}

}  // namespace

std::string temporary_folder() {
  const char* const given = std::getenv("TMPDIR");
  return given != nullptr && *given != '\0' ? given : "/var/tmp";
}

bool is_in_memory(const std::string& folder) noexcept {
  struct statfs facts {};
  return statfs(folder.c_str(), &facts) == 0 && (facts.f_type == TMPFS_MAGIC || facts.f_type == RAMFS_MAGIC);
}

Result<BoneFile> BoneFile::create(const BoneStorage& storage) {
  const int descriptor = open_unnamed(storage.folder);
  if (descriptor < 0) return no_room(storage, "cannot be made: " + text_of(errno));
  BoneFile out(descriptor, storage);
  out.storage_.most_bytes = std::min(storage.most_bytes, process_limit());
  struct statvfs facts {};
  if (fstatvfs(descriptor, &facts) != 0) return out;
  const std::uint64_t free = static_cast<std::uint64_t>(facts.f_bavail) * facts.f_frsize;
  if (free < storage.expected_bytes) return no_room(storage, fmt::format("does not fit: {} are free", megabytes(free)));
  return out;
}

BoneFile::BoneFile(int descriptor, BoneStorage storage) : descriptor_(descriptor), storage_(std::move(storage)) {}
BoneFile::BoneFile(BoneFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), storage_(std::move(other.storage_)), size_(other.size_) {}
BoneFile::~BoneFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

Status BoneFile::write(std::uint64_t at, std::span<const std::byte> from) {
  const auto refuse = [&](const std::string& why) {
    return no_room(storage_, fmt::format("cannot grow beyond {}: {}", megabytes(size_), why));
  };
  if (at + from.size() > storage_.most_bytes) return refuse(text_of(EFBIG));
  while (!from.empty()) {
    const ssize_t count = pwrite(descriptor_, from.data(), from.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return refuse(text_of(count < 0 ? errno : ENOSPC));
    from = from.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
    size_ = std::max(size_, at);
  }
  return {};
}

int BoneFile::read(std::uint64_t at, std::span<std::byte> out) const noexcept {
  while (!out.empty()) {
    const ssize_t count = pread(descriptor_, out.data(), out.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    out = out.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  return 0;
}

Error BoneFile::read_error(int number) const {
  return {ErrorCode::unavailable,
          fmt::format("the temporary file of the bone in {} cannot be read: {}; bone is missing from here on", storage_.folder,
                      text_of(number)),
          {}};
}

}  // namespace burrhole
