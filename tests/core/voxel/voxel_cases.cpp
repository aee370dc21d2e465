#include "tests/core/voxel/voxel_cases.h"

#include <cstdlib>

#include "core/base/random.h"

namespace burrhole::test {
namespace {

std::string place(const char* what, const Vec3i& v) {
  return std::string(what) + " at (" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

std::size_t position(const VoxelBox& box, const Vec3i& v) {
  const std::size_t nx = static_cast<std::size_t>(box.hi.x - box.lo.x), ny = static_cast<std::size_t>(box.hi.y - box.lo.y);
  return static_cast<std::size_t>(v.x - box.lo.x) +
         nx * (static_cast<std::size_t>(v.y - box.lo.y) + ny * static_cast<std::size_t>(v.z - box.lo.z));
}

bool holds(const VoxelBox& box, const Vec3i& v) {
  return box.lo.x <= v.x && v.x < box.hi.x && box.lo.y <= v.y && v.y < box.hi.y && box.lo.z <= v.z && v.z < box.hi.z;
}

}  // namespace

DenseBone random_bone(const Vec3i& dims, std::uint64_t seed) {
  DenseBone dense;
  dense.dims = dims;
  dense.bone_from_index = Affine::scaling(0.25e-3, Vec3(0.0));
  const auto count = static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
  for (std::size_t n = 0; n < count; ++n) {
    const double kind = uniform01(seed, 4 * n), value = uniform01(seed, 4 * n + 1);
    dense.occupancy.push_back(kind < 1.0 / 3.0 ? 0.0f : kind < 2.0 / 3.0 ? 1.0f : static_cast<float>(value));
    dense.hardness.push_back(static_cast<float>(uniform01(seed, 4 * n + 2)));
    dense.labels.push_back(static_cast<std::uint8_t>(8.0 * uniform01(seed, 4 * n + 3)));
  }
  return dense;
}

std::shared_ptr<const BoneModel> load_bone(const DenseBone& dense) {
  auto bone = BoneModel::create(dense);
  if (!bone) std::abort();
  return *bone;
}

Voxmap make_voxmap(std::shared_ptr<const BoneModel> bone, float dead_zone) {
  auto voxmap = Voxmap::create(std::move(bone), {.gradient_dead_zone = dead_zone});
  if (!voxmap) std::abort();
  return std::move(voxmap).value();
}

double Dice::next() { return uniform01(seed, counter++); }
int Dice::next_below(int below) { return static_cast<int>(next() * below); }

VoxelBox Dice::box_inside(const VoxelBox& inside, int longest) {
  VoxelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int room = inside.hi[axis] - inside.lo[axis];
    const int edge = 1 + next_below(std::min(longest, room));
    box.lo[axis] = inside.lo[axis] + next_below(room - edge + 1);
    box.hi[axis] = box.lo[axis] + edge;
  }
  return box;
}

PlainTwin::PlainTwin(const DenseBone& dense, float dead_zone)
    : grid_{Vec3i(0), dense.dims},
      reach_{Vec3i(-16), dense.dims + 16},
      dead_zone_(dead_zone),
      occupancy_(dense.occupancy),
      remaining_(reach_.count(), 1.0f) {}

float PlainTwin::remaining(const Vec3i& v) const { return holds(reach_, v) ? remaining_[position(reach_, v)] : 1.0f; }
void PlainTwin::set_remaining(const Vec3i& v, float value) { remaining_.at(position(reach_, v)) = value; }
float PlainTwin::density(const Vec3i& v) const { return holds(grid_, v) ? occupancy_[position(grid_, v)] * remaining(v) : 0.0f; }

Vec3f PlainTwin::gradient(const Vec3i& v) const {
  Vec3f g;
  g.x = (density({v.x + 1, v.y, v.z}) - density({v.x - 1, v.y, v.z})) / 2.0f;
  g.y = (density({v.x, v.y + 1, v.z}) - density({v.x, v.y - 1, v.z})) / 2.0f;
  g.z = (density({v.x, v.y, v.z + 1}) - density({v.x, v.y, v.z - 1})) / 2.0f;
  const bool dead = g.x * g.x + g.y * g.y + g.z * g.z < dead_zone_ * dead_zone_;
  return dead ? Vec3f(0.0f) : g;
}

void erode_box(Voxmap& voxmap, PlainTwin& twin, const VoxelBox& box, Dice& dice) {
  for_each_voxel(box, [&](const Vec3i& v) {
    float& left = voxmap.remaining()[position(voxmap.window().box, v)];
    const double kind = dice.next();
    if (kind < 1.0 / 3.0)
      left = 0.0f;
    else if (kind < 2.0 / 3.0)
      left *= static_cast<float>(dice.next());
    twin.set_remaining(v, left);
  });
  voxmap.commit(box);
}

VoxelBox random_window(const VoxelBox& grid, Dice& dice) {
  VoxelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int edge = 8 + dice.next_below(13);
    box.lo[axis] = grid.lo[axis] - 6 + dice.next_below(std::max(1, grid.hi[axis] - grid.lo[axis] + 12 - edge));
    box.hi[axis] = box.lo[axis] + edge;
  }
  return box;
}

std::vector<Vec3f> gradients_of(const MasterWindow& window) {
  std::vector<Vec3f> out(window.box.count(), Vec3f(9.0f));
  derive_gradient(window, window.box, out);
  return out;
}

std::string difference(const MasterWindow& window, const PlainTwin& twin) {
  const std::vector<Vec3f> gradient = gradients_of(window);
  for (int k = window.box.lo.z; k < window.box.hi.z; ++k)
    for (int j = window.box.lo.y; j < window.box.hi.y; ++j)
      for (int i = window.box.lo.x; i < window.box.hi.x; ++i) {
        const Vec3i v(i, j, k);
        const std::size_t n = position(window.box, v);
        if (window.remaining[n] != twin.remaining(v)) return place("remaining", v);
        if (window.density[n] != twin.density(v)) return place("density", v);
        const bool edge = i == window.box.lo.x || j == window.box.lo.y || k == window.box.lo.z || i == window.box.hi.x - 1 ||
                          j == window.box.hi.y - 1 || k == window.box.hi.z - 1;
        if (gradient[n] != (edge ? Vec3f(0.0f) : twin.gradient(v))) return place("gradient", v);
      }
  return {};
}

std::string uncovered_change(const MasterWindow& before, const MasterWindow& after, std::span<const VoxelBox> dirty) {
  std::string first;
  const std::vector<Vec3f> gradient_before = gradients_of(before), gradient_after = gradients_of(after);
  for_each_voxel(before.box.intersect(after.box), [&](const Vec3i& v) {
    const std::size_t a = position(before.box, v), b = position(after.box, v);
    if (before.density[a] == after.density[b] && gradient_before[a] == gradient_after[b]) return;
    bool covered = false;
    for (const VoxelBox& box : dirty) covered = covered || holds(box, v);
    if (!covered && first.empty()) first = place("change", v);
  });
  return first;
}

}  // namespace burrhole::test
