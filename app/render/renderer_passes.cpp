// The draw calls of one picture: programs, passes and their OpenGL state.
#include <algorithm>

#include "app/render/renderer_impl.h"

namespace burrhole {

void Renderer::Impl::scissor(const PixelRect& part) const { gl.Scissor(part.lo.x, part.lo.y, part.size().x, part.size().y); }

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

void Renderer::Impl::draw_added(const PixelRect& part, const Programs& used) const {
  if (!added) return;
  scissor(part);
  gl.UseProgram(used.added);
  added->draw();
}

/// The opaque edge of the opening, then the shell blended over what is there, where neither bone nor tool nor edge is nearer. Of each pixel only
/// the nearest layer of the shell is drawn: a first pass writes its depth. Both passes have the same program, so their depths are equal.
void Renderer::Impl::draw_skin(const Programs& used) const {
  gl.UseProgram(used.rim);
  skin->draw_rim();
  gl.UseProgram(used.skin);
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  skin->draw_shell();
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl.DepthMask(GL_FALSE);
  gl.DepthFunc(GL_EQUAL);
  skin->draw_shell();
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
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
  const GLuint opaque_depth = target.copy_depth(part);
  volume->bind();
  gl.BindTextureUnit(3, transfer.name());
  gl.BindTextureUnit(4, opaque_depth);
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

/// Calls f with the detail's textures and block bound, for the part of the picture where it may be.
template <class F>
void Renderer::Impl::with_detail(const PixelRect& part, const Programs& used, const F& f) const {
  const PixelRect drawn = used.detail_rect.intersect(part);
  if (drawn.empty()) return;
  scissor(drawn);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, detail_buffer.name());
  detail->bind();
  volume->bind_field(7);
  f();
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer.name());
  scissor(part);
}

/// The nearer hit of each ray in both levels, or in the only one, then the light on the hits of each.
void Renderer::Impl::draw_levels(const PixelRect& part, const Programs& used) const {
  volume->bind();
  draw_screen(used.volume);
  with_detail(part, used, [&] {
    gl.DepthFunc(GL_LESS);  // a ray without a hit, at the far plane, changes nothing
    draw_screen(used.detail);
    gl.DepthFunc(GL_LEQUAL);
  });
  light_levels(part, used.light, used.detail_light, used);
}

/// Runs one program on the hits of all of the volume, or of all but the detail, and one on those of the detail.
void Renderer::Impl::light_levels(const PixelRect& part, GLuint outer, GLuint inner, const Programs& used) const {
  volume->bind();
  draw_light(outer);
  with_detail(part, used, [&] { draw_light(inner); });
}

/// A program that first tests whether its pixel is concerned costs as much as one that lights it: Mesa executes both branches of each `if`.
/// Therefore one pass marks the pixels by stencil, and a second draws light there.
std::uint64_t Renderer::Impl::relight(std::span<const PixelRect> parts, const Programs& used) const {
  const auto each = [&](GLuint outer, GLuint inner) {
    for (const PixelRect& part : parts) {
      scissor(part);
      light_levels(part, outer, inner, used);
    }
  };
  for (const PixelRect& part : parts) {
    scissor(part);
    gl.Clear(GL_STENCIL_BUFFER_BIT);
  }
  gl.Enable(GL_STENCIL_TEST);
  gl.StencilFunc(GL_ALWAYS, 1, 0xff);
  gl.StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  gl.BeginQuery(GL_SAMPLES_PASSED, count_query.name());
  each(used.stale_occlusion, used.detail_stale_occlusion);
  gl.EndQuery(GL_SAMPLES_PASSED);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.StencilFunc(GL_EQUAL, 1, 0xff);
  gl.StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  each(used.light, used.detail_light);
  gl.Disable(GL_STENCIL_TEST);
  GLuint64 marked = 0;
  gl.GetQueryObjectui64v(count_query.name(), GL_QUERY_RESULT, &marked);
  return marked;
}

ShaderVariant Renderer::Impl::stale_variant(bool cut, VolumeLevel level) const {
  return stale_occlusion_variant({.cut = cut, .finish = options.finish, .appearance = options.appearance, .level = level});
}

