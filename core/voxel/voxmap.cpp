#include "core/voxel/voxmap.h"

#include "core/base/assert.h"
#include "core/voxel/gradient.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

struct Voxmap::Store {
  FloatVdb remaining{"remaining", 1.0f};
};

namespace {

/// Copies the values of `part` between two dense arrays.
template <class T>
void copy_part(const VoxelBox& part, const VoxelBox& from_box, std::span<const T> from, const VoxelBox& to_box, std::span<T> to) {
  if (part.empty()) return;
  const auto row = static_cast<std::size_t>(part.size().x);
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j) {
      const Vec3i start(part.lo.x, j, k);
      std::copy_n(from.data() + from_box.offset_of(start), row, to.data() + to_box.offset_of(start));
    }
}

}  // namespace

Voxmap::Voxmap(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config)
    : bone_(std::move(bone)), config_(config), store_(std::make_unique<Store>()) {}
Voxmap::Voxmap(Voxmap&&) noexcept = default;
Voxmap& Voxmap::operator=(Voxmap&&) noexcept = default;
Voxmap::~Voxmap() = default;

Result<Voxmap> Voxmap::create(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config) {
  if (!(config.gradient_dead_zone >= 0.0f && config.gradient_dead_zone < 0.5f)) return bad_input("gradient dead zone must be in [0, 0.5)");
  return Voxmap(std::move(bone), config);
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
  load_window(box);
  return {};
}

void Voxmap::load_window(const VoxelBox& box) {
  const std::size_t n = box.count();
  window_.box = box;
  for (std::vector<float>* field : {&window_.occupancy, &window_.hardness, &window_.remaining, &window_.density}) field->resize(n);
  window_.gradient.assign(n, Vec3f(0.0f));
  bone_->read_occupancy(box, window_.occupancy);
  bone_->read_hardness(box, window_.hardness);
  store_->remaining.read_box(box, window_.remaining);
  for (std::size_t i = 0; i < n; ++i) window_.density[i] = window_.occupancy[i] * window_.remaining[i];
  update_gradient({box, window_.density}, window_.valid_box(), config_.gradient_dead_zone, box, window_.gradient);
  ++window_epoch_;
}

void Voxmap::commit(const VoxelBox& touched) noexcept {
  if (touched.empty()) return;
  BH_ASSERT(window_.erodible_box().contains(touched));
  for (int k = touched.lo.z; k < touched.hi.z; ++k)
    for (int j = touched.lo.y; j < touched.hi.y; ++j) {
      const std::size_t start = window_.box.offset_of({touched.lo.x, j, k});
      for (std::size_t n = start; n < start + static_cast<std::size_t>(touched.size().x); ++n)
        window_.density[n] = window_.occupancy[n] * window_.remaining[n];
    }
  const VoxelBox halo = touched.grown(1);
  update_gradient({window_.box, window_.density}, halo, config_.gradient_dead_zone, window_.box, window_.gradient);
  unsaved_ = unsaved_.unite(touched);
  for (DirtyBoxes& listener : listeners_) listener.add(halo);
}

std::size_t Voxmap::add_listener() {
  listeners_.emplace_back();
  return listeners_.size() - 1;
}

std::vector<VoxelBox> Voxmap::take_dirty(std::size_t listener) { return listeners_.at(listener).take(); }

void Voxmap::write_back() {
  if (unsaved_.empty()) return;
  std::vector<float> part(unsaved_.count());
  copy_part<float>(unsaved_, window_.box, window_.remaining, unsaved_, part);
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
