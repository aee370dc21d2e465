#include "app/render/screen_mesh.h"

#include <vector>

namespace burrhole {
namespace {

using Corner = glm::fvec2;  // clip coordinates

GlObject make_corner_array(const GladGLContext& gl, const GlObject& vertices) {
  GlObject array = make_vertex_array(gl);
  gl.VertexArrayVertexBuffer(array.name(), 0, vertices.name(), 0, sizeof(Corner));
  gl.EnableVertexArrayAttrib(array.name(), 0);
  gl.VertexArrayAttribFormat(array.name(), 0, 2, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(array.name(), 0, 0);
  return array;
}

}  // namespace

ScreenMesh::ScreenMesh(const GladGLContext& gl) : gl_(&gl), all_vertices_(make_buffer(gl)), rect_vertices_(make_buffer(gl)) {
  const Corner all[] = {{-1.0f, -1.0f}, {3.0f, -1.0f}, {-1.0f, 3.0f}};
  gl.NamedBufferData(all_vertices_.name(), sizeof(all), all, GL_STATIC_DRAW);
  all_ = make_corner_array(gl, all_vertices_);
  rects_ = make_corner_array(gl, rect_vertices_);
}

void ScreenMesh::set(std::span<const PixelRect> rects, const Vec2i& picture) {
  std::vector<Corner> corners;
  corners.reserve(6 * rects.size());
  for (const PixelRect& rect : rects) {
    const Corner lo(2.0 * Vec2(rect.lo) / Vec2(picture) - 1.0), hi(2.0 * Vec2(rect.hi) / Vec2(picture) - 1.0);
    corners.insert(corners.end(), {lo, {hi.x, lo.y}, hi, lo, hi, {lo.x, hi.y}});
  }
  count_ = static_cast<int>(corners.size());
  gl_->NamedBufferData(rect_vertices_.name(), static_cast<GLsizeiptr>(sizeof(Corner) * corners.size()), corners.data(), GL_STREAM_DRAW);
}

void ScreenMesh::draw_all() const {
  gl_->BindVertexArray(all_.name());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

void ScreenMesh::draw_rects() const {
  if (count_ == 0) return;
  gl_->BindVertexArray(rects_.name());
  gl_->DrawArrays(GL_TRIANGLES, 0, count_);
}

}  // namespace burrhole
