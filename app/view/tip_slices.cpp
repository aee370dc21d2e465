#include "app/view/tip_slices.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/assert.h"
#include "core/base/bounds.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

/// Orientation of a slice in the patient: directions of the picture's axes, and names of its sides.
struct Section {
  const char* name;
  std::size_t across;
  Vec3 right, down;
  char left_name, right_name, top_name, bottom_name;
};
/// Radiological convention: viewed from the feet, from anterior, from the left.
const std::array<Section, 3>& sections() {
  static const std::array<Section, 3> all{Section{"axial", 2, {1, 0, 0}, {0, 1, 0}, 'R', 'L', 'A', 'P'},
                                          Section{"coronal", 1, {1, 0, 0}, {0, 0, -1}, 'R', 'L', 'S', 'I'},
                                          Section{"sagittal", 0, {0, 1, 0}, {0, 0, -1}, 'A', 'P', 'S', 'I'}};
  return all;
}

/// Segments where triangles cross the plane `height` = 0. A vertex on the plane counts as above it.
template <class Height, class ToPicture>
std::vector<std::array<glm::dvec2, 2>> cross(const TriangleMesh& mesh, const Pose& bone_from_tool, Height&& height,
                                             ToPicture&& to_picture) {
  std::vector<std::array<glm::dvec2, 2>> strokes;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::array<glm::dvec2, 2> stroke;
    std::size_t ends = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = bone_from_tool * Vec3(mesh.positions[mesh.indices[t + i]]);
      const Vec3 b = bone_from_tool * Vec3(mesh.positions[mesh.indices[t + (i + 1) % 3]]);
      const double from = height(a), to = height(b);
      if ((from < 0.0) == (to < 0.0) || ends == 2) continue;
      stroke[ends++] = to_picture(a + from / (from - to) * (b - a));
    }
    if (ends == 2) strokes.push_back(stroke);
  }
  return strokes;
}

}  // namespace

bool MineralBox::holds(const Vec3& p_bone) const {
  const Vec3 index = index_from_bone * p_bone;
  return !box.empty() && glm::all(glm::greaterThanEqual(index, Vec3(box.lo))) && glm::all(glm::lessThanEqual(index, Vec3(box.hi - 1)));
}

double MineralBox::at(const Vec3& p_bone) const {
  if (!holds(p_bone)) return 0.0;
  const Vec3 index = index_from_bone * p_bone;
  const Vec3i low = glm::min(Vec3i(glm::floor(index)), glm::max(box.hi - 2, box.lo));
  return trilinear(index - Vec3(low),
                   [&](unsigned n) { return static_cast<double>(values[box.offset_of(glm::min(low + cell_corner(n), box.hi - 1))]); });
}

VoxelBox voxels_around(const Affine& index_from_bone, const Vec3& p_bone, double half_width) noexcept {
  VoxelBox out;
  for (const Vec3& corner : Bounds{p_bone - half_width, p_bone + half_width}.corners()) {
    out.include(Vec3i(glm::floor(index_from_bone * corner)));
    out.include(Vec3i(glm::floor(index_from_bone * corner)) + 1);
  }
  return out;
}

TipSlices make_tip_slices(Voxmap& voxmap, const TriangleMesh& tool, const Pose& bone_from_tool, double half_width, int size) {
  const Affine index_from_bone = voxmap.bone().bone_from_index().inverse();
  MineralBox mineral{
      voxels_around(index_from_bone, bone_from_tool.translation, half_width).intersect(voxmap.bone().bounds()), index_from_bone, {}};
  if (!mineral.box.empty()) {
    mineral.values.resize(mineral.box.count());
    std::vector<float> hardness(mineral.box.count());
    voxmap.read_density(mineral.box, mineral.values);
    voxmap.bone().read_hardness(mineral.box, hardness);
    std::transform(mineral.values.begin(), mineral.values.end(), hardness.begin(), mineral.values.begin(), std::multiplies<>());
  }
  return make_tip_slices({&mineral, 1}, tool, bone_from_tool, half_width, size);
}

TipSlices make_tip_slices(std::span<const MineralBox> levels, const TriangleMesh& tool, const Pose& bone_from_tool, double half_width,
                          int size) {
  BH_ASSERT(half_width > 0.0 && size >= 2);
  const Vec3 tip = bone_from_tool.translation;
  const auto value_at = [&](const Vec3& p) {
    const auto level = std::ranges::find_if(levels, [&](const MineralBox& one) { return one.holds(p); });
    return level != levels.end() ? level->at(p) : 0.0;
  };
  TipSlices out{.size = size, .pixel = 2.0 * half_width / size, .planes = {}};
  for (std::size_t n = 0; n < 3; ++n) {
    const Section& section = sections()[n];
    TipSlice& plane = out.planes[n];
    plane = {section.name,
             "xyz"[section.across],
             tip[section.across],
             section.left_name,
             section.right_name,
             section.top_name,
             section.bottom_name,
             {},
             {}};
    plane.grey.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Vec3 p = tip + out.pixel * ((x + 0.5 - 0.5 * size) * section.right + (y + 0.5 - 0.5 * size) * section.down);
        plane.grey.push_back(static_cast<std::uint8_t>(std::floor(255.0 * std::clamp(value_at(p), 0.0, 1.0) + 0.5)));
      }
    plane.tool = cross(
        tool, bone_from_tool, [&](const Vec3& p) { return p[section.across] - tip[section.across] - 1e-9; },
        [&](const Vec3& p) {
          return glm::dvec2(glm::dot(p - tip, section.right), glm::dot(p - tip, section.down)) / out.pixel + 0.5 * size;
        });
  }
  return out;
}

}  // namespace burrhole
