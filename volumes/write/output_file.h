/// volumes/write/output_file.h: a file that is written piece by piece, packed if asked for, and appears under its name only when it is whole.
///   Units  bytes.   Errors  bad_input with the path and the reason of the operating system; unavailable: stopped.   Memory  bounded: the state of zlib.
///   Thread  one owner.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

class OutputFile {
 public:
  /// Opens a temporary file beside `path`. @param stop once true, write() and finish() fail with `unavailable`; a signal handler may set it.
  /// Null: never.
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, const std::atomic<bool>* stop = nullptr);
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  /// Removes the temporary file unless finish() has renamed it.
  ~OutputFile();

  /// From here on the bytes are one gzip member, to the end of the file.
  void pack();
  /// Errors are kept: the first one is returned here and by all later calls.
  [[nodiscard]] Status write(std::span<const std::byte> bytes);
  [[nodiscard]] Status write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// Writes what is buffered and renames the file. @returns the size of the file [bytes].
  [[nodiscard]] Result<std::uint64_t> finish();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace burrhole
