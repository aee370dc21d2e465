/// core/base/box_list.h: a bounded list of boxes: several tight boxes instead of one bounding box.
///   Box  VoxelBox, or another half-open box of integers with lo, hi, empty, count, intersect, unite, contains.
///   Frame  that of the boxes.   Thread  one.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

/// Appends `box` without `hole`, as at most two boxes an axis that do not overlap. The last axis is cut first: its slabs have the longest
/// rows.
template <class Box>
void append_outside(const Box& box, const Box& hole, std::vector<Box>& out) {
  const Box inner = box.intersect(hole);
  if (inner.empty()) {
    out.push_back(box);
    return;
  }
  Box rest = box;
  for (std::size_t axis = static_cast<std::size_t>(box.lo.length()); axis-- > 0;) {
    Box below = rest, above = rest;
    below.hi[axis] = inner.lo[axis];
    above.lo[axis] = inner.hi[axis];
    for (const Box& part : {below, above})
      if (!part.empty()) out.push_back(part);
    rest.lo[axis] = inner.lo[axis];
    rest.hi[axis] = inner.hi[axis];
  }
}

/// At most kMost boxes, none of them empty. A value: copied freely; add() never allocates.
template <class Box, std::size_t kMost>
class BoxList {
 public:
  static constexpr std::size_t kMax = kMost;

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const Box* begin() const noexcept { return boxes_.data(); }
  [[nodiscard]] const Box* end() const noexcept { return boxes_.data() + count_; }
  [[nodiscard]] std::span<const Box> boxes() const noexcept { return {boxes_.data(), count_}; }
  /// The box round all of them.
  [[nodiscard]] Box bounds() const noexcept {
    Box all;
    for (const Box& box : *this) all = all.unite(box);
    return all;
  }
  /// Sum of the boxes' counts: places in all of them, where they are disjoint.
  [[nodiscard]] auto count() const noexcept {
    decltype(Box{}.count()) sum = 0;
    for (const Box& box : *this) sum += box.count();
    return sum;
  }
  /// Whether one box holds `place`, a voxel or a box.
  template <class Place>
  [[nodiscard]] bool contains(const Place& place) const noexcept {
    return std::ranges::any_of(*this, [&](const Box& box) { return box.contains(place); });
  }
  friend bool operator==(const BoxList& a, const BoxList& b) noexcept { return std::ranges::equal(a.boxes(), b.boxes()); }

  void clear() noexcept { count_ = 0; }
  /// All boxes; none are left.
  [[nodiscard]] BoxList take() noexcept { return std::exchange(*this, {}); }

  /// Covers `box`; boxes may overlap. Merged with a box where their union holds nothing that neither has; when there are too many, the two
  /// whose union wastes least are merged.
  void add(const Box& box) noexcept {
    if (box.empty()) return;
    for (Box& known : std::span(boxes_).first(count_)) {
      if (known.contains(box)) return;
      const Box both = known.unite(box);
      if (both.count() <= known.count() + box.count() - known.intersect(box).count()) {
        known = both;
        return;
      }
    }
    append(box);
    if (count_ > kMost) join_cheapest();
  }

  /// Covers `box`; what other boxes hold of it is left out, so that disjoint boxes stay disjoint. When there are too many, the box round all
  /// of them takes their place. May allocate.
  void add_disjoint(const Box& box) {
    if (box.empty()) return;
    std::vector<Box> fresh{box};
    for (const Box& known : *this) {
      std::vector<Box> outside;
      for (const Box& part : fresh) append_outside(part, known, outside);
      fresh = std::move(outside);
    }
    if (count_ + fresh.size() <= kMost) {
      for (const Box& part : fresh) append(part);
      return;
    }
    const Box all = bounds().unite(box);
    clear();
    append(all);
  }

  /// As it is, at the end. The caller sees to it that it is not empty and that there is room: kMost boxes, and one more in passing.
  void append(const Box& box) noexcept {
    BH_ASSERT(!box.empty() && count_ < boxes_.size());
    boxes_[count_++] = box;
  }
  void erase(std::size_t n) noexcept {
    BH_ASSERT(n < count_);
    std::move(boxes_.begin() + static_cast<std::ptrdiff_t>(n) + 1, boxes_.begin() + static_cast<std::ptrdiff_t>(count_),
              boxes_.begin() + static_cast<std::ptrdiff_t>(n));
    --count_;
  }
  /// Puts `box` before all others; room as for append().
  void prepend(const Box& box) noexcept {
    append(box);
    std::rotate(boxes_.begin(), boxes_.begin() + static_cast<std::ptrdiff_t>(count_) - 1,
                boxes_.begin() + static_cast<std::ptrdiff_t>(count_));
  }

 private:
  void join_cheapest() noexcept {
    std::size_t best_a = 0, best_b = 1;
    auto best_waste = std::numeric_limits<decltype(Box{}.count())>::max();
    for (std::size_t a = 0; a < count_; ++a)
      for (std::size_t b = a + 1; b < count_; ++b) {
        const auto joined = boxes_[a].unite(boxes_[b]).count(), apart = boxes_[a].count() + boxes_[b].count();
        const auto waste = joined > apart ? joined - apart : 0;
        if (waste < best_waste) {
          best_waste = waste;
          best_a = a;
          best_b = b;
        }
      }
    boxes_[best_a] = boxes_[best_a].unite(boxes_[best_b]);
    erase(best_b);
  }

  std::array<Box, kMost + 1> boxes_{};
  std::size_t count_ = 0;
};

/// What a step has changed, or what a copy of it has missed.
using VoxelBoxes = BoxList<VoxelBox, 16>;

}  // namespace burrhole
