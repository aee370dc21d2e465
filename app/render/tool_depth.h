/// app/render/tool_depth.h: depths of the tool seen from the light, for its shadow. Internal to app/render.
///   Frame  that of FrameBlock::light_from_world.   Units  depths 0..1, 1 where there is no tool.   Errors  unavailable.
#pragma once

#include "app/render/gl_object.h"
#include "app/render/tool_mesh.h"
#include "core/base/result.h"

namespace burrhole {

class ToolDepth {
 public:
  ToolDepth() = default;
  /// @returns ErrorCode::unavailable if the driver rejects it.
  [[nodiscard]] static Result<ToolDepth> create(const GladGLContext& gl);
  /// Draws the tool by a program of tool_depth_variant(). Another target is to be bound afterwards. @pre the block of the frame is bound.
  void draw(const ToolMesh& tool, GLuint program) const;
  /// A texture that compares: the share of the nearest four texels whose depth is not less.
  [[nodiscard]] GLuint depths() const noexcept { return depths_.name(); }

 private:
  const GladGLContext* gl_ = nullptr;
  GlObject framebuffer_, depths_;
};

}  // namespace burrhole
