/// app/render/renderer.h: draws the volume and the tool offscreen. The only folder that knows OpenGL; no GL type shows here.
///   Frame  world, but for what FrameView says.   Units  SI; images: row 0 is the top, RGBA8, alpha 255.
///   Source [AcostaLiu07] section 4: textures, eq. 5 and 6, the light; section 5: slices. Ray casting in their place is our own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/view.h"
#include "app/render/gl_context.h"
#include "app/render/pace.h"
#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Slices across the axis of the volume nearest to the direction of view, back to front. Opacity is the density: no sharp surface, no
/// finish, no skipping, and a probe has nothing to tell.
struct SliceOptions {
  double per_voxel = 1.0;  ///< (0, 8] slices for each voxel along the axis
  bool correct =
      true;  ///< opacity holds over a mean voxel edge, whatever the distance between slices; off: over that distance, as the paper's
};

/// What a picture costs and how it is finished; choices that are off are not in the shader.
struct RenderOptions {
  double step_voxels = 0.5;  ///< (0, 1] distance of samples along a ray, in index coordinates
  int bisections = 5;        ///< 0..16, each halves the error of the hit
  bool skip_empty = true;    ///< same picture, fewer samples
  bool finish = true;        ///< smoothed normals and soft highlights; off: the light of the paper (and the headlight) alone
  LookView looks{};          ///< beyond that light; tissue, occlusion, shadow and glint for surfaces by rays alone
  int supersample = 1;       ///< 1..4, picture edges are smoothed by that many rays along each side of a pixel
  double resolution = 1.0;   ///< [0.25, 1] of the picture's width and height are drawn, then enlarged
  bool keep_picture = true;  ///< same picture; what did not change since the last one is not drawn again
  /// update() takes it that bone only disappears, unless forget() came since the last picture; off: it looks for what grew, which takes
  /// several times as long as sending it.
  bool growth_is_told = false;
  std::optional<SliceOptions> slices{};           ///< in place of rays
  std::optional<TransferFunction> translucent{};  ///< bone as a translucent body, front to back, in place of its surface; no finish
  /// Changed texels go to the card through a ring of mapped buffers. Nothing said: on a GPU, where a copy would wait for drawing; a software
  /// renderer copies at once.
  std::optional<bool> upload_ring{};
  GlBackend gl = GlBackend::automatic;    ///< where OpenGL comes from
  std::filesystem::path shader_folder{};  ///< empty: the shaders as built in
};

/// What a quality and looks ask for, by rays to the surface; a quality without finish leaves occlusion out.
[[nodiscard]] RenderOptions make_render_options(const DrawingQuality& quality, const LookView& looks);

/// Counted, never timed.
struct RenderCounters {
  std::uint64_t volume_bytes = 0;  ///< texels, colours and tissue sent by set_volume, last call
  std::uint64_t update_bytes = 0;  ///< texels sent by update, all calls
  std::uint64_t update_boxes = 0;
  std::uint64_t skip_map_bytes = 0;  ///< for empty space skipping: at set_volume, and where bone grew
  std::uint64_t frames = 0;
  std::uint64_t drawn_pixels = 0;   ///< of pictures that draw() gave, those that were drawn anew, all calls
  std::uint64_t probe_samples = 0;  ///< volume samples before the hit, all rays of the last probe()
};

/// A frame with its measurements; one value a pixel, row 0 at the top.
struct FrameProbe {
  Image image;
  std::vector<Vec3f> hit_index;   ///< where the ray met the volume, index coordinates; meaningful where hit is 1
  std::vector<std::uint8_t> hit;  ///< 1 where the volume is what the pixel shows
  std::vector<float> view_depth;  ///< [m] along the view's direction, from the depth buffer: of bone or tool; meaningless on the background
  std::vector<int> samples;       ///< taken before the hit or the end of the ray; 0 where the tool is in front
};

/// Owns its context. One thread at a time.
class Renderer {
 public:
  /// @returns ErrorCode::unavailable without OpenGL, ErrorCode::out_of_range for an option, ErrorCode::bad_input for a faulty shader.
  [[nodiscard]] static Result<Renderer> create(const RenderOptions& options);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Replaces the volume. @returns ErrorCode::bad_input, out_of_range or unavailable with the reason; the old volume stays then.
  [[nodiscard]] Status set_volume(const VolumeView& view);
  /// Sends exactly the texels of the box, before the next frame is drawn. A volume is set and holds the box.
  void update(const TexelBox& texels);
  /// Replaces the tool. @returns ErrorCode::bad_input for a faulty mesh; the old one stays then.
  [[nodiscard]] Status set_tool(const TriangleMesh& mesh);

  /// Bone may have grown back: until the next picture update() looks for what grew, and that picture is drawn whole.
  void forget() noexcept;

  /// From the next picture on, which is drawn whole; the volume and all other options stay. @returns ErrorCode::out_of_range, and nothing
  /// changes then.
  [[nodiscard]] Status set_quality(const DrawingQuality& quality);

  /// One picture of what is set; without a volume the background and the tool. Same view, same bytes. While camera, light, cut, bone's pose
  /// and size stay as they were, only pixels are drawn that changed texels or the tool, at its old and new place, may reach.
  /// @returns ErrorCode::out_of_range for a size, camera or light out of range.
  [[nodiscard]] Result<Image> draw(const FrameView& view, int width, int height);
  /// The same for a camera that is moved by hand: while it differs from the last call's, as finely as `pace` expects to fit, enlarged; once
  /// it rests, as draw(). Pictures of a moving camera depend on the clock.
  [[nodiscard]] Result<Image> draw_at_pace(const FrameView& view, int width, int height, Pace& pace);
  /// The same picture with hit positions and sample counts; slower.
  [[nodiscard]] Result<FrameProbe> probe(const FrameView& view, int width, int height);

  /// Compiles and links all of all_shader_variants(). @returns the first fault.
  [[nodiscard]] Status link_every_variant();
  [[nodiscard]] const RenderCounters& counters() const noexcept;
  [[nodiscard]] const GlContext& context() const noexcept;
  [[nodiscard]] std::string driver() const;  ///< "BACKEND: VERSION, RENDERER", the last two as the driver states them

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
