// DICOM folders written by the test: which files are slices, which series is taken, where its voxels lie, what is told.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "core/base/units.h"
#include "tests/support/dicom_writer.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A stack of `count` slices along z, one file each, named so that names sort against positions.
struct Series {
  CtSlice slice;
  int count = 4;
  Vec3 step{0, 0, 1.0};
  int missing = -1;
  std::string prefix = "a";
};

void write_series(const TemporaryFolder& folder, const Series& series) {
  for (int k = 0; k < series.count; ++k) {
    if (k == series.missing) continue;
    CtSlice s = series.slice;
    s.position += static_cast<double>(k) * series.step;
    s.instance = fmt::format("{}.{}", s.series, k + 1);
    ct_slice(s).write(folder.file(fmt::format("{}{:03}", series.prefix, 500 - k)));
  }
}

ReadOptions of_series(const std::string& name) {
  ReadOptions options;
  options.series = name;
  return options;
}
ReadOptions keeping(const std::vector<std::string>& keywords) {
  ReadOptions options;
  options.keep = keywords;
  return options;
}

ReadScan read(const TemporaryFolder& folder, const ReadOptions& options = {}) {
  auto out = read_dicom(folder.path().string(), options);
  if (!out) FAIL(out.error().text());
  return std::move(out).value();
}

std::string refusal(const std::string& path, const ReadOptions& options = {}) {
  const auto out = read_dicom(path, options);
  if (out.ok()) return "(read)";
  CHECK(out.error().code == ErrorCode::bad_input);
  CHECK(out.error().place.find(path) == 0);
  CHECK(out.error().message.find('\n') == std::string::npos);
  return out.error().message;
}
std::string refusal(const TemporaryFolder& folder, const ReadOptions& options = {}) { return refusal(folder.path().string(), options); }

std::size_t skipped(const ScanReport& report, const std::string& reason) {
  const auto found = std::find_if(report.skipped.begin(), report.skipped.end(), [&](const Skipped& s) { return s.reason == reason; });
  return found == report.skipped.end() ? 0 : found->count;
}

bool told(const ScanReport& report, const std::string& part) {
  return std::any_of(report.assumed.begin(), report.assumed.end(), [&](const std::string& a) { return a.find(part) != std::string::npos; });
}

/// Where the brightest voxel of a scan lies [m].
Vec3 brightest(const Scan& scan) {
  const auto at = static_cast<std::size_t>(std::max_element(scan.values.begin(), scan.values.end()) - scan.values.begin());
  const auto nx = static_cast<std::size_t>(scan.dims.x), ny = static_cast<std::size_t>(scan.dims.y);
  return scan.bone_from_index * Vec3(static_cast<double>(at % nx), static_cast<double>(at / nx % ny), static_cast<double>(at / (nx * ny)));
}

constexpr int kMarkI = 4, kMarkJ = 1, kMarkK = 6;

/// A tilted, turned stack with one bright voxel; @returns where the test's own formula puts it [m].
Vec3 write_marker_stack(const TemporaryFolder& folder, const Vec3& step) {
  CtSlice s;
  s.position = {-101.25, -87.5, 33.125};
  s.row = {0.8, 0.6, 0.0};
  s.column = {-0.6, 0.8, 0.0};
  for (int k = 0; k < 9; ++k) {
    CtSlice slice = s;
    slice.position += static_cast<double>(k) * step;
    slice.instance = fmt::format("1.2.3.{}", k);
    slice.stored = [k](int i, int j) { return i == kMarkI && j == kMarkJ && k == kMarkK ? 3000 : 1024 + i + j; };
    ct_slice(slice).write(folder.file(fmt::format("{:02}", (k * 5) % 9)));
  }
  return (s.position + kMarkI * s.column_spacing * s.row + kMarkJ * s.row_spacing * s.column + static_cast<double>(kMarkK) * step) *
         kMillimetre;
}

}  // namespace