ShaderVariant Renderer::Impl::light_variant(bool cut, bool tissue, bool soft, VolumeLevel level, bool tool_shadow) const {
  SurfaceChoice choice{.cut = cut,
                       .soft = false,
                       .finish = options.finish,
                       .fog = has_fog,
                       .tool_shadow = tool_shadow,
                       .appearance = options.appearance,
                       .level = level};
  choice.appearance.tissue = choice.appearance.tissue && tissue;
  choice.soft = choice.appearance.tissue && soft;
  return surface_variant(choice);
}

ShaderVariant Renderer::Impl::volume_variant(bool cut, bool probe, bool soft, VolumeLevel level) const {
  const Appearance& appearance = options.appearance;
  if (options.slices)
    return slices_variant(
        {.cut = cut, .correct = options.slices->correct, .labels = appearance.labels, .fog = has_fog, .normals = appearance.normals});
  if (options.translucent)
    return translucent_variant({.cut = cut,
                                .soft = soft,
                                .skip = options.skip_empty,
                                .probe = probe,
                                .labels = appearance.labels,
                                .tint = tinted,
                                .fog = has_fog});
  return raycast_variant({.cut = cut, .skip = options.skip_empty, .probe = probe, .table = has_table, .fog = has_fog, .level = level});
}

/// A user's faulty shader is found at once and not at the first picture that takes it: every program the options may call for, as if the
/// volume had tissue and dura. What is built in, the build has compiled.
Status Renderer::Impl::link_asked(const std::filesystem::path& folder) {
  std::vector<ShaderVariant> asked{background_variant(), tool_variant(has_surface() ? ToolPass::layer : ToolPass::picture)};
  for (const bool cut : {false, true}) {
    for (const bool wet : {false, true})
      asked.push_back(added_variant({.pass = has_surface() ? ToolPass::layer : ToolPass::picture, .cut = cut, .wet = wet}));
    if (options.mesh) {
      asked.push_back(bone_mesh_variant(cut, false));
      continue;
    }
    asked.push_back(volume_variant(cut, false, true, VolumeLevel::only));
    if (has_surface()) asked.push_back(light_variant(cut, true, true, VolumeLevel::only));
    if (relights()) asked.push_back(stale_variant(cut, VolumeLevel::only));
    if (has_surface() && options.appearance.shadow) asked.push_back(light_variant(cut, true, true, VolumeLevel::only, true));
  }
  if (!options.mesh && has_surface() && options.appearance.shadow) asked.insert(asked.end(), {tool_depth_variant(), tool_shadow_variant()});
  for (const ShaderVariant& variant : asked) {
    const auto linked = programs.find_or_link(variant);
    if (linked) continue;
    Error fault = linked.error();
    if (!fault.place.empty()) fault.place = (folder / fault.place).string();
    return fault;
  }
  return {};
}

TargetKind Renderer::Impl::bone_kind() const noexcept {
  if (options.slices) return TargetKind::floats;
  return relights() ? TargetKind::marked : TargetKind::bytes;
}

Status Renderer::Impl::prepare(GlTarget& into, GlTarget* spare, int width, int height, TargetKind kind) {
  if (into.fits(width, height, kind)) return {};
  if (&into != &probe_target) cache.forget();  // kept pixels read it
  if (spare != nullptr && (spare->fits(width, height, kind) || into.pixels() > std::int64_t{width} * height)) std::swap(into, *spare);
  if (into.fits(width, height, kind)) return {};
  auto made = GlTarget::create(gl, width, height, kind);
  if (!made) return made.error();
  into = std::move(made).value();
  if (options.translucent) into.make_depth_copy();
  return {};
}

Result<Renderer::Impl::Programs> Renderer::Impl::find_programs(bool cut, ToolPass pass, bool with_stale) {
  auto out = find_bone_programs(cut, pass, with_stale);
  if (!out || !added) return out;
  const auto found = programs.find_or_link(added_variant({.pass = pass, .cut = cut, .fog = has_fog, .wet = added->is_wet()}));
  if (!found) return found.error();
  out->added = found.value();
  return out;
}

