#include "volumes/read/nifti_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kBytes1 = 348, kBytes2 = 540;
constexpr std::size_t kDescrip = 148;  ///< offset of the description in version 1
constexpr double kReportedDifference =
    0.1 * kMillimetre;  ///< sform and qform may differ by this much due to rounding; a larger difference is reported

/// Offsets of the fields in each version, nifti1.h and nifti2.h. Numbers are int16/float in version 1, int64/double in version 2 where
/// stated.
struct Places {
  std::size_t datatype, bitpix, dim, pixdim, vox_offset, slope, inter, units, qform, sform, quatern, qoffset, srow;
};
constexpr Places kPlaces1{70, 72, 40, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280};
constexpr Places kPlaces2{12, 14, 16, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400};

bool has(std::span<const std::byte> bytes, std::size_t at, std::string_view text) noexcept {
  return bytes.size() >= at + text.size() && std::memcmp(bytes.data() + at, text.data(), text.size()) == 0;
}

/// Reads numbers of a header whose version and byte order are known.
class Fields {
 public:
  Fields(std::span<const std::byte> bytes, int version, bool big_endian)
      : bytes_(bytes), two_(version == 2), swapped_(big_endian != (std::endian::native == std::endian::big)) {}

  template <class T>
  [[nodiscard]] T get(std::size_t at) const noexcept {
    std::array<std::byte, sizeof(T)> raw;
    std::copy_n(bytes_.data() + at, sizeof(T), raw.data());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }
  /// Element n of an array that is float in version 1 and double in version 2.
  [[nodiscard]] double real(std::size_t at, std::size_t n = 0) const noexcept {
    return two_ ? get<double>(at + 8 * n) : static_cast<double>(get<float>(at + 4 * n));
  }
  /// Element n of an array that is int16 in version 1 and int64 in version 2.
  [[nodiscard]] std::int64_t size(std::size_t at, std::size_t n) const noexcept {
    return two_ ? get<std::int64_t>(at + 8 * n) : get<std::int16_t>(at + 2 * n);
  }
  /// A code that is int16 in version 1 and int32 in version 2.
  [[nodiscard]] int code(std::size_t at) const noexcept { return two_ ? get<std::int32_t>(at) : get<std::int16_t>(at); }
  [[nodiscard]] int units(std::size_t at) const noexcept { return two_ ? get<std::int32_t>(at) : std::to_integer<int>(bytes_[at]); }
  [[nodiscard]] bool two() const noexcept { return two_; }

 private:
  std::span<const std::byte> bytes_;
  bool two_, swapped_;
};

Result<PixelType> pixel_type(int datatype, int bitpix) {
  struct Known {
    int code;
    PixelType type;
  };
  static constexpr std::array<Known, 10> kKnown{{{2, PixelType::u8},
                                                 {4, PixelType::i16},
                                                 {8, PixelType::i32},
                                                 {16, PixelType::f32},
                                                 {64, PixelType::f64},
                                                 {256, PixelType::i8},
                                                 {512, PixelType::u16},
                                                 {768, PixelType::u32},
                                                 {1024, PixelType::i64},
                                                 {1280, PixelType::u64}}};
  if (datatype == 128 || datatype == 2304) return bad_input("holds colours (RGB): only one number per voxel is supported");
  if (datatype == 32 || datatype == 1792 || datatype == 2048)
    return bad_input("holds complex numbers: only one number per voxel is supported");
  for (const Known& known : kKnown) {
    if (known.code != datatype) continue;
    const int bits = static_cast<int>(8 * bytes_of(known.type));
    if (bitpix != bits) return bad_input(fmt::format("datatype {} has {} bits a voxel, bitpix says {}", datatype, bits, bitpix));
    return known.type;
  }
  return bad_input(fmt::format("datatype {} is not read", datatype));
}

Result<Vec3i> volume_dims(const Fields& fields, const Places& at) {
  const std::int64_t axes = fields.size(at.dim, 0);
  if (axes < 1 || axes > 7) return bad_input(fmt::format("dim[0] = {} must be in [1, 7]", axes));
  const auto size = [&](std::size_t n) { return static_cast<std::int64_t>(n) <= axes ? fields.size(at.dim, n) : 1; };
  if (axes < 3) return bad_input(fmt::format("{}D: a volume has three axes", axes));
  if (size(4) > 1) return bad_input(fmt::format("4D: {} volumes; one is read, so save one of them alone", size(4)));
  for (std::size_t n = 5; n <= 7; ++n)
    if (size(n) > 1) return bad_input(fmt::format("{} numbers per voxel (dim[{}]): one is read", size(n), n));
  if (const auto error = dims_error(size(1), size(2), size(3))) return bad_input(*error);
  return Vec3i(size(1), size(2), size(3));
}

