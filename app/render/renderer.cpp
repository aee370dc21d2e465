#include "app/render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "app/render/enlarge.h"
#include "app/render/renderer_impl.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr int kMaxSide = 16384;  ///< [pixels] beyond any driver's limit, which GlTarget checks; prevents overflow of products

Error out_of_range(std::string why) { return {ErrorCode::out_of_range, std::move(why), {}}; }

Status check_options(const RenderOptions& options) {
  if (!(options.step_voxels > 0.0 && options.step_voxels <= 1.0)) return out_of_range("the ray step must be in (0, 1] voxels");
  if (options.bisections < 0 || options.bisections > 16) return out_of_range("bisections must be in 0..16");
  if (options.supersample < 1 || options.supersample > 4) return out_of_range("supersampling must be in 1..4");
  if (!(options.resolution >= 0.25 && options.resolution <= 1.0)) return out_of_range("the resolution must be in [0.25, 1]");
  if (options.slices && !(options.slices->per_voxel > 0.0 && options.slices->per_voxel <= 8.0))
    return out_of_range("slices must be in (0, 8] a voxel");
  if (options.slices && options.translucent) return out_of_range("a transfer function is for rays: slices have their own opacity");
  if (options.mesh && (options.slices || options.translucent))
    return out_of_range("a mesh is a surface: slices and a transfer function are for volumes");
  if (options.translucent) return check_transfer(*options.translucent);
  return {};
}

/// Checks that need no drawing; the camera is checked by make_camera_rays().
Status check_view(const FrameView& view) {
  const LightView& light = view.light;
  if (!is_finite(light.direction_to_light) || glm::length(light.direction_to_light) == 0.0)
    return out_of_range("the light has no direction");
  for (const double term : {light.ambient, light.diffuse, light.fill})
    if (!(term >= 0.0 && term <= 100.0)) return out_of_range("the terms of the light must be in 0..100");
  for (const Vec3& color : {view.background.bottom, view.background.top})
    for (const double channel : {color.x, color.y, color.z})
      if (!(channel >= 0.0 && channel <= 1.0)) return out_of_range("colours of the background must be in 0..1");
  if (view.table && (!is_finite(view.table->normal) || !is_finite(view.table->centre) || glm::length(view.table->half_x) == 0.0 ||
                     glm::length(view.table->half_y) == 0.0))
    return out_of_range("the table has no place");
  if (view.camera.fog) {
    const FogView& fog = *view.camera.fog;
    if (!(fog.depth > 0.0 && std::isfinite(fog.depth))) return out_of_range("the depth of fog must be above 0");
    for (const double channel : {fog.color.x, fog.color.y, fog.color.z})
      if (!(channel >= 0.0 && channel <= 1.0)) return out_of_range("the colour of fog must be in 0..1");
  }
  if (view.cut && (!is_finite(view.cut->normal) || glm::length(view.cut->normal) == 0.0)) return out_of_range("the cut has no direction");
  return {};
}

}  // namespace

Result<FrameBlock> Renderer::Impl::make_block(const FrameView& view, int width, int height, int rays_a_side) {
  const Status valid = check_view(view);
  if (!valid) return valid.error();
  const auto rays = make_camera_rays(view.camera, static_cast<double>(width) / static_cast<double>(height));
  if (!rays) return rays.error();
  FrameBlock block;
  std::vector<Vec3> points;
  fill_camera(block, rays.value());
  fill_light_and_cut(block, view);
  fill_fog(block, view.camera, rays.value());
  const Mat3 rotation = glm::mat3_cast(view.world_from_bone.rotation);
  for (int axis = 0; axis < 3; ++axis) block.world_from_bone[axis] = Vec4f(glm::dvec4(rotation[axis], 0.0));
  if (has_bone()) {
    const Affine world_from_index = place_bone(view);
    append_corners(bone_dims(), world_from_index, points);
    fill_volume(block, rays.value(), bone_dims(), world_from_index);
    if (detail) fill_hole(block, grid);
  }
  block.dims.w = static_cast<float>(options.step_voxels);
  block.light.w = static_cast<float>(options.bisections);
  block.background_bottom.w = rays_a_side % 2 == 0 ? 2.0f : 1.0f;
  const bool with_tool = tool && view.world_from_tool;
  if (with_tool)
    for (const Vec3& corner : tool->corners_at(*view.world_from_tool)) points.push_back(corner);
  if (skin)
    for (const Vec3& corner : skin->corners()) points.push_back(view.world_from_bone * corner);
  if (added)
    for (const Vec3& corner : added->corners_at(view.world_from_bone)) points.push_back(corner);
  range = fit_depth_range(rays.value(), points);
  block.lens = Vec4f(glm::dvec4(range.near_plane, range.far_plane, width, height));
  if (mesh || added) fill_bone_place(block, view.world_from_bone, clip_from_world(rays.value(), range));
  if (skin) fill_skin(block, skin->look(), view.world_from_bone, clip_from_world(rays.value(), range));
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
    if (has_tool_shadow()) fill_tool_shadow(block, tool->corners_at(*view.world_from_tool), Vec3(world_from_tool[2]));
  }
  return block;
}

