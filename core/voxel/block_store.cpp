#include "core/voxel/block_store.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/window_size.h"

namespace burrhole {
namespace {

// Blocks of the largest window, which may begin and end within blocks: 65 x 65 x 10 or fewer.
constexpr std::size_t kMostBlocks = kMaxWindowVoxels / kBlockVoxels * 2;

template <class Entries>
auto place_of(Entries& entries, std::uint64_t key) noexcept {
  return std::lower_bound(entries.begin(), entries.end(), key, [](const BlockEntry& entry, std::uint64_t k) { return entry.key < k; });
}

}  // namespace

void BlockPool::reserve(std::size_t blocks) {
  while (capacity() < blocks) {
    const std::size_t first = capacity();
    free_.reserve(first + kChunk);
    chunks_.push_back(std::make_unique<BlockValues[]>(kChunk));
    for (std::size_t n = kChunk; n > 0; --n) free_.push_back(static_cast<Index>(first + n - 1));
  }
}

BlockPool::Index BlockPool::take() {
  if (free_.empty()) reserve(capacity() + 1);
  const Index out = free_.back();
  free_.pop_back();
  return out;
}

std::size_t BlockPool::bytes() const noexcept {
  return capacity() * sizeof(BlockValues) + chunks_.capacity() * sizeof(chunks_[0]) + free_.capacity() * sizeof(Index);
}

void BlockStore::reserve(std::size_t blocks) {
  pool_.reserve(blocks);
  entries_.reserve(blocks);
}

const BlockValues* BlockStore::find(const Vec3i& block) const noexcept {
  const std::uint64_t key = key_of_block(block);
  const auto place = place_of(entries_, key);
  return place == entries_.end() || place->key != key ? nullptr : &pool_[place->index];
}

void BlockStore::put(const Vec3i& block, const BlockValues& values) {
  BH_ASSERT(block_of_key(key_of_block(block)) == block);
  const std::uint64_t key = key_of_block(block);
  auto place = place_of(entries_, key);
  if (place == entries_.end() || place->key != key) place = entries_.insert(place, BlockEntry{key, pool_.take()});
  pool_[place->index] = values;
}

void BlockStore::erase(const Vec3i& block) noexcept {
  const std::uint64_t key = key_of_block(block);
  const auto place = place_of(entries_, key);
  if (place == entries_.end() || place->key != key) return;
  pool_.give_back(place->index);
  entries_.erase(place);
}

void BlockStore::clear() noexcept {
  for (const BlockEntry& entry : entries_) pool_.give_back(entry.index);
  entries_.clear();
}

void BlockStore::read_box(const VoxelBox& box, std::span<float> out) const noexcept {
  BH_ASSERT(out.size() == box.count());
  std::ranges::fill(out, 1.0f);
  const VoxelBox wanted = blocks_of(box);
  if (entries_.empty() || wanted.empty()) return;
  // Rows of blocks along i are contiguous in the list.
  for (int k = wanted.lo.z; k < wanted.hi.z; ++k)
    for (int j = wanted.lo.y; j < wanted.hi.y; ++j) {
      const std::uint64_t end = key_of_block({wanted.hi.x, j, k});
      for (auto entry = place_of(entries_, key_of_block({wanted.lo.x, j, k})); entry != entries_.end() && entry->key < end; ++entry) {
        const VoxelBox block = box_of_block(block_of_key(entry->key));
        copy_part(box.intersect(block), block, pool_[entry->index].data(), box, out.data());
      }
    }
}

VoxelBox BlockStore::layer_at(std::size_t& first) const noexcept {
  const int k = block_of_key(entries_[first].key).z;
  VoxelBox blocks;
  for (; first < entries_.size() && block_of_key(entries_[first].key).z == k; ++first) blocks.include(block_of_key(entries_[first].key));
  return {blocks.lo * kBlockEdge, blocks.hi * kBlockEdge};
}

VoxelBox BlockStore::changed_bounds() const noexcept {
  VoxelBox out;
  for_each_block([&](const Vec3i& block, const BlockValues& values) {
    const VoxelBox box = box_of_block(block);
    if (!out.empty() && out.contains(box)) return;
    std::size_t n = 0;
    for_each_voxel(box, [&](const Vec3i& v) {
      if (values[n++] != 1.0f) out.include(v);
    });
  });
  return out;
}

void BlockMarks::reset(const VoxelBox& window) {
  bits_.reserve((kMostBlocks + 63) / 64);
  blocks_ = blocks_of(window);
  bits_.assign((blocks_.count() + 63) / 64, 0);
  count_ = 0;
}

void BlockMarks::mark(const VoxelBox& box) noexcept {
  for_each_voxel(blocks_of(box).intersect(blocks_), [&](const Vec3i& block) {
    const std::size_t n = blocks_.offset_of(block);
    std::uint64_t& word = bits_[n / 64];
    const std::uint64_t bit = std::uint64_t{1} << (n % 64);
    count_ += (word & bit) == 0 ? 1 : 0;
    word |= bit;
  });
}

Vec3i BlockMarks::block_at(std::size_t n) const noexcept {
  const Vec3i size = blocks_.size();
  const auto x = static_cast<std::size_t>(size.x), y = static_cast<std::size_t>(size.y);
  return blocks_.lo + Vec3i(static_cast<int>(n % x), static_cast<int>(n / x % y), static_cast<int>(n / (x * y)));
}

}  // namespace burrhole
