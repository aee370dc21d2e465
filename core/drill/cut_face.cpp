#include "core/drill/cut_face.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr float kBand = static_cast<float>(kRecordBand);  // [voxel edges]
constexpr float kKnown = kBand - 0.1f;                    // [voxel edges] bone deeper than this has no known distance
constexpr float kExact = 1e-4f;                           // [voxel edges] of a lag
constexpr float kNearTool = 1.5f;                         // [voxel edges] bone nearer than this must know its face
constexpr int kPart = kBlockEdge / 2;                     // [voxels] parts of a block are passed over where all of it is far from the tool
constexpr double kPartMiddle = 0.5 * (kPart - 1);
constexpr int kMostRounds = 8;              // for a lag
constexpr float kNewNormal = 1.0f / 16.0f;  // [voxel edges] a face that moved less keeps its normal
constexpr float kSharedDepth = 1.0f;        // [voxel edges] bone between two faces has the normal of the cut one up to here
constexpr double kFacing = 0.3;             // [-] cosine: a surface that faces the tool; the sides of a post do not
constexpr float kSteepEnough = 0.1f;        // [-] least slope with which a lag is extrapolated
constexpr double kReserve = 0.05;           // [voxel edges] of room: beyond the border of the table distances are lower bounds

constexpr std::size_t kAsked = 6;  // most places asked for per node: for a new normal

std::int16_t steps_of(float distance) noexcept {
  return static_cast<std::int16_t>(std::lrint(std::clamp(distance, -kBand, kBand) / static_cast<float>(kRecord16Distance)));
}

/// @returns the largest change of an interpolated distance over the way [-]: 1 for exact distances.
double steepest_of(const CuttingField& field) noexcept {
  if (field.empty()) return 1.0;
  const VoxelBox all{Vec3i(0), field.dims};
  const std::size_t row = static_cast<std::size_t>(field.dims.x), slab = row * static_cast<std::size_t>(field.dims.y);
  Vec3f most(0.0f);
  for_each_voxel({Vec3i(0), field.dims - Vec3i(1, field.revolved ? 0 : 1, 1)}, [&](const Vec3i& v) {
    const float* const here = &field.distance[all.offset_of(v)];
    most = glm::max(most, glm::abs(Vec3f(here[1], field.revolved ? *here : here[row], here[slab]) - *here));
  });
  // The last row of each axis lies at the border, where the distance to the cutting part changes by the way along it.
  return std::max(1.0, glm::length(Vec3(most)) / field.pitch);
}

Vec3i voxel_of(const Vec3i& block, std::uint16_t inside) noexcept {
  return block * kBlockEdge + Vec3i(inside % kBlockEdge, inside / kBlockEdge % kBlockEdge, inside / (kBlockEdge * kBlockEdge));
}

}  // namespace

/// One pose of the tool.
struct CutFace::Sweep {
  Affine place;  // nodes of the field from index
  VoxelBox box;  // voxels within kFollow of the bounds of the tool
  VoxelBox erodible;
  VoxelBox allowed;  // the part of the box that may be eroded
  Vec3i ahead;       // [voxels] to the neighbour towards the face
  float part_reach;  // [voxel edges] by which distances in a part of a block differ from that of its middle
};

CutFace::CutFace(std::shared_ptr<const CuttingField> field)
    : field_(std::move(field)), sampler_(*field_), job_(field_job(*field_)), steepest_(steepest_of(*field_)) {}

/// Fills sampled_ with the distances to the tool.
void CutFace::sample(const FieldPlaces& places) {
  sampled_.resize(places.size() + kFieldPad);
  sample_field(job_, {places.size(), places.x.data(), places.y.data(), places.z.data()}, sampled_.data());
  for (std::size_t n = 0; n < places.size(); ++n) sampled_[n] /= edge_;
}

/// Sets the nodes of a block from the density, as far as the window knows them.
void CutFace::complete(const Voxmap& voxmap, const Vec3i& at, CutSurface::Block& block) {
  const MasterWindow& window = voxmap.window();
  const Vec3i reach = record_reach(voxmap.bone().bone_from_index());
  const VoxelBox whole = box_of_block(at), part = whole.intersect({window.box.lo + reach, window.box.hi - reach});
  if (part.empty()) return;
  surface_->read(window, part, scratch_);
  block.complete = part == whole;
  for_each_voxel(part, [&](const Vec3i& v) {
    CutSurface::Node& node = block.at(v);
    if (node.set()) return;
    const Record16& record = scratch_[part.offset_of(v)];
    node.base = static_cast<float>(kRecord16Distance) * static_cast<float>(record.distance);
    node.cut = -kBand;
    node.normal = {record.nx, record.ny, record.nz};
  });
}

