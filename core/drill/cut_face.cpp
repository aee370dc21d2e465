#include "core/drill/cut_face.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/bounds.h"
#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

constexpr float kBand = static_cast<float>(kRecordBand);  // [voxel edges]
constexpr float kKnown = kBand - 0.1f;                    // [voxel edges] bone deeper than this has no known distance
constexpr float kNearTool = 1.5f;                         // [voxel edges] bone nearer than this must know its face
constexpr int kPart = kBlockEdge / 2;                     // [voxels] parts of a block are passed over by themselves
constexpr std::uint32_t kAllParts = 0xff;
constexpr float kNewNormal = 1.0f / 16.0f;  // [voxel edges] a face that moved less keeps its normal
constexpr float kSharedDepth = 1.0f;        // [voxel edges] bone between two faces has the normal of the cut one up to here
constexpr double kFacing = 0.3;             // [-] cosine: a surface that faces the tool; the sides of a post do not
constexpr float kSteepEnough = 0.1f;        // [-] least slope with which a lag is extrapolated
constexpr float kReserve = 0.05f;           // [voxel edges] of room: beyond the border of the table distances are lower bounds

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

Vec3i place_in_block(std::uint32_t inside) noexcept {
  const int n = static_cast<int>(inside);
  return {n % kBlockEdge, n / kBlockEdge % kBlockEdge, n / (kBlockEdge * kBlockEdge)};
}

std::array<float, 3> array_of(const Vec3f& v) noexcept { return {v.x, v.y, v.z}; }

}  // namespace

/// One pose of the tool.
struct CutFace::Sweep {
  Affine place;  // nodes of the field from index
  VoxelBox box;  // voxels within kFollow of the bounds of the tool
  VoxelBox erodible;
  VoxelBox allowed;  // the part of the box that may be eroded
  Vec3i ahead;       // [voxels] to the neighbour towards the face
};

CutFace::CutFace(std::shared_ptr<const CuttingField> field)
    : field_(std::move(field)),
      sampler_(*field_),
      tool_{.field = field_job(*field_), .edge = 0.0f, .along = {}, .follow = kFollow, .free = kFree, .known = kKnown, .normal_from = {}},
      steepest_(steepest_of(*field_)) {}

/// Sets the nodes of a block from the density, as far as the window knows them.
void CutFace::complete(const Voxmap& voxmap, const Vec3i& at, CutSurface::Block& block) {
  const MasterWindow& window = voxmap.window();
  const Vec3i reach = record_reach(voxmap.bone().bone_from_index());
  const VoxelBox whole = box_of_block(at), part = whole.intersect({window.box.lo + reach, window.box.hi - reach});
  if (part.empty()) return;
  surface_->read(window, part, scratch_);
  block.complete = part == whole;
  for_each_voxel(part, [&](const Vec3i& v) {
    const std::size_t n = CutSurface::Block::place(v);
    if (block.base[n] != CutSurface::kUnset) return;
    block.record[n] = scratch_[part.offset_of(v)];
    block.base[n] = static_cast<float>(kRecord16Distance) * static_cast<float>(block.record[n].distance);
    block.cut[n] = -kBand;
    block.cut_before[n] = window.remaining[window.box.offset_of(v)] < 1.0f;
  });
}

/// @returns whether the surface at a node faces the tool.
bool CutFace::faces_tool(const Record16& record, const Vec3f& place) const noexcept {
  Vec3f gradient(0.0f);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3f step(0.0f);
    step[axis] = 1.0f;
    gradient[axis] = sampler_.distance(place + step) - sampler_.distance(place - step);
  }
  const Vec3 away = normal_from_node_ * Vec3(gradient), normal = kRecord16Normal * Vec3(record.nx, record.ny, record.nz);
  return -glm::dot(normal, away) > kFacing * glm::length(away);
}