Result<Renderer::Impl::Programs> Renderer::Impl::find_bone_programs(bool cut, ToolPass pass, bool with_stale) {
  const bool probe = pass == ToolPass::probe;
  const auto empty = programs.find_or_link(background_variant(has_table, has_fog));
  if (!empty) return empty.error();
  if (mesh) return find_mesh_programs(cut, pass);
  const auto bone = volume ? programs.find_or_link(volume_variant(cut, probe, has_soft(), outer_level())) : empty;
  if (!bone) return bone.error();
  const auto light = volume && has_surface() ? programs.find_or_link(light_variant(cut, has_tissue(), has_soft(), outer_level())) : empty;
  if (!light) return light.error();
  const auto steel = programs.find_or_link(tool_variant(pass, has_fog));
  if (!steel) return steel.error();
  Programs out{.background = empty.value(), .volume = bone.value(), .light = light.value(), .tool = steel.value()};
  if (with_stale) {
    const auto stale = programs.find_or_link(stale_variant(cut, outer_level()));
    if (!stale) return stale.error();
    out.stale_occlusion = stale.value();
  }
  if (skin)
    if (Status found = find_skin_programs(cut, out); !found) return found.error();
  if (pass == ToolPass::layer && has_tool_shadow())
    if (Status found = find_shadow_programs(cut, out); !found) return found.error();
  if (!detail) return out;
  const auto part = programs.find_or_link(volume_variant(cut, probe, has_soft(), VolumeLevel::detail));
  if (!part) return part.error();
  const auto part_light = programs.find_or_link(light_variant(cut, has_tissue(), has_soft(), VolumeLevel::detail));
  if (!part_light) return part_light.error();
  out.detail = part.value();
  out.detail_light = part_light.value();
  if (with_stale) {
    const auto part_stale = programs.find_or_link(stale_variant(cut, VolumeLevel::detail));
    if (!part_stale) return part_stale.error();
    out.detail_stale_occlusion = part_stale.value();
  }
  return out;
}

Status Renderer::Impl::find_skin_programs(bool cut, Programs& out) {
  for (const bool rim : {false, true}) {
    const auto found = programs.find_or_link(skin_variant({.cut = cut, .fog = has_fog, .rim = rim}));
    if (!found) return found.error();
    (rim ? out.rim : out.skin) = found.value();
  }
  return {};
}

Status Renderer::Impl::find_shadow_programs(bool cut, Programs& out) {
  const auto find = [this](const ShaderVariant& variant, GLuint& program) -> Status {
    const auto found = programs.find_or_link(variant);
    if (!found) return found.error();
    program = found.value();
    return {};
  };
  if (Status found = find(tool_depth_variant(), out.tool_depth); !found) return found;
  if (Status found = find(tool_shadow_variant(), out.tool_shadow); !found) return found;
  if (Status found = find(light_variant(cut, has_tissue(), has_soft(), outer_level(), true), out.shaded); !found) return found;
  if (!detail) return {};
  return find(light_variant(cut, has_tissue(), has_soft(), VolumeLevel::detail, true), out.detail_shaded);
}

Status Renderer::Impl::make_tool_depth() {
  if (tool_depth) return {};
  auto made = ToolDepth::create(gl);
  if (!made) return made.error();
  tool_depth = std::move(made).value();
  return {};
}

