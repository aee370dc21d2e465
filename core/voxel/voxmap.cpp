#include "core/voxel/voxmap.h"

#include <cstring>

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/gradient.h"
#include "core/voxel/saved_remaining.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

namespace {

constexpr BlockValues kAsLoaded = [] {
  BlockValues out{};
  out.fill(1.0f);
  return out;
}();

bool same_bits(const BlockValues& a, const BlockValues& b) noexcept { return std::memcmp(a.data(), b.data(), sizeof(BlockValues)) == 0; }

}  // namespace

Voxmap::Voxmap(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config) : bone_(std::move(bone)), config_(config) {
  window_.gradient_dead_zone = config.gradient_dead_zone;
  if (bone_->drilled() == nullptr) return;
  bone_->drilled()->for_each_block([this](const Vec3i& block, const BlockValues& values) { blocks_.put(block, values); });
  start_ = first_ = std::shared_ptr<const BlockStore>(bone_, bone_->drilled());
}

Result<Voxmap> Voxmap::create(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config) {
  if (!(config.gradient_dead_zone >= 0.0f && config.gradient_dead_zone < 0.5f)) return bad_input("gradient dead zone must be in [0, 0.5)");
  return Voxmap(std::move(bone), config);
}

void derive_gradient(const MasterWindow& window, const VoxelBox& part, std::span<Vec3f> gradient) noexcept {
  const VoxelBox wanted = part.intersect(window.box), known = wanted.intersect(window.valid_box());
  if (known != wanted) fill_part(wanted, Vec3f(0.0f), window.box, gradient.data());
  update_gradient({window.box, window.density}, known, window.gradient_dead_zone, window.box, gradient);
}

Status Voxmap::place_window(const VoxelBox& box) {
  const Vec3i size = box.size();
  if (!fits_window(size))
    return Error{ErrorCode::out_of_range,
                 "the window would be " + std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z) +
                     " voxels; each edge must be in [" + std::to_string(kLeastWindowEdge) + ", " + std::to_string(kMaxWindowEdge) +
                     "], and all voxels at most " + std::to_string(kMaxWindowVoxels),
                 {}};
  write_back();
  if (kept_by_slide(window_.box, box, 1).empty())
    load_window(box);
  else
    slide_window(box);
  unsaved_.reset(box);
  if (prefetch_ != nullptr) prefetch_->aim(box);
  return bone_->read_status();
}

void Voxmap::load_window(const VoxelBox& box) {
  window_.box = box;
  for (std::vector<float>* field : {&window_.occupancy, &window_.hardness, &window_.remaining, &window_.density})
    field->resize(box.count());
  load_part(box);
  ++window_epoch_;
}

void Voxmap::slide_window(const VoxelBox& box) {
  const VoxelBox from = window_.box;
  for (std::vector<float>* field : {&window_.occupancy, &window_.hardness, &window_.remaining, &window_.density})
    slide_array(from, box, *field);
  window_.box = box;
  for (const VoxelBox& part : box_without(box, from)) load_part(part);
  ++window_epoch_;
}

void Voxmap::load_part(const VoxelBox& part) {
  BlockValues read;
  for_each_voxel(blocks_of(part), [&](const Vec3i& block) {
    const VoxelBox box = box_of_block(block), inside = part.intersect(box);
    if (prefetch_ == nullptr || !prefetch_->copy(inside, window_.box, window_.occupancy.data(), window_.hardness.data())) {
      const std::span values(read.data(), inside.count());
      bone_->read_occupancy(inside, values);
      copy_part(inside, inside, read.data(), window_.box, window_.occupancy.data());
      bone_->read_hardness(inside, values);
      copy_part(inside, inside, read.data(), window_.box, window_.hardness.data());
    }
    const BlockValues* remaining = blocks_.find(block);
    copy_part(inside, box, (remaining != nullptr ? *remaining : kAsLoaded).data(), window_.box, window_.remaining.data());
  });
  update_density(window_.occupancy, window_.remaining, window_.box, part, window_.density);
}

void Voxmap::set_prefetch(BonePrefetch* prefetch) noexcept {
  prefetch_ = prefetch;
  if (prefetch_ != nullptr && !window_.box.empty()) prefetch_->aim(window_.box);
}

