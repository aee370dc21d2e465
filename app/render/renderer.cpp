#include "app/render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "app/render/enlarge.h"
#include "app/render/frame_block.h"
#include "app/render/frame_cache.h"
#include "app/render/gl_context.h"
#include "app/render/gl_target.h"
#include "app/render/shader_program.h"
#include "app/render/tool_mesh.h"
#include "app/render/transfer_texture.h"
#include "app/render/volume_texture.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr int kMaxSide = 16384;  ///< [pixels] beyond any driver's limit, which GlTarget asks for; keeps products in range

Error out_of_range(std::string why) { return {ErrorCode::out_of_range, std::move(why), {}}; }

Status check_options(const RenderOptions& options) {
  if (!(options.step_voxels > 0.0 && options.step_voxels <= 1.0)) return out_of_range("the ray step must be in (0, 1] voxels");
  if (options.bisections < 0 || options.bisections > 16) return out_of_range("bisections must be in 0..16");
  if (options.supersample < 1 || options.supersample > 4) return out_of_range("supersampling must be in 1..4");
  if (!(options.resolution >= 0.25 && options.resolution <= 1.0)) return out_of_range("the resolution must be in [0.25, 1]");
  if (options.slices && !(options.slices->per_voxel > 0.0 && options.slices->per_voxel <= 8.0))
    return out_of_range("slices must be in (0, 8] a voxel");
  if (options.slices && options.translucent) return out_of_range("a transfer function is for rays: slices have their own opacity");
  if (options.translucent) return check_transfer(*options.translucent);
  return {};
}

/// What can be checked before any drawing; the camera checks itself.
Status check_view(const FrameView& view) {
  const LightView& light = view.light;
  if (!is_finite(light.direction_to_light) || glm::length(light.direction_to_light) == 0.0)
    return out_of_range("the light has no direction");
  for (const double term : {light.ambient, light.diffuse, light.fill})
    if (!(term >= 0.0 && term <= 100.0)) return out_of_range("the terms of the light must be in 0..100");
  for (const Vec3& color : {view.background.bottom, view.background.top})
    for (const double channel : {color.x, color.y, color.z})
      if (!(channel >= 0.0 && channel <= 1.0)) return out_of_range("colours of the background must be in 0..1");
  if (view.cut && (!is_finite(view.cut->normal) || glm::length(view.cut->normal) == 0.0)) return out_of_range("the cut has no direction");
  return {};
}

/// Means of blocks of n x n pixels, rounded to nearest.
Image shrink(const Image& large, int n) {
  if (n == 1) return large;
  Image image{large.width / n, large.height / n, {}};
  image.pixels.reserve(large.pixels.size() / static_cast<std::size_t>(n * n));
  const auto mean = [n](int sum) { return static_cast<std::uint8_t>((sum + n * n / 2) / (n * n)); };
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      glm::ivec3 sum(0);
      for (int part = 0; part < n * n; ++part) {
        const int y = row * n + part / n, x = column * n + part % n;
        const Rgba8& p = large.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(large.width) + static_cast<std::size_t>(x)];
        sum += glm::ivec3(p.r, p.g, p.b);
      }
      image.pixels.push_back({mean(sum.x), mean(sum.y), mean(sum.z), 255});
    }
  return image;
}

/// Corners of the box of all voxel cells, which is what rays are clipped to, in world coordinates.
void append_corners(const VolumeTexture& volume, const Affine& world_from_index, std::vector<Vec3>& points) {
  const Vec3 dims(volume.dims());
  for (unsigned c = 0; c < 8; ++c) {
    const Vec3 corner((c & 1u) != 0 ? dims.x : 0.0, (c & 2u) != 0 ? dims.y : 0.0, (c & 4u) != 0 ? dims.z : 0.0);
    points.push_back(world_from_index * (corner - 0.5));
  }
}

}  // namespace

