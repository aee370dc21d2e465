/// app/render/screen_mesh.h: the triangle over the whole picture, or rectangles of it, at which a fragment shader runs. Internal to app/render.
///   Units  pixels.   Errors  none.
#pragma once

#include <span>

#include "app/render/footprint.h"
#include "app/render/gl_object.h"

namespace burrhole {

class ScreenMesh {
 public:
  explicit ScreenMesh(const GladGLContext& gl);
  /// Of a picture of that size. Fragments at the same pixels are those of the whole picture: shaders read gl_FragCoord alone.
  void set(std::span<const PixelRect> rects, const Vec2i& picture);
  void draw_all() const;    ///< over the whole picture
  void draw_rects() const;  ///< over the rectangles of the last set()

 private:
  const GladGLContext* gl_;
  GlObject all_, rects_, all_vertices_, rect_vertices_;
  int count_ = 0;
};

}  // namespace burrhole
