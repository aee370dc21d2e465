#include "core/voxel/paged_bone.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "core/voxel/coarse_distance.h"
#include "tests/core/voxel/voxel_cases.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

using Fields = std::array<std::vector<float>, 4>;

/// All four fields of a box, by the public readers.
Fields read_all(const BoneModel& bone, const VoxelBox& box) {
  Fields out;
  for (std::vector<float>& field : out) field.assign(box.count(), -1.0f);
  bone.read_occupancy(box, out[0]);
  bone.read_hardness(box, out[1]);
  bone.read_soft(box, out[2]);
  bone.read_labels(box, out[3]);
  return out;
}

BoneStorage storage_in(const TemporaryFolder& folder) { return {.folder = folder.path().string()}; }

/// A random bone, of which some blocks are empty, some constant in a field, and some have soft tissue.
DenseBone patchy_bone(const Vec3i& dims, std::uint64_t seed) {
  DenseBone out = random_bone(dims, seed);
  out.soft = out.hardness;
  Dice dice{seed};
  const VoxelBox all{Vec3i(0), dims};
  for (int n = 0; n < 60; ++n) {
    const int kind = n % 5;
    const float constant = static_cast<float>(dice.next());
    for_each_voxel(dice.box_inside(all, 20), [&](const Vec3i& v) {
      const std::size_t at = all.offset_of(v);
      if (kind == 0) out.occupancy[at] = out.hardness[at] = out.soft[at] = 0.0f;
      if (kind == 0 || kind == 4) out.labels[at] = 0;
      if (kind == 1) out.occupancy[at] = constant;
      if (kind == 2) out.hardness[at] = constant;
      if (kind == 3) out.soft[at] = 0.0f;
      if (kind == 4) out.soft[at] = out.occupancy[at] = out.hardness[at] = 0.0f;
    });
  }
  return out;
}

DenseBone part_of(const DenseBone& dense, const VoxelBox& box) {
  const VoxelBox all{Vec3i(0), dense.dims};
  DenseBone out;
  out.dims = box.size();
  for_each_voxel(box, [&](const Vec3i& v) {
    const std::size_t at = all.offset_of(v);
    out.occupancy.push_back(dense.occupancy[at]);
    out.hardness.push_back(dense.hardness[at]);
    if (!dense.soft.empty()) out.soft.push_back(dense.soft[at]);
    if (!dense.labels.empty()) out.labels.push_back(dense.labels[at]);
  });
  return out;
}

std::shared_ptr<const BoneModel> paged_bone(const DenseBone& dense, const BoneStorage& storage) {
  auto bone = BoneModel::create(dense, storage);
  REQUIRE(bone.ok());
  REQUIRE((*bone)->file_bytes().has_value());
  return *bone;
}

/// @returns the first of many random boxes, some outside the grid, in which two bones differ; empty if in none.
std::string difference(const BoneModel& a, const BoneModel& b, std::uint64_t seed, int boxes) {
  Dice dice{seed};
  const VoxelBox around = a.bounds().grown(11);
  for (int n = 0; n < boxes; ++n) {
    const VoxelBox box = n == 0 ? around : dice.box_inside(around, n % 3 == 0 ? 40 : 9);
    if (read_all(a, box) != read_all(b, box)) return "box " + std::to_string(n) + " of seed " + std::to_string(seed);
    if (a.label(box.lo) != b.label(box.lo) || a.occupancy(box.lo) != b.occupancy(box.lo)) return "voxel " + std::to_string(n);
  }
  return {};
}

std::vector<VoxelBox> regions_of(const BoneModel& bone) {
  std::vector<VoxelBox> out;
  bone.for_each_drawn_region([&](const VoxelBox& box) { out.push_back(box); });
  std::ranges::sort(out, {}, [](const VoxelBox& b) { return std::array{b.lo.z, b.lo.y, b.lo.x, b.hi.z, b.hi.y, b.hi.x}; });
  return out;
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

/// Open files without a name in the folder; those of this process are visible in /proc.
std::vector<int> unnamed_files(const TemporaryFolder& folder) {
  std::vector<int> out;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code ignored;
    const std::string target = std::filesystem::read_symlink(entry.path(), ignored).string();
    if (target.starts_with(folder.path().string()) && target.ends_with("(deleted)")) out.push_back(std::stoi(entry.path().filename()));
  }
  return out;
}

}  // namespace

