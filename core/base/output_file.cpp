#include "core/base/output_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/descriptor.h"

namespace burrhole {
namespace {

constexpr std::size_t kBuffer = 65536;        ///< [bytes]
constexpr int kTries = 100;                   ///< names of temporary files, of which each is free almost surely
constexpr int kMostLinks = 40;                ///< in a row, as Linux follows
constexpr std::size_t kRandomDigits = 16;     ///< hexadecimal, of such a name
constexpr std::size_t kLongestName = 255;     ///< [bytes] NAME_MAX of Linux
constexpr std::string_view kEnding = ".tmp";  // NAME.PROCESS-RANDOM.tmp
constexpr int kMostEntries = 10'000;          ///< of a folder that are searched for temporary files of dead processes: about 2 ms

/// @returns 0, or errno of the first write that failed. @param stop as of open_descriptor().
int write_all(int file, std::span<const std::byte> bytes, const std::atomic<bool>* stop = nullptr) noexcept {
  while (!bytes.empty()) {
    const ssize_t count = repeat_interrupted([&] { return ::write(file, bytes.data(), bytes.size()); }, stop);
    if (count <= 0) return count < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    if (!bytes.empty() && is_stopped(stop)) return EINTR;  // a signal ends a write that has begun with a count, not with an error
  }
  return 0;
}

/// @returns 0, or errno. What cannot be synchronised (a pipe, some network file systems) is no error.
int sync(int file) noexcept {
  if (repeat_interrupted([&] { return ::fsync(file); }) == 0) return 0;
  return errno == EINVAL || errno == ENOTSUP || errno == EROFS ? 0 : errno;
}

std::pair<std::string, std::string> folder_and_name(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {{}, path};
  return {path.substr(0, slash + 1), path.substr(slash + 1)};
}

/// Puts the new name on the disk. A folder that may not be opened is left to the system.
int sync_folder_of(const std::string& path) noexcept {
  const std::string folder = folder_and_name(path).first;
  const Descriptor file(open_descriptor(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY));
  return file.get() < 0 ? 0 : sync(file.get());
}

/// @returns a name beside `path` that no other process or thread chooses. @param number of the try.
std::string temporary_name(const std::string& path, int number) {
  std::uint64_t random = 0;
  if (::getrandom(&random, sizeof random, 0) != static_cast<ssize_t>(sizeof random))
    random =
        static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(&random)) + static_cast<std::uint64_t>(number);  // O_EXCL does the rest
  const std::string ending = fmt::format(".{}-{:016x}{}", ::getpid(), random, kEnding);
  auto [folder, name] = folder_and_name(path);
  name.resize(std::min(name.size(), kLongestName - ending.size()));
  return folder + name + ending;
}

/// @returns the process in the name of a temporary file.
pid_t process_of(std::string_view temporary) noexcept {
  const std::string_view without_end = temporary.substr(0, temporary.rfind('-'));
  pid_t process = 0;
  const std::string_view digits = without_end.substr(without_end.rfind('.') + 1);
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), process);
  return read.ec == std::errc() ? process : 0;
}

/// Removes a temporary file if it is this user's, its process has gone, and nobody holds the lock that its writer has. A writer on another
/// machine, or whose processes are numbered anew, has it.
void remove_if_dead(int folder, const char* name) noexcept {
  const pid_t process = process_of(name);
  if (process <= 0 || ::kill(process, 0) == 0 || errno != ESRCH) return;
  const Descriptor file(::openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != ::geteuid()) return;
  if (::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlinkat(folder, name, 0);
}

/// Removes what killed processes have left of writing to `path`. Errors are no errors of the write.
void remove_dead(const std::string& path) noexcept {
  const std::size_t slash = path.rfind('/');
  const std::string_view name = std::string_view(path).substr(slash == std::string::npos ? 0 : slash + 1);
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir(slash == std::string::npos ? "." : path.substr(0, slash + 1).c_str()),
                                                   ::closedir);
  if (!folder) return;
  std::vector<std::string> found;
  for (int n = 0; n < kMostEntries; ++n) {
    const dirent* entry = ::readdir(folder.get());
    if (entry == nullptr) break;
    if (is_temporary_of(entry->d_name, name)) found.emplace_back(entry->d_name);
  }
  for (const std::string& one : found) remove_if_dead(::dirfd(folder.get()), one.c_str());
}

