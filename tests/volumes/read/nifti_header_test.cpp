#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "core/base/units.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/nifti_header.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

// The numbers of the small volume are exact in float; what is left is one rounding of the factor 1e-3 on values under 0.1 m.
constexpr double kRounding = 1e-15;  // [m]

Result<NiftiHeader> parse(const std::string& bytes) { return parse_nifti(std::as_bytes(std::span(bytes))); }

double apart(const Affine& a, const Affine& b_mm) {
  double farthest = glm::length(a.offset - b_mm.offset * kMillimetre);
  for (std::size_t n = 0; n < 3; ++n) farthest = std::max(farthest, glm::length(a.linear[n] - b_mm.linear[n] * kMillimetre));
  return farthest;
}

std::string fault_of(const std::string& bytes) {
  const auto header = parse(bytes);
  REQUIRE_FALSE(header.ok());
  CHECK(header.error().code == ErrorCode::bad_input);
  CHECK(header.error().message.find('\n') == std::string::npos);
  return header.error().message;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("parse_nifti: both versions and byte orders say the same of one volume") {
  const SmallVolume volume = small_volume();
  for (const int version : {1, 2})
    for (const bool big : {false, true}) {
      INFO("version ", version, " big ", big);
      const auto header = parse(nifti_header(volume, {.version = version, .big = big, .slope = 2.0, .intercept = -8.0}));
      REQUIRE(header.ok());
      const NiftiHeader& h = header.value();
      CHECK(h.version == version);
      CHECK(h.image.form.big_endian == big);
      CHECK(h.image.dims == volume.dims);
      CHECK(h.image.form.type == PixelType::i16);
      CHECK(h.image.form.slope == 2.0);
      CHECK(h.image.form.intercept == -8.0);
      CHECK(h.data_offset == (version == 1 ? 352 : 544));
      CHECK(apart(h.image.bone_from_index, volume.lps_mm) < kRounding);
      CHECK(h.image.assumed.empty());
    }
}

TEST_CASE("parse_nifti: a quaternion of 90 degrees about z and a flipped third axis, by hand") {
  SmallVolume volume = small_volume();
  std::string bytes = nifti_header(volume, {.sform = 0, .qform = 1});
  const float half = std::sqrt(0.5f);
  set(bytes, 76, -1.0f, false);  // qfac
  for (std::size_t n = 0; n < 3; ++n) set(bytes, 80 + 4 * n, static_cast<float>(n + 1) * 0.5f, false);
  set(bytes, 264, half, false);  // d: a turn about z
  set(bytes, 268, 4.0f, false);
  const auto header = parse(bytes);
  REQUIRE(header.ok());
  // RAS: i to +y, j to -x, k to -z; LPS turns the signs of x and y
  const Affine expected{Mat3(Vec3(0, -0.5, 0), Vec3(1, 0, 0), Vec3(0, 0, -1.5)), Vec3(-4, 0, 0)};
  CHECK(apart(header->image.bone_from_index, expected) < 1e-9);  // a float quaternion turns by up to 1e-7 rad, over 1.5 mm
}

TEST_CASE("parse_nifti: half a turn whose floats sum to more than 1 stays a turn") {
  std::string bytes = nifti_header(small_volume(), {.sform = 0, .qform = 1});
  for (std::size_t n = 0; n < 3; ++n) set(bytes, 80 + 4 * n, 1.0f, false);
  set(bytes, 256, std::nextafter(1.0f, 2.0f), false);
  const auto header = parse(bytes);
  REQUIRE(header.ok());
  CHECK(apart(header->image.bone_from_index, {Mat3(Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, -1)), Vec3(0)}) < kRounding);
}

TEST_CASE("parse_nifti: sform is preferred, and reported when qform lies elsewhere") {
  std::string bytes = nifti_header(small_volume(), {.qform = 1});
  set(bytes, 268, 40.0f, false);
  const auto header = parse(bytes);
  REQUIRE(header.ok());
  CHECK(apart(header->image.bone_from_index, small_volume().lps_mm) < kRounding);
  REQUIRE(header->image.assumed.size() == 1);
  CHECK(holds(header->image.assumed[0], "sform and qform lie"));
}

