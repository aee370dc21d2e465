/// app/render/frame_cache.h: the last picture, and the pixels of it that the next picture must draw again. No OpenGL. Internal to
/// app/render.
///   Frame  drawn pixels: `supersample` along each side of a pixel of the picture; row 0 at the bottom.   Units  pixels.   Errors  none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/render/footprint.h"
#include "app/render/frame_block.h"
#include "core/base/box_list.h"

namespace burrhole {

/// All inputs of a picture except texels and tool. Two pictures with equal keys differ only where texels or tool changed.
struct FrameKey {
  std::string variant;  ///< of the volume's shaders; empty without a volume
  FrameBlock block;     ///< fields that depend on the tool are zero
};

/// @param block as passed to the shaders.
[[nodiscard]] FrameKey make_frame_key(std::string variant, const FrameBlock& block);

/// Position of the drawn tool; absent without a tool.
struct DrawnTool {
  Pose world_from_tool;
  PixelRect footprint;
  PixelRect shadow{};  ///< with layers, where its shadow on bone may be; empty without shadows
};

/// Position of what effects add; version 0 without it.
struct DrawnAdded {
  std::uint64_t version = 0;  ///< two with one version have the same triangles
  PixelRect footprint{};
};

/// What a picture must draw.
struct StalePixels {
  std::vector<PixelRect> drawn;  ///< disjoint: rays and light; without layers also the tool
  std::vector<PixelRect> relit;  ///< beside `drawn`, disjoint: the light of those hits whose ambient occlusion may read a changed texel
  /// With layers, beside both, disjoint: where the tool, its shadow or what effects add has changed.
  std::vector<PixelRect> tool;
  VoxelBox changed;              ///< round all texels that changed since the last picture

  /// @returns all rectangles.
  [[nodiscard]] std::vector<PixelRect> all() const;
  /// @returns the same in parts that can be drawn one after the other: bands of about kBandPixels of `drawn`, those nearest to the row
  /// `focus` first; the first part has everything else.
  [[nodiscard]] std::vector<StalePixels> in_bands(int supersample, int focus) const;
};

/// [drawn pixels] 10 ms of four rays a pixel with llvmpipe on two cores.
inline constexpr int kBandPixels = 1 << 17;

class FrameCache {
 public:
  /// @param supersample drawn pixels per pixel of the picture, along each side.
  explicit FrameCache(int supersample = 1) : supersample_(supersample) {}

  /// The next picture is drawn completely: volume or tool were replaced, or bone changed in a way that was not reported.
  void forget() noexcept { key_.reset(); }
  /// The next picture is drawn completely, with that many drawn pixels. Until all of it is drawn, the last one is shown in the rest.
  void restart(int supersample) noexcept;
  void texels_changed(const VoxelBox& box);

  /// @returns what the picture of `key` must draw, in whole pixels of the picture. @param drawn size in drawn pixels.
  /// @param world_from_index, reach of the volume; absent without a volume, whose texels then do not change. @param layers the tool is drawn
  /// over a copy of the picture of the bone; then hits can be relit, if `reach.occlusion` is not 0.
  [[nodiscard]] StalePixels find_stale(const FrameKey& key, const Vec2i& drawn, const std::optional<DrawnTool>& tool, const DrawnAdded& added,
                                       const std::optional<Affine>& world_from_index, const Reach& reach, bool layers) const;
  /// Stores the drawn parts of the picture. @param shrunk one image per rectangle, in pixels of the picture; of one that is the whole
  /// picture the memory is taken, and that of the last picture is left in its place. @param missing what was not drawn of the stale pixels,
  /// disjoint: the next find_stale() returns it again.
  void keep(FrameKey key, const Vec2i& drawn, const std::optional<DrawnTool>& tool, const DrawnAdded& added,
            std::span<const PixelRect> rects, std::span<Image> shrunk, std::vector<PixelRect> missing = {});
  [[nodiscard]] const Image& picture() const noexcept { return picture_; }

 private:
  int supersample_;
  std::optional<FrameKey> key_;
  std::optional<DrawnTool> tool_;
  DrawnAdded added_;
  BoxList<VoxelBox, 32> changed_;   // since the last picture
  std::vector<PixelRect> missing_;  // of the last picture
  Image picture_;
};

/// @returns the camera from which a block was filled; single precision, a few 1e-4 of a pixel.
[[nodiscard]] CameraRays rays_of(const FrameBlock& block) noexcept;

}  // namespace burrhole
