// Labels of the user: files of 3D Slicer and of ITK-SNAP are read with names and colours, and another grid than that of the scan is refused.
#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/import_bone.h"
#include "volumes/read/label_volume.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A scan of bone everywhere, and the same grid with labels 0, 1, 2, 7 and 9 in turn.
struct Files {
  TemporaryFolder folder;
  SmallVolume scan = small_volume(), labels = small_volume();
  Files() {
    constexpr std::int16_t kLabels[] = {0, 1, 2, 7, 9};
    for (std::size_t n = 0; n < labels.values.size(); ++n) {
      scan.values[n] = 1000;
      labels.values[n] = kLabels[n % 5];
    }
    write_bytes(folder.file("scan.nrrd"), nrrd_header(scan, "short", "little", "raw") + "\n" + stored<std::int16_t>(scan.values, false));
  }
  std::string nrrd(const std::string& name, const SmallVolume& volume, const std::string& fields = {}) {
    write_bytes(folder.file(name),
                nrrd_header(volume, "short", "little", "raw") + fields + "\n" + stored<std::int16_t>(volume.values, false));
    return folder.file(name);
  }
  std::string nifti(const std::string& name, const SmallVolume& volume) {
    write_bytes(folder.file(name), nifti_header(volume, {}) + stored<std::int16_t>(volume.values, false));
    return folder.file(name);
  }
  Result<ImportedBone> import(const LabelFiles& files) {
    ImportRequest request{folder.file("scan.nrrd"), {}, {}};
    request.bone.hu_offset = 0.0;
    request.bone.label_files = files;
    auto out = import_bone(request, {});
    INFO((out.ok() ? std::string() : out.error().text()));
    CHECK((out.ok() || out.error().place != request.path));
    return out;
  }
};

constexpr const char* kSegments =
    "Segment0_LabelValue:=1\nSegment0_Name:=Sagittal suture\nSegment0_Color:=1 0.5 0\n"
    "Segment1_LabelValue:=7\nSegment1_Name:=Inner table\nSegment1_Color:=0 0 1\n"
    "Segment2_LabelValue:=2\nSegment2_Name:=Frontal sinus\nSegment2_Color:=0 1 0\n";

constexpr const char* kSnap =
    "# ITK-SnAP Label Description File\n"
    "    0     0    0    0        0  0  0    \"Clear Label\"\n"
    "    1   255    0   10        1  1  1    \"Coronal suture\"\n"
    "    9     1    2    3      0.5  1  0    \"Sigmoid sinus\"\n";

}  // namespace

TEST_CASE("labels: segments of a .seg.nrrd keep names and colours, and a name of a layer is that layer") {
  Files files;
  const auto imported = files.import({files.nrrd("a.seg.nrrd", files.labels, kSegments), ""});
  REQUIRE(imported);
  const BoneModel& bone = *imported->bone;
  const LabelTable table = labels_of(bone.notes());
  REQUIRE(table.size() == 3);
  CHECK(table[0].name == "Sagittal suture");
  CHECK(table[0].color == LabelColor{255, 128, 0});
  CHECK(table[1].name == "Frontal sinus");
  CHECK(table[2].name == "label 9");  // the file has no name for it
  const VoxelBox all = bone.bounds();
  for_each_voxel(all, [&](const Vec3i& v) {
    const std::int16_t value = files.labels.values[all.offset_of(v)];
    const VoxelLabel expected = value == 0   ? VoxelLabel::bone
                                : value == 7 ? VoxelLabel::inner_table
                                             : table[value == 1   ? 0
                                                     : value == 2 ? 1
                                                                  : 2]
                                                   .label;
    CHECK(bone.label(v) == expected);
  });
}

TEST_CASE("labels: a NIfTI volume takes the names of an ITK-SNAP table, and a saved bone keeps them") {
  Files files;
  write_bytes(files.folder.file("labels.txt"), kSnap);
  const auto imported = files.import({files.nifti("labels.nii", files.labels), files.folder.file("labels.txt")});
  REQUIRE(imported);
  const LabelTable table = labels_of(imported->bone->notes());
  REQUIRE(table.size() == 4);
  CHECK(table[0].name == "Coronal suture");
  CHECK(table[0].color == LabelColor{255, 0, 10});
  CHECK(table[3].name == "Sigmoid sinus");
  CHECK(label_name(table[3].label, table) == "Sigmoid sinus");
  CHECK(is_felt(table[3].label));
}

TEST_CASE("labels: another size, spacing or place than that of the scan is refused in one line that says which") {
  Files files;
  const auto error_of = [&](const SmallVolume& volume) {
    const auto read = files.import({files.nrrd("other.nrrd", volume), ""});
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().code == ErrorCode::bad_input);
    CHECK(read.error().message.find('\n') == std::string::npos);
    CHECK(read.error().place == files.folder.file("other.nrrd"));
    return read.error().message;
  };
  SmallVolume other = files.labels;
  other.dims.z = 3;
  other.values.resize(other.values.size() * 3 / 4);
  CHECK(error_of(other).find("7 x 5 x 3 voxels, the scan 7 x 5 x 4") != std::string::npos);
  other = files.labels;
  other.lps_mm.linear[2] *= 1.25;
  CHECK(error_of(other).find("has voxels of") != std::string::npos);
  other = files.labels;
  other.lps_mm.offset.x += 0.5;
  CHECK(error_of(other).find("0.5 mm away") != std::string::npos);
  // A header with seven digits is the same grid.
  other = files.labels;
  other.lps_mm.offset.x += 1e-5;
  CHECK(files.import({files.nrrd("same.nrrd", other), ""}).ok());
}

TEST_CASE("labels: fractions, negative values, no labels and invalid tables are refused") {
  Files files;
  SmallVolume other = files.labels;
  other.values[3] = -2;
  CHECK(files.import({files.nrrd("negative.nrrd", other), ""}).error().message.find("the value -2") != std::string::npos);
  std::ranges::fill(other.values, std::int16_t{0});
  CHECK(files.import({files.nrrd("none.nrrd", other), ""}).error().message.find("no labels") != std::string::npos);
  for (const char* row : {"1 255 0 0 1 1 \"a\"", "1 256 0 0 1 1 1 \"a\"", "1 25 0 0 1 1 1 a", "1 2 3 4 1 1 1 \"a\"\n1 2 3 4 1 1 1 \"b\""}) {
    const auto rows = parse_label_table(std::string("# comment\n") + row + "\n", "table.txt");
    CAPTURE(row);
    REQUIRE_FALSE(rows.ok());
    CHECK(rows.error().place.starts_with("table.txt:"));
  }
}

TEST_CASE("labels: lines of notes that are not labels are skipped") {
  CHECK(labels_of("label 16 #ff0000 a b\nlabel 3 #ff0000 x\nlabel 17 #ff000 x\nlabel #ff0000 x\nother\nlabel 300 #ff0000 x\n").size() == 1);
  const NamedLabel one{static_cast<VoxelLabel>(200), "x y", {1, 2, 255}};
  const LabelTable back = labels_of(note_of(one));
  REQUIRE(back.size() == 1);
  CHECK(back[0].label == one.label);
  CHECK(back[0].name == one.name);
  CHECK(back[0].color == one.color);
}
