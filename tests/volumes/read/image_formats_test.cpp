#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "core/base/units.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/scan_geometry.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kSamePlace = 1e-9;  // [m] asked for; a thousandth of what a micrometre is to a burr hole

using Reader = std::function<Result<ReadScan>(const std::string&, const ReadOptions&)>;

/// One way of writing the small volume: what to read, with which reader.
struct Written {
  std::string name, path;
  Reader read;
};

double apart(const Affine& a, const Affine& b_mm) {
  double farthest = glm::length(a.offset - b_mm.offset * kMillimetre);
  for (std::size_t n = 0; n < 3; ++n) farthest = std::max(farthest, glm::length(a.linear[n] - b_mm.linear[n] * kMillimetre));
  return farthest;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string decimal(const std::vector<std::int16_t>& values) {
  std::string out;
  for (const std::int16_t value : values) out += fmt::format("{}\n", value);
  return out;
}

/// A file a slice, "NAME<number>ENDING" from `first` on.
void write_slices(const TemporaryFolder& folder, const std::string& name, const std::string& ending, int first, const std::string& bytes) {
  const std::size_t share = bytes.size() / 4;
  for (int n = 0; n < 4; ++n)
    write_bytes(folder.file(fmt::format("{}{}{}", name, first + n, ending)), bytes.substr(static_cast<std::size_t>(n) * share, share));
}

void write_niftis(const TemporaryFolder& folder, const SmallVolume& v, std::vector<Written>& out) {
  for (const int version : {1, 2})
    for (const bool big : {false, true}) {
      const std::string one = nifti_header(v, {.version = version, .big = big}) + stored<std::int16_t>(v.values, big);
      const std::string tag = fmt::format("{}{}", version, big ? "big" : "little");
      write_bytes(folder.file(tag + ".nii"), one);
      write_bytes(folder.file(tag + ".nii.gz"), gzip(one));
      write_bytes(folder.file(tag + "pair.hdr"), nifti_header(v, {.version = version, .big = big, .pair = true}));
      write_bytes(folder.file(tag + "pair.img"), stored<std::int16_t>(v.values, big));
      for (const char* const ending : {".nii", ".nii.gz", "pair.hdr", "pair.img"})
        out.push_back({"NIfTI " + tag + ending, folder.file(tag + ending), read_nifti});
    }
  const std::string wide = nifti_header(v, {.datatype = 64, .bitpix = 64}) + stored<double>(v.values, false);
  write_bytes(folder.file("double.nii"), wide);
  out.push_back({"NIfTI double", folder.file("double.nii"), read_nifti});
  const std::string members = gzip(wide.substr(0, 500)) + gzip(wide.substr(500));
  write_bytes(folder.file("members.nii.gz"), members);
  out.push_back({"NIfTI in two gzip members", folder.file("members.nii.gz"), read_nifti});
}

void write_nrrds(const TemporaryFolder& folder, const SmallVolume& v, std::vector<Written>& out) {
  const auto add = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.file(name), bytes);
    out.push_back({"NRRD " + name, folder.file(name), read_nrrd});
  };
  const std::string little = stored<std::int16_t>(v.values, false), big = stored<std::int16_t>(v.values, true);
  add("little.nrrd", nrrd_header(v, "short", "little", "raw") + "\n" + little);
  add("big.nrrd", nrrd_header(v, "int16", "big", "raw") + "\n" + big);
  add("gz.nrrd", nrrd_header(v, "short", "big", "gzip") + "\n" + gzip(big));
  add("gzskip.nrrd", nrrd_header(v, "short", "big", "gzip") + "byte skip: 3\n\n" + gzip("abc" + big));
  add("text.nrrd", nrrd_header(v, "short", "little", "ascii") + "\n" + decimal(v.values));
  write_bytes(folder.file("detached.raw"), "two\nlines\nxyz" + little);
  add("detached.nhdr", nrrd_header(v, "short", "little", "raw") + "line skip: 2\nbyte skip: 3\ndata file: detached.raw\n");
  add("end.nhdr", nrrd_header(v, "short", "little", "raw") + "byte skip: -1\ndata file: detached.raw\n");
  write_slices(folder, "n", ".raw", 8, little);
  add("numbered.nhdr", nrrd_header(v, "short", "little", "raw") + "data file: n%d.raw 8 11 1\n");
  add("list.nhdr", nrrd_header(v, "short", "little", "raw") + "data file: LIST\nn8.raw\nn9.raw\nn10.raw\nn11.raw\n");
}

