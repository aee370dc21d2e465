/// app/render/renderer.h: draws volume and tool offscreen. Only app/render uses OpenGL; this header has no GL type.
///   Frame  world, except where FrameView states another.   Units  SI; images: row 0 is the top, RGBA8, alpha 255.
///   Errors unavailable, out_of_range, bad_input, as each function states; internal if OpenGL reports an error.   Thread  one at a time.
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
#include "app/view/bone_texture.h"
#include "app/view/tip_slices.h"
#include "app/view/view.h"
#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

struct AddedMesh;

/// Slices across the volume axis nearest to the direction of view, back to front. Opacity is the density: no sharp surface, no finish, no
/// empty space skipping, and no probe.
struct SliceOptions {
  double per_voxel = 1.0;  ///< [-] (0, 8] slices per voxel along the axis
  /// true: a density is the opacity of a path of one mean voxel edge, so the picture hardly depends on the distance between slices.
  /// false: a density is the opacity of one slice, at any distance between slices, as in [AcostaLiu07].
  bool correct = true;
};

/// Options of accuracy and finish. A disabled option is not in the shader. At most one of `slices`, `translucent` and `mesh` may be set; without
/// them, rays draw the 0.5 surface.
struct RenderOptions {
  double step_voxels = 0.5;  ///< [voxels] in (0, 1], distance of samples along a ray, in index coordinates; not for slices
  int bisections = 5;        ///< 0..16, each halves the error of the hit; surfaces only
  bool skip_empty = true;    ///< true: rays skip empty space; the picture is the same, with fewer samples
  bool finish = true;        ///< surfaces only; true: smoothed normals and soft highlights; false: the light of [AcostaLiu07] and headlight
  Appearance appearance{};   ///< additional light options; tissue, occlusion, shadow and highlights for surfaces only
  int supersample = 1;       ///< 1..4, rays along each side of a pixel (antialiasing)
  double resolution = 1.0;   ///< [-] in [0.25, 1], share of the picture's width and height that is drawn, then enlarged
  bool keep_picture = true;  ///< true: only pixels that may have changed are drawn; false: all pixels; the picture is the same
  /// true: the caller reports growth of bone by forget(). Without forget() since the last picture, update() assumes that bone only
  /// disappears. false: each update() searches for bone that grew, which takes several times as long as sending the texels.
  bool growth_is_reported = false;
  std::optional<SliceOptions> slices{};           ///< if set: slices instead of rays
  std::optional<TransferFunction> translucent{};  ///< if set: bone as a translucent body, front to back, instead of its surface; no finish
  /// The 0.5 surface is drawn as triangles (app/view/bone_mesh.h), made from the texels and updated by those of update(). No texture of the
  /// volume is made, except one of its colours when a cut is first drawn. `specular`, `labels` and `finish` apply, other options of Appearance do not.
  bool mesh = false;
  /// Of a mesh: images in place of the voxels' colours, where bone was not cut and where it was. Null: no texture, no upload and no branch of it.
  std::shared_ptr<const BoneTextures> textures{};
  /// Whether changed texels are sent and pictures are read through mapped buffers (upload_ring.h, read_buffer.h). Absent: true on a GPU,
  /// where a copy would wait until drawing ends; false with a software renderer, which copies at once. The picture is the same.
  std::optional<bool> mapped_buffers{};
  GlBackend gl = GlBackend::automatic;    ///< back end of OpenGL
  std::filesystem::path shader_folder{};  ///< folder of shaders that create() reads and checks; empty: the built-in shaders
};

/// @returns the options of a quality and appearance options for surfaces drawn by rays; a quality without finish has no occlusion.
[[nodiscard]] RenderOptions make_render_options(const DrawingQuality& quality, const Appearance& appearance);

/// Counters, not times.
struct RenderCounters {
  std::uint64_t volume_bytes = 0;       ///< texels, colours and tissue sent by the last set_volume()
  std::uint64_t update_bytes = 0;       ///< texels sent by all calls of update()
  std::uint64_t update_boxes = 0;       ///< number of calls of update()
  std::uint64_t mesh_bytes = 0;         ///< vertices sent before the first picture, and again when their buffer grew
  std::uint64_t mesh_update_bytes = 0;  ///< vertices of changed triangles sent before later pictures
  std::uint64_t texture_bytes = 0;      ///< texels of RenderOptions::textures sent by the last set_volume(), without their coarser levels
  std::uint64_t skip_map_bytes = 0;     ///< sent for empty space skipping by all calls: by set_volume(), and by update() where bone grew
  std::uint64_t frames = 0;             ///< pictures drawn, those of probe() included
  /// By draw() and draw_at_pace(), at the drawn resolution, without pixels that were kept; pixels that were only lit again count.
  std::uint64_t drawn_pixels = 0;
  std::uint64_t tool_pixels = 0;    ///< beside them, those where only the tool, its shadow and what effects add were drawn, over a copy of the bone
  std::uint64_t probe_samples = 0;  ///< sum of FrameProbe::samples of the last probe()
};

/// A picture that is drawn in steps.
struct PictureStep {
  Image image;        ///< where it is not drawn yet, that of the last step shows the last picture, resampled if its size differs
  bool whole = true;  ///< false: pixels are missing
};

