#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/base/units.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/scan_geometry.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Figures of data/README.md.
struct Figures {
  std::string file;
  Vec3i dims{0};
  Vec3 spacing_mm{0.0};
  float lowest = 0, highest = 0;
};

// README's spacings have four decimals [mm].
constexpr double kReadmeDigits = 0.5e-4;

void check_figures(const Result<ReadScan>& read, const Figures& figures) {
  INFO(figures.file);
  if (!read) FAIL(read.error().text());
  const Scan& scan = read.value().scan;
  CHECK(scan.dims == figures.dims);
  const GridShape shape = describe_grid(scan.bone_from_index);
  for (std::size_t n = 0; n < 3; ++n) CHECK(std::abs(shape.spacing[n] / kMillimetre - figures.spacing_mm[n]) < kReadmeDigits);
  const auto [lowest, highest] = std::minmax_element(scan.values.begin(), scan.values.end());
  CHECK(*lowest == figures.lowest);
  CHECK(*highest == figures.highest);
  for (const std::string& line : read.value().report.assumed) MESSAGE(figures.file, " assumed: ", line);
}

}  // namespace

TEST_CASE("read_nifti: real scans have the published figures") {
  const std::string data = real_data().string();
  for (const Figures& figures : {Figures{"/nifti/CT_pitch.nii.gz", {175, 248, 58}, {0.8125, 0.8125, 2.397}, 0, 255},
                                 Figures{"/nifti/example_ct.nii.gz", {122, 101, 112}, {3, 3, 3}, -1207, 3382},
                                 Figures{"/nifti/example_ct_sm.nii.gz", {122, 101, 30}, {3, 3, 3}, -1100, 1207}})
    check_figures(read_nifti(data + figures.file, {}), figures);
  // axes R, A, S: i to the right is -x in LPS, j to the front -y, k up +z
  const Affine affine = read_nifti(data + "/nifti/example_ct.nii.gz", {})->scan.bone_from_index;
  CHECK(affine.linear[0].x < 0.0);
  CHECK(affine.linear[1].y < 0.0);
  CHECK(affine.linear[2].z > 0.0);
}

TEST_CASE("read_nrrd: real scans have the published figures, and one ball is the same in every form") {
  const std::string data = real_data().string();
  check_figures(read_nrrd(data + "/nrrd/FLAIR.nrrd", {}), {"/nrrd/FLAIR.nrrd", {124, 160, 140}, {1, 1, 1}, 0, 255});
  const std::string ball = "/nrrd/BallBinary30x30x30";
  for (const char* const ending : {".nrrd", "_gz.nrrd", ".nhdr"})
    check_figures(read_nrrd(data + ball + ending, {}), {ball + ending, {30, 30, 30}, {1, 1, 1}, 0, 257});
  const std::vector<float> plain = read_nrrd(data + ball + ".nrrd", {})->scan.values;
  CHECK(read_nrrd(data + ball + "_gz.nrrd", {})->scan.values == plain);
  CHECK(read_nrrd(data + ball + ".nhdr", {})->scan.values == plain);
  const auto packed = read_nrrd(data + ball + "_bz2.nrrd", {});
  REQUIRE_FALSE(packed.ok());
  CHECK(packed.error().message == "encoding bzip2 is not read: save it again with encoding gzip or raw");
}

TEST_CASE("read_metaimage: real scans have the published figures") {
  const std::string data = real_data().string();
  check_figures(read_metaimage(data + "/metaimage/mha.mha", {}), {"/metaimage/mha.mha", {64, 64, 37}, {3.4375, 3.4375, 3.8}, 0, 6690});
  check_figures(read_metaimage(data + "/head_ct_mha/head.mha", {}), {"/head_ct_mha/head.mha", {64, 64, 93}, {3.2, 3.2, 1.5}, 0, 3926});
  // the matrix of mha.mha turns the second axis
  CHECK(read_metaimage(data + "/metaimage/mha.mha", {})->scan.bone_from_index.linear[1].y < 0.0);
}

TEST_CASE("read_raw: the head in 113 files has the published figures, slices in numeric order") {
  const std::string data = real_data().string();
  const TemporaryFolder folder;
  const auto sidecar = [&](const std::string& order) {
    write_bytes(
        folder.file("head.toml"),
        fmt::format("folder = \"$BURRHOLE_DATA/head_ct_raw_big_endian\"\nfiles = \"CThead.*\"\ndims = [256, 256, 113]\ntype = \"int16\"\n"
                    "byte_order = \"{}\"\nspacing_mm = [1.0, 1.0, 2.0]\nassumed = \"spacing: only its ratio 1:1:2 is known\"\n",
                    order));
    return folder.file("head.toml");
  };
  const auto head = read_raw(sidecar("big"), {});
  check_figures(head, {"head_ct_raw_big_endian", {256, 256, 113}, {1, 1, 2}, 0, 3272});
  // Neighbouring slices of a head are alike: the mean step between slices is least in the true order. As text, CThead.10 follows CThead.1.
  const auto step = [&](int from, int to) {
    const std::size_t slice = 256 * 256;
    double sum = 0.0;
    for (std::size_t n = 0; n < slice; ++n)
      sum += std::abs(head.value().scan.values[static_cast<std::size_t>(from) * slice + n] -
                      head.value().scan.values[static_cast<std::size_t>(to) * slice + n]);
    return sum;
  };
  CHECK(step(1, 2) < step(1, 10));
  CHECK(step(98, 99) < step(98, 9));
  // Sabotage: the other byte order leaves the published range.
  const auto swapped = read_raw(sidecar("little"), {});
  REQUIRE(swapped.ok());
  CHECK(*std::max_element(swapped.value().scan.values.begin(), swapped.value().scan.values.end()) != 3272.0f);
}