void write_metas(const TemporaryFolder& folder, const SmallVolume& v, std::vector<Written>& out) {
  const auto add = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.file(name), bytes);
    out.push_back({"MetaImage " + name, folder.file(name), read_metaimage});
  };
  const std::string little = stored<std::int16_t>(v.values, false), big = stored<std::int16_t>(v.values, true);
  add("little.mha", meta_header(v, "MET_SHORT", false, false, "LOCAL") + little);
  add("big.mha", meta_header(v, "MET_SHORT", true, false, "LOCAL") + big);
  add("packed.mha", meta_header(v, "MET_SHORT", true, true, "LOCAL") + zlib_packed(big));
  add("float.mha", meta_header(v, "MET_FLOAT", false, false, "LOCAL") + stored<float>(v.values, false));
  write_bytes(folder.file("meta.raw"), "skipped" + little);
  add("separate.mhd", "HeaderSize = 7\n" + meta_header(v, "MET_SHORT", false, false, "meta.raw"));
  add("end.mhd", "HeaderSize = -1\n" + meta_header(v, "MET_SHORT", false, false, "meta.raw"));
  write_slices(folder, "m", ".raw", 8, little);
  add("numbered.mhd", meta_header(v, "MET_SHORT", false, false, "m%d.raw 8 11 1"));
  add("list.mhd", meta_header(v, "MET_SHORT", false, false, "LIST\nm8.raw\nm9.raw\nm10.raw\nm11.raw"));
}

void write_raws(const TemporaryFolder& folder, const SmallVolume& v, std::vector<Written>& out) {
  const auto add = [&](const std::string& name, const std::string& text) {
    write_bytes(folder.file(name), text);
    out.push_back({"raw " + name, folder.file(name), read_raw});
  };
  write_bytes(folder.file("volume.bin"), "head" + stored<std::int16_t>(v.values, true));
  add("one.toml", raw_sidecar(v, "big", "data = \"volume.bin\"\noffset_bytes = 4"));
  // numeric order differs from the order of the names: 8, 9, 10, 11
  std::filesystem::create_directory(folder.file("slices"));
  write_slices(folder, "slices/CT.", "", 8, stored<std::int16_t>(v.values, false));
  write_bytes(folder.file("slices/CT.info"), "not a slice");
  add("many.toml", raw_sidecar(v, "little", "folder = \"slices\"\nfiles = \"CT.*\""));
  ::setenv("BURRHOLE_TEST_SLICES", folder.file("slices").c_str(), 1);
  add("variable.toml", raw_sidecar(v, "little", "folder = \"$BURRHOLE_TEST_SLICES\"\nfiles = \"CT.*\""));
}

std::vector<Written> write_all(const TemporaryFolder& folder) {
  const SmallVolume volume = small_volume();
  std::vector<Written> out;
  write_niftis(folder, volume, out);
  write_nrrds(folder, volume, out);
  write_metas(folder, volume, out);
  write_raws(folder, volume, out);
  return out;
}

std::string fault_of(const Result<ReadScan>& read) {
  REQUIRE_FALSE(read.ok());
  CHECK(read.error().code == ErrorCode::bad_input);
  CHECK_FALSE(read.error().place.empty());
  CHECK(read.error().text().find('\n') == std::string::npos);
  return read.error().text();
}

}  // namespace

