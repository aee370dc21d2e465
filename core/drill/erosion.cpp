#include "core/drill/erosion.h"

#include <cmath>

#include "core/base/assert.h"
#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr float kLeastHardness = 0.1f;  // keeps dr/dt finite in pores; part of the law

Affine mix(const Affine& a, const Affine& b, double t) {
  Affine out;
  for (std::size_t c = 0; c < 3; ++c) out.linear[c] = a.linear[c] + (b.linear[c] - a.linear[c]) * t;
  out.offset = a.offset + (b.offset - a.offset) * t;
  return out;
}

}  // namespace

Erosion::Erosion(const ErosionConfig& config, const ErosionPoints& points) : config_(config), points_(points) {
  if (points_.size() == 0) return;
  lo_ = hi_ = points_.positions.front();
  for (const Vec3& p : points_.positions) {
    lo_ = glm::min(lo_, p);
    hi_ = glm::max(hi_, p);
  }
  // Runs of points one pitch apart along the tool's x: the order in which a bit is voxelised makes them long.
  for (std::uint32_t n = 0; n < points_.size(); ++n) {
    if (!runs_.empty()) {
      Run& run = runs_.back();
      const Vec3 next = run.start + Vec3(points_.pitch * run.count, 0.0, 0.0);
      if (glm::length(points_.positions[n] - next) < 1e-9 * points_.pitch) {
        ++run.count;
        continue;
      }
    }
    runs_.push_back({points_.positions[n], n, 1});
  }
}

Result<Erosion> Erosion::create(const ErosionConfig& config, const ErosionPoints& points) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(config.minimum_density >= 0.0f && config.minimum_density < 0.5f)) return refuse("minimum density must be in [0, 0.5)");
  if (!(config.longest_substep > 0.0 && config.longest_substep <= 1.0)) return refuse("the longest sub-step must be in (0, 1] voxels");
  if (points.size() > kMaxErosionPoints || points.factors.size() != points.size()) return refuse("erosion points and factors disagree");
  if (points.size() > 0 && !(points.pitch > 0.0 && std::isfinite(points.pitch)))
    return refuse("the pitch of erosion points must be a number above 0");
  for (std::size_t n = 0; n < points.size(); ++n)
    if (!is_finite(points.positions[n]) || !(points.factors[n] >= 0.0f) || !std::isfinite(points.factors[n]))
      return refuse("an erosion point is not finite or its factor is negative");
  return Erosion(config, points);
}

int Erosion::substeps_for(const ErosionPath& path) const noexcept {
  // The corner of the tool's box that moves most bounds every point: positions are affine in the corners.
  double longest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) != 0 ? hi_.x : lo_.x, (corner & 2) != 0 ? hi_.y : lo_.y, (corner & 4) != 0 ? hi_.z : lo_.z);
    longest = std::max(longest, glm::length(path.to * p - path.from * p));
  }
  return std::max(1, static_cast<int>(std::ceil(longest / config_.longest_substep)));
}

ErosionOutcome Erosion::step(Voxmap& voxmap, const ErosionPath& path, double spin, double dt) {
  ErosionOutcome outcome;
  if (!(spin > 0.0) || points_.size() == 0 || !(dt > 0.0)) return outcome;
  const MasterWindow& window = voxmap.window();
  if (exposure_.size() != window.box.count()) exposure_.assign(window.box.count(), 0.0f);

  const int substeps = substeps_for(path);
  const double voxel_edge = voxmap.bone().bone_from_index().mean_edge();
  const double relative_pitch = points_.pitch / voxel_edge;
  const double cell_share = relative_pitch * relative_pitch * relative_pitch;
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  for (int n = 0; n < substeps; ++n) {
    const Affine index_from_tool = mix(path.from, path.to, (n + 0.5) / substeps);
    if (config_.law == ErosionLaw::rate) {
      gather_exposure(window, index_from_tool, outcome);
      apply_rate(voxmap, spin * cell_share, dt / substeps, outcome);
    } else {
      apply_per_update(voxmap, index_from_tool, spin, outcome);
    }
  }
  outcome.removed_mass *= voxmap.bone().bone_from_index().cell_volume();
  return outcome;
}

