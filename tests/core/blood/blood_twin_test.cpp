// Voxels whose surroundings did not change are not updated again: a twin that updates every voxel of every box has the same bits.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/blood/blood_site.h"

using namespace burrhole;

namespace {

constexpr Vec3i kBeside[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
constexpr double kEdge = 0.3e-3, kCoagulation = 2.0;

SiteBone noisy_block() {
  SiteBone out{.box = {Vec3i(3, -2, 5), Vec3i(25, 17, 22)}, .bone_from_index = Affine::scaling(kEdge, Vec3(1e-3, 0.0, 2e-3))};
  std::uint64_t n = 0;
  for_each_voxel(out.box, [&](const Vec3i& v) {
    out.whole.push_back(v.z < 19 ? static_cast<float>(0.6 + 0.4 * uniform01(1, n)) : 0.0f);
    out.start.push_back(uniform01(2, n) < 0.1 ? 0.5f * out.whole.back() : out.whole.back());
    out.pores.push_back(std::max(0.0f, static_cast<float>(uniform11(3, n))));
    out.outside.push_back(v.z < 19 ? 0 : 1);
    ++n;
  });
  return out;
}

/// Each voxel of a box is updated; layers are one voxel high, as z is up.
class PlainSite {
 public:
  explicit PlainSite(const SiteBone& bone)
      : bone_(bone), area(bone.box.count()), cut_(bone.box.count()), opened_(bone.box.count()), removed(bone.box.count()) {
    pores_.resize(static_cast<std::size_t>(bone.box.size().z));
    sources_.resize(pores_.size());
  }
  void update(const VoxelBox& changed, std::span<const float> density, double now) {
    const VoxelBox of = changed.grown(1);
    for_each_voxel(changed, [&](const Vec3i& v) {
      const auto value = [&](const Vec3i& at) { return density[of.offset_of(at)]; };
      const std::size_t at = bone_.box.offset_of(v);
      const float gone = std::clamp(bone_.whole[at] - value(v), 0.0f, 1.0f);
      removed[at] = static_cast<std::uint16_t>(std::lround(gone * 65535.0f));
      if (!(bone_.pores[at] > 0.0f)) return;
      const auto is_gone = [&](const Vec3i& p) { return bone_.box.contains(p) && bone_.start[bone_.box.offset_of(p)] - value(p) > 1e-3f; };
      const bool was_cut = is_gone(v) || std::ranges::any_of(kBeside, [&](const Vec3i& step) { return is_gone(v + step); });
      const auto slope = [&](const Vec3i& s) { return 0.5 * (static_cast<double>(value(v + s)) - static_cast<double>(value(v - s))); };
      const Vec3 gradient(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1}));
      const Mat3 from_slope = glm::transpose(glm::inverse(bone_.bone_from_index.linear));
      open(at, static_cast<std::size_t>(v.z - bone_.box.lo.z),
           was_cut ? glm::length(from_slope * gradient) * bone_.bone_from_index.cell_volume() : 0.0, now);
    });
  }
  void decay(double factor) {
    for (double& one : pores_) one *= factor;
  }
  [[nodiscard]] double drive() const {
    double sum = 0.0;
    for (std::size_t n = 0; n < pores_.size(); ++n)
      if (sources_[n] > 0) sum += pores_[n];
    return sum;
  }

 private:
  void open(std::size_t at, std::size_t layer, double cut_area, double now) {
    if (static_cast<float>(cut_area) == cut_[at]) return;
    cut_[at] = static_cast<float>(cut_area);
    const auto pores = static_cast<float>(cut_area * static_cast<double>(bone_.pores[at]));
    const auto before = static_cast<double>(area[at]);
    if (before > 0.0) pores_[layer] -= before * portable_exp(-(now - opened_[at]) / kCoagulation);
    opened_[at] = now;
    pores_[layer] += static_cast<double>(pores);
    sources_[layer] += static_cast<int>(pores > 0.0f) - static_cast<int>(before > 0.0);
    open_pores += static_cast<double>(pores) - before;
    if (sources_[layer] == 0) pores_[layer] = 0.0;
    pores_[layer] = std::max(pores_[layer], 0.0);
    area[at] = pores;
  }
  SiteBone bone_;

