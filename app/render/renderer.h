/// app/render/renderer.h: draws volume and tool offscreen. Only app/render uses OpenGL; this header has no GL type.
///   Frame  world, except where FrameView states another.   Units  SI; images: row 0 is the top, RGBA8, alpha 255.
///   Errors unavailable, out_of_range, bad_input, as each function states.   Thread  one at a time.
///   Source [AcostaLiu07] section 4: textures, eq. 5 and 6, the light; section 5: slices. Ray casting instead of slices is our own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/render/dynamic_resolution.h"
#include "app/render/gl_context.h"
#include "app/view/view.h"
#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Slices across the volume axis nearest to the direction of view, back to front. Opacity is the density: no sharp surface, no finish, no
/// empty space skipping, and no probe.
struct SliceOptions {
  double per_voxel = 1.0;  ///< [-] (0, 8] slices per voxel along the axis
  bool correct = true;  ///< opacity refers to a mean voxel edge for any distance of slices; off: to the distance of slices, as in the paper
};

/// Options of accuracy and finish. A disabled option is not in the shader.
struct RenderOptions {
  double step_voxels = 0.5;  ///< [voxels] in (0, 1], distance of samples along a ray, in index coordinates
  int bisections = 5;        ///< 0..16, each halves the error of the hit
  bool skip_empty = true;    ///< same picture with fewer samples
  bool finish = true;        ///< smoothed normals and soft highlights; off: the light of the paper (and the headlight) only
  Appearance appearance{};   ///< additional light options; tissue, occlusion, shadow and highlights only for surfaces drawn by rays
  int supersample = 1;       ///< 1..4, rays along each side of a pixel (antialiasing)
  double resolution = 1.0;   ///< [-] in [0.25, 1], share of the picture's width and height that is drawn, then enlarged
  bool keep_picture = true;  ///< same picture; pixels that did not change are not drawn again
  /// update() assumes that bone only disappears, unless forget() was called since the last picture. Off: it searches for bone that grew,
  /// which takes several times as long as sending the texels.
  bool growth_is_reported = false;
  std::optional<SliceOptions> slices{};           ///< instead of rays
  std::optional<TransferFunction> translucent{};  ///< bone as a translucent body, front to back, instead of its surface; no finish
  /// Changed texels are sent through a ring of mapped buffers. Default: on a GPU, where a copy would wait for drawing; a software renderer
  /// copies at once.
  std::optional<bool> upload_ring{};
  GlBackend gl = GlBackend::automatic;    ///< back end of OpenGL
  std::filesystem::path shader_folder{};  ///< empty: the built-in shaders
};

/// @returns the options of a quality and appearance options for surfaces drawn by rays; a quality without finish has no occlusion.
[[nodiscard]] RenderOptions make_render_options(const DrawingQuality& quality, const Appearance& appearance);

/// Counters, not times.
struct RenderCounters {
  std::uint64_t volume_bytes = 0;  ///< texels, colours and tissue sent by the last set_volume()
  std::uint64_t update_bytes = 0;  ///< texels sent by all calls of update()
  std::uint64_t update_boxes = 0;
  std::uint64_t skip_map_bytes = 0;  ///< for empty space skipping: by set_volume(), and where bone grew
  std::uint64_t frames = 0;
  std::uint64_t drawn_pixels = 0;   ///< drawn by all calls of draw(), without pixels that were kept
  std::uint64_t probe_samples = 0;  ///< volume samples before the hit, all rays of the last probe()
};

/// A frame with measurements; one value per pixel, row 0 at the top.
struct FrameProbe {
  Image image;
  std::vector<Vec3f> hit_index;   ///< [voxels] position of the hit in index coordinates; valid where `hit` is 1
  std::vector<std::uint8_t> hit;  ///< 1 where the pixel shows the volume
  std::vector<float> view_depth;  ///< [m] along the direction of view, from the depth buffer, of bone or tool; undefined on the background
  std::vector<int> samples;       ///< taken before the hit or the end of the ray; 0 where the tool is in front
};

/// Owns its context. One thread at a time.
class Renderer {
 public:
  /// @returns ErrorCode::unavailable without OpenGL, ErrorCode::out_of_range for an option, ErrorCode::bad_input for an invalid shader.
  [[nodiscard]] static Result<Renderer> create(const RenderOptions& options);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Replaces the volume. @returns ErrorCode::bad_input, out_of_range or unavailable with the reason; the old volume is then kept.
  [[nodiscard]] Status set_volume(const VolumeView& view);
  /// Sends the texels of the box before the next frame is drawn. @pre a volume is set and contains the box.
  void update(const TexelBox& texels);
  /// Replaces the tool. @returns ErrorCode::bad_input for an invalid mesh; the old tool is then kept.
  [[nodiscard]] Status set_tool(const TriangleMesh& mesh);

  /// Bone may have grown: until the next picture update() searches for bone that grew, and that picture is drawn completely.
  void forget() noexcept;

  /// Changes the options of the following pictures; the next picture is drawn completely. @returns ErrorCode::out_of_range without any
  /// change.
  [[nodiscard]] Status set_quality(const DrawingQuality& quality);

  /// Draws one picture; without a volume, background and tool. The same view gives the same bytes. While camera, light, cut, pose of the
  /// bone and size are unchanged, only the pixels are drawn that changed texels or the tool, at its old and new position, can affect.
  /// @returns ErrorCode::out_of_range for a size, camera or light out of range.
  [[nodiscard]] Result<Image> draw(const FrameView& view, int width, int height);
  /// The same for a camera moved by hand. While the camera differs from that of the last call, the picture is drawn at the resolution of
  /// `pace` and enlarged; when it is at rest, as draw(). Pictures of a moving camera depend on measured times.
  [[nodiscard]] Result<Image> draw_at_pace(const FrameView& view, int width, int height, DynamicResolution& pace);
  /// Draws the same picture with hit positions and sample counts; slower.
  [[nodiscard]] Result<FrameProbe> probe(const FrameView& view, int width, int height);

  /// Compiles and links all_shader_variants(). @returns the first error.
  [[nodiscard]] Status link_every_variant();
  [[nodiscard]] const RenderCounters& counters() const noexcept;
  [[nodiscard]] const GlContext& context() const noexcept;
  [[nodiscard]] std::string driver() const;  ///< "BACKEND: VERSION, RENDERER", the last two as stated by the driver

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