/// @returns what a symbolic link leads to, whether it is there or not; another path as it is.
std::string behind_link(std::string path) {
  for (int n = 0; n < kMostLinks; ++n) {
    std::string to(PATH_MAX, '\0');
    const ssize_t size = ::readlink(path.c_str(), to.data(), to.size());
    if (size <= 0) break;  // no link
    to.resize(static_cast<std::size_t>(size));
    path = to.starts_with('/') ? to : folder_and_name(path).first + to;
  }
  return path;
}

/// Gives a new file the group and the permissions of the one that it will replace. Where the group is refused, it gets no rights. A file
/// system without permissions refuses both.
void copy_rights(int file, const struct stat& old) noexcept {
  const bool same_group = ::fchown(file, static_cast<uid_t>(-1), old.st_gid) == 0;
  static_cast<void>(::fchmod(file, old.st_mode & (same_group ? 0777 : 0707)));
}

/// Appends, or leaves the file as it was before. @param is_new this process has made it, empty. @returns 0, or errno.
int append(Descriptor& file, const struct stat& before, bool is_new, const std::string& path, std::string_view text) {
  const std::string target = behind_link(path);
  int code = write_all(file.get(), std::as_bytes(std::span(text)));
  if (code == 0) code = sync(file.get());
  if (code == 0 && is_new) code = sync_folder_of(target);
  if (code == 0) return file.close();
  if (is_new)
    ::unlink(target.c_str());
  else if (S_ISREG(before.st_mode))
    static_cast<void>(::ftruncate(file.get(), before.st_size));
  return code;
}

/// What to do, for the reasons that a user can remove.
const char* remedy_of(int code) noexcept {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      return ": free space there, or name another place";
    case EFBIG:
      return ": raise the limit of the size of files (ulimit -f), or name a place on another file system";
    case EISDIR:
      return ": name a file";
    case EACCES:
    case EPERM:
    case EROFS:
      return ": name a place that may be written";
    case ENOTDIR:
      return ": a part of its path is a file, not a folder";
    default:
      return "";
  }
}

}  // namespace

struct OutputFile::State {
  std::string path;  // as given, for errors
  const std::atomic<bool>* stop = nullptr;
  std::string target;     // behind links
  std::string temporary;  // empty: the target is written directly, or the temporary file has gone
  Descriptor file;
  std::vector<std::byte> buffer;
  std::uint64_t flushed = 0, end = 0;  // [bytes] position of the descriptor; largest position written
  Status status;

  ~State() {
    if (!temporary.empty()) ::unlink(temporary.c_str());
  }
  [[nodiscard]] Status fail(int code) {
    if (status) status = code == EINTR && is_stopped(stop) ? stopped_error(path) : write_error(path, code);
    return status;
  }
  [[nodiscard]] Status check_stop() {
    if (status && is_stopped(stop)) status = stopped_error(path);
    return status;
  }
  [[nodiscard]] int open_temporary(mode_t mode) {
    for (int n = 0; n < kTries; ++n) {
      std::string name = temporary_name(target, n);
      file = Descriptor(open_descriptor(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, mode));
      if (file.get() >= 0) temporary = std::move(name);
      if (file.get() >= 0 || errno != EEXIST) break;
    }
    if (file.get() < 0) return errno;
    static_cast<void>(::flock(file.get(), LOCK_EX | LOCK_NB));  // see remove_if_dead()
    return 0;
  }
  [[nodiscard]] Status put(std::span<const std::byte> bytes) {
    if (const int code = write_all(file.get(), bytes, stop); code != 0) return fail(code);
    flushed += bytes.size();
    end = std::max(end, flushed);
    return status;
  }
  [[nodiscard]] Status flush() {
    if (!status || buffer.empty()) return status;
    Status written = put(buffer);
    buffer.clear();
    return written;
  }
};

OutputFile::OutputFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<OutputFile> OutputFile::create(const std::string& path, const std::atomic<bool>* stop) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->stop = stop;
  struct stat old {};
  const bool is_there = ::stat(path.c_str(), &old) == 0;
  if (!is_there && errno != ENOENT) return write_error(path, errno);
  if (is_there && S_ISDIR(old.st_mode)) return write_error(path, EISDIR);
  if (is_there && !S_ISREG(old.st_mode)) {
    state->file = Descriptor(open_descriptor(path.c_str(), O_WRONLY, 0, stop));
    if (state->file.get() < 0) return state->fail(errno).error();
  } else {
    // A rename would also replace a file that is protected against writing.
    if (is_there && ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) return write_error(path, errno);
    state->target = behind_link(path);
    // That of a link's target is not made: a link into nowhere may be one to a medium that is not mounted.
    if (const std::filesystem::path folder = std::filesystem::path(path).parent_path(); !is_there && !folder.empty()) {
      std::error_code error;
      std::filesystem::create_directories(folder, error);
      if (error) return write_error(path, error.value());
    }
    // Who may read the old file may read the new one, and nobody else, at no time.
    if (const int code = state->open_temporary(is_there ? 0600 : 0666); code != 0) return write_error(path, code);
    if (is_there) copy_rights(state->file.get(), old);
    remove_dead(state->target);
  }
  state->buffer.reserve(kBuffer);
  return OutputFile(std::move(state));
}