/// [m] per unit of the file.
double length_unit(const Fields& fields, const Places& at, std::vector<std::string>& assumed) {
  const int code = fields.units(at.units) & 7;
  if (code == 1) return 1.0;
  if (code == 2) return kMillimetre;
  if (code == 3) return 1e-6;
  assumed.emplace_back("no unit of length in the file: millimetres");
  return kMillimetre;
}

/// Method 3. In the file's unit, RAS.
Affine from_sform(const Fields& fields, const Places& at) {
  Affine out;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) out.linear[column][row] = fields.real(at.srow, 4 * row + column);
    out.offset[row] = fields.real(at.srow, 4 * row + 3);
  }
  return out;
}

/// Method 2: unit quaternion (a, b, c, d) with a >= 0 omitted in the file, the third axis flipped by the sign of pixdim[0].
Affine from_qform(const Fields& fields, const Places& at) {
  double b = fields.real(at.quatern, 0), c = fields.real(at.quatern, 1), d = fields.real(at.quatern, 2);
  double a = 1.0 - (b * b + c * c + d * d);
  if (a < 1e-7) {  // as the reference library: half a turn; the sum of squares may exceed 1 by rounding
    const double length = std::sqrt(b * b + c * c + d * d);
    a = 0.0, b /= length, c /= length, d /= length;
  } else {
    a = std::sqrt(a);
  }
  const double flip = fields.real(at.pixdim, 0) < 0.0 ? -1.0 : 1.0;
  Affine out;
  out.linear[0] = Vec3(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)) * fields.real(at.pixdim, 1);
  out.linear[1] = Vec3(2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)) * fields.real(at.pixdim, 2);
  out.linear[2] = Vec3(2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c) * fields.real(at.pixdim, 3) * flip;
  out.offset = Vec3(fields.real(at.qoffset, 0), fields.real(at.qoffset, 1), fields.real(at.qoffset, 2));
  return out;
}

/// Method 1: voxel sizes only.
Affine from_pixdim(const Fields& fields, const Places& at) {
  Affine out;
  for (std::size_t n = 0; n < 3; ++n) out.linear[n] *= fields.real(at.pixdim, n + 1);
  return out;
}

/// Largest displacement of a corner of the grid between the two maps.
double corner_distance(const Affine& one, const Affine& other, const Vec3i& dims) {
  double farthest = 0.0;
  for_each_voxel(VoxelBox{Vec3i(0), Vec3i(2)}, [&](const Vec3i& corner) {
    const Vec3 at = Vec3(corner) * Vec3(dims - 1);
    farthest = std::max(farthest, glm::length(one * at - other * at));
  });
  return farthest;
}

Affine scaled(const Affine& a, double unit) { return {a.linear * unit, a.offset * unit}; }

/// The map of the file to RAS [m], by the best available of its three methods.
Result<Affine> ras_from_index(const Fields& fields, const Places& at, ImageHead& image) {
  const double unit = length_unit(fields, at, image.assumed);
  const bool by_sform = fields.code(at.sform) > 0, by_qform = fields.code(at.qform) > 0;
  if (!by_sform)
    for (std::size_t n = 1; n <= 3; ++n)
      if (const double edge = fields.real(at.pixdim, n); !(edge > 0.0))
        return bad_input(fmt::format("pixdim[{}] = {} must be > 0", n, edge));
  if (by_sform) {
    const Affine sform = scaled(from_sform(fields, at), unit);
    const double apart = by_qform ? corner_distance(sform, scaled(from_qform(fields, at), unit), image.dims) : 0.0;
    if (apart > kReportedDifference)
      image.assumed.push_back(fmt::format("sform and qform lie {:.3g} mm apart: sform", apart / kMillimetre));
    return sform;
  }
  if (by_qform) return scaled(from_qform(fields, at), unit);
  image.assumed.emplace_back("no orientation in the file: i towards right, j towards anterior, k towards superior, first voxel at 0");
  return scaled(from_pixdim(fields, at), unit);
}

