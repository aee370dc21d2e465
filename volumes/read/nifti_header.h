/// volumes/read/nifti_header.h: parses the header of NIfTI-1 and NIfTI-2 from its bytes; no file access.
///   Frame   RAS in the file, LPS out; sform before qform before pixdim; the sform is used as it is, including shear.     Units  m.
///   Errors  bad_input without place.   Privacy descrip, aux_file, db_name and intent_name are not read.
///   Source  nifti1.h and nifti2.h of the NIfTI reference library (public domain): field offsets, methods 1 to 3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "volumes/read/image_file.h"

namespace burrhole {

inline constexpr std::size_t kNiftiHeaderBytes = 540;  ///< enough for either version

struct NiftiHeader {
  int version = 1;
  bool pair = false;              ///< the voxels are in an .img file beside the .hdr
  std::uint64_t data_offset = 0;  ///< [bytes] of the first voxel, after decompression
  ImageHead image;
};

/// @returns whether the bytes contain NIfTI's magic text (of either version).
[[nodiscard]] bool starts_like_nifti(std::span<const std::byte> bytes) noexcept;

/// @param bytes the first kNiftiHeaderBytes of the file, or all of it. @returns bad_input without place: no magic (also Analyze 7.5), 2D,
/// 4D or vector valued, RGB or complex, invalid sizes, no usable affine.
[[nodiscard]] Result<NiftiHeader> parse_nifti(std::span<const std::byte> bytes);

}  // namespace burrhole
