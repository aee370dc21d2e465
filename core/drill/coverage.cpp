#include "core/drill/coverage.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/drill/coverage_kernels.h"
#include "core/drill/field_sampler.h"

namespace burrhole {
namespace {

constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr int kTraceSteps = 32;         // along one sub-step; the least stride is its length over this
constexpr float kLeastDip = 0.01f;      // of a voxel or so
constexpr double kSlackPitches = 0.25;  // interpolated distances may grow a little faster than the way

Affine nodes_from_index(const CuttingField& field, const Affine& index_from_tool) {
  return Affine::scaling(1.0 / field.pitch, -field.origin / field.pitch) * index_from_tool.inverse();
}

Vec3 corner_of(const Vec3& lo, const Vec3& hi, int n) {
  return {(n & 1) != 0 ? hi.x : lo.x, (n & 2) != 0 ? hi.y : lo.y, (n & 4) != 0 ? hi.z : lo.z};
}

float share_of(std::uint64_t mask) { return static_cast<float>(std::popcount(mask)) / static_cast<float>(kCoverageSamples); }

}  // namespace

/// One sub-step, seen from the table.
struct Coverage::Sweep {
  explicit Sweep(const CuttingField& table) : field(table) {}
  FieldSampler field;
  VoxelBox box;                                       ///< all that the tool can reach
  VoxelBox allowed;                                   ///< of it, what may be eroded
  Affine middle;                                      ///< nodes from index, in the middle of the sub-step
  Affine half;                                        ///< from there to its end
  std::array<float, kCoverageSamples> x{}, y{}, z{};  ///< [nodes] offsets of samples
  std::array<Vec3f, 3> span{};                        ///< [nodes] half the edges of the box that they fill
  std::array<float, kCoverageSamples> far{};          ///< [m] of a sample from the centre
  /// Whether a place that moves from q - half to q + half meets the tool. Strides of the distance itself pass nothing by.
  [[nodiscard]] bool met_on_the_way(const Vec3f& q, const Vec3f& half_step) const noexcept {
    const float least = 2.0f / static_cast<float>(kTraceSteps), half_length = static_cast<float>(pitch) * glm::length(half_step);
    float t = -1.0f;
    for (int n = 0; n <= kTraceSteps && t < 1.0f; ++n) {
      const float d = field.distance(q + t * half_step);
      if (d <= 0.0f) return true;
      t += std::max(least, d / half_length);
    }
    return false;
  }
  Vec3f end{0.0f};        ///< [nodes] last node of each axis
  double pitch = 0.0;     ///< [m] of a node
  double reach = 0.0;     ///< [m] largest of far
  double half_way = 0.0;  ///< [m] bound on half the way of any place in the box
  double ramp = 0.0;      ///< [m] w
  double cell = 0.0;      ///< [m] half the diagonal of a block
};

/// One voxel in it.
struct Coverage::Probe {
  Vec3i voxel;
  std::size_t at, in_block;
  Vec3f q;         ///< [nodes] the centre, in the middle of the sub-step
  Vec3f half;      ///< [nodes] half its way
  float distance;  ///< [m] there
};

Coverage::Coverage(std::shared_ptr<const CuttingField> field, CoverageKernel kernel)
    : field_(std::move(field)), samples_(make_coverage_samples(kernel)) {
  const double nodes = field_->empty() ? 0.0 : field_->margin / field_->pitch;
  down_ = bends_of(*field_, -1.0, static_cast<int>(std::ceil(nodes)));
  up_ = bends_of(*field_, 1.0, 1);
}

std::uint64_t Coverage::key_of(const Vec3i& block) noexcept {
  const auto part = [](int n) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(n)) & 0x1fffffu; };
  return part(block.x) | part(block.y) << 21 | part(block.z) << 42;
}

