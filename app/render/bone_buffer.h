/// app/render/bone_buffer.h: the triangles of a BoneMesh in GPU memory, at the places of triangle_chunks.h. Internal to app/render.
///   Frame  bone frame.   Units  m.   Errors  unavailable: the driver has no memory.
#pragma once

#include <cstdint>
#include <vector>

#include "app/render/gl_object.h"
#include "app/render/triangle_chunks.h"
#include "app/view/bone_mesh.h"
#include "core/base/result.h"

namespace burrhole {

class BoneBuffer {
 public:
  explicit BoneBuffer(const GladGLContext& gl);

  /// Bytes that one call of send() has passed to the driver.
  struct Sent {
    std::uint64_t whole = 0;    ///< [bytes] of all triangles, into a new buffer
    std::uint64_t changed = 0;  ///< [bytes] of changed triangles, into the buffer that exists
  };
  /// Sends the triangles that have changed since the last call. Where their numbers exceed the buffer, it is replaced by one half as large again, and all are sent.
  [[nodiscard]] Result<Sent> send(BoneMesh& mesh);
  /// Draws the triangles that a part of the picture may show. @param rays of the whole picture, whose size is `picture`.
  void draw(const CameraRays& rays, const Affine& world_from_bone, const PixelRect& part, const Vec2i& picture);

 private:
  [[nodiscard]] Status grow(std::uint32_t slots);
  std::uint64_t write(const BoneMesh& mesh, const TriangleRange& places);

  const GladGLContext* gl_;
  GlObject array_, vertices_;
  std::uint32_t capacity_ = 0;         // [triangles]
  std::vector<MeshTriangle> staging_;  // reused memory
  TriangleChunks chunks_;
  std::vector<std::uint32_t> places_;  // of changed triangles, reused memory
  std::vector<GLint> firsts_;          // [vertices] of the last draw(), reused memory
  std::vector<GLsizei> counts_;        // [vertices]
};

}  // namespace burrhole