/// Sets phi of a node that has none yet: the surface as it was, in air or if it faces the tool, or the face as its neighbour knows it.
void CutFace::start(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& voxel, const Vec3f& place, float tool, CutSurface::Block& block,
                    std::size_t inside) const noexcept {
  const float base = block.base[inside];
  float& cut = block.cut[inside];
  if (base >= 0.0f || (base > -kKnown && faces_tool(block.record[inside], place)))  // air has no face but the bone's
    cut = base;
  else
    cut = std::max(cut, from_neighbour(voxmap, sweep, voxel, place));
  if (cut > -kKnown || tool > kNearTool) return;
  // The tool moves across the force. Distances of neighbours differ by at most an edge.
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      Vec3i next = voxel;
      next[axis] += side;
      const CutSurface::Block* const beside = voxmap.cut().find(block_of(next));
      if (beside == nullptr || beside->at(next).cut <= -kKnown) continue;
      cut = std::max(cut, std::min(beside->at(next).cut - 1.0f, -tool));
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
  // One step of the secant, from the mean lag of the last step, or from what is missing if that is more: a lag is at least that. A removal
  // that has just been made knows no mean lag.
  const float missing = -phi - sampler_.distance(there) / edge_;
  float l = std::max(usual_, missing);
  const float rest = -phi - sampler_.distance(there - l * along_) / edge_;
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
    tool_.edge = edge_;
    longest_ = static_cast<float>(glm::length(field_->bounds.hi - field_->bounds.lo)) / edge_ + kBand;
    nodes_.make_room(reserved_nodes(*field_, bone.mean_edge()) / 2);
  }
  const MasterWindow& window = voxmap.window();
  const double edge = bone.mean_edge(), reach = static_cast<double>(kFollow) * edge;
  along_ = Vec3f(reaction * (edge / field_->pitch));
  Sweep sweep;
  sweep.place = Affine::scaling(1.0 / field_->pitch, -field_->origin / field_->pitch) * index_from_tool.inverse();
  normal_from_node_ = glm::transpose(glm::inverse(bone.linear)) * glm::transpose(sweep.place.linear);
  tool_.along = array_of(along_);
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) tool_.normal_from[3 * r + c] = static_cast<float>(normal_from_node_[c][r] * edge);
  const Vec3 u = index_from_tool.linear * reaction;
  sweep.ahead = Vec3i(glm::round(u / std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)})));
  const Bounds near = bounds_under(index_from_tool, {field_->bounds.lo - reach, field_->bounds.hi + reach});
  const Vec3 low(window.box.lo - 2), high(window.box.hi + 2);
  sweep.box = {Vec3i(glm::ceil(glm::clamp(near.lo, low, high))), Vec3i(glm::floor(glm::clamp(near.hi, low, high))) + 1};
  sweep.erodible = window.erodible_box();
  sweep.allowed = sweep.box.intersect(sweep.erodible);
  return sweep;
}

std::uint32_t CutFace::find(Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction) {
  nodes_.count = 0;
  runs_.clear();
  buried_.clear();
  unknown_.clear();
  if (field_->empty()) return 0;
  const Sweep sweep = aim(voxmap, index_from_tool, reaction);
  const auto tool_at = [&](const Vec3& v) { return sampler_.distance(Vec3f(sweep.place * v)) / edge_; };
  const auto half = static_cast<float>(0.5 * std::sqrt(3.0) * (kBlockEdge - 1) * 1.05);
  if (!sweep.allowed.empty())
    for_each_voxel(blocks_of(sweep.allowed), [&](const Vec3i& at) {
      if (tool_at(Vec3(at * kBlockEdge) + 0.5 * (kBlockEdge - 1)) <= kFollow + half) visit(voxmap, sweep, at);
    });
  if (nodes_.count > 0) {
    buried_.clear();
    find_wear(tool_, voxmap.window().hardness.data(), kLeastHardness, nodes_);
    find_lags(tool_, usual_, longest_, nodes_);
    note_earlier_cuts();
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t n = 0; n < nodes_.count; ++n)
      if (nodes_.behind[n] > 0.0f) sum += static_cast<double>(nodes_.behind[n]), ++count;
    if (count > 0) usual_ = static_cast<float>(sum / static_cast<double>(count));
  }
  std::uint32_t outside = 0;
  if (!(sweep.allowed == sweep.box))
    for_each_voxel(sweep.box, [&](const Vec3i& v) { outside += !sweep.allowed.contains(v) && tool_at(Vec3(v)) < 0.0f ? 1 : 0; });
  return outside;
}