Coverage::Sweep Coverage::sweep_of(const Voxmap& voxmap, const ErosionPath& path) const {
  Sweep sweep(*field_);
  const Affine from = nodes_from_index(*field_, path.from), to = nodes_from_index(*field_, path.to);
  sweep.middle = {0.5 * (from.linear + to.linear), 0.5 * (from.offset + to.offset)};
  sweep.half = {0.5 * (to.linear - from.linear), 0.5 * (to.offset - from.offset)};
  sweep.pitch = field_->pitch;
  sweep.end = Vec3f(field_->dims - 1);
  const Mat3& cell = voxmap.bone().bone_from_index().linear;
  for (std::size_t n = 0; n < kCoverageSamples; ++n) {
    const Vec3 offset(samples_.offset[n]);
    const Vec3f in_nodes(sweep.middle.linear * offset);
    sweep.x[n] = in_nodes.x;
    sweep.y[n] = in_nodes.y;
    sweep.z[n] = in_nodes.z;
    sweep.far[n] = static_cast<float>(glm::length(cell * offset));
    sweep.reach = std::max(sweep.reach, static_cast<double>(sweep.far[n]));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) sweep.span[axis] = Vec3f(samples_.reach * sweep.middle.linear[axis]);
  Vec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (int n = 0; n < 8; ++n)
    for (const Affine* pose : {&path.from, &path.to}) {
      const Vec3 p = *pose * corner_of(field_->bounds.lo, field_->bounds.hi, n);
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
  const double wide = samples_.reach + 0.1;  // a turn inside a sub-step bulges by far less
  lo -= wide;
  hi += wide;
  // Far outside the window numbers need not fit an int.
  const VoxelBox& window = voxmap.window().box;
  const Vec3 low(window.lo - 2), high(window.hi + 2);
  sweep.box = {Vec3i(glm::ceil(glm::clamp(lo, low, high))), Vec3i(glm::floor(glm::clamp(hi, low, high))) + 1};
  sweep.allowed = sweep.box.intersect(voxmap.window().erodible_box());
  for (int n = 0; n < 8; ++n) sweep.half_way = std::max(sweep.half_way, sweep.pitch * glm::length(sweep.half * corner_of(lo, hi, n)));
  const Affine& bone = voxmap.bone().bone_from_index();
  sweep.ramp = std::sqrt(3.0 * samples_.variance) * bone.mean_edge();
  for (int n = 0; n < 4; ++n)
    sweep.cell = std::max(sweep.cell, 0.5 * glm::length(cell * (corner_of(Vec3(-1.0), Vec3(1.0), n) * (kEdge - 1.0))));
  return sweep;
}

std::uint32_t Coverage::advance(const Voxmap& voxmap, const ErosionPath& path, std::vector<Engaged>& engaged) {
  if (voxmap.growth_epoch() != growth_epoch_) {
    blocks_.clear();
    growth_epoch_ = voxmap.growth_epoch();
  }
  if (field_->empty()) return 0;
  const Sweep sweep = sweep_of(voxmap, path);
  const auto block_of = [](const Vec3i& v) { return Vec3i(v.x >> 3, v.y >> 3, v.z >> 3); };
  if (!sweep.allowed.empty())
    for_each_voxel({block_of(sweep.allowed.lo), block_of(sweep.allowed.hi - 1) + 1},
                   [&](const Vec3i& block) { visit_block(voxmap, sweep, block, engaged); });
  std::uint32_t outside = 0;
  if (!(sweep.allowed == sweep.box))
    for_each_voxel(sweep.box, [&](const Vec3i& v) {
      if (sweep.allowed.contains(v)) return;
      const float d = sweep.field.distance(Vec3f(sweep.middle * Vec3(v)));
      outside += static_cast<double>(d) < sweep.half_way ? 1 : 0;
    });
  return outside;
}

void Coverage::visit_block(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& block, std::vector<Engaged>& engaged) {
  const Vec3i corner = block * kEdge;
  const double away = static_cast<double>(sweep.field.distance(Vec3f(sweep.middle * (Vec3(corner) + 0.5 * (kEdge - 1)))));
  const double limit = sweep.reach + sweep.half_way + kSlackPitches * sweep.pitch;
  if (away > limit + sweep.cell) return;
  const MasterWindow& window = voxmap.window();
  const VoxelBox part = VoxelBox{corner, corner + kEdge}.intersect(sweep.allowed);
  Block* marks = nullptr;
  bool found = false;
  std::unique_ptr<Block> wholly;  // read only, when the block keeps no masks
  const auto take = [&](const Vec3i& v, std::size_t at, const Vec3f& q, float d) {
    if (!found) {
      auto [place, fresh] = blocks_.try_emplace(key_of(block));
      if (fresh) place->second = std::make_unique<Block>();
      marks = place->second.get();
      if (marks == nullptr) {
        wholly = std::make_unique<Block>();
        wholly->masks.fill(kAll);
        wholly->known.set();
        marks = wholly.get();
      }
      found = true;
    }
    const Vec3i in = v - corner;
    const auto in_block = static_cast<std::size_t>((in.z * kEdge + in.y) * kEdge + in.x);
    visit(window, sweep, {v, at, in_block, q, Vec3f(sweep.half * Vec3(v)), d}, *marks, engaged);
  };
  const auto distance_at = [&](const Vec3& v) { return sweep.field.distance(Vec3f(sweep.middle * v)); };
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& eighth) {
    constexpr int kHalf = kEdge / 2;
    const Vec3i start = corner + kHalf * eighth;
    // The same question of a cube of 4^3 voxels: three sevenths of the block's diagonal.
    if (static_cast<double>(distance_at(Vec3(start) + 0.5 * (kHalf - 1))) > limit + 3.0 / 7.0 * sweep.cell) return;
    for_each_voxel(part.intersect({start, start + kHalf}), [&](const Vec3i& v) {
      const std::size_t at = window.box.offset_of(v);
      if (window.density[at] == 0.0f || window.remaining[at] == 0.0f) return;
      const Vec3f q(sweep.middle * Vec3(v));
      const float d = sweep.field.distance(q);
      if (static_cast<double>(d) <= limit) take(v, at, q, d);
    });
  });
  if (found && wholly == nullptr && marks->full == kBlockVoxels) blocks_[key_of(block)].reset();
}