TEST_CASE("read_dicom: the brightest voxel of a tilted stack lands where the test's formula puts it") {
  const TemporaryFolder folder;
  const Vec3 expected = write_marker_stack(folder, {0.15, 0.35, 1.25});
  const ReadScan out = read(folder);
  // 0.01 mm: a hundredth of what a surgeon could see; decimals are written in full, so only roundings are left.
  CHECK(glm::length(brightest(out.scan) - expected) < 1e-5);
  CHECK(told(out.report, "gantry tilt"));
  CHECK(describe_grid(out.scan.bone_from_index).shear > 10.0 * kDegree);
}

// Sabotage twin: the same check must fail for a reader that straightens the tilt, or that exchanges the two pixel spacings.
TEST_CASE("read_dicom: the marker check sees a dropped tilt and exchanged spacings") {
  const TemporaryFolder folder;
  const Vec3 expected = write_marker_stack(folder, {0.15, 0.35, 1.25});
  Scan straight = read(folder).scan, exchanged = straight;
  straight.bone_from_index.linear[2] = Vec3(0, 0, 1.25e-3);
  CHECK(glm::length(brightest(straight) - expected) > 1e-3);
  std::swap(exchanged.bone_from_index.linear[0], exchanged.bone_from_index.linear[1]);
  CHECK(glm::length(brightest(exchanged) - expected) > 1e-3);
}

TEST_CASE("read_dicom: files that are no slices are skipped and counted by reason, in folders below too") {
  const TemporaryFolder folder;
  write_series(folder, {});
  std::filesystem::create_directory(folder.path() / "below");
  write_bytes(folder.file("below/readme.txt"), "not a picture");
  write_bytes(folder.file("below/empty"), "");
  CtSlice other;
  other.instance = "9.1";
  ct_slice(other).text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER").write(folder.file("scout"));
  ct_slice(other).text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7").write(folder.file("below/screen"));
  ct_slice(other).numbers(0x00280002, "US", {3}).text(0x00280004, "CS", "RGB").write(folder.file("colour"));
  ct_slice(other).text(0x00080016, "UI", "1.2.840.10008.1.3.10").write(folder.file("DICOMDIR"));
  ct_slice(other).erase(0x7fe00010).write(folder.file("report"));
  std::filesystem::copy_file(folder.file("a500"), folder.file("z-copy"));
  const ReadScan out = read(folder);
  CHECK(out.scan.dims == Vec3i(6, 5, 4));
  CHECK(skipped(out.report, "not DICOM") == 2);
  for (const char* reason : {"localizer", "screen capture", "colour picture", "DICOMDIR", "no image", "duplicate"}) {
    CAPTURE(reason);
    CHECK(skipped(out.report, reason) == 1);
  }
  CHECK(out.report.format == "DICOM");
}

TEST_CASE("read_dicom: a folder or file without any slice is refused for what was found there") {
  const TemporaryFolder folder;
  CHECK(refusal(folder) == "the folder holds no files");
  CHECK(refusal(folder.file("nowhere")) == "there is no such file or folder");
  write_bytes(folder.file("a.txt"), "text");
  write_bytes(folder.file("b.txt"), "text");
  ct_slice({}).numbers(0x00280002, "US", {3}).text(0x00280004, "CS", "RGB").write(folder.file("rgb"));
  CHECK(refusal(folder).starts_with("none of 3 files is a slice of a scan: 2 not DICOM, 1 colour picture; raw voxels are read by a file"));
  CHECK(refusal(folder.file("rgb")) == "the file is not a slice of a scan: colour picture");
  CHECK(refusal(folder.file("a.txt")) == "the file is not DICOM");
  CHECK(refusal("/dev/null") == "neither a file nor a folder");
}