bool CutFace::is_quiet(const Sweep& sweep, const Vec3i& at, const Quiet& part, bool has_block) const noexcept {
  if (!(part.room > 0.0f && (part.far || has_block))) return false;
  // Every voxel of the block moves, in the tool's frame, by at most what its middle moves and what its corners turn about it.
  constexpr double kHalf = 0.5 * (kBlockEdge - 1);
  const Mat3 turn = sweep.place.linear - part.place.linear;
  const Vec3 moved = turn * (Vec3(at * kBlockEdge) + kHalf) + sweep.place.offset - part.place.offset;
  const double turned = kHalf * std::sqrt(3.0 * (glm::dot(turn[0], turn[0]) + glm::dot(turn[1], turn[1]) + glm::dot(turn[2], turn[2])));
  return (glm::length(moved) + turned) * steepest_ * field_->pitch < static_cast<double>(part.room * edge_);
}

BlockSearch CutFace::search_of(const MasterWindow& window, const Sweep& sweep, const VoxelBox& box, const CutSurface::Block* block,
                               const QuietParts* parts) {
  static const CutSurface::Block kNoNodes;
  const bool has_block = block != nullptr;
  if (!has_block) block = &kNoNodes;
  const Vec3i at = block_of(box.lo), corner = at * kBlockEdge;
  const auto step = [&](std::size_t axis) { return array_of(Vec3f(sweep.place.linear[axis])); };
  const Vec3i lo = box.lo - corner, hi = box.hi - corner, size = window.box.size();
  const auto row = static_cast<std::uint32_t>(size.x), slab = row * static_cast<std::uint32_t>(size.y);
  const Vec3i in_window = corner - window.box.lo;
  BlockSearch out{.first = array_of(Vec3f(sweep.place * Vec3(corner))),
                  .step_i = step(0),
                  .step_j = step(1),
                  .step_k = step(2),
                  .occupancy = occupancy_.data(),
                  .remaining = remaining_.data(),
                  .row = kBlockEdge,
                  .slab = kBlockEdge * kBlockEdge,
                  // A block may begin outside the window; offsets of its voxels are right modulo 2^32.
                  .at = static_cast<std::uint32_t>(in_window.z) * slab + static_cast<std::uint32_t>(in_window.y) * row +
                        static_cast<std::uint32_t>(in_window.x),
                  .window_row = row,
                  .window_slab = slab,
                  .base = block->base.data(),
                  .cut = block->cut.data(),
                  .parts = 0,
                  .lo = {lo.x, lo.y, lo.z},
                  .hi = {hi.x, hi.y, hi.z}};
  for (std::uint32_t part = 0; part < 8; ++part)
    if (parts == nullptr || !is_quiet(sweep, at, (*parts)[part], has_block)) out.parts |= 1u << part;
  const VoxelBox whole{corner, corner + kBlockEdge};
  if (out.parts == 0) return out;
  if (window.box.contains(whole)) {
    out.occupancy = window.occupancy.data() + out.at;
    out.remaining = window.remaining.data() + out.at;
    out.row = row;
    out.slab = slab;
  } else {
    occupancy_.fill(0.0f);
    remaining_.fill(0.0f);
    const VoxelBox inside = whole.intersect(window.box);
    copy_part(inside, window.box, window.occupancy.data(), whole, occupancy_.data());
    copy_part(inside, window.box, window.remaining.data(), whole, remaining_.data());
  }
  return out;
}

double CutFace::radius(std::size_t node) const noexcept {
  const Vec3 p = field_->origin + field_->pitch * Vec3(Vec3f(nodes_.x[node], nodes_.y[node], nodes_.z[node]));
  return std::sqrt(p.x * p.x + p.y * p.y);
}