void Renderer::Impl::note_view(const FrameView& view) noexcept {
  has_fog = view.camera.fog.has_value();
  has_table = view.table.has_value() && !has_fog;  // fog hides the background
}

FrameBlock Renderer::Impl::make_detail_block(const FrameBlock& whole, const FrameView& view) const {
  FrameBlock block = whole;
  fill_volume(block, rays_of(whole), detail->dims(), Affine::from_pose(view.world_from_bone) * detail->bone_from_index());
  block.dims.w = whole.dims.w;
  fill_part(block, grid, volume->dims());
  return block;
}

Result<PictureStep> Renderer::Impl::draw(const FrameView& view, int width, int height, std::optional<double> seconds) {
  const auto start = std::chrono::steady_clock::now();
  const int n = options.supersample;
  const Vec2i drawn = n * Vec2i(width, height);
  if (const Status current = context.make_current(); !current) return current.error();
  auto block = make_block(view, drawn.x, drawn.y, n);
  if (!block) return block.error();
  if (Status made = prepare(target, &spare_target, drawn.x, drawn.y, bone_kind()); !made) return made.error();
  const bool layers = has_layers(), over_copy = layers && (tool || skin || added);
  if (over_copy)
    if (Status made = prepare(shown, &spare_shown, drawn.x, drawn.y, has_tool_shadow() ? TargetKind::shaded : TargetKind::shown); !made)
      return made.error();
  const bool cut = view.cut.has_value();
  note_view(view);
  if (Status sent = send_mesh(cut); !sent) return sent.error();
  FrameKey key = make_frame_key(shader_names(cut), block.value());
  std::optional<Affine> world_from_index;
  if (has_bone()) world_from_index = place_bone(view);
  const Reach reach = reach_of(options, world_from_index ? world_from_index->longest_edge() : 0.0);
  const std::optional<DrawnTool> drawn_tool = place_tool(view, block.value(), drawn);
  const DrawnAdded drawn_added = place_added(view, block.value(), drawn);
  if (!options.keep_picture) {
    cache.forget();
    seconds.reset();  // a step would begin anew each time
  }
  const StalePixels stale = cache.find_stale(key, drawn, drawn_tool, drawn_added, world_from_index, reach, layers);
  fill_changed(block.value(), stale.changed);
  const int focus = drawn_tool ? (drawn_tool->footprint.lo.y + drawn_tool->footprint.hi.y) / 2 : drawn.y / 2;
  std::vector<PixelRect> rects;
  std::vector<PixelRect> missing;
  for (const StalePixels& step : seconds ? stale.in_bands(n, focus) : std::vector{stale}) {
    if (!rects.empty() && std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds.value_or(INFINITY)) {
      missing.insert(missing.end(), step.drawn.begin(), step.drawn.end());
      continue;
    }
    const auto relit = render(step, view, block.value(), drawn_tool, over_copy ? ToolPass::layer : ToolPass::picture);
    if (!relit) {
      cache.forget();
      return relit.error();
    }
    for (const PixelRect& part : step.all()) {
      if (rects.size() == read_parts.size()) read_parts.emplace_back();
      Image& read = read_parts[rects.size()];
      (over_copy ? shown : target).read_part(part, read_buffer ? &*read_buffer : nullptr, read);
      if (n > 1) read = shrink(read, n);
      rects.push_back(part);
    }
    for (const PixelRect& part : step.drawn) counters.drawn_pixels += static_cast<std::uint64_t>(part.count() / (n * n));
    counters.drawn_pixels += *relit / static_cast<std::uint64_t>(n * n);
  }
  const bool whole = missing.empty();
  cache.keep(std::move(key), drawn, drawn_tool, drawn_added, rects, std::span(read_parts).first(rects.size()), std::move(missing));
  may_grow = false;
  if (whole) ++counters.frames;
  for (const PixelRect& part : stale.tool) counters.tool_pixels += static_cast<std::uint64_t>(part.count() / (n * n));
  return PictureStep{cache.picture(), whole};
}

