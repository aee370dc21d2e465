// Pixels of DICOM files written by the test: types, bits, byte orders, rescale, padding, RLE, multi-frame.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/base/random.h"
#include "tests/support/dicom_writer.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/dicom_pixels.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

struct Bits {
  int allocated = 16, stored = 16, high = 15, is_signed = 1;
};

/// A file of one row of `words` (as they lie in the file), in the given layout, without rescale unless added.
DicomData row_of(const std::vector<std::uint32_t>& words, const Bits& bits) {
  std::string raw;
  for (const std::uint32_t w : words)
    for (int b = 0; b < bits.allocated / 8; ++b) raw += static_cast<char>((w >> (8 * b)) & 0xff);
  const auto u16 = [](int v) { return std::vector<std::uint16_t>{static_cast<std::uint16_t>(v)}; };
  DicomData data = ct_slice({.columns = static_cast<int>(words.size()), .rows = 1});
  data.numbers(0x00280100, "US", u16(bits.allocated)).numbers(0x00280101, "US", u16(bits.stored));
  data.numbers(0x00280102, "US", u16(bits.high)).numbers(0x00280103, "US", u16(bits.is_signed));
  data.text(0x00281052, "DS", "0").text(0x00281053, "DS", "1");
  return data.pixels(bits.allocated == 8 ? "OB" : "OW", bits.allocated / 8, raw);
}

ReadScan read(const DicomData& data, const std::string& syntax = kExplicitLittle) {
  const TemporaryFolder folder;
  data.write(folder.file("a"), syntax);
  auto out = read_dicom(folder.file("a"), {});
  if (!out) FAIL(out.error().message);
  return std::move(out).value();
}

std::string refusal(const DicomData& data, const std::string& syntax = kExplicitLittle) {
  const TemporaryFolder folder;
  data.write(folder.file("a"), syntax);
  const auto out = read_dicom(folder.file("a"), {});
  if (out.ok()) return "(read)";
  CHECK(out.error().code == ErrorCode::bad_input);
  CHECK(out.error().place == folder.file("a"));
  return out.error().message;
}

bool told(const ReadScan& scan, const std::string& part) {
  const auto& assumed = scan.report.assumed;
  return std::any_of(assumed.begin(), assumed.end(), [&](const std::string& a) { return a.find(part) != std::string::npos; });
}

using Values = std::vector<float>;

/// PackBits as the standard's example writer: runs of equal bytes, else literals of one. The test's own.
std::string pack_bits(const std::string& plain) {
  std::string out;
  for (std::size_t at = 0; at < plain.size();) {
    std::size_t run = 1;
    while (at + run < plain.size() && run < 128 && plain[at + run] == plain[at]) ++run;
    out += static_cast<char>(run == 1 ? 0 : 1 - static_cast<int>(run));
    out += plain[at];
    at += run;
  }
  return out;
}

std::string rle_frame(const std::vector<std::string>& planes) {
  std::vector<std::string> packed;
  for (const std::string& p : planes) packed.push_back(pack_bits(p));
  const auto u32 = [](std::size_t v) {
    std::string s;
    for (int b = 0; b < 4; ++b) s += static_cast<char>((v >> (8 * b)) & 0xff);
    return s;
  };
  std::string head = u32(planes.size());
  std::size_t at = 64;
  for (const std::string& p : packed) head += u32(at), at += p.size();
  head.resize(64, '\0');
  for (const std::string& p : packed) head += p;
  return head;
}

/// Frame n has the pixels 100 n, 100 n + 1, ...
DicomData multi_frame(const std::vector<double>& heights) {
  std::vector<int> stored;
  for (std::size_t n = 0; n < heights.size(); ++n)
    for (int p = 0; p < 30; ++p) stored.push_back(static_cast<int>(n) * 100 + p);
  return ct_frames({}, heights).pixels("OW", 2, words16(stored));
}

}  // namespace

