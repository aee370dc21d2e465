// Undo and checkpoints against dense copies of the whole volume. operator new is replaced: bytes() is compared with what is allocated.
#include "core/voxel/bone_history.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <new>

#include "core/voxel/contact_window.h"
#include "tests/core/voxel/voxel_cases.h"

namespace {

/// Sum of the sizes asked for and not given back. The size stands before each block.
std::size_t live_bytes = 0;
constexpr std::size_t kFront = alignof(std::max_align_t);

}  // namespace

// Not inlined: GCC would see free() of a block that is not malloc()'s own and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  auto* block = static_cast<std::byte*>(std::malloc(size + kFront));
  if (block == nullptr) throw std::bad_alloc();
  *reinterpret_cast<std::size_t*>(block) = size;
  live_bytes += size;
  return block + kFront;
}
[[gnu::noinline]] void operator delete(void* at) noexcept {
  if (at == nullptr) return;
  auto* block = static_cast<std::byte*>(at) - kFront;
  live_bytes -= *reinterpret_cast<std::size_t*>(block);
  std::free(block);
}
void operator delete(void* at, std::size_t) noexcept { operator delete(at); }
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete[](void* at) noexcept { operator delete(at); }
void operator delete[](void* at, std::size_t) noexcept { operator delete(at); }

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(43, 38, 35);  // no multiple of a block's 8
const VoxelBox kAll = VoxelBox{Vec3i(0), kDims}.grown(16);

/// Every voxel of the volume as it is, and the hash: the slow twin of a step.
struct DenseState {
  std::vector<float> remaining;
  std::uint64_t hash = 0;
  friend bool operator==(const DenseState&, const DenseState&) = default;
};

struct Drilling {
  explicit Drilling(std::uint64_t seed, const BoneHistoryConfig& config = {.memory = std::size_t{8} << 20})
      : dice{seed}, history(std::move(BoneHistory::create(voxmap, config)).value()) {
    slide();
  }

  void slide() { REQUIRE(voxmap.place_window(random_window(voxmap.bone().bounds(), dice)).ok()); }
  void bite() { erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 9), dice); }
  /// Bites, with the window moving between them.
  void drill(int bites) {
    for (int n = 0; n < bites; ++n) {
      if (dice.next() < 0.4) slide();
      bite();
      if (dice.next() < 0.3) voxmap.write_back();
    }
  }
  /// A step that changes something, unless it has no bites.
  void step(int bites) {
    const std::uint64_t hash = voxmap.hash();
    history->begin_step();
    do drill(bites);
    while (bites > 0 && voxmap.hash() == hash);
    history->end_step();
  }
  [[nodiscard]] DenseState state() {
    DenseState out{std::vector<float>(kAll.count()), voxmap.hash()};
    std::size_t n = 0;
    for_each_voxel(kAll, [&](const Vec3i& v) { out.remaining[n++] = twin.remaining(v); });
    return out;
  }
  /// The twin takes over an earlier state.
  void set_twin(const DenseState& state) {
    std::size_t n = 0;
    for_each_voxel(kAll, [&](const Vec3i& v) { twin.set_remaining(v, state.remaining[n++]); });
  }
  /// @returns what differs from the state, by the window, by reads over everything and by the hash.
  [[nodiscard]] std::string difference_from(const DenseState& wanted) {
    set_twin(wanted);
    if (std::string found = difference(voxmap.window(), twin); !found.empty()) return found;
    std::vector<float> read(kAll.count());
    voxmap.read_remaining(kAll, read);
    if (read != wanted.remaining) return "remaining";
    return voxmap.hash() == wanted.hash ? "" : "hash";
  }

  DenseBone dense = random_bone(kDims, 4);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  PlainTwin twin{dense, 0.08f};
  Dice dice;
  std::unique_ptr<BoneHistory> history;
};

}  // namespace