struct Renderer::Impl {
  RenderOptions options;
  bool asked_occlusion;  ///< at creation; a quality without finish leaves it out
  GlContext context;
  const GladGLContext& gl;
  ProgramCache programs;
  RenderCounters counters;
  GlObject no_vertices, frame_buffer;
  GlTarget target;
  DepthRange range;  ///< of the last picture
  GlObject transfer, opaque_depth;
  bool tinted = false;                    ///< the transfer function has a tint
  std::optional<std::uint8_t> seen_from;  ///< as VolumeTexture::create takes it
  std::optional<VolumeTexture> volume;
  std::optional<UploadRing> ring;
  std::optional<ToolMesh> tool;
  FrameCache cache;
  bool may_grow = false;                  ///< forget() came since the last picture
  std::optional<CameraView> last_camera;  ///< of draw_at_pace

  Impl(const RenderOptions& chosen, GlContext made, ShaderFiles files)
      : options(chosen),
        asked_occlusion(chosen.looks.occlusion),
        context(std::move(made)),
        gl(context.functions()),
        programs(gl, std::move(files)),
        cache(chosen.supersample) {
    no_vertices = make_vertex_array(gl);
    frame_buffer = make_buffer(gl);
    gl.NamedBufferStorage(frame_buffer.name(), sizeof(FrameBlock), nullptr, GL_DYNAMIC_STORAGE_BIT);
    if (options.upload_ring.value_or(!context.is_software())) ring.emplace(gl);
    if (options.skip_empty && !options.slices) seen_from = kSolidOpacity;
    if (!options.translucent) return;
    const TransferTable table = make_transfer_table(*options.translucent);
    transfer = make_transfer_texture(gl, table);
    tinted = has_tint(table);
    if (options.skip_empty) seen_from = burrhole::seen_from(table);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { static_cast<void>(context.make_current()); }  // the members delete their names in it

  [[nodiscard]] bool has_soft() const noexcept { return volume && volume->has_soft(); }
  [[nodiscard]] bool has_tissue() const noexcept { return volume && volume->has_tissue(); }
  [[nodiscard]] ShaderVariant volume_variant(bool cut, bool probe, bool soft) const;
  [[nodiscard]] bool has_surface() const noexcept { return !options.slices && !options.translucent; }
  [[nodiscard]] ShaderVariant light_variant(bool cut, bool tissue, bool soft) const;
  [[nodiscard]] Status link_asked(const std::filesystem::path& folder);
  void draw_screen(GLuint program) const;
  void draw_tool(GLuint program) const;
  void draw_slices(GLuint program, int count) const;
  void draw_translucent(GLuint program, const PixelRect& part) const;
  void draw_light(GLuint program) const;
  Result<FrameBlock> make_block(const FrameView& view, int width, int height);
  struct Programs {
    GLuint background, volume, light, tool;  ///< light: on the surface that rays hit
  };
  Result<Programs> find_programs(bool cut, bool probe);
  Status prepare_target(int width, int height, bool probe);
  [[nodiscard]] std::optional<DrawnTool> place_tool(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const;
  void draw_part(const PixelRect& part, const FrameBlock& block, const Programs& used, bool with_tool) const;
  Status render(const PixelRegion& region, const FrameView& view, const FrameBlock& block, const std::optional<DrawnTool>& drawn_tool,
                bool probe);
  Result<Image> draw(const FrameView& view, int width, int height);
  Status draw_probe(const FrameView& view, int width, int height);
};

Result<FrameBlock> Renderer::Impl::make_block(const FrameView& view, int width, int height) {
  const Status valid = check_view(view);
  if (!valid) return valid.error();
  const auto rays = make_camera_rays(view.camera, static_cast<double>(width) / static_cast<double>(height));
  if (!rays) return rays.error();
  FrameBlock block;
  std::vector<Vec3> points;
  fill_camera(block, rays.value());
  fill_light_and_cut(block, view);
  const Mat3 rotation = glm::mat3_cast(view.world_from_bone.rotation);
  for (int axis = 0; axis < 3; ++axis) block.world_from_bone[axis] = Vec4f(glm::dvec4(rotation[axis], 0.0));
  if (volume) {
    const Affine world_from_index = Affine::from_pose(view.world_from_bone) * volume->bone_from_index();
    append_corners(*volume, world_from_index, points);
    fill_volume(block, rays.value(), volume->dims(), world_from_index);
  }
  block.dims.w = static_cast<float>(options.step_voxels);
  block.light.w = static_cast<float>(options.bisections);
  const bool with_tool = tool && view.world_from_tool;
  if (with_tool)
    for (const Vec3& corner : tool->corners()) points.push_back(*view.world_from_tool * corner);
  range = fit_depth_range(rays.value(), points);
  block.lens = Vec4f(glm::dvec4(range.near_plane, range.far_plane, width, height));
  if (volume && options.slices) {
    const Affine world_from_index = Affine::from_pose(view.world_from_bone) * volume->bone_from_index();
    fill_slices(block, rays.value(), volume->dims(), world_from_index, options.slices->per_voxel);
    glm::dmat4 matrix(world_from_index.linear);
    matrix[3] = glm::dvec4(world_from_index.offset, 1.0);
    block.world_from_index = glm::fmat4(matrix);
    block.clip_from_index = glm::fmat4(clip_from_world(rays.value(), range) * matrix);
  }
  if (with_tool) {
    glm::dmat4 world_from_tool(glm::mat3_cast(view.world_from_tool->rotation));
    world_from_tool[3] = glm::dvec4(view.world_from_tool->translation, 1.0);
    block.world_from_tool = glm::fmat4(world_from_tool);
    block.clip_from_tool = glm::fmat4(clip_from_world(rays.value(), range) * world_from_tool);
  }
  return block;
}

/// One triangle over the whole picture: a ray, or the background, at each pixel.
void Renderer::Impl::draw_screen(GLuint program) const {
  gl.UseProgram(program);
  gl.BindVertexArray(no_vertices.name());
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::Impl::draw_tool(GLuint program) const {
  gl.UseProgram(program);
  tool->draw();
}

/// Blends them over what is there; what is nearer, the tool, hides them.
void Renderer::Impl::draw_slices(GLuint program, int count) const {
  gl.UseProgram(program);
  volume->bind();
  gl.BindVertexArray(no_vertices.name());
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  gl.DepthMask(GL_FALSE);
  gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
  gl.DepthMask(GL_TRUE);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.Disable(GL_BLEND);
}

/// Blends over what is there the part of each ray that lies before it.
void Renderer::Impl::draw_translucent(GLuint program, const PixelRect& part) const {
  target.copy_depth(opaque_depth.name(), part);
  volume->bind();
  gl.BindTextureUnit(3, transfer.name());
  gl.BindTextureUnit(4, opaque_depth.name());
  gl.Disable(GL_DEPTH_TEST);  // depths were looked up instead
  gl.Enablei(GL_BLEND, 0);    // the picture alone, not the probe
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.ColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  draw_screen(program);
  gl.ColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.Disablei(GL_BLEND, 0);
  gl.Enable(GL_DEPTH_TEST);
}

/// Light where rays hit bone, tissue or a cut: the depth test leaves the other pixels as they are, without running their shader.
void Renderer::Impl::draw_light(GLuint program) const {
  target.bind_for_light();
  gl.BindTextureUnit(4, target.hits());
  gl.DepthFunc(GL_GREATER);  // the far plane, over a hit
  gl.DepthMask(GL_FALSE);
  draw_screen(program);
  gl.DepthMask(GL_TRUE);
  gl.DepthFunc(GL_LEQUAL);
  target.bind();
}

ShaderVariant Renderer::Impl::light_variant(bool cut, bool tissue, bool soft) const {
  SurfaceChoice choice{.cut = cut, .soft = false, .finish = options.finish, .looks = options.looks};
  choice.looks.tissue = choice.looks.tissue && tissue;
  choice.soft = choice.looks.tissue && soft;
  return surface_variant(choice);
}

ShaderVariant Renderer::Impl::volume_variant(bool cut, bool probe, bool soft) const {
  const LookView& looks = options.looks;
  if (options.slices)
    return slices_variant({.cut = cut, .correct = options.slices->correct, .labels = looks.labels, .normals = looks.normals});
  if (options.translucent)
    return translucent_variant(
        {.cut = cut, .soft = soft, .skip = options.skip_empty, .probe = probe, .labels = looks.labels, .tint = tinted});
  return raycast_variant({.cut = cut, .skip = options.skip_empty, .probe = probe});
}

/// A user's faulty shader is found at once and not at the first picture that takes it: every program the options may call for, as if the
/// volume had tissue and dura. What is built in, the build has compiled.
Status Renderer::Impl::link_asked(const std::filesystem::path& folder) {
  std::vector<ShaderVariant> asked{background_variant(), tool_variant(false)};
  for (const bool cut : {false, true}) {
    asked.push_back(volume_variant(cut, false, true));
    if (has_surface()) asked.push_back(light_variant(cut, true, true));
  }
  for (const ShaderVariant& variant : asked) {
    const auto linked = programs.find_or_link(variant);
    if (linked) continue;
    Error fault = linked.error();
    if (!fault.place.empty()) fault.place = (folder / fault.place).string();
    return fault;
  }
  return {};
}

Status Renderer::Impl::prepare_target(int width, int height, bool probe) {
  const TargetKind kind = probe ? TargetKind::probed : (options.slices ? TargetKind::floats : TargetKind::bytes);
  if (target.fits(width, height, kind)) return {};
  auto made = GlTarget::create(gl, width, height, kind);
  if (!made) return made.error();
  target = std::move(made).value();
  if (options.translucent) opaque_depth = target.make_depth_texture();
  return {};
}

Result<Renderer::Impl::Programs> Renderer::Impl::find_programs(bool cut, bool probe) {
  const auto empty = programs.find_or_link(background_variant());
  if (!empty) return empty.error();
  const auto bone = volume ? programs.find_or_link(volume_variant(cut, probe, has_soft())) : empty;
  if (!bone) return bone.error();
  const auto light = volume && has_surface() ? programs.find_or_link(light_variant(cut, has_tissue(), has_soft())) : empty;
  if (!light) return light.error();
  const auto steel = programs.find_or_link(tool_variant(probe));
  if (!steel) return steel.error();
  return Programs{empty.value(), bone.value(), light.value(), steel.value()};
}

std::optional<DrawnTool> Renderer::Impl::place_tool(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const {
  if (!tool || !view.world_from_tool) return std::nullopt;
  std::vector<Vec3> corners;
  for (const Vec3& corner : tool->corners()) corners.push_back(*view.world_from_tool * corner);
  return DrawnTool{*view.world_from_tool, find_footprint(rays_of(block), corners, drawn)};
}

/// The same fragments as in a whole picture: OpenGL does not let the scissor's place change what is drawn inside (4.5 core, appendix A.3).
void Renderer::Impl::draw_part(const PixelRect& part, const FrameBlock& block, const Programs& used, bool with_tool) const {
  gl.Scissor(part.lo.x, part.lo.y, part.size().x, part.size().y);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const bool opaque = !volume || has_surface();
  if (opaque && volume) volume->bind();
  draw_screen(opaque ? used.volume : used.background);
  if (opaque && volume) draw_light(used.light);
  if (with_tool) draw_tool(used.tool);
  if (!opaque && options.slices) draw_slices(used.volume, static_cast<int>(block.slices.y));
  if (!opaque && options.translucent) draw_translucent(used.volume, part);
}

Status Renderer::Impl::render(const PixelRegion& region, const FrameView& view, const FrameBlock& block,
                              const std::optional<DrawnTool>& drawn_tool, bool probe) {
  const auto used = find_programs(view.cut.has_value(), probe);
  if (!used) return used.error();
  gl.NamedBufferSubData(frame_buffer.name(), 0, sizeof(FrameBlock), &block);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer.name());
  target.bind();
  gl.ClearDepth(1.0);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Enable(GL_SCISSOR_TEST);
  for (const PixelRect& part : region.rects())
    draw_part(part, block, used.value(), drawn_tool && !drawn_tool->footprint.intersect(part).empty());
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::internal, "OpenGL reports an error after drawing", {}};
  return {};
}

Result<Image> Renderer::Impl::draw(const FrameView& view, int width, int height) {
  const int n = options.supersample;
  const Vec2i drawn = n * Vec2i(width, height);
  if (const Status current = context.make_current(); !current) return current.error();
  if (const Status made = prepare_target(drawn.x, drawn.y, false); !made) return made.error();
  const auto block = make_block(view, drawn.x, drawn.y);
  if (!block) return block.error();
  const bool cut = view.cut.has_value();
  std::string shaders;
  if (volume) shaders = volume_variant(cut, false, has_soft()).name;
  if (volume && has_surface()) shaders += " " + light_variant(cut, has_tissue(), has_soft()).name;
  FrameKey key = make_frame_key(std::move(shaders), block.value());
  std::optional<Affine> world_from_index;
  if (volume) world_from_index = Affine::from_pose(view.world_from_bone) * volume->bone_from_index();
  const Reach reach = reach_of(options, world_from_index ? world_from_index->longest_edge() : 0.0);
  const std::optional<DrawnTool> drawn_tool = place_tool(view, block.value(), drawn);
  if (!options.keep_picture) cache.forget();
  const PixelRegion region = cache.find_stale(key, drawn, drawn_tool, world_from_index, reach);
  if (const Status done = render(region, view, block.value(), drawn_tool, false); !done) {
    cache.forget();
    return done.error();
  }
  std::vector<Image> parts;
  for (const PixelRect& part : region.rects()) parts.push_back(shrink(target.read_part(part), n));
  cache.keep(std::move(key), drawn, drawn_tool, region, parts);
  may_grow = false;
  ++counters.frames;
  counters.drawn_pixels += static_cast<std::uint64_t>(region.pixels() / (n * n));
  return cache.picture();
}

Status Renderer::Impl::draw_probe(const FrameView& view, int width, int height) {
  if (const Status current = context.make_current(); !current) return current;
  if (const Status made = prepare_target(width, height, true); !made) return made;
  const auto block = make_block(view, width, height);
  if (!block) return block.error();
  PixelRegion whole;
  whole.add({Vec2i(0), Vec2i(width, height)});
  if (const Status done = render(whole, view, block.value(), place_tool(view, block.value(), Vec2i(width, height)), true); !done)
    return done;
  ++counters.frames;
  return {};
}

RenderOptions make_render_options(const DrawingQuality& quality, const LookView& looks) {
  RenderOptions options{.step_voxels = quality.step_voxels,
                        .bisections = quality.bisections,
                        .finish = quality.finish,
                        .looks = looks,
                        .supersample = quality.supersample,
                        .resolution = quality.resolution};
  options.looks.occlusion = looks.occlusion && quality.finish;
  return options;
}

Result<Renderer> Renderer::create(const RenderOptions& options) {
  const Status valid = check_options(options);
  if (!valid) return valid.error();
  ShaderFiles files = embedded_shaders();
  if (!options.shader_folder.empty()) {
    auto read = read_shader_folder(options.shader_folder);
    if (!read) return read.error();
    files = std::move(read).value();
  }
  auto context = GlContext::create(16, 16, options.gl);
  if (!context) return context.error();
  auto impl = std::make_unique<Impl>(options, std::move(context).value(), std::move(files));
  if (!options.shader_folder.empty())
    if (Status linked = impl->link_asked(options.shader_folder); !linked) return linked.error();
  return Renderer(std::move(impl));
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Status Renderer::set_volume(const VolumeView& view) {
  const Status current = impl_->context.make_current();
  if (!current) return current;
  auto made = VolumeTexture::create(impl_->gl, view, impl_->seen_from);
  if (!made) return made.error();
  impl_->volume = std::move(made).value();
  impl_->cache.forget();
  impl_->counters.volume_bytes = impl_->volume->initial_bytes().texels;
  impl_->counters.skip_map_bytes += impl_->volume->initial_bytes().skip_map;
  return {};
}

void Renderer::update(const TexelBox& texels) {
  BH_ASSERT(impl_->volume.has_value());
  const Status current = impl_->context.make_current();
  BH_ASSERT(current.ok());
  static_cast<void>(current);
  const UploadedBytes sent =
      impl_->volume->update(texels, !impl_->options.growth_is_told || impl_->may_grow, impl_->ring ? &*impl_->ring : nullptr);
  impl_->cache.texels_changed(texels.box);
  impl_->counters.update_bytes += sent.texels;
  impl_->counters.skip_map_bytes += sent.skip_map;
  ++impl_->counters.update_boxes;
}

Status Renderer::set_tool(const TriangleMesh& mesh) {
  const Status current = impl_->context.make_current();
  if (!current) return current;
  auto made = ToolMesh::create(impl_->gl, mesh);
  if (!made) return made.error();
  impl_->tool = std::move(made).value();
  impl_->cache.forget();
  return {};
}

void Renderer::forget() noexcept {
  impl_->cache.forget();
  impl_->may_grow = true;
}

Status Renderer::set_quality(const DrawingQuality& quality) {
  RenderOptions options = impl_->options;
  options.step_voxels = quality.step_voxels;
  options.bisections = quality.bisections;
  options.finish = quality.finish;
  options.looks.occlusion = quality.finish && impl_->asked_occlusion;
  options.supersample = quality.supersample;
  options.resolution = quality.resolution;
  if (Status valid = check_options(options); !valid) return valid;
  impl_->options = std::move(options);
  impl_->cache = FrameCache(impl_->options.supersample);
  return {};
}

Result<Image> Renderer::draw(const FrameView& view, int width, int height) {
  const int n = impl_->options.supersample;
  if (width < 1 || height < 1 || width > kMaxSide / n || height > kMaxSide / n)
    return out_of_range("a picture must be 1 to " + std::to_string(kMaxSide / n) + " pixels wide and high");
  const auto drawn_side = [&](int side) { return std::max(1, static_cast<int>(std::lround(impl_->options.resolution * side))); };
  auto drawn = impl_->draw(view, drawn_side(width), drawn_side(height));
  if (!drawn) return drawn.error();
  return enlarge(*drawn, width, height);
}

Result<Image> Renderer::draw_at_pace(const FrameView& view, int width, int height, Pace& pace) {
  const bool moves = !impl_->last_camera || !(*impl_->last_camera == view.camera);
  impl_->last_camera = view.camera;
  if (!moves) return draw(view, width, height);
  const double asked = impl_->options.resolution, share = pace.resolution();
  impl_->options.resolution = asked * share;
  const auto start = std::chrono::steady_clock::now();
  auto image = draw(view, width, height);
  impl_->options.resolution = asked;
  if (image) pace.tell(share, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return image;
}

Result<FrameProbe> Renderer::probe(const FrameView& view, int width, int height) {
  if (!impl_->volume) return bad_input("a probe needs a volume");
  if (impl_->options.slices) return bad_input("a probe needs rays: slices meet no surface");
  const Status drawn = impl_->draw_probe(view, width, height);
  if (!drawn) return drawn.error();
  FrameProbe probe;
  probe.image = impl_->target.read_picture();
  for (const float depth : impl_->target.read_depth()) probe.view_depth.push_back(static_cast<float>(impl_->range.view_depth_of(depth)));
  impl_->counters.probe_samples = 0;
  for (const Vec4f& pixel : impl_->target.read_probe()) {
    probe.hit_index.emplace_back(pixel.x, pixel.y, pixel.z);
    probe.hit.push_back(pixel.w > 0.0f ? 1 : 0);
    probe.samples.push_back(static_cast<int>(pixel.w < 0.0f ? -pixel.w : pixel.w));
    impl_->counters.probe_samples += static_cast<std::uint64_t>(probe.samples.back());
  }
  return probe;
}

Status Renderer::link_every_variant() {
  const Status current = impl_->context.make_current();
  if (!current) return current;
  for (const ShaderVariant& variant : all_shader_variants()) {
    const auto linked = impl_->programs.find_or_link(variant);
    if (!linked) return linked.error();
  }
  return {};
}

const RenderCounters& Renderer::counters() const noexcept { return impl_->counters; }

const GlContext& Renderer::context() const noexcept { return impl_->context; }

std::string Renderer::driver() const {
  const GlContext& context = impl_->context;
  return std::string(gl_backend_name(context.backend())) + ": " + context.version() + ", " + context.renderer();
}

}  // namespace burrhole
