#include "app/report/file.h"

#include <filesystem>
#include <system_error>

#include "core/base/output_file.h"

namespace burrhole {

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

Result<std::string> read_file(const std::string& path, const FileLimit& kind) { return read_input(path, kind); }

}  // namespace burrhole
