/// app/view/view.h: plain structs from the simulation to a display; no OpenGL.
///   Frame  world frame (LPS) unless stated; images: row 0 is the top, RGBA8, sRGB values as stored.   Units SI.   Errors  none.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
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

/// [AcostaLiu07] eq. 6, N = 2 (C - 0.5); each component is within 1/255 of the encoded one; not renormalised.
[[nodiscard]] inline Vec3 decode_normal(const Rgba8& texel) noexcept { return 2.0 * (Vec3(texel.r, texel.g, texel.b) / 255.0 - 0.5); }

/// A box of texels, i fastest. normal_opacity: RGB = 0.5 N + 0.5 ([AcostaLiu07] eq. 5), with N the outward unit normal in the bone frame:
/// that of bone, or that of soft tissue where its gradient is about as large or larger. A = occupancy x remaining of bone. An unknown
/// normal is stored as 0.5, 0.5, 0.5. field: the visible density, 0..65535: the larger of bone's occupancy x remaining and the occupancy of
/// soft tissue.
struct TexelBox {
  VoxelBox box;  ///< [voxels] of the volume, or of its detail
  std::vector<Rgba8> normal_opacity;
  std::vector<std::uint16_t> field;
  bool of_detail = false;
};

/// [bytes] sent for one changed voxel.
inline constexpr std::size_t kTexelBytes = sizeof(Rgba8) + sizeof(std::uint16_t);

/// @returns the field of a voxel from 8-bit alphas.
[[nodiscard]] constexpr std::uint16_t field_of(std::uint8_t bone, std::uint8_t soft) noexcept {
  return static_cast<std::uint16_t>(257 * std::max(bone, soft));
}

/// State of a voxel as loaded, sent once. r: occupancy as loaded. g: for bone its sponginess, 0 dense .. 255 marrow; for soft tissue 255
/// dura, 0 brain.
struct TissueTexel {
  std::uint8_t r = 0, g = 0;
  friend bool operator==(const TissueTexel&, const TissueTexel&) = default;
};

/// Texels before rounding, as fractions [-].
struct PreciseTexels {
  std::vector<glm::vec4> normal_opacity;  ///< [-]
  std::vector<float> field;               ///< [-]
};

struct DetailView;
struct SkinView;

/// The volume as first sent: every texel and its colour. Alpha of `color` is the occupancy of soft tissue (dura, brain), 0..255. Its 0.5
/// level is drawn as a surface, but has no contact.
struct VolumeView {
  Vec3i dims{0};           ///< [voxels]
  Affine bone_from_index;  ///< [m]
  std::vector<Rgba8> normal_opacity;
  std::vector<Rgba8> color;
  std::vector<std::uint16_t> field{};          ///< as TexelBox::field; empty: computed from the alphas of both
  std::vector<TissueTexel> tissue{};           ///< empty if no picture needs it
  PreciseTexels precise{};                     ///< if not empty, drawn instead of normal_opacity and field, for measurements
  std::shared_ptr<const DetailView> detail{};  ///< a part with finer voxels; null: there is none
  std::shared_ptr<const SkinView> skin{};      ///< null: there is none
  std::string note{};                          ///< what of it is assumed, one line for the picture; empty: nothing
};

/// A translucent shell over the bone: skin with an opening, whose edge is opaque. Drawn by rays to a surface only, over the bone's picture.
struct SkinView {
  TriangleMesh shell;         ///< bone frame
  std::vector<float> beyond;  ///< [m] of each vertex of the shell beyond the opening; where it is negative nothing is drawn
  TriangleMesh rim;           ///< bone frame; the cut edge of the skin
  std::vector<float> depth;   ///< [-] of each vertex of the rim: 0 at the skin's surface, 1 at the lower end
  Vec3 color{0.0};            ///< [-] 0..1
  double opacity = 0.0;       ///< [-] share of the light that the shell takes square on; at an angle 1 - (1 - opacity)^(1 / cosine)
};

