#include "core/drill/coverage.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/drill/coverage_kernels.h"
#include "core/drill/coverage_sweep.h"
#include "core/drill/field_sampler.h"

namespace burrhole {
namespace {

constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr float kLeastDip = 0.01f;  // [voxels] about
constexpr std::size_t kAhead = 6;   // voxels whose curvature is prefetched
constexpr double kRounding = 1e-3;  // [nodes] bound on the rounding error of a distance in single precision

PlaceJob place_job(const CuttingField& field, const CoverageSweep& sweep) {
  PlaceJob job{.distance = field.distance.data(),
               .factor = field.factor.data(),
               .row = field.dims.x,
               .slab = field.dims.x * field.dims.y,
               .end = {sweep.end.x, sweep.end.y, sweep.end.z},
               .linear = {},
               .offset = {},
               .margin = field.margin,
               .pitch = field.pitch,
               .origin = {field.origin.x, field.origin.y, field.origin.z},
               .ramp = sweep.ramp};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t column = 0; column < 3; ++column) job.linear[column][axis] = sweep.middle.linear[column][axis];
    job.offset[axis] = sweep.middle.offset[axis];
  }
  return job;
}

/// The largest float <= x.
float float_below(double x) {
  const auto near = static_cast<float>(x);
  return static_cast<double>(near) > x ? std::nextafter(near, -std::numeric_limits<float>::infinity()) : near;
}

}  // namespace

/// Voxels of one block within reach of the tool, as arrays. Only the first `count` entries are set.
struct Coverage::Near {
  template <class T>
  using List = std::array<T, kBlockVoxels + kPlacePad>;
  std::size_t count = 0;
  List<std::uint32_t> at;  ///< offsets into the window
  List<std::uint16_t> in_block;
  List<float> x, y, z, distance;
  List<float> share, grown, available;
  List<float> exposure, radius;

  /// Moves entry n to entry `to` <= n.
  void move(std::size_t n, std::size_t to) noexcept {
    at[to] = at[n];
    x[to] = x[n];
    y[to] = y[n];
    z[to] = z[n];
    distance[to] = distance[n];
  }
};

/// One voxel of the list.
struct Coverage::Probe {
  Vec3f q;         ///< [nodes] its centre, at the middle of the sub-step
  Vec3f half;      ///< [nodes] half its travel
  float distance;  ///< [m] of the centre
};

Coverage::Coverage(std::shared_ptr<const CuttingField> field, CoverageKernel kernel) : field_(std::move(field)), kernel_(kernel) {
  if (field_->empty()) return;
  const std::vector<float> down = bends_of(*field_, -1.0, static_cast<int>(std::ceil(field_->margin / field_->pitch)));
  const std::vector<float> up = bends_of(*field_, 1.0, 1);
  bends_.reserve(down.size());
  for (std::size_t n = 0; n < down.size(); ++n) bends_.push_back({down[n], up[n]});
  steepest_ = steepest_of(*field_);
}

std::uint64_t Coverage::key_of(const Vec3i& block) noexcept {
  const auto part = [](int n) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(n)) & 0x1fffffu; };
  return part(block.x) | part(block.y) << 21 | part(block.z) << 42;
}

int Coverage::marks_in(const std::uint64_t* mask) const noexcept {
  int marks = 0;
  for (std::size_t w = 0; w < samples_.words; ++w) marks += std::popcount(mask[w]);
  return marks;
}

float Coverage::share_of(int marks) const noexcept { return static_cast<float>(marks) / static_cast<float>(samples_.size()); }

void Coverage::start_step(const ErosionPath& path, const CoverageSweep& sweep) {
  if (step_++ > 0) odometer_ += sweep.way_between(*field_, {last_, path.from});
  const double way = sweep.way_between(*field_, path);
  half_odometer_ = odometer_ + 0.5 * way;
  odometer_ += way;
  last_ = path.to;
}