Status OutputFile::write(std::span<const std::byte> bytes) {
  State& s = *state_;
  if (Status goes_on = s.check_stop(); !goes_on) return goes_on;
  if (s.buffer.size() + bytes.size() > kBuffer)
    if (Status flushed = s.flush(); !flushed) return flushed;
  if (bytes.size() >= kBuffer) return s.put(bytes);
  s.buffer.insert(s.buffer.end(), bytes.begin(), bytes.end());
  return s.status;
}

Status OutputFile::seek(std::uint64_t position) {
  State& s = *state_;
  if (Status flushed = s.flush(); !flushed) return flushed;
  if (::lseek(s.file.get(), static_cast<off_t>(position), SEEK_SET) < 0) return s.fail(errno);
  s.flushed = position;
  return s.status;
}

std::uint64_t OutputFile::position() const noexcept { return state_->flushed + state_->buffer.size(); }

const std::string& OutputFile::temporary() const noexcept { return state_->temporary; }

Result<std::uint64_t> OutputFile::commit() {
  State& s = *state_;
  if (const Status goes_on = s.check_stop(); !goes_on) return goes_on.error();
  if (const Status flushed = s.flush(); !flushed) return flushed.error();
  if (const int code = sync(s.file.get()); code != 0) return s.fail(code).error();
  if (const int code = s.file.close(); code != 0) return s.fail(code).error();
  if (s.temporary.empty()) return s.end;
  if (std::rename(s.temporary.c_str(), s.target.c_str()) != 0) return s.fail(errno).error();
  s.temporary.clear();
  if (const int code = sync_folder_of(s.target); code != 0) return s.fail(code).error();
  return s.end;
}

Status append_to_file(const std::string& path, std::string_view text) {
  for (int n = 0; n < kTries; ++n) {
    Descriptor file(open_descriptor(path.c_str(), O_WRONLY | O_APPEND));
    const bool is_new = file.get() < 0 && errno == ENOENT;
    if (is_new) file = Descriptor(open_descriptor(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666));
    if (file.get() < 0) return write_error(path, errno);
    // What is cut off after an error is this process's own. Some file systems have no locks.
    static_cast<void>(repeat_interrupted([&] { return ::flock(file.get(), LOCK_EX); }));
    struct stat before {
    }, named{};
    if (::fstat(file.get(), &before) != 0) return write_error(path, errno);
    const bool same = ::stat(path.c_str(), &named) == 0 && named.st_ino == before.st_ino && named.st_dev == before.st_dev;
    if (!same) continue;  // whoever made it could not write, and removed it
    if (const int code = append(file, before, is_new && before.st_size == 0, path, text); code != 0) return write_error(path, code);
    return {};
  }
  return write_error(path, EBUSY);
}

Error write_error(const std::string& path, int code) {
  return bad_input(std::string("cannot be written: ") + std::strerror(code) + remedy_of(code), path);
}

Status check_folder_of(const std::string& path) {
  std::error_code ignored;
  std::filesystem::path folder = std::filesystem::absolute(path, ignored).parent_path();
  while (folder.has_relative_path() && !std::filesystem::exists(folder, ignored)) folder = folder.parent_path();
  if (!std::filesystem::is_directory(folder, ignored)) return write_error(path, ENOTDIR);
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) return write_error(path, errno);
  return {};
}

Error stopped_error(const std::string& path) {
  return {ErrorCode::unavailable, "the writing was stopped: the file is as it was before", path};
}

bool is_temporary_of(std::string_view name, std::string_view of) noexcept {
  if (!name.starts_with(of) || !name.ends_with(kEnding) || name.size() <= of.size() + kEnding.size()) return false;
  const std::string_view middle = name.substr(of.size(), name.size() - of.size() - kEnding.size());
  const std::size_t dash = middle.find('-');
  if (middle[0] != '.' || dash == std::string_view::npos || dash < 2 || middle.size() != dash + 1 + kRandomDigits) return false;
  return middle.substr(1, dash - 1).find_first_not_of("0123456789") == std::string_view::npos &&
         middle.substr(dash + 1).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace burrhole
