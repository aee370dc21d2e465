#include "app/render/volume_texture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "core/base/assert.h"

namespace burrhole {
namespace {

Status check(const GladGLContext& gl, const VolumeView& view) {
  GLint limit = 0;
  gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  const auto [x, y, z] = std::tuple(view.dims.x, view.dims.y, view.dims.z);
  if (x < 1 || y < 1 || z < 1 || std::max({x, y, z}) > limit)
    return Error{ErrorCode::out_of_range, "a drawn volume must have 1 to " + std::to_string(limit) + " voxels along each axis", {}};
  const std::size_t count = VoxelBox{Vec3i(0), view.dims}.count();
  if (view.normal_opacity.size() != count || view.color.size() != count || (!view.tissue.empty() && view.tissue.size() != count))
    return bad_input("the texels of a volume do not agree with its dimensions");
  const double size = glm::determinant(view.bone_from_index.linear);
  if (!std::isfinite(size) || size == 0.0 || !is_finite(view.bone_from_index.offset))
    return bad_input("the volume's affine map is singular");
  return {};
}

void set_sampling(const GladGLContext& gl, GLuint texture, GLint filter) {
  gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, filter);
  gl.TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) gl.TextureParameteri(texture, axis, GL_CLAMP_TO_EDGE);
}

void upload(const GladGLContext& gl, GLuint texture, const VoxelBox& box, GLenum format, const void* texels) {
  const Vec3i size = box.size();
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TextureSubImage3D(texture, 0, box.lo.x, box.lo.y, box.lo.z, size.x, size.y, size.z, format, GL_UNSIGNED_BYTE, texels);
}

GlObject make_volume(const GladGLContext& gl, const Vec3i& dims, GLenum stored, GLenum format, GLint filter, const void* texels) {
  GlObject texture = make_texture(gl, GL_TEXTURE_3D);
  gl.TextureStorage3D(texture.name(), 1, stored, dims.x, dims.y, dims.z);
  set_sampling(gl, texture.name(), filter);
  upload(gl, texture.name(), {Vec3i(0), dims}, format, texels);
  return texture;
}

}  // namespace

Result<VolumeTexture> VolumeTexture::create(const GladGLContext& gl, const VolumeView& view, std::optional<std::uint8_t> seen_from) {
  const Status valid = check(gl, view);
  if (!valid) return valid.error();
  VolumeTexture made;
  made.gl_ = &gl;
  made.dims_ = view.dims;
  made.bone_from_index_ = view.bone_from_index;
  made.normal_opacity_ = make_volume(gl, view.dims, GL_RGBA8, GL_RGBA, GL_LINEAR, view.normal_opacity.data());
  made.color_soft_ = make_volume(gl, view.dims, GL_RGBA8, GL_RGBA, GL_LINEAR, view.color.data());
  if (!view.tissue.empty()) made.tissue_ = make_volume(gl, view.dims, GL_RG8, GL_RG, GL_LINEAR, view.tissue.data());
  made.has_soft_ = std::any_of(view.color.begin(), view.color.end(), [](const Rgba8& c) { return c.a >= kSolidOpacity; });
  if (seen_from) {
    made.seen_from_ = *seen_from;
    std::vector<std::uint8_t> solid(view.color.size());
    for (std::size_t n = 0; n < solid.size(); ++n) solid[n] = view.normal_opacity[n].a >= *seen_from || view.color[n].a >= kSolidOpacity;
    made.skip_map_ = SkipMap(view.dims, solid);
    made.skip_texture_ = make_volume(gl, view.dims, GL_R8, GL_RED, GL_NEAREST, made.skip_map_.distances().data());
  }
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for this volume", {}};
  return made;
}

UploadedBytes VolumeTexture::update(const TexelBox& texels) {
  const VoxelBox all{Vec3i(0), dims_};
  BH_ASSERT(all.contains(texels.box) && texels.normal_opacity.size() == texels.box.count());
  if (texels.box.empty()) return {};
  upload(*gl_, normal_opacity_.name(), texels.box, GL_RGBA, texels.normal_opacity.data());
  UploadedBytes sent{texels.box.count() * sizeof(Rgba8), 0};
  if (!has_skip_map()) return sent;
  std::vector<std::uint8_t> solid(texels.normal_opacity.size());
  std::transform(texels.normal_opacity.begin(), texels.normal_opacity.end(), solid.begin(),
                 [this](const Rgba8& t) { return static_cast<std::uint8_t>(t.a >= seen_from_); });
  const VoxelBox nearer = skip_map_.raise(texels.box, solid);
  if (nearer.empty()) return sent;
  // Only when bone grew: whole slabs, since rows of a part are not contiguous and this is rare.
  const VoxelBox slab{{0, 0, nearer.lo.z}, {dims_.x, dims_.y, nearer.hi.z}};
  upload(*gl_, skip_texture_.name(), slab, GL_RED, skip_map_.distances().data() + all.offset_of(slab.lo));
  sent.skip_map = slab.count();
  return sent;
}

void VolumeTexture::bind() const {
  gl_->BindTextureUnit(0, normal_opacity_.name());
  gl_->BindTextureUnit(1, color_soft_.name());
  if (has_skip_map()) gl_->BindTextureUnit(2, skip_texture_.name());
  if (has_tissue()) gl_->BindTextureUnit(5, tissue_.name());
}

UploadedBytes VolumeTexture::initial_bytes() const noexcept {
  const std::uint64_t count = VoxelBox{Vec3i(0), dims_}.count();
  return {count * (2 * sizeof(Rgba8) + (has_tissue() ? sizeof(TissueTexel) : 0)), has_skip_map() ? count : 0};
}

}  // namespace burrhole