void Coverage::visit(const MasterWindow& window, const Sweep& sweep, const Probe& probe, Block& block,
                     std::vector<Engaged>& engaged) const {
  const float remaining = window.remaining[probe.at];
  if (!block.known[probe.in_block]) {
    block.known.set(probe.in_block);
    if (remaining < 1.0f) block.masks[probe.in_block] = mask_from_remaining(window, probe.voxel, remaining);
    block.full += block.masks[probe.in_block] == kAll ? 1 : 0;
  }
  const std::uint64_t before = block.masks[probe.in_block];
  const std::uint64_t after = before == kAll ? kAll : meet(sweep, probe, before);
  if (after != before) {
    block.masks[probe.in_block] = after;
    block.full += after == kAll ? 1 : 0;
  }
  const float share = share_of(after), grown = share - share_of(before);
  const double ramp = std::clamp(0.5 - 0.5 * static_cast<double>(probe.distance) / sweep.ramp, 0.0, 1.0);
  const float now = std::min(share, std::max(static_cast<float>(ramp), 0.5f * grown));
  if (!(now > 0.0f)) return;
  const float factor = sweep.field.factor(probe.q);
  // Covered mass left before, and what has come under the tool. Where others have taken more than was covered, no more than there is.
  const float left = std::max(0.0f, remaining - (1.0f - share_of(before)));
  const float available = after == kAll ? remaining : std::min(remaining, left + grown);
  if (!(factor > 0.0f && available > 0.0f)) return;
  const Vec3 p = field_->origin + field_->pitch * Vec3(probe.q);
  engaged.push_back({.at = static_cast<std::uint32_t>(probe.at),
                     .available = available,
                     .share = share,
                     .exposure = factor * now / share,
                     .radius = static_cast<float>(std::sqrt(p.x * p.x + p.y * p.y))});
}

