#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/voxel/bone_history.h"
#include "core/voxel/vdb_grids.h"
#include "tests/core/voxel/voxel_cases.h"
#include "tests/support/file_limit.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(21, 18, 26);

/// A voxmap with random bites all over, its twin, and the same bone untouched.
struct Drilled {
  DenseBone dense = random_bone(kDims, 8);
  std::shared_ptr<const BoneModel> bone = load_bone(dense);
  Voxmap voxmap = make_voxmap(bone);
  PlainTwin twin{dense, 0.08f};

  explicit Drilled(std::uint64_t seed) {
    Dice dice{seed};
    for (int slide = 0; slide < 6; ++slide) {
      REQUIRE(voxmap.place_window(random_window(bone->bounds(), dice)).ok());
      erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 8), dice);
    }
  }
};

bool refuses(Voxmap& voxmap, const std::string& path) {
  const std::uint64_t hash = voxmap.hash(), growth = voxmap.growth_epoch();
  const Status status = voxmap.restore(path);
  return !status.ok() && status.error().code == ErrorCode::bad_input && status.error().place == path && voxmap.hash() == hash &&
         voxmap.growth_epoch() == growth;
}

std::vector<Affine> affines() {
  Affine scaled = Affine::scaling(0.3e-3, Vec3(0.0)), moved = Affine::scaling(0.1e-3, Vec3(-0.0123, 4.5e-7, 1.0 / 3.0));
  Affine turned = Affine::from_pose({rotation_from_z(glm::normalize(Vec3(0.3, -0.2, 0.9))), Vec3(0.0)});
  Affine sheared{Mat3(Vec3(0.31e-3, 1e-5, -2e-5), Vec3(7e-5, 0.4e-3, 1e-5 / 3.0), Vec3(-5e-5, 3e-5, 0.7e-3)), Vec3(0.1, -0.2, 1.0 / 7.0)};
  Affine mirrored = sheared;
  mirrored.linear[0] = -mirrored.linear[0];
  Affine anisotropic;
  anisotropic.linear = Mat3(Vec3(0.3e-3, 0, 0), Vec3(0, 0.5e-3, 0), Vec3(0, 0, 1.0e-3 / 3.0));
  Affine nearly_even;  // edges apart by less than a micrometre still add up over a skull
  nearly_even.linear = Mat3(Vec3(0.3e-3, 1e-8, 0), Vec3(0, 0.3002e-3, 0), Vec3(0, 0, 0.3004e-3));
  const Affine fine = Affine::scaling(5e-6, Vec3(0.1, 0.2, 0.3));
  return {scaled, moved, turned, sheared, mirrored, anisotropic, nearly_even, fine};
}

}  // namespace

TEST_CASE("checkpoint: save and restore bring back every voxel, the hash and the window, and raise both epochs") {
  const TemporaryFolder folder;
  Drilled drilled(1);
  const std::string path = folder.file("checkpoint.vdb");
  REQUIRE(drilled.voxmap.save(path).ok());
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);

  Voxmap restored = make_voxmap(drilled.bone);
  REQUIRE(restored.place_window({Vec3i(1), Vec3i(18, 17, 22)}).ok());
  const std::size_t listener = restored.add_listener();
  const MasterWindow before = restored.window();
  const std::uint64_t growth = restored.growth_epoch(), epoch = restored.window_epoch();
  REQUIRE(restored.restore(path).ok());
  CHECK(restored.hash() == drilled.voxmap.hash());
  CHECK(difference(restored.window(), drilled.twin) == "");
  CHECK(restored.growth_epoch() > growth);
  CHECK(restored.window_epoch() > epoch);
  CHECK(uncovered_change(before, restored.window(), restored.take_dirty(listener)) == "");
}

TEST_CASE(
    "checkpoint: restoring an earlier state undoes later drilling, unsaved drilling included, and notifies listeners where bone grew") {
  const TemporaryFolder folder;
  Drilled drilled(2);
  const std::string path = folder.file("checkpoint.vdb");
  REQUIRE(drilled.voxmap.save(path).ok());
  const std::uint64_t hash = drilled.voxmap.hash();
  const PlainTwin twin = drilled.twin;

  Dice dice{77};
  REQUIRE(drilled.voxmap.place_window({Vec3i(0), kDims}).ok());
  const std::size_t listener = drilled.voxmap.add_listener();
  erode_box(drilled.voxmap, drilled.twin, {Vec3i(3), Vec3i(16, 14, 20)}, dice);
  static_cast<void>(drilled.voxmap.take_dirty(listener));
  const MasterWindow before = drilled.voxmap.window();
  REQUIRE(drilled.voxmap.restore(path).ok());
  CHECK(drilled.voxmap.hash() == hash);
  CHECK(difference(drilled.voxmap.window(), twin) == "");
  CHECK(uncovered_change(before, drilled.voxmap.window(), drilled.voxmap.take_dirty(listener)) == "");
}

