/// volumes/write/packed_file.h: an output file (core/base/output_file.h) whose bytes are packed from where that is asked for.
///   Units  bytes.   Errors  those of OutputFile.   Memory  bounded: the state of zlib.   Thread  one owner.
#pragma once

#include <memory>

#include "core/base/output_file.h"

namespace burrhole {

class PackedFile {
 public:
  [[nodiscard]] static Result<PackedFile> create(const std::string& path, const std::atomic<bool>* stop = nullptr);
  PackedFile(PackedFile&&) noexcept;
  PackedFile& operator=(PackedFile&&) = delete;
  ~PackedFile();

  /// From here on the bytes are one gzip member, to the end of the file.
  [[nodiscard]] Status pack();
  [[nodiscard]] Status write(std::span<const std::byte> bytes);
  [[nodiscard]] Status write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// @returns the size of the file [bytes].
  [[nodiscard]] Result<std::uint64_t> commit();

 private:
  struct State;
  explicit PackedFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace burrhole
