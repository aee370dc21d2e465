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

std::uint64_t BoneBuffer::write(const BoneMesh& mesh, const TriangleRange& places) {
  for (std::uint32_t begin = places.begin; begin < places.end; begin += kMostAtOnce) {
    const std::uint32_t end = std::min(places.end, begin + kMostAtOnce);
    staging_.clear();
    for (std::uint32_t place = begin; place < end; ++place) {
      staging_.push_back(mesh.triangle(chunks_.number_at(place)));
      chunks_.set(place, staging_.back());
    }
    gl_->NamedBufferSubData(vertices_.name(), static_cast<GLintptr>(begin) * static_cast<GLintptr>(sizeof(MeshTriangle)),
                            static_cast<GLsizeiptr>(staging_.size() * sizeof(MeshTriangle)), staging_.data());
  }
  return places.size() * sizeof(MeshTriangle);
}

Result<BoneBuffer::Sent> BoneBuffer::send(BoneMesh& mesh) {
  Sent sent;
  const std::vector<TriangleRange> changed = mesh.take_changed();
  const std::uint32_t slots = mesh.slots();
  if (slots > capacity_) {
    if (Status grown = grow(slots); !grown) return grown.error();
    chunks_.arrange(mesh);
    sent.whole = write(mesh, {0, slots});
    return sent;
  }
  chunks_.extend(slots);
  places_.clear();
  for (const TriangleRange& range : changed)
    for (std::uint32_t number = range.begin; number < std::min(range.end, slots); ++number) places_.push_back(chunks_.place_of(number));
  std::ranges::sort(places_);
  for (std::size_t n = 0; n < places_.size();) {
    const std::size_t first = n++;
    while (n < places_.size() && places_[n] == places_[n - 1] + 1) ++n;
    sent.changed += write(mesh, {places_[first], places_[n - 1] + 1});
  }
  return sent;
}

void BoneBuffer::draw(const CameraRays& rays, const Affine& world_from_bone, const PixelRect& part, const Vec2i& picture) {
  firsts_.clear();
  counts_.clear();
  for (const TriangleRange& range : chunks_.find(rays, world_from_bone, part, picture)) {
    firsts_.push_back(static_cast<GLint>(3 * range.begin));
    counts_.push_back(static_cast<GLsizei>(3 * range.size()));
  }
  if (firsts_.empty()) return;
  gl_->BindVertexArray(array_.name());
  gl_->MultiDrawArrays(GL_TRIANGLES, firsts_.data(), counts_.data(), static_cast<GLsizei>(firsts_.size()));
}

}  // namespace burrhole