TEST_CASE("bone history: undo after undo brings back every voxel and the hash of each step's begin, whatever slid in between") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Drilling run(seed);
    std::vector<DenseState> begins;
    for (int n = 0; n < 6; ++n) {
      begins.push_back(run.state());
      run.step(1 + run.dice.next_below(6));
    }
    CHECK(run.history->steps() == begins.size());
    while (!begins.empty()) {
      if (run.dice.next() < 0.5) run.slide();
      REQUIRE(run.history->undo());
      REQUIRE(run.difference_from(begins.back()) == "");
      begins.pop_back();
      if (run.dice.next() < 0.3) {  // drilled anew from there
        begins.push_back(run.state());
        run.step(2);
      }
      REQUIRE(run.history->steps() == begins.size());
    }
    CHECK_FALSE(run.history->undo());
    CHECK(run.voxmap.blocks().size() == 0);
    CHECK(run.history->kept_blocks() == 0);
    CHECK(run.history->dropped_steps() == 0);
  }
}

TEST_CASE("bone history: undo ends an open step; steps without a change do not count; what changes between steps goes with the last") {
  Drilling run(11);
  const DenseState fresh = run.state();
  run.drill(2);  // before any step: kept by none
  const DenseState loose = run.state();
  for (int n = 0; n < 3; ++n) run.step(0);
  CHECK(run.history->steps() == 0);
  CHECK_FALSE(run.history->undo());
  CHECK(run.difference_from(loose) == "");
  run.step(3);
  run.drill(2);
  CHECK(run.history->steps() == 1);
  const DenseState second = run.state();
  run.history->begin_step();
  run.drill(4);
  REQUIRE(run.history->undo());
  CHECK_FALSE(run.history->step_open());
  CHECK(run.difference_from(second) == "");
  REQUIRE(run.history->undo());
  CHECK(run.difference_from(loose) == "");
  CHECK_FALSE(fresh == loose);
}

TEST_CASE("bone history: undo raises both epochs and names to listeners all that it changes, in the window and outside") {
  Drilling run(12);
  REQUIRE(run.voxmap.place_window({Vec3i(-2), kDims + 2}).ok());
  const std::size_t listener = run.voxmap.add_listener();
  run.history->begin_step();
  for (int n = 0; n < 12; ++n) run.bite();
  run.history->end_step();
  static_cast<void>(run.voxmap.take_dirty(listener));
  const MasterWindow before = run.voxmap.window();
  const std::uint64_t growth = run.voxmap.growth_epoch(), epoch = run.voxmap.window_epoch();
  SUBCASE("the window over all of it") {
    REQUIRE(run.history->undo());
    CHECK(uncovered_change(before, run.voxmap.window(), run.voxmap.take_dirty(listener)) == "");
  }
  SUBCASE("the window elsewhere") {
    REQUIRE(run.voxmap.place_window({Vec3i(60), Vec3i(70)}).ok());
    REQUIRE(run.history->undo());
    const VoxelBoxes dirty = run.voxmap.take_dirty(listener);
    REQUIRE(run.voxmap.place_window(before.box).ok());
    CHECK(uncovered_change(before, run.voxmap.window(), dirty) == "");
  }
  CHECK(run.voxmap.growth_epoch() > growth);
  CHECK(run.voxmap.window_epoch() > epoch);
}

