// DICOM on real files: a head phantom, one slice in nine transfer syntaxes, multi-frame. $BURRHOLE_DATA says where they are.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/base/units.h"
#include "tests/support/dicom_writer.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

std::string file_with(const std::string& folder, const std::string& part) {
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().find(part) != std::string::npos) return entry.path().string();
  FAIL("no file with " << part);
  return {};
}

ReadScan read(const std::string& path, const ReadOptions& options = {}) {
  auto out = read_dicom(path, options);
  if (!out) FAIL(out.error().text());
  return std::move(out).value();
}

bool told(const ScanReport& report, const std::string& part) {
  return std::any_of(report.assumed.begin(), report.assumed.end(), [&](const std::string& a) { return a.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("read_dicom: the head phantom comes in whole, sorted by position though names sort wrongly") {
  const std::string folder = real_data("head_ct_dicom_phantom_1mm").string();
  int calls = 0;
  double last = 0.0;
  ReadOptions options;
  options.progress = [&](double share) {
    ++calls;
    CHECK(share > last);
    last = share;
  };
  const ReadScan read_scan = read(folder, options);
  const Scan& scan = read_scan.scan;
  CHECK(scan.dims == Vec3i(512, 512, 48));
  CHECK(scan.quantity == Quantity::hounsfield);
  CHECK(calls == 48);
  CHECK(last == 1.0);
  const GridShape shape = describe_grid(scan.bone_from_index);
  // data/README.md: 0.4512 x 0.4512 x 1 mm, of four digits.
  CHECK(std::abs(shape.spacing.x / kMillimetre - 0.4512) < 1e-4);
  CHECK(std::abs(shape.spacing.z / kMillimetre - 1.0) < 1e-4);
  CHECK_FALSE(shape.mirrored);
  const auto [low, high] = std::minmax_element(scan.values.begin(), scan.values.end());
  CHECK(*low == -1024.0f);
  CHECK(*high == 1038.0f);
  const auto bone = std::count_if(scan.values.begin(), scan.values.end(), [](float v) { return v > 300.0f; });
  // 5.3 % by the README, of two digits.
  CHECK(std::abs(static_cast<double>(bone) / static_cast<double>(scan.values.size()) - 0.053) < 5e-4);
  REQUIRE(read_scan.report.series.size() == 1);
  CHECK(read_scan.report.series[0].direction == "axial");
  CHECK(read_scan.report.series[0].taken);
}

TEST_CASE("read_dicom: a phantom slice taken away is missed by number and place, and sabotage of the gap check") {
  const std::string folder = real_data("head_ct_dicom_phantom_1mm").string();
  const TemporaryFolder partial;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (std::size_t n = 0; n < files.size(); ++n)
    if (n != 20) std::filesystem::create_symlink(files[n], partial.path() / files[n].filename());
  const auto out = read_dicom(partial.path().string(), {});
  REQUIRE_FALSE(out.ok());
  CHECK(out.error().code == ErrorCode::bad_input);
  CHECK(out.error().message.find("of 48 is missing: step 2.00 mm where 1.00 mm is the rule, after z = ") != std::string::npos);
}

TEST_CASE("read_dicom: eight lossless transfer syntaxes of one slice give the same bits, the lossy one is close and reported") {
  const std::string folder = real_data("dicom_transfer_syntaxes").string();
  const ReadScan reference = read(file_with(folder, "LittleEndianExplicit"));
  CHECK(reference.scan.dims == Vec3i(512, 512, 1));
  CHECK(told(reference.report, "one slice: thickness "));
  CHECK(told(reference.report, "pixels below -1024 HU"));
  for (const char* name : {"LittleEndianImplicit", "BigEndianExplicit", "Deflated", "JPEG2000LosslessOnly", "JPEGLSLossless",
                           "JPEGProcess14SV1", "RLELossless"}) {
    CAPTURE(name);
    const ReadScan other = read(file_with(folder, name));
    CHECK(other.scan.values == reference.scan.values);
    CHECK(other.scan.bone_from_index.linear == reference.scan.bone_from_index.linear);
  }
  const ReadScan lossy = read(file_with(folder, "JPEGProcess2_4"));
  double sum2 = 0.0;
  for (std::size_t n = 0; n < lossy.scan.values.size(); ++n) {
    const double d = lossy.scan.values[n] - reference.scan.values[n];
    sum2 += d * d;
  }
  // Noise of a chest CT is 10 to 30 HU: a lossy copy further off than that would not be the same picture.
  const double rms = std::sqrt(sum2 / static_cast<double>(lossy.scan.values.size()));
  MESSAGE("lossy against lossless: rms " << rms << " HU");
  CHECK(rms > 0.0);
  CHECK(rms < 30.0);
}

TEST_CASE("read_dicom: compressed and plain files cut at many places are refused, never read as if whole") {
  const std::string folder = real_data("dicom_transfer_syntaxes").string();
  const TemporaryFolder cut;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string whole = read_bytes(entry.path().string());
    write_bytes(cut.file("whole.dcm"), whole);
    REQUIRE(read_dicom(cut.file("whole.dcm"), {}).ok());
    ++files;
    for (int n = 1; n <= 20; ++n) {
      const std::size_t length = whole.size() * static_cast<std::size_t>(n) / 21;
      CAPTURE(entry.path().filename().string());
      CAPTURE(length);
      write_bytes(cut.file("cut.dcm"), whole.substr(0, length));
      const auto out = read_dicom(cut.file("cut.dcm"), {});
      REQUIRE_FALSE(out.ok());
      CHECK(out.error().code == ErrorCode::bad_input);
      CHECK(out.error().text().find("short") != std::string::npos);
    }
  }
  CHECK(files > 0);
}

TEST_CASE("read_dicom: compressed streams cut inside, with every length around them set right, are refused") {
  const std::string folder = real_data("dicom_transfer_syntaxes").string();
  const TemporaryFolder cut;
  for (const char* name : {"JPEG2000LosslessOnly", "JPEGLSLossless", "JPEGProcess14SV1", "RLELossless", "JPEGProcess2_4"}) {
    const std::string whole = read_bytes(file_with(folder, name));
    // Pixel data, explicit, undefined length: 12 bytes, an empty table of 8, then the one fragment.
    const std::size_t pixels = whole.rfind(std::string("\xe0\x7f\x10\x00O", 5));
    REQUIRE(pixels != std::string::npos);
    std::size_t at = pixels + 12;
    const auto length_at = [&](std::size_t p) {
      std::size_t v = 0;
      for (int b = 3; b >= 0; --b) v = v << 8 | static_cast<unsigned char>(whole[p + 4 + static_cast<std::size_t>(b)]);
      return v;
    };
    at += 8 + length_at(at);
    const std::size_t length = length_at(at);
    std::size_t refused = 0;
    const bool marked = std::string(name).find("RLE") == std::string::npos;
    for (int n = 1; n <= 40; ++n) {
      // Every other cut is given the end marker that a whole stream has, so that only what is missing in between can tell.
      const std::string ending = marked && n % 2 == 0 ? "\xff\xd9" : "";
      const std::size_t kept = (length * static_cast<std::size_t>(n) / 41) & ~std::size_t{1};
      std::string file = whole.substr(0, at + 4);
      for (int b = 0; b < 4; ++b) file += static_cast<char>(((kept + ending.size()) >> (8 * b)) & 0xff);
      file += whole.substr(at + 8, kept) + ending + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
      write_bytes(cut.file("cut.dcm"), file);
      const auto out = read_dicom(cut.file("cut.dcm"), {});
      CAPTURE(name);
      CAPTURE(kept);
      CHECK_FALSE(out.ok());
      refused += out.ok() ? 0 : 1;
    }
    CHECK(refused == 40);
  }
}

// These files carry no functional groups: nothing says where a frame lies, so no volume can be made of them.
TEST_CASE("read_dicom: multi-frame MR without positions is refused for that, alike in three syntaxes") {
  const std::string folder = real_data("dicom_multiframe").string();
  for (const char* name : {"emri_small.dcm", "emri_small_jpeg_ls_lossless.dcm", "emri_small_RLE.dcm"}) {
    const auto out = read_dicom(folder + "/" + name, {});
    REQUIRE_FALSE(out.ok());
    CHECK(out.error().message == "multi-frame image that is not a volume: 10 frames without positions of their own");
    CHECK(out.error().place == folder + "/" + name);
  }
}