TEST_CASE("readers: one volume in every format reads equal, voxel for voxel, at the same place") {
  const TemporaryFolder folder;
  const SmallVolume volume = small_volume();
  const std::vector<float> expected(volume.values.begin(), volume.values.end());
  for (const Written& file : write_all(folder)) {
    INFO(file.name);
    const auto read = file.read(file.path, {});
    if (!read) FAIL_CHECK(read.error().text());
    if (!read) continue;
    CHECK(read.value().scan.dims == volume.dims);
    CHECK(read.value().scan.values == expected);
    CHECK(apart(read.value().scan.bone_from_index, volume.lps_mm) < kSamePlace);
    CHECK(read.value().scan.quantity == Quantity::unknown);
    CHECK_FALSE(read.value().report.format.empty());
    CHECK(read.value().report.assumed.empty());
  }
}

TEST_CASE("readers: a wrong byte order or a swapped slice order does not read equal, so the check above can fail") {
  const TemporaryFolder folder;
  const SmallVolume volume = small_volume();
  const std::vector<float> expected(volume.values.begin(), volume.values.end());
  write_bytes(folder.file("lie.nrrd"), nrrd_header(volume, "short", "big", "raw") + "\n" + stored<std::int16_t>(volume.values, false));
  CHECK(read_nrrd(folder.file("lie.nrrd"), {})->scan.values != expected);
  write_slices(folder, "n", ".raw", 8, stored<std::int16_t>(volume.values, false));
  write_bytes(folder.file("text_order.nhdr"),
              nrrd_header(volume, "short", "little", "raw") + "data file: LIST\nn10.raw\nn11.raw\nn8.raw\nn9.raw\n");
  CHECK(read_nrrd(folder.file("text_order.nhdr"), {})->scan.values != expected);
}

TEST_CASE("read_nifti: scaling is applied once, for floats and whole numbers, with and without orientation") {
  const TemporaryFolder folder;
  const SmallVolume volume = small_volume();
  for (const int sform : {0, 1})
    for (const bool wide : {false, true}) {
      const std::int16_t datatype = wide ? 16 : 4, bits = wide ? 32 : 16;
      const NiftiWrite how{.datatype = datatype, .bitpix = bits, .sform = sform, .slope = 2.5, .intercept = -7.0};
      const std::string voxels = wide ? stored<float>(volume.values, false) : stored<std::int16_t>(volume.values, false);
      write_bytes(folder.file("s.nii"), nifti_header(volume, how) + voxels);
      const auto read = read_nifti(folder.file("s.nii"), {});
      REQUIRE(read.ok());
      for (std::size_t n = 0; n < volume.values.size(); ++n) REQUIRE(read.value().scan.values[n] == 2.5f * volume.values[n] - 7.0f);
    }
}

TEST_CASE("read_nifti: a marker in a sheared scan lies where the sform puts it, and spacing and direction alone would miss") {
  const TemporaryFolder folder;
  SmallVolume volume = small_volume();
  volume.dims = Vec3i(24, 20, 16);
  volume.values.assign(24 * 20 * 16, 0);
  const Vec3i marker(21, 3, 14);
  volume.values[VoxelBox{Vec3i(0), volume.dims}.offset_of(marker)] = 1000;
  write_bytes(folder.file("shear.nii"), nifti_header(volume, {}) + stored<std::int16_t>(volume.values, false));
  const auto read = read_nifti(folder.file("shear.nii"), {});
  REQUIRE(read.ok());
  const Scan& scan = read.value().scan;
  Vec3i found(-1);
  for_each_voxel(VoxelBox{Vec3i(0), scan.dims}, [&](const Vec3i& v) {
    if (scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of(v)] == 1000.0f) found = v;
  });
  CHECK(found == marker);
  // by hand, LPS mm: -12.5 + 21 * 0.5 - 3 * 0.25, 30.25 + 21 * 0.125 + 3 * 0.75 + 14 * 0.3125, 8.125 + 3 * 0.0625 + 14 * 1.25
  const Vec3 truth = Vec3(-2.75, 39.5, 25.8125) * kMillimetre;
  const double miss = glm::length(scan.bone_from_index * Vec3(found) - truth);
  CHECK(miss < 1e-6 * kMillimetre);  // what is left are roundings of doubles under 0.1 m
  // Sabotage: the nearest that spacing and a rotation can say of this scan, as software without shear keeps it.
  const GridShape shape = describe_grid(scan.bone_from_index);
  Mat3 straight;
  straight[0] = shape.direction[0];
  straight[1] = glm::normalize(shape.direction[1] - straight[0] * glm::dot(straight[0], shape.direction[1]));
  straight[2] = glm::cross(straight[0], straight[1]);
  Affine unsheared = scan.bone_from_index;
  for (std::size_t n = 0; n < 3; ++n) unsheared.linear[n] = straight[n] * shape.spacing[n];
  CHECK(glm::length(unsheared * Vec3(found) - truth) > 0.1 * kMillimetre);
}