std::uint64_t Coverage::meet(const Sweep& sweep, const Probe& probe, std::uint64_t mask) const {
  const auto pitch = static_cast<float>(sweep.pitch), reach = static_cast<float>(sweep.reach);
  const float half_way = pitch * glm::length(probe.half), slack = static_cast<float>(kSlackPitches) * pitch;
  if (probe.distance < -(reach + half_way + slack)) return kAll;
  // A sample's distance is at least that of the plane through the centre's, less what the field bends downwards on the way and what the
  // gradient, that of the middle of its cell, is off by. Most voxels and samples need no look-up.
  const Vec3f slope = sweep.field.gradient(probe.q);
  const std::size_t node = sweep.field.nearest_node(probe.q);
  const float bend = 0.5f * down_[node], up = up_[node], sway = pitch * up, spare = probe.distance - half_way - slack;
  float deepest = 0.0f;
  for (const Vec3f& edge : sweep.span) deepest += std::abs(glm::dot(slope, edge));
  if (spare - deepest > (bend * reach + sway) * reach) return mask;
  // Between the ends of a short way a distance dips below both by no more than this: then the end that lies deeper tells.
  const bool straight = 0.5f * up * half_way * half_way < kLeastDip * static_cast<float>(sweep.ramp);
  const Vec3f deeper = glm::dot(slope, probe.half) > 0.0f ? -probe.half : probe.half;
  const MeetJob job{.distance = field_->distance.data(),
                    .row = field_->dims.x,
                    .slab = field_->dims.x * field_->dims.y,
                    .end = {sweep.end.x, sweep.end.y, sweep.end.z},
                    .x = sweep.x.data(),
                    .y = sweep.y.data(),
                    .z = sweep.z.data(),
                    .far = sweep.far.data(),
                    .centre = {probe.q.x, probe.q.y, probe.q.z},
                    .slope = {slope.x, slope.y, slope.z},
                    .deeper = {deeper.x, deeper.y, deeper.z},
                    .closest = probe.distance,
                    .spare = spare,
                    .bend = bend,
                    .sway = sway,
                    .half_way = half_way,
                    .slack = slack,
                    .straight = straight};
  const MeetMasks found = meet_samples(job, ~mask);
  mask |= found.met;
  for (std::uint64_t left = found.unsure; left != 0; left &= left - 1) {
    const auto n = static_cast<std::size_t>(std::countr_zero(left));
    const Vec3f q = probe.q + Vec3f(sweep.x[n], sweep.y[n], sweep.z[n]);
    const float d = sweep.field.distance(q);
    const bool met = d <= 0.0f || (half_way > 0.0f && d <= 1.1f * half_way &&
                                   (sweep.field.distance(q + deeper) <= 0.0f || (!straight && sweep.met_on_the_way(q, probe.half))));
    if (met) mask |= std::uint64_t{1} << n;
  }
  return mask;
}

std::uint64_t Coverage::mask_from_remaining(const MasterWindow& window, const Vec3i& voxel, float remaining) const {
  const auto count = static_cast<std::size_t>(std::lround((1.0f - remaining) * static_cast<float>(kCoverageSamples)));
  Vec3f rise(0.0f);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3i step(0);
    step[axis] = 1;
    rise[axis] = window.remaining[window.box.offset_of(voxel + step)] - window.remaining[window.box.offset_of(voxel - step)];
  }
  std::array<std::size_t, kCoverageSamples> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return glm::dot(rise, samples_.offset[a]) < glm::dot(rise, samples_.offset[b]); });
  std::uint64_t mask = 0;
  for (std::size_t n = 0; n < count; ++n) mask |= std::uint64_t{1} << order[n];
  return mask;
}

double Coverage::covered(const Vec3i& voxel) const {
  const auto found = blocks_.find(key_of({voxel.x >> 3, voxel.y >> 3, voxel.z >> 3}));
  if (found == blocks_.end()) return 0.0;
  if (found->second == nullptr) return 1.0;
  const Vec3i in(voxel.x & 7, voxel.y & 7, voxel.z & 7);
  return static_cast<double>(share_of(found->second->masks[static_cast<std::size_t>((in.z * kEdge + in.y) * kEdge + in.x)]));
}

std::size_t Coverage::bytes() const noexcept {
  std::size_t sum = 0;
  for (const auto& [key, block] : blocks_) sum += sizeof(key) + sizeof(block) + (block != nullptr ? sizeof(Block) : 0);
  return sum;
}

}  // namespace burrhole
