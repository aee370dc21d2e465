#include "app/render/added_mesh_buffer.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace burrhole {
namespace {

/// As added.vert reads it.
struct Vertex {
  Vec3f position, normal;
  Rgba8 color;
  float unlit = 0.0f;
};
static_assert(sizeof(Vertex) == 8 * sizeof(float));

Status check(const AddedMesh& mesh) {
  if (mesh.triangles.empty()) return bad_input("an added mesh needs a triangle");
  if (mesh.colors.size() != mesh.vertices.size()) return bad_input("an added mesh needs one colour a vertex");
  if (mesh.unlit.size() > mesh.vertices.size()) return bad_input("an added mesh has more unlit shares than vertices");
  for (const auto& triangle : mesh.triangles)
    if (std::ranges::any_of(triangle, [&](std::uint32_t n) { return n >= mesh.vertices.size(); }))
      return bad_input("an added mesh has an index beyond its vertices");
  if (!std::ranges::all_of(mesh.vertices, [](const glm::vec3& p) { return is_finite(Vec3(p)); }))
    return bad_input("an added mesh has a vertex that is not finite");
  if (mesh.triangles.size() > static_cast<std::size_t>(std::numeric_limits<GLsizei>::max()) / 3)
    return bad_input("an added mesh is too large");
  return {};
}

/// Normals are the means of those of the triangles at a vertex, by area.
std::vector<Vertex> make_vertices(const AddedMesh& mesh) {
  std::vector<Vertex> out(mesh.vertices.size());
  constexpr float kWhole = 255.0f;
  for (std::size_t n = 0; n < out.size(); ++n)
    out[n] = {mesh.vertices[n], Vec3f(0.0f), mesh.colors[n], n < mesh.unlit.size() ? static_cast<float>(mesh.unlit[n]) / kWhole : 0.0f};
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 from(mesh.vertices[a]);
    const Vec3f normal(1e6 * glm::cross(Vec3(mesh.vertices[b]) - from, Vec3(mesh.vertices[c]) - from));
    for (const std::uint32_t n : {a, b, c}) out[n].normal += normal;
  }
  for (Vertex& vertex : out) {
    const float length = glm::length(vertex.normal);
    vertex.normal = length > 0.0f ? vertex.normal / length : Vec3f(0.0f, 0.0f, 1.0f);
  }
  return out;
}

template <class T>
GlObject make_filled_buffer(const GladGLContext& gl, const std::vector<T>& data) {
  GlObject buffer = make_buffer(gl);
  gl.NamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), 0);
  return buffer;
}

}  // namespace

Result<AddedMeshBuffer> AddedMeshBuffer::create(const GladGLContext& gl, const AddedMesh& mesh, std::uint64_t version) {
  if (const Status valid = check(mesh); !valid) return valid.error();
  AddedMeshBuffer made;
  made.gl_ = &gl;
  made.version_ = version;
  made.is_wet_ = std::ranges::any_of(mesh.colors, [](const Rgba8& color) { return color.a >= kLeastWet; });
  made.index_count_ = static_cast<GLsizei>(3 * mesh.triangles.size());
  Bounds bounds = Bounds::none();
  for (const glm::vec3& p : mesh.vertices) bounds.include(Vec3(p));
  made.corners_ = bounds.corners();
  made.array_ = make_vertex_array(gl);
  made.vertices_ = make_filled_buffer(gl, make_vertices(mesh));
  made.indices_ = make_filled_buffer(gl, mesh.triangles);
  const GLuint array = made.array_.name();
  gl.VertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offsetof(Vertex, position)));
  gl.VertexArrayAttribFormat(array, 1, 3, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offsetof(Vertex, normal)));
  gl.VertexArrayAttribFormat(array, 2, 4, GL_UNSIGNED_BYTE, GL_TRUE, static_cast<GLuint>(offsetof(Vertex, color)));
  gl.VertexArrayAttribFormat(array, 3, 1, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offsetof(Vertex, unlit)));
  for (const GLuint attribute : {0u, 1u, 2u, 3u}) {
    gl.EnableVertexArrayAttrib(array, attribute);
    gl.VertexArrayAttribBinding(array, attribute, 0);
  }
  gl.VertexArrayVertexBuffer(array, 0, made.vertices_.name(), 0, sizeof(Vertex));
  gl.VertexArrayElementBuffer(array, made.indices_.name());
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for what effects show", {}};
  return made;
}

void AddedMeshBuffer::draw() const {
  gl_->BindVertexArray(array_.name());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

std::array<Vec3, 8> AddedMeshBuffer::corners_at(const Pose& world_from_bone) const noexcept {
  std::array<Vec3, 8> out = corners_;
  for (Vec3& corner : out) corner = world_from_bone * corner;
  return out;
}

}  // namespace burrhole
