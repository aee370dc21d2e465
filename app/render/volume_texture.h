/// app/render/volume_texture.h: the two 3D textures of the paper, the field texture and the skip map on the GPU. Internal to app/render.
///   Frame  index.   Units  texels.   Errors  bad_input, out_of_range, unavailable.
///   Source [AcostaLiu07] section 4: normals and opacity in one RGBA texture, colours in a second, partial updates by sub-texture.
#pragma once

#include <cstdint>
#include <optional>

#include "app/render/gl_object.h"
#include "app/render/skip_map.h"
#include "app/render/upload_ring.h"
#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// [bytes] sent to the GPU by one change.
struct UploadedBytes {
  std::uint64_t texels = 0;
  std::uint64_t skip_map = 0;
};

/// The smallest 8-bit value at or above the drawn level 0.5; a trilinear mean of smaller values is below the level.
inline constexpr std::uint8_t kSolidOpacity = 128;
/// Grey value of marrow in slices.
inline constexpr float kMarrow = 0.25f;

/// @returns a texture of colours alone, for the section of a mesh. Errors as VolumeTexture::create(). @pre one colour per voxel.
[[nodiscard]] Result<GlObject> make_color_texture(const GladGLContext& gl, const Vec3i& dims, const std::vector<Rgba8>& colors);

class VolumeTexture {
 public:
  VolumeTexture() = default;
  /// @param seen_from smallest opacity of bone, 0..255, that is visible; if given, a skip map is made. A trilinear mean of smaller values
  /// must be invisible.
  /// @returns ErrorCode::bad_input if sizes disagree or the affine is singular, ErrorCode::out_of_range beyond the driver's limit,
  /// ErrorCode::unavailable if the driver has not enough memory.
  [[nodiscard]] static Result<VolumeTexture> create(const GladGLContext& gl, const VolumeView& view, std::optional<std::uint8_t> seen_from);

  /// Replaces the texels of the box. @param may_grow the box may have more bone than before: the skip map is updated.
  /// @param ring null: the driver copies texels. @returns the bytes sent. @pre the box lies inside the volume.
  UploadedBytes update(const TexelBox& texels, bool may_grow, UploadRing* ring);
  void bind() const;  ///< texture units 0, 1, 6; with a skip map 2, with tissue 5

  void bind_field(GLuint unit) const;
  /// Reads the opacity of bone back, as drawn, 0..1, x fastest. Where the volume has tissue, bone as loaded is darker the more pores it
  /// has, from 1 to kMarrow. @pre the box lies inside the volume. Waits for the GPU.
  [[nodiscard]] std::vector<float> read_mineral(const VoxelBox& box) const;

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
