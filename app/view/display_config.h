/// app/view/display_config.h: display options of a scene: the contents of [display]. No OpenGL.
///   Frame  bone frame unless stated.   Units  SI.   Errors  none.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "app/view/bone_texture.h"
#include "app/view/view.h"
#include "core/base/bounds.h"
#include "core/base/units.h"

namespace burrhole {

/// Cutting plane of pictures: none, a given plane, or a plane through the tip perpendicular to the view.
enum class CutKind { none, plane, tip };
struct CutConfig {
  CutKind kind = CutKind::none;
  Vec3 point{0.0};   ///< [m] bone frame; for CutKind::plane
  Vec3 normal{0.0};  ///< [-] bone frame, towards the side that is not drawn; for CutKind::plane
};

/// A cloth over the body around the bone, with a window round the entry.
struct DrapeConfig {
  double window = 0.056;  ///< [m] width of the window; key drape_window_mm
  bool round = false;     ///< a round window, otherwise a square one with its sides along the approach frame's x and y; key drape
  /// @returns the distance [m] of a point of the bone frame from the body's surface, positive outside. Set where the bone is known.
  std::function<double(const Vec3&)> body;
};

/// The skin of a whole head as a translucent shell, with an opening round the entry.
struct SkinConfig {
  double opacity = 0.55;             ///< [-] share of the light that it takes square on; key skin_opacity
  double window = 0.042;             ///< [m] width of the opening without a drape; key skin_window_mm
  double shown = 0.005;              ///< [m] of skin between the opening and the window of a drape, if there is one
  std::optional<double> reach;       ///< [m] beyond the opening to which the skin is drawn, under a drape; absent: all of it
  bool round = true;                 ///< the shape of the opening; that of a drape, if there is one
  double below = 0.006;              ///< [m] assumed thickness under the head, by which a table lies lower
  Vec3 color{0.86, 0.59, 0.49};      ///< [-] 0..1
  double pitch = 2.0 * kMillimetre;  ///< [m] of the lattice on which the body is evaluated
  /// @returns about the distance [m] of a point of the bone frame from the body's surface, positive outside; NaN where the body is not known.
  /// Set where the bone is known.
  std::function<double(const Vec3&)> body;
  Bounds box;  ///< [m] bone frame, that contains the surface
};

/// [display]
struct DisplayConfig {
  std::string method = "raycast";  ///< "raycast", "slices" or "mesh"
  double slices_per_voxel = 1.0;   ///< [1/voxel]
  bool opacity_correction = true;
  TransferFunction transfer;                 ///< empty: bone is drawn as a surface; key shading = "translucent"
  DrawingQuality quality{.supersample = 2};  ///< four rays per pixel: anti-aliased edges
  std::optional<double> budget;  ///< [s] time of one picture, used to select `quality` (quality = "auto"); absent: `quality` is used
  Appearance appearance{.tissue = true, .occlusion = true};
  TextureConfig textures;  ///< of method = "mesh"
  /// [voxels] largest texture of a whole bone. A larger bone is drawn at coarser voxels, and by rays to a surface also a part around the
  /// entry at its own voxels. Key whole_voxels.
  std::size_t whole_voxels = 32'000'000;
  double detail = 0.048;  ///< [m] edge of that part; key detail_mm
  BackgroundView background;
  int width = 1200, height = 900;                     ///< [pixels]
  std::size_t upload_budget = std::size_t{64} << 20;  ///< [byte] most texel data sent for one picture; key upload_budget_kb
  double upload_time = 0.0;                           ///< [s] limit for making these texels; 0: no limit; key upload_budget_ms
  double azimuth = 35.0 * kDegree;                    ///< [rad] of the camera about +z of the approach frame, from -y towards +x
  double elevation = 42.0 * kDegree;                  ///< [rad] of the camera above the xy plane of the approach frame
  double distance = 0.074;                            ///< [m] of the camera from its target, 0.8 of the thickness below the entry
  bool scale_bar = true;
  bool orientation = false;    ///< directions of the patient; key orientation_mark, true for a bone with patient axes
  bool inset = true;           ///< a small picture of a whole head beside the pictures of a site; key inset
  bool assumed_brain = false;  ///< dura and brain under the bone of a scan (assumed_brain.h); key assumed_brain, true for a scan
  /// [m] distance of the camera in the picture `overview`, the first of a run, which shows all that is drawn; key overview_mm. Absent: there is
  /// no such picture.
  std::optional<double> overview;
  bool only_overviews = false;       ///< every picture is taken from there; render --overview
  bool table = false;                ///< what is drawn lies on a table, a plane across the approach axis
  std::optional<DrapeConfig> drape;  ///< absent: no cloth
  std::optional<SkinConfig> skin;    ///< absent: no skin
  CutConfig cut;
  StereoView stereo;
};

/// @returns whether a large bone has a detail: rays to a surface. Slices and translucent bone show coarse voxels alone.
[[nodiscard]] inline bool draws_detail(const DisplayConfig& display) noexcept {
  return display.method == "raycast" && display.transfer.empty();
}

/// @returns whether skin may be drawn over the bone, which is an opaque surface.
[[nodiscard]] inline bool draws_surface(const DisplayConfig& display) noexcept {
  return display.method != "slices" && display.transfer.empty();
}

/// @returns whether the drawn bone has textures.
[[nodiscard]] inline bool draws_textures(const DisplayConfig& display) noexcept {
  return display.method == "mesh" && display.textures.any();
}

}  // namespace burrhole
