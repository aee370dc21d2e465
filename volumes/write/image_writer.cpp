#include "volumes/write/image_writer.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"
#include "volumes/write/packed_file.h"

namespace burrhole {
namespace {

static_assert(std::endian::native == std::endian::little, "files are written as the numbers are in memory, and say little endian");

constexpr int kSlab = 8;                  ///< slices at a time: the edge of a block of bone
constexpr double kNoShear = 1e-5;         ///< [rad] below it a qform has the accuracy of its floats
constexpr std::size_t kNiftiBytes = 348;  ///< of the header; four extension bytes follow

Status write_values(PackedFile& file, const ImageOut& image) {
  std::vector<float> values;
  std::vector<std::uint8_t> labels;
  for (int k = image.box.lo.z; k < image.box.hi.z; k += kSlab) {
    const VoxelBox slab{{image.box.lo.x, image.box.lo.y, k}, {image.box.hi.x, image.box.hi.y, std::min(k + kSlab, image.box.hi.z)}};
    values.resize(slab.count());
    image.read(slab, values);
    if (image.labels) labels.assign(values.begin(), values.end());
    Status written = file.write(image.labels ? std::as_bytes(std::span(labels)) : std::as_bytes(std::span(values)));
    if (!written) return written;
    if (image.progress) image.progress(static_cast<double>(slab.hi.z - image.box.lo.z) / image.box.size().z);
  }
  return image.check ? image.check() : Status();
}

std::string numbers(const Vec3& metres) {
  return fmt::format("({},{},{})", exact_millimetres(metres.x), exact_millimetres(metres.y), exact_millimetres(metres.z));
}

/// Writes numbers at their offsets of nifti1.h.
class NiftiBytes {
 public:
  template <class T>
  void put(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void put_real(std::size_t at, double value) { put(at, static_cast<float>(value)); }
  void put_text(std::size_t at, const std::string& text) { bytes_.replace(at, text.size(), text); }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_ = std::string(kNiftiBytes + 4, '\0');
};

/// Method 2 of nifti1.h: unit quaternion with a >= 0, which is not stored; a left-handed map has its third axis negated.
void put_qform(NiftiBytes& out, const Affine& ras_mm) {
  Mat3 turn;
  for (std::size_t n = 0; n < 3; ++n) turn[n] = glm::normalize(ras_mm.linear[n]);
  const bool mirrored = glm::determinant(turn) < 0.0;
  if (mirrored) turn[2] = -turn[2];
  Quat q = glm::quat_cast(turn);
  if (q.w < 0.0) q = -q;
  out.put<std::int16_t>(252, 1);
  out.put_real(76, mirrored ? -1.0 : 1.0);
  for (std::size_t n = 0; n < 3; ++n) out.put_real(268 + 4 * n, ras_mm.offset[n]);
  out.put_real(256, q.x);
  out.put_real(260, q.y);
  out.put_real(264, q.z);
}

}  // namespace

Affine map_of_box(const Affine& bone_from_index, const VoxelBox& box) noexcept {
  return {bone_from_index.linear, box.lo == Vec3i(0) ? bone_from_index.offset : bone_from_index * Vec3(box.lo)};
}

double exact_millimetres(double metres) noexcept {
  const double rounded = metres / kMillimetre;
  for (const double candidate : {rounded, std::nextafter(rounded, HUGE_VAL), std::nextafter(rounded, -HUGE_VAL)})
    if (candidate * kMillimetre == metres) return candidate + 0.0;  // + 0.0: no negative zero in the text
  return rounded;
}

std::string nrrd_header_text(const ImageOut& image) {
  const Affine map = map_of_box(image.bone_from_index, image.box);
  const Vec3i dims = image.box.size();
  return fmt::format(
      "NRRD0005\n"
      "type: {}\n"
      "dimension: 3\n"
      "space: left-posterior-superior\n"
      "sizes: {} {} {}\n"
      "space directions: {} {} {}\n"
      "kinds: domain domain domain\n"
      "endian: little\n"
      "encoding: gzip\n"
      "space units: \"mm\" \"mm\" \"mm\"\n"
      "space origin: {}\n"
      "burrhole_field:={}\n\n",
      image.labels ? "uint8" : "float", dims.x, dims.y, dims.z, numbers(map.linear[0]), numbers(map.linear[1]), numbers(map.linear[2]),
      numbers(map.offset), image.content);
}

Result<std::string> nifti_header_bytes(const ImageOut& image) {
  const Vec3i dims = image.box.size();
  for (std::size_t n = 0; n < 3; ++n)
    if (dims[n] > INT16_MAX) return bad_input(fmt::format("NIfTI-1 holds at most {} voxels along an axis, not {}", INT16_MAX, dims[n]));
  const Affine map = map_of_box(image.bone_from_index, image.box);
  const Affine lps_mm{map.linear * (1.0 / kMillimetre), map.offset * (1.0 / kMillimetre)};
  const Affine ras_mm = lps_from_ras(lps_mm);  // its own inverse
  NiftiBytes out;
  out.put<std::int32_t>(0, kNiftiBytes);
  out.put<std::int16_t>(40, 3);
  for (std::size_t n = 0; n < 3; ++n) out.put(42 + 2 * n, static_cast<std::int16_t>(dims[n]));
  for (std::size_t n = 4; n <= 7; ++n) out.put<std::int16_t>(40 + 2 * n, 1);
  out.put<std::int16_t>(68, image.labels ? 1002 : 0);  // intent: labels
  out.put<std::int16_t>(70, image.labels ? 2 : 16);
  out.put<std::int16_t>(72, image.labels ? 8 : 32);
  out.put_real(76, 1.0);
  for (std::size_t n = 0; n < 3; ++n) out.put_real(80 + 4 * n, glm::length(ras_mm.linear[n]));
  out.put_real(108, kNiftiBytes + 4);
  out.put_real(112, 1.0);         // slope
  out.put<std::uint8_t>(123, 2);  // mm
  out.put_text(148, "burrhole " + image.content);
  if (describe_grid(map).shear < kNoShear) put_qform(out, ras_mm);
  out.put<std::int16_t>(254, 1);  // sform: scanner coordinates
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) out.put_real(280 + 16 * row + 4 * column, ras_mm.linear[column][row]);
    out.put_real(280 + 16 * row + 12, ras_mm.offset[row]);
  }
  out.put_text(344, "n+1");
  return out.bytes();
}

Result<std::uint64_t> write_nrrd(const std::string& path, const ImageOut& image) {
  auto file = PackedFile::create(path, image.stop);
  if (!file) return file.error();
  if (const Status written = file->write(nrrd_header_text(image)); !written) return written.error();
  if (const Status packs = file->pack(); !packs) return packs.error();
  if (const Status written = write_values(*file, image); !written) return written.error();
  return file->commit();
}

Result<std::uint64_t> write_nifti(const std::string& path, const ImageOut& image, bool packed) {
  const auto header = nifti_header_bytes(image);
  if (!header) return bad_input(header.error().message, path);
  auto file = PackedFile::create(path, image.stop);
  if (!file) return file.error();
  if (packed)
    if (const Status packs = file->pack(); !packs) return packs.error();
  if (const Status written = file->write(*header); !written) return written.error();
  if (const Status written = write_values(*file, image); !written) return written.error();
  return file->commit();
}

}  // namespace burrhole