std::uint32_t Coverage::advance(const Voxmap& voxmap, const ErosionPath& path, std::vector<Engaged>& engaged) {
  if (voxmap.growth_epoch() != growth_epoch_) {
    blocks_.clear();
    growth_epoch_ = voxmap.growth_epoch();
  }
  if (field_->empty()) return 0;
  if (step_ == 0) {
    const Vec3 half = 0.5 * (field_->bounds.hi - field_->bounds.lo) / voxmap.bone().bone_from_index().mean_edge();
    samples_ = make_coverage_samples(kernel_, coverage_words(std::min({half.x, half.y, half.z})));
  }
  const CoverageSweep sweep(*field_, samples_, voxmap, path);
  start_step(path, sweep);
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

void Coverage::visit_block(const Voxmap& voxmap, const CoverageSweep& sweep, const Vec3i& block, std::vector<Engaged>& engaged) {
  Near near;
  find_near(voxmap.window(), sweep, block, near);
  if (near.count == 0) return;
  auto [place, fresh] = blocks_.try_emplace(key_of(block));
  if (fresh) place->second = std::make_unique<Block>(samples_.words);
  if (Block* marks = place->second.get(); marks != nullptr) {
    mark(voxmap.window(), sweep, block * kEdge, *marks, near);
    if (marks->full == kBlockVoxels) place->second.reset();
  } else {
    for (std::size_t n = 0; n < near.count; ++n) {
      near.share[n] = 1.0f;
      near.grown[n] = 0.0f;
      near.available[n] = voxmap.window().remaining[near.at[n]];
    }
  }
  weigh(sweep, near, engaged);
}

/// Finds the voxels with bone whose samples the tool may meet, one eighth of the block after another.
void Coverage::find_near(const MasterWindow& window, const CoverageSweep& sweep, const Vec3i& block, Near& near) const {
  constexpr int kHalf = kEdge / 2;
  constexpr std::size_t kMost = kHalf * kHalf * kHalf + kPlacePad;
  const Vec3i corner = block * kEdge;
  const auto distance_at = [&](const Vec3& v) { return static_cast<double>(sweep.field.distance(Vec3f(sweep.middle * v))); };
  const double limit = sweep.reach + sweep.half_way + kSlackPitches * sweep.pitch;
  if (distance_at(Vec3(corner) + 0.5 * (kEdge - 1)) > limit + sweep.cell) return;
  const VoxelBox part = VoxelBox{corner, corner + kEdge}.intersect(sweep.allowed);
  const float farthest = float_below(limit);
  const PlaceJob job = place_job(*field_, sweep);
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& eighth) {
    const Vec3i start = corner + kHalf * eighth;
    // The same test for a cube of 4^3 voxels: three sevenths of the block's diagonal.
    if (distance_at(Vec3(start) + 0.5 * (kHalf - 1)) > limit + 3.0 / 7.0 * sweep.cell) return;
    std::array<std::int32_t, kMost> i, j, k;
    std::array<std::uint32_t, kMost> at;
    std::size_t count = 0;
    for_each_voxel(part.intersect({start, start + kHalf}), [&](const Vec3i& v) {
      at[count] = static_cast<std::uint32_t>(window.box.offset_of(v));
      i[count] = v.x, j[count] = v.y, k[count] = v.z;
      count += window.density[at[count]] != 0.0f && window.remaining[at[count]] != 0.0f ? 1 : 0;
    });
    for (std::size_t n = count; n < count + kPlacePad; ++n) i[n] = j[n] = k[n] = 0;  // whole vectors are read
    float* const x = near.x.data() + near.count;
    const PlaceList places{x, near.y.data() + near.count, near.z.data() + near.count, near.distance.data() + near.count};
    measure_places(job, {count, i.data(), j.data(), k.data()}, places);
    std::size_t to = near.count;
    for (std::size_t n = 0, from = near.count; n < count; ++n, ++from) {
      if (!(near.distance[from] <= farthest)) continue;
      near.at[from] = at[n];
      near.move(from, to);
      near.in_block[to++] = static_cast<std::uint16_t>(((k[n] & 7) * kEdge + (j[n] & 7)) * kEdge + (i[n] & 7));
    }
    near.count = to;
  });
}

