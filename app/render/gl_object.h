/// app/render/gl_object.h: move-only owner of one OpenGL name. Internal to app/render.   Errors  none.
#pragma once

#include <glad/gl.h>

#include <utility>

namespace burrhole {

/// Deletes its name at destruction. @pre the context that made it is current then.
class GlObject {
 public:
  using Destroy = void (*)(const GladGLContext&, GLuint);
  GlObject() = default;
  GlObject(const GladGLContext& gl, GLuint name, Destroy destroy) noexcept : gl_(&gl), name_(name), destroy_(destroy) {}
  GlObject(GlObject&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)), destroy_(other.destroy_) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(name_, other.name_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }
  ~GlObject() {
    if (name_ != 0) destroy_(*gl_, name_);
  }
  [[nodiscard]] GLuint name() const noexcept { return name_; }
  explicit operator bool() const noexcept { return name_ != 0; }

 private:
  const GladGLContext* gl_ = nullptr;
  GLuint name_ = 0;
  Destroy destroy_ = nullptr;
};

[[nodiscard]] inline GlObject make_texture(const GladGLContext& gl, GLenum target) {
  GLuint name = 0;
  gl.CreateTextures(target, 1, &name);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteTextures(1, &n); }};
}

[[nodiscard]] inline GlObject make_buffer(const GladGLContext& gl) {
  GLuint name = 0;
  gl.CreateBuffers(1, &name);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteBuffers(1, &n); }};
}

[[nodiscard]] inline GlObject make_vertex_array(const GladGLContext& gl) {
  GLuint name = 0;
  gl.CreateVertexArrays(1, &name);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteVertexArrays(1, &n); }};
}

/// Counts fragments that pass.
[[nodiscard]] inline GlObject make_count_query(const GladGLContext& gl) {
  GLuint name = 0;
  gl.CreateQueries(GL_SAMPLES_PASSED, 1, &name);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteQueries(1, &n); }};
}

[[nodiscard]] inline GlObject make_framebuffer(const GladGLContext& gl) {
  GLuint name = 0;
  gl.CreateFramebuffers(1, &name);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteFramebuffers(1, &n); }};
}

[[nodiscard]] inline GlObject make_renderbuffer(const GladGLContext& gl, GLenum format, int width, int height) {
  GLuint name = 0;
  gl.CreateRenderbuffers(1, &name);
  gl.NamedRenderbufferStorage(name, format, width, height);
  return {gl, name, [](const GladGLContext& g, GLuint n) { g.DeleteRenderbuffers(1, &n); }};
}

}  // namespace burrhole
