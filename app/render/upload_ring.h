/// app/render/upload_ring.h: buffers that texels are copied into on their way to a card, so that the copy need not wait until the card has
///   drawn what it still draws. Internal: only app/render's sources include it.
///   Thread  that of the context, which is current.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>

#include "app/render/gl_object.h"

namespace burrhole {

/// One mapped buffer in three slots, used by turns; a fence says when the card has read a slot. Over Mesa's software renderer, which reads at
/// once, a plain upload is quicker.
class UploadRing {
 public:
  static constexpr std::size_t kSlots = 3, kSlotBytes = std::size_t{1} << 20;

  explicit UploadRing(const GladGLContext& gl);
  UploadRing(const UploadRing&) = delete;
  UploadRing& operator=(const UploadRing&) = delete;
  ~UploadRing();

  /// Copies the parts, one after the other, into the next slot and lets uploads read from the buffer until finish().
  /// @returns where the first lies in the buffer, as uploads take it; nothing, and nothing done, when they do not fit into a slot or the
  /// driver maps no buffer.
  [[nodiscard]] std::optional<std::size_t> stage(std::initializer_list<std::span<const std::byte>> parts);
  void finish();

 private:
  const GladGLContext& gl_;
  GlObject buffer_;
  std::byte* memory_ = nullptr;  ///< of the driver, as long as the buffer lives
  std::array<GLsync, kSlots> read_{};
  std::size_t next_ = 0;
};

}  // namespace burrhole
