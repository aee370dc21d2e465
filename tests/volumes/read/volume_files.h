/// tests/volumes/read/volume_files.h: one small volume and writers of it in every format, byte by byte; they share no code with the
/// readers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "volumes/read/scan.h"

namespace burrhole::test {

/// Oblique and sheared; its numbers are short binary fractions, so that even NIfTI-1's floats hold them exactly.
struct SmallVolume {
  Vec3i dims{7, 5, 4};
  Affine lps_mm;                     ///< [mm]
  std::vector<std::int16_t> values;  ///< i fastest, no two equal
};
[[nodiscard]] SmallVolume small_volume();

void write_bytes(const std::string& path, const std::string& bytes);
[[nodiscard]] std::string read_bytes(const std::string& path);
[[nodiscard]] std::string gzip(const std::string& bytes);
[[nodiscard]] std::string zlib_packed(const std::string& bytes);

/// Appends the bytes of a number in the order asked for.
template <class T>
void put(std::string& out, T value, bool big) {
  const char* at = reinterpret_cast<const char*>(&value);
  for (std::size_t n = 0; n < sizeof(T); ++n) out.push_back(at[big ? sizeof(T) - 1 - n : n]);  // tests run on little-endian machines
}
template <class T>
void set(std::string& out, std::size_t at, T value, bool big) {
  std::string bytes;
  put(bytes, value, big);
  out.replace(at, bytes.size(), bytes);
}
template <class T>
std::string stored(const std::vector<std::int16_t>& values, bool big) {
  std::string out;
  for (const std::int16_t value : values) put(out, static_cast<T>(value), big);
  return out;
}

struct NiftiWrite {
  int version = 1;
  bool big = false, pair = false;
  std::int16_t datatype = 4, bitpix = 16;
  int sform = 1, qform = 0, units = 2;
  double slope = 0.0, intercept = 0.0;
};
/// The header, its four extension bytes included.
[[nodiscard]] std::string nifti_header(const SmallVolume& volume, const NiftiWrite& how);
[[nodiscard]] std::string nrrd_header(const SmallVolume& volume, const std::string& type, const std::string& endian,
                                      const std::string& encoding);
[[nodiscard]] std::string meta_header(const SmallVolume& volume, const std::string& type, bool big, bool packed,
                                      const std::string& data_file);
/// Sidecar text with every key that places the volume; `more` are further lines.
[[nodiscard]] std::string raw_sidecar(const SmallVolume& volume, const std::string& byte_order, const std::string& more);

}  // namespace burrhole::test