TEST_CASE("read_dicom: 8, 16 and 32 bits, signed and not, come out as the numbers they are") {
  CHECK(read(row_of({0, 1, 255, 128}, {8, 8, 7, 0})).scan.values == Values{0, 1, 255, 128});
  CHECK(read(row_of({0, 1, 255, 128}, {8, 8, 7, 1})).scan.values == Values{0, 1, -1, -128});
  CHECK(read(row_of({0, 65535, 32768}, {16, 16, 15, 0})).scan.values == Values{0, 65535, 32768});
  CHECK(read(row_of({0, 65535, 0xfc18}, {16, 16, 15, 1})).scan.values == Values{0, -1, -1000});
  CHECK(read(row_of({7, 0xffffffff, 1u << 30}, {32, 32, 31, 1})).scan.values == Values{7, -1, 1073741824.0f});
  CHECK(read(row_of({7, 0xffffffff}, {32, 32, 31, 0})).scan.values == Values{7, 4294967295.0f});
}

TEST_CASE("read_dicom: 12 bits in 16 are extended with their sign, and overlay bits above or below are masked") {
  CHECK(read(row_of({0x0fff, 0x0800, 0x07ff}, {16, 12, 11, 0})).scan.values == Values{4095, 2048, 2047});
  CHECK(read(row_of({0x0fff, 0x0c18, 0x07ff}, {16, 12, 11, 1})).scan.values == Values{-1, -1000, 2047});
  CHECK(read(row_of({0xffff, 0x1c18, 0xa7ff}, {16, 12, 11, 1})).scan.values == Values{-1, -1000, 2047});
  CHECK(read(row_of({0xfff5, 0x0015}, {16, 12, 15, 0})).scan.values == Values{4095, 1});
}

TEST_CASE("read_dicom: implicit, explicit and big-endian files of the same slice read the same") {
  const CtSlice slice{.stored = [](int i, int j) { return 700 + 256 * i + 17 * j; }};
  const ReadScan reference = read(ct_slice(slice));
  CHECK(reference.scan.values[7] == 700.0f + 256.0f + 17.0f - 1024.0f);
  for (const char* syntax : {kImplicitLittle, kExplicitBig}) {
    const ReadScan other = read(ct_slice(slice), syntax);
    CHECK(other.scan.values == reference.scan.values);
    CHECK(other.scan.bone_from_index.linear == reference.scan.bone_from_index.linear);
  }
  // 8-bit pixels in words: big-endian files exchange neighbours. PS3.5 annex A.3.
  DicomData swapped = row_of({1, 2, 3, 4}, {8, 8, 7, 0});
  swapped.pixels("OW", 2, "\x01\x02\x03\x04");
  CHECK(read(swapped, kExplicitBig).scan.values == Values{1, 2, 3, 4});
  CHECK(read(swapped, kExplicitLittle).scan.values == Values{1, 2, 3, 4});
}

TEST_CASE("read_dicom: files without the preamble are read, as old ones lack it") {
  const std::string whole = ct_slice({}).file();
  const TemporaryFolder folder;
  write_bytes(folder.file("a"), whole.substr(132));
  CHECK(read_dicom(folder.file("a"), {}).ok());
  // Without group 0002 either: the first element is that of the data set, with its value type or without.
  const auto data_set = [](const DicomData& data, const char* syntax) {
    const std::string file = data.file(syntax);
    return file.substr(file.find(std::string("\x08\0", 2), 132 + file.substr(132).find(syntax)));
  };
  DicomData late = ct_slice({});
  for (const std::uint32_t tag : {0x00080008u, 0x00080016u, 0x00080018u}) late.erase(tag);
  for (const DicomData& data : {ct_slice({}), late}) {
    write_bytes(folder.file("a"), data_set(data, kExplicitLittle));
    CHECK(read_scan(folder.path().string() + "/a", {}).ok());
  }
  write_bytes(folder.file("a"), data_set(ct_slice({}), kImplicitLittle));
  CHECK(read_scan(folder.file("a"), {}).ok());
}