/// A frame with measurements; one value per pixel, row 0 at the top.
struct FrameProbe {
  Image image;
  std::vector<Vec3f> hit_index;   ///< [voxels] position of the hit in index coordinates; valid where `hit` is 1
  std::vector<std::uint8_t> hit;  ///< 1 where the pixel shows the surface of bone or soft tissue, or a cut; always 0 for translucent bone
  std::vector<float>
      view_depth;  ///< [m] of tool or surface along the direction of view; undefined where there is neither, and on a section of a mesh
  /// Densities that the ray sampled at its steps, up to and including the hit, or to the end of the ray. Bisections and look-ups of the
  /// skip map are not counted. Surfaces: a ray that crosses the volume without a hit counts one too many; 0 where the tool is in front.
  std::vector<int> samples;
};

/// Owns its context. One thread at a time.
class Renderer {
 public:
  /// @returns ErrorCode::unavailable without OpenGL, ErrorCode::out_of_range for an option outside its range or for slices together with a
  /// transfer function, ErrorCode::bad_input for an invalid shader.
  [[nodiscard]] static Result<Renderer> create(const RenderOptions& options);
  /// Draws in a context that exists, in place of that of RenderOptions::gl. Its thread is that of the renderer.
  [[nodiscard]] static Result<Renderer> create(const RenderOptions& options, GlContext context);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Replaces the volume and its skin. @returns ErrorCode::bad_input, out_of_range or unavailable with the reason; the old volume is then kept.
  [[nodiscard]] Status set_volume(const VolumeView& view);
  /// Replaces the detail of the volume. Without one, as with slices and translucent bone, nothing happens. @returns the errors of
  /// set_volume(); the old detail is then kept.
  [[nodiscard]] Status set_detail(const DetailView& view);
  /// Sends the texels of the box before the next frame is drawn. @pre a volume is set and contains the box.
  void update(const TexelBox& texels);
  /// Replaces the tool. @returns ErrorCode::bad_input for an invalid mesh; the old tool is then kept.
  [[nodiscard]] Status set_tool(const TriangleMesh& mesh);

  /// Replaces what effects add to the following pictures; null: nothing. @returns ErrorCode::bad_input as AddedMeshBuffer::create; the old one is
  /// then kept.
  [[nodiscard]] Status set_added(const std::shared_ptr<const AddedMesh>& mesh);

  /// Reports that bone may have grown. Call it before the update() of that bone. Until the next draw(), update() searches for bone that
  /// grew, and that draw() draws all pixels.
  void forget() noexcept;

  /// Changes the options of the following pictures; all pixels of the next picture are drawn. Ambient occlusion is on if the options of
  /// create() and the finish of `quality` enable it. @returns ErrorCode::out_of_range without any change.
  [[nodiscard]] Status set_quality(const DrawingQuality& quality);
  /// Changes shadows and highlights of the following pictures; all pixels of the next picture are drawn if they differ. No effect on slices
  /// and translucent bone, which have neither.
  void set_lights(const SurfaceLights& lights) noexcept;

  /// Draws one picture. If no volume is set, it shows background and tool only. The same view, volume and tool give the same bytes. If only
  /// texels or the pose of the tool have changed since the last picture, or what effects add, it draws the pixels that they can affect (the tool at its old and
  /// new position) and keeps the others; after any other change, and without keep_picture, it draws all pixels.
  /// @returns ErrorCode::out_of_range for a size, camera, light, background or cut outside its range; unavailable if the driver cannot draw
  /// the size.
  [[nodiscard]] Result<Image> draw(const FrameView& view, int width, int height);
  /// As draw(), for a camera moved by hand. In the first call, and if the camera differs from that of the last call, the picture is drawn
  /// at RenderOptions::resolution x pace.resolution() and enlarged, and its wall time is recorded in `pace`; such pictures depend on
  /// measured times. If the camera is that of the last call, the picture is that of draw().
  [[nodiscard]] Result<Image> draw_at_pace(const FrameView& view, int width, int height, DynamicResolution& pace);
  /// As draw(), in steps: ends when `seconds` [s] have passed and at least one band of rows has been drawn, those round the tool first. Call
  /// it again until the picture is whole; then it is that of draw(). View, tool and bone may change between the steps.
  [[nodiscard]] Result<PictureStep> draw_step(const FrameView& view, int width, int height, double seconds);
  /// Draws a picture without skin and without the shadow of the tool, with hit positions and sample counts, by one ray per pixel at full resolution: `supersample` and `resolution` are
  /// ignored. All pixels are drawn, and the values per pixel are read back, so it is slower than draw(). @returns ErrorCode::bad_input
  /// without a volume or with slices; the errors of draw().
  [[nodiscard]] Result<FrameProbe> probe(const FrameView& view, int width, int height);

  /// Reads bone around a point back, as it would be drawn (VolumeTexture::read_mineral), for slices: of the detail, if there is one, and then
  /// of the whole volume. @param half_width [m] of a cube around it. Nothing without a volume; the errors of the context.
  [[nodiscard]] Result<std::vector<MineralBox>> read_mineral(const Vec3& p_bone, double half_width) const;

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
