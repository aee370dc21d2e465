#include "app/render/volume_texture.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "core/base/assert.h"

namespace burrhole {
namespace {

std::string size_text(const Vec3i& dims) {
  return std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " + std::to_string(dims.z);
}

/// Tests a proxy texture: no memory is allocated.
bool takes(const GladGLContext& gl, const Vec3i& dims, GLenum stored) {
  GLint limit = 0, width = 0;
  gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  if (std::max({dims.x, dims.y, dims.z}) > limit) return false;
  gl.TexImage3D(GL_PROXY_TEXTURE_3D, 0, static_cast<GLint>(stored), dims.x, dims.y, dims.z, 0, GL_RGBA, GL_FLOAT, nullptr);
  gl.GetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &width);
  return width == dims.x;
}

/// The largest volume of that aspect ratio that the driver accepts, by the length of its longest edge.
Vec3i largest_taken(const GladGLContext& gl, const Vec3i& dims, GLenum stored) {
  const int longest = std::max({dims.x, dims.y, dims.z});
  const auto shrunk = [&](int edge) { return glm::max(Vec3i(glm::floor(Vec3(dims) * (edge / static_cast<double>(longest)))), Vec3i(1)); };
  int fits = 1, too_large = longest;
  while (too_large - fits > 1) {
    const int middle = fits + (too_large - fits) / 2;
    (takes(gl, shrunk(middle), stored) ? fits : too_large) = middle;
  }
  return shrunk(fits);
}

Status check_size(const GladGLContext& gl, const Vec3i& dims, GLenum stored) {
  if (takes(gl, dims, stored)) return {};
  return Error{ErrorCode::out_of_range,
               "a volume of " + size_text(dims) + " voxels is more than this driver draws: " + size_text(largest_taken(gl, dims, stored)) +
                   " would fit, as with larger voxels or a smaller region",
               {}};
}

Status check(const GladGLContext& gl, const VolumeView& view) {
  if (std::min({view.dims.x, view.dims.y, view.dims.z}) < 1)
    return Error{ErrorCode::out_of_range, "a volume of " + size_text(view.dims) + " voxels cannot be drawn: it is empty", {}};
  if (Status fits = check_size(gl, view.dims, view.precise.normal_opacity.empty() ? GL_RGBA8 : GL_RGBA32F); !fits) return fits;
  const std::size_t count = VoxelBox{Vec3i(0), view.dims}.count();
  if (view.normal_opacity.size() != count || view.color.size() != count ||
      (!view.precise.normal_opacity.empty() && (view.precise.normal_opacity.size() != count || view.precise.field.size() != count)) ||
      (!view.tissue.empty() && view.tissue.size() != count) || (!view.field.empty() && view.field.size() != count))
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

void upload(const GladGLContext& gl, GLuint texture, const VoxelBox& box, GLenum format, const void* texels,
            GLenum type = GL_UNSIGNED_BYTE) {
  const Vec3i size = box.size();
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TextureSubImage3D(texture, 0, box.lo.x, box.lo.y, box.lo.z, size.x, size.y, size.z, format, type, texels);
}

GlObject make_volume(const GladGLContext& gl, const Vec3i& dims, GLenum stored, GLenum format, GLint filter, const void* texels,
                     GLenum type = GL_UNSIGNED_BYTE) {
  GlObject texture = make_texture(gl, GL_TEXTURE_3D);
  gl.TextureStorage3D(texture.name(), 1, stored, dims.x, dims.y, dims.z);
  set_sampling(gl, texture.name(), filter);
  upload(gl, texture.name(), {Vec3i(0), dims}, format, texels, type);
  return texture;
}

/// One channel of 16 bits: llvmpipe filters it a third faster than RGBA8 or one channel of 8 bits.
GlObject make_field(const GladGLContext& gl, const VolumeView& view) {
  if (view.precise.normal_opacity.empty() && !view.field.empty())
    return make_volume(gl, view.dims, GL_R16, GL_RED, GL_LINEAR, view.field.data(), GL_UNSIGNED_SHORT);
  if (view.precise.normal_opacity.empty()) {
    std::vector<std::uint16_t> field(view.color.size());
    for (std::size_t n = 0; n < field.size(); ++n) field[n] = field_of(view.normal_opacity[n].a, view.color[n].a);
    return make_volume(gl, view.dims, GL_R16, GL_RED, GL_LINEAR, field.data(), GL_UNSIGNED_SHORT);
  }
  return make_volume(gl, view.dims, GL_R32F, GL_RED, GL_LINEAR, view.precise.field.data(), GL_FLOAT);
}

}  // namespace

Result<GlObject> make_color_texture(const GladGLContext& gl, const Vec3i& dims, const std::vector<Rgba8>& colors) {
  if (Status fits = check_size(gl, dims, GL_RGBA8); !fits) return fits.error();
  GlObject made = make_volume(gl, dims, GL_RGBA8, GL_RGBA, GL_LINEAR, colors.data());
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for the colours of a section", {}};
  return made;
}

Result<VolumeTexture> VolumeTexture::create(const GladGLContext& gl, const VolumeView& view, std::optional<std::uint8_t> seen_from) {
  const Status valid = check(gl, view);
  if (!valid) return valid.error();
  VolumeTexture made;
  made.gl_ = &gl;
  made.dims_ = view.dims;
  made.bone_from_index_ = view.bone_from_index;
  made.texel_bytes_ = view.precise.normal_opacity.empty() ? kTexelBytes : sizeof(glm::vec4) + sizeof(float);
  made.normal_opacity_ = view.precise.normal_opacity.empty()
                             ? make_volume(gl, view.dims, GL_RGBA8, GL_RGBA, GL_LINEAR, view.normal_opacity.data())
                             : make_volume(gl, view.dims, GL_RGBA32F, GL_RGBA, GL_LINEAR, view.precise.normal_opacity.data(), GL_FLOAT);
  made.color_soft_ = make_volume(gl, view.dims, GL_RGBA8, GL_RGBA, GL_LINEAR, view.color.data());
  made.field_ = make_field(gl, view);
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

void VolumeTexture::send(const TexelBox& texels, UploadRing* ring) const {
  const auto colors = std::as_bytes(std::span(texels.normal_opacity)), field = std::as_bytes(std::span(texels.field));
  if (const auto at = ring != nullptr ? ring->stage({colors, field}) : std::nullopt) {
    // With a bound buffer the offset is passed as a pointer.
    upload(*gl_, normal_opacity_.name(), texels.box, GL_RGBA, reinterpret_cast<const void*>(*at));
    upload(*gl_, field_.name(), texels.box, GL_RED, reinterpret_cast<const void*>(*at + colors.size()), GL_UNSIGNED_SHORT);
    ring->finish();
    return;
  }
  upload(*gl_, normal_opacity_.name(), texels.box, GL_RGBA, colors.data());
  upload(*gl_, field_.name(), texels.box, GL_RED, field.data(), GL_UNSIGNED_SHORT);
}

UploadedBytes VolumeTexture::update(const TexelBox& texels, bool may_grow, UploadRing* ring) {
  const VoxelBox all{Vec3i(0), dims_};
  BH_ASSERT(all.contains(texels.box) && texels.normal_opacity.size() == texels.box.count() && texels.field.size() == texels.box.count());
  if (texels.box.empty()) return {};
  send(texels, ring);
  UploadedBytes sent{texels.box.count() * kTexelBytes, 0};
  if (!has_skip_map() || !may_grow) return sent;
  std::vector<std::uint8_t> solid(texels.normal_opacity.size());
  std::transform(texels.normal_opacity.begin(), texels.normal_opacity.end(), solid.begin(),
                 [this](const Rgba8& t) { return static_cast<std::uint8_t>(t.a >= seen_from_); });
  const VoxelBox nearer = skip_map_.raise(texels.box, solid);
  if (nearer.empty()) return sent;
  // Only if bone grew, which is rare: whole slabs, since rows of a part are not contiguous.
  const VoxelBox slab{{0, 0, nearer.lo.z}, {dims_.x, dims_.y, nearer.hi.z}};
  upload(*gl_, skip_texture_.name(), slab, GL_RED, skip_map_.distances().data() + all.offset_of(slab.lo));
  sent.skip_map = slab.count();
  return sent;
}

void VolumeTexture::bind() const {
  gl_->BindTextureUnit(0, normal_opacity_.name());
  gl_->BindTextureUnit(1, color_soft_.name());
  if (has_skip_map()) gl_->BindTextureUnit(2, skip_texture_.name());
  gl_->BindTextureUnit(6, field_.name());
  if (has_tissue()) gl_->BindTextureUnit(5, tissue_.name());
}

std::vector<float> VolumeTexture::read_mineral(const VoxelBox& box) const {
  std::vector<float> out(box.count());
  if (box.empty()) return out;
  const Vec3i size = box.size();
  const auto read = [&](const GlObject& texture, GLenum format, auto& texels) {
    gl_->GetTextureSubImage(texture.name(), 0, box.lo.x, box.lo.y, box.lo.z, size.x, size.y, size.z, format, GL_UNSIGNED_BYTE,
                            static_cast<GLsizei>(texels.size() * sizeof(texels[0])), texels.data());
  };
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 1);
  std::vector<Rgba8> bone(box.count());
  read(normal_opacity_, GL_RGBA, bone);
  std::transform(bone.begin(), bone.end(), out.begin(), [](const Rgba8& t) { return static_cast<float>(t.a) / 255.0f; });
  if (!has_tissue()) return out;
  std::vector<TissueTexel> tissue(box.count());
  read(tissue_, GL_RG, tissue);
  for (std::size_t n = 0; n < out.size(); ++n) out[n] *= 1.0f - (1.0f - kMarrow) * static_cast<float>(tissue[n].g) / 255.0f;
  return out;
}

void VolumeTexture::bind_field(GLuint unit) const { gl_->BindTextureUnit(unit, field_.name()); }

UploadedBytes VolumeTexture::initial_bytes() const noexcept {
  const std::uint64_t count = VoxelBox{Vec3i(0), dims_}.count();
  return {count * (texel_bytes_ + sizeof(Rgba8) + (has_tissue() ? sizeof(TissueTexel) : 0)), has_skip_map() ? count : 0};
}

}  // namespace burrhole