/// @returns whether the surface at a node faces the tool.
bool CutFace::faces_tool(const CutSurface::Node& node, const Vec3f& place) const noexcept {
  Vec3f gradient(0.0f);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3f step(0.0f);
    step[axis] = 1.0f;
    gradient[axis] = sampler_.distance(place + step) - sampler_.distance(place - step);
  }
  const Vec3 away = normal_from_node_ * Vec3(gradient), normal = kRecord16Normal * Vec3(node.normal[0], node.normal[1], node.normal[2]);
  return -glm::dot(normal, away) > kFacing * glm::length(away);
}

/// Sets phi of a node that has none yet: the surface as it was, in air or if it faces the tool, or the face as its neighbour knows it.
void CutFace::start(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& voxel, const Vec3f& place, float tool,
                    CutSurface::Node& node) const noexcept {
  if (node.base >= 0.0f || (node.base > -kKnown && faces_tool(node, place)))  // air has no face but the bone's
    node.cut = node.base;
  else
    node.cut = std::max(node.cut, from_neighbour(voxmap, sweep, voxel, place));
  if (node.cut > -kKnown || tool > kNearTool) return;
  // The tool moves across the force. Distances of neighbours differ by at most an edge.
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      Vec3i next = voxel;
      next[axis] += side;
      const CutSurface::Block* const block = voxmap.cut().find(block_of(next));
      if (block == nullptr || block->at(next).cut <= -kKnown) continue;
      node.cut = std::max(node.cut, std::min(block->at(next).cut - 1.0f, -tool));
    }
}

/// phi [voxel edges] of a node without a known distance, from the lag of its neighbour towards the face; unknown: -kBand.
float CutFace::from_neighbour(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& voxel, const Vec3f& place) const noexcept {
  const Vec3i next = voxel + sweep.ahead;
  const CutSurface::Block* const block = voxmap.cut().find(block_of(next));
  if (block == nullptr) return -kBand;
  const float phi = block->at(next).cut;
  if (phi <= -kKnown) return -kBand;
  const Vec3f there(sweep.place * Vec3(next));
  float l = usual_;  // and one step of the secant
  const float missing = -phi - sampler_.distance(there) / edge_, rest = -phi - sampler_.distance(there - l * along_) / edge_;
  if (missing <= 0.0f)
    l = 0.0f;
  else if (missing - rest > kSteepEnough * l)
    l *= missing / (missing - rest);
  return std::max(-kBand, -sampler_.distance(place - l * along_) / edge_);
}

CutFace::Sweep CutFace::aim(const Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction) {
  const Affine& bone = voxmap.bone().bone_from_index();
  if (!surface_) {
    surface_.emplace(bone);
    edge_ = static_cast<float>(bone.mean_edge());
    longest_ = static_cast<float>(glm::length(field_->bounds.hi - field_->bounds.lo)) / edge_ + kBand;
    reserve_lists();
  }
  const MasterWindow& window = voxmap.window();
  const double edge = bone.mean_edge(), reach = static_cast<double>(kFollow) * edge;
  along_ = Vec3f(reaction * (edge / field_->pitch));
  Sweep sweep;
  sweep.place = Affine::scaling(1.0 / field_->pitch, -field_->origin / field_->pitch) * index_from_tool.inverse();
  normal_from_node_ = glm::transpose(glm::inverse(bone.linear)) * glm::transpose(sweep.place.linear);
  const Vec3 u = index_from_tool.linear * reaction;
  sweep.ahead = Vec3i(glm::round(u / std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)})));
  const Bounds near = bounds_under(index_from_tool, {field_->bounds.lo - reach, field_->bounds.hi + reach});
  const Vec3 low(window.box.lo - 2), high(window.box.hi + 2);
  sweep.box = {Vec3i(glm::ceil(glm::clamp(near.lo, low, high))), Vec3i(glm::floor(glm::clamp(near.hi, low, high))) + 1};
  double diagonal = 0.0;  // [nodes]
  for (const double y : {-kPartMiddle, kPartMiddle})
    for (const double z : {-kPartMiddle, kPartMiddle})
      diagonal = std::max(diagonal, glm::length(sweep.place.linear * Vec3(kPartMiddle, y, z)));
  sweep.part_reach = static_cast<float>(diagonal * steepest_ * field_->pitch / edge);
  sweep.erodible = window.erodible_box();
  sweep.allowed = sweep.box.intersect(sweep.erodible);
  return sweep;
}

