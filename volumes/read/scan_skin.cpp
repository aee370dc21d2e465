#include "volumes/read/scan_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr float kSkin = -400.0f, kBone = 250.0f, kRamp = 500.0f;  // [HU]
constexpr int kClosed = 2;                                        // [voxels] half the width of openings that are closed
constexpr int kSmoothed = 2;                                      // times that the field is smoothed

using Mask = std::vector<std::uint8_t>;

constexpr std::array<Vec3i, 6> kFaces{Vec3i(-1, 0, 0), Vec3i(1, 0, 0), Vec3i(0, -1, 0), Vec3i(0, 1, 0), Vec3i(0, 0, -1), Vec3i(0, 0, 1)};

/// The scan as means over boxes of voxels.
ScanSkin shrink_scan(const Scan& scan, double offset, double pitch) {
  ScanSkin out;
  Vec3i factor;
  for (glm::length_t a = 0; a < 3; ++a)
    factor[a] = std::clamp(static_cast<int>(std::lround(pitch / glm::length(scan.bone_from_index.linear[a]))), 1, scan.dims[a]);
  out.dims = scan.dims / factor;
  const Mat3& edges = scan.bone_from_index.linear;
  out.bone_from_index = {Mat3(edges[0] * double(factor.x), edges[1] * double(factor.y), edges[2] * double(factor.z)),
                         scan.bone_from_index * (0.5 * Vec3(factor - 1))};
  out.index_from_bone = out.bone_from_index.inverse();
  const VoxelBox all{Vec3i(0), out.dims}, of_scan{Vec3i(0), scan.dims};
  out.value.resize(all.count());
  const double share = 1.0 / (static_cast<double>(factor.x) * factor.y * factor.z);
  for_each_number(out.dims.z, [&](int k) {
    for_each_voxel({{0, 0, k}, {out.dims.x, out.dims.y, k + 1}}, [&](const Vec3i& v) {
      double sum = 0.0;
      for_each_voxel({factor * v, factor * (v + 1)},
                     [&](const Vec3i& w) { sum += static_cast<double>(scan.values[of_scan.offset_of(w)]); });
      out.value[all.offset_of(v)] = static_cast<float>(share * sum + offset);
    });
  });
  return out;
}

/// @returns the voxels that have a neighbour in the mask, or are in it.
Mask grown(const Mask& mask, const VoxelBox& all) {
  Mask out = mask;
  for_each_voxel(all, [&](const Vec3i& v) {
    if (mask[all.offset_of(v)] == 0) return;
    for (const Vec3i& step : kFaces)
      if (all.contains(v + step)) out[all.offset_of(v + step)] = 1;
  });
  return out;
}

Mask inverted(Mask mask) {
  for (std::uint8_t& value : mask) value = value == 0 ? 1 : 0;
  return mask;
}

/// At the sides of the scan nothing is taken away.
Mask shrunk(const Mask& mask, const VoxelBox& all) { return inverted(grown(inverted(mask), all)); }

/// Marks what is joined to the voxels in `stack` by faces within the mask, as `mark`. Calls f for each voxel.
template <class F>
void flood(std::vector<Vec3i> stack, const Mask& mask, const VoxelBox& all, std::uint8_t mark, Mask& out, const F& f) {
  while (!stack.empty()) {
    const Vec3i v = stack.back();
    stack.pop_back();
    std::uint8_t& here = out[all.offset_of(v)];
    if (here == mark || mask[all.offset_of(v)] == 0) continue;
    here = mark;
    f(v);
    for (const Vec3i& step : kFaces)
      if (all.contains(v + step)) stack.push_back(v + step);
  }
}

