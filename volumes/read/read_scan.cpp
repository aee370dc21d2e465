#include <fmt/format.h>

#include <cstring>
#include <filesystem>

#include "volumes/read/byte_stream.h"
#include "volumes/read/dicom_elements.h"
#include "volumes/read/mesh_file.h"
#include "volumes/read/meta_header.h"
#include "volumes/read/nifti_header.h"
#include "volumes/read/number_text.h"
#include "volumes/read/pixels.h"
#include "volumes/read/raw_template.h"
#include "volumes/read/readable_path.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

/// One of the readers; null: the kind is not known yet.
struct Reader {
  Result<ReadScan> (*read)(const std::string&, const ReadOptions&) = nullptr;
};

constexpr std::size_t kSniffed = 1024;  ///< [bytes] read to detect a format by its content
constexpr const char* kKinds =
    "a DICOM folder or file, NIfTI (.nii, .nii.gz, .hdr), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), the .toml of a raw volume, "
    "a mesh (.stl, .obj, .ply), a .vdb";

Reader by_ending(std::string path) {
  path = lower(path);
  struct Ending {
    const char* text;
    Result<ReadScan> (*read)(const std::string&, const ReadOptions&);
  };
  static constexpr Ending kEndings[] = {
      {".nii", read_nifti},    {".nii.gz", read_nifti},  {".hdr", read_nifti},     {".hdr.gz", read_nifti},  {".img", read_nifti},
      {".img.gz", read_nifti}, {".nrrd", read_nrrd},     {".nhdr", read_nrrd},     {".mha", read_metaimage}, {".mhd", read_metaimage},
      {".toml", read_raw},     {".stl", read_mesh_scan}, {".obj", read_mesh_scan}, {".ply", read_mesh_scan}, {".vdb", read_foreign_vdb},
      {".dcm", read_dicom},    {".dicom", read_dicom}};
  for (const Ending& ending : kEndings)
    if (path.ends_with(ending.text)) return {ending.read};
  return {};
}

/// Detects the format by the first bytes. DICOM without its magic text is the weakest criterion and is tested last.
Result<Reader> by_content(const std::string& path) {
  const bool packed = starts_as_gzip(path);
  const Result<std::vector<std::byte>> head = read_head(path, packed, kSniffed);
  if (!head) return head.error();
  const std::string_view text(reinterpret_cast<const char*>(head.value().data()), head.value().size());
  if (text.size() >= 132 && text.substr(128, 4) == "DICM") return Reader{read_dicom};
  if (starts_like_nifti(head.value())) return Reader{read_nifti};
  if (text.starts_with("NRRD000")) return Reader{read_nrrd};
  if (starts_like_metaimage(text)) return Reader{read_metaimage};
  if (text.starts_with(std::string_view(" BDV\0\0\0\0", 8))) return Reader{read_foreign_vdb};
  if (!packed && !mesh_format(path).empty()) return Reader{read_mesh_scan};
  if (!packed && starts_like_dicom(head.value())) return Reader{read_dicom};
  if (named_as_raw(path)) return bad_input("is not in a supported format; " + raw_template({&path, 1}), path);
  return bad_input(fmt::format("is not in a supported format: {}", kKinds), path);
}

Result<Reader> reader_of(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return bad_input("there is no such file or folder", path);
  if (std::filesystem::is_directory(path, ignored)) return Reader{read_dicom};
  if (const Reader reader = by_ending(path); reader.read != nullptr) return reader;
  return by_content(path);
}

/// Checks the guarantees of every reader again.
Status check(const Scan& scan, const std::string& path) {
  const VoxelBox box{Vec3i(0), scan.dims};
  if (box.empty() || scan.values.size() != box.count())
    return bad_input(fmt::format("{} values for {} x {} x {} voxels", scan.values.size(), scan.dims.x, scan.dims.y, scan.dims.z), path);
  if (const auto error = affine_error(scan.bone_from_index)) return bad_input(*error, path);
  const std::size_t bad = count_not_finite(scan.values);
  if (bad > 0) return bad_input(fmt::format("holds {} NaN or infinite voxels", bad), path);
  return {};
}

}  // namespace

Status advance(const ReadOptions& options, double share) {
  if (options.stop.stop_requested()) return Error{ErrorCode::unavailable, "the reading was stopped", {}};
  if (options.progress) options.progress(share);
  return {};
}

Result<ReadScan> read_scan(const std::string& path, const ReadOptions& options) {
  const auto found = readable_path(path);
  if (!found) return found.error();
  const Result<Reader> reader = reader_of(*found);
  if (!reader) return reader.error();
  Result<ReadScan> read = reader.value().read(*found, options);
  if (!read) return read;
  if (const Status status = check(read->scan, *found); !status) return status.error();
  return read;
}

}  // namespace burrhole