TEST_CASE("read_dicom: slope and intercept are each slice's own") {
  const TemporaryFolder folder;
  for (int k = 0; k < 3; ++k)
    ct_slice({.position = {0, 0, 1.0 * k}, .instance = fmt::format("1.{}", k), .stored = [](int, int) { return 10; }})
        .text(0x00281053, "DS", decimals({1.0 + k}))
        .text(0x00281052, "DS", decimals({-0.5 * k}))
        .write(folder.file(fmt::format("{}", k)));
  const auto out = read_dicom(folder.path().string(), {});
  REQUIRE(out.ok());
  CHECK(out->scan.values[0] == 10.0f);
  CHECK(out->scan.values[30] == 19.5f);
  CHECK(out->scan.values[60] == 29.0f);
}

TEST_CASE("read_dicom: padding becomes air, what lies below air is clamped, both are counted and reported") {
  DicomData data = row_of({0xf830, 0x0005, 0xfbff, 0xfc00, 0xf831, 0xf000}, {16, 16, 15, 1});
  data.numbers(0x00280120, "US", {0xf830}).numbers(0x00280121, "US", {0xf831});
  const ReadScan out = read(data);
  CHECK(out.scan.values == Values{-1024, 5, -1024, -1024, -1024, -1024});
  CHECK(told(out, "2 padding pixels set to -1024 HU (air)"));
  CHECK(told(out, "2 pixels below -1024 HU set to -1024 HU"));
  // Padding above all bone must not come out as bone.
  CHECK(read(row_of({32767, 40}, {16, 16, 15, 1}).numbers(0x00280120, "SS", {32767})).scan.values == Values{-1024, 40});
  // Of other modalities nothing is known, so nothing is changed.
  const ReadScan mr = read(row_of({0xf000, 40}, {16, 16, 15, 1}).numbers(0x00280120, "US", {40}).text(0x00080060, "CS", "MR"));
  CHECK(mr.scan.values == Values{-4096, 40});
  CHECK(mr.scan.quantity == Quantity::other);
}

TEST_CASE("read_dicom: what the values mean follows modality and RescaleType") {
  CHECK(read(ct_slice({})).scan.quantity == Quantity::hounsfield);
  CHECK(read(ct_slice({}).text(0x00281054, "LO", "HU")).scan.quantity == Quantity::hounsfield);
  const ReadScan us = read(ct_slice({}).text(0x00281054, "LO", "US"));
  CHECK(us.scan.quantity == Quantity::other);
  CHECK(told(us, "RescaleType is not HU"));
  CHECK(told(read(ct_slice({}).erase(0x00281052).erase(0x00281053)), "lack rescale slope"));
}

TEST_CASE("read_dicom: MONOCHROME1 turns the display over, not the numbers") {
  const ReadScan plain = read(ct_slice({.stored = [](int i, int) { return i; }}));
  const ReadScan white = read(ct_slice({.stored = [](int i, int) { return i; }}).text(0x00280004, "CS", "MONOCHROME1"));
  CHECK(white.scan.values == plain.scan.values);
  CHECK(told(white, "MONOCHROME1"));
}

TEST_CASE("read_dicom: rescale that gives no finite numbers and bits that do not fit are refused") {
  CHECK(refusal(ct_slice({}).text(0x00281053, "DS", "1e300")).find("give no usable values") != std::string::npos);
  for (const char* none : {"-1O24", "-1024,0", ""})
    CHECK(refusal(ct_slice({}).text(0x00281052, "DS", none)) == "rescale slope or intercept is not a number");
  CHECK(refusal(ct_slice({}).text(0x00281053, "DS", "0")).find("rescale slope 0") != std::string::npos);
  CHECK(refusal(row_of({1, 2}, {16, 12, 5, 0})) == "12 bits stored below bit 5 do not fit into 16");
  CHECK(refusal(ct_slice({}).numbers(0x00280100, "US", {12})) == "pixels of 12 bits; 8, 16 and 32 are read");
  CHECK(refusal(ct_slice({}), "1.2.840.10008.1.2.4.100") == "transfer syntax 1.2.840.10008.1.2.4.100 is not read");
}

