/// app/render/picture_texture.h: a picture as a texture that a window shows, and the window's background.
///   Frame  none: pixels, row 0 at the top.   Errors  none.   Thread  that of the context, which is current.
#pragma once

#include "app/render/gl_context.h"
#include "app/view/view.h"

namespace burrhole {

class PictureTexture {
 public:
  /// @param context must outlive the texture.
  explicit PictureTexture(const GlContext& context);
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;
  ~PictureTexture();

  /// Replaces the picture, of whatever size.
  void set(const Image& image);
  /// Name of the texture in OpenGL; 0 before the first picture.
  [[nodiscard]] unsigned name() const noexcept { return name_; }
  [[nodiscard]] int width() const noexcept { return width_; }    ///< [pixels] of the picture
  [[nodiscard]] int height() const noexcept { return height_; }  ///< [pixels] of the picture
  /// In a window with quad-buffered stereo: what follows is drawn into the back buffer of one eye, which read_window() reads.
  void draw_to_eye(bool left) const;
  /// Binds the window's own framebuffer and fills it. @param width, height [pixels].
  void clear_window(int width, int height, const Vec3& color) const;
  /// @returns what the window shows, before it is swapped.
  [[nodiscard]] Image read_window(int width, int height) const;

 private:
  const GladGLContext* gl_;
  unsigned name_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace burrhole
