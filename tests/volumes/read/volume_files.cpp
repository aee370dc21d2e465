#include "tests/volumes/read/volume_files.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <zlib.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace burrhole::test {
namespace {

std::string deflated(const std::string& bytes, int window_bits) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<unsigned char*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string vector_text(const Vec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); }

}  // namespace

SmallVolume small_volume() {
  SmallVolume out;
  out.lps_mm.linear = Mat3(Vec3(0.5, 0.125, 0.0), Vec3(-0.25, 0.75, 0.0625), Vec3(0.0, 0.3125, 1.25));
  out.lps_mm.offset = Vec3(-12.5, 30.25, 8.125);
  const int count = out.dims.x * out.dims.y * out.dims.z;
  for (int n = 0; n < count; ++n) out.values.push_back(static_cast<std::int16_t>((n * 37) % 211 * 17 - 1024));
  return out;
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  REQUIRE(file.good());
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file.good());
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string gzip(const std::string& bytes) { return deflated(bytes, 15 + 16); }
std::string zlib_packed(const std::string& bytes) { return deflated(bytes, 15); }

std::string nifti_header(const SmallVolume& volume, const NiftiWrite& how) {
  const bool two = how.version == 2, big = how.big;
  std::string h(two ? 544 : 352, '\0');
  const auto real = [&](std::size_t at, std::size_t n, double value) {
    if (two)
      set(h, at + 8 * n, value, big);
    else
      set(h, at + 4 * n, static_cast<float>(value), big);
  };
  const auto size = [&](std::size_t at, std::size_t n, int value) {
    if (two)
      set(h, at + 8 * n, static_cast<std::int64_t>(value), big);
    else
      set(h, at + 2 * n, static_cast<std::int16_t>(value), big);
  };
  set(h, 0, two ? 540 : 348, big);
  h.replace(two ? 4 : 344, 4, std::string(how.pair ? "ni" : "n+") + (two ? "2" : "1") + std::string(1, '\0'));
  if (two) h.replace(8, 4, "\r\n\x1a\n");
  const std::size_t dim = two ? 16 : 40, pixdim = two ? 104 : 76, srow = two ? 400 : 280;
  const int dims[8] = {3, volume.dims.x, volume.dims.y, volume.dims.z, 1, 1, 1, 1};
  for (std::size_t n = 0; n < 8; ++n) size(dim, n, dims[n]);
  set(h, two ? 12 : 70, how.datatype, big);
  set(h, two ? 14 : 72, how.bitpix, big);
  real(pixdim, 0, 1.0);
  for (std::size_t n = 0; n < 3; ++n) real(pixdim, n + 1, glm::length(volume.lps_mm.linear[n]));
  if (two)
    set(h, 168, static_cast<std::int64_t>(how.pair ? 0 : 544), big);
  else
    set(h, 108, how.pair ? 0.0f : 352.0f, big);
  real(two ? 176 : 112, 0, how.slope);
  real(two ? 184 : 116, 0, how.intercept);
  const Vec3 to_ras(-1, -1, 1);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) real(srow, 4 * row + column, to_ras[row] * volume.lps_mm.linear[column][row]);
    real(srow, 4 * row + 3, to_ras[row] * volume.lps_mm.offset[row]);
  }
  if (two) {
    set(h, 344, how.qform, big);
    set(h, 348, how.sform, big);
    set(h, 500, how.units, big);
  } else {
    set(h, 252, static_cast<std::int16_t>(how.qform), big);
    set(h, 254, static_cast<std::int16_t>(how.sform), big);
    h[123] = static_cast<char>(how.units);
  }
  return h;
}

std::string nrrd_header(const SmallVolume& volume, const std::string& type, const std::string& endian, const std::string& encoding) {
  const Affine& a = volume.lps_mm;
  return fmt::format(
      "NRRD0004\n# made by a test\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\nspace directions: {} {} {}\n"
      "kinds: domain domain domain\nspace units: \"mm\" \"mm\" \"mm\"\nendian: {}\nencoding: {}\nspace origin: {}\n",
      type, volume.dims.x, volume.dims.y, volume.dims.z, vector_text(a.linear[0]), vector_text(a.linear[1]), vector_text(a.linear[2]),
      endian, encoding, vector_text(a.offset));
}

std::string meta_header(const SmallVolume& volume, const std::string& type, bool big, bool packed, const std::string& data_file) {
  std::string matrix, spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = glm::length(volume.lps_mm.linear[axis]);
    const Vec3 unit = volume.lps_mm.linear[axis] / length;
    matrix += fmt::format(" {} {} {}", unit.x, unit.y, unit.z);
    spacing += fmt::format(" {}", length);
  }
  return fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {}\nCompressedData = {}\nTransformMatrix ={}\n"
      "Offset = {} {} {}\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\nElementSpacing ={}\nDimSize = {} {} {}\nElementType = {}\n"
      "ElementDataFile = {}\n",
      big ? "True" : "False", packed ? "True" : "False", matrix, volume.lps_mm.offset.x, volume.lps_mm.offset.y, volume.lps_mm.offset.z,
      spacing, volume.dims.x, volume.dims.y, volume.dims.z, type, data_file);
}

std::string raw_sidecar(const SmallVolume& volume, const std::string& byte_order, const std::string& more) {
  std::string direction, spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = glm::length(volume.lps_mm.linear[axis]);
    const Vec3 unit = volume.lps_mm.linear[axis] / length;
    direction += fmt::format("{:.17g}, {:.17g}, {:.17g}, ", unit.x, unit.y, unit.z);
    spacing += fmt::format("{:.17g}, ", length);
  }
  const Vec3 at = volume.lps_mm.offset;
  return fmt::format(
      "dims = [{}, {}, {}]\ntype = \"int16\"\nbyte_order = \"{}\"\nspacing_mm = [{}]\ndirection = [{}]\norigin_mm = [{}, {}, {}]\n{}\n",
      volume.dims.x, volume.dims.y, volume.dims.z, byte_order, spacing, direction, at.x, at.y, at.z, more);
}

}  // namespace burrhole::test
