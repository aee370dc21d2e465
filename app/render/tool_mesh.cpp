#include "app/render/tool_mesh.h"

#include <algorithm>
#include <limits>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

Status check(const TriangleMesh& mesh) {
  if (mesh.indices.empty() || mesh.indices.size() % 3 != 0) return bad_input("a tool's mesh needs whole triangles");
  if (mesh.normals.size() != mesh.positions.size()) return bad_input("a tool's mesh needs one normal a vertex");
  if (*std::max_element(mesh.indices.begin(), mesh.indices.end()) >= mesh.positions.size())
    return bad_input("a tool's mesh has an index beyond its vertices");
  if (mesh.indices.size() > static_cast<std::size_t>(std::numeric_limits<GLsizei>::max())) return bad_input("a tool's mesh is too large");
  return {};
}

GlObject make_filled_buffer(const GladGLContext& gl, const void* data, std::size_t bytes) {
  GlObject buffer = make_buffer(gl);
  gl.NamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), data, 0);
  return buffer;
}

std::array<Vec3, 8> box_corners(const std::vector<Vec3f>& points) {
  Bounds bounds = Bounds::none();
  for (const Vec3f& p : points) bounds.include(Vec3(p));
  return bounds.corners();
}

}  // namespace

Result<ToolMesh> ToolMesh::create(const GladGLContext& gl, const TriangleMesh& mesh) {
  const Status valid = check(mesh);
  if (!valid) return valid.error();
  ToolMesh made;
  made.gl_ = &gl;
  made.array_ = make_vertex_array(gl);
  made.positions_ = make_filled_buffer(gl, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  made.normals_ = make_filled_buffer(gl, mesh.normals.data(), mesh.normals.size() * sizeof(Vec3f));
  made.indices_ = make_filled_buffer(gl, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  made.index_count_ = static_cast<GLsizei>(mesh.indices.size());
  made.corners_ = box_corners(mesh.positions);
  const GLuint array = made.array_.name();
  for (const GLuint attribute : {0u, 1u}) {
    gl.EnableVertexArrayAttrib(array, attribute);
    gl.VertexArrayAttribFormat(array, attribute, 3, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(array, attribute, attribute);
  }
  gl.VertexArrayVertexBuffer(array, 0, made.positions_.name(), 0, sizeof(Vec3f));
  gl.VertexArrayVertexBuffer(array, 1, made.normals_.name(), 0, sizeof(Vec3f));
  gl.VertexArrayElementBuffer(array, made.indices_.name());
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for the tool's mesh", {}};
  return made;
}

void ToolMesh::draw() const {
  gl_->BindVertexArray(array_.name());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace burrhole
