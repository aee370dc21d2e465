/// app/render/renderer_impl.h: state of a Renderer, and the steps of one picture. Internal to app/render.
///   renderer.cpp checks the request and fills the frame's block; renderer_passes.cpp finds the programs and issues the draw calls.
///   Errors  those of Renderer; unavailable if OpenGL fails.
#pragma once

#include <filesystem>
#include <optional>

#include "app/render/added_mesh_buffer.h"
#include "app/render/bone_buffer.h"
#include "app/render/bone_paint.h"
#include "app/render/frame_block.h"
#include "app/render/frame_cache.h"
#include "app/render/gl_context.h"
#include "app/render/gl_target.h"
#include "app/render/read_buffer.h"
#include "app/render/renderer.h"
#include "app/render/shader_program.h"
#include "app/render/skin_mesh.h"
#include "app/render/tool_depth.h"
#include "app/render/tool_mesh.h"
#include "app/render/transfer_texture.h"
#include "app/render/volume_texture.h"

namespace burrhole {

struct Renderer::Impl {
  RenderOptions options;
  bool asked_occlusion;  ///< at creation; a quality without finish leaves it out
  GlContext context;
  const GladGLContext& gl;
  ProgramCache programs;
  RenderCounters counters;
  GlObject no_vertices, frame_buffer, detail_buffer, count_query;
  GlTarget target;  ///< the picture; with layers that of the bone
  GlTarget shown;   ///< with layers and a tool the picture
  GlTarget probe_target;
  /// The last larger one of each that a smaller one replaced: a view that moves and rests alternates, and a software renderer clears new
  /// memory page by page.
  GlTarget spare_target, spare_shown;
  DepthRange range;  ///< of the last picture
  GlObject transfer;
  bool tinted = false;                    ///< the transfer function has a tint
  std::optional<std::uint8_t> seen_from;  ///< as VolumeTexture::create takes it
  std::optional<VolumeTexture> volume;
  std::optional<VolumeTexture> detail;  ///< a part of it at finer voxels
  DetailGrid grid;                      ///< of the detail
  /// The bone as triangles, in place of the volume; all absent unless RenderOptions::mesh.
  std::optional<BoneMesh> mesh;
  std::optional<BoneBuffer> mesh_buffer;
  std::optional<BonePaint> paint;          ///< its textures; absent: none
  std::optional<GlObject> section_colors;  ///< a texture of its voxels' colours, made when a cut is first drawn
  std::optional<UploadRing> ring;
  std::optional<ReadBuffer> read_buffer;
  std::optional<ToolMesh> tool;
  std::optional<ToolDepth> tool_depth;  ///< made when the tool's shadow is first drawn
  std::optional<SkinMesh> skin;         ///< drawn where has_layers()
  std::optional<AddedMeshBuffer> added;
  std::uint64_t added_versions = 0;
  FrameCache cache;
  std::vector<Image> read_parts;          ///< drawn parts of the last picture, whose memory the next ones take
  bool may_grow = false;                  ///< forget() came since the last picture
  std::optional<CameraView> last_camera;  ///< of draw_at_pace

