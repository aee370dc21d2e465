#include "app/view/bone_mesh.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/assert.h"
#include "core/mesh/surface_offset.h"

namespace burrhole {
namespace {

constexpr double kNormalStep = 1.0;          // [voxel] between a vertex and the samples of its gradient
constexpr Rgba8 kIvory{237, 224, 194, 255};  // as shade.glsl without labels
constexpr double kCutProbe = 0.75;           // [voxel] outside a vertex, where bone as loaded is compared with bone now, as in tissue.glsl
constexpr double kLeastGradient = 1e-3;      // [-] difference of the density over two steps; below, the triangle's own normal is taken
// A vertex lies up to kLongestOffset from its voxel, and a sample reads the voxels of its cell.
const int kNormalReach = static_cast<int>(std::ceil(kLongestOffset + kNormalStep)) + 1;

float density_of(std::uint16_t field) { return static_cast<float>(field) / 65535.0f; }

std::array<std::int16_t, 4> encode(const Vec3& normal, bool textured) {
  const auto code = [](double n) { return static_cast<std::int16_t>(std::lround(32767.0 * std::clamp(n, -1.0, 1.0))); };
  return {code(normal.x), code(normal.y), code(normal.z), code(textured ? 1.0 : 0.0)};
}

/// @returns the trilinear mean of bytes at p (index), 0 outside the box.
double sample_bytes(const VoxelBox& box, const std::vector<std::uint8_t>& bytes, const Vec3& p) {
  const Vec3 base = glm::floor(p), f = p - base;
  double sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    const Vec3i corner(c & 1, (c >> 1) & 1, c >> 2), v = Vec3i(base) + corner;
    if (!box.contains(v)) continue;
    const Vec3 w = glm::mix(1.0 - f, f, Vec3(corner));
    sum += w.x * w.y * w.z * bytes[box.offset_of(v)] / 255.0;
  }
  return sum;
}

}  // namespace

BoneMesh::BoneMesh(BallMesh mesh, const VolumeView& volume, const BoneMeshOptions& options)
    : mesh_(std::move(mesh)),
      dims_(volume.dims),
      bone_from_index_(volume.bone_from_index),
      bone_from_gradient_(glm::transpose(glm::inverse(volume.bone_from_index.linear))),
      turns_over_(glm::determinant(volume.bone_from_index.linear) < 0.0),
      colors_(volume.color) {
  const std::size_t count = volume.normal_opacity.size();
  density_.resize(count);
  bone_.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    bone_[n] = volume.normal_opacity[n].a;
    density_[n] = density_of(volume.field.empty() ? field_of(bone_[n], volume.color[n].a) : volume.field[n]);
  }
  if (!options.labels)
    for (Rgba8& color : colors_) color = {kIvory.r, kIvory.g, kIvory.b, color.a};
  if (!options.find_cuts) return;
  loaded_ = bone_;
  for (std::size_t n = 0; n < volume.tissue.size(); ++n) loaded_[n] = volume.tissue[n].r;
}

Result<BoneMesh> BoneMesh::create(const VolumeView& volume, const BoneMeshOptions& options) {
  auto mesh = BallMesh::create({Vec3i(0), volume.dims}, {.subvoxel = true, .report = true});
  if (!mesh)
    return Error{
        mesh.error().code,
        fmt::format("a bone of {} x {} x {} voxels is too long for method = \"mesh\": give a smaller display.whole_voxels, so that "
                    "no edge has more than {}, or method = \"raycast\"",
                    volume.dims.x, volume.dims.y, volume.dims.z, BallMesh::kLongestBox),
        {}};
  const std::size_t count = VoxelBox{Vec3i(0), volume.dims}.count();
  if (volume.normal_opacity.size() != count || volume.color.size() != count || !(volume.field.empty() || volume.field.size() == count) ||
      !(volume.tissue.empty() || volume.tissue.size() == count))
    return bad_input("the texels of a volume do not agree with its dimensions");
  const double size = glm::determinant(volume.bone_from_index.linear);
  if (!std::isfinite(size) || size == 0.0) return bad_input("the volume's affine map is singular");
  BoneMesh out(std::move(mesh).value(), volume, options);
  out.mesh_.fill(out.block());
  return out;
}

void BoneMesh::update(const TexelBox& texels) {
  const VoxelBox whole = mesh_.box();
  BH_ASSERT(whole.contains(texels.box) && !texels.of_detail);
  std::size_t n = 0;
  VoxelBox changed;  // a box of texels is that of all that may have changed
  for_each_voxel(texels.box, [&](const Vec3i& v) {
    const std::size_t at = whole.offset_of(v);
    const float density = density_of(texels.field[n]);
    const std::uint8_t bone = texels.normal_opacity[n++].a;
    if (density == density_[at] && bone == bone_[at]) return;
    density_[at] = density;
    bone_[at] = bone;
    changed.include(v);
  });
  if (changed.empty()) return;
  mesh_.update(block(), changed);
  mesh_.list_vertices(changed.grown(kNormalReach));
}

