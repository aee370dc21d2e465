#include "core/voxel/tile_marks.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <tuple>

namespace burrhole {
namespace {

constexpr std::size_t kMostBricks = 64;  // bounds the search for the cheapest pair

/// Voxels whose gradient a box makes new, and so what it costs.
std::ptrdiff_t cost_of(const VoxelBox& box) { return static_cast<std::ptrdiff_t>(box.grown(1).count()); }

bool overlap(const VoxelBox& a, const VoxelBox& b) { return !a.intersect(b).empty(); }

}  // namespace

void TileMarks::reset(const VoxelBox& window) {
  const glm::uvec3 tiles((window.size() + (kEdge - 1)) / kEdge);
  if (tiles == tiles_) {
    for (const std::uint32_t index : touched_) marks_[index] = {};
  } else {
    tiles_ = tiles;
    marks_.assign(std::size_t{tiles.x} * tiles.y * tiles.z, {});
  }
  window_ = window;
  touched_.clear();
}

VoxelBox TileMarks::tight_box(std::uint32_t index) const {
  const Tile& tile = marks_[index];
  const Vec3i corner = window_.lo + kEdge * Vec3i(static_cast<int>(index % tiles_.x), static_cast<int>(index / tiles_.x % tiles_.y),
                                                  static_cast<int>(index / (tiles_.x * tiles_.y)));
  const Vec3i lo(std::countr_zero(tile.x), std::countr_zero(tile.y), std::countr_zero(tile.z));
  const Vec3i hi(std::bit_width(tile.x), std::bit_width(tile.y), std::bit_width(tile.z));
  return {corner + lo, corner + hi};
}

/// Joins bricks that follow each other along the axis and are alike across it.
void TileMarks::join_rows(std::size_t axis) {
  const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
  const auto key = [&](const Brick& k) { return std::tuple(k.lo[c], k.lo[b], k.hi[c], k.hi[b], k.lo[axis]); };
  std::ranges::sort(bricks_, [&](const Brick& p, const Brick& q) { return key(p) < key(q); });
  std::size_t kept = 0;
  for (std::size_t n = 1; n < bricks_.size(); ++n) {
    Brick& last = bricks_[kept];
    const Brick& next = bricks_[n];
    if (last.lo[b] == next.lo[b] && last.hi[b] == next.hi[b] && last.lo[c] == next.lo[c] && last.hi[c] == next.hi[c] &&
        last.hi[axis] == next.lo[axis]) {
      last.hi[axis] = next.hi[axis];
      last.tight = last.tight.unite(next.tight);
    } else {
      bricks_[++kept] = next;
    }
  }
  bricks_.resize(kept + 1);
}

/// Bricks of twice the edge, from bricks of one tile each.
void TileMarks::coarsen() {
  for (Brick& brick : bricks_) {
    brick.lo /= 2;
    brick.hi = brick.lo + 1;
  }
  const auto place = [](const Brick& k) { return std::tuple(k.lo.z, k.lo.y, k.lo.x); };
  std::ranges::sort(bricks_, [&](const Brick& p, const Brick& q) { return place(p) < place(q); });
  std::size_t kept = 0;
  for (std::size_t n = 1; n < bricks_.size(); ++n) {
    if (bricks_[kept].lo == bricks_[n].lo)
      bricks_[kept].tight = bricks_[kept].tight.unite(bricks_[n].tight);
    else
      bricks_[++kept] = bricks_[n];
  }
  bricks_.resize(kept + 1);
}

/// Joins brick b to a, then every brick that the joined box meets, so that all stay disjoint.
void TileMarks::absorb(std::size_t a, std::size_t b) {
  bricks_[a].tight = bricks_[a].tight.unite(bricks_[b].tight);
  bricks_.erase(bricks_.begin() + static_cast<std::ptrdiff_t>(b));
  if (b < a) --a;
  for (std::size_t n = 0; n < bricks_.size();) {
    if (n == a || !overlap(bricks_[a].tight, bricks_[n].tight)) {
      ++n;
      continue;
    }
    bricks_[a].tight = bricks_[a].tight.unite(bricks_[n].tight);
    bricks_.erase(bricks_.begin() + static_cast<std::ptrdiff_t>(n));
    if (n < a) --a;
    n = 0;
  }
}

void TileMarks::join_cheapest() {
  while (bricks_.size() > 1) {
    std::size_t best_a = 0, best_b = 1;
    std::ptrdiff_t least = std::numeric_limits<std::ptrdiff_t>::max();
    for (std::size_t a = 0; a < bricks_.size(); ++a)
      for (std::size_t b = a + 1; b < bricks_.size(); ++b) {
        const VoxelBox &p = bricks_[a].tight, &q = bricks_[b].tight;
        const std::ptrdiff_t more = cost_of(p.unite(q)) - cost_of(p) - cost_of(q);
        if (more < least) {
          least = more;
          best_a = a;
          best_b = b;
        }
      }
    if (least > 0 && bricks_.size() <= VoxelBoxes::kMax) return;
    absorb(best_a, best_b);
  }
}

VoxelBoxes TileMarks::boxes() {
  VoxelBoxes out;
  if (touched_.empty()) return out;
  bricks_.clear();
  for (const std::uint32_t index : touched_) {
    const Vec3i at(static_cast<int>(index % tiles_.x), static_cast<int>(index / tiles_.x % tiles_.y),
                   static_cast<int>(index / (tiles_.x * tiles_.y)));
    bricks_.push_back({at, at + 1, tight_box(index)});
  }
  std::ranges::sort(bricks_,
                    [](const Brick& p, const Brick& q) { return std::tuple(p.lo.z, p.lo.y, p.lo.x) < std::tuple(q.lo.z, q.lo.y, q.lo.x); });
  std::vector<Brick> single;
  if (bricks_.size() > kMostBricks) single = bricks_;
  for (std::size_t axis = 0; axis < 3; ++axis) join_rows(axis);
  while (bricks_.size() > kMostBricks) {
    bricks_ = single;
    coarsen();
    single = bricks_;
    for (std::size_t axis = 0; axis < 3; ++axis) join_rows(axis);
  }
  join_cheapest();
  std::ranges::sort(bricks_, [](const Brick& p, const Brick& q) {
    return std::tuple(p.tight.lo.z, p.tight.lo.y, p.tight.lo.x) < std::tuple(q.tight.lo.z, q.tight.lo.y, q.tight.lo.x);
  });
  for (const Brick& brick : bricks_) out.append(brick.tight);
  return out;
}

}  // namespace burrhole