TEST_CASE("checkpoint: the bone itself comes back bit for bit, whatever its voxel-to-bone map") {
  const TemporaryFolder folder;
  int number = 0;
  for (const Affine& affine : affines()) {
    CAPTURE(number);
    DenseBone dense = random_bone({9, 11, 10}, 5);
    dense.bone_from_index = affine;
    dense.soft = dense.hardness;
    Voxmap voxmap = make_voxmap(load_bone(dense));
    const std::string path = folder.file("bone" + std::to_string(number) + ".vdb");
    REQUIRE(voxmap.save(path).ok());
    const auto loaded = BoneModel::load(path);
    REQUIRE(loaded.ok());
    const BoneModel& bone = **loaded;
    CHECK(bone.dims() == dense.dims);
    CHECK(bone.bone_from_index().linear == affine.linear);
    CHECK(bone.bone_from_index().offset == affine.offset);
    CHECK(bone.bone_voxels() == voxmap.bone().bone_voxels());
    std::vector<float> field(bone.bounds().count());
    bone.read_occupancy(bone.bounds(), field);
    CHECK(field == dense.occupancy);
    bone.read_hardness(bone.bounds(), field);
    CHECK(field == dense.hardness);
    bone.read_soft(bone.bounds(), field);
    CHECK(field == dense.soft);
    bone.read_labels(bone.bounds(), field);
    CHECK(field == std::vector<float>(dense.labels.begin(), dense.labels.end()));
    ++number;
  }
}

TEST_CASE("checkpoint: a bone model that was drilled before it was saved starts drilled, and a reset brings it back so") {
  const TemporaryFolder folder;
  Drilled drilled(5);
  REQUIRE(drilled.voxmap.save(folder.file("bone.vdb")).ok());
  const auto loaded = BoneModel::load(folder.file("bone.vdb"));
  REQUIRE(loaded.ok());
  REQUIRE((*loaded)->drilled() != nullptr);
  Voxmap voxmap = make_voxmap(*loaded);
  CHECK(voxmap.starts_drilled());
  CHECK(voxmap.hash() == drilled.voxmap.hash());
  const VoxelBox box = drilled.bone->bounds().grown(2);
  std::vector<float> expected(box.count()), found(box.count());
  drilled.voxmap.read_density(box, expected);
  (*loaded)->read_density(box, found);
  CHECK(found == expected);
  voxmap.read_start(box, found);
  CHECK(found == expected);
  drilled.bone->read_occupancy(box, found);
  CHECK(found != expected);

  auto history = BoneHistory::create(voxmap, {});
  REQUIRE(history.ok());
  Dice dice{6};
  PlainTwin twin = drilled.twin;
  REQUIRE(voxmap.place_window({Vec3i(0), kDims}).ok());
  (*history)->begin_step();
  erode_box(voxmap, twin, {Vec3i(3), Vec3i(16, 14, 20)}, dice);
  (*history)->end_step();
  CHECK(voxmap.hash() != drilled.voxmap.hash());
  (*history)->reset();
  CHECK(voxmap.hash() == drilled.voxmap.hash());

  // Saved again and moved into a temporary file, it is the same.
  REQUIRE(voxmap.save(folder.file("again.vdb")).ok());
  const auto again = BoneModel::load(folder.file("again.vdb"));
  REQUIRE(again.ok());
  const auto paged = (*again)->paged({.folder = folder.file("")});
  REQUIRE(paged.ok());
  CHECK(make_voxmap(*paged).hash() == drilled.voxmap.hash());
  Voxmap untouched = make_voxmap(drilled.bone);
  REQUIRE(untouched.save(folder.file("untouched.vdb")).ok());
  CHECK(BoneModel::load(folder.file("untouched.vdb")).value()->drilled() == nullptr);
}