void Voxmap::reserve(std::size_t window_voxels, std::size_t blocks) {
  for (std::vector<float>* field : {&window_.occupancy, &window_.hardness, &window_.remaining, &window_.density})
    field->reserve(window_voxels);
  blocks_.reserve(blocks);
}

void Voxmap::commit(const VoxelBox& touched) noexcept {
  if (touched.empty()) return;
  BH_ASSERT(window_.erodible_box().contains(touched));
  update_density(window_.occupancy, window_.remaining, window_.box, touched, window_.density);
  unsaved_.mark(touched);
  for (VoxelBoxes& listener : listeners_) listener.add(touched.grown(1));
}

std::size_t Voxmap::add_listener() {
  listeners_.emplace_back();
  return listeners_.size() - 1;
}

VoxelBoxes Voxmap::take_dirty(std::size_t listener) { return listeners_.at(listener).take(); }

bool Voxmap::put_block(const Vec3i& block, const BlockValues& values) {
  const BlockValues* before = blocks_.find(block);
  if (same_bits(before != nullptr ? *before : kAsLoaded, values)) return false;
  if (keeper_ != nullptr) keeper_->keep(block, before);
  if (same_bits(values, kAsLoaded))
    blocks_.erase(block);
  else
    blocks_.put(block, values);
  return true;
}

void Voxmap::write_back() {
  unsaved_.take([&](const Vec3i& block) {
    const VoxelBox box = box_of_block(block);
    const BlockValues* before = blocks_.find(block);
    BlockValues now = before != nullptr ? *before : kAsLoaded;
    copy_part(box.intersect(window_.box), window_.box, window_.remaining.data(), box, now.data());
    put_block(block, now);
  });
}

void Voxmap::put_blocks(std::span<const BlockChange> changes) {
  write_back();
  for (const BlockChange& change : changes) {
    const BlockValues& values = change.values != nullptr ? *change.values : kAsLoaded;
    if (!put_block(change.block, values)) continue;
    const VoxelBox box = box_of_block(change.block), inside = box.intersect(window_.box);
    if (!inside.empty()) {
      copy_part(inside, box, values.data(), window_.box, window_.remaining.data());
      update_density(window_.occupancy, window_.remaining, window_.box, inside, window_.density);
    }
    for (VoxelBoxes& listener : listeners_) listener.add(box.grown(1));
  }
  raise_start(changes);
  ++growth_epoch_;
  cut_.clear();
  ++window_epoch_;
}

void Voxmap::raise_start(std::span<const BlockChange> changes) {
  if (first_ == nullptr) return;
  const auto raised = std::make_shared<BlockStore>();
  start_->for_each_block([&](const Vec3i& block, const BlockValues& values) { raised->put(block, values); });
  for (const BlockChange& change : changes) {
    const BlockValues* const before = first_->find(change.block);
    if (before == nullptr) continue;
    BlockValues values = *before;
    for (std::size_t n = 0; n < kBlockVoxels; ++n) values[n] = std::max(values[n], change.values != nullptr ? (*change.values)[n] : 1.0f);
    raised->put(change.block, values);
  }
  start_ = raised;
}

void Voxmap::read_remaining(const VoxelBox& box, std::span<float> out) const {
  if (!window_.box.contains(box)) blocks_.read_box(box, out);
  copy_part(box.intersect(window_.box), window_.box, window_.remaining.data(), box, out.data());
}

void Voxmap::read_density(const VoxelBox& box, std::span<float> out) const {
  const VoxelBox inside = box.intersect(window_.box);
  copy_part(inside, window_.box, window_.density.data(), box, out.data());
  if (window_.box.contains(box)) return;
  for (const VoxelBox& part : box_without(box, window_.box)) {
    BlockValues occupancy{}, hardness{};
    for_each_voxel(blocks_of(part), [&](const Vec3i& block) {
      const VoxelBox whole = box_of_block(block), wanted = part.intersect(whole);
      if (prefetch_ == nullptr || !prefetch_->copy(wanted, whole, occupancy.data(), hardness.data())) {
        bone_->read_occupancy(wanted, {hardness.data(), wanted.count()});
        copy_part(wanted, wanted, hardness.data(), whole, occupancy.data());
      }
      const BlockValues* changed = blocks_.find(block);
      const BlockValues& remaining = changed != nullptr ? *changed : kAsLoaded;
      for (std::size_t n = 0; n < occupancy.size(); ++n) occupancy[n] *= remaining[n];
      copy_part(wanted, whole, occupancy.data(), box, out.data());
    });
  }
}

