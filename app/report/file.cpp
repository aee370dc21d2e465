#include "app/report/file.h"

#include "core/base/output_file.h"

namespace burrhole {

Status write_file(const std::string& path, std::string_view bytes) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(bytes); !written) return written;
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

Result<std::string> read_file(const std::string& path, const FileLimit& kind) { return read_input(path, kind); }

}  // namespace burrhole
