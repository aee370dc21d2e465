#include "app/report/file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

namespace burrhole {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

Error file_error(const char* doing, const std::string& path, int code) {
  return bad_input(std::string("cannot ") + doing + ": " + std::strerror(code), path);
}

/// @returns 0, or the errno of the first failed step. A full disk may be detected only when the stream is flushed or closed.
int write_all(const std::string& path, std::string_view bytes) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) return errno;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() || std::fflush(file.get()) != 0) return errno;
  return std::fclose(file.release()) == 0 ? 0 : errno;
}

}  // namespace

Status write_file(const std::string& path, std::string_view bytes) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return bad_input("cannot make the folder: " + error.message(), folder.string());
  }
  const std::string temporary = path + "." + std::to_string(::getpid()) + ".tmp";
  int code = write_all(temporary, bytes);
  if (code == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) code = errno;
  if (code == 0) return {};
  std::remove(temporary.c_str());
  return file_error("write", path, code);
}

Result<std::string> read_file(const std::string& path, const FileLimit& kind) { return read_input(path, kind); }

}  // namespace burrhole