std::uint32_t CutFace::find(Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction) {
  nodes_.clear();
  buried_.clear();
  unknown_.clear();
  places_.clear();
  if (field_->empty()) return 0;
  const Sweep sweep = aim(voxmap, index_from_tool, reaction);
  const auto tool_at = [&](const Vec3& v) { return sampler_.distance(Vec3f(sweep.place * v)) / edge_; };
  const auto half = static_cast<float>(0.5 * std::sqrt(3.0) * (kBlockEdge - 1) * 1.05);
  if (!sweep.allowed.empty())
    for_each_voxel(blocks_of(sweep.allowed), [&](const Vec3i& at) {
      if (tool_at(Vec3(at * kBlockEdge) + 0.5 * (kBlockEdge - 1)) <= kFollow + half) visit(voxmap, sweep, at);
    });
  if (!nodes_.empty()) buried_.clear();
  find_lags();
  std::uint32_t outside = 0;
  if (!(sweep.allowed == sweep.box))
    for_each_voxel(sweep.box, [&](const Vec3i& v) { outside += !sweep.allowed.contains(v) && tool_at(Vec3(v)) < 0.0f ? 1 : 0; });
  return outside;
}

bool CutFace::is_quiet(const Sweep& sweep, const Vec3i& at, bool has_block) const noexcept {
  const auto found = quiet_.find(key_of_block(at));
  if (found == quiet_.end() || !(found->second.far || has_block)) return false;
  // Every voxel of the block moves, in the tool's frame, by at most what its middle moves and what its corners turn about it.
  constexpr double kHalf = 0.5 * (kBlockEdge - 1);
  const Affine& before = found->second.place;
  const Mat3 turn = sweep.place.linear - before.linear;
  const Vec3 moved = turn * (Vec3(at * kBlockEdge) + kHalf) + sweep.place.offset - before.offset;
  const double turned = kHalf * std::sqrt(3.0 * (glm::dot(turn[0], turn[0]) + glm::dot(turn[1], turn[1]) + glm::dot(turn[2], turn[2])));
  return (glm::length(moved) + turned) * steepest_ * field_->pitch < found->second.room * static_cast<double>(edge_);
}

void CutFace::gather(const MasterWindow& window, const Sweep& sweep, const VoxelBox& part, const CutSurface::Block* block) {
  candidates_.resize(part.count());
  asked_.resize(part.count());
  passed_over_ = std::numeric_limits<float>::infinity();
  const Vec3i first_lo = block_of(part.lo) * kBlockEdge;
  std::size_t count = 0;
  const Vec3f step(sweep.place.linear[0]);
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& which) {
    const Vec3i lo = first_lo + kPart * which;
    const VoxelBox here = VoxelBox{lo, lo + kPart}.intersect(part);
    if (here.empty()) return;
    const float least = sampler_.distance(Vec3f(sweep.place * (Vec3(lo) + kPartMiddle))) / edge_ - sweep.part_reach;
    if (least > kFollow) {
      passed_over_ = std::min(passed_over_, least - kFollow);
      return;
    }
    for (int k = here.lo.z; k < here.hi.z; ++k)
      for (int j = here.lo.y; j < here.hi.y; ++j) {
        const Vec3f first(sweep.place * Vec3(here.lo.x, j, k));
        const std::size_t row = window.box.offset_of({here.lo.x, j, k});
        const auto inside = static_cast<std::size_t>(((k & 7) * kBlockEdge + (j & 7)) * kBlockEdge + (here.lo.x & 7));
        for (int i = 0; i < here.hi.x - here.lo.x; ++i) {
          const auto n = static_cast<std::size_t>(i);
          const bool bone = window.occupancy[row + n] > 0.0f && window.remaining[row + n] > 0.0f;
          if (block != nullptr && !bone && block->nodes[inside + n].cut > kFree) continue;
          asked_.set(count, first + static_cast<float>(i) * step);
          candidates_[count++] = {static_cast<std::uint32_t>(row + n), static_cast<std::uint16_t>(inside + n), bone};
        }
      }
  });
  candidates_.resize(count);
  asked_.resize(count);
  sample(asked_);
}