std::optional<DrawnTool> Renderer::Impl::place_tool(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const {
  if (!tool || !view.world_from_tool) return std::nullopt;
  const auto corners = tool->corners_at(*view.world_from_tool);
  DrawnTool out{*view.world_from_tool, find_footprint(rays_of(block), corners, drawn)};
  if (!has_tool_shadow()) return out;
  std::vector<Vec3> bone;
  append_corners(volume->dims(), Affine::from_pose(view.world_from_bone) * volume->bone_from_index(), bone);
  out.shadow = find_shadow_footprint(rays_of(block), {corners, bone, Vec3(block.light)}, drawn);
  return out;
}

DrawnAdded Renderer::Impl::place_added(const FrameView& view, const FrameBlock& block, const Vec2i& drawn) const {
  if (!added) return {};
  return {added->version(), find_footprint(rays_of(block), added->corners_at(view.world_from_bone), drawn)};
}

/// The same fragments as in a whole picture: OpenGL does not let the scissor's place change what is drawn inside (4.5 core, appendix A.3).
void Renderer::Impl::draw_part(const PixelRect& part, const FrameBlock& block, const Programs& used, bool with_tool, bool over_copy) {
  scissor(part);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (mesh) {
    draw_mesh(part, block, used.background, used.volume);
    if (with_tool) draw_tool(used.tool);
    if (!over_copy) draw_added(part, used);
    return;
  }
  const bool opaque = !volume || has_surface();
  if (volume && opaque)
    draw_levels(part, used);
  else
    draw_screen(used.background);
  if (with_tool) draw_tool(used.tool);
  if (!over_copy) draw_added(part, used);
  if (!opaque && options.slices) draw_slices(used.volume, static_cast<int>(block.slices.y));
  if (!opaque && options.translucent) draw_translucent(used.volume, part);
}

/// Light again on the hits in the tool's shadow, over the copy of the bone. A first pass marks them, so that other pixels cost a look-up.
void Renderer::Impl::draw_tool_shadow(const PixelRect& part, const Programs& used) const {
  scissor(part);
  gl.Clear(GL_STENCIL_BUFFER_BIT);
  gl.BindTextureUnit(4, target.hits());
  gl.BindTextureUnit(8, tool_depth->depths());
  gl.Disable(GL_DEPTH_TEST);
  gl.Enable(GL_STENCIL_TEST);
  gl.StencilFunc(GL_ALWAYS, 1, 0xff);
  gl.StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_screen(used.tool_shadow);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.StencilFunc(GL_EQUAL, 1, 0xff);
  gl.StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  volume->bind();
  draw_screen(used.shaded);
  with_detail(part, used, [&] { draw_screen(used.detail_shaded); });
  gl.Disable(GL_STENCIL_TEST);
  gl.Enable(GL_DEPTH_TEST);
}

/// The picture: the bone with the tool's shadow, and over it tool, what effects add, and skin where no bone is nearer.
void Renderer::Impl::draw_layer(const PixelRect& part, const Programs& used, const std::optional<DrawnTool>& drawn_tool) const {
  scissor(part);
  target.copy_picture(shown, part);
  const PixelRect shade = drawn_tool ? drawn_tool->shadow.intersect(part) : PixelRect{};
  if (!shade.empty()) draw_tool_shadow(shade, used);
  const bool with_tool = drawn_tool && !drawn_tool->footprint.intersect(part).empty();
  if (!with_tool && !skin && !added) return;
  scissor(part);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.BindTextureUnit(4, target.hits());
  if (with_tool) draw_tool(used.tool);
  draw_added(part, used);
  if (skin) draw_skin(used);
}

Result<std::uint64_t> Renderer::Impl::render(const StalePixels& stale, const FrameView& view, const FrameBlock& block,
                                             const std::optional<DrawnTool>& drawn_tool, ToolPass pass) {
  auto used = find_programs(view.cut.has_value(), pass, !stale.relit.empty());
  if (!used) return used.error();
  if (detail) {
    const FrameBlock of_detail = make_detail_block(block, view);
    gl.NamedBufferSubData(detail_buffer.name(), 0, sizeof(FrameBlock), &of_detail);
    std::vector<Vec3> corners;
    append_corners(detail->dims(), Affine::from_pose(view.world_from_bone) * detail->bone_from_index(), corners);
    used->detail_rect = find_footprint(rays_of(block), corners, {static_cast<int>(block.lens.z), static_cast<int>(block.lens.w)});
  }
  gl.NamedBufferSubData(frame_buffer.name(), 0, sizeof(FrameBlock), &block);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer.name());
  target.bind();
  gl.ClearDepth(1.0);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Enable(GL_SCISSOR_TEST);
  const bool layers = pass == ToolPass::layer;
  const auto has_tool = [&](const PixelRect& part) { return drawn_tool && !drawn_tool->footprint.intersect(part).empty(); };
  for (const PixelRect& part : stale.drawn) draw_part(part, block, used.value(), !layers && has_tool(part), layers);
  const std::uint64_t relit = stale.relit.empty() ? 0 : relight(stale.relit, *used);
  if (layers) {
    const std::vector<PixelRect> parts = stale.all();
    const auto shaded = [&](const PixelRect& part) { return !drawn_tool->shadow.intersect(part).empty(); };
    if (drawn_tool && std::ranges::any_of(parts, shaded)) {
      if (Status made = make_tool_depth(); !made) return made.error();
      tool_depth->draw(*tool, used->tool_depth);
    }
    shown.bind();
    for (const PixelRect& part : parts) draw_layer(part, *used, drawn_tool);
  }
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::internal, "OpenGL reports an error after drawing", {}};
  return relit;
}

}  // namespace burrhole
