#include "core/base/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include "core/base/descriptor.h"

namespace burrhole {
namespace {

constexpr std::size_t kBlock = 1u << 16;  // [bytes] of one read

Error cannot_read(const std::string& path, int code) {
  // A socket or a device without a driver cannot be opened.
  if (code == ENXIO || code == ENODEV) return bad_input("is a socket or a device: give a regular file", path);
  return bad_input(std::string("cannot be read: ") + std::strerror(code), path);
}

const char* kind_of(mode_t mode) noexcept {
  if (S_ISDIR(mode)) return "is a folder: give a file";
  if (S_ISFIFO(mode)) return "is a pipe: write its content into a regular file first, and give that";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "is a device: give a regular file";
  return "is not a regular file: give one";
}

struct Opened {
  Descriptor file;
  std::uint64_t bytes = 0;
};

/// O_NONBLOCK: a pipe without a writer would wait for one.
Result<Opened> open_regular(const std::string& path) {
  if (path.empty()) return bad_input("names no file: the path is empty");
  if (path.find('\0') != std::string::npos) return bad_input("a path must not contain a byte 0", path);
  Descriptor file(open_descriptor(path.c_str(), O_RDONLY | O_NONBLOCK));
  if (file.get() < 0) return cannot_read(path, errno);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return cannot_read(path, errno);
  if (!S_ISREG(status.st_mode)) return bad_input(kind_of(status.st_mode), path);
  return Opened{std::move(file), static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0))};
}

Error too_large(const std::string& path, const FileLimit& kind) {
  return bad_input(fmt::format("is larger than {} bytes, the most that {} may have", kind.most_bytes, kind.name), path);
}

}  // namespace

Result<std::string> read_input(const std::string& path, const FileLimit& kind) {
  const auto opened = open_regular(path);
  if (!opened) return opened.error();
  if (opened->bytes > kind.most_bytes) return too_large(path, kind);
  try {
    // The size is a hint: files of /proc report 0, and a file may grow while it is read. One byte more shows the end without new memory.
    std::string out(opened->bytes > 0 ? static_cast<std::size_t>(opened->bytes) + 1 : kBlock, '\0');
    std::size_t had = 0;
    for (;;) {
      if (had == out.size()) out.resize(had + kBlock);
      const ssize_t got = repeat_interrupted([&] { return ::read(opened->file.get(), out.data() + had, out.size() - had); });
      if (got < 0) return cannot_read(path, errno);
      had += static_cast<std::size_t>(got);
      if (had > kind.most_bytes) return too_large(path, kind);
      if (got == 0) break;
    }
    out.resize(had);
    if (kind.text)
      if (Status whole = check_no_zero_byte(out, path); !whole) return whole.error();
    return out;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::unavailable, fmt::format("there is no memory for its {} bytes", opened->bytes), path};
  }
}

Status check_regular_file(const std::string& path) {
  const auto opened = open_regular(path);
  return opened ? Status() : Status(opened.error());
}

Status check_no_zero_byte(std::string_view text, const std::string& name) {
  const std::size_t at = text.find('\0');
  if (at == std::string_view::npos) return {};
  const std::string_view before = text.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 is 0
  return bad_input("holds a byte 0, which no text has: is this another kind of file?", fmt::format("{}:{}:{}", name, line, at - start + 1));
}

}  // namespace burrhole