 public:
  std::vector<float> area;
  double open_pores = 0.0;

 private:
  std::vector<float> cut_;
  std::vector<double> opened_, pores_;
  std::vector<int> sources_;

 public:
  std::vector<std::uint16_t> removed;
};

/// The present bone, and the boxes of it that a step reports: those round what it changed, some cut into parts that overlap, in any order.
class Bone {
 public:
  explicit Bone(const SiteBone& site) : wide_(site.box.grown(2)), density_(wide_.count(), 0.7f) {
    for_each_voxel(site.box, [&](const Vec3i& v) { density_[wide_.offset_of(v)] = site.start[site.box.offset_of(v)]; });
  }
  [[nodiscard]] std::vector<float> read(const VoxelBox& box) const {
    std::vector<float> out;
    for_each_voxel(box, [&](const Vec3i& v) { out.push_back(density_[wide_.offset_of(v)]); });
    return out;
  }
  void scale(const VoxelBox& box, float by, std::uint64_t seed) {
    for_each_voxel(box, [&](const Vec3i& v) {
      float& one = density_[wide_.offset_of(v)];
      if (uniform01(seed, wide_.offset_of(v)) < 0.4) one = std::min(1.0f, one * by + (by > 1.0f ? 0.1f : 0.0f));
    });
  }

 private:
  VoxelBox wide_;
  std::vector<float> density_;
};

}  // namespace

TEST_CASE(
    "blood: updates have the bits of a twin that updates every voxel, for boxes that overlap, in any order, while bone goes and comes") {
  const SiteBone made = noisy_block();
  Bone bone(made);
  BloodSite site(made);
  PlainSite twin(made);
  double now = 0.0;
  const auto show = [&](const VoxelBox& box) {
    if (box.empty()) return;
    const std::vector<float> density = bone.read(box.grown(1));
    site.update(box, density, now, kCoagulation);
    twin.update(box, density, now);
  };
  const auto same = [&] {
    return std::ranges::equal(site.pore_area(), twin.area) && std::ranges::equal(site.removed(), twin.removed) &&
           site.open_pores() == twin.open_pores && site.drive(1.0, 0.0, 0.0) == twin.drive();
  };
  show(made.box);
  REQUIRE(same());
  for (std::uint64_t n = 0; n < 400; ++n) {
    now += 0.01;
    site.decay(0.995);
    twin.decay(0.995);
    const auto any = [n](std::uint64_t k, int most) { return static_cast<int>(uniform01(21, 16 * n + k) * most); };
    const Vec3i lo = made.box.lo - 1 + Vec3i(any(0, 20), any(1, 18), any(2, 16));
    const VoxelBox touched = VoxelBox{lo, lo + Vec3i(1 + any(3, 6), 1 + any(4, 6), 1 + any(5, 6))}.intersect(made.box.grown(1));
    if (n % 4 != 3) bone.scale(touched, n % 17 == 9 ? 1.2f : 0.7f, n);  // else nothing has changed
    const VoxelBox dirty = touched.grown(1).intersect(made.box);
    std::array parts{dirty, dirty};
    parts[0].hi.x = std::min(dirty.hi.x, dirty.lo.x + 3);
    parts[1].lo.x = std::min(dirty.hi.x, dirty.lo.x + any(6, 4));
    if (n % 3 == 0) std::swap(parts[0], parts[1]);
    if (n % 2 == 0)
      for (const VoxelBox& part : parts) show(part);
    else
      show(dirty);
    REQUIRE(same());
  }
  CHECK(twin.drive() > 1e-8);
  // Sabotage: a change that one of the two is not shown.
  bone.scale(made.box, 0.7f, 999);
  site.update(made.box, bone.read(made.box.grown(1)), now, kCoagulation);
  CHECK(!same());
}
