/// volumes/read/dicom_bytes.h: random access to the bytes of one DICOM file; deflated data sets are inflated in memory.
///   Errors  bad_input.   Bound  a deflated data set may inflate to 256 MiB; a slice has about half a MiB.
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
  /// @returns bad_input, place = path, if the file cannot be opened.
  [[nodiscard]] static Result<DicomBytes> open(const std::string& path);
  /// @returns true if all of `out` was filled, false if the file has fewer bytes.
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> out);
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Replaces the bytes by those that follow `offset`, inflated (RFC 1951), from offset 0.
  /// @returns the error, empty if none; bytes inflated before an error can be read.
  [[nodiscard]] std::string inflate_from(std::uint64_t offset);

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t window_offset_ = 0;
  std::vector<std::byte> window_;    // of the file: headers need many small reads
  std::vector<std::byte> inflated_;  // the whole data set, if it was deflated
  bool in_memory_ = false;
};

}  // namespace burrhole
