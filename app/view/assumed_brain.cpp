#include "app/view/assumed_brain.h"

#include <algorithm>
#include <cmath>

#include "app/view/tissue_texels.h"
#include "core/base/bounds.h"
#include "core/base/parallel.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

/// Layers without dura below them are all that there is. A scan whose layers were found has labels of dura, but no soft tissue to be drawn.
bool has_layers_alone(const std::vector<float>& labels) {
  const auto has = [&](VoxelLabel first, VoxelLabel last) {
    return std::ranges::any_of(labels,
                               [&](float label) { return label >= static_cast<float>(first) && label <= static_cast<float>(last); });
  };
  return has(VoxelLabel::outer_table, VoxelLabel::inner_table) && !has(VoxelLabel::dura, VoxelLabel::brain);
}

constexpr double kPitch = 0.75e-3;  // [m] of the lattice
constexpr double kRadius = 42e-3;   // [m] about the axis, in which they are drawn
constexpr double kReach = 30e-3;    // [m] below the inner surface
constexpr double kAbove = 30e-3;    // [m] start of a column above the entry
constexpr double kBelow = 75e-3;    // [m] end of a column below the entry
constexpr double kGap = 2e-3;       // [m] as in make_approach()
constexpr double kDura = 0.6e-3;    // [m]
constexpr double kInBone = 0.75;    // [voxels] of their surface above the inner surface, so that no slit is drawn between them
// [-] occupancy from which a voxel has the colour of dura, also one of bone: half a voxel above the surface of dura. Where bone is drilled away, the
// colour of dura is sampled three quarters of a voxel below its surface (shade.glsl), between voxels that were bone and voxels that were not.
constexpr double kColored = 0.25;
constexpr int kBisections = 6;
constexpr int kSmoothings = 12;

const Rgba8 kDuraColor{204, 158, 153, 0}, kBrainColor{214, 140, 135, 0};  // as make_colors()

/// Bone as loaded in a box, as dense values.
struct Block {
  VoxelBox box;
  Affine index_from_bone;
  std::vector<float> occupancy;

  [[nodiscard]] double at(const Vec3& p_bone) const {
    const Vec3 index = index_from_bone * p_bone;
    const Vec3i low(glm::floor(index));
    if (glm::any(glm::lessThan(low, box.lo)) || glm::any(glm::greaterThanEqual(low + 1, box.hi))) return 0.0;
    return trilinear(index - Vec3(low), [&](unsigned n) { return static_cast<double>(occupancy[box.offset_of(low + cell_corner(n))]); });
  }
};

Block read_block(const BoneModel& bone, const Pose& bone_from_approach) {
  Block out{{}, bone.bone_from_index().inverse(), {}};
  const double half = kRadius + 2.0 * kPitch;
  for (const Vec3& corner : Bounds{Vec3(-half, -half, -kBelow), Vec3(half, half, kAbove)}.corners())
    out.box.include(Vec3i(glm::floor(out.index_from_bone * (bone_from_approach * corner))));
  out.box = out.box.grown(1).intersect(bone.bounds());
  out.occupancy.resize(out.box.count());
  bone.read_occupancy(out.box, out.occupancy);
  return out;
}

}  // namespace