std::vector<TriangleRange> BoneMesh::take_changed() {
  changed_.clear();
  mesh_.take_changed(changed_);
  std::vector<TriangleRange> out;
  for (const std::uint32_t number : changed_) {
    if (!out.empty() && out.back().end == number)
      ++out.back().end;
    else
      out.push_back({number, number + 1});
  }
  return out;
}

/// @returns how far bone was cut at a vertex, as cut_share() of tissue.glsl. @param falling index axes, of any length.
std::uint8_t BoneMesh::cut_at(const Vec3& p, const Vec3& falling) const {
  const double length = glm::length(falling);
  if (loaded_.empty() || !(length > 0.0)) return 0;
  const Vec3 before = p + kCutProbe / length * falling;
  const double t = (sample_bytes(mesh_.box(), loaded_, before) - sample_bytes(mesh_.box(), bone_, before) - 0.08) / (0.3 - 0.08);
  const double inside = std::clamp(t, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255.0 * inside * inside * (3.0 - 2.0 * inside)));
}

/// Cloth over a head is green, and no tissue is.
bool BoneMesh::is_textured(std::size_t voxel) const noexcept {
  const Rgba8& color = colors_[voxel];
  return !loaded_.empty() && bone_[voxel] >= color.a && color.g <= color.r;
}

/// @param face [voxels] normal of the triangle, of any length, index axes.
MeshVertex BoneMesh::corner(std::uint32_t half_edge, const Vec3& face) const {
  const HalfEdgeMesh& edges = mesh_.half_edges();
  const Vec3 p = mesh_.position(half_edge);
  Vec3 falling;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step(0.0);
    step[axis] = kNormalStep;
    falling[axis] = sample_density(block(), p - step) - sample_density(block(), p + step);
  }
  // In a wall thinner than the steps the gradient may be that of the other side.
  if (!(glm::length(falling) > kLeastGradient) || glm::dot(falling, face) < 0.0) falling = face;
  Vec3 normal = bone_from_gradient_ * falling;
  const double length = glm::length(normal);
  normal = length > 0.0 ? normal / length : Vec3(0.0);
  const std::size_t voxel = mesh_.box().offset_of(edges.voxel(edges.origin(half_edge)));
  const Rgba8& color = colors_[voxel];
  return {Vec3f(bone_from_index_ * p), encode(normal, is_textured(voxel)), {color.r, color.g, color.b, cut_at(p, falling)}};
}

MeshTriangle BoneMesh::triangle(std::uint32_t number) const {
  if (!mesh_.half_edges().has_triangle(number)) return {};
  const std::uint32_t a = 3 * number, b = turns_over_ ? a + 2 : a + 1, c = turns_over_ ? a + 1 : a + 2;
  const Vec3 from = mesh_.position(a);
  const Vec3 face = glm::cross(mesh_.position(a + 1) - from, mesh_.position(a + 2) - from);
  return {corner(a, face), corner(b, face), corner(c, face)};
}

std::vector<float> BoneMesh::read_mineral(const VoxelBox& box) const {
  std::vector<float> out;
  out.reserve(box.empty() ? 0 : box.count());
  for_each_voxel(box, [&](const Vec3i& v) { out.push_back(static_cast<float>(bone_[mesh_.box().offset_of(v)]) / 255.0f); });
  return out;
}

Bounds BoneMesh::loaded_box() const {
  VoxelBox box;
  if (!loaded_.empty())
    for_each_voxel(mesh_.box(), [&](const Vec3i& v) {
      if (loaded_[mesh_.box().offset_of(v)] > 127) box.include(v);
    });
  if (box.empty()) box = mesh_.box();
  return bounds_under(bone_from_index_, Bounds{Vec3(box.lo) - 0.5, Vec3(box.hi) - 0.5});
}

std::size_t BoneMesh::bytes() const noexcept {
  return mesh_.bytes() + density_.capacity() * sizeof(float) + bone_.capacity() + loaded_.capacity() + colors_.capacity() * sizeof(Rgba8) +
         changed_.capacity() * sizeof(std::uint32_t);
}

std::uint64_t mesh_bytes(std::uint64_t voxels, bool find_cuts) noexcept {
  // A voxel: density, bone, colour, its bits, the colour of a section. Triangles, by the area of the bone: a drilled skull patch has 8.9 for each voxel of
  // a face of its box, a full box 12; more is assumed for the pores of a scan. A triangle: half-edges, offsets, lists, and its vertices in the
  // display's buffer, its place there.
  constexpr double kVoxelBytes = 4 + 1 + 4 + 4 + 0.75, kTriangles = 30.0, kTriangleBytes = 110 + 72 + 20;
  const auto count = static_cast<double>(voxels);
  const double voxel_bytes = find_cuts ? kVoxelBytes + 1 : kVoxelBytes;
  return static_cast<std::uint64_t>(voxel_bytes * count + kTriangles * kTriangleBytes * std::cbrt(count) * std::cbrt(count));
}

}  // namespace burrhole