/// scl_slope 0 and, from some writers, NaN mean no scaling.
void set_scaling(const Fields& fields, const Places& at, PixelForm& form) {
  const double slope = fields.real(at.slope), intercept = fields.real(at.inter);
  if (slope == 0.0 || !std::isfinite(slope)) return;
  form.slope = slope;
  form.intercept = std::isfinite(intercept) ? intercept : 0.0;
}

Result<std::uint64_t> data_offset(const Fields& fields, const Places& at, bool pair) {
  const double written = fields.two() ? static_cast<double>(fields.get<std::int64_t>(at.vox_offset)) : fields.real(at.vox_offset);
  const double least = pair ? 0.0 : static_cast<double>(fields.two() ? kBytes2 : kBytes1);
  if (!pair && written == 0.0)
    return fields.two() ? kBytes2 + 4 : kBytes1 + 4;  // nifti1.h: 0 means directly after the extension of the header
  if (!(written >= least && written <= 0x1p52) || written != std::floor(written))
    return bad_input(fmt::format("vox_offset = {} must be a whole number from {} on", written, least));
  return static_cast<std::uint64_t>(written);
}

/// Version and byte order, by the size field and the magic text.
Result<NiftiHeader> recognise(std::span<const std::byte> bytes) {
  NiftiHeader out;
  const auto is = [&](std::string_view size_field) { return has(bytes, 0, size_field); };
  const bool one = is("\x5c\x01\0\0"sv) || is("\0\0\x01\x5c"sv), two = is("\x1c\x02\0\0"sv) || is("\0\0\x02\x1c"sv);
  if (!one && !two) return bad_input("is not a NIfTI file: its first four bytes are neither 348 nor 540");
  out.image.form.big_endian = bytes[0] == std::byte{0};
  out.version = one ? 1 : 2;
  const std::size_t needed = one ? kBytes1 : kBytes2;
  if (bytes.size() < needed) return bad_input(fmt::format("header ends after {} of {} bytes", bytes.size(), needed));
  if (!starts_like_nifti(bytes)) {
    if (one) return bad_input("is Analyze 7.5, or its NIfTI magic is damaged: left and right are ambiguous; save it as NIfTI");
    return bad_input("its NIfTI-2 magic is damaged");
  }
  out.pair = one ? has(bytes, 344, "ni1\0"sv) : has(bytes, 4, "ni2\0"sv);
  return out;
}

}  // namespace

bool starts_like_nifti(std::span<const std::byte> bytes) noexcept {
  const bool one = has(bytes, 344, "n+1\0"sv) || has(bytes, 344, "ni1\0"sv);
  const bool two = has(bytes, 4, "n+2\0\r\n\x1a\n"sv) || has(bytes, 4, "ni2\0\r\n\x1a\n"sv);
  return one || two;
}

Result<NiftiHeader> parse_nifti(std::span<const std::byte> bytes) {
  Result<NiftiHeader> recognised = recognise(bytes);
  if (!recognised) return recognised.error();
  NiftiHeader out = std::move(recognised).value();
  const Fields fields(bytes, out.version, out.image.form.big_endian);
  const Places& at = out.version == 1 ? kPlaces1 : kPlaces2;
  const Result<Vec3i> dims = volume_dims(fields, at);
  if (!dims) return dims.error();
  out.image.dims = dims.value();
  const Result<PixelType> type = pixel_type(fields.get<std::int16_t>(at.datatype), fields.get<std::int16_t>(at.bitpix));
  if (!type) return type.error();
  out.image.form.type = type.value();
  out.image.own_density = out.version == 1 && has(bytes, kDescrip, std::string(kNiftiDensity) + '\0');
  set_scaling(fields, at, out.image.form);
  const Result<std::uint64_t> offset = data_offset(fields, at, out.pair);
  if (!offset) return offset.error();
  out.data_offset = offset.value();
  const Result<Affine> ras = ras_from_index(fields, at, out.image);
  if (!ras) return ras.error();
  out.image.bone_from_index = lps_from_ras(ras.value());
  if (const auto error = affine_error(out.image.bone_from_index)) return bad_input(*error);
  return out;
}

}  // namespace burrhole
