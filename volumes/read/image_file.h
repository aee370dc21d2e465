/// volumes/read/image_file.h: reads the voxels that a header describes. Sizes are checked against the files first; then voxels are read and
///   converted in pieces.
///   Frame  LPS.   Units  SI.   Errors  bad_input, unavailable.
///   Memory  the floats of the volume and one piece; allocated only after the files are known to have the voxels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/read/pixels.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {

/// The common content of the headers of all image formats.
struct ImageHead {
  Vec3i dims{0};  ///< [voxels]
  PixelForm form;
  Affine bone_from_index;            ///< [m], LPS
  std::vector<std::string> assumed;  ///< lines for the report
  bool own_density = false;          ///< written by this program as density: the values are occupancy
};

/// What the header of a file with density says, by which the readers recognise it: an NRRD key:=value line, and NIfTI's descrip.
inline constexpr const char* kNrrdDensity = "burrhole_field:=density";
inline constexpr const char* kNiftiDensity = "burrhole density";

enum class Packing { raw, packed, text };  ///< packed: gzip or zlib; text: decimal numbers separated by blanks

/// One file that contains an equal share of the voxels; parts are consecutive along k.
struct VoxelPart {
  std::string path;
  std::uint64_t offset = 0;        ///< [bytes] in the file on disk
  std::uint64_t inner_offset = 0;  ///< [bytes] to skip after decompression
  bool at_end = false;             ///< the share is at the end of the file; `offset` is not used; `raw` only
};

struct ImageFile {
  std::string place;   ///< place in messages: the file that the user named
  std::string format;  ///< format in the report
  ImageHead head{};
  Quantity quantity = Quantity::unknown;
  Packing packing = Packing::raw;
  std::vector<VoxelPart> parts{};
  bool exact = false;  ///< bytes after the voxels are an error; otherwise an assumption in the report
};

/// @returns the scan with the values of the file, including NaN and infinities. bad_input: sizes, affine, missing files, "data ends after N
/// of M bytes", damaged compression, invalid numbers in text; unavailable: not enough memory.
[[nodiscard]] Result<ReadScan> read_image(ImageFile file, const ReadOptions& options);

}  // namespace burrhole
