// Every file of the developers' data set: imported, or refused for the right reason. One row a file; a file without a row fails.
#include <doctest/doctest.h>

#include <filesystem>
#include <set>

#include "app/scene/volume_scene.h"
#include "tests/support/real_data.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"
#include "volumes/import_bone.h"

using namespace burrhole;

namespace {

namespace fs = std::filesystem;

struct Row {
  std::string path;    ///< relative to the data set
  std::string needle;  ///< of the refusal; empty: imported
  Vec3i dims{0};       ///< as scanned
  std::string unit = {};
  std::array<double, 2> band{0.0, 0.0};  ///< when not 0, 0
};

/// Grids of .vdb files have two voxels of nothing added on each side.
const std::vector<Row>& rows() {
  static const std::string kNotHu = "not Hounsfield units";
  static const std::vector<Row> table{
      {"head_ct_mha/head.mha", "", {64, 64, 93}},
      {"head_ct_raw_big_endian", "DICOM", {}},  // no header: a sidecar is needed
      {"head_ct_raw_big_endian/CThead.1", "supported format", {}},
      {"head_ct_dicom_phantom_1mm", "", {512, 512, 48}},
      {"head_ct_dicom_phantom_1mm/I1000", "", {512, 512, 1}},
      {"nifti/CT_pitch.nii.gz", kNotHu, {}},
      {"nifti/CT_pitch.nii.gz", "", {175, 248, 58}, "", {180, 220}},
      {"nifti/example_ct.nii.gz", "", {122, 101, 112}},
      {"nifti/example_ct_sm.nii.gz", "", {122, 101, 30}},
      {"dicom_multiframe/emri_small.dcm", "multi-frame image that is not a volume", {}},
      {"dicom_multiframe/emri_small_jpeg_ls_lossless.dcm", "multi-frame image that is not a volume", {}},
      {"dicom_multiframe/emri_small_RLE.dcm", "multi-frame image that is not a volume", {}},
      {"nrrd/FLAIR.nrrd", kNotHu, {}},
      {"nrrd/BallBinary30x30x30.nrrd", kNotHu, {}},
      {"nrrd/BallBinary30x30x30.nrrd", "", {30, 30, 30}, "", {100, 150}},
      {"nrrd/BallBinary30x30x30_gz.nrrd", "", {30, 30, 30}, "", {100, 150}},
      {"nrrd/BallBinary30x30x30.nhdr", "", {30, 30, 30}, "", {100, 150}},
      {"nrrd/BallBinary30x30x30_bz2.nrrd", "bzip2", {}, "", {100, 150}},
      {"nrrd/BallBinary30x30x30.raw", "supported format", {}},
      {"metaimage/mha.mha", kNotHu, {}},
      {"meshes/skull.obj", "unit", {}},
      {"meshes/skull.obj", "", {}, "cm"},
      {"meshes/footbones.ply", "", {}, "in"},
      {"meshes/apple.stl", "", {}, "m"},
      {"vdb/sphere.vdb", "unit", {}},
      {"vdb/sphere.vdb", "", {29, 29, 29}, "mm"},
      {"vdb/torus01.vdb", "", {26, 13, 26}, "mm"},
  };
  return table;
}

ImportRequest request_of(const fs::path& data, const Row& row) {
  ImportRequest request{(data / row.path).string(), {}, {}};
  if (!row.unit.empty()) request.read.unit = length_unit(row.unit);
  if (row.band[1] > row.band[0]) request.bone.band = row.band;
  return request;
}

/// Texts that go with the data, and what a row of the whole folder stands for.
bool needs_no_row(const fs::path& path) {
  const std::string name = path.filename().string(), folder = path.parent_path().filename().string();
  return name == "README.md" || name == "SHA256SUMS" || name == "skull-README.md" || folder == "licences" ||
         folder == "head_ct_raw_big_endian" || folder == "head_ct_dicom_phantom_1mm" || folder == "dicom_transfer_syntaxes";
}

}  // namespace

TEST_CASE("data: every file is imported or refused for the right reason") {
  const fs::path data = real_data();
  for (const Row& row : rows()) {
    CAPTURE(row.path);
    const auto imported = import_bone(request_of(data, row), {});
    if (row.needle.empty()) {
      CHECK_MESSAGE(imported.ok(), (imported.ok() ? std::string() : imported.error().text()));
      if (!imported) continue;
      CHECK(imported->report.bone_voxels > 0);
      if (row.dims.x > 0) CHECK(imported->report.dims == row.dims);
      CHECK_FALSE(imported->report.scan.format.empty());
    } else {
      REQUIRE_FALSE(imported.ok());
      CHECK_MESSAGE(imported.error().message.find(row.needle) != std::string::npos, imported.error().text());
      CHECK(imported.error().code == ErrorCode::bad_input);
      CHECK(imported.error().text().find('\n') == std::string::npos);
      CHECK(imported.error().place.find(row.path) != std::string::npos);
    }
  }
}