void CutFace::start_lacking(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& at, const BlockSearch& search,
                            CutSurface::Block& block) {
  const MasterWindow& window = voxmap.window();
  for (std::size_t n = 0; n < found_.lacking_count; ++n) {
    const std::uint32_t inside = found_.lacking[n];
    const float tool = found_.lacking_tool[n];
    const Vec3i in_block = place_in_block(inside), part = in_block / kPart;
    float& room = found_.room[static_cast<std::size_t>(part.x + 2 * part.y + 4 * part.z)];
    if (block.base[inside] == CutSurface::kUnset) {
      room = 0.0f;
      continue;
    }
    const Vec3i voxel = at * kBlockEdge + in_block;
    const Vec3f i(in_block), place = Vec3f(search.first[0], search.first[1], search.first[2]) + Vec3f(sweep.place.linear * Vec3(i));
    const std::size_t here = window.box.offset_of(voxel);
    const bool bone = window.occupancy[here] > 0.0f && window.remaining[here] > 0.0f;
    start(voxmap, sweep, voxel, place, tool, block, inside);
    const float cut = block.cut[inside];
    if (cut > kFree && !bone) continue;
    if (cut <= -kKnown) {
      room = 0.0f;
      unknown_.push_back({&block.cut[inside], tool});
      if (bone && tool < 0.0f) {
        const Vec3 p = field_->origin + field_->pitch * Vec3(place);
        buried_.push_back({static_cast<std::uint32_t>(here), tool, sampler_.factor(place) / std::max(window.hardness[here], kLeastHardness),
                           static_cast<float>(std::sqrt(p.x * p.x + p.y * p.y))});
      }
      continue;
    }
    room = std::min(room, std::max(0.0f, tool + cut));
    if (tool + cut >= 0.0f) continue;
    const std::size_t to = nodes_.count++;
    nodes_.at[to] = static_cast<std::uint32_t>(here);
    nodes_.inside[to] = inside;
    nodes_.x[to] = place.x, nodes_.y[to] = place.y, nodes_.z[to] = place.z;
    nodes_.tool[to] = tool, nodes_.cut[to] = cut, nodes_.base[to] = block.base[inside];
  }
}

void CutFace::note_quiet(const Sweep& sweep, const BlockSearch& search, bool has_block, QuietParts& parts) const noexcept {
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if ((search.parts >> part & 1u) == 0) continue;
    const float room = has_block ? found_.room[part] : found_.nearest[part] - kFollow;
    parts[part] = {sweep.place, std::max(0.0f, std::min(kBand, room) - kReserve), !has_block};
  }
}

/// Appends the voxels of one block whose face overlaps the tool.
void CutFace::visit(Voxmap& voxmap, const Sweep& sweep, const Vec3i& at) {
  const MasterWindow& window = voxmap.window();
  CutSurface::Block* block = voxmap.cut().find(at);
  if (block != nullptr && block->free) return;
  const VoxelBox whole = box_of_block(at), box = whole.intersect(sweep.erodible);
  const bool all = box == whole;
  QuietParts* const known = all ? &quiet_[key_of_block(at)] : nullptr;
  BlockSearch search = search_of(window, sweep, box, block, known);
  if (search.parts == 0) return;
  const std::size_t first = nodes_.count;
  nodes_.make_room(kBlockVoxels);
  search_block(tool_, search, nodes_, found_);
  const float nearest = *std::min_element(found_.nearest.begin(), found_.nearest.end());
  if (search.parts == kAllParts && nearest == std::numeric_limits<float>::max()) {
    if (block != nullptr) block->free = all;
    return;
  }
  if (nearest > kFollow) {
    if (known != nullptr) note_quiet(sweep, search, block != nullptr, *known);
    return;
  }
  if (block == nullptr || !block->complete) {
    if (block == nullptr) block = &voxmap.cut().add(at);
    complete(voxmap, at, *block);
    search = search_of(window, sweep, box, block, nullptr);
    nodes_.count = first;
    search_block(tool_, search, nodes_, found_);
  }
  start_lacking(voxmap, sweep, at, search, *block);
  if (nodes_.count > first) runs_.push_back({block, first});
  if (known != nullptr) note_quiet(sweep, search, true, *known);
}