/// Updates the masks; keeps the voxels of `near` that have bone to remove.
void Coverage::mark(const MasterWindow& window, const CoverageSweep& sweep, const Vec3i& corner, Block& block, Near& near) {
  if (block.seen + 1 != step_) block.inactive.fill(0.0);
  block.seen = step_;
  const auto all = static_cast<int>(samples_.size());
  std::size_t kept = 0;
  for (std::size_t n = 0; n < near.count; ++n) {
    if (n + kAhead < near.count)
      __builtin_prefetch(&bends_[sweep.field.nearest_node({near.x[n + kAhead], near.y[n + kAhead], near.z[n + kAhead]})]);
    const std::size_t in_block = near.in_block[n];
    const float remaining = window.remaining[near.at[n]];
    const auto voxel = [&] {
      const auto in = static_cast<int>(in_block);
      return corner + Vec3i(in & 7, (in >> 3) & 7, in >> 6);
    };
    std::uint64_t* const mask = &block.masks[in_block * samples_.words];
    if (!block.known[in_block]) {
      block.known.set(in_block);
      if (remaining < 1.0f) mark_from_remaining(window, voxel(), remaining, mask);
      block.full += marks_in(mask) == all ? 1 : 0;
    }
    const int before = marks_in(mask);
    int after = before;
    if (before != all && block.inactive[in_block] <= odometer_) {
      const Probe probe{{near.x[n], near.y[n], near.z[n]}, Vec3f(sweep.half * Vec3(voxel())), near.distance[n]};
      const double nearest = static_cast<double>(meet(sweep, probe, mask)) - kRounding * sweep.pitch;
      block.inactive[in_block] = nearest > 0.0 ? half_odometer_ + nearest / steepest_ : 0.0;
      after = marks_in(mask);
      block.full += after == all ? 1 : 0;
    }
    const float share = share_of(after), grown = share - share_of(before);
    // Covered mass left before, plus the newly covered mass. If another law removed more than was covered: at most what is there.
    const float left = std::max(0.0f, remaining - (1.0f - share_of(before)));
    const float available = after == all ? remaining : std::min(remaining, left + grown);
    if (!(available > 0.0f)) continue;
    near.move(n, kept);
    near.share[kept] = share;
    near.grown[kept] = grown;
    near.available[kept++] = available;
  }
  near.count = kept;
}

void Coverage::weigh(const CoverageSweep& sweep, Near& near, std::vector<Engaged>& engaged) const {
  for (std::size_t n = near.count; n < near.count + kPlacePad; ++n)  // whole vectors are read
    near.x[n] = near.y[n] = near.z[n] = near.distance[n] = near.share[n] = near.grown[n] = 0.0f;
  weigh_places(place_job(*field_, sweep), {.count = near.count,
                                           .at = {near.x.data(), near.y.data(), near.z.data(), near.distance.data()},
                                           .share = near.share.data(),
                                           .grown = near.grown.data(),
                                           .exposure = near.exposure.data(),
                                           .radius = near.radius.data()});
  for (std::size_t n = 0; n < near.count; ++n)
    if (near.exposure[n] > 0.0f)
      engaged.push_back({.at = near.at[n],
                         .available = near.available[n],
                         .share = near.share[n],
                         .exposure = near.exposure[n],
                         .radius = near.radius[n]});
}

