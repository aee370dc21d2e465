/// app/render/bone_buffer.h: the triangles of a BoneMesh in GPU memory, in the order of their numbers. Internal to app/render.
///   Frame  bone frame.   Units  m.   Errors  unavailable: the driver has no memory.
#pragma once

#include <cstdint>
#include <vector>

#include "app/render/gl_object.h"
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
  void draw() const;

 private:
  [[nodiscard]] Status grow(std::uint32_t slots);
  std::uint64_t write(const BoneMesh& mesh, const TriangleRange& range);

  const GladGLContext* gl_;
  GlObject array_, vertices_;
  std::uint32_t capacity_ = 0, slots_ = 0;  // [triangles]
  std::vector<MeshTriangle> staging_;       // reused memory
};

}  // namespace burrhole