TEST_CASE("read_dicom: a file that may not be read is a refusal, not a silent gap") {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  write_series(folder, {});
  fs::permissions(folder.path(), fs::perms::owner_all | fs::perms::group_all | fs::perms::others_read | fs::perms::others_exec);
  fs::permissions(folder.file("a500"), fs::perms::none);
  // The administrator may read everything, so the test becomes somebody else for a moment.
  const bool administrator = ::geteuid() == 0;
  if (administrator && ::seteuid(65534) != 0) {
    MESSAGE("SKIPPED: the administrator may read everything");
    return;
  }
  const std::string file = refusal(folder), lone = refusal(folder.file("a500"));
  if (administrator) REQUIRE(::seteuid(0) == 0);
  CHECK(file == "cannot be read: Permission denied");
  CHECK(lone == "cannot be read: Permission denied");
}

TEST_CASE("read_dicom: the largest axial series is taken; a name takes another; an unknown name lists them") {
  const TemporaryFolder folder;
  write_series(folder, {.slice = {.number = 2, .series = "1.1"}, .count = 4, .prefix = "a"});
  write_series(folder, {.slice = {.number = 3, .series = "1.2"}, .count = 6, .prefix = "b"});
  write_series(folder, {.slice = {.number = 3, .series = "1.3"}, .count = 5, .prefix = "c"});
  write_series(folder, {.slice = {.column = {0, 0, -1}, .number = 9, .series = "1.4"}, .count = 30, .step = {0, 1, 0}, .prefix = "d"});
  const ReadScan out = read(folder);
  CHECK(out.scan.dims.z == 6);
  REQUIRE(out.report.series.size() == 4);
  CHECK(out.report.series[0].name == "2");
  CHECK(out.report.series[1].name == "3");
  CHECK(out.report.series[1].taken);
  CHECK(out.report.series[2].name == "3b");
  CHECK(out.report.series[2].dims == Vec3i(6, 5, 5));
  CHECK(out.report.series[3].direction == "coronal");
  CHECK_FALSE(out.report.series[3].taken);
  CHECK(told(out.report, "series 9 is 5.0 times as large as series 3, which was taken, but is coronal"));
  CHECK(std::abs(out.report.series[1].spacing.x - 0.5e-3) < 1e-12);
  CHECK(std::abs(out.report.series[1].spacing.y - 0.75e-3) < 1e-12);
  CHECK(read(folder, of_series("3b")).scan.dims.z == 5);
  CHECK(read(folder, of_series("9")).scan.dims.z == 30);
  CHECK(refusal(folder, of_series("7")) == "no series '7'; there are: 2, 3, 3b, 9");
}

TEST_CASE("read_dicom: a faulty larger series is not passed over in silence, and is the refusal when named or alone") {
  const TemporaryFolder folder;
  write_series(folder, {.slice = {.number = 1, .series = "1.1"}, .count = 20, .missing = 7, .prefix = "a"});
  const std::string gap = "slice 8 of 20 is missing: step 2.00 mm where 1.00 mm is the rule, after z = 6.0 mm";
  CHECK(refusal(folder) == gap);
  write_series(folder, {.slice = {.number = 2, .series = "1.2"}, .count = 4, .prefix = "b"});
  const ReadScan out = read(folder);
  CHECK(out.scan.dims.z == 4);
  CHECK(out.report.series[0].error == gap);
  CHECK(told(out.report, "series 1 is 4.8 times as large as series 2, which was taken, but cannot be read: " + gap));
  CHECK(refusal(folder, of_series("1")) == "series 1: " + gap);
}