std::optional<AssumedBrain> AssumedBrain::create(const BoneModel& bone, const Pose& bone_from_approach, double thickness, double edge) {
  if (!(thickness < kThickest)) return std::nullopt;
  const Block block = read_block(bone, bone_from_approach);
  if (block.box.empty()) return std::nullopt;
  std::vector<float> soft(block.box.count());
  bone.read_soft(block.box, soft);
  if (std::ranges::any_of(soft, [](float s) { return s > 0.0f; })) return std::nullopt;
  bone.read_labels(block.box, soft);
  if (has_layers_alone(soft)) return std::nullopt;
  AssumedBrain out(bone_from_approach, edge);
  out.columns_.resize(kColumns * kColumns);
  const double step = 0.5 * bone.bone_from_index().mean_edge();
  const int middle = static_cast<int>(kColumns / 2);
  for_each_number(static_cast<int>(kColumns), [&](int j) {
    for (int i = 0; i < static_cast<int>(kColumns); ++i) {
      Column& column = out.column(i, j);
      const double x = (i - middle) * kPitch, y = (j - middle) * kPitch;
      bool began = false, ended = false;
      double last = 0.0;  // [m] depth of the last bone
      for (double depth = -kAbove; depth < kBelow; depth += step) {
        const bool is_bone = block.at(bone_from_approach * Vec3(x, y, -depth)) >= 0.5;
        if (is_bone && ended) {
          column.next = depth;
          break;
        }
        if (is_bone) {
          began = true;
          last = depth;
        }
        ended = began && depth > last + kGap;
        column.next = depth;
      }
      // Bone that ends at the edge of the volume has no inner surface there.
      const Vec3 end = block.index_from_bone * (bone_from_approach * Vec3(x, y, -last - kGap));
      column.found = ended && glm::all(glm::greaterThan(end, Vec3(0.0))) && glm::all(glm::lessThan(end, Vec3(bone.dims() - 1)));
      double free = last + step;  // [m] the inner surface lies between
      for (int n = 0; n < kBisections; ++n) {
        const double half = 0.5 * (last + free);
        (block.at(bone_from_approach * Vec3(x, y, -half)) >= 0.5 ? last : free) = half;
      }
      column.inner = last;
    }
  });
  out.fill();
  out.smooth();
  return out;
}

/// Columns without an inner surface continue that of their neighbours, from the inside to the outside.
void AssumedBrain::fill() {
  const int size = static_cast<int>(kColumns);
  for (int round = 0; round < size; ++round) {
    const std::vector<Column> before = columns_;
    bool changed = false;
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        if (column(i, j).found) continue;
        double sum = 0.0, next = 0.0, count = 0.0;
        for (const auto& [a, b] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          const auto at = [&](int n) -> const Column* {
            const int x = i + n * a, y = j + n * b;
            if (x < 0 || y < 0 || x >= size || y >= size) return nullptr;
            const Column& other = before[static_cast<std::size_t>(y) * kColumns + static_cast<std::size_t>(x)];
            return other.found ? &other : nullptr;
          };
          const Column *near = at(1), *far = at(4);
          if (near == nullptr) continue;
          sum += far == nullptr ? near->inner : near->inner + (near->inner - far->inner) / 3.0;
          next += near->next;
          count += 1.0;
        }
        if (count == 0.0) continue;
        column(i, j) = {sum / count, next / count, true};
        changed = true;
      }
    if (!changed) return;
  }
}

void AssumedBrain::smooth() {
  const int size = static_cast<int>(kColumns);
  for (int round = 0; round < kSmoothings; ++round) {
    const std::vector<Column> before = columns_;
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        if (!column(i, j).found) continue;
        double sum = 0.0, count = 0.0;
        for (int b = std::max(0, j - 1); b <= std::min(size - 1, j + 1); ++b)
          for (int a = std::max(0, i - 1); a <= std::min(size - 1, i + 1); ++a) {
            const Column& other = before[static_cast<std::size_t>(b) * kColumns + static_cast<std::size_t>(a)];
            if (!other.found || std::abs(other.inner - column(i, j).inner) > 2.0 * kPitch) continue;  // a step, as at an edge
            sum += other.inner;
            count += 1.0;
          }
        if (count > 0.0) column(i, j).inner = sum / count;
      }
  }
}

std::optional<double> AssumedBrain::depth_at(double x, double y, double& next) const {
  const double half = static_cast<double>(kColumns / 2);
  const double u = x / kPitch + half, v = y / kPitch + half;
  if (!(u >= 0.0 && v >= 0.0 && u < kColumns - 1 && v < kColumns - 1)) return std::nullopt;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  double sum = 0.0, weights = 0.0, beyond = 0.0;
  for (int b = 0; b < 2; ++b)
    for (int a = 0; a < 2; ++a) {
      const Column& one = column(i + a, j + b);
      const double weight = std::abs(1.0 - a - (u - i)) * std::abs(1.0 - b - (v - j));
      if (!one.found) continue;
      sum += weight * one.inner;
      beyond += weight * one.next;
      weights += weight;
    }
  if (weights < 0.5) return std::nullopt;
  next = beyond / weights;
  return sum / weights;
}

