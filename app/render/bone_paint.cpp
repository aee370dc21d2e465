#include "app/render/bone_paint.h"

#include <algorithm>
#include <bit>

namespace burrhole {
namespace {

/// Mirrors Textures of mesh_texture.glsl (std140).
struct PaintBlock {
  glm::fvec4 exterior_rows[3], interior_rows[3], texel_rates{0.0f};
};

PaintBlock make_paint_block(const BoneTextures& textures, const Bounds& box) {
  const TextureMaps maps = make_texture_maps(textures, box);
  PaintBlock out;
  double finest = 0.0;
  for (int row = 0; row < 3; ++row) {
    out.exterior_rows[row] = glm::fvec4(maps.exterior[row]);
    out.interior_rows[row] = glm::fvec4(maps.interior[row]);
    finest = std::max(finest, textures.interior.dims[row] * glm::length(Vec3(maps.interior[row])));
  }
  out.texel_rates.x = static_cast<float>(std::max(textures.exterior.width, textures.exterior.height) / textures.exterior_edge);
  out.texel_rates.y = static_cast<float>(finest);
  return out;
}

GLsizei levels_of(int longest) { return std::bit_width(static_cast<unsigned>(longest)); }

Status check_side(const GladGLContext& gl, GLenum limit, int side) {
  GLint most = 0;
  gl.GetIntegerv(limit, &most);
  if (side <= most) return {};
  return Error{ErrorCode::out_of_range,
               "a texture of " + std::to_string(side) + " texels along an edge exceeds the " + std::to_string(most) +
                   " of this driver: scale the image down",
               {}};
}

void set_sampling(const GladGLContext& gl, GLuint name, bool tiles) {
  gl.TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TextureParameteri(name, wrap, tiles ? GL_REPEAT : GL_MIRRORED_REPEAT);
}

}  // namespace

Result<BonePaint> BonePaint::create(const GladGLContext& gl, const BoneTextures& textures, const Bounds& box) {
  BonePaint out;
  out.gl_ = &gl;
  const Image& image = textures.exterior;
  const VolumeImage& volume = textures.interior;
  const int side = std::max(image.width, image.height), edge = std::max({volume.dims.x, volume.dims.y, volume.dims.z});
  if (Status fits = check_side(gl, GL_MAX_TEXTURE_SIZE, side); !fits) return fits.error();
  if (Status fits = check_side(gl, GL_MAX_3D_TEXTURE_SIZE, edge); !fits) return fits.error();
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  if (!image.pixels.empty()) {
    out.exterior_ = make_texture(gl, GL_TEXTURE_2D);
    const GLuint name = out.exterior_.name();
    gl.TextureStorage2D(name, levels_of(side), GL_RGBA8, image.width, image.height);
    gl.TextureSubImage2D(name, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
    gl.GenerateTextureMipmap(name);
    set_sampling(gl, name, textures.exterior_tiles);
  }
  if (!volume.pixels.empty()) {
    out.interior_ = make_texture(gl, GL_TEXTURE_3D);
    const GLuint name = out.interior_.name();
    gl.TextureStorage3D(name, levels_of(edge), GL_RGBA8, volume.dims.x, volume.dims.y, volume.dims.z);
    gl.TextureSubImage3D(name, 0, 0, 0, 0, volume.dims.x, volume.dims.y, volume.dims.z, GL_RGBA, GL_UNSIGNED_BYTE, volume.pixels.data());
    gl.GenerateTextureMipmap(name);
    set_sampling(gl, name, textures.interior_tiles);
  }
  const PaintBlock block = make_paint_block(textures, box);
  out.maps_ = make_buffer(gl);
  gl.NamedBufferStorage(out.maps_.name(), sizeof block, &block, 0);
  out.bytes_ = (image.pixels.size() + volume.pixels.size()) * sizeof(Rgba8);
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for the textures of the bone", {}};
  return out;
}

void BonePaint::bind() const {
  gl_->BindBufferBase(GL_UNIFORM_BUFFER, 1, maps_.name());
  if (exterior_) gl_->BindTextureUnit(2, exterior_.name());
  if (interior_) gl_->BindTextureUnit(3, interior_.name());
}

}  // namespace burrhole