TEST_CASE("read_dicom: a series of two even stacks is refused with the names of both, and each can be read") {
  // Thin slices through the base of the skull, thick ones above; the slice between them belongs to both.
  const TemporaryFolder folder;
  for (int k = 0; k < 12; ++k) {
    const double z = k < 7 ? 2.5 * k : 15.0 + 5.0 * (k - 6);
    ct_slice({.position = {0, 0, z}, .number = 3, .instance = fmt::format("1.{}", k), .stored = [k](int, int) { return k; }})
        .write(folder.file(fmt::format("s{:02}", 11 - k)));
  }
  const std::string both =
      "it is two even stacks, name one of them (--series; series in a scene): 3:1 of 7 slices 2.5 mm apart, 3:2 of 6 "
      "slices 5 mm apart";
  CHECK(refusal(folder).find(both) != std::string::npos);
  const ReadScan low = read(folder, of_series("3:1")), high = read(folder, of_series("3:2"));
  REQUIRE(low.scan.dims.z == 7);
  REQUIRE(high.scan.dims.z == 6);
  for (std::size_t k = 0; k < 7; ++k) CHECK(low.scan.values[30 * k] == static_cast<float>(k) - 1024.0f);
  for (std::size_t k = 0; k < 6; ++k) CHECK(high.scan.values[30 * k] == static_cast<float>(k + 6) - 1024.0f);
  CHECK(high.scan.bone_from_index.offset.z == doctest::Approx(15e-3));
  // A whole series beside it is taken, and the halves are not.
  write_series(folder, {.slice = {.number = 8, .series = "8.8"}, .count = 4, .prefix = "t"});
  CHECK(read(folder).scan.dims.z == 4);
}

TEST_CASE("read_dicom: a series with two slices at each place has the first of each pair in one half, the second in the other") {
  const TemporaryFolder folder;
  // Names in the order of a folder's text, 1, 10, 11, ... 2, in which the halves are mixed.
  const auto write = [&](int n, const std::string& number) {
    ct_slice({.position = {0, 0, 1.0 * (n % 6)}, .instance = fmt::format("1.{}", n), .stored = [n](int, int) { return n < 6 ? 10 : 20; }})
        .text(0x00200013, "IS", number)
        .write(folder.file(fmt::format("IM{}", n + 1)));
  };
  for (int n = 0; n < 12; ++n) write(n, fmt::format("{}", n + 1));
  CHECK(refusal(folder).find("two slices at one place: 6 of 12 slices lie where another does") == 0);
  CHECK(refusal(folder).find("1:1 of 6 slices 1 mm apart, 1:2 of 6 slices 1 mm apart") != std::string::npos);
  CHECK(read(folder, of_series("1:1")).scan.values == std::vector<float>(180, -1014.0f));
  CHECK(read(folder, of_series("1:2")).scan.values == std::vector<float>(180, -1004.0f));
  // Numbers that do not separate them: no halves are offered.
  write(3, "11");
  CHECK(refusal(folder).find("1:1") == std::string::npos);
}

TEST_CASE("read_dicom: halves of a series have the size and the unit of their own slices") {
  for (const bool large_first : {true, false}) {
    const TemporaryFolder folder;
    for (int k = 0; k < 8; ++k) {
      const bool first = k < 4;
      const int edge = first == large_first ? 64 : 8;
      ct_slice({.columns = edge, .rows = edge, .position = {0, 0, first ? 1.0 * k : 2.0 * k - 3.0}, .instance = fmt::format("1.{}", k)})
          .text(0x00281054, "LO", first ? "HU" : "US")
          .write(folder.file(fmt::format("s{}", k)));
    }
    CAPTURE(large_first);
    const ReadScan low = read(folder, of_series("1:1")), high = read(folder, of_series("1:2"));
    CHECK(low.scan.dims == Vec3i(large_first ? 64 : 8, large_first ? 64 : 8, 4));
    CHECK(high.scan.dims == Vec3i(large_first ? 8 : 64, large_first ? 8 : 64, 4));
    CHECK(low.scan.values == std::vector<float>(low.scan.values.size(), 0.0f));
    CHECK(low.scan.quantity == Quantity::hounsfield);
    CHECK(high.scan.quantity == Quantity::other);
  }
}