TEST_CASE("parse_nifti: with neither, and without a unit, what is assumed is reported") {
  const auto header = parse(nifti_header(small_volume(), {.sform = 0, .units = 0}));
  REQUIRE(header.ok());
  CHECK(header->image.assumed.size() == 2);
  CHECK(header->image.bone_from_index.linear[0].x < 0.0);  // right is -x in LPS
}

TEST_CASE("parse_nifti: metres and micrometres") {
  struct Unit {
    int code;
    float factor;  // of the numbers in the file, a power of two
    double in_mm;
  };
  for (const Unit& unit : {Unit{1, 1.0f / 1024, 1000.0}, Unit{2, 1.0f, 1.0}, Unit{3, 1024.0f, 1e-3}}) {
    INFO("unit ", unit.code);
    std::string bytes = nifti_header(small_volume(), {.units = unit.code});
    for (std::size_t n = 0; n < 12; ++n) {
      float value = 0;
      std::memcpy(&value, bytes.data() + 280 + 4 * n, 4);
      set(bytes, 280 + 4 * n, value * unit.factor, false);
    }
    Affine expected = small_volume().lps_mm;
    expected.linear *= unit.factor * unit.in_mm, expected.offset *= unit.factor * unit.in_mm;
    const auto header = parse(bytes);
    REQUIRE(header.ok());
    CHECK(apart(header->image.bone_from_index, expected) < kRounding);
  }
}

TEST_CASE("parse_nifti: scl_slope of 0 or NaN means values as they are") {
  for (const double slope : {0.0, std::nan("")}) {
    const auto header = parse(nifti_header(small_volume(), {.slope = slope, .intercept = 5.0}));
    CHECK(header->image.form.slope == 1.0);
    CHECK(header->image.form.intercept == 0.0);
  }
}

TEST_CASE("parse_nifti: what cannot be one volume of plain numbers is refused by name") {
  const SmallVolume volume = small_volume();
  const auto changed = [&](std::size_t at, std::int16_t value) {
    std::string bytes = nifti_header(volume, {});
    set(bytes, at, value, false);
    return bytes;
  };
  std::string four = changed(40, 4);
  set(four, 48, std::int16_t{12}, false);
  CHECK(holds(fault_of(four), "4D: 12 volumes"));
  std::string five = changed(40, 5);
  set(five, 50, std::int16_t{3}, false);
  CHECK(holds(fault_of(five), "3 numbers per voxel"));
  CHECK(parse(changed(40, 4)).ok());  // a fourth axis of one
  CHECK(holds(fault_of(changed(40, 2)), "2D"));
  CHECK(holds(fault_of(changed(40, 9)), "dim[0] = 9"));
  CHECK(holds(fault_of(changed(42, 0)), "0 x 5 x 4"));
  CHECK(holds(fault_of(changed(42, -7)), "-7 x 5 x 4"));
  CHECK(holds(fault_of(changed(70, 128)), "RGB"));
  CHECK(holds(fault_of(changed(70, 2304)), "RGB"));
  CHECK(holds(fault_of(changed(70, 32)), "complex"));
  CHECK(holds(fault_of(changed(70, 1)), "datatype 1 "));
  CHECK(holds(fault_of(changed(72, 8)), "bitpix says 8"));
  std::string analyze = nifti_header(volume, {});
  analyze.replace(344, 4, std::string(4, '\0'));
  CHECK(holds(fault_of(analyze), "Analyze 7.5"));
  CHECK(holds(fault_of(nifti_header(volume, {}).substr(0, 200)), "200 of 348"));
  CHECK(holds(fault_of(""), "not a NIfTI"));
  std::string offset = nifti_header(volume, {});
  set(offset, 108, 12.0f, false);
  CHECK(holds(fault_of(offset), "vox_offset = 12"));
  std::string flat = nifti_header(volume, {});
  for (std::size_t n = 0; n < 12; ++n) set(flat, 280 + 4 * n, 0.0f, false);
  CHECK(holds(fault_of(flat), "mm long"));
}

TEST_CASE("parse_nifti: sizes of NIfTI-2 that overflow are refused with the numbers") {
  std::string bytes = nifti_header(small_volume(), {.version = 2});
  set(bytes, 24, std::int64_t{1} << 40, false);
  CHECK(holds(fault_of(bytes), "1099511627776 x 5 x 4"));
  set(bytes, 24, std::int64_t{2000000000}, false);
  CHECK(holds(fault_of(bytes), "more than"));
}
