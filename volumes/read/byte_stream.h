/// volumes/read/byte_stream.h: the bytes of one file from an offset on, inflated on the way if they are packed; the only wrapper of zlib.
///   Memory  bounded: a window of the file and zlib's own, whatever the file claims.     Thread  one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Size of a regular file [bytes]; bad_input when it is missing or no regular file (a folder, a device, a pipe that never ends).
[[nodiscard]] Result<std::uint64_t> size_of_file(const std::string& path);

/// Whether the file starts with gzip's two magic bytes; false when it cannot be read.
[[nodiscard]] bool starts_as_gzip(const std::string& path);

class ByteStream {
 public:
  /// @param packed bytes from `offset` on are gzip (any number of members) or zlib, told apart by their first bytes.
  [[nodiscard]] static Result<ByteStream> open(const std::string& path, std::uint64_t offset, bool packed);
  ByteStream(ByteStream&&) noexcept;
  ByteStream& operator=(ByteStream&&) noexcept;
  ~ByteStream();

  /// Fills `out` from its start. @returns the bytes filled: fewer than out.size() at the end. bad_input: unreadable, or packed data
  /// damaged.
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out);
  /// Reads on without keeping anything. @returns the bytes passed, fewer than `count` at the end.
  [[nodiscard]] Result<std::uint64_t> skip(std::uint64_t count);
  /// The end was met inside packed data, its checksum included.
  [[nodiscard]] bool cut() const noexcept;

 private:
  struct State;
  explicit ByteStream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The first bytes of a file, at most `most`, inflated if `packed`.
[[nodiscard]] Result<std::vector<std::byte>> read_head(const std::string& path, bool packed, std::size_t most);

}  // namespace burrhole