TEST_CASE("readers: a file cut short anywhere is refused with the numbers") {
  const TemporaryFolder folder;
  int shortened = 0;
  for (const Written& file : write_all(folder)) {
    if (file.path.ends_with(".toml") || file.path.ends_with("hdr") || file.path.ends_with(".mhd")) continue;  // voxels lie elsewhere
    const std::string whole = read_bytes(file.path);
    const bool text = file.path.ends_with("text.nrrd");
    ++shortened;
    for (std::size_t n = 0; n < 20; ++n) {
      const std::size_t kept = whole.size() * n / 20;
      INFO(file.name, " cut to ", kept, " of ", whole.size());
      write_bytes(file.path, whole.substr(0, kept));
      fault_of(file.read(file.path, {}));
    }
    write_bytes(file.path, whole.substr(0, whole.size() - (text ? 6 : 1)));
    const std::string error = fault_of(file.read(file.path, {}));
    INFO(error);
    CHECK((holds(error, "ends after") || holds(error, "cut short")));
    write_bytes(file.path, whole);
    CHECK(file.read(file.path, {}).ok());
  }
  CHECK(shortened > 0);
}

TEST_CASE("readers: a damaged compressed file is refused, its checksum included") {
  const TemporaryFolder folder;
  const SmallVolume volume = small_volume();
  const std::string whole = gzip(nifti_header(volume, {}) + stored<std::int16_t>(volume.values, false));
  for (const std::size_t at : {whole.size() / 2, whole.size() - 6}) {  // the data, the checksum
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x55);
    write_bytes(folder.file("d.nii.gz"), bytes);
    fault_of(read_nifti(folder.file("d.nii.gz"), {}));
  }
}

TEST_CASE("readers: a small file that claims a huge volume is refused before anything is allocated") {
  const TemporaryFolder folder;
  SmallVolume volume = small_volume();
  volume.dims = Vec3i(1024, 1024, 2048);  // the most that is read: 8 GiB of floats
  const std::string voxels = stored<std::int16_t>(volume.values, false);
  write_bytes(folder.file("a.nii"), nifti_header(volume, {}) + voxels);
  CHECK(holds(fault_of(read_nifti(folder.file("a.nii"), {})), "data ends after 280 of 4294967296 bytes"));
  write_bytes(folder.file("a.nii.gz"), gzip(nifti_header(volume, {}) + voxels));
  CHECK(holds(fault_of(read_nifti(folder.file("a.nii.gz"), {})), "cannot hold 4294967296 bytes"));
  // zeros pack a thousandfold: past the first estimate, so the count of the unpacked bytes must tell
  write_bytes(folder.file("z.mha"),
              meta_header(volume, "MET_UCHAR", false, true, "LOCAL") + zlib_packed(voxels) + std::string(4 << 20, 'x'));
  CHECK(holds(fault_of(read_metaimage(folder.file("z.mha"), {})), "data ends after 280 of 2147483648 bytes"));
  write_bytes(folder.file("t.nrrd"), nrrd_header(volume, "short", "little", "ascii") + "\n1 2 3\n");
  CHECK(holds(fault_of(read_nrrd(folder.file("t.nrrd"), {})), "cannot hold 2147483648 numbers"));
  volume.dims.z += 1;
  write_bytes(folder.file("b.mha"), meta_header(volume, "MET_SHORT", false, false, "LOCAL"));
  CHECK(holds(fault_of(read_metaimage(folder.file("b.mha"), {})), "more than the 2147483648"));
}

