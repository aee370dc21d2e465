/// volumes/read/byte_stream.h: sequential bytes of one file from an offset, decompressed if they are packed. The only wrapper of zlib.
///   Units  bytes.   Errors  bad_input.   Memory  bounded: a window of the file and the state of zlib.   Thread  one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// @returns the size [bytes] of a regular file; bad_input if it is missing or not a regular file (a folder, a device, a pipe).
[[nodiscard]] Result<std::uint64_t> size_of_file(const std::string& path);

/// @returns whether the file starts with the two magic bytes of gzip; false if it cannot be read.
[[nodiscard]] bool starts_as_gzip(const std::string& path);

class ByteStream {
 public:
  /// @param packed the bytes from `offset` are gzip (any number of members) or zlib, detected by their first bytes.
  [[nodiscard]] static Result<ByteStream> open(const std::string& path, std::uint64_t offset, bool packed);
  ByteStream(ByteStream&&) noexcept;
  ByteStream& operator=(ByteStream&&) noexcept;
  ~ByteStream();

  /// Fills `out` from its start. @returns the number of bytes, fewer than out.size() at the end; bad_input if the file cannot be read or
  /// packed data is damaged.
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out);
  /// Skips bytes. @returns the number of bytes skipped, fewer than `count` at the end.
  [[nodiscard]] Result<std::uint64_t> skip(std::uint64_t count);
  /// @returns whether the end was reached inside packed data or its checksum.
  [[nodiscard]] bool cut() const noexcept;

 private:
  struct State;
  explicit ByteStream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// @returns the first bytes of a file, at most `most`, decompressed if `packed`.
[[nodiscard]] Result<std::vector<std::byte>> read_head(const std::string& path, bool packed, std::size_t most);

}  // namespace burrhole