/// @returns the component of the mask with most bone; nothing if there is none.
Mask find_body(const Mask& tissue, const std::vector<float>& hu, const VoxelBox& all) {
  const Mask core = shrunk(tissue, all);
  Mask seen(core.size()), body(core.size());
  Vec3i start(-1);
  std::size_t most = 0;
  for_each_voxel(all, [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    if (core[n] == 0 || seen[n] != 0) return;
    std::size_t bone = 0;
    flood({v}, core, all, 1, seen, [&](const Vec3i& w) { bone += hu[all.offset_of(w)] >= kBone ? 1 : 0; });
    if (bone > most) most = bone, start = v;
  });
  if (most == 0) return body;
  flood({start}, core, all, 1, body, [](const Vec3i&) {});
  // The layer, and corners that lost two.
  for (int n = 0; n < 2; ++n) {
    body = grown(body, all);
    std::transform(body.begin(), body.end(), tissue.begin(), body.begin(), [](std::uint8_t a, std::uint8_t b) { return a & b; });
  }
  return body;
}

/// @returns what air reaches from the sides of the scan, through openings wider than twice kClosed.
Mask find_outside(const Mask& body, const VoxelBox& all) {
  Mask wide = body;
  for (int n = 0; n < kClosed; ++n) wide = grown(wide, all);
  const Mask open = inverted(std::move(wide));
  std::vector<Vec3i> sides;
  for_each_voxel(all, [&](const Vec3i& v) {
    if (glm::any(glm::equal(v, all.lo)) || glm::any(glm::equal(v, all.hi - 1))) sides.push_back(v);
  });
  Mask out(body.size());
  flood(std::move(sides), open, all, 1, out, [](const Vec3i&) {});
  for (int n = 0; n < kClosed; ++n) {
    out = grown(out, all);
    std::transform(out.begin(), out.end(), body.begin(), out.begin(), [](std::uint8_t a, std::uint8_t b) { return a & (b == 0 ? 1 : 0); });
  }
  return out;
}

void smooth_along(std::vector<float>& values, const VoxelBox& all, const Vec3i& step) {
  const std::vector<float> from = values;
  for_each_voxel(all, [&](const Vec3i& v) {
    const auto at = [&](const Vec3i& w) { return from[all.offset_of(glm::clamp(w, all.lo, all.hi - 1))]; };
    values[all.offset_of(v)] = 0.25f * at(v - step) + 0.5f * at(v) + 0.25f * at(v + step);
  });
}

}  // namespace

double ScanSkin::at(const Vec3& p_bone) const noexcept {
  const Vec3 index = index_from_bone * p_bone, half = 0.5 * Vec3(dims - 1);
  const Vec3 beyond = glm::abs(index - half) - half;
  const double side = bone_from_index.mean_edge() * std::max({beyond.x, beyond.y, beyond.z});
  if (side >= 0.0) return side;
  return std::max(side, trilinear({Vec3i(0), dims}, value.data(), index));
}

Bounds ScanSkin::box() const noexcept { return bounds_under(bone_from_index, Bounds{Vec3(-1.5), Vec3(dims) + 0.5}); }

Result<ScanSkin> find_scan_skin(const Scan& scan, double offset, double pitch) {
  ScanSkin out = shrink_scan(scan, offset, pitch);
  const VoxelBox all{Vec3i(0), out.dims};
  Mask tissue(out.value.size());
  std::transform(out.value.begin(), out.value.end(), tissue.begin(), [](float hu) { return static_cast<std::uint8_t>(hu > kSkin); });
  const Mask body = find_body(tissue, out.value, all);
  if (std::none_of(body.begin(), body.end(), [](std::uint8_t b) { return b != 0; }))
    return bad_input("the scan has no skin: no bone in soft tissue above -400 HU");
  const Mask outside = find_outside(body, all);
  const float scale = static_cast<float>(out.bone_from_index.mean_edge());
  for (std::size_t n = 0; n < out.value.size(); ++n) {
    float& value = out.value[n];
    if (outside[n] == 0)
      value = body[n] != 0 ? -scale * std::clamp((value - kSkin) / kRamp, 0.05f, 1.0f) : -scale;
    else  // tissue that is not the body's is left out
      value = tissue[n] != 0 ? scale : scale * std::clamp((kSkin - value) / kRamp, 0.05f, 1.0f);
  }
  for (int n = 0; n < kSmoothed; ++n)
    for (const Vec3i& step : {Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)}) smooth_along(out.value, all, step);
  return out;
}

}  // namespace burrhole
