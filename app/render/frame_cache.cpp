#include "app/render/frame_cache.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "app/render/enlarge.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

bool same(const FrameKey& a, const FrameKey& b) {
  return a.variant == b.variant && std::memcmp(&a.block, &b.block, sizeof(FrameBlock)) == 0;
}

bool same(const std::optional<DrawnTool>& a, const std::optional<DrawnTool>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->world_from_tool.translation == b->world_from_tool.translation && a->world_from_tool.rotation == b->world_from_tool.rotation;
}

/// The smallest rectangle of whole blocks of n x n pixels that contains r.
PixelRect in_blocks(const PixelRect& r, int n) { return {r.lo / n * n, (r.hi + n - 1) / n * n}; }

/// @returns disjoint rectangles that cover what `rects`, which are disjoint, have outside of all `holes`.
std::vector<PixelRect> outside(std::span<const PixelRect> rects, std::span<const PixelRect> holes) {
  std::vector<PixelRect> out(rects.begin(), rects.end());
  for (const PixelRect& hole : holes) {
    std::vector<PixelRect> left;
    for (const PixelRect& rect : out) append_outside(rect, hole, left);
    out = std::move(left);
  }
  return out;
}

/// Row 0 is the top row of pictures and the bottom row of rectangles.
void paste(const Image& part, const PixelRect& place, Image& picture) {
  BH_ASSERT(part.width == place.size().x && part.height == place.size().y);
  for (int row = 0; row < part.height; ++row) {
    const auto from = part.pixels.begin() + std::ptrdiff_t{row} * part.width;
    const std::ptrdiff_t line = picture.height - place.hi.y + row;
    std::copy(from, from + part.width, picture.pixels.begin() + line * picture.width + place.lo.x);
  }
}

}  // namespace

FrameKey make_frame_key(std::string variant, const FrameBlock& block) {
  FrameKey key{std::move(variant), block};
  key.block.clip_from_tool = key.block.world_from_tool = key.block.light_from_world = glm::fmat4(0.0f);
  // The depth range depends on the tool. Colours do not depend on the depth range, because it contains the whole volume, unless the near
  // plane is at its minimum and cuts the volume.
  if (block.lens.x <= static_cast<float>(kNearestPlane)) return key;
  key.block.lens.x = key.block.lens.y = 0.0f;
  for (glm::length_t column = 0; column < 4; ++column) key.block.clip_from_index[column].z = key.block.clip_from_bone[column].z = 0.0f;
  return key;
}

CameraRays rays_of(const FrameBlock& block) noexcept {
  const Vec3 forward(block.forward_world), right(block.right_world), up(block.up_world);
  const Vec3 across = glm::normalize(glm::cross(right, up));
  return {Vec3(block.eye_world), forward, right, up, glm::dot(across, forward) < 0.0 ? -across : across};
}

void FrameCache::restart(int supersample) noexcept {
  forget();
  supersample_ = supersample;
}

void FrameCache::texels_changed(const VoxelBox& box) {
  if (key_) changed_.add(box);
}

StalePixels FrameCache::find_stale(const FrameKey& key, const Vec2i& drawn, const std::optional<DrawnTool>& tool, const DrawnAdded& added,
                                   const std::optional<Affine>& world_from_index, const Reach& reach, bool layers) const {
  StalePixels out;
  if (!key_ || !same(*key_, key) || Vec2i(picture_.width, picture_.height) * supersample_ != drawn) {
    out.drawn.push_back({Vec2i(0), drawn});
    return out;
  }
  BH_ASSERT(changed_.empty() || world_from_index);
  PixelRegion region;
  const CameraRays rays = rays_of(key.block);
  const auto footprints = [&](const Reach& of, PixelRegion& into) {
    for (const VoxelBox& box : changed_)
      into.add(in_blocks(find_footprint(rays, reached_corners(box, of, *world_from_index), drawn), supersample_));
  };
  footprints(layers ? reach : reach.with_occlusion(), region);
  PixelRegion moved;
  const auto redraw = [&](const PixelRect& place) { (layers ? moved : region).add(in_blocks(place, supersample_)); };
  if (!same(tool_, tool))
    for (const std::optional<DrawnTool>& one : {tool_, tool})
      for (const PixelRect& place : one ? std::vector{one->footprint, one->shadow} : std::vector<PixelRect>{}) redraw(place);
  if (added_.version != added.version)
    for (const DrawnAdded& one : {added_, added}) redraw(one.footprint);
  out.drawn.assign(region.rects().begin(), region.rects().end());
  for (const PixelRect& part : outside(missing_, region.rects())) out.drawn.push_back(part);
  if (!layers) return out;
  if (reach.occlusion > 0.0 && !changed_.empty()) {
    PixelRegion wide;
    footprints(reach.with_occlusion(), wide);
    out.relit = outside(wide.rects(), out.drawn);
    out.changed = changed_.bounds();
  }
  out.tool = outside(outside(moved.rects(), out.drawn), out.relit);
  return out;
}

std::vector<PixelRect> StalePixels::all() const {
  std::vector<PixelRect> out = drawn;
  out.insert(out.end(), relit.begin(), relit.end());
  out.insert(out.end(), tool.begin(), tool.end());
  return out;
}

std::vector<StalePixels> StalePixels::in_bands(int supersample, int focus) const {
  std::vector<PixelRect> bands;
  for (const PixelRect& rect : drawn) {
    const int whole = std::max(1, kBandPixels / (supersample * rect.size().x)) * supersample;
    for (int row = rect.lo.y; row < rect.hi.y; row += whole)
      bands.push_back({{rect.lo.x, row}, {rect.hi.x, std::min(row + whole, rect.hi.y)}});
  }
  std::ranges::stable_sort(bands, {}, [focus](const PixelRect& band) { return std::abs(band.lo.y + band.hi.y - 2 * focus); });
  std::vector<StalePixels> out(std::max<std::size_t>(1, bands.size()));
  out.front() = {{}, relit, tool, changed};
  for (std::size_t n = 0; n < bands.size(); ++n) out[n].drawn.push_back(bands[n]);
  return out;
}

void FrameCache::keep(FrameKey key, const Vec2i& drawn, const std::optional<DrawnTool>& tool, const DrawnAdded& added,
                      std::span<const PixelRect> rects, std::span<Image> shrunk, std::vector<PixelRect> missing) {
  BH_ASSERT(rects.size() == shrunk.size());
  const Vec2i size = drawn / supersample_;
  if (!missing.empty() && !picture_.pixels.empty()) picture_ = enlarge(std::move(picture_), size.x, size.y);
  if (shrunk.size() == 1 && Vec2i(shrunk[0].width, shrunk[0].height) == size) {
    std::swap(picture_, shrunk[0]);
  } else {
    picture_.width = size.x;
    picture_.height = size.y;
    picture_.pixels.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    for (std::size_t n = 0; n < shrunk.size(); ++n) {
      const PixelRect& r = rects[n];
      paste(shrunk[n], {r.lo / supersample_, r.hi / supersample_}, picture_);
    }
  }
  key_ = std::move(key);
  tool_ = tool;
  added_ = added;
  changed_.clear();
  missing_ = std::move(missing);
}

}  // namespace burrhole
