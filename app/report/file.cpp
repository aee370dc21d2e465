#include "app/report/file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "core/base/output_file.h"

namespace burrhole {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

Error read_error(const std::string& path, int code) { return bad_input(std::string("cannot read: ") + std::strerror(code), path); }

}  // namespace

Status write_file(const std::string& path, std::string_view bytes) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return bad_input("cannot make the folder: " + error.message(), folder.string());
  }
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(bytes); !written) return written;
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

Result<std::string> read_file(const std::string& path) {
  File file;
  do file.reset(std::fopen(path.c_str(), "rb"));
  while (!file && errno == EINTR);
  if (!file) return read_error(path, errno);
  std::string bytes;
  char block[65536];
  for (std::size_t count = 0; (count = std::fread(block, 1, sizeof block, file.get())) > 0;) bytes.append(block, count);
  if (std::ferror(file.get()) != 0) return read_error(path, errno);
  return bytes;
}

}  // namespace burrhole
