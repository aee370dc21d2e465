#include "app/render/bone_buffer.h"

#include <algorithm>
#include <cstddef>

namespace burrhole {
namespace {

constexpr std::uint32_t kMostAtOnce = 4096;  // [triangles] of the staging memory

void describe(const GladGLContext& gl, GLuint array) {
  gl.VertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, offsetof(MeshVertex, position));
  gl.VertexArrayAttribFormat(array, 1, 4, GL_SHORT, GL_TRUE, offsetof(MeshVertex, normal));
  gl.VertexArrayAttribFormat(array, 2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(MeshVertex, color));
  for (const GLuint attribute : {0u, 1u, 2u}) {
    gl.EnableVertexArrayAttrib(array, attribute);
    gl.VertexArrayAttribBinding(array, attribute, 0);
  }
}

}  // namespace

BoneBuffer::BoneBuffer(const GladGLContext& gl) : gl_(&gl), array_(make_vertex_array(gl)) { describe(gl, array_.name()); }

Status BoneBuffer::grow(std::uint32_t slots) {
  const std::uint32_t capacity = slots + slots / 2;
  GlObject made = make_buffer(*gl_);
  gl_->NamedBufferStorage(made.name(), static_cast<GLsizeiptr>(capacity) * static_cast<GLsizeiptr>(sizeof(MeshTriangle)), nullptr,
                          GL_DYNAMIC_STORAGE_BIT);
  if (gl_->GetError() != GL_NO_ERROR) return Error{ErrorCode::unavailable, "the driver has no memory for the mesh of the bone", {}};
  vertices_ = std::move(made);
  capacity_ = capacity;
  gl_->VertexArrayVertexBuffer(array_.name(), 0, vertices_.name(), 0, sizeof(MeshVertex));
  return {};
}

std::uint64_t BoneBuffer::write(const BoneMesh& mesh, const TriangleRange& range) {
  for (std::uint32_t begin = range.begin; begin < range.end; begin += kMostAtOnce) {
    const std::uint32_t end = std::min(range.end, begin + kMostAtOnce);
    staging_.clear();
    for (std::uint32_t number = begin; number < end; ++number) staging_.push_back(mesh.triangle(number));
    gl_->NamedBufferSubData(vertices_.name(), static_cast<GLintptr>(begin) * static_cast<GLintptr>(sizeof(MeshTriangle)),
                            static_cast<GLsizeiptr>(staging_.size() * sizeof(MeshTriangle)), staging_.data());
  }
  return range.size() * sizeof(MeshTriangle);
}

Result<BoneBuffer::Sent> BoneBuffer::send(BoneMesh& mesh) {
  Sent sent;
  const std::vector<TriangleRange> changed = mesh.take_changed();
  slots_ = mesh.slots();
  if (slots_ > capacity_) {
    if (Status grown = grow(slots_); !grown) return grown.error();
    sent.whole = write(mesh, {0, slots_});
    return sent;
  }
  for (const TriangleRange& range : changed) sent.changed += write(mesh, {range.begin, std::min(range.end, slots_)});
  return sent;
}

void BoneBuffer::draw() const {
  if (slots_ == 0) return;
  gl_->BindVertexArray(array_.name());
  gl_->DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * slots_));
}

}  // namespace burrhole