Result<PictureStep> Renderer::Impl::draw_sized(const FrameView& view, int width, int height, std::optional<double> seconds) {
  const int n = options.supersample;
  if (width < 1 || height < 1 || width > kMaxSide / n || height > kMaxSide / n)
    return out_of_range("a picture must be 1 to " + std::to_string(kMaxSide / n) + " pixels wide and high");
  const auto drawn_side = [&](int side) { return std::max(1, static_cast<int>(std::lround(options.resolution * side))); };
  auto drawn = draw(view, drawn_side(width), drawn_side(height), seconds);
  if (drawn) drawn->image = enlarge(std::move(drawn->image), width, height);
  return drawn;
}

Status Renderer::Impl::draw_probe(const FrameView& view, int width, int height) {
  if (const Status current = context.make_current(); !current) return current;
  if (Status made = prepare(probe_target, nullptr, width, height, TargetKind::probed); !made) return made;
  const auto block = make_block(view, width, height, 1);
  if (!block) return block.error();
  note_view(view);
  if (Status sent = send_mesh(view.cut.has_value()); !sent) return sent;
  StalePixels whole;
  whole.drawn.push_back({Vec2i(0), Vec2i(width, height)});
  std::swap(target, probe_target);
  const auto done = render(whole, view, block.value(), place_tool(view, block.value(), Vec2i(width, height)), ToolPass::probe);
  std::swap(target, probe_target);
  if (!done) return done.error();
  ++counters.frames;
  return {};
}

RenderOptions make_render_options(const DrawingQuality& quality, const Appearance& appearance) {
  RenderOptions options{.step_voxels = quality.step_voxels,
                        .bisections = quality.bisections,
                        .finish = quality.finish,
                        .appearance = appearance,
                        .supersample = quality.supersample,
                        .resolution = quality.resolution};
  options.appearance.occlusion = appearance.occlusion && quality.finish;
  return options;
}

Result<Renderer> Renderer::create(const RenderOptions& options) {
  if (Status valid = check_options(options); !valid) return valid.error();
  auto context = GlContext::create(16, 16, options.gl);
  if (!context) return context.error();
  return create(options, std::move(context).value());
}

Result<Renderer> Renderer::create(const RenderOptions& options, GlContext context) {
  if (Status valid = check_options(options); !valid) return valid.error();
  ShaderFiles files = embedded_shaders();
  if (!options.shader_folder.empty()) {
    auto read = read_shader_folder(options.shader_folder);
    if (!read) return read.error();
    files = std::move(read).value();
  }
  auto impl = std::make_unique<Impl>(options, std::move(context), std::move(files));
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
  if (impl_->options.mesh) return impl_->set_mesh(view);
  auto made = VolumeTexture::create(impl_->gl, view, impl_->seen_from);
  if (!made) return made.error();
  std::optional<VolumeTexture> detail;
  if (view.detail && impl_->has_surface()) {
    auto part = VolumeTexture::create(impl_->gl, view.detail->volume, impl_->seen_from);
    if (!part) return part.error();
    detail = std::move(part).value();
  }
  std::optional<SkinMesh> skin;
  if (view.skin && impl_->has_surface()) {
    auto shell = SkinMesh::create(impl_->gl, *view.skin);
    if (!shell) return shell.error();
    skin = std::move(shell).value();
  }
  impl_->skin = std::move(skin);
  impl_->volume = std::move(made).value();
  impl_->detail = std::move(detail);
  if (impl_->detail) impl_->grid = view.detail->grid;
  impl_->cache.forget();
  impl_->counters.volume_bytes = 0;
  for (const VolumeTexture* one : {&*impl_->volume, impl_->detail ? &*impl_->detail : nullptr}) {
    if (one == nullptr) continue;
    impl_->counters.volume_bytes += one->initial_bytes().texels;
    impl_->counters.skip_map_bytes += one->initial_bytes().skip_map;
  }
  return {};
}

Status Renderer::set_detail(const DetailView& view) {
  if (!impl_->detail) return {};
  if (Status current = impl_->context.make_current(); !current) return current;
  auto made = VolumeTexture::create(impl_->gl, view.volume, impl_->seen_from);
  if (!made) return made.error();
  impl_->detail = std::move(made).value();
  impl_->grid = view.grid;
  impl_->cache.forget();
  return {};
}