TEST_CASE("readers: what is missing or is no file is reported") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  CHECK(holds(fault_of(read_nifti(folder.file("none.nii"), {})), "no such file"));
  CHECK(holds(fault_of(read_nrrd(folder.path().string(), {})), "not a regular file"));
  CHECK(holds(fault_of(read_nrrd("/dev/zero", {})), "not a regular file"));
  write_bytes(folder.file("p.hdr"), nifti_header(v, {.pair = true}));
  CHECK(holds(fault_of(read_nifti(folder.file("p.hdr"), {})), ".img"));
  write_bytes(folder.file("d.nhdr"), nrrd_header(v, "short", "little", "raw") + "data file: d.raw\n");
  CHECK(holds(fault_of(read_nrrd(folder.file("d.nhdr"), {})), "data file 1 of 1 is missing"));
  write_bytes(folder.file("many.mhd"), meta_header(v, "MET_SHORT", false, false, "m%d.raw 1 900000000 1"));
  CHECK(holds(fault_of(read_metaimage(folder.file("many.mhd"), {})), "900000000 data files for 4 slices"));
  write_bytes(folder.file("text.nrrd"), nrrd_header(v, "short", "little", "ascii") + "\n" + decimal(v.values).replace(20, 1, "x"));
  CHECK(holds(fault_of(read_nrrd(folder.file("text.nrrd"), {})), "is not a number"));
}

TEST_CASE("read_raw: lengths and counts that do not fit are refused with the numbers") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  const std::string voxels = stored<std::int16_t>(v.values, true);
  const auto fault = [&](const std::string& more) {
    write_bytes(folder.file("v.toml"), raw_sidecar(v, "big", more));
    return fault_of(read_raw(folder.file("v.toml"), {}));
  };
  write_bytes(folder.file("short.bin"), voxels.substr(0, 100));
  CHECK(holds(fault("data = \"short.bin\""), "data ends after 100 of 280 bytes"));
  write_bytes(folder.file("long.bin"), voxels + "12345");
  CHECK(holds(fault("data = \"long.bin\""), "holds 285 bytes, 5 more"));
  CHECK(holds(fault("data = \"none.bin\""), "no such file"));
  CHECK(
      holds(fault("data = \"$BURRHOLE_NOT_SET_ANYWHERE/x\""), "v.toml:7:1: the environment variable BURRHOLE_NOT_SET_ANYWHERE is not set"));
  write_slices(folder, "s", ".raw", 1, voxels);
  CHECK(read_raw((write_bytes(folder.file("v.toml"), raw_sidecar(v, "big", "files = \"s*.raw\"")), folder.file("v.toml")), {}).ok());
  CHECK(holds(fault("files = \"x*.raw\""), "0 files fit x*.raw, dims say 4 slices"));
  CHECK(holds(fault("folder = \"nowhere\"\nfiles = \"x*.raw\""), "cannot be read"));
  write_bytes(folder.file("s5.raw"), voxels.substr(0, 70));
  CHECK(holds(fault("files = \"s*.raw\""), "5 files fit s*.raw, dims say 4 slices"));
  std::filesystem::remove(folder.file("s3.raw"));
  CHECK(holds(fault("files = \"s*.raw\""), "numbers go from 2 to 4"));
  write_bytes(folder.file("s05.raw"), voxels.substr(0, 70));
  CHECK_FALSE(fault("files = \"s*.raw\"").empty());
}