TEST_CASE("bone history: after an undo the published copies, gradients, words and records equal those of a fresh publisher") {
  for (const RecordPrecision precision : {RecordPrecision::bits8, RecordPrecision::bits16}) {
    Drilling run(13);
    REQUIRE(run.voxmap.place_window({Vec3i(-3), kDims + 3}).ok());
    const ContactFields fields{.density = true, .gradient = true, .words = true, .records = precision};
    ContactWindowPublisher publisher(run.voxmap, fields);
    publisher.publish(run.voxmap);
    for (int round = 0; round < 4; ++round) {
      run.history->begin_step();
      for (int n = 0; n < 5; ++n) {
        run.bite();
        publisher.publish(run.voxmap);
      }
      REQUIRE(run.history->undo());
      for (int n = 0; n < 1 + round; ++n) publisher.publish(run.voxmap);  // each of the three copies is caught up in turn
      ContactWindowPublisher fresh(run.voxmap, fields);
      fresh.publish(run.voxmap);
      const ContactWindow &now = publisher.exchange().latest(), &rebuilt = fresh.exchange().latest();
      CHECK(now.growth_epoch == run.voxmap.growth_epoch());
      CHECK(now.density == rebuilt.density);
      CHECK(now.gradient == rebuilt.gradient);
      CHECK(now.words == rebuilt.words);
      CHECK(now.stiffness == rebuilt.stiffness);
      CHECK(now.records_valid == rebuilt.records_valid);
      std::visit(
          [&](const auto& records) {
            const auto& others = std::get<std::decay_t<decltype(records)>>(rebuilt.records);
            CHECK(std::memcmp(records.data(), others.data(), records.size() * sizeof(records[0])) == 0);
          },
          now.records);
      run.step(3);  // the bone differs between rounds
      publisher.publish(run.voxmap);
      REQUIRE(run.voxmap.place_window({Vec3i(-3), kDims + 3}).ok());
    }
  }
}

TEST_CASE("bone history: checkpoints and the bone as loaded come back bit for bit, and their coming back can be undone") {
  for (std::uint64_t seed = 21; seed <= 24; ++seed) {
    CAPTURE(seed);
    Drilling run(seed);
    const DenseState loaded = run.state();
    std::map<std::string, DenseState> marked;
    for (const char* name : {"first", "second", "first", "third"}) {  // the second "first" replaces the other
      run.step(3);
      REQUIRE(run.history->checkpoint(name).ok());
      marked[name] = run.state();
    }
    CHECK(run.history->checkpoints() == 3);
    run.step(4);
    const DenseState last = run.state();
    for (const auto& [name, state] : marked) {
      if (run.dice.next() < 0.5) run.slide();
      REQUIRE(run.history->restore(name).ok());
      CHECK(run.difference_from(state) == "");
    }
    run.history->reset();
    CHECK(run.difference_from(loaded) == "");
    CHECK(run.voxmap.blocks().size() == 0);
    for (std::size_t n = 0; n < 1 + marked.size(); ++n) REQUIRE(run.history->undo());
    CHECK(run.difference_from(last) == "");
  }
}

TEST_CASE("bone history: names and memory that do not do are refused with the reason, and nothing changes") {
  Drilling run(31, {.memory = kLeastHistoryMemory});
  run.step(2);
  const DenseState state = run.state();
  const auto refused = [](const Status& status, ErrorCode code) { return !status.ok() && status.error().code == code; };
  CHECK(refused(run.history->checkpoint(""), ErrorCode::bad_input));
  CHECK(refused(run.history->checkpoint(std::string(BoneHistory::kLongestName + 1, 'x')), ErrorCode::bad_input));
  CHECK(refused(run.history->restore("none"), ErrorCode::bad_input));
  REQUIRE(run.voxmap.place_window({Vec3i(-2), kDims + 2}).ok());
  run.history->begin_step();
  for_each_voxel({Vec3i(0), kDims}, [&](const Vec3i& v) { run.voxmap.remaining()[run.voxmap.window().box.offset_of(v)] = 0.0f; });
  run.voxmap.commit({Vec3i(0), kDims});
  run.history->end_step();
  const std::size_t steps = run.history->steps();
  CHECK(refused(run.history->checkpoint("all of it"), ErrorCode::out_of_range));
  CHECK(run.history->steps() == steps);
  CHECK(run.history->checkpoints() == 0);
  REQUIRE(run.history->undo());
  CHECK(run.difference_from(state) == "");
  run.history->reset();
  for (std::size_t n = 0; n < BoneHistory::kMostCheckpoints; ++n) REQUIRE(run.history->checkpoint("mark " + std::to_string(n)).ok());
  CHECK(refused(run.history->checkpoint("one more"), ErrorCode::out_of_range));
  const auto made = BoneHistory::create(run.voxmap, {.memory = kLeastHistoryMemory - 1});
  CHECK((!made.ok() && made.error().code == ErrorCode::out_of_range));
}