TEST_CASE("read_dicom: one slice that is the best of several series is a question, and can be named") {
  const TemporaryFolder folder;
  ct_slice({.number = 1, .series = "1.1", .instance = "1.1.1"}).write(folder.file("one"));
  for (int n = 0; n < 3; ++n)
    ct_slice({.position = {0, 0, 1.0 * n}, .number = 2, .series = "1.2", .instance = fmt::format("1.2.{}", n)})
        .erase(0x00280030)
        .write(folder.file(fmt::format("m{}", n)));
  CHECK(refusal(folder) == "the best of 2 series, 1, has one slice; name the series to read (--series; series in a scene): 2, 1");
  CHECK(read(folder, of_series("1")).scan.dims.z == 1);
}

TEST_CASE("read_dicom: with a tilted gantry, distances of slices are those along the table") {
  const TemporaryFolder folder;
  // The table moves by 5 mm along z; slices lean by 20 degrees, so that they are 4.70 mm apart.
  const double c = std::cos(20.0 * kDegree), s = std::sin(20.0 * kDegree);
  for (int k = 0; k < 9; ++k)
    if (k != 4)
      ct_slice({.position = {0, 0, 5.0 * k}, .column = {0, c, s}, .instance = fmt::format("1.{}", k)})
          .write(folder.file(fmt::format("s{}", k)));
  CHECK(refusal(folder).find("step 10.00 mm where 5.00 mm is the rule, after z = 15.0 mm") != std::string::npos);
}

TEST_CASE("read_dicom: two different slices at one place are refused") {
  const TemporaryFolder folder;
  write_series(folder, {});
  ct_slice({.position = {0, 0, 2}, .instance = "7.7"}).write(folder.file("other"));
  CHECK(refusal(folder) == "two slices at one place: 1 of 5 slices lie where another does, the first at z = 2.0 mm");
}

TEST_CASE("read_dicom: slices that do not say where they lie are refused") {
  const TemporaryFolder folder;
  ct_slice({}).erase(0x00200032).write(folder.file("a"));
  CHECK(refusal(folder) == "1 of 1 slices lack position, orientation or pixel spacing");
  ct_slice({}).text(0x00200032, "DS", "1\\two\\3").write(folder.file("a"));
  CHECK(refusal(folder).find("lack position") != std::string::npos);
}

TEST_CASE("read_dicom: one slice is as thick as SliceThickness says, and that is reported") {
  const TemporaryFolder folder;
  ct_slice({.thickness = 5.0}).write(folder.file("a"));
  const auto out = read_dicom(folder.file("a"), {});
  REQUIRE(out.ok());
  CHECK(told(out->report, "one slice: thickness 5 mm from SliceThickness"));
  CHECK(std::abs(glm::length(out->scan.bone_from_index.linear[2]) - 5e-3) < 1e-12);
  ct_slice({}).erase(0x00180050).write(folder.file("a"));
  CHECK(refusal(folder.file("a")) == "there is one slice, and its thickness is unknown");
}

