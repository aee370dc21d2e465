/// app/render/skin_mesh.h: the triangles of a skin on the GPU. Internal to app/render.
///   Frame  bone frame.   Units  m.   Errors  bad_input, unavailable.
#pragma once

#include <array>

#include "app/render/gl_object.h"
#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

class SkinMesh {
 public:
  /// @returns ErrorCode::bad_input if sizes disagree, an index is beyond the vertices, a vertex is not finite, or colour or opacity are outside
  /// 0..1; ErrorCode::unavailable if the driver has not enough memory.
  [[nodiscard]] static Result<SkinMesh> create(const GladGLContext& gl, const SkinView& view);
  void draw_shell() const { draw(0, shell_count_); }
  void draw_rim() const { draw(shell_count_, rim_count_); }
  [[nodiscard]] const std::array<Vec3, 8>& corners() const noexcept { return corners_; }  ///< of its bounding box
  [[nodiscard]] const SkinView& look() const noexcept { return look_; }                   ///< without triangles

 private:
  void draw(GLsizei first, GLsizei count) const;

  const GladGLContext* gl_ = nullptr;
  GlObject array_, vertices_, indices_;
  GLsizei shell_count_ = 0, rim_count_ = 0;
  std::array<Vec3, 8> corners_{};
  SkinView look_;
};

}  // namespace burrhole
