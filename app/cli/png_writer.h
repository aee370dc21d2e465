/// app/cli/png_writer.h: writes PNG files one after the other on a thread of its own: compression takes long, and drilling goes on meanwhile.
///   Thread  one at a time.   Errors  those of write_png().
#pragma once

#include <future>
#include <string>
#include <vector>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole::cli {

class PngWriter {
 public:
  /// Waits for the file before, then begins with this one. @returns the error of the first file that could not be written.
  [[nodiscard]] Status add(const std::string& file, Image image);
  /// Waits for the last file. @returns the error of the first file that could not be written.
  [[nodiscard]] Status wait();
  [[nodiscard]] const std::vector<std::string>& files() const noexcept { return files_; }  ///< written so far

 private:
  std::vector<std::string> files_;
  std::future<Status> writing_;
  std::string writing_file_;
  Status failed_{};
};

}  // namespace burrhole::cli
