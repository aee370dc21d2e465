// Damaged and lying DICOM files: the answer is a scan or one line of bad_input, never a crash, a hang or memory beyond the file's worth.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "core/base/random.h"
#include "tests/support/dicom_writer.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/dicom_elements.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Small files that between them hold every structure the reader walks.
std::vector<std::string> samples() {
  DicomData icon, position, frame, orientation, measures, shared;
  icon.numbers(0x00280010, "US", {1}).pixels("OB", 1, "ab");
  position.text(0x00200032, "DS", "0\\0\\1");
  orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
  measures.text(0x00280030, "DS", "1\\1").text(0x00180050, "DS", "2");
  frame.items(0x00209113, {position});
  shared.items(0x00209116, {orientation}).items(0x00289110, {measures});
  DicomData plain = ct_slice({});
  plain.items(0x00880200, {icon}).text(0x00100010, "PN", "A^B");
  DicomData enhanced = plain;
  enhanced.erase(0x00200032).text(0x00280008, "IS", "1").items(0x52009229, {shared}).items(0x52009230, {frame});
  DicomData rle = plain;
  // Two segments of 30 equal bytes each, and the header that says where they lie.
  rle.pieces({std::string("\x02\0\0\0\x40\0\0\0\x42\0\0\0", 12) + std::string(52, '\0') + std::string("\xe3\x04\xe3\x00", 4)});
  return {plain.file(),    plain.file(kImplicitLittle),    plain.file(kExplicitBig),
          enhanced.file(), enhanced.file(kImplicitLittle), rle.file(kRleLossless)};
}

/// Reads bytes as a file. @returns the message, empty when it was read; anything else than a scan of finite values or bad_input fails.
std::string answer(const TemporaryFolder& folder, const std::string& bytes) {
  const std::string path = folder.file("broken");
  write_bytes(path, bytes);
  const auto out = read_dicom(path, {});
  if (!out) {
    CHECK(out.error().code == ErrorCode::bad_input);
    CHECK(out.error().place == path);
    CHECK_FALSE(out.error().message.empty());
    CHECK(out.error().message.size() < 300);
    return out.error().message;
  }
  const Vec3i dims = out->scan.dims;
  bool good = dims.x > 0 && dims.y > 0 && dims.z > 0;
  good = good &&
         out->scan.values.size() == static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
  for (const float v : out->scan.values) good = good && std::isfinite(v);
  CHECK(good);
  return {};
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

TEST_CASE("read_dicom: the sound samples are read, so that what follows damages something") {
  const TemporaryFolder folder;
  for (const std::string& bytes : samples()) CHECK(answer(folder, bytes) == "");
}

TEST_CASE("read_dicom: a file cut anywhere is refused") {
  const TemporaryFolder folder;
  for (const std::string& bytes : samples())
    for (std::size_t length = 0; length < bytes.size(); length += length < 128 ? 32 : 5)
      CHECK(answer(folder, bytes.substr(0, length)) != "");
}

TEST_CASE("read_dicom: random bits turned over in headers and pixels never crash it") {
  const TemporaryFolder folder;
  const std::uint64_t seed = 20240611;
  std::size_t read = 0, refused = 0;
  std::uint64_t counter = 0;
  for (const std::string& bytes : samples())
    for (int n = 0; n < 600; ++n) {
      std::string damaged = bytes;
      const int flips = 1 + static_cast<int>(uniform01(seed, ++counter) * 4.0);
      for (int f = 0; f < flips; ++f) {
        const auto at = 128 + static_cast<std::size_t>(uniform01(seed, ++counter) * static_cast<double>(bytes.size() - 128));
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << static_cast<int>(uniform01(seed, ++counter) * 8.0)));
      }
      CAPTURE(seed);
      CAPTURE(counter);
      ++(answer(folder, damaged).empty() ? read : refused);
    }
  // Both must occur, or the damage is not where it matters.
  CHECK(read > 300);
  CHECK(refused > 300);
}

TEST_CASE("read_dicom: every 16-bit word set to its extremes never crashes it") {
  const TemporaryFolder folder;
  for (const std::string& bytes : samples())
    for (std::size_t at = 132; at + 2 <= bytes.size(); at += 6)
      for (const char fill : {'\0', '\x7f', '\xff'}) {
        std::string damaged = bytes;
        damaged[at] = damaged[at + 1] = fill;
        static_cast<void>(answer(folder, damaged));
      }
}