TEST_CASE("readers: bytes behind the voxels are reported") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  write_bytes(folder.file("more.nii"), nifti_header(v, {}) + stored<std::int16_t>(v.values, false) + "tail");
  const auto read = read_nifti(folder.file("more.nii"), {});
  REQUIRE(read.ok());
  REQUIRE(read.value().report.assumed.size() == 1);
  CHECK(holds(read.value().report.assumed[0], "continues"));
}

TEST_CASE("readers: nothing that can name a patient reaches the report or a message") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  const std::string secret = "DoeJane1970";
  std::string nifti = nifti_header(v, {});
  for (const std::size_t at : {14, 148, 228, 328}) nifti.replace(at, secret.size(), secret);  // db_name, descrip, aux_file, intent_name
  const std::string keys = "content: " + secret + "\nlabels: \"" + secret + "\" \"\" \"\"\n# " + secret + "\nname:=" + secret + "\n";
  const std::string meta = "Name = " + secret + "\nID = " + secret + "\nComment = " + secret + "\nPatient = " + secret + "\n";
  const std::string voxels = stored<std::int16_t>(v.values, false);
  const std::vector<std::pair<Reader, std::string>> files = {
      {read_nifti, nifti + voxels},
      {read_nifti, nifti + "short"},
      {read_nrrd, nrrd_header(v, "short", "little", "raw") + keys + "\n" + voxels},
      {read_nrrd, nrrd_header(v, "short", "little", "raw") + keys + "\n"},
      {read_nrrd, nrrd_header(v, secret, "little", "raw") + keys + "\n"},
      {read_nrrd, nrrd_header(v, "short", "little", "raw") + secret + ": 1\n\n"},
      {read_nrrd, nrrd_header(v, "short", "little", "raw") + secret + "\n\n"},
      {read_metaimage, meta + meta_header(v, "MET_SHORT", false, false, "LOCAL") + voxels},
      {read_metaimage, meta + meta_header(v, "MET_SHORT", false, false, "LOCAL")},
      {read_metaimage, meta + meta_header(v, secret, false, false, "LOCAL")},
      {read_metaimage, secret + "\n" + meta_header(v, "MET_SHORT", false, false, "LOCAL")},
  };
  for (std::size_t n = 0; n < files.size(); ++n) {
    INFO("file ", n);
    write_bytes(folder.file("f"), files[n].second);
    const auto read = files[n].first(folder.file("f"), {});
    if (!read) {
      CHECK_FALSE(holds(read.error().text(), secret));
      continue;
    }
    const ScanReport& report = read.value().report;
    CHECK(report.kept.empty());
    CHECK(report.series.empty());
    CHECK_FALSE(holds(report.format, secret));
    for (const std::string& line : report.assumed) CHECK_FALSE(holds(line, secret));
  }
}

TEST_CASE("readers: NaN and infinite voxels are left as they are") {
  const TemporaryFolder folder;
  SmallVolume v = small_volume();
  std::string voxels = stored<float>(v.values, false);
  set(voxels, 8, std::nanf(""), false);
  write_bytes(folder.file("n.nrrd"), nrrd_header(v, "float", "little", "raw") + "\n" + voxels);
  const auto read = read_nrrd(folder.file("n.nrrd"), {});
  REQUIRE(read.ok());
  CHECK(std::isnan(read.value().scan.values[2]));
}

TEST_CASE("readers: progress rises to 1") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  write_bytes(folder.file("p.nii"), nifti_header(v, {}) + stored<std::int16_t>(v.values, false));
  double last = 0.0;
  ReadOptions options;
  options.progress = [&](double share) {
    CHECK(share >= last);
    last = share;
  };
  CHECK(read_nifti(folder.file("p.nii"), options).ok());
  CHECK(last == 1.0);

  std::stop_source source;
  source.request_stop();
  options.stop = source.get_token();
  options.progress = [](double) { FAIL("a reading that shall stop goes on"); };
  const auto stopped = read_nifti(folder.file("p.nii"), options);
  REQUIRE_FALSE(stopped.ok());
  CHECK(stopped.error().code == ErrorCode::unavailable);
}