TEST_CASE("paged bone: reads the same bits as a bone in memory: any box, outside the grid, constant and empty blocks, soft tissue") {
  const TemporaryFolder folder;
  for (const Vec3i& dims : {Vec3i(61, 50, 43), Vec3i(8, 8, 8), Vec3i(1, 70, 3), Vec3i(64, 64, 64)}) {
    CAPTURE(dims.x);
    const DenseBone dense = patchy_bone(dims, static_cast<std::uint64_t>(dims.y));
    const auto memory = load_bone(dense);
    const auto paged = paged_bone(dense, storage_in(folder));
    CHECK(difference(*memory, *paged, 5, 300) == "");
    CHECK(paged->bone_voxels() == memory->bone_voxels());
    CHECK(paged->bone_box() == memory->bone_box());
    CHECK(regions_of(*paged) == regions_of(*memory));
    CHECK(paged->read_status().ok());
    CHECK(!memory->file_bytes());
    CHECK(files_in(folder.path()) == 0);
  }
}

TEST_CASE("paged bone: boxes in random order that cut blocks and overlap give the bone of one box; the last value of a voxel counts") {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const Vec3i dims(45, 39, 52);
    DenseBone earlier = patchy_bone(dims, seed), last = patchy_bone(dims, seed + 100);
    // Without soft tissue or labels the values that are there stay, as in memory.
    if (seed == 2) last.soft.clear();
    if (seed == 3) last.labels.clear();
    std::vector<VoxelBox> tiles;
    const Vec3i edge(5 + static_cast<int>(seed), 17, 9);
    for_each_voxel({Vec3i(0), (dims + edge - 1) / edge}, [&](const Vec3i& t) {
      tiles.push_back({t * edge, glm::min((t + 1) * edge, dims)});
    });
    for (std::size_t n = tiles.size(); n > 1; --n)
      std::swap(tiles[n - 1], tiles[static_cast<std::size_t>(dice.next_below(static_cast<int>(n)))]);
    auto memory = BoneModelBuilder::create(dims, earlier.bone_from_index);
    auto paged = BoneModelBuilder::create(dims, earlier.bone_from_index, storage_in(folder));
    REQUIRE(paged.ok());
    for (int n = 0; n < 25; ++n) {
      const VoxelBox box = dice.box_inside({Vec3i(0), dims}, 30);
      for (BoneModelBuilder* builder : {&*memory, &*paged}) REQUIRE(builder->add(box, part_of(earlier, box)).ok());
    }
    for (const VoxelBox& box : tiles)
      for (BoneModelBuilder* builder : {&*memory, &*paged}) REQUIRE(builder->add(box, part_of(last, box)).ok());
    CHECK(!paged->add({Vec3i(0), dims + 1}, last).ok());
    const auto a = memory->finish("note"), b = paged->finish("note");
    CHECK(difference(*a, *b, seed, 200) == "");
    CHECK(b->bone_voxels() == a->bone_voxels());
    CHECK(b->bone_box() == a->bone_box());
    CHECK(b->notes() == "note");
    // Places of blocks that moved are used again: at most the size of a file of full blocks, and that of one more block for each size.
    CHECK(*b->file_bytes() <= PagedBone::file_bytes(dims, true, 1.0) * 3 / 2);
  }
}

TEST_CASE("paged bone: sabotage, one damaged value of one block in the file is noticed by these comparisons") {
  const TemporaryFolder folder;
  const DenseBone dense = patchy_bone({40, 40, 40}, 9);
  const auto memory = load_bone(dense);
  const auto paged = paged_bone(dense, storage_in(folder));
  REQUIRE(difference(*memory, *paged, 1, 10) == "");
  const auto files = unnamed_files(folder);
  REQUIRE(files.size() == 1);
  const float other = 0.123f;
  REQUIRE(pwrite(files.front(), &other, sizeof other, 512 * 40 + 8) == sizeof other);
  CHECK(difference(*memory, *paged, 1, 10) != "");
}

