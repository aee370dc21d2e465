#include "app/render/skin_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

/// As skin.vert reads it.
struct Vertex {
  Vec3f position, normal;
  float place = 0.0f;
};
static_assert(sizeof(Vertex) == 7 * sizeof(float));

Status check(const TriangleMesh& mesh, const std::vector<float>& places) {
  if (mesh.indices.size() % 3 != 0) return bad_input("a skin needs whole triangles");
  if (mesh.normals.size() != mesh.positions.size() || places.size() != mesh.positions.size())
    return bad_input("a skin needs one normal and one place a vertex");
  const auto beyond = [&](std::uint32_t n) { return n >= mesh.positions.size(); };
  if (std::any_of(mesh.indices.begin(), mesh.indices.end(), beyond)) return bad_input("a skin has an index beyond its vertices");
  for (const Vec3f& p : mesh.positions)
    if (!is_finite(Vec3(p))) return bad_input("a skin has a vertex that is not finite");
  return {};
}

Status check(const SkinView& view) {
  if (Status shell = check(view.shell, view.beyond); !shell) return shell;
  if (Status rim = check(view.rim, view.depth); !rim) return rim;
  for (const double value : {view.color.x, view.color.y, view.color.z, view.opacity})
    if (!(value >= 0.0 && value <= 1.0)) return bad_input("the colour and the opacity of a skin must be in 0..1");
  if (view.shell.indices.size() + view.rim.indices.size() > static_cast<std::size_t>(std::numeric_limits<GLsizei>::max()))
    return bad_input("a skin is too large");
  return {};
}

void append(const TriangleMesh& mesh, const std::vector<float>& places, std::vector<Vertex>& vertices,
            std::vector<std::uint32_t>& indices) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) vertices.push_back({mesh.positions[n], mesh.normals[n], places[n]});
  for (const std::uint32_t n : mesh.indices) indices.push_back(first + n);
}

template <class T>
GlObject make_filled_buffer(const GladGLContext& gl, const std::vector<T>& data) {
  GlObject buffer = make_buffer(gl);
  gl.NamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(std::max<std::size_t>(data.size() * sizeof(T), 1)), nullptr,
                        GL_DYNAMIC_STORAGE_BIT);
  gl.NamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data());
  return buffer;
}

}  // namespace

Result<SkinMesh> SkinMesh::create(const GladGLContext& gl, const SkinView& view) {
  if (const Status valid = check(view); !valid) return valid.error();
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  append(view.shell, view.beyond, vertices, indices);
  append(view.rim, view.depth, vertices, indices);
  SkinMesh made;
  made.gl_ = &gl;
  made.shell_count_ = static_cast<GLsizei>(view.shell.indices.size());
  made.rim_count_ = static_cast<GLsizei>(view.rim.indices.size());
  made.look_.color = view.color;
  made.look_.opacity = view.opacity;
  Bounds bounds = vertices.empty() ? Bounds{} : Bounds::none();
  for (const Vertex& vertex : vertices) bounds.include(Vec3(vertex.position));
  made.corners_ = bounds.corners();
  made.array_ = make_vertex_array(gl);
  made.vertices_ = make_filled_buffer(gl, vertices);
  made.indices_ = make_filled_buffer(gl, indices);
  const GLuint array = made.array_.name();
  const std::array<std::pair<GLint, std::size_t>, 3> parts{
      {{3, offsetof(Vertex, position)}, {3, offsetof(Vertex, normal)}, {1, offsetof(Vertex, place)}}};
  for (GLuint attribute = 0; attribute < 3; ++attribute) {
    gl.EnableVertexArrayAttrib(array, attribute);
    gl.VertexArrayAttribFormat(array, attribute, parts[attribute].first, GL_FLOAT, GL_FALSE, static_cast<GLuint>(parts[attribute].second));
    gl.VertexArrayAttribBinding(array, attribute, 0);
  }
  gl.VertexArrayVertexBuffer(array, 0, made.vertices_.name(), 0, sizeof(Vertex));
  gl.VertexArrayElementBuffer(array, made.indices_.name());
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for the skin", {}};
  return made;
}

void SkinMesh::draw(GLsizei first, GLsizei count) const {
  gl_->BindVertexArray(array_.name());
  const std::size_t offset = static_cast<std::size_t>(first) * sizeof(std::uint32_t);
  // With a bound buffer the offset is passed as a pointer.  NOLINTNEXTLINE(performance-no-int-to-ptr)
  gl_->DrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
}

}  // namespace burrhole
