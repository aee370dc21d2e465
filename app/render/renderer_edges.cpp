// A picture of one ray a pixel, and all rays where it has edges (docs/drawing.md, "Rays at edges").
#include <algorithm>

#include "app/render/renderer_impl.h"

namespace burrhole {
namespace {

PixelRect in_pixels(const PixelRect& rays, int n) { return {rays.lo / n, rays.hi / n}; }

}  // namespace

/// One ray a pixel, and the tiles with edges in it. Tiles read the pixels around them, so these are drawn too.
Result<std::uint64_t> Renderer::Impl::draw_pixels(const StalePixels& step, const EdgeFrame& frame) {
  const int n = options.supersample;
  const PixelRect all{Vec2i(0), edges.size()};
  StalePixels coarse;
  for (const PixelRect& part : step.drawn) coarse.drawn.push_back(in_pixels(part, n).grown(1).intersect(all));
  for (const PixelRect& part : step.relit) coarse.relit.push_back(in_pixels(part, n));
  std::swap(target, pixels);
  auto relit = render(coarse, frame.view, frame.of_pixels, std::nullopt, ToolPass::none);
  std::swap(target, pixels);
  if (!relit) return relit;
  for (const std::vector<PixelRect>* parts : {&step.drawn, &step.relit})
    for (const PixelRect& part : *parts) {
      const PixelRect tiles = in_pixels(part, n);
      edges.mark(tiles, pixels.read_part(tiles.grown(1).intersect(all)), options.edge_threshold);
    }
  return relit;
}

/// All rays of the bone in the marked tiles.
void Renderer::Impl::draw_edges(const StalePixels& step, const Programs& used) {
  const int n = options.supersample;
  std::vector<PixelRect> marked;
  for (const std::vector<PixelRect>* parts : {&step.drawn, &step.relit})
    for (const PixelRect& part : *parts) edges.append(in_pixels(part, n), true, marked);
  if (marked.empty()) return;
  for (const PixelRect& part : marked) counters.edge_pixels += static_cast<std::uint64_t>(part.count());
  screen.set(marked, edges.size());
  const PixelRect all{Vec2i(0), n * edges.size()};
  by_rects = true;
  scissor(all);
  draw_levels(all, used);
  by_rects = false;
}

/// Runs a program, over the rectangles, that reads the colours of one target.
void Renderer::Impl::convert(GLuint program, const GlTarget& from, std::span<const PixelRect> parts) {
  if (parts.empty()) return;
  screen.set(parts, edges.size());
  gl.ProgramUniform1i(program, 0, options.supersample);
  gl.BindTextureUnit(9, from.colours());
  gl.UseProgram(program);
  gl.Disable(GL_DEPTH_TEST);
  screen.draw_rects();
  gl.Enable(GL_DEPTH_TEST);
}

Status Renderer::Impl::draw_over_edges(std::span<const PixelRect> parts, const Programs& used, const EdgeFrame& frame) {
  const int n = options.supersample;
  std::vector<PixelRect> plain, covered;
  for (const PixelRect& part : parts) {
    edges.append(in_pixels(part, n), false, plain);
    covered.push_back(in_pixels(part, n));
  }
  target.bind();
  scissor({Vec2i(0), n * edges.size()});
  gl.BindTextureUnit(4, pixels.hits());
  convert(used.spread, pixels, plain);
  if (Status drawn = draw_layers(parts, used, frame.tool); !drawn) return drawn;
  resolved.bind();
  scissor({Vec2i(0), edges.size()});
  convert(used.resolve, shown, covered);
  return {};
}

Result<std::uint64_t> Renderer::Impl::render_edges(const StalePixels& step, const EdgeFrame& frame) {
  const auto relit = draw_pixels(step, frame);
  if (!relit) return relit;
  auto used = begin_pass(frame.view, frame.of_rays, frame.over_copy ? ToolPass::layer : ToolPass::none, false);
  if (!used) return used.error();
  for (const auto& [variant, program] : {std::pair(resolve_variant(), &used->resolve), std::pair(spread_variant(), &used->spread)}) {
    const auto found = programs.find_or_link(variant);
    if (!found) return found.error();
    *program = found.value();
  }
  draw_edges(step, *used);
  const int n = options.supersample;
  resolved.bind();
  std::vector<PixelRect> marked, over;
  PixelRect tool_at = frame.tool ? frame.tool->footprint.unite(frame.tool->shadow) : PixelRect{};
  tool_at = {tool_at.lo / n * n, (tool_at.hi + n - 1) / n * n};
  for (const PixelRect& part : step.all()) {
    const PixelRect at = in_pixels(part, n);
    scissor(at);
    pixels.copy_picture(resolved, at);
    edges.append(at, true, marked);
    const PixelRect covered = skin ? part : tool_at.intersect(part);
    if (frame.over_copy && !covered.empty()) over.push_back(covered);
  }
  scissor({Vec2i(0), edges.size()});
  convert(used->resolve, target, marked);
  if (!over.empty())
    if (Status drawn = draw_over_edges(over, *used, frame); !drawn) return drawn.error();
  if (gl.GetError() != GL_NO_ERROR) return Error{ErrorCode::internal, "OpenGL reports an error after drawing", {}};
  return relit;
}

}  // namespace burrhole
