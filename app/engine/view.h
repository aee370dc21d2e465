/// app/engine/view.h: plain structs between the engine and a display; no OpenGL here.
///   Frame  world frame (LPS) unless said; Units SI; images: row 0 is the top, RGBA8, sRGB values as stored.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/tool/tool.h"

namespace burrhole {

struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 0;
  friend bool operator==(const Rgba8&, const Rgba8&) = default;
};

/// [AcostaLiu07] eq. 5, C = 0.5 N + 0.5, rounded to 8 bits; each component of `normal` in -1..1.
[[nodiscard]] inline Rgba8 encode_normal(const Vec3& normal, std::uint8_t opacity) noexcept {
  const auto code = [](double n) { return static_cast<std::uint8_t>(std::floor(std::clamp(0.5 * n + 0.5, 0.0, 1.0) * 255.0 + 0.5)); };
  return {code(normal.x), code(normal.y), code(normal.z), opacity};
}

/// [AcostaLiu07] eq. 6, N = 2 (C - 0.5); within 1/255 a component of what was encoded, not renormalised.
[[nodiscard]] inline Vec3 decode_normal(const Rgba8& texel) noexcept { return 2.0 * (Vec3(texel.r, texel.g, texel.b) / 255.0 - 0.5); }

/// A box of texels, i fastest. normal_opacity: RGB = 0.5 N + 0.5 ([AcostaLiu07] eq. 5; N is the outward unit normal, bone frame, of bone, or of
/// soft tissue where that changes about as fast or faster), A = occupancy x remaining of bone. An unknown normal is stored as 0.5, 0.5, 0.5.
/// field: what is seen of both, 0..65535: the larger of bone's occupancy x remaining and the occupancy of soft tissue.
struct TexelBox {
  VoxelBox box;
  std::vector<Rgba8> normal_opacity;
  std::vector<std::uint16_t> field;
};

/// Bytes that a voxel's change sends.
inline constexpr std::size_t kTexelBytes = sizeof(Rgba8) + sizeof(std::uint16_t);

/// The field of a voxel from alphas of 8 bits.
[[nodiscard]] constexpr std::uint16_t field_of(std::uint8_t bone, std::uint8_t soft) noexcept {
  return static_cast<std::uint16_t>(257 * std::max(bone, soft));
}

/// What a voxel was before any drill came, never sent again. r: occupancy as loaded. g: of bone how spongy it is, 0 dense .. 255 marrow; of
/// soft tissue 255 dura, 0 brain.
struct TissueTexel {
  std::uint8_t r = 0, g = 0;
  friend bool operator==(const TissueTexel&, const TissueTexel&) = default;
};

/// Texels before they are rounded, as fractions.
struct PreciseTexels {
  std::vector<glm::vec4> normal_opacity;
  std::vector<float> field;
};

/// The volume as first sent: every texel and its colour. Alpha of `color` is the occupancy of soft tissue (dura, brain), 0..255: its 0.5
/// level is a surface too, seen but not felt.
struct VolumeView {
  Vec3i dims{0};
  Affine bone_from_index;  ///< [m]
  std::vector<Rgba8> normal_opacity;
  std::vector<Rgba8> color;
  std::vector<std::uint16_t> field{};  ///< as of TexelBox; empty: from the alphas of both
  std::vector<TissueTexel> tissue{};   ///< empty where no picture asks for it
  PreciseTexels precise{};             ///< drawn in place of normal_opacity and field, for measurements; empty: not there
};

/// What a picture may cost: the knobs that trade its accuracy for time.
struct DrawingQuality {
  double step_voxels = 0.5;  ///< (0, 1] distance of samples along a ray, in index coordinates
  int bisections = 5;        ///< 0..16, each halves the error of the hit
  bool finish = true;        ///< smooth normals, and ambient occlusion where it is asked for
  int supersample = 1;       ///< 1..4, rays along each side of a pixel
  double resolution = 1.0;   ///< [0.25, 1] of the picture's width and height are drawn, then enlarged
  friend bool operator==(const DrawingQuality&, const DrawingQuality&) = default;
};

/// Where normals come from: the first texture, as sent, or differences of the density in each pixel.
enum class NormalSource { texture, recomputed };

/// What light and tissue may look like beyond the light of the paper; what is off is not in the shader.
struct LookView {
  bool tissue = false;     ///< procedural tissue: old surface, cut bone, pores, vessels; needs VolumeView::tissue
  bool occlusion = false;  ///< less sky in hollows
  bool shadow = false;     ///< bone between a point and the light
  bool specular = false;   ///< the glint of a wet surface
  bool labels = true;      ///< colours by tissue; off: all of one ivory
  NormalSource normals = NormalSource::texture;
};

/// Perspective camera.
struct CameraView {
  Vec3 eye{0.0, -0.1, 0.1};
  Vec3 target{0.0};
  Vec3 up{0.0, 0.0, 1.0};
  double vertical_fov = 0.6;  ///< [rad] in (0, 3)
  /// Off-axis frustum: where the middle of the picture lies off the direction of view, in half widths and half heights of the picture.
  glm::dvec2 shift{0.0};
  friend bool operator==(const CameraView&, const CameraView&) = default;
};

/// Two pictures, one an eye, as one.
enum class StereoMode { off, side_by_side, top_bottom, anaglyph };

struct StereoView {
  StereoMode mode = StereoMode::off;
  double separation = 0.0;  ///< [m] between the eyes
  double screen = 0.0;      ///< [m] from the eyes to the plane on which both see a point at one place
};

/// Light of [AcostaLiu07] section 4: C = Ia Cv + Id Cv max(N.L, 0); `fill` adds a weak headlight, fill Cv max(N.V, 0), 0 for the paper's
/// own.
struct LightView {
  double ambient = 0.35;
  double diffuse = 0.75;
  double fill = 0.12;
  Vec3 direction_to_light{0.3, -0.5, 0.8};  ///< world; normalised on use
};

/// A corner of the piecewise linear line from density (occupancy x remaining) to what translucent bone does to light.
struct TransferPoint {
  double density = 0.0;     ///< 0..1, rising from corner to corner
  double extinction = 0.0;  ///< [1/m] light falls by exp(-extinction * way)
  Vec3 tint{1.0};           ///< 0..1, times the tissue's own colour
};
/// Level before the first corner and after the last.
using TransferFunction = std::vector<TransferPoint>;

/// A soft vertical gradient behind everything.
struct BackgroundView {
  Vec3 bottom{0.60, 0.65, 0.70};  ///< 0..1, as stored
  Vec3 top{0.19, 0.24, 0.30};
};

/// Everything one frame shows.
struct FrameView {
  CameraView camera;
  LightView light;
  BackgroundView background;
  Pose world_from_bone;
  std::optional<Pose> world_from_tool;  ///< nothing: the tool is not drawn
  /// Half space cut away from the picture: points with dot(normal, p_world) > offset are not drawn (bone, dura and brain; not the tool).
  struct Cut {
    Vec3 normal{0.0, -1.0, 0.0};
    double offset = 0.0;  ///< [m]
  };
  std::optional<Cut> cut;
};

struct Image {
  int width = 0, height = 0;
  std::vector<Rgba8> pixels;
};

}  // namespace burrhole