std::optional<double> AssumedBrain::inner_depth(double x, double y) const {
  double next = 0.0;
  return depth_at(x, y, next);
}

AssumedBrain::Sample AssumedBrain::at(const Vec3& p_bone, double edge) const {
  const Vec3 p = approach_from_bone_ * p_bone;
  const double aside = kRadius - std::sqrt(p.x * p.x + p.y * p.y), ramp = 2.0 * edge;
  Sample out;
  if (aside < -ramp || -p.z < -kAbove) return out;
  double next = 0.0, unused = 0.0;
  const auto inner = depth_at(p.x, p.y, next);
  if (!inner) return out;
  const double below = -p.z - *inner + kInBone * edge_;
  if (below < -4.0 * ramp || below > kReach + ramp) return out;
  const auto depth_beside = [&](double dx, double dy) { return depth_at(p.x + dx, p.y + dy, unused).value_or(*inner); };
  const double slope_x = (depth_beside(kPitch, 0.0) - depth_beside(-kPitch, 0.0)) / (2.0 * kPitch);
  const double slope_y = (depth_beside(0.0, kPitch) - depth_beside(0.0, -kPitch)) / (2.0 * kPitch);
  const Vec3 up = glm::normalize(Vec3(slope_x, slope_y, 1.0));  // of the surface z = -depth
  const double inside = below * up.z;
  const double end = std::min({aside, kReach - below, next + 2.0 * edge_ + p.z});
  out.soft = std::clamp(0.5 + std::min(inside, end) / ramp, 0.0, 1.0);
  out.dura = inside < kDura;
  if (out.soft > 0.0 && out.soft < 1.0 && inside <= end) out.normal = approach_from_bone_.inverse().rotate(up);
  return out;
}

void AssumedBrain::add_to(VolumeView& volume) const {
  const double edge = volume.bone_from_index.mean_edge();
  const VoxelBox all{Vec3i(0), volume.dims};
  for_each_number(volume.dims.z, [&](int k) {
    for_each_voxel({{0, 0, k}, {volume.dims.x, volume.dims.y, k + 1}}, [&](const Vec3i& v) {
      const Sample sample = at(volume.bone_from_index * Vec3(v), edge);
      if (sample.soft <= 0.0) return;
      const std::size_t n = all.offset_of(v);
      const bool colored = sample.soft >= kColored;
      const std::uint8_t soft = to_byte(sample.soft);
      if (colored || volume.normal_opacity[n].a <= 127) volume.color[n] = sample.dura ? kDuraColor : kBrainColor;
      volume.color[n].a = std::max(volume.color[n].a, soft);
      volume.field[n] = std::max(volume.field[n], static_cast<std::uint16_t>(std::lround(65535.0 * sample.soft)));
      if (sample.normal != Vec3(0.0)) volume.normal_opacity[n] = encode_normal(sample.normal, volume.normal_opacity[n].a);
      if (!volume.tissue.empty() && (colored || volume.tissue[n].r <= 127)) volume.tissue[n].g = sample.dura ? 255 : 0;
    });
  });
}

void AssumedBrain::add_to(TexelBox& texels, const Affine& bone_from_index) const {
  const double edge = bone_from_index.mean_edge();
  std::size_t n = 0;
  for_each_voxel(texels.box, [&](const Vec3i& v) {
    const Sample sample = at(bone_from_index * Vec3(v), edge);
    if (sample.soft > 0.0) {
      texels.field[n] = std::max(texels.field[n], static_cast<std::uint16_t>(std::lround(65535.0 * sample.soft)));
      if (sample.normal != Vec3(0.0)) texels.normal_opacity[n] = encode_normal(sample.normal, texels.normal_opacity[n].a);
    }
    ++n;
  });
}

}  // namespace burrhole
