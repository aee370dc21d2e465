/// volumes/read/dicom_bytes.h: the bytes of one DICOM file by offset, read when asked for; deflated data sets are inflated in memory.
///   Bound   a deflated data set may grow to 256 MiB: a slice is half of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// One open file. One owner, any thread.
class DicomBytes {
 public:
  /// @returns bad_input, place = path, when the file cannot be opened.
  [[nodiscard]] static Result<DicomBytes> open(const std::string& path);
  /// @returns all of `out` filled, or false when the bytes are not there.
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> out);
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// From here on the bytes are those that follow `offset`, inflated (RFC 1951), from offset 0.
  /// @returns what is wrong, empty if nothing; what came out before a fault can be read.
  [[nodiscard]] std::string inflate_from(std::uint64_t offset);

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t window_offset_ = 0;
  std::vector<std::byte> window_;    // of the file: headers are many small reads
  std::vector<std::byte> inflated_;  // the whole data set, when deflated
  bool in_memory_ = false;
};

}  // namespace burrhole