TEST_CASE("read_dicom: sizes larger than the file can hold are refused before memory is taken") {
  const TemporaryFolder folder;
  const double before = peak_megabytes();
  DicomData data = ct_slice({});
  data.numbers(0x00280010, "US", {65535}).numbers(0x00280011, "US", {65535});
  CHECK(answer(folder, data.file()) == "4.295e+09 voxels are more than the 2.147e+09 that are read");
  data.numbers(0x00280010, "US", {30000}).numbers(0x00280011, "US", {30000});
  CHECK(answer(folder, data.file()) == "pixels cut short: 60 of 1800000000 bytes are there");
  CHECK(answer(folder, data.pieces({std::string(100, 'x')}).file(kRleLossless)).find("more than 1000 to 1 is not accepted") !=
        std::string::npos);
  data.text(0x00280008, "IS", "2000000000");
  CHECK(answer(folder, data.file(kRleLossless)) != "");
  // An element that claims 3 GiB, at the top and inside a sequence.
  const std::string huge = std::string("\x10\0\x10\0UN\0\0\0\0\0\xc0", 12);
  const std::string head = ct_slice({}).file().substr(0, 132 + 60);
  CHECK(answer(folder, head + huge + std::string(50, ' ')) != "");
  CHECK(peak_megabytes() - before < 50.0);
}

TEST_CASE("read_dicom: sequences within sequences without end are refused, not recursed into") {
  const TemporaryFolder folder;
  std::string bytes = std::string(128, '\0') + "DICM" +
                      std::string(
                          "\x02\0\x10\0UI\x14\0"
                          "1.2.840.10008.1.2.1\0",
                          28);
  for (int n = 0; n < 100000; ++n) bytes += std::string("\x08\0\x40\x11SQ\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\xff\xff\xff\xff", 20);
  CHECK(answer(folder, bytes) != "");
}

TEST_CASE("read_dicom: a deflated file that would fill the memory is refused at its bound") {
  const TemporaryFolder folder;
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  // A group of the past, 512 MiB long: zeros inflate a thousandfold.
  std::vector<unsigned char> zeros(1 << 20), packed(1 << 20);
  stream.next_out = packed.data();
  stream.avail_out = static_cast<unsigned>(packed.size());
  for (int n = 0; n < 512; ++n) {
    stream.next_in = zeros.data();
    stream.avail_in = static_cast<unsigned>(zeros.size());
    REQUIRE(deflate(&stream, n == 511 ? Z_FINISH : Z_NO_FLUSH) >= 0);
  }
  const std::size_t size = packed.size() - stream.avail_out;
  deflateEnd(&stream);
  const std::string meta = std::string(128, '\0') + "DICM" +
                           std::string(
                               "\x02\0\x10\0UI\x16\0"
                               "1.2.840.10008.1.2.1.99",
                               30);
  CHECK(answer(folder, meta + std::string(reinterpret_cast<const char*>(packed.data()), size)) != "");
}

// GDCM's own assertions are on in distributions: a stream that reaches them would end the program.
TEST_CASE("read_dicom: bits turned over in real compressed streams never crash it") {
  const std::filesystem::path data = real_data("dicom_transfer_syntaxes");
  const TemporaryFolder folder;
  std::uint64_t counter = 0;
  std::set<std::string> codecs;
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    const std::string name = entry.path().filename().string();
    if (name.find("JPEG") == std::string::npos && name.find("RLE") == std::string::npos && name.find("Deflated") == std::string::npos)
      continue;
    const std::string whole = read_bytes(entry.path().string());
    REQUIRE(answer(folder, whole) == "");  // so that what follows damages something
    for (const char* codec : {"JPEG", "RLE", "Deflated"})
      if (name.find(codec) != std::string::npos) codecs.insert(codec);
    for (int n = 0; n < 120; ++n) {
      std::string damaged = whole;
      // Half of the damage falls on the stream's own header, which follows the file's.
      const double from = 7000.0, length = n % 2 == 0 ? 500.0 : static_cast<double>(whole.size()) - from - 20.0;
      for (int f = 0; f < 3; ++f) {
        const auto at = static_cast<std::size_t>(from + uniform01(99, ++counter) * length);
        damaged[at] = static_cast<char>(mix64(counter));
      }
      CAPTURE(name);
      CAPTURE(counter);
      static_cast<void>(answer(folder, damaged));
    }
  }
  CHECK(codecs.size() == 3);
}