TEST_CASE("paged bone: a read that fails is an error that stays, and a window is not placed on it") {
  const TemporaryFolder folder;
  const DenseBone dense = random_bone({40, 40, 40}, 4);
  const auto bone = paged_bone(dense, storage_in(folder));
  Voxmap voxmap = make_voxmap(bone);
  REQUIRE(voxmap.place_window({Vec3i(0), Vec3i(20)}).ok());
  REQUIRE(!bone->read_failed()->load());
  REQUIRE(ftruncate(unnamed_files(folder).front(), static_cast<off_t>(*bone->file_bytes() / 2)) == 0);
  std::vector<float> values(bone->bounds().count());
  bone->read_occupancy(bone->bounds(), values);
  CHECK(bone->read_failed()->load());
  const Status status = bone->read_status();
  REQUIRE(!status.ok());
  CHECK(status.error().code == ErrorCode::unavailable);
  CHECK(status.error().message.find(folder.path().string()) != std::string::npos);
  const Status placed = voxmap.place_window({Vec3i(20), Vec3i(40)});
  REQUIRE(!placed.ok());
  CHECK(placed.error().message == status.error().message);
}

TEST_CASE("paged bone: a full disk, a limit of the process and a folder that is not there are errors with folder and bytes") {
  const TemporaryFolder folder;
  const DenseBone dense = random_bone({40, 40, 40}, 4);
  const auto refusal = [&](BoneStorage storage) {
    storage.expected_bytes = storage.expected_bytes == 0 ? 64'000'000 : storage.expected_bytes;
    const auto bone = BoneModel::create(dense, storage);
    REQUIRE(!bone.ok());
    CHECK(bone.error().code == ErrorCode::unavailable);
    CHECK(bone.error().message.find(storage.folder) != std::string::npos);
    return bone.error().message;
  };
  BoneStorage small = storage_in(folder);
  small.most_bytes = 100'000;
  CHECK(refusal(small).find("needs about 64.0 MB") != std::string::npos);
  BoneStorage huge = storage_in(folder);
  huge.expected_bytes = 1'000'000'000'000'000'000;
  CHECK(refusal(huge).find("are free") != std::string::npos);
  CHECK(refusal({.folder = folder.file("none")}).find("cannot be made") != std::string::npos);
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  rlimit tight = before;
  tight.rlim_cur = 200'000;
  REQUIRE(setrlimit(RLIMIT_FSIZE, &tight) == 0);  // beyond it a write would end the process by SIGXFSZ
  const std::string limited = refusal(storage_in(folder));
  REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
  CHECK(limited.find("cannot grow beyond 0.2 MB") != std::string::npos);
  CHECK(unnamed_files(folder).empty());
  CHECK(files_in(folder.path()) == 0);
}

TEST_CASE("paged bone: a volume of 2048^3 with little bone takes memory for its bone, not for its voxels") {
  const TemporaryFolder folder;
  const Vec3i dims(2048);
  auto paged = BoneModelBuilder::create(dims, Affine::scaling(1e-4, Vec3(0.0)), storage_in(folder));
  auto memory = BoneModelBuilder::create(dims, Affine::scaling(1e-4, Vec3(0.0)));
  REQUIRE(paged.ok());
  Dice dice{3};
  constexpr int kBoxes = 40;
  std::vector<VoxelBox> boxes;
  for (int n = 0; n < kBoxes; ++n) {
    const Vec3i lo(dice.next_below(2020), dice.next_below(2020), dice.next_below(2020));
    boxes.push_back({lo, lo + 20});
    const DenseBone part = random_bone(Vec3i(20), static_cast<std::uint64_t>(n));
    for (BoneModelBuilder* builder : {&*memory, &*paged}) REQUIRE(builder->add(boxes.back(), part).ok());
  }
  const auto a = memory->finish(), b = paged->finish();
  for (const VoxelBox& box : boxes) CHECK(read_all(*a, box.grown(9)) == read_all(*b, box.grown(9)));
  CHECK(b->bone_voxels() == a->bone_voxels());
  // 32^3 pointers to nodes. A box of 20 voxels meets at most 4^3 blocks, of 36 bytes in the index, in at most 2^3 nodes of 2 KiB.
  CHECK(b->bytes() <= 2000 + 32768 * 8 + kBoxes * (64 * 36 + 8 * 2048));
  // A block in the file has 9 bytes a voxel, without soft tissue.
  CHECK(*b->file_bytes() <= kBoxes * 64 * 512 * 9);
  const double share = kBoxes * 64.0 / (256.0 * 256.0 * 256.0);
  CHECK(b->bytes() <= PagedBone::index_bytes(dims, share));
  CHECK(*b->file_bytes() <= PagedBone::file_bytes(dims, false, share));
  const CoarseDistance distance_a(*a), distance_b(*b);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 at(2048.0 * dice.next(), 2048.0 * dice.next(), 2048.0 * dice.next());
    REQUIRE(distance_a.at(at) == distance_b.at(at));
  }
}

