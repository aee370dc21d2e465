#include "app/render/triangle_chunks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace burrhole {
namespace {

const Vec3f kNowhere(std::numeric_limits<float>::quiet_NaN());

/// @returns 0..2^30 - 1, the place on Morton's curve. @param at in [0, 1023].
std::uint32_t curve_key(const Vec3f& at) {
  const auto spread = [](float x) {  // two zero bits behind each bit
    auto bits = static_cast<std::uint32_t>(x) & 0x3ffu;
    bits = (bits | bits << 16) & 0x030000ffu;
    bits = (bits | bits << 8) & 0x0300f00fu;
    bits = (bits | bits << 4) & 0x030c30c3u;
    return (bits | bits << 2) & 0x09249249u;
  };
  return spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2;
}

}  // namespace

void TriangleChunks::arrange(const BoneMesh& mesh) {
  places_.clear();
  numbers_.clear();
  lowest_.clear();
  chunks_.clear();
  extend(mesh.slots());
  for (std::uint32_t n = 0; n < mesh.slots(); ++n) set(n, mesh.triangle(n));
  Vec3f lo(std::numeric_limits<float>::max()), hi(std::numeric_limits<float>::lowest());
  for (const Vec3f& p : lowest_)
    if (!std::isnan(p.x)) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
  const float steps = 1023.0f / std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, std::numeric_limits<float>::min()});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keys;
  keys.reserve(lowest_.size());
  for (std::uint32_t n = 0; n < lowest_.size(); ++n)
    keys.emplace_back(std::isnan(lowest_[n].x) ? std::numeric_limits<std::uint32_t>::max() : curve_key(steps * (lowest_[n] - lo)), n);
  std::ranges::sort(keys);
  std::vector<Vec3f> by_place;
  by_place.reserve(keys.size());
  for (std::uint32_t place = 0; place < keys.size(); ++place) {
    const std::uint32_t number = keys[place].second;
    places_[number] = place;
    numbers_[place] = number;
    by_place.push_back(lowest_[number]);
  }
  lowest_ = std::move(by_place);
}

void TriangleChunks::extend(std::uint32_t triangles) {
  for (auto n = static_cast<std::uint32_t>(places_.size()); n < triangles; ++n) {
    places_.push_back(n);
    numbers_.push_back(n);
    lowest_.push_back(kNowhere);
  }
  chunks_.resize((places_.size() + kTriangles - 1) / kTriangles);
}

void TriangleChunks::set(std::uint32_t place, const MeshTriangle& triangle) {
  const Vec3f &a = triangle[0].position, &b = triangle[1].position, &c = triangle[2].position;
  if (a == b && b == c) {
    lowest_[place] = kNowhere;
  } else {
    lowest_[place] = glm::min(a, glm::min(b, c));
    longest_ = glm::max(longest_, glm::max(a, glm::max(b, c)) - lowest_[place]);
  }
  chunks_[place / kTriangles].stale = true;
}

void TriangleChunks::measure(std::size_t chunk) {
  Chunk& out = chunks_[chunk];
  out = {Vec3f(std::numeric_limits<float>::max()), Vec3f(std::numeric_limits<float>::lowest()), true, false};
  const std::size_t end = std::min<std::size_t>(lowest_.size(), (chunk + 1) * kTriangles);
  for (std::size_t n = chunk * kTriangles; n < end; ++n) {
    if (std::isnan(lowest_[n].x)) continue;
    out.lo = glm::min(out.lo, lowest_[n]);
    out.hi = glm::max(out.hi, lowest_[n]);
    out.empty = false;
  }
}

const std::vector<TriangleRange>& TriangleChunks::find(const CameraRays& rays, const Affine& world_from_bone, const PixelRect& part,
                                                       const Vec2i& picture) {
  found_.clear();
  const PixelRect near = part.grown(1);  // for the errors of single precision
  for (std::size_t n = 0; n < chunks_.size(); ++n) {
    if (chunks_[n].stale) measure(n);
    if (chunks_[n].empty) continue;
    const Vec3 lo(chunks_[n].lo), hi(chunks_[n].hi + longest_);
    std::array<Vec3, 8> corners{};
    for (std::size_t m = 0; m < 8; ++m)
      corners[m] = world_from_bone * Vec3((m & 1) != 0 ? hi.x : lo.x, (m & 2) != 0 ? hi.y : lo.y, (m & 4) != 0 ? hi.z : lo.z);
    if (find_footprint(rays, corners, picture).intersect(near).empty()) continue;
    const auto begin = static_cast<std::uint32_t>(n * kTriangles);
    const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(lowest_.size(), (n + 1) * kTriangles));
    if (!found_.empty() && found_.back().end == begin)
      found_.back().end = end;
    else
      found_.push_back({begin, end});
  }
  return found_;
}

}  // namespace burrhole
