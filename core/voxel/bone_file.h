/// core/voxel/bone_file.h: the temporary file that holds the voxels of a paged bone. It has no name in the folder, so it disappears with the
///   process, also after a crash.
///   Units   bytes.   Errors  unavailable: no folder, no room in it, a write or read that fails; the text names the folder.
///   Thread  one writes; any number may read what was written before they started.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "core/base/result.h"

namespace burrhole {

/// Where a bone model keeps its voxels.
struct BoneStorage {
  std::string folder = {};                                                   ///< of the temporary file; empty: voxels are in memory
  std::uint64_t expected_bytes = 0;                                          ///< predicted size of the file: so much must be free
  std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max() / 2;  ///< limit of the size of the file

  [[nodiscard]] bool is_paged() const noexcept { return !folder.empty(); }
};

/// @returns the folder for large temporary files: $TMPDIR, or /var/tmp, which unlike /tmp is on a disk on all systems.
[[nodiscard]] std::string temporary_folder();
/// @returns whether files of the folder are in memory (tmpfs), where they save none.
[[nodiscard]] bool is_in_memory(const std::string& folder) noexcept;

class BoneFile {
 public:
  /// unavailable: the file cannot be made, or less than expected_bytes are free.
  [[nodiscard]] static Result<BoneFile> create(const BoneStorage& storage);
  BoneFile(BoneFile&& other) noexcept;
  BoneFile& operator=(BoneFile&&) = delete;
  ~BoneFile();

  /// Writes at an offset, which may be at or beyond the end. unavailable: the disk is full or fails, or most_bytes is exceeded.
  [[nodiscard]] Status write(std::uint64_t at, std::span<const std::byte> from);
  /// @returns 0, or errno of a read that failed; EIO also where the file ends too early.
  [[nodiscard]] int read(std::uint64_t at, std::span<std::byte> out) const noexcept;
  /// @returns the error for a number that read() returned.
  [[nodiscard]] Error read_error(int number) const;
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }  ///< [bytes]
  /// The descriptor, for tests that damage the file.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

 private:
  BoneFile(int descriptor, BoneStorage storage);
  int descriptor_ = -1;
  BoneStorage storage_;
  std::uint64_t size_ = 0;
};

}  // namespace burrhole