  Impl(const RenderOptions& chosen, GlContext made, ShaderFiles files)
      : options(chosen),
        asked_occlusion(chosen.appearance.occlusion),
        context(std::move(made)),
        gl(context.functions()),
        programs(gl, std::move(files)),
        cache(chosen.supersample) {
    no_vertices = make_vertex_array(gl);
    frame_buffer = make_buffer(gl);
    gl.NamedBufferStorage(frame_buffer.name(), sizeof(FrameBlock), nullptr, GL_DYNAMIC_STORAGE_BIT);
    detail_buffer = make_buffer(gl);
    gl.NamedBufferStorage(detail_buffer.name(), sizeof(FrameBlock), nullptr, GL_DYNAMIC_STORAGE_BIT);
    count_query = make_count_query(gl);
    if (options.mapped_buffers.value_or(!context.is_software())) {
      if (!options.mesh) ring.emplace(gl);
      read_buffer.emplace(gl);
    }
    if (options.skip_empty && !options.slices && !options.mesh) seen_from = kSolidOpacity;
    if (!options.translucent) return;
    const TransferTable table = make_transfer_table(*options.translucent);
    transfer = make_transfer_texture(gl, table);
    tinted = has_tint(table);
    if (options.skip_empty) seen_from = burrhole::seen_from(table);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { static_cast<void>(context.make_current()); }  // the members delete their names in it

  struct Programs {
    GLuint background = 0, volume = 0, light = 0, tool = 0;  ///< light: on the surface that rays hit
    GLuint detail = 0, detail_light = 0;                     ///< those of the detail, if there is one
    GLuint stale_occlusion = 0, detail_stale_occlusion = 0;  ///< mark the hits to be relit, if any
    GLuint added = 0;                                        ///< of what effects add, if there is anything
    GLuint skin = 0, rim = 0;                                ///< of the skin, if there is one
    GLuint tool_depth = 0, tool_shadow = 0;                  ///< of the tool's shadow, if it is drawn: seen from the light, and marks
    GLuint shaded = 0, detail_shaded = 0;                    ///< light on the hits in the tool's shadow
    PixelRect detail_rect{};                                 ///< pixels whose rays may meet the detail
  };
  bool has_table = false;  ///< the view that is drawn has a table that is seen
  bool has_fog = false;    ///< the view that is drawn has fog
  [[nodiscard]] bool has_soft() const noexcept { return volume && (volume->has_soft() || (detail && detail->has_soft())); }
  [[nodiscard]] bool has_tissue() const noexcept { return volume && volume->has_tissue(); }
  [[nodiscard]] ShaderVariant volume_variant(bool cut, bool probe, bool soft, VolumeLevel level) const;
  /// @returns the level that draws all of the volume, or all but the detail.
  [[nodiscard]] VolumeLevel outer_level() const noexcept { return detail ? VolumeLevel::whole : VolumeLevel::only; }
  [[nodiscard]] bool has_surface() const noexcept { return !options.slices && !options.translucent; }
  [[nodiscard]] bool has_bone() const noexcept { return volume || mesh; }
  /// @returns world_from_index of the bone. @pre has_bone().
  [[nodiscard]] Affine place_bone(const FrameView& view) const {
    return Affine::from_pose(view.world_from_bone) * (mesh ? mesh->bone_from_index() : volume->bone_from_index());
  }
  [[nodiscard]] const Vec3i& bone_dims() const noexcept { return mesh ? mesh->dims() : volume->dims(); }
  /// @returns whether ambient occlusion reaches further than what else is drawn, so that some hits are only lit again.
  [[nodiscard]] bool relights() const noexcept { return reach_of(options, 0.0).occlusion > 0.0; }
  /// @returns whether the bone is drawn into a picture of its own, so that a moving tool costs no rays. Slices and translucent bone are
  /// blended with the tool.
  [[nodiscard]] bool has_layers() const noexcept { return has_bone() && has_surface(); }
  [[nodiscard]] bool has_tool_shadow() const noexcept { return !mesh && has_layers() && tool && options.appearance.shadow; }
  [[nodiscard]] ShaderVariant light_variant(bool cut, bool tissue, bool soft, VolumeLevel level, bool tool_shadow = false) const;
  [[nodiscard]] ShaderVariant stale_variant(bool cut, VolumeLevel level) const;
  [[nodiscard]] ShaderVariant bone_mesh_variant(bool cut, bool probe) const;
  [[nodiscard]] std::string shader_names(bool cut) const;
  [[nodiscard]] Status set_mesh(const VolumeView& view);
  /// Sends what of the mesh has changed, and before the first cut the colours of its section. Nothing without a mesh.
  [[nodiscard]] Status send_mesh(bool cut);
  void draw_mesh(const PixelRect& part, const FrameBlock& block, GLuint background, GLuint program);
  [[nodiscard]] Status link_asked(const std::filesystem::path& folder);
  void scissor(const PixelRect& part) const;
  void draw_screen(GLuint program) const;
  void draw_tool(GLuint program) const;
  void draw_added(const PixelRect& part, const Programs& used) const;
  void draw_skin(const Programs& used) const;
  void draw_tool_shadow(const PixelRect& part, const Programs& used) const;
  void draw_slices(GLuint program, int count) const;
  void draw_translucent(GLuint program, const PixelRect& part) const;
  void draw_light(GLuint program) const;
  template <class F>
  void with_detail(const PixelRect& part, const Programs& used, const F& f) const;
  void draw_levels(const PixelRect& part, const Programs& used) const;
  void light_levels(const PixelRect& part, GLuint outer, GLuint inner, const Programs& used) const;
  /// @returns the number of drawn pixels whose light was drawn again.
  std::uint64_t relight(std::span<const PixelRect> parts, const Programs& used) const;
  /// @param width, height [pixels] drawn. @param rays_a_side of a pixel of the picture.
  Result<FrameBlock> make_block(const FrameView& view, int width, int height, int rays_a_side);
  void note_view(const FrameView& view) noexcept;
  Result<Programs> find_mesh_programs(bool cut, ToolPass pass);
  Status find_skin_programs(bool cut, Programs& out);
  Status find_shadow_programs(bool cut, Programs& out);
  Status make_tool_depth();
  [[nodiscard]] FrameBlock make_detail_block(const FrameBlock& whole, const FrameView& view) const;
  Result<Programs> find_programs(bool cut, ToolPass pass, bool with_stale);
  Result<Programs> find_bone_programs(bool cut, ToolPass pass, bool with_stale);
  [[nodiscard]] TargetKind bone_kind() const noexcept;
  /// Makes `into` a target of that size and kind. @param spare keeps the last larger one, and gives it back; null: none is kept.
  Status prepare(GlTarget& into, GlTarget* spare, int width, int height, TargetKind kind);
  [[nodiscard]] std::optional<DrawnTool> place_tool(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const;
  [[nodiscard]] DrawnAdded place_added(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const;
  /// @param over_copy tool and added triangles are drawn later, over a copy.
  void draw_part(const PixelRect& part, const FrameBlock& block, const Programs& used, bool with_tool, bool over_copy);
  /// @param drawn_tool where it meets the part; absent: not at all.
  void draw_layer(const PixelRect& part, const Programs& used, const std::optional<DrawnTool>& drawn_tool) const;
  /// @returns the number of drawn pixels that were only lit again.
  Result<std::uint64_t> render(const StalePixels& stale, const FrameView& view, const FrameBlock& block,
                               const std::optional<DrawnTool>& drawn_tool, ToolPass pass);
  /// @param seconds [s] after which no further band is begun; absent: the picture is drawn as a whole.
  Result<PictureStep> draw(const FrameView& view, int width, int height, std::optional<double> seconds);
  /// As Renderer::draw_step(), at RenderOptions::resolution.
  Result<PictureStep> draw_sized(const FrameView& view, int width, int height, std::optional<double> seconds);
  Status draw_probe(const FrameView& view, int width, int height);
};

}  // namespace burrhole