TEST_CASE(
    "checkpoint: restore refuses files that are missing, foreign, damaged, of another size or without remaining, and changes nothing") {
  const TemporaryFolder folder;
  Drilled drilled(3);
  CHECK(refuses(drilled.voxmap, folder.file("missing.vdb")));

  std::ofstream(folder.file("foreign.vdb")) << "not a grid at all, only text that goes on for a while";
  CHECK(refuses(drilled.voxmap, folder.file("foreign.vdb")));
  std::ofstream(folder.file("empty.vdb")).flush();
  CHECK(refuses(drilled.voxmap, folder.file("empty.vdb")));

  Voxmap other = make_voxmap(load_bone(random_bone({21, 18, 25}, 8)));
  REQUIRE(other.save(folder.file("other.vdb")).ok());
  CHECK(refuses(drilled.voxmap, folder.file("other.vdb")));

  const auto grids = drilled.bone->grids();
  REQUIRE(write_vdb(folder.file("bone.vdb"), kDims, drilled.bone->bone_from_index(), grids).ok());
  CHECK(refuses(drilled.voxmap, folder.file("bone.vdb")));
  CHECK(BoneModel::load(folder.file("bone.vdb")).ok());

  const FloatVdb wrong("remaining", 0.0f);
  const std::vector<const FloatVdb*> only{&wrong};
  REQUIRE(write_vdb(folder.file("background.vdb"), kDims, drilled.bone->bone_from_index(), only).ok());
  CHECK(refuses(drilled.voxmap, folder.file("background.vdb")));
  CHECK_FALSE(BoneModel::load(folder.file("background.vdb")).ok());

  REQUIRE(drilled.voxmap.save(folder.file("whole.vdb")).ok());
  std::filesystem::copy_file(folder.file("whole.vdb"), folder.file("cut.vdb"));
  std::filesystem::resize_file(folder.file("cut.vdb"), std::filesystem::file_size(folder.file("cut.vdb")) / 2);
  CHECK(refuses(drilled.voxmap, folder.file("cut.vdb")));
  CHECK_FALSE(BoneModel::load(folder.file("cut.vdb")).ok());
}

TEST_CASE("checkpoint: restore refuses remaining outside 0..1 or not finite") {
  const TemporaryFolder folder;
  Drilled drilled(4);
  for (const float value : {-0.1f, 1.5f, std::numeric_limits<float>::quiet_NaN()}) {
    CAPTURE(value);
    FloatVdb grid("remaining", 1.0f);
    grid.write_box({Vec3i(4), Vec3i(5)}, {&value, 1});
    const std::vector<const FloatVdb*> only{&grid};
    const std::string path = folder.file("values.vdb");
    REQUIRE(write_vdb(path, kDims, drilled.bone->bone_from_index(), only).ok());
    CHECK(refuses(drilled.voxmap, path));
  }
}

TEST_CASE("checkpoint: a place that cannot be written is refused and leaves no half file, and a good file is replaced whole") {
  const TemporaryFolder folder;
  Drilled drilled(5);
  std::ofstream(folder.file("file")) << "text";
  const Status status = drilled.voxmap.save(folder.file("file/checkpoint.vdb"));
  REQUIRE_FALSE(status.ok());
  CHECK(status.error().code == ErrorCode::bad_input);
  const std::string path = folder.file("checkpoint.vdb");
  REQUIRE(make_voxmap(drilled.bone).save(path).ok());
  REQUIRE(drilled.voxmap.save(path).ok());
  Voxmap restored = make_voxmap(drilled.bone);
  REQUIRE(restored.restore(path).ok());
  CHECK(restored.hash() == drilled.voxmap.hash());
}

TEST_CASE("checkpoint: wherever a write fails, that is an error, and the good file stays as it was") {
  const TemporaryFolder folder;
  const std::string path = folder.file("checkpoint.vdb");
  const auto bytes = [&] {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  Drilled drilled(6);
  REQUIRE(drilled.voxmap.save(path).ok());
  const std::string good = bytes();
  Dice dice{7};
  for (int n = 0; n < 40; ++n) {
    // The first limits cut the header off, the last one the end of the file.
    const auto limit = n == 39 ? good.size() - 1 : static_cast<std::size_t>(n < 4 ? n : dice.next_below(static_cast<int>(good.size())));
    INFO("limit " << limit << " of " << good.size());
    Status status;
    {
      const DiskLimit full(limit);
      status = drilled.voxmap.save(path);
    }
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().place == path);
    CHECK(status.error().message.find("File too large") != std::string::npos);
    CHECK(bytes() == good);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
  }
}
