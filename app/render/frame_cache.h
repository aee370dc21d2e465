/// app/render/frame_cache.h: the last picture, and which of its pixels a next one must draw anew. No OpenGL. Internal to app/render.
///   Pixels are those that are drawn: `supersample` along each side of one of the picture; row 0 at the bottom.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/render/footprint.h"
#include "app/render/frame_block.h"

namespace burrhole {

/// All that a picture is made of but for texels and the tool: pictures of one key differ where these changed.
struct FrameKey {
  std::string variant;  ///< of the volume's shaders; empty without a volume
  FrameBlock block;     ///< what depends on the tool is zero
};

/// @param block as the shaders get it.
[[nodiscard]] FrameKey make_frame_key(std::string variant, const FrameBlock& block);

/// Where the tool is drawn; nothing without one.
struct DrawnTool {
  Pose world_from_tool;
  PixelRect footprint;
};

class FrameCache {
 public:
  /// @param supersample pixels drawn for one of the picture, along each side.
  explicit FrameCache(int supersample = 1) : supersample_(supersample) {}

  /// The next picture is drawn whole: volume or tool were replaced, or bone is other than told.
  void forget() noexcept { key_.reset(); }
  void texels_changed(const VoxelBox& box);

  /// What the picture of `key` must draw; whole pixels of the picture. @param drawn size in pixels drawn.
  /// @param world_from_index, reach of the volume; no texel has changed without one.
  [[nodiscard]] PixelRegion find_stale(const FrameKey& key, const Vec2i& drawn, const std::optional<DrawnTool>& tool,
                                       const std::optional<Affine>& world_from_index, const Reach& reach) const;
  /// Takes over the parts of the picture that were drawn. @param shrunk one for each rectangle of the region, in pixels of the picture.
  void keep(FrameKey key, const Vec2i& drawn, const std::optional<DrawnTool>& tool, const PixelRegion& region,
            std::span<const Image> shrunk);
  [[nodiscard]] const Image& picture() const noexcept { return picture_; }

 private:
  static constexpr std::size_t kMostBoxes = 32;

  int supersample_;
  std::optional<FrameKey> key_;
  std::optional<DrawnTool> tool_;
  std::vector<VoxelBox> boxes_;
  Image picture_;
};

/// The camera that a block was filled with; single precision, a few 1e-4 of a pixel.
[[nodiscard]] CameraRays rays_of(const FrameBlock& block) noexcept;

}  // namespace burrhole
