#include "core/voxel/voxmap.h"

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/gradient.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

struct Voxmap::Store {
  FloatVdb remaining{"remaining", 1.0f};
};

Voxmap::Voxmap(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config)
    : bone_(std::move(bone)), config_(config), store_(std::make_unique<Store>()) {
  window_.gradient_dead_zone = config.gradient_dead_zone;
}
Voxmap::Voxmap(Voxmap&&) noexcept = default;
Voxmap& Voxmap::operator=(Voxmap&&) noexcept = default;
Voxmap::~Voxmap() = default;

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
  for (const int edge : {size.x, size.y, size.z})
    if (edge < 5 || edge > kMaxWindowEdge)
      return Error{ErrorCode::out_of_range,
                   "the window would be " + std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z) +
                       " voxels; each edge must be in [5, " + std::to_string(kMaxWindowEdge) + "]",
                   {}};
  write_back();
  if (kept_by_slide(window_.box, box, 1).empty())
    load_window(box);
  else
    slide_window(box);
  return {};
}

void Voxmap::load_window(const VoxelBox& box) {
  const std::size_t n = box.count();
  window_.box = box;
  for (std::vector<float>* field : {&window_.occupancy, &window_.hardness, &window_.remaining, &window_.density}) field->resize(n);
  bone_->read_occupancy(box, window_.occupancy);
  bone_->read_hardness(box, window_.hardness);
  store_->remaining.read_box(box, window_.remaining);
  for (std::size_t i = 0; i < n; ++i) window_.density[i] = window_.occupancy[i] * window_.remaining[i];
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
  std::vector<float> occupancy(part.count()), read(part.count());
  const auto place = [&](std::vector<float>& field) { copy_part(part, part, read.data(), window_.box, field.data()); };
  bone_->read_hardness(part, read);
  place(window_.hardness);
  bone_->read_occupancy(part, occupancy);
  copy_part(part, part, occupancy.data(), window_.box, window_.occupancy.data());
  store_->remaining.read_box(part, read);
  place(window_.remaining);
  for (std::size_t i = 0; i < read.size(); ++i) read[i] = occupancy[i] * read[i];
  place(window_.density);
}

void Voxmap::commit(const VoxelBox& touched) noexcept {
  if (touched.empty()) return;
  BH_ASSERT(window_.erodible_box().contains(touched));
  update_density(window_.occupancy, window_.remaining, window_.box, touched, window_.density);
  unsaved_ = unsaved_.unite(touched);
  for (DirtyBoxes& listener : listeners_) listener.add(touched.grown(1));
}

std::size_t Voxmap::add_listener() {
  listeners_.emplace_back();
  return listeners_.size() - 1;
}

std::vector<VoxelBox> Voxmap::take_dirty(std::size_t listener) { return listeners_.at(listener).take(); }

void Voxmap::write_back() {
  if (unsaved_.empty()) return;
  std::vector<float> part(unsaved_.count());
  copy_part(unsaved_, window_.box, window_.remaining.data(), unsaved_, part.data());
  store_->remaining.write_box(unsaved_, part);
  unsaved_ = {};
}

void Voxmap::read_remaining(const VoxelBox& box, std::span<float> out) {
  write_back();
  store_->remaining.read_box(box, out);
}

void Voxmap::read_density(const VoxelBox& box, std::span<float> out) {
  read_remaining(box, out);
  std::vector<float> occupancy(box.count());
  bone_->read_occupancy(box, occupancy);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = occupancy[i] * out[i];
}

void Voxmap::read_gradient(const VoxelBox& box, std::span<Vec3f> out) {
  const VoxelBox halo = box.grown(1);
  std::vector<float> density(halo.count());
  read_density(halo, density);
  update_gradient({halo, density}, box, config_.gradient_dead_zone, box, out);
}

Status Voxmap::save(const std::string& path) {
  write_back();
  std::vector<const FloatVdb*> grids = bone_->grids();
  grids.push_back(&store_->remaining);
  return write_vdb(path, bone_->dims(), bone_->bone_from_index(), grids, bone_->notes());
}

Status Voxmap::restore(const std::string& path) {
  auto content = read_vdb(path);
  if (!content) return content.error();
  FloatVdb* found = nullptr;
  for (FloatVdb& grid : content->grids)
    if (grid.name() == "remaining") found = &grid;
  if (found == nullptr) return bad_input("holds no grid named remaining: it is not a checkpoint", path);
  if (content->dims != bone_->dims() || found->background() != 1.0f)
    return bad_input("was saved from another bone: the dimensions differ", path);
  bool sound = true;
  found->for_each_sorted([&](const Vec3i&, float value) { sound = sound && value >= 0.0f && value <= 1.0f; });
  if (!sound) return bad_input("holds a remaining outside 0..1 or not finite", path);

  const VoxelBox changed = changed_bounds().unite(found->active_bounds());
  store_->remaining = std::move(*found);
  unsaved_ = {};
  if (!window_.box.empty()) load_window(window_.box);
  for (DirtyBoxes& listener : listeners_)
    if (!changed.empty()) listener.add(changed.grown(1));
  ++growth_epoch_;
  return {};
}

std::uint64_t Voxmap::hash() {
  write_back();
  Hash64 hash;
  store_->remaining.for_each_sorted([&](const Vec3i& v, float value) {
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.x)));
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.y)));
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(v.z)));
    hash.add(value);
  });
  return hash.value();
}

VoxelBox Voxmap::changed_bounds() {
  write_back();
  return store_->remaining.active_bounds();
}

std::size_t Voxmap::bytes() const { return bone_->bytes() + store_->remaining.bytes() + window_.bytes(); }

}  // namespace burrhole
