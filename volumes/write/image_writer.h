/// volumes/write/image_writer.h: writes a volume as NRRD or NIfTI-1, slab by slab.
///   Frame  NRRD is LPS, NIfTI is RAS.   Units  mm in the files.   Errors  bad_input with the path as place.   Memory  one slab.
///   Source  NRRD format definition, revision 5; nifti1.h of the NIfTI Data Format Working Group.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct ImageOut {
  VoxelBox box;            ///< [voxels] part of the grid that is written
  Affine bone_from_index;  ///< [m] LPS, of the grid
  bool labels = false;     ///< 8-bit whole numbers; otherwise floats
  std::string content;     ///< one word for the header
  /// Reads a box, i fastest.
  std::function<void(const VoxelBox& box, std::span<float> out)> read;
  std::function<void(double)> progress = {};  ///< receives the share done, 0..1; may be empty
  std::function<Status()> check = {};         ///< after the last read: an error leaves no file; may be empty
  const std::atomic<bool>* stop = nullptr;    ///< see OutputFile::create()
};

/// @returns the map of a box of the grid, whose first voxel has index 0.
[[nodiscard]] Affine map_of_box(const Affine& bone_from_index, const VoxelBox& box) noexcept;
/// @returns the length in mm whose product with kMillimetre is exactly `metres`, or the nearest, so that a file read again places bone where
/// it was.
[[nodiscard]] double exact_millimetres(double metres) noexcept;

/// The text of an NRRD header with attached gzip data.
[[nodiscard]] std::string nrrd_header_text(const ImageOut& image);
/// The 348 bytes of a NIfTI-1 header and its four extension bytes. The sform has the whole map, rounded to float; the qform is given where
/// the map has no shear. bad_input: an edge over 32767 voxels.
[[nodiscard]] Result<std::string> nifti_header_bytes(const ImageOut& image);

/// @returns the size of the file [bytes].
[[nodiscard]] Result<std::uint64_t> write_nrrd(const std::string& path, const ImageOut& image);
/// @param packed writes the whole file as gzip (.nii.gz).
[[nodiscard]] Result<std::uint64_t> write_nifti(const std::string& path, const ImageOut& image, bool packed);

}  // namespace burrhole
