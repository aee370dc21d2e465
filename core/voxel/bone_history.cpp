#include "core/voxel/bone_history.h"

#include <algorithm>
#include <limits>

#include "core/base/assert.h"

namespace burrhole {
namespace {

/// In place of a pool index: the block was as loaded.
constexpr BlockPool::Index kWasAsLoaded = std::numeric_limits<BlockPool::Index>::max();

struct Limits {
  std::size_t entries, blocks;
};

/// An eighth of the memory for the lists of blocks, what is left for their values, each with its place in a checkpoint's list and in the
/// pool's own.
Limits limits_of(std::size_t memory) {
  constexpr std::size_t kFixed = BoneHistory::kMostSteps * sizeof(std::size_t) + BoneHistory::kMostCheckpoints * 256;
  constexpr std::size_t kPerBlock = sizeof(BlockValues) + sizeof(BlockEntry) + 2 * sizeof(BlockPool::Index);
  constexpr std::size_t kPerChunk = BlockPool::kChunk * kPerBlock + 2 * sizeof(void*);
  return {memory / 8 / sizeof(BlockEntry), (memory - memory / 8 - kFixed) / kPerChunk * BlockPool::kChunk};
}

}  // namespace

Result<std::unique_ptr<BoneHistory>> BoneHistory::create(Voxmap& voxmap, const BoneHistoryConfig& config) {
  if (config.memory < kLeastHistoryMemory)
    return Error{ErrorCode::out_of_range,
                 "a history of " + std::to_string(config.memory) + " bytes holds too little; at least " +
                     std::to_string(kLeastHistoryMemory) + " are needed",
                 {}};
  const Limits limits = limits_of(config.memory);
  std::unique_ptr<BoneHistory> out(new BoneHistory(voxmap, limits.entries, limits.blocks));
  if (config.preallocate) out->pool_.reserve(limits.blocks);
  return out;
}

BoneHistory::BoneHistory(Voxmap& voxmap, std::size_t most_entries, std::size_t most_blocks)
    : voxmap_(&voxmap), most_entries_(most_entries), most_blocks_(most_blocks) {
  kept_.reserve(most_entries_);
  steps_.reserve(kMostSteps);
  checkpoints_.reserve(kMostCheckpoints);
  voxmap_->write_back();
  voxmap_->set_keeper(this);
}

BoneHistory::~BoneHistory() { voxmap_->set_keeper(nullptr); }

void BoneHistory::begin_step() {
  voxmap_->write_back();
  if (steps_.size() == kMostSteps && steps_.back() != kept_.size()) static_cast<void>(drop_oldest());
  if (steps_.empty() || steps_.back() != kept_.size()) steps_.push_back(kept_.size());
  open_ = true;
}

void BoneHistory::end_step() {
  voxmap_->write_back();
  open_ = false;
}

std::size_t BoneHistory::steps() const noexcept { return steps_.size() - (!steps_.empty() && steps_.back() == kept_.size() ? 1 : 0); }

bool BoneHistory::drop_oldest() noexcept {
  if (steps_.empty()) return false;
  const std::size_t end = steps_.size() > 1 ? steps_[1] : kept_.size();
  for (std::size_t n = 0; n < end; ++n)
    if (kept_[n].index != kWasAsLoaded) pool_.give_back(kept_[n].index);
  kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(end));
  steps_.erase(steps_.begin());
  for (std::size_t& first : steps_) first -= end;
  dropped_ += end > 0 ? 1 : 0;
  return true;
}

/// @returns whether the last step still exists.
bool BoneHistory::make_room(bool with_values) noexcept {
  while (kept_.size() == most_entries_ || (with_values && pool_.in_use() == most_blocks_))
    if (!drop_oldest()) return false;
  return !steps_.empty();
}

void BoneHistory::keep(const Vec3i& block, const BlockValues* before) {
  if (undoing_ || steps_.empty()) return;
  const std::uint64_t key = key_of_block(block);
  const auto place_of = [&] {
    return std::lower_bound(kept_.begin() + static_cast<std::ptrdiff_t>(steps_.back()), kept_.end(), key,
                            [](const BlockEntry& entry, std::uint64_t k) { return entry.key < k; });
  };
  if (const auto known = place_of(); known != kept_.end() && known->key == key) return;
  if (!make_room(before != nullptr)) return;
  BlockEntry entry{key, kWasAsLoaded};
  if (before != nullptr) {
    entry.index = pool_.take();
    pool_[entry.index] = *before;
  }
  kept_.insert(place_of(), entry);
}