// A name in every text field of patient, study, equipment and series, and in fields where only codes belong.
TEST_CASE("read_dicom: nothing of patient or study reaches a report or an error unless it was asked for") {
  const TemporaryFolder folder;
  const std::string mark = "MARKED";
  const std::vector<std::uint32_t> fields = {0x00080020, 0x00080050, 0x00080080, 0x00080090, 0x00081030, 0x0008103e, 0x00081070,
                                             0x00100010, 0x00100020, 0x00100030, 0x00100040, 0x00101040, 0x00104000, 0x0020000d,
                                             0x0020000e, 0x00200010, 0x00200011, 0x00200052, 0x00204000, 0x00080018, 0x00080060};
  std::vector<std::string> texts;
  const auto gather = [&](const Result<ReadScan>& out) {
    if (!out) return texts.push_back(out.error().text());
    const ScanReport& r = out->report;
    for (const auto& s : r.series) texts.insert(texts.end(), {s.name, s.modality, s.direction, s.error});
    for (const auto& s : r.skipped) texts.push_back(s.reason);
    for (const auto& k : r.kept) texts.push_back(k.value);
    texts.insert(texts.end(), r.assumed.begin(), r.assumed.end());
  };
  const auto marked = [&](const CtSlice& slice) {
    DicomData data = ct_slice(slice);
    for (const std::uint32_t tag : fields) data.text(tag, "LO", mark + (tag == 0x00080018 ? slice.instance : ""));
    return data;
  };
  const auto found = [&] {
    return std::count_if(texts.begin(), texts.end(), [&](const std::string& t) { return t.find(mark) != std::string::npos; });
  };

  marked({}).write(folder.file("0"));
  marked({.position = {0, 0, 1}, .instance = "2"}).write(folder.file("1"));
  gather(read_dicom(folder.path().string(), {}));
  gather(read_dicom(folder.path().string(), of_series("4")));
  marked({.position = {0, 0, 3}, .instance = "3"}).write(folder.file("2"));
  gather(read_dicom(folder.path().string(), {}));
  for (const char* syntax : {"MARKED", "1.2.840.10008.1.2.4.100"}) {
    marked({.position = {0, 0, 2}, .instance = "4"}).write(folder.file("3"), syntax);
    gather(read_dicom(folder.path().string(), {}));
  }
  const std::string whole = marked({}).file();
  for (std::size_t n = 132; n < whole.size(); n += 7) {
    write_bytes(folder.file("cut"), whole.substr(0, n));
    gather(read_dicom(folder.file("cut"), {}));
  }
  CHECK(texts.size() > 100);
  CHECK(found() == 0);
  // Sabotage twin: the search does find what was asked for.
  gather(read_dicom(folder.file("0"), keeping({"PatientID"})));
  CHECK(found() == 1);
}

TEST_CASE("read_dicom: keep copies the named fields, reports absent ones and refuses words that are no keyword") {
  const TemporaryFolder folder;
  ct_slice({}).text(0x00100020, "LO", "P-17").text(0x00181210, "SH", "YA\nx").write(folder.file("a"));
  const auto out = read_dicom(folder.file("a"), keeping({"PatientID", "ConvolutionKernel", "PatientName", "Rows"}));
  REQUIRE(out.ok());
  REQUIRE(out->report.kept.size() == 4);
  CHECK(out->report.kept[0].name == "PatientID");
  CHECK(out->report.kept[0].value == "P-17");
  CHECK(out->report.kept[1].value == "YA\\nx");
  CHECK(out->report.kept[2].value == "(absent)");
  CHECK(out->report.kept[3].value == "5");
  const auto message = [&](const char* word) { return read_dicom(folder.file("a"), keeping({word})).error().message; };
  CHECK(message("PatientId2") == "'PatientId2' is not a DICOM keyword; did you mean PatientID?");
  CHECK(message("qqqqqqqq") == "'qqqqqqqq' is not a DICOM keyword");
  CHECK(message("PixelData") == "DICOM field PixelData holds no text that could be kept");
}

TEST_CASE("read_dicom: one UID on all slices is no reason to lose slices") {
  const TemporaryFolder folder;
  for (int k = 0; k < 4; ++k) {
    CtSlice slice;
    slice.position = Vec3(0, 0, k);
    slice.instance = "1.2.3.1";
    ct_slice(slice).write(folder.file("s" + std::to_string(k)));
  }
  CHECK(read(folder).scan.dims.z == 4);
}

TEST_CASE("read_dicom: a CT is taken before a larger series of another modality") {
  const TemporaryFolder folder;
  for (int k = 0; k < 7; ++k) {
    CtSlice slice;
    slice.position = Vec3(0, 0, k);
    slice.series = k < 3 ? "1.2.3" : "1.2.4";
    slice.number = k < 3 ? 1 : 2;
    slice.instance = "1.2.3." + std::to_string(k);
    ct_slice(slice).text(0x00080060, "CS", k < 3 ? "CT" : "MR").write(folder.file("s" + std::to_string(k)));
  }
  const ReadScan out = read(folder);
  CHECK(out.scan.quantity == Quantity::hounsfield);
  CHECK(out.scan.dims.z == 3);
  CHECK(out.report.series.size() == 2);
}
