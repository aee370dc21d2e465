/// app/render/upload_ring.h: ring of mapped buffers for texel uploads, so that a copy does not wait for the GPU to finish drawing.
///   Internal to app/render.   Units  bytes.   Errors  nothing is returned.   Thread  that of the context, which is current.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>

#include "app/render/gl_object.h"

namespace burrhole {

/// One mapped buffer in three slots that are used in rotation; a fence signals that the GPU has read a slot. With Mesa's software renderer,
/// which reads at once, a plain upload is faster.
class UploadRing {
 public:
  static constexpr std::size_t kSlots = 3, kSlotBytes = std::size_t{1} << 20;

  explicit UploadRing(const GladGLContext& gl);
  UploadRing(const UploadRing&) = delete;
  UploadRing& operator=(const UploadRing&) = delete;
  ~UploadRing();

  /// Copies the parts, one after the other, into the next slot, after the GPU has read its previous content. Uploads then read from the
  /// buffer until finish(). @returns the offset [bytes] of the first part in the buffer, which an upload takes in place of a pointer;
  /// nothing, without any change, if the parts do not fit into a slot or the driver could not map the buffer.
  [[nodiscard]] std::optional<std::size_t> stage(std::initializer_list<std::span<const std::byte>> parts);
  /// Ends the uploads from the slot that stage() filled. Call it after each stage() that returned an offset.
  void finish();

 private:
  const GladGLContext& gl_;
  GlObject buffer_;
  std::byte* memory_ = nullptr;  ///< mapped by the driver, valid while the buffer exists
  std::array<GLsync, kSlots> read_{};
  std::size_t next_ = 0;
};

}  // namespace burrhole
