#include "app/render/gl_target.h"

#include <algorithm>
#include <string>

#include "core/base/assert.h"

namespace burrhole {
namespace {

/// Row 0 of OpenGL is the bottom row.
template <class T>
void flip_rows(std::vector<T>& pixels, int width, int height) {
  for (int row = 0; row < height / 2; ++row) {
    const auto top = pixels.begin() + static_cast<std::ptrdiff_t>(row) * width;
    const auto bottom = pixels.begin() + static_cast<std::ptrdiff_t>(height - 1 - row) * width;
    std::swap_ranges(top, top + width, bottom);
  }
}

}  // namespace

Result<GlTarget> GlTarget::create(const GladGLContext& gl, int width, int height, TargetKind kind) {
  GLint limit = 0;
  gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  if (width < 1 || height < 1 || width > limit || height > limit)
    return Error{ErrorCode::out_of_range, "a picture must be 1 to " + std::to_string(limit) + " pixels wide and high", {}};
  GlTarget target;
  target.gl_ = &gl;
  target.width_ = width;
  target.height_ = height;
  target.kind_ = kind;
  const bool with_probe = kind == TargetKind::probed, marked = kind == TargetKind::marked || kind == TargetKind::shaded,
             with_hits = kind != TargetKind::floats && kind != TargetKind::shown && kind != TargetKind::shaded;
  const GLenum depth_place = marked ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT;
  target.framebuffer_ = make_framebuffer(gl);
  target.color_ = make_renderbuffer(gl, kind == TargetKind::floats ? GL_RGBA32F : GL_RGBA8, width, height);
  target.depth_ = make_renderbuffer(gl, marked ? GL_DEPTH32F_STENCIL8 : GL_DEPTH_COMPONENT32F, width, height);
  const GLuint framebuffer = target.framebuffer_.name();
  gl.NamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color_.name());
  gl.NamedFramebufferRenderbuffer(framebuffer, depth_place, GL_RENDERBUFFER, target.depth_.name());
  const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  bool complete = true;
  if (with_hits) {
    target.hits_ = make_texture(gl, GL_TEXTURE_2D);
    gl.TextureStorage2D(target.hits_.name(), 1, GL_R32F, width, height);
    gl.TextureParameteri(target.hits_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(target.hits_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT1, target.hits_.name(), 0);
    target.light_framebuffer_ = make_framebuffer(gl);
    const GLuint light = target.light_framebuffer_.name();
    gl.NamedFramebufferRenderbuffer(light, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color_.name());
    gl.NamedFramebufferRenderbuffer(light, depth_place, GL_RENDERBUFFER, target.depth_.name());
    complete = gl.CheckNamedFramebufferStatus(light, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }
  if (with_probe) {
    target.probe_ = make_renderbuffer(gl, GL_RGBA32F, width, height);
    gl.NamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT2, GL_RENDERBUFFER, target.probe_.name());
  }
  gl.NamedFramebufferDrawBuffers(framebuffer, with_probe ? 3 : (with_hits ? 2 : 1), outputs);
  complete = complete && gl.CheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (!complete || gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver cannot draw a picture of this size", {}};
  return target;
}

bool GlTarget::fits(int width, int height, TargetKind kind) const noexcept {
  return framebuffer_ && width == width_ && height == height_ && kind == kind_;
}

void GlTarget::bind() const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_->Viewport(0, 0, width_, height_);
}

void GlTarget::bind_for_light() const { gl_->BindFramebuffer(GL_FRAMEBUFFER, light_framebuffer_.name()); }

Image GlTarget::read_picture() const {
  Image image;
  read_part({Vec2i(0), Vec2i(width_, height_)}, nullptr, image);
  return image;
}

void GlTarget::read_part(const PixelRect& part, ReadBuffer* through, Image& out) const {
  const Vec2i size = part.size();
  out.width = size.x;
  out.height = size.y;
  out.pixels.resize(static_cast<std::size_t>(part.count()));
  gl_->NamedFramebufferReadBuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT0);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  if (const auto rows = through ? through->read(part) : std::span<const Rgba8>(); !rows.empty()) {
    const auto width = static_cast<std::ptrdiff_t>(size.x);
    auto to = out.pixels.begin();
    for (auto from = rows.end(); from != rows.begin(); to += width) std::copy_n(from -= width, width, to);
    return;
  }
  gl_->ReadPixels(part.lo.x, part.lo.y, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, out.pixels.data());
  flip_rows(out.pixels, size.x, size.y);
}

void GlTarget::make_depth_copy() {
  depth_copy_ = make_texture(*gl_, GL_TEXTURE_2D);
  gl_->TextureStorage2D(depth_copy_.name(), 1, GL_DEPTH_COMPONENT32F, width_, height_);
  gl_->TextureParameteri(depth_copy_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_->TextureParameteri(depth_copy_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

GLuint GlTarget::copy_depth(const PixelRect& part) const {
  BH_ASSERT(depth_copy_);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_->CopyTextureSubImage2D(depth_copy_.name(), 0, part.lo.x, part.lo.y, part.lo.x, part.lo.y, part.size().x, part.size().y);
  return depth_copy_.name();
}

void GlTarget::copy_picture(const GlTarget& to, const PixelRect& part) const {
  gl_->NamedFramebufferReadBuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT0);
  gl_->BlitNamedFramebuffer(framebuffer_.name(), to.framebuffer_.name(), part.lo.x, part.lo.y, part.hi.x, part.hi.y, part.lo.x, part.lo.y,
                            part.hi.x, part.hi.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

std::vector<float> GlTarget::read_depth() const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  std::vector<float> values(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  gl_->ReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, values.data());
  flip_rows(values, width_, height_);
  return values;
}

std::vector<glm::fvec4> GlTarget::read_probe() const {
  BH_ASSERT(probe_);
  std::vector<glm::fvec4> values(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  gl_->NamedFramebufferReadBuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT2);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  gl_->ReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, values.data());
  flip_rows(values, width_, height_);
  return values;
}

}  // namespace burrhole