void CutFace::note_earlier_cuts() {
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const std::size_t last = r + 1 < runs_.size() ? runs_[r + 1].first : nodes_.count;
    for (std::size_t n = runs_[r].first; n < last; ++n) nodes_.cut_before[n] = runs_[r].block->cut_before[nodes_.inside[n]] ? 1 : 0;
  }
}

std::span<const float> CutFace::recede(double turns) {
  for (std::vector<float>* list : {&shares_, &after_, &back_})
    if (list->size() < nodes_.count + kFieldPad) list->resize(nodes_.x.size());
  find_shares(nodes_, static_cast<float>(turns), shares_.data());
  recede_nodes(tool_, nodes_, shares_.data(), after_.data(), back_.data());
  return {after_.data(), nodes_.count};
}

void CutFace::open() noexcept {
  for (const auto& [cut, tool] : unknown_) *cut = std::max(*cut, -tool);
}

void CutFace::keep() {
  if (steps_.size() < nodes_.count + kFieldPad) steps_.resize(nodes_.x.size());
  quantise_distances(after_.data(), nodes_.base.data(), nodes_.count, steps_.data());
  turned_.clear();
  asked_.resize(nodes_.count);
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    CutSurface::Block& block = *runs_[r].block;
    const std::size_t last = r + 1 < runs_.size() ? runs_[r + 1].first : nodes_.count;
    for (std::size_t n = runs_[r].first; n < last; ++n) {
      const std::uint32_t inside = nodes_.inside[n];
      const float cut = after_[n], base = nodes_.base[n];
      block.cut[inside] = cut;
      block.record[inside].distance = steps_[n];
      if (cut < (base < 0.0f ? base - kSharedDepth : 0.0f)) continue;
      const std::int16_t known = block.normal_at[inside];
      if (std::abs(cut - static_cast<float>(kRecord16Distance) * static_cast<float>(known)) < kNewNormal && known != 0) continue;
      const std::size_t to = turned_.size();
      turned_.push_back({&block, inside});
      asked_.x[to] = nodes_.x[n] - back_[n] * along_.x;
      asked_.y[to] = nodes_.y[n] - back_[n] * along_.y;
      asked_.z[to] = nodes_.z[n] - back_[n] * along_.z;
    }
  }
  asked_.count = turned_.size();
  renew_normals();
}

/// Normals of faces that have moved.
void CutFace::renew_normals() {
  for (std::vector<std::int16_t>& list : normals_)
    if (list.size() < asked_.count + kFieldPad) list.resize(2 * asked_.count + kFieldPad);
  find_normals(tool_, {asked_.count, asked_.x.data(), asked_.y.data(), asked_.z.data()},
               {normals_[0].data(), normals_[1].data(), normals_[2].data()});
  for (std::size_t n = 0; n < asked_.count; ++n) {
    const auto& [block, inside] = turned_[n];
    Record16& record = block->record[inside];
    const std::int16_t x = normals_[0][n], y = normals_[1][n], z = normals_[2][n];
    if (x == 0 && y == 0 && z == 0) continue;
    record.nx = x, record.ny = y, record.nz = z;
    const float cut = std::clamp(block->cut[inside], -kBand, kBand);
    block->normal_at[inside] = static_cast<std::int16_t>(std::lrint(cut / static_cast<float>(kRecord16Distance)));
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
  // A face turns once it has moved by kNewNormal: half of the nodes at most in a usual step.
  constexpr std::size_t kTurned = sizeof(std::pair<CutSurface::Block*, std::uint32_t>) + 3 * sizeof(std::int16_t),
                        kPlace = 3 * sizeof(float);
  return nodes * (FaceNodes::bytes_of_node() + 3 * sizeof(float) + sizeof(std::int16_t) + kPlace + kTurned / 2);
}

}  // namespace burrhole