/// Position of a part that is drawn at the bone's own voxels, in a bone that is otherwise drawn at coarser voxels, every `factor`-th one.
/// Within `ring` voxels of its faces its texels are those of the coarse volume, interpolated; over the next `blend` voxels they change to
/// those of its own voxels. So there is no seam.
struct DetailGrid {
  VoxelBox box;    ///< [voxels] of the bone; box.lo and box.hi - 1 are multiples of factor
  int factor = 1;  ///< [voxels] of the bone, edge of a coarse voxel

  [[nodiscard]] double ring() const noexcept { return 2.0 * factor; }   ///< [voxels]
  [[nodiscard]] double blend() const noexcept { return 4.0 * factor; }  ///< [voxels]
  /// @returns 0..1, the weight of the part's own texels at voxel v of the bone.
  [[nodiscard]] double own_share(const Vec3i& v) const noexcept {
    const Vec3i inside = glm::min(v - box.lo, box.hi - 1 - v);
    const double t = std::clamp((std::min({inside.x, inside.y, inside.z}) - ring()) / blend(), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }
  /// @returns the coarse voxels around a box of the part. @param inner [voxels] of the part.
  [[nodiscard]] VoxelBox coarse_box(const VoxelBox& inner) const noexcept {
    return {(box.lo + inner.lo) / factor, (box.lo + inner.hi - 1) / factor + 2};
  }
};

/// The part itself: a volume over grid.box.
struct DetailView {
  DetailGrid grid;
  VolumeView volume;
};

/// Options that trade the accuracy of a picture for time.
struct DrawingQuality {
  double step_voxels = 0.5;  ///< [voxels] in (0, 1], distance of samples along a ray, in index coordinates
  int bisections = 5;        ///< 0..16, each halves the error of the hit
  bool finish = true;        ///< smooth normals, and ambient occlusion if requested
  int supersample = 1;       ///< 1..4, rays along each side of a pixel
  double resolution = 1.0;   ///< [-] in [0.25, 1], share of the picture's width and height that is drawn, then enlarged
  friend bool operator==(const DrawingQuality&, const DrawingQuality&) = default;
};

/// Source of normals: the first texture, as sent, or differences of the density in each pixel.
enum class NormalSource { texture, recomputed };

/// Options of light and tissue in addition to the light of the paper. A disabled option is not in the shader.
struct Appearance {
  bool tissue = false;     ///< procedural tissue: original surface, cut bone, pores, vessels; needs VolumeView::tissue
  bool occlusion = false;  ///< ambient occlusion
  bool shadow = false;     ///< shadows of bone and tool on bone
  bool specular = false;   ///< specular highlights of a wet surface
  bool drape = false;      ///< cloth has a pattern of its own
  bool labels = true;      ///< colours by tissue; off: one ivory colour
  NormalSource normals = NormalSource::texture;
};

/// The options of Appearance that a person changes while pictures are drawn.
struct SurfaceLights {
  bool shadow = false, specular = false;
  friend bool operator==(const SurfaceLights&, const SurfaceLights&) = default;
};

/// Fog of a microscope: of what lies at depth d from the plane of the camera's target, square to the view, a share 1 - exp(-(d / depth)^2) of
/// the colour is replaced.
struct FogView {
  double depth = 0.010;            ///< [m] > 0
  Vec3 color{0.035, 0.035, 0.04};  ///< [-] 0..1, as stored
  friend bool operator==(const FogView&, const FogView&) = default;
};

/// Perspective camera.
struct CameraView {
  Vec3 eye{0.0, -0.1, 0.1};   ///< [m]
  Vec3 target{0.0};           ///< [m]
  Vec3 up{0.0, 0.0, 1.0};     ///< [-] need not be perpendicular to the view
  double vertical_fov = 0.6;  ///< [rad] in (0, 3)
  /// [-] Off-axis frustum: offset of the centre of the picture from the direction of view, in half widths and half heights of the picture.
  glm::dvec2 shift{0.0};
  std::optional<FogView> fog{};  ///< absent: none, and nothing of it in a shader
  friend bool operator==(const CameraView&, const CameraView&) = default;
};

/// Combination of the two pictures of a stereo pair. quad: none, a window shows each eye from a buffer of its own.
enum class StereoMode { off, side_by_side, top_bottom, anaglyph, quad };

/// The haptic workbench of [AcostaLiu07]: bone appears at its place and size behind or before a screen that stands at the camera's target,
/// perpendicular to its view. The head may be anywhere before the screen; the camera's distance and field have no effect.
struct WorkbenchView {
  double height = 0.0;    ///< [m] of the screen; its width is that of the picture
  Vec3 head{0.0};         ///< [m] midway between the eyes, from the middle of the screen: right, up, towards the viewer
  bool mirrored = false;  ///< the screen is seen in a mirror: the picture is upside down
};

struct StereoView {
  StereoMode mode = StereoMode::off;
  double separation = 0.0;  ///< [m] distance of the eyes
  double screen = 0.0;      ///< [m] distance of the plane without parallax from the eyes; not used by a workbench
  std::optional<WorkbenchView> workbench{};
};

/// Light of [AcostaLiu07] section 4: C = Ia Cv + Id Cv max(N.L, 0). `fill` adds a weak headlight, fill Cv max(N.V, 0); 0 gives the light of
/// the paper.
struct LightView {
  double ambient = 0.35;                    ///< [-] Ia
  double diffuse = 0.75;                    ///< [-] Id
  double fill = 0.12;                       ///< [-]
  Vec3 direction_to_light{0.3, -0.5, 0.8};  ///< [-] world; normalised on use
};

/// A point of the piecewise linear transfer function from density (occupancy x remaining) to the optical properties of translucent bone.
struct TransferPoint {
  double density = 0.0;     ///< [-] 0..1, increasing from point to point
  double extinction = 0.0;  ///< [1/m] over a length d a share exp(-extinction * d) of the light passes
  Vec3 tint{1.0};           ///< [-] 0..1, factor on the tissue's own colour
};
/// Constant before the first point and after the last.
using TransferFunction = std::vector<TransferPoint>;

/// A vertical gradient in the background.
struct BackgroundView {
  Vec3 bottom{0.60, 0.65, 0.70};  ///< [-] 0..1, as stored
  Vec3 top{0.19, 0.24, 0.30};     ///< [-] 0..1, as stored
};

/// A table in the background, with the shadow of what lies on it.
struct TableView {
  Vec3 normal{0.0, 0.0, 1.0};    ///< [-] world, length 1, up
  double offset = 0.0;           ///< [m] points of the table have dot(normal, p) = offset
  Vec3 centre{0.0};              ///< [m] world, of what lies on the table
  Vec3 half_x{0.1, 0.0, 0.0};    ///< [m] world, half its extent along two axes of the table
  Vec3 half_y{0.0, 0.1, 0.0};    ///< [m] world
  double height = 0.1;           ///< [m] of its middle above the table
  Vec3 color{0.46, 0.52, 0.56};  ///< [-] 0..1
};

/// Contents of one frame.
struct FrameView {
  CameraView camera;
  LightView light;
  BackgroundView background;
  Pose world_from_bone;
  std::optional<Pose> world_from_tool;  ///< absent: the tool is not drawn
  /// Clipped half space: points with dot(normal, p_world) > offset are not drawn (bone, dura and brain; not the tool).
  struct Cut {
    Vec3 normal{0.0, -1.0, 0.0};  ///< [-] length 1
    double offset = 0.0;          ///< [m]
  };
  std::optional<Cut> cut;
  std::optional<TableView> table;  ///< absent: a gradient alone
  std::optional<CameraView>
      inset;  ///< of a small picture of all that is drawn, without the cut; displays without a place for it leave it out
};

struct Image {
  int width = 0, height = 0;  ///< [pixels]
  std::vector<Rgba8> pixels;
};

}  // namespace burrhole
