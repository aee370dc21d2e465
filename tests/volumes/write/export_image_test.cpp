#include <doctest/doctest.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "core/base/units.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/itk_twin.h"
#include "tests/volumes/read/volume_files.h"
#include "tests/volumes/write/drilled_ball.h"
#include "volumes/import_bone.h"
#include "volumes/read/scan.h"
#include "volumes/write/image_writer.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const VoxelBox kAll{Vec3i(0), kBallDims};

ReadScan read_back(const std::string& path) {
  auto read = read_scan(path, {});
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  return std::move(read).value();
}

ExportReport exported(const Voxmap& bone, const ExportRequest& request) {
  auto report = export_bone(bone, request);
  REQUIRE_MESSAGE(report.ok(), (report ? "" : report.error().text()));
  return *report;
}

/// [m] largest distance between what two maps make of the corners of the grid.
double apart(const Affine& a, const Affine& b) {
  double farthest = 0.0;
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& corner) {
    const Vec3 at = Vec3(corner) * Vec3(kBallDims - 1);
    farthest = std::max(farthest, glm::length(a * at - b * at));
  });
  return farthest;
}

Affine map_of(const TwinVolume& twin) {
  Affine out;
  for (std::size_t n = 0; n < 3; ++n) out.linear[n] = twin.direction[n] * twin.spacing_mm[n] * kMillimetre;
  out.offset = twin.origin_mm * kMillimetre;
  return out;
}

std::vector<std::string> files_in(const TemporaryFolder& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) out.push_back(entry.path().filename().string());
  return out;
}

// NIfTI-1 has floats: 2^-24 of the largest number of a row, here at most 0.8 m, three of them and a sum. NRRD has all digits of a double.
constexpr double kFloat = 4.0 * 0.8 * 0x1p-24, kDouble = 4.0 * 0.8 * 0x1p-52;

}  // namespace

TEST_CASE("export: NRRD and NIfTI read again are the same numbers at the same place, drilled and as loaded, sheared and left-handed") {
  const TemporaryFolder folder;
  for (const Affine& map : {oblique_map(), sheared_map()}) {
    const Voxmap bone = ball_voxmap(map, true);
    for (const bool undrilled : {false, true})
      for (const std::string name : {"a.nrrd", "a.nii", "b.nii.gz"}) {
        const double accuracy = name == "a.nrrd" ? kDouble : kFloat;
        INFO(name);
        const ExportReport report = exported(bone, {.path = folder.file(name), .undrilled = undrilled});
        CHECK(report.dims == kBallDims);
        CHECK(report.bytes == std::filesystem::file_size(folder.file(name)));
        const Scan scan = read_back(folder.file(name)).scan;
        CHECK(scan.dims == kBallDims);
        CHECK(scan.values == field_of(bone, ExportField::density, undrilled, kAll));
        CHECK(apart(scan.bone_from_index, map) < accuracy);
      }
  }
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  CHECK(field_of(bone, ExportField::density, false, kAll) != field_of(bone, ExportField::density, true, kAll));
  // NRRD loses nothing: the map is the same to the bit.
  exported(bone, {.path = folder.file("exact.nrrd")});
  const Affine exact = read_back(folder.file("exact.nrrd")).scan.bone_from_index;
  CHECK(exact.linear == oblique_map().linear);
  CHECK(exact.offset == oblique_map().offset);
}

TEST_CASE("export: ITK reads the same numbers at the same place") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  for (const ExportField field : {ExportField::density, ExportField::hardness, ExportField::remaining, ExportField::labels})
    for (const char* const name : {"a.nrrd", "a.nii", "a.nii.gz"}) {
      INFO(std::string(name) << " " << export_field_names()[static_cast<std::size_t>(field)]);
      exported(bone, {.path = folder.file(name), .field = field});
      const TwinVolume twin = read_by_itk(folder.file(name));
      CHECK(twin.dims == kBallDims);
      const std::vector<float> meant = field_of(bone, field, false, kAll);
      CHECK(std::equal(twin.values.begin(), twin.values.end(), meant.begin(), meant.end(),
                       [](double read, float written) { return read == static_cast<double>(written); }));
      // ITK computes the directions of a NIfTI in float: as many errors again.
      CHECK(apart(map_of(twin), oblique_map()) < 4.0 * kFloat);
    }
}

TEST_CASE("export, sabotage: a NIfTI map that stays LPS is 240 mm from where it belongs") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  exported(bone, {.path = folder.file("a.nii")});
  std::string bytes = read_bytes(folder.file("a.nii"));
  // The first two rows of the sform with the other sign; the qform is switched off.
  for (std::size_t at = 280; at < 312; at += 4) bytes[at + 3] = static_cast<char>(bytes[at + 3] ^ 0x80);
  set<std::int16_t>(bytes, 252, 0, false);
  write_bytes(folder.file("b.nii"), bytes);
  CHECK(apart(read_back(folder.file("a.nii")).scan.bone_from_index, oblique_map()) < kFloat);
  CHECK(apart(read_back(folder.file("b.nii")).scan.bone_from_index, oblique_map()) > 0.2);
}