bool Voxmap::is_as_loaded(const VoxelBox& box) const {
  if (!box.intersect(window_.box).empty()) return false;
  bool same = true;
  for_each_voxel(blocks_of(box), [&](const Vec3i& block) { same = same && blocks_.find(block) == nullptr; });
  return same;
}

void Voxmap::read_gradient(const VoxelBox& box, std::span<Vec3f> out) const {
  const VoxelBox halo = box.grown(1);
  std::vector<float> density(halo.count());
  read_density(halo, density);
  update_gradient({halo, density}, box, config_.gradient_dead_zone, box, out);
}

void Voxmap::read_labels(const VoxelBox& box, std::span<float> out) const {
  if (prefetch_ == nullptr) return bone_->read_labels(box, out);
  BlockValues read;
  for_each_voxel(blocks_of(box), [&](const Vec3i& block) {
    const VoxelBox inside = box.intersect(box_of_block(block));
    if (prefetch_->copy_labels(inside, box, out.data())) return;
    bone_->read_labels(inside, {read.data(), inside.count()});
    copy_part(inside, inside, read.data(), box, out.data());
  });
}

Status Voxmap::save(const std::string& path, SavedBone saved) {
  if (saved == SavedBone::whole && bone_->file_bytes())
    return bad_input("a bone whose voxels are in a temporary file cannot be saved whole, only its changes", path);
  write_back();
  FloatVdb remaining(kRemainingGrid, 1.0f);
  blocks_.for_each_block([&](const Vec3i& block, const BlockValues& values) { remaining.write_box(box_of_block(block), values); });
  std::vector<const FloatVdb*> grids;
  if (saved == SavedBone::whole) grids = bone_->grids();
  grids.push_back(&remaining);
  return write_vdb(path, bone_->dims(), bone_->bone_from_index(), grids, bone_->notes());
}

Status Voxmap::restore(const std::string& path) {
  auto content = read_vdb(path);
  if (!content) return content.error();
  FloatVdb* found = nullptr;
  for (FloatVdb& grid : content->grids)
    if (grid.name() == kRemainingGrid) found = &grid;
  if (found == nullptr) return bad_input("holds no grid named remaining: it is not a checkpoint", path);
  if (content->dims != bone_->dims()) return bad_input("was saved from another bone: the dimensions differ", path);
  const Affine &saved = content->bone_from_index, &here = bone_->bone_from_index();
  if (saved.linear != here.linear || saved.offset != here.offset)
    return bad_input("was saved from another bone: it lies at another place", path);
  auto blocks = saved_remaining(*found, bone_->bounds(), path);
  if (!blocks) return blocks.error();
  const auto read = std::make_shared<const BlockStore>(std::move(blocks).value());
  std::vector<BlockChange> changes;
  write_back();
  blocks_.for_each_block([&](const Vec3i& block, const BlockValues&) {
    if (read->find(block) == nullptr) changes.push_back({block, nullptr});
  });
  read->for_each_block([&](const Vec3i& block, const BlockValues& values) { changes.push_back({block, &values}); });
  put_blocks(changes);
  start_ = first_ = read->size() > 0 ? read : nullptr;
  return {};
}

void Voxmap::read_start(const VoxelBox& box, std::span<float> out) const {
  bone_->read_occupancy(box, out);
  if (start_ == nullptr) return;
  std::vector<float> remaining(out.size());
  start_->read_box(box, remaining);
  for (std::size_t n = 0; n < out.size(); ++n) out[n] *= remaining[n];
}

std::uint64_t Voxmap::hash() {
  write_back();
  Hash64 hash;
  blocks_.for_each_sorted([&](const Vec3i& v, float value) {
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.x)));
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.y)));
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.z)));
    hash.add(value);
  });
  return hash.value();
}

VoxelBox Voxmap::changed_bounds() {
  write_back();
  return blocks_.changed_bounds();
}

std::size_t Voxmap::bytes() const {
  return bone_->bytes() + (start_ != nullptr ? start_->bytes() : 0) + blocks_.bytes() + window_.bytes() +
         (prefetch_ != nullptr ? prefetch_->bytes() : 0);
}

}  // namespace burrhole