void Erosion::gather_exposure(const MasterWindow& window, const Affine& index_from_tool, ErosionOutcome& outcome) {
  // Coordinates relative to the window's corner are positive inside it, so that truncation is floor; cell = centre +- 1/2.
  const VoxelBox allowed{window.erodible_box().lo - window.box.lo, window.erodible_box().hi - window.box.lo};
  const Vec3 lowest(allowed.lo), highest(allowed.hi);
  const auto row = static_cast<std::size_t>(window.box.size().x);
  const auto slab = row * static_cast<std::size_t>(window.box.size().y);
  const Vec3 shift = index_from_tool.offset + 0.5 - Vec3(window.box.lo);
  const Vec3 along = index_from_tool.linear[0] * points_.pitch;
  const float* density = window.density.data();
  for (const Run& run : runs_) {
    const Vec3 first = index_from_tool.linear * run.start + shift;
    const Vec3 last = first + along * static_cast<double>(run.count - 1);
    // A straight run lies in a convex box when both ends do.
    const bool inside =
        glm::all(glm::greaterThanEqual(glm::min(first, last), lowest)) && glm::all(glm::lessThan(glm::max(first, last), highest));
    for (std::uint32_t n = 0; n < run.count; ++n) {
      const Vec3 p = first + along * static_cast<double>(n);
      if (!inside && !(glm::all(glm::greaterThanEqual(p, lowest)) && glm::all(glm::lessThan(p, highest)))) {
        ++outcome.outside;
        continue;
      }
      const std::size_t at = static_cast<std::size_t>(static_cast<int>(p.z)) * slab +
                             static_cast<std::size_t>(static_cast<int>(p.y)) * row + static_cast<std::size_t>(static_cast<int>(p.x));
      if (density[at] == 0.0f) continue;  // density is current up to the last commit, remaining up to this sub-step
      if (exposure_[at] == 0.0f) touched_.push_back(static_cast<std::uint32_t>(at));
      exposure_[at] += points_.factors[run.first + n];
    }
  }
}

void Erosion::apply_rate(Voxmap& voxmap, double rate_scale, double dt, ErosionOutcome& outcome) {
  const MasterWindow& window = voxmap.window();
  const std::span<float> remaining = voxmap.remaining();
  const auto row = static_cast<std::uint32_t>(window.box.size().x);
  const auto slab = row * static_cast<std::uint32_t>(window.box.size().y);
  for (const std::uint32_t at : touched_) {
    const double lambda = static_cast<double>(exposure_[at]) * rate_scale;
    exposure_[at] = 0.0f;
    const float before = remaining[at];
    if (lambda == 0.0 || before == 0.0f) continue;
    const double hardness = static_cast<double>(std::max(window.hardness[at], kLeastHardness));
    float after = static_cast<float>(static_cast<double>(before) * portable_exp(-lambda * dt / hardness));
    if (window.occupancy[at] * after < config_.minimum_density) after = 0.0f;
    if (after == before) continue;
    remaining[at] = after;
    outcome.removed_mass += static_cast<double>(window.occupancy[at]) * (static_cast<double>(before) - static_cast<double>(after));
    outcome.changed.include(window.box.lo +
                            Vec3i(static_cast<int>(at % row), static_cast<int>(at % slab / row), static_cast<int>(at / slab)));
    ++outcome.touched;
  }
  touched_.clear();
}

void Erosion::apply_per_update(Voxmap& voxmap, const Affine& index_from_tool, double spin, ErosionOutcome& outcome) {
  const MasterWindow& window = voxmap.window();
  const std::span<float> remaining = voxmap.remaining();
  const VoxelBox allowed = window.erodible_box();
  for (std::size_t n = 0; n < points_.size(); ++n) {
    const Vec3i v = voxel_of(index_from_tool * points_.positions[n]);
    if (!allowed.contains(v)) {
      ++outcome.outside;
      continue;
    }
    const std::size_t at = window.box.offset_of(v);
    const float before = remaining[at];
    if (window.occupancy[at] * before == 0.0f || points_.factors[n] == 0.0f) continue;
    const double keep = 1.0 - static_cast<double>(points_.factors[n]) * spin;  // [AcostaLiu07] eq. 4
    float after = keep > 0.0 ? static_cast<float>(static_cast<double>(before) * keep) : 0.0f;
    if (window.occupancy[at] * after < config_.minimum_density) after = 0.0f;
    remaining[at] = after;
    outcome.removed_mass += static_cast<double>(window.occupancy[at]) * (static_cast<double>(before) - static_cast<double>(after));
    outcome.changed.include(v);
    ++outcome.touched;
  }
}

}  // namespace burrhole
