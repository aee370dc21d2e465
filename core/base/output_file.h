/// core/base/output_file.h: the one way to write a file: piece by piece into a temporary file beside it, which gets the name only when all
///   of it is on the disk. A reader sees the old or the new content, never a part, also after a crash or on a full disk.
///   Units  bytes.   Errors  bad_input with the path, the reason of the operating system and what to do; unavailable: stopped.   Memory  a buffer of 64 KiB.
///   Thread  one owner.   Source  open(2), fsync(2), rename(2).
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
  /// Opens a new temporary file in the folder of `path`, which is made if it is missing; no other process has its name. A symbolic link is followed, also to a file that is
  /// not there yet. The new file has the group and the permissions of the old one; other hard links keep the old content. What is no regular
  /// file (a pipe, a device) is written directly. bad_input also for a folder, and for a file that is protected against writing. @param stop once true, write() and commit() fail with
  /// `unavailable`; a signal handler may set it. Null: never. Temporary files of the same name that killed processes of this user have left
  /// are removed; of a folder with more than 10,000 files, the first of them are searched.
  [[nodiscard]] static Result<OutputFile> create(const std::string& path, const std::atomic<bool>* stop = nullptr);
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  /// Removes the temporary file unless commit() has renamed it.
  ~OutputFile();

  /// Writes at the position. Errors are kept: the first one is returned here and by all later calls.
  [[nodiscard]] Status write(std::span<const std::byte> bytes);
  [[nodiscard]] Status write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// Moves the position, for a header that is completed last.
  [[nodiscard]] Status seek(std::uint64_t position);
  [[nodiscard]] std::uint64_t position() const noexcept;
  /// The file that another program writes in place of write(); it must not be replaced there.
  [[nodiscard]] const std::string& temporary() const noexcept;
  /// Writes what is buffered, waits for the disk and renames the file. @returns the size of what was written [bytes].
  [[nodiscard]] Result<std::uint64_t> commit();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Adds a text to the end of a file, which is made if it is not there, and waits for the disk. Of processes that append to one file each adds
/// its text whole. After an error the file is as it was before: it is not there if it was not.
[[nodiscard]] Status append_to_file(const std::string& path, std::string_view text);

/// @returns the error of a write that failed. @param code errno.
[[nodiscard]] Error write_error(const std::string& path, int code);

/// @returns the error that the folder of `path` gives: it cannot be written to, or made where it is missing. Makes nothing, so that a command
/// can ask before long work.
[[nodiscard]] Status check_folder_of(const std::string& path);

/// @returns the error of a write that was stopped: `unavailable`.
[[nodiscard]] Error stopped_error(const std::string& path);

/// @returns whether `name` is that of a temporary file for the file `of`, both without folder: such a file stays only when its process was
/// killed, until the next write to that name.
[[nodiscard]] bool is_temporary_of(std::string_view name, std::string_view of) noexcept;

}  // namespace burrhole