TEST_CASE("data: no file is left without a row") {
  const fs::path data = real_data();
  std::set<std::string> known;
  for (const Row& row : rows()) known.insert(row.path);
  for (const auto& entry : fs::recursive_directory_iterator(data))
    if (entry.is_regular_file() && !needs_no_row(entry.path()))
      CHECK_MESSAGE(known.contains(fs::relative(entry.path(), data).string()), entry.path().string());
}

TEST_CASE("data: one slice in nine transfer syntaxes is one slice") {
  const fs::path data = real_data();
  std::vector<float> first;
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(data / "dicom_transfer_syntaxes")) {
    const std::string path = entry.path().string();
    CAPTURE(path);
    const auto read = read_scan(path, {});
    CHECK_MESSAGE(read.ok(), (read.ok() ? std::string() : read.error().text()));
    if (!read) continue;
    ++files;
    CHECK(read->scan.dims == Vec3i(512, 512, 1));
    const bool lossy = path.find("JPEGProcess2_4") != std::string::npos;
    if (first.empty() && !lossy) first = read->scan.values;
    double worst = 0.0;
    if (!first.empty())
      for (std::size_t n = 0; n < first.size(); ++n)
        worst = std::max(worst, static_cast<double>(std::abs(first[n] - read->scan.values[n])));
    // Lossy JPEG of 12 bits at good quality: tens of HU at edges.
    CHECK(worst <= (lossy ? 100.0 : 0.0));
  }
  CHECK(files == 9);
}

TEST_CASE("data: the headerless head is imported by the shipped sidecar, its guess reported") {
  (void)real_data("head_ct_raw_big_endian");  // the sidecar finds it by itself
  const auto imported = import_bone({test::in_source("app/scenes/volumes/cthead.toml"), {}, {}}, {});
  REQUIRE_MESSAGE(imported.ok(), imported.error().text());
  CHECK(imported->report.dims == Vec3i(256, 256, 113));
  CHECK(imported->report.facts.hu_offset == -1024.0);
  // 0..3272 in the data set's own table.
  CHECK(imported->report.facts.value_min == -1024.0);
  CHECK(imported->report.facts.value_max == 3272.0 - 1024.0);
  bool told = false;
  for (const std::string& line : imported->report.scan.assumed) told = told || line.find("spacing 0.9375") != std::string::npos;
  CHECK(told);
}

TEST_CASE("data: the whole head at 0.25 mm takes less than 2 GiB, and a region has its voxels") {
  (void)real_data("head_ct_raw_big_endian");
  ImportRequest request{test::in_source("app/scenes/volumes/cthead.toml"), {}, {}};
  request.bone.spacing = 0.25e-3;
  double predicted = 0.0;
  request.accept = [&](const BoneGrid& grid, std::uint64_t) {
    predicted = grid.bone_share * static_cast<double>(VoxelBox{Vec3i(0), grid.dims}.count()) * 3.0 * sizeof(float);
    return BoneStorage();
  };
  const auto whole = import_bone(request, {});
  REQUIRE(whole.ok());
  const BoneModel& all = *whole->bone;
  CHECK(all.dims() == Vec3i(957, 957, 841));
  CHECK(all.bytes() < std::size_t{2} << 30);
  CHECK(std::abs(predicted / static_cast<double>(all.bytes()) - 1.0) < 0.15);

  // The region of app/scenes/cadaver_head.toml.
  request.accept = {};
  request.bone.region = BoneRegion{Vec3(36.0, 131.2, -45.0) * 1e-3, Vec3(46e-3)};
  const auto part = import_bone(request, {});
  REQUIRE(part.ok());
  const BoneModel& region = *part->bone;
  const Vec3i at(glm::round(all.bone_from_index().inverse() * region.bone_from_index().offset));
  std::vector<float> ours(region.bounds().count()), theirs(ours.size());
  region.read_occupancy(region.bounds(), ours);
  all.read_occupancy({at, at + region.dims()}, theirs);
  double worst = 0.0;
  for (std::size_t n = 0; n < ours.size(); ++n) worst = std::max(worst, static_cast<double>(std::abs(ours[n] - theirs[n])));
  // Places differ by 1e-16 m; a float of 1000 HU is rounded to 6e-5 HU, over a ramp of 150 HU at least.
  CHECK(worst < 1e-5);
  CHECK(region.bone_voxels() > 100'000);
}