TEST_CASE("paged bone: made from a bone in memory it has the same voxels") {
  const TemporaryFolder folder;
  const DenseBone dense = patchy_bone({50, 33, 41}, 12);
  const auto memory = load_bone(dense);
  const auto paged = memory->paged(storage_in(folder));
  REQUIRE(paged.ok());
  CHECK(difference(*memory, **paged, 2, 100) == "");
  CHECK((*paged)->bone_voxels() == memory->bone_voxels());
}

TEST_CASE("paged bone: a voxmap slides, erodes and saves changes as on a bone in memory, and refuses to save the whole") {
  const TemporaryFolder folder;
  const DenseBone dense = patchy_bone({60, 52, 45}, 6);
  Voxmap a = make_voxmap(load_bone(dense)), b = make_voxmap(paged_bone(dense, storage_in(folder)));
  PlainTwin twin(dense, 0.08f);
  Dice dice{6};
  for (int slide = 0; slide < 30; ++slide) {
    const VoxelBox window = random_window(a.bone().bounds(), dice);
    REQUIRE(a.place_window(window).ok());
    REQUIRE(b.place_window(window).ok());
    REQUIRE(a.window().occupancy == b.window().occupancy);
    REQUIRE(a.window().hardness == b.window().hardness);
    const VoxelBox bite = dice.box_inside(window.grown(-2), 6);
    erode_box(a, twin, bite, dice);
    std::vector<float> left(window.count());
    a.read_remaining(window, left);
    std::ranges::copy(left, b.remaining().begin());
    b.commit(window.grown(-2));
  }
  CHECK(a.hash() == b.hash());
  CHECK(a.hash() != make_voxmap(load_bone(dense)).hash());
  const Status whole = b.save(folder.file("whole.vdb"));
  REQUIRE(!whole.ok());
  CHECK(!std::filesystem::exists(folder.file("whole.vdb")));
  REQUIRE(b.save(folder.file("changes.vdb"), SavedBone::changes).ok());
  Voxmap restored = make_voxmap(load_bone(dense));
  REQUIRE(restored.restore(folder.file("changes.vdb")).ok());
  CHECK(restored.hash() == b.hash());
  Voxmap on_pages = make_voxmap(paged_bone(dense, storage_in(folder)));
  REQUIRE(on_pages.restore(folder.file("changes.vdb")).ok());
  CHECK(on_pages.hash() == b.hash());
}

TEST_CASE("paged bone: several threads read it at the same time") {
  const TemporaryFolder folder;
  const DenseBone dense = patchy_bone({48, 48, 48}, 21);
  const auto memory = load_bone(dense);
  const auto paged = paged_bone(dense, storage_in(folder));
  std::array<std::string, 4> found;
  std::vector<std::thread> threads;
  for (std::size_t n = 0; n < found.size(); ++n) threads.emplace_back([&, n] { found[n] = difference(*memory, *paged, n, 60); });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& one : found) CHECK(one == "");
}