/// What the law does to a voxel.
CutRule CutFace::rule_at(const MasterWindow& window, std::uint32_t at, const Vec3f& place) const noexcept {
  const Vec3 p = field_->origin + field_->pitch * Vec3(place);
  return {sampler_.factor(place), std::max(window.hardness[at], 0.1f), static_cast<float>(std::sqrt(p.x * p.x + p.y * p.y))};
}

/// Appends the voxels of one block whose face overlaps the tool.
void CutFace::visit(Voxmap& voxmap, const Sweep& sweep, const Vec3i& at) {
  const MasterWindow& window = voxmap.window();
  CutSurface::Block* block = voxmap.cut().find(at);
  if ((block != nullptr && block->free) || is_quiet(sweep, at, block != nullptr)) return;
  const VoxelBox whole = box_of_block(at), part = whole.intersect(sweep.erodible);
  const bool all = part == whole;
  gather(window, sweep, part, block);
  const bool none_far = passed_over_ == std::numeric_limits<float>::infinity();
  if (candidates_.empty() && none_far) {
    if (block != nullptr) block->free = all;
    return;
  }
  float nearest = kFollow + std::min(kBand, passed_over_);
  for (std::size_t n = 0; n < candidates_.size(); ++n) nearest = std::min(nearest, sampled_[n]);
  if (nearest > kFollow) {
    if (all)
      quiet_.insert_or_assign(key_of_block(at), Quiet{sweep.place, static_cast<double>(nearest - kFollow) - kReserve, block == nullptr});
    return;
  }
  if (block == nullptr) block = &voxmap.cut().add(at);
  if (!block->complete) complete(voxmap, at, *block);
  float room = all ? std::min(kBand, passed_over_) : 0.0f;
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    const Candidate& one = candidates_[n];
    CutSurface::Node& node = block->nodes[one.inside];
    const float tool = sampled_[n];
    if (tool > kFollow) {
      room = std::min(room, tool - kFollow);
      continue;
    }
    if (!node.set()) {
      room = 0.0f;
      continue;
    }
    if (node.cut <= -kKnown) {
      start(voxmap, sweep, voxel_of(at, one.inside), asked_.at(n), tool, node);
      if (node.cut > kFree && !one.bone) continue;
      if (node.cut <= -kKnown) {
        room = 0.0f;
        unknown_.push_back({&node, tool});
        if (one.bone && tool < 0.0f) buried_.push_back({one.at, &node, tool, rule_at(window, one.at, asked_.at(n))});
        continue;
      }
    }
    room = std::min(room, std::max(0.0f, tool + node.cut));
    if (tool + node.cut >= 0.0f) continue;
    nodes_.push_back({one.at, &node, tool, 0.0f, 0.0f, rule_at(window, one.at, asked_.at(n))});
    places_.add(asked_.at(n));
  }
  if (room > 0.0f)
    quiet_.insert_or_assign(key_of_block(at), Quiet{sweep.place, static_cast<double>(room) - kReserve, false});
  else
    quiet_.erase(key_of_block(at));
}

/// Finds l of each node. The search starts at the usual lag. It is a secant, bounded below by the missing distance itself, since distances
/// change by at most the travel. A lag that does not settle belongs to a face along u, which the normal decides.
void CutFace::find_lags() {
  lags_.resize(nodes_.size());
  open_.clear();
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    const float missing = -(nodes_[n].tool + nodes_[n].node->cut);
    lags_[n] = {0.0f, missing, -1.0f, 0.0f, std::max(usual_, missing)};
    open_.push_back(n);
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (int round = 0; round < kMostRounds && !open_.empty(); ++round) {
    asked_.clear();
    for (const std::uint32_t n : open_) asked_.add(places_.at(n) - lags_[n].now * along_);
    sample(asked_);
    std::size_t kept = 0;
    for (std::size_t m = 0; m < open_.size(); ++m) {
      const std::uint32_t n = open_[m];
      Lag& lag = lags_[n];
      const float missing = -nodes_[n].node->cut - sampled_[m], at = lag.now;
      if (std::abs(missing) <= kExact) {
        nodes_[n].behind = at;
        nodes_[n].rest = missing;
        sum += static_cast<double>(at), ++count;
        continue;
      }
      if (missing < 0.0f) {
        lag.far = at, lag.far_missing = missing;
      } else {
        const float slope = (lag.near_missing - missing) / (at - lag.near);
        lag.near = at, lag.near_missing = missing;
        lag.now = at + (slope > kSteepEnough ? std::max(missing, missing / slope) : missing);
      }
      if (lag.far >= 0.0f && (missing < 0.0f || lag.now >= lag.far))
        lag.now = lag.near + (lag.far - lag.near) * lag.near_missing / (lag.near_missing - lag.far_missing);
      if (lag.now <= longest_) open_[kept++] = n;
    }
    open_.resize(kept);
  }
  if (count > 0) usual_ = static_cast<float>(sum / static_cast<double>(count));
}