/// The blocks take the values of the list. What changes is not kept: the caller has done so, or forgets the step.
void BoneHistory::bring_back(const std::vector<BlockEntry>& blocks) {
  std::vector<BlockChange> changes;
  changes.reserve(blocks.size());
  for (const BlockEntry& entry : blocks)
    changes.push_back({block_of_key(entry.key), entry.index == kWasAsLoaded ? nullptr : &pool_[entry.index]});
  voxmap_->put_blocks(changes);
}

void BoneHistory::release(std::vector<BlockEntry>& blocks) noexcept {
  for (const BlockEntry& entry : blocks)
    if (entry.index != kWasAsLoaded) pool_.give_back(entry.index);
  blocks.clear();
}

bool BoneHistory::undo() {
  end_step();
  while (!steps_.empty() && steps_.back() == kept_.size()) steps_.pop_back();
  if (steps_.empty()) return false;
  const auto first = kept_.begin() + static_cast<std::ptrdiff_t>(steps_.back());
  std::vector<BlockEntry> last(first, kept_.end());
  undoing_ = true;
  bring_back(last);
  undoing_ = false;
  kept_.erase(first, kept_.end());
  steps_.pop_back();
  release(last);
  return true;
}

Status BoneHistory::checkpoint(std::string_view name) {
  if (name.empty() || name.size() > kLongestName)
    return bad_input("a checkpoint's name must have 1 to " + std::to_string(kLongestName) + " characters");
  voxmap_->write_back();
  const auto same = std::ranges::find(checkpoints_, name, &Checkpoint::name);
  if (same == checkpoints_.end() && checkpoints_.size() == kMostCheckpoints)
    return Error{
        ErrorCode::out_of_range, "there are " + std::to_string(kMostCheckpoints) + " checkpoints already, as many as are kept", {}};
  std::size_t of_others = 0;
  for (const Checkpoint& one : checkpoints_) of_others += one.name == name ? 0 : one.blocks.size();
  const std::size_t needed = voxmap_->blocks().size();
  if (of_others + needed > most_blocks_)
    return Error{ErrorCode::out_of_range,
                 "a checkpoint of " + std::to_string(needed) + " blocks does not fit: " + std::to_string(most_blocks_ - of_others) +
                     " of " + std::to_string(most_blocks_) + " are left for it",
                 {}};
  if (same != checkpoints_.end()) {
    release(same->blocks);
    checkpoints_.erase(same);
  }
  while (most_blocks_ - pool_.in_use() < needed && !kept_.empty() && drop_oldest()) continue;
  Checkpoint fresh{std::string(name), {}};
  fresh.blocks.reserve(needed);
  voxmap_->blocks().for_each_block([&](const Vec3i& block, const BlockValues& values) {
    fresh.blocks.push_back({key_of_block(block), pool_.take()});
    pool_[fresh.blocks.back().index] = values;
  });
  checkpoints_.push_back(std::move(fresh));
  return {};
}

Status BoneHistory::restore(std::string_view name) {
  const auto found = std::ranges::find(checkpoints_, name, &Checkpoint::name);
  if (found == checkpoints_.end()) return bad_input("there is no checkpoint named \"" + std::string(name) + "\"");
  begin_step();
  std::vector<BlockEntry> wanted = found->blocks;
  voxmap_->blocks().for_each_block([&](const Vec3i& block, const BlockValues&) {
    const std::uint64_t key = key_of_block(block);
    const auto place = std::ranges::lower_bound(found->blocks, key, {}, &BlockEntry::key);
    if (place == found->blocks.end() || place->key != key) wanted.push_back({key, kWasAsLoaded});
  });
  bring_back(wanted);
  end_step();
  return {};
}

void BoneHistory::reset() {
  begin_step();
  const BlockStore* const loaded = voxmap_->bone().drilled();
  std::vector<BlockChange> changes;
  voxmap_->blocks().for_each_block([&](const Vec3i& block, const BlockValues&) {
    if (loaded == nullptr || loaded->find(block) == nullptr) changes.push_back({block, nullptr});
  });
  if (loaded != nullptr)
    loaded->for_each_block([&](const Vec3i& block, const BlockValues& values) { changes.push_back({block, &values}); });
  voxmap_->put_blocks(changes);
  end_step();
}

std::size_t BoneHistory::bytes() const noexcept {
  std::size_t sum = pool_.bytes() + kept_.capacity() * sizeof(BlockEntry) + steps_.capacity() * sizeof(std::size_t) +
                    checkpoints_.capacity() * sizeof(Checkpoint);
  for (const Checkpoint& one : checkpoints_) {
    sum += one.blocks.capacity() * sizeof(BlockEntry);
    if (one.name.capacity() > std::string().capacity()) sum += one.name.capacity() + 1;
  }
  return sum;
}

}  // namespace burrhole
