/// app/render/volume_texture.h: the paper's two 3D textures, the seen field and the skip map on the card. Internal: only app/render's sources include it.
///   Source [AcostaLiu07] section 4: normals and opacity in one RGBA texture, colours in a second, partial updates by sub-texture.
#pragma once

#include <cstdint>
#include <optional>

#include "app/engine/view.h"
#include "app/render/gl_object.h"
#include "app/render/skip_map.h"
#include "app/render/upload_ring.h"
#include "core/base/result.h"

namespace burrhole {

/// Bytes that one change sent to the card.
struct UploadedBytes {
  std::uint64_t texels = 0;
  std::uint64_t skip_map = 0;
};

/// The least 8-bit value at or above the drawn level 0.5; a trilinear mean of lesser ones stays below it.
inline constexpr std::uint8_t kSolidOpacity = 128;

class VolumeTexture {
 public:
  VolumeTexture() = default;
  /// @param seen_from the least opacity of bone, 0..255, a picture shows: with it comes a skip map. A trilinear mean of lesser ones must
  /// be invisible.
  /// @returns ErrorCode::bad_input when sizes disagree or the affine is singular, ErrorCode::out_of_range beyond the driver's limit,
  /// ErrorCode::unavailable when the driver has no memory for it.
  [[nodiscard]] static Result<VolumeTexture> create(const GladGLContext& gl, const VolumeView& view, std::optional<std::uint8_t> seen_from);

  /// Replaces exactly the texels of the box. @param may_grow bone of the box may be more than before: the skip map is told.
  /// @param ring nothing: the driver copies texels itself. @returns what was sent; the box lies inside the volume (ours to see to).
  UploadedBytes update(const TexelBox& texels, bool may_grow, UploadRing* ring);
  void bind() const;  ///< texture units 0, 1, 6 and, with a skip map, 2, with tissue 5

  [[nodiscard]] const Vec3i& dims() const noexcept { return dims_; }
  [[nodiscard]] const Affine& bone_from_index() const noexcept { return bone_from_index_; }
  [[nodiscard]] bool has_soft() const noexcept { return has_soft_; }
  [[nodiscard]] bool has_tissue() const noexcept { return static_cast<bool>(tissue_); }
  [[nodiscard]] bool has_skip_map() const noexcept { return static_cast<bool>(skip_texture_); }
  [[nodiscard]] UploadedBytes initial_bytes() const noexcept;

 private:
  void send(const TexelBox& texels, UploadRing* ring) const;

  const GladGLContext* gl_ = nullptr;
  Vec3i dims_{0};
  Affine bone_from_index_;
  bool has_soft_ = false;
  std::uint8_t seen_from_ = 0;
  std::size_t texel_bytes_ = kTexelBytes;
  GlObject normal_opacity_, color_soft_, field_, skip_texture_, tissue_;
  SkipMap skip_map_;
};

}  // namespace burrhole