std::span<const float> CutFace::recede(std::span<const float> shares) {
  moved_.resize(nodes_.size());
  after_.resize(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) moved_.set(n, places_.at(n) - (1.0f - shares[n]) * nodes_[n].behind * along_);
  sample(moved_);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Receding& node = nodes_[n];
    const float before = node.node->cut, most = -node.tool;
    after_[n] = std::clamp(before + shares[n] * (most - before), before, most);
    const float followed = std::min(-sampled_[n] - node.rest, most);
    if (node.behind > 0.0f && followed > after_[n])
      after_[n] = followed;
    else
      moved_.set(n, places_.at(n));
  }
  return after_;
}

void CutFace::open() noexcept {
  for (const auto& [node, tool] : unknown_) node->cut = std::max(node->cut, -tool);
}

void CutFace::keep() {
  asked_.clear();
  open_.clear();
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    CutSurface::Node& node = *nodes_[n].node;
    node.cut = after_[n];
    if (node.cut < (node.base < 0.0f ? node.base - kSharedDepth : 0.0f)) continue;
    const float since = after_[n] - static_cast<float>(kRecord16Distance) * static_cast<float>(node.normal_at);
    if (std::abs(since) < kNewNormal && node.normal_at != 0) continue;
    open_.push_back(n);
    const Vec3f place = moved_.at(n);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const float side : {1.0f, -1.0f}) {
        Vec3f beside = place;
        beside[axis] += side;
        asked_.add(beside);
      }
  }
  sample(asked_);
  for (std::size_t m = 0; m < open_.size(); ++m) {
    CutSurface::Node& node = *nodes_[open_[m]].node;
    const float* const d = &sampled_[6 * m];
    const Vec3 normal = -(normal_from_node_ * Vec3(Vec3f(d[0] - d[1], d[2] - d[3], d[4] - d[5])));
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      node.normal[axis] = static_cast<std::int16_t>(std::lrint(normal[axis] / length / kRecord16Normal));
    node.normal_at = steps_of(node.cut);
  }
}

std::size_t CutFace::reserved_nodes(const CuttingField& field, double edge) noexcept {
  // Area of the cutting surface, from the nodes of the field within a pitch of it, each a cube or, of a solid of revolution, a ring. Over it
  // bone whose face is followed, and the ramp.
  double cubes = 0.0;  // [pitch^3] within a pitch of the surface
  const auto row = static_cast<std::size_t>(field.dims.x);
  for (std::size_t n = 0; n < field.distance.size(); ++n)
    if (std::abs(field.distance[n]) < static_cast<float>(field.pitch))
      cubes += field.revolved ? 2.0 * std::numbers::pi * static_cast<double>(n % row) : 1.0;
  const double area = 0.5 * cubes * field.pitch * field.pitch;
  return static_cast<std::size_t>(area / (edge * edge) * static_cast<double>(kFollow + kFree));
}

std::size_t CutFace::list_bytes(std::size_t nodes) noexcept {
  constexpr std::size_t kPlace = 3 * sizeof(float);
  return nodes * (sizeof(Receding) + 2 * kPlace + kAsked * (kPlace + sizeof(float)) + sizeof(float) + sizeof(Lag) + sizeof(std::uint32_t));
}

/// Steps of a usual run then allocate only blocks of the cut surface.
void CutFace::reserve_lists() {
  const std::size_t most = reserved_nodes(*field_, static_cast<double>(edge_));
  nodes_.reserve(most);
  places_.reserve(most);
  moved_.reserve(most);
  asked_.reserve(kAsked * most);
  sampled_.reserve(kAsked * most + kFieldPad);
  after_.reserve(most);
  lags_.reserve(most);
  open_.reserve(most);
}

}  // namespace burrhole
