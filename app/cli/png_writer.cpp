#include "app/cli/png_writer.h"

#include <system_error>
#include <utility>

#include "app/render/png.h"

namespace burrhole::cli {

Status PngWriter::add(const std::string& file, Image image) {
  if (Status written = wait(); !written) return written;
  auto write = [file, of = std::move(image)] { return write_png(file, of); };
  try {
    writing_ = std::async(std::launch::async, write);
  } catch (const std::system_error&) {  // there is no thread to be had
    std::promise<Status> written;
    written.set_value(write());
    writing_ = written.get_future();
  }
  writing_file_ = file;
  return {};
}

Status PngWriter::wait() {
  if (!writing_.valid()) return failed_;
  if (Status written = writing_.get(); written)
    files_.push_back(writing_file_);
  else
    failed_ = written;
  return failed_;
}

}  // namespace burrhole::cli