TEST_CASE("export: the qform of a NIfTI agrees with its sform, and is left out where the map is sheared") {
  const TemporaryFolder folder;
  for (const Affine& map :
       {oblique_map(), Affine{oblique_map().linear * Mat3(Vec3(1, 0, 0), Vec3(0, 1.5, 0), Vec3(0, 0, -2)), Vec3(0.1)}}) {
    exported(ball_voxmap(map, false), {.path = folder.file("a.nii")});
    std::string bytes = read_bytes(folder.file("a.nii"));
    set<std::int16_t>(bytes, 254, 0, false);  // without the sform the reader takes the qform
    write_bytes(folder.file("b.nii"), bytes);
    // A quaternion of floats turns by up to 4 * 2^-24, over the 50 mm of the grid, besides the rounding of the offset.
    CHECK(apart(read_back(folder.file("b.nii")).scan.bone_from_index, map) < 2.0 * kFloat);
  }
  exported(ball_voxmap(sheared_map(), false), {.path = folder.file("c.nii")});
  CHECK(read_bytes(folder.file("c.nii")).substr(252, 2) == std::string(2, '\0'));
}

TEST_CASE("export: labels are bytes; bone that was drilled away has none, dura and brain stay") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  exported(bone, {.path = folder.file("a.nii"), .field = ExportField::labels});
  CHECK(std::filesystem::file_size(folder.file("a.nii")) == 352 + kAll.count());
  const std::vector<float> labels = read_back(folder.file("a.nii")).scan.values;
  const DenseBone dense = ball_of_bone(oblique_map());
  std::size_t drilled = 0, kept = 0;
  for_each_voxel(kAll, [&](const Vec3i& v) {
    const std::size_t n = kAll.offset_of(v);
    const Vec3 from_axis = Vec3(v) - kBallCentre;
    const double beside = std::hypot(from_axis.x, from_axis.y) - kHoleRadius / kEdge;
    const auto label = static_cast<VoxelLabel>(dense.labels[n]);
    if (beside > 2.0 || !is_felt(label)) {  // the ramp of the hole's wall ends two voxels outside
      kept += labels[n] == static_cast<float>(dense.labels[n]) ? 0 : 1;
    } else if (beside < 0.0) {
      drilled += labels[n] == 0.0f ? 1 : 0;
      CHECK(labels[n] == 0.0f);
    }
  });
  CHECK(kept == 0);
  CHECK(drilled > 1000);
  CHECK(field_of(bone, ExportField::labels, true, kAll) == std::vector<float>(dense.labels.begin(), dense.labels.end()));
}

TEST_CASE("export: a cropped volume holds all bone, and it stays where it is in the patient") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  for (const char* const name : {"a.nrrd", "a.nii"}) {
    exported(bone, {.path = folder.file(name), .crop = true});
    const Scan scan = read_back(folder.file(name)).scan;
    REQUIRE(scan.dims != kBallDims);
    const VoxelBox box{Vec3i(0), scan.dims};
    double inside = 0.0, all = 0.0;
    Vec3 centre(0.0);
    for_each_voxel(box, [&](const Vec3i& v) {
      const float value = scan.values[box.offset_of(v)];
      inside += static_cast<double>(value);
      centre += static_cast<double>(value) * (scan.bone_from_index * Vec3(v));
    });
    for (const float value : field_of(bone, ExportField::density, false, kAll)) all += static_cast<double>(value);
    CHECK(inside == doctest::Approx(all).epsilon(1e-12));
    // The ball is sampled: its centre of mass is within a tenth of a voxel of its middle.
    CHECK(glm::length(centre / inside - oblique_map() * kBallCentre) < 0.1 * kEdge);
  }
}

TEST_CASE("export: nothing is left of a file that cannot be written, and an old one stays as it was") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  for (const char* const name : {"a.nrrd", "a.nii.gz", "a.stl", "a.vdb"}) {
    INFO(std::string(name));
    std::filesystem::create_directory(folder.file(name));  // a folder in its place: the renaming fails, after all was written
    std::filesystem::create_directory(folder.file(name) + "/keep");
    const auto report = export_bone(bone, {.path = folder.file(name)});
    REQUIRE_FALSE(report.ok());
    CHECK(report.error().code == ErrorCode::bad_input);
    CHECK(report.error().place == folder.file(name));
    CHECK(files_in(folder) == std::vector<std::string>{name});
    std::filesystem::remove_all(folder.file(name));
  }
  const auto nowhere = export_bone(bone, {.path = "/proc/none/a.nrrd"});
  REQUIRE_FALSE(nowhere.ok());
  CHECK(nowhere.error().message == "cannot be written: No such file or directory");
}

