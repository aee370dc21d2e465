/// volumes/read/nifti_header.h: the header of NIfTI-1 and NIfTI-2 from its bytes alone; no file access.
///   Frame   RAS in the file, LPS out; sform before qform before pixdim, the sform kept whole, shear included.     Units  m out.
///   Privacy descrip, aux_file, db_name and intent_name are never looked at.
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
  bool pair = false;              ///< voxels lie in an .img beside the .hdr
  std::uint64_t data_offset = 0;  ///< [bytes] of the first voxel, after unpacking
  ImageHead image;
};

/// Whether the bytes carry NIfTI's magic text (of either version).
[[nodiscard]] bool looks_like_nifti(std::span<const std::byte> bytes) noexcept;

/// @param bytes the first kNiftiHeaderBytes of the file, or all of it. @returns bad_input without place: no magic (Analyze 7.5 too), 2D, 4D
/// or vector valued, RGB or complex, impossible sizes, no usable affine.
[[nodiscard]] Result<NiftiHeader> parse_nifti(std::span<const std::byte> bytes);

}  // namespace burrhole
