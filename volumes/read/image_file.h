/// volumes/read/image_file.h: from what a header says to voxels: sizes checked against the files first, then read and converted in pieces.
///   Memory  the floats of the volume and one piece; nothing is allocated before the files are known to hold that many voxels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/read/pixels.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {

/// What the header of any image format comes down to.
struct ImageHead {
  Vec3i dims{0};
  PixelForm form;
  Affine bone_from_index;            ///< [m], LPS
  std::vector<std::string> assumed;  ///< goes to the report
};

enum class Packing { raw, packed, text };  ///< packed: gzip or zlib; text: decimal numbers between blanks

/// One file that holds an equal share of the voxels; parts follow each other along k.
struct VoxelPart {
  std::string path;
  std::uint64_t offset = 0;        ///< [bytes] in the file as it lies on disk
  std::uint64_t inner_offset = 0;  ///< [bytes] to drop after unpacking
  bool at_end = false;             ///< the share is the last bytes of the file; offset is not used; raw only
};

struct ImageFile {
  std::string place;   ///< of messages: the file that was named by the user
  std::string format;  ///< of the report
  ImageHead head{};
  Quantity quantity = Quantity::unknown;
  Packing packing = Packing::raw;
  std::vector<VoxelPart> parts{};
  bool exact = false;  ///< bytes behind the voxels are refused; else told as assumed
};

/// @returns the scan, values as in the file, NaN and infinities included; bad_input: sizes, affine, missing files, "data ends after N of M
/// bytes", damaged compression, text that is no number; unavailable: more memory than there is.
[[nodiscard]] Result<ReadScan> read_image(ImageFile file, const ReadOptions& options);

}  // namespace burrhole
