/// app/render/tool_mesh.h: a triangle mesh in GPU memory. Internal to app/render.
///   Frame  tool frame.   Units  m.   Errors  bad_input, unavailable.
#pragma once

#include <array>

#include "app/render/gl_object.h"
#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

class ToolMesh {
 public:
  ToolMesh() = default;
  /// @returns ErrorCode::bad_input for a mesh that is empty, lacks a normal per vertex, or has an index beyond its vertices.
  [[nodiscard]] static Result<ToolMesh> create(const GladGLContext& gl, const TriangleMesh& mesh);
  void draw() const;
  /// Corners of its bounding box [m], tool frame.
  [[nodiscard]] const std::array<Vec3, 8>& corners() const noexcept { return corners_; }
  /// The same in the world.
  [[nodiscard]] std::array<Vec3, 8> corners_at(const Pose& world_from_tool) const noexcept {
    std::array<Vec3, 8> out = corners_;
    for (Vec3& corner : out) corner = world_from_tool * corner;
    return out;
  }

 private:
  const GladGLContext* gl_ = nullptr;
  GlObject array_, positions_, normals_, indices_;
  GLsizei index_count_ = 0;
  std::array<Vec3, 8> corners_{};
};

}  // namespace burrhole
