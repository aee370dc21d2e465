#include "app/render/picture_texture.h"

#include <glad/gl.h>

#include <algorithm>

namespace burrhole {

PictureTexture::PictureTexture(const GlContext& context) : gl_(&context.functions()) {}

PictureTexture::~PictureTexture() {
  if (name_ != 0) gl_->DeleteTextures(1, &name_);
}

void PictureTexture::set(const Image& image) {
  if (image.width != width_ || image.height != height_ || name_ == 0) {
    if (name_ != 0) gl_->DeleteTextures(1, &name_);
    gl_->CreateTextures(GL_TEXTURE_2D, 1, &name_);
    gl_->TextureStorage2D(name_, 1, GL_RGBA8, image.width, image.height);
    gl_->TextureParameteri(name_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_->TextureParameteri(name_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_->TextureParameteri(name_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_->TextureParameteri(name_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    width_ = image.width;
    height_ = image.height;
  }
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl_->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  gl_->TextureSubImage2D(name_, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
}

void PictureTexture::draw_to_eye(bool left) const {
  gl_->NamedFramebufferDrawBuffer(0, left ? GL_BACK_LEFT : GL_BACK_RIGHT);
  gl_->NamedFramebufferReadBuffer(0, left ? GL_BACK_LEFT : GL_BACK_RIGHT);
}

void PictureTexture::clear_window(int width, int height, const Vec3& color) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_->Viewport(0, 0, width, height);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->ClearColor(static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), 1.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
}

Image PictureTexture::read_window(int width, int height) const {
  Image out{width, height, std::vector<Rgba8>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  gl_->BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl_->PixelStorei(GL_PACK_ROW_LENGTH, 0);
  std::vector<Rgba8> rows(out.pixels.size());
  gl_->ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  const auto wide = static_cast<std::ptrdiff_t>(width);
  for (std::ptrdiff_t y = 0; y < height; ++y)  // OpenGL begins at the bottom
    std::copy_n(rows.begin() + (height - 1 - y) * wide, wide, out.pixels.begin() + y * wide);
  for (Rgba8& pixel : out.pixels) pixel.a = 255;
  return out;
}

}  // namespace burrhole
