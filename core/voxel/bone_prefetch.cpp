#include "core/voxel/bone_prefetch.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"

namespace burrhole {

BonePrefetch::BonePrefetch(const BoneModel& bone, bool with_labels)
    : bone_(&bone), with_labels_(with_labels), slots_(kWays * kSets), labels_read_(kBlockVoxels) {
  bytes_.store(slots_.size() * sizeof(Slot), std::memory_order_relaxed);
}
BonePrefetch::~BonePrefetch() = default;

void BonePrefetch::aim(const VoxelBox& window) noexcept {
  if (window == last_aim_.window) return;
  const VoxelBox before = last_aim_.window;
  last_aim_ = {window, before.empty() ? Vec3i(0) : (window.lo + window.hi) - (before.lo + before.hi), last_aim_.number + 1};
  aim_.publish(last_aim_);
}

BonePrefetch::Slot* BonePrefetch::set_of(std::uint64_t key) noexcept {
  // Fibonacci hashing: neighbours along each axis spread over the sets.
  return &slots_[kWays * static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ull) >> (64 - 13))];
}

template <class F>
bool BonePrefetch::read_slot(const Vec3i& block, F&& f) noexcept {
  const std::uint64_t key = key_of_block(block);
  Slot* const set = set_of(key);
  for (std::size_t way = 0; way < kWays; ++way) {
    Slot& slot = set[way];
    if (slot.key.load(std::memory_order_relaxed) != key) continue;
    State expected = State::ready;
    if (!slot.state.compare_exchange_strong(expected, State::reading, std::memory_order_acquire)) continue;
    const bool same = slot.key.load(std::memory_order_relaxed) == key;
    if (same) f(*slot.loaded);
    slot.state.store(State::ready, std::memory_order_release);
    if (!same) continue;
    hits_.store(hits() + 1, std::memory_order_relaxed);
    return true;
  }
  misses_.store(misses() + 1, std::memory_order_relaxed);
  return false;
}

bool BonePrefetch::copy(const VoxelBox& part, const VoxelBox& to, float* occupancy, float* hardness) noexcept {
  const Vec3i block = block_of(part.lo);
  const VoxelBox box = box_of_block(block);
  BH_ASSERT(box.contains(part));
  return read_slot(block, [&](const Loaded& loaded) {
    copy_part(part, box, loaded.occupancy.data(), to, occupancy);
    copy_part(part, box, loaded.hardness.data(), to, hardness);
  });
}

bool BonePrefetch::copy_labels(const VoxelBox& part, const VoxelBox& to, float* labels) noexcept {
  const Vec3i block = block_of(part.lo);
  const VoxelBox box = box_of_block(block);
  BH_ASSERT(box.contains(part) && with_labels_);
  return read_slot(block, [&](const Loaded& loaded) {
    for_each_voxel(part, [&](const Vec3i& v) { labels[to.offset_of(v)] = static_cast<float>(loaded.labels[box.offset_of(v)]); });
  });
}

/// Blocks that a slide may need: not those wholly inside the window, whose outermost layer is read again for labels.
bool BonePrefetch::wanted(const Vec3i& block) const noexcept {
  const VoxelBox box = box_of_block(block);
  return !box.intersect(shell_).empty() && !known_.contains(box);
}

bool BonePrefetch::present(std::uint64_t key) noexcept {
  Slot* const set = set_of(key);
  return std::any_of(set, set + kWays, [&](const Slot& slot) {
    return slot.state.load(std::memory_order_relaxed) != State::empty && slot.key.load(std::memory_order_relaxed) == key;
  });
}

/// Drops the blocks that are not wanted any more and lists those that are missing.
void BonePrefetch::follow(const Aim& aim) {
  followed_ = aim.number;
  known_ = aim.window.grown(-1);
  shell_ = aim.window.grown(kAhead);
  for (const std::size_t axis : {0, 1, 2}) {
    if (aim.moved[axis] < 0) shell_.lo[axis] -= kAhead;
    if (aim.moved[axis] > 0) shell_.hi[axis] += kAhead;
  }
  std::erase_if(filled_, [&](std::size_t n) {
    Slot& slot = slots_[n];
    if (wanted(block_of_key(slot.key.load(std::memory_order_relaxed)))) return false;
    State expected = State::ready;
    if (!slot.state.compare_exchange_strong(expected, State::empty, std::memory_order_acquire)) return false;  // being read: next time
    spare_.push_back(std::move(slot.loaded));
    return true;
  });
  missing_.clear();
  for_each_voxel(blocks_of(shell_), [&](const Vec3i& block) {
    if (wanted(block) && !present(key_of_block(block))) missing_.push_back(block);
  });
}

void BonePrefetch::load(const Vec3i& block) {
  const std::uint64_t key = key_of_block(block);
  Slot* const set = set_of(key);
  Slot* const free = std::find_if(set, set + kWays, [](const Slot& s) { return s.state.load(std::memory_order_relaxed) == State::empty; });
  if (free == set + kWays) return;  // a full set: the owner reads this block itself
  std::unique_ptr<Loaded> loaded;
  if (spare_.empty()) {
    loaded = std::make_unique<Loaded>();
    bytes_.store(bytes() + sizeof(Loaded), std::memory_order_relaxed);
  } else {
    loaded = std::move(spare_.back());
    spare_.pop_back();
  }
  const VoxelBox box = box_of_block(block);
  bone_->read_occupancy(box, loaded->occupancy);
  bone_->read_hardness(box, loaded->hardness);
  if (with_labels_) {
    bone_->read_labels(box, labels_read_);
    std::ranges::transform(labels_read_, loaded->labels.begin(), [](float label) { return static_cast<std::uint8_t>(label); });
  }
  filled_.push_back(static_cast<std::size_t>(free - slots_.data()));
  free->loaded = std::move(loaded);
  free->key.store(key, std::memory_order_relaxed);
  free->state.store(State::ready, std::memory_order_release);
}

std::size_t BonePrefetch::fill(std::size_t most) {
  if (const Aim& aim = aim_.latest(); aim.number != followed_) follow(aim);
  std::size_t count = 0;
  for (; count < most && !missing_.empty(); ++count) {
    load(missing_.back());
    missing_.pop_back();
  }
  return count;
}

}  // namespace burrhole