void Renderer::update(const TexelBox& texels) {
  BH_ASSERT(impl_->has_bone());
  if (impl_->mesh) {
    if (texels.of_detail) return;
    impl_->mesh->update(texels);
    impl_->cache.texels_changed(texels.box);
    ++impl_->counters.update_boxes;
    return;
  }
  const Status current = impl_->context.make_current();
  BH_ASSERT(current.ok());
  static_cast<void>(current);
  if (texels.of_detail && !impl_->detail) return;
  VolumeTexture& volume = texels.of_detail ? *impl_->detail : *impl_->volume;
  const UploadedBytes sent =
      volume.update(texels, !impl_->options.growth_is_reported || impl_->may_grow, impl_->ring ? &*impl_->ring : nullptr);
  impl_->cache.texels_changed(texels.of_detail ? impl_->grid.coarse_box(texels.box) : texels.box);
  impl_->counters.update_bytes += sent.texels;
  impl_->counters.skip_map_bytes += sent.skip_map;
  ++impl_->counters.update_boxes;
}

Result<std::vector<MineralBox>> Renderer::read_mineral(const Vec3& p_bone, double half_width) const {
  if (const Status current = impl_->context.make_current(); !current) return current.error();
  std::vector<MineralBox> out;
  if (const auto& mesh = impl_->mesh) {
    const Affine index_from_bone = mesh->bone_from_index().inverse();
    const VoxelBox box = voxels_around(index_from_bone, p_bone, half_width).intersect({Vec3i(0), mesh->dims()});
    out.push_back({box, index_from_bone, mesh->read_mineral(box)});
  }
  for (const std::optional<VolumeTexture>* level : {&impl_->detail, &impl_->volume}) {
    if (!*level) continue;
    const VolumeTexture& volume = **level;
    const Affine index_from_bone = volume.bone_from_index().inverse();
    const VoxelBox box = voxels_around(index_from_bone, p_bone, half_width).intersect({Vec3i(0), volume.dims()});
    out.push_back({box, index_from_bone, volume.read_mineral(box)});
  }
  return out;
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

Status Renderer::set_added(const std::shared_ptr<const AddedMesh>& mesh) {
  if (mesh == nullptr) {
    impl_->added.reset();
    return {};
  }
  const Status current = impl_->context.make_current();
  if (!current) return current;
  auto made = AddedMeshBuffer::create(impl_->gl, *mesh, impl_->added_versions + 1);
  if (!made) return made.error();
  ++impl_->added_versions;
  impl_->added = std::move(made).value();
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
  options.appearance.occlusion = quality.finish && impl_->asked_occlusion;
  options.supersample = quality.supersample;
  options.resolution = quality.resolution;
  if (Status valid = check_options(options); !valid) return valid;
  impl_->options = std::move(options);
  impl_->cache.restart(impl_->options.supersample);
  return {};
}

void Renderer::set_lights(const SurfaceLights& lights) noexcept {
  Appearance& appearance = impl_->options.appearance;
  if (impl_->options.slices || impl_->options.translucent || lights == SurfaceLights{appearance.shadow, appearance.specular}) return;
  appearance.shadow = lights.shadow;
  appearance.specular = lights.specular;
  impl_->cache.restart(impl_->options.supersample);
}

Result<Image> Renderer::draw(const FrameView& view, int width, int height) {
  auto drawn = impl_->draw_sized(view, width, height, std::nullopt);
  if (!drawn) return drawn.error();
  return std::move(drawn->image);
}

Result<PictureStep> Renderer::draw_step(const FrameView& view, int width, int height, double seconds) {
  impl_->last_camera = view.camera;
  return impl_->draw_sized(view, width, height, seconds);
}

Result<Image> Renderer::draw_at_pace(const FrameView& view, int width, int height, DynamicResolution& pace) {
  const bool moves = !impl_->last_camera || !(*impl_->last_camera == view.camera);
  impl_->last_camera = view.camera;
  if (!moves) return draw(view, width, height);
  const double asked = impl_->options.resolution, share = pace.resolution();
  impl_->options.resolution = asked * share;
  const auto start = std::chrono::steady_clock::now();
  auto image = draw(view, width, height);
  impl_->options.resolution = asked;
  if (image) pace.record(share, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return image;
}

Result<FrameProbe> Renderer::probe(const FrameView& view, int width, int height) {
  if (!impl_->has_bone()) return bad_input("a probe needs a volume");
  if (impl_->options.slices) return bad_input("a probe needs rays: slices meet no surface");
  const Status drawn = impl_->draw_probe(view, width, height);
  if (!drawn) return drawn.error();
  FrameProbe probe;
  probe.image = impl_->probe_target.read_picture();
  for (const float depth : impl_->probe_target.read_depth())
    probe.view_depth.push_back(static_cast<float>(impl_->range.view_depth_of(depth)));
  impl_->counters.probe_samples = 0;
  for (const Vec4f& pixel : impl_->probe_target.read_probe()) {
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