TEST_CASE("decode_rle: random images come back bit for bit, literals and runs alike") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::string high, low;
    for (std::uint64_t n = 0; n < 700; ++n) {
      high += static_cast<char>(mix64(seed + n / 40) & 3);
      low += static_cast<char>(mix64(seed * 1000 + n / (1 + seed % 5)));
    }
    const std::string frame = rle_frame({high, low});
    std::vector<std::byte> out;
    REQUIRE(decode_rle(std::as_bytes(std::span(frame)), 700, 2, out).empty());
    bool equal = true;
    for (std::size_t n = 0; n < 700; ++n)
      equal = equal && out[2 * n] == static_cast<std::byte>(low[n]) && out[2 * n + 1] == static_cast<std::byte>(high[n]);
    CHECK(equal);
  }
}

TEST_CASE("read_dicom: an RLE frame that gives too few bytes is refused with the numbers") {
  DicomData data = row_of(std::vector<std::uint32_t>(100, 5), {});
  CHECK(read(data.pieces({rle_frame({std::string(100, '\0'), std::string(100, '\x05')})}), kRleLossless).scan.values == Values(100, 5.0f));
  CHECK(refusal(data.pieces({rle_frame({std::string(100, '\0'), std::string(60, '\x05')})}), kRleLossless) ==
        "pixels cut short: RLE segment 2 gives 60 of 100 bytes");
  CHECK(refusal(data.pieces({std::string(10, '\0')}), kRleLossless) == "pixels cut short: 10 bytes of an RLE frame");
  CHECK(refusal(data.pieces({}), kRleLossless) == "pixels cut short: there is no compressed fragment");
}

TEST_CASE("read_dicom: frames of one file are stacked by their own positions, each with its own rescale") {
  for (const char* syntax : {kExplicitLittle, kImplicitLittle}) {
    const ReadScan out = read(multi_frame({4, 0, 2}), syntax);
    REQUIRE(out.scan.dims == Vec3i(6, 5, 3));
    CHECK(out.scan.bone_from_index.offset == Vec3(-10, -20, 0) * 1e-3);
    CHECK(std::abs(out.scan.bone_from_index.linear[2].z - 2e-3) < 1e-12);
    CHECK(std::abs(out.scan.bone_from_index.linear[0].x - 0.5e-3) < 1e-12);
    // The lowest is frame 1: 100 and its intercept 1; then frame 2: 200 + 2; then frame 0.
    CHECK(out.scan.values[0] == 101.0f);
    CHECK(out.scan.values[30] == 202.0f);
    CHECK(out.scan.values[60] == 0.0f);
    CHECK(out.scan.quantity == Quantity::hounsfield);
  }
}

TEST_CASE("read_dicom: frames that are no volume are refused with the numbers") {
  CHECK(refusal(multi_frame({0, 1, 0, 1})).find("multi-frame image that is not a volume: 4 frames at 2 positions") == 0);
  CHECK(refusal(multi_frame({0, 1, 2}).erase(0x52009230)) ==
        "multi-frame image that is not a volume: 3 frames without positions of their own");
  CHECK(refusal(multi_frame({0, 1, 2}).text(0x00280008, "IS", "5")) ==
        "multi-frame image that is not a volume: 5 frames, 3 of them described");
  CHECK(refusal(multi_frame({0, 1, 2}).erase(0x52009229)).find("3 of 3 frames without a position") != std::string::npos);
  CHECK(refusal(multi_frame({0, 1, 2, 4, 5})).find("is missing: step 2.00 mm where 1.00 mm is the rule") != std::string::npos);
}