/// @returns the least distance [m] of an unmet sample to the tool at the middle of the sub-step; 0 if unknown.
float Coverage::meet(const CoverageSweep& sweep, const Probe& probe, std::uint64_t* mask) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto pitch = static_cast<float>(sweep.pitch), reach = static_cast<float>(sweep.reach);
  const float half_way = pitch * glm::length(probe.half), slack = static_cast<float>(kSlackPitches) * pitch;
  if (probe.distance < -(reach + half_way + slack)) {
    std::fill_n(mask, samples_.words, kAll);
    return kFar;
  }
  // The distance of a sample is at least that of the tangent plane at the centre, less the downward curvature of the field along the travel
  // and the error of the gradient, which is that of the middle of its cell. Most voxels and samples need no table access.
  const Vec3f slope = sweep.field.gradient(probe.q);
  const Bend& here = bends_[sweep.field.nearest_node(probe.q)];
  const float bend = 0.5f * here.down, up = here.up, sway = pitch * up, spare = probe.distance - half_way - slack;
  float deepest = 0.0f;
  for (const Vec3f& edge : sweep.span) deepest += std::abs(glm::dot(slope, edge));
  // Outside the table distances are bounds, so a voxel may not become inactive.
  const bool inside =
      glm::all(glm::greaterThanEqual(probe.q - sweep.extent, Vec3f(0.0f))) && glm::all(glm::lessThan(probe.q + sweep.extent, sweep.end));
  const float bent = (bend * reach + sway) * reach;
  if (spare - deepest > bent) return inside ? spare - deepest - bent + half_way : 0.0f;
  // Between the ends of a short travel the distance is below both ends by at most this: the deeper end then decides.
  const bool straight = 0.5f * up * half_way * half_way < kLeastDip * static_cast<float>(sweep.ramp);
  const Vec3f deeper = glm::dot(slope, probe.half) > 0.0f ? -probe.half : probe.half;
  MeetJob job{.distance = field_->distance.data(),
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
  float nearest = inside ? kFar : 0.0f;
  for (std::size_t w = 0; w < samples_.words; ++w) {
    if (mask[w] == kAll) continue;
    const std::size_t from = w * kCoverageSamples;
    job.x = &sweep.x[from], job.y = &sweep.y[from], job.z = &sweep.z[from], job.far = &sweep.far[from];
    const MeetMasks found = meet_samples(job, ~mask[w]);
    mask[w] |= found.met;
    nearest = found.unsure != 0 ? 0.0f : std::min(nearest, found.nearest);
    for (std::uint64_t left = found.unsure; left != 0; left &= left - 1) {
      const auto n = static_cast<std::size_t>(std::countr_zero(left));
      if (meet_alone(sweep, probe, job, {job.x[n], job.y[n], job.z[n]})) mask[w] |= std::uint64_t{1} << n;
    }
  }
  return nearest;
}

/// Tests a single sample that the bounds and the vector kernels could not decide.
bool Coverage::meet_alone(const CoverageSweep& sweep, const Probe& probe, const MeetJob& job, const Vec3f& offset) const {
  const Vec3f q = probe.q + offset, deeper(job.deeper[0], job.deeper[1], job.deeper[2]);
  const float d = sweep.field.distance(q);
  if (d <= 0.0f) return true;
  if (!(job.half_way > 0.0f && d <= 1.1f * job.half_way)) return false;
  return sweep.field.distance(q + deeper) <= 0.0f || (!job.straight && sweep.met_on_the_way(q, probe.half));
}

void Coverage::mark_from_remaining(const MasterWindow& window, const Vec3i& voxel, float remaining, std::uint64_t* mask) const {
  const auto count = static_cast<std::size_t>(std::lround((1.0f - remaining) * static_cast<float>(samples_.size())));
  Vec3f rise(0.0f);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3i step(0);
    step[axis] = 1;
    rise[axis] = window.remaining[window.box.offset_of(voxel + step)] - window.remaining[window.box.offset_of(voxel - step)];
  }
  std::array<std::size_t, kMostCoverageWords * kCoverageSamples> order;
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(samples_.size());
  std::iota(order.begin(), end, std::size_t{0});
  std::stable_sort(order.begin(), end,
                   [&](std::size_t a, std::size_t b) { return glm::dot(rise, samples_.offset[a]) < glm::dot(rise, samples_.offset[b]); });
  for (std::size_t n = 0; n < count; ++n) mask[order[n] / kCoverageSamples] |= std::uint64_t{1} << (order[n] % kCoverageSamples);
}

double Coverage::covered(const Vec3i& voxel) const {
  const auto found = blocks_.find(key_of(block_of(voxel)));
  if (found == blocks_.end()) return 0.0;
  if (found->second == nullptr) return 1.0;
  const Vec3i in(voxel.x & 7, voxel.y & 7, voxel.z & 7);
  const auto at = static_cast<std::size_t>((in.z * kEdge + in.y) * kEdge + in.x);
  return static_cast<double>(share_of(marks_in(&found->second->masks[at * samples_.words])));
}

std::size_t Coverage::bytes() const noexcept {
  std::size_t sum = 0;
  for (const auto& [key, block] : blocks_)
    sum += sizeof(key) + sizeof(block) + (block != nullptr ? sizeof(Block) + block->masks.size() * sizeof(std::uint64_t) : 0);
  return sum;
}

}  // namespace burrhole