TEST_CASE("export: what a format does not hold is refused before the bone is read") {
  const auto refusal = [](const ExportRequest& request) { return check_request(request).error().text(); };
  CHECK(refusal({.path = "a.png"}) ==
        "a.png: must end in .nrrd, .nii, .nii.gz, .vdb, .stl, .ply or .obj; a planned line in .mrk.json or .fcsv");
  CHECK(refusal({.path = "a.stl", .field = ExportField::labels}) == "a.stl: a mesh is the surface of the density: leave the field out");
  CHECK(refusal({.path = "a.vdb", .field = ExportField::labels}) == "a.vdb: a .vdb holds all fields: leave the field out");
  CHECK(refusal({.path = "a.vdb", .crop = true}) == "a.vdb: only .nrrd and .nii are cropped: a .vdb and a mesh hold no empty space");
  CHECK(check_request({.path = "A.NII.GZ", .field = ExportField::labels}).ok());
  const auto wide = nifti_header_bytes({.box = {Vec3i(0), Vec3i(40000, 1, 1)}, .bone_from_index = {}, .content = "density", .read = {}});
  REQUIRE_FALSE(wide.ok());
  CHECK(wide.error().message == "NIfTI-1 holds at most 32767 voxels along an axis, not 40000");
}

TEST_CASE("export: a length in mm is written so that it is read as the same length") {
  std::size_t off = 0;
  for (int n = -2000; n < 2000; ++n) {
    const double metres = n * 0.25 * kMillimetre + 1.0 / 3000.0;
    const double again = exact_millimetres(metres) * kMillimetre;
    CHECK(std::abs(again - metres) <= std::abs(metres) * 0x1p-52);
    off += again == metres ? 0 : 1;
  }
  CHECK(exact_millimetres(0.25 * kMillimetre) == 0.25);
  CHECK(off < 400);  // a product with 0.001 does not reach every double
}

TEST_CASE("export: density is recognised as occupancy when it is imported, and other fields are not") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  for (const char* const name : {"a.nrrd", "a.nii.gz"}) {
    exported(bone, {.path = folder.file(name)});
    const auto imported = import_bone({folder.file(name), {}, {}}, {});
    REQUIRE_MESSAGE(imported.ok(), (imported ? "" : imported.error().text()));
    std::vector<float> occupancy(kAll.count());
    imported->bone->read_occupancy(kAll, occupancy);
    CHECK(occupancy == field_of(bone, ExportField::density, false, kAll));
    CHECK(apart(imported->bone->bone_from_index(), oblique_map()) < kFloat);
    exported(bone, {.path = folder.file(name), .field = ExportField::remaining});
    CHECK(read_back(folder.file(name)).scan.quantity == Quantity::unknown);
  }
  // Resampled like any volume.
  exported(bone, {.path = folder.file("a.nrrd")});
  ImportRequest finer{folder.file("a.nrrd"), {}, {}};
  finer.bone.spacing = 0.4e-3;
  finer.read.pitch = 0.4e-3;
  const auto resampled = import_bone(finer, {});
  REQUIRE_MESSAGE(resampled.ok(), (resampled ? "" : resampled.error().text()));
  CHECK(resampled->bone->bone_from_index().mean_edge() == doctest::Approx(0.4e-3));
}

TEST_CASE("export: a stop after the file is begun leaves no part of it, and the file that was there") {
  const Voxmap bone = ball_voxmap(sheared_map(), false);
  REQUIRE(kBallDims.z > 8);  // a slab: the stop comes before the last
  for (const std::string name : {"a.nrrd", "a.nii", "a.nii.gz", "a.stl", "a.vdb"})
    for (const bool there : {false, true}) {
      CAPTURE(name);
      const TemporaryFolder folder;
      if (there) std::ofstream(folder.file(name)) << "a CT";
      const bool is_image = name != "a.stl" && name != "a.vdb";
      std::atomic<bool> stop{false};
      std::size_t slabs = 0, begun = 0, temporary = 0;
      const auto between_slabs = [&](double share) {
        CHECK(share < 1.0);
        ++slabs;
        temporary = files_in(folder).size() - (there ? 1 : 0);
        stop = true;
      };
      const auto before_the_file = [&] {
        ++begun;
        CHECK(files_in(folder).size() == (there ? 1 : 0));
        stop = !is_image;  // these have no progress
      };
      const auto report =
          export_bone(bone, {.path = folder.file(name), .progress = between_slabs, .begin = before_the_file, .stop = &stop});
      CHECK(begun == 1);
      CHECK(slabs == (is_image ? 1 : 0));
      CHECK(temporary == (is_image ? 1 : 0));
      REQUIRE(!report.ok());
      CHECK(report.error().code == ErrorCode::unavailable);
      CHECK(report.error().place == folder.file(name));
      CHECK(report.error().message.find("was stopped") != std::string::npos);
      CHECK(files_in(folder) == (there ? std::vector<std::string>{name} : std::vector<std::string>{}));
      if (there) CHECK(std::filesystem::file_size(folder.file(name)) == 4);
    }
}