TEST_CASE("bone history: memory stays within its bound and is what bytes() says; the oldest steps go first, and the others still undo") {
  for (const bool preallocate : {false, true}) {
    CAPTURE(preallocate);
    Dice dice{41};
    const BoneHistoryConfig config{.memory = std::size_t{1} << 20, .preallocate = preallocate};
    Drilling run(42, config);
    std::vector<DenseState> begins;
    std::uint64_t made = 0;
    for (int n = 0; n < 60; ++n) {
      begins.push_back(run.state());
      run.step(1 + dice.next_below(8));
      ++made;
      if (n == 20) REQUIRE(run.history->checkpoint("kept").ok());
      if (dice.next() < 0.1) {
        if (!run.history->undo()) continue;
        --made;
        REQUIRE(run.difference_from(begins.back()) == "");
        begins.pop_back();
      }
      REQUIRE(run.history->bytes() <= config.memory);
      REQUIRE(run.history->steps() + run.history->dropped_steps() == made);
    }
    CHECK(run.history->dropped_steps() > 10);
    REQUIRE(run.history->steps() > 1);
    const std::size_t kept = run.history->steps();
    for (std::size_t n = 0; n < kept; ++n) {
      REQUIRE(run.history->undo());
      REQUIRE(run.difference_from(begins[begins.size() - 1 - n]) == "");
    }
    CHECK_FALSE(run.history->undo());
    run.history->begin_step();
    run.voxmap.write_back();
    const std::size_t stated = run.history->bytes(), before = live_bytes;
    run.history.reset();
    CHECK(before - live_bytes == stated + sizeof(BoneHistory));
  }
}

TEST_CASE("bone history: with memory taken at once a step allocates nothing for it") {
  Drilling run(43, {.memory = std::size_t{1} << 20, .preallocate = true});
  const std::size_t stated = run.history->bytes();
  for (int n = 0; n < 30; ++n) run.step(4);
  CHECK(run.history->bytes() == stated);
}

TEST_CASE("bone history: a step larger than the memory is given up and counted, and later ones can be undone again") {
  Drilling run(44, {.memory = kLeastHistoryMemory});
  run.step(2);
  REQUIRE(run.voxmap.place_window({Vec3i(-16), kDims + 16}).ok());
  const auto all_to = [&](float value) {
    for (float& one : run.voxmap.remaining()) one = value;
    run.voxmap.commit(run.voxmap.window().erodible_box());
    run.voxmap.write_back();
  };
  all_to(0.5f);
  run.history->begin_step();
  all_to(0.25f);
  CHECK(run.history->steps() == 0);
  CHECK(run.history->dropped_steps() > 0);
  CHECK_FALSE(run.history->undo());
  const std::uint64_t hash = run.voxmap.hash();
  run.step(2);
  CHECK(run.voxmap.hash() != hash);
  REQUIRE(run.history->undo());
  CHECK(run.voxmap.hash() == hash);
}

TEST_CASE("bone history: sabotage: a block that is not kept is missing after undo") {
  struct Forgetful final : BlockKeeper {
    BoneHistory* history = nullptr;
    int count = 0;
    void keep(const Vec3i& block, const BlockValues* before) override {
      if (count++ != 2) history->keep(block, before);
    }
  } forgetful;
  Drilling run(51);
  run.step(3);
  const DenseState begin = run.state();
  forgetful.history = run.history.get();
  run.voxmap.set_keeper(&forgetful);
  run.history->begin_step();
  REQUIRE(run.voxmap.place_window({Vec3i(-2), kDims + 2}).ok());
  for (int n = 0; n < 8; ++n) run.bite();
  run.history->end_step();
  REQUIRE(forgetful.count > 3);
  run.voxmap.set_keeper(run.history.get());
  REQUIRE(run.history->undo());
  CHECK(run.difference_from(begin) != "");
}
