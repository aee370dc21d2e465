/// app/render/read_buffer.h: a mapped buffer through which a GPU hands over a picture, since it writes into memory of a program only
///   slowly. Internal to app/render.   Units  pixels.   Errors  none.   Thread  that of the context, which is current.
#pragma once

#include <cstddef>
#include <span>

#include "app/render/footprint.h"
#include "app/render/gl_object.h"
#include "app/view/view.h"

namespace burrhole {

class ReadBuffer {
 public:
  explicit ReadBuffer(const GladGLContext& gl) : gl_(gl) {}

  /// Reads pixels of the framebuffer that is bound for reading, and waits until they are there. @returns them, the bottom row first, valid
  /// until the next call; nothing if the driver could not map the buffer.
  [[nodiscard]] std::span<const Rgba8> read(const PixelRect& part);

 private:
  const GladGLContext& gl_;
  GlObject buffer_;
  std::size_t pixels_ = 0;  // that the buffer has room for
  const Rgba8* memory_ = nullptr;
};

}  // namespace burrhole
