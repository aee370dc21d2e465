#include "core/drill/erosion.h"

#include <cmath>

#include "core/base/assert.h"
#include "core/base/portable_math.h"
#include "core/drill/engaged_removal.h"
#include "core/drill/face_removal.h"
#include "core/drill/progressive_removal.h"
#include "core/drill/removal_pass.h"
#include "core/drill/threshold_removal.h"

namespace burrhole {
namespace {

constexpr float kLeastHardness = 0.1f;  // keeps dr/dt finite in pores; part of the law
constexpr double kGone = 128.0;         // e^-128 x a float <= 1 rounds to 0; any other -ln(1 - e s) of a double is below 37

}  // namespace

Erosion::Erosion(const ErosionConfig& config, const ErosionPoints& points, bool by_points) : config_(config), count_(points.size()) {
  if (count_ == 0) return;
  tool_bounds_ = bounds_of_points(points.positions);
  if (!by_points) return;
  points_ = points;
  if (config.form == ErosionForm::scatter) scatter_ = PointScatter(points);
}

Erosion::Erosion(Erosion&&) noexcept = default;
Erosion& Erosion::operator=(Erosion&&) noexcept = default;
Erosion::~Erosion() = default;

Result<Erosion> Erosion::create(const ErosionConfig& config, const ErosionPoints& points, std::shared_ptr<const CuttingField> field) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(config.minimum_density >= 0.0f && config.minimum_density < 0.5f)) return refuse("minimum density must be in [0, 0.5)");
  if (!(config.longest_substep > 0.0 && config.longest_substep <= 1.0)) return refuse("the longest sub-step must be in (0, 1] voxels");
  if (points.size() > kMaxErosionPoints || points.factors.size() != points.size()) return refuse("erosion points and factors disagree");
  if (points.size() > 0 && !(points.pitch > 0.0 && std::isfinite(points.pitch)))
    return refuse("the pitch of erosion points must be a number above 0");
  for (std::size_t n = 0; n < points.size(); ++n)
    if (!is_finite(points.positions[n]) || !(points.factors[n] >= 0.0f) || !std::isfinite(points.factors[n]))
      return refuse("an erosion point is not finite or its factor is negative");
  const bool by_points = config.law == ErosionLaw::rate || config.law == ErosionLaw::per_update;
  Erosion erosion(config, points, !config.subvoxel && by_points);
  if (config.law == ErosionLaw::threshold) {
    auto ball = ThresholdRemoval::create(config.threshold, points);
    if (!ball) return ball.error();
    erosion.ball_ = std::make_unique<ThresholdRemoval>(std::move(ball).value());
  } else if (config.law == ErosionLaw::progressive) {
    auto progressive = ProgressiveRemoval::create(config, points);
    if (!progressive) return progressive.error();
    erosion.progressive_ = std::make_unique<ProgressiveRemoval>(std::move(progressive).value());
  } else if (config.subvoxel) {
    auto face = FaceRemoval::create(config, std::move(field));
    if (!face) return face.error();
    erosion.face_ = std::make_unique<FaceRemoval>(std::move(face).value());
  } else if (config.law == ErosionLaw::energy) {
    auto engaged = EngagedRemoval::create(config, points);
    if (!engaged) return engaged.error();
    erosion.engaged_ = std::make_unique<EngagedRemoval>(std::move(engaged).value());
  }
  return erosion;
}

void Erosion::set_factors(std::span<const float> factors) {
  BH_ASSERT(factors.size() == count_);
  if (engaged_) engaged_->set_factors(factors);
  if (points_.size() == 0) return;
  points_.factors.assign(factors.begin(), factors.end());
  weighed_for_ = 0.0;
  strength_ = {};
  if (config_.form == ErosionForm::scatter) scatter_ = PointScatter(points_);
}

int Erosion::substeps_for(const ErosionPath& path) const noexcept {
  // Positions are affine in the corners, so the corner of the tool's box with the largest motion bounds every point.
  double longest = 0.0;
  for (const Vec3& p : tool_bounds_.corners()) {
    longest = std::max(longest, glm::length(path.to * p - path.from * p));
  }
  return std::max(1, static_cast<int>(std::ceil(longest / config_.longest_substep)));
}

ErosionOutcome Erosion::step(Voxmap& voxmap, const ErosionPath& path, double spin, double dt) {
  return step(voxmap, path, CuttingLoad{.spin = spin}, dt);
}

ErosionOutcome Erosion::step(Voxmap& voxmap, const ErosionPath& path, const CuttingLoad& load, double dt) {
  ErosionOutcome outcome;
  const double spin = load.spin;
  if (!(spin > 0.0) || count_ == 0 || !(dt > 0.0)) return outcome;
  if (ball_) return ball_->step(voxmap, path, substeps_for(path), load);
  if (progressive_) return progressive_->step(voxmap, path, substeps_for(path), load, dt);
  if (face_) return face_->step(voxmap, path, substeps_for(path), load, dt);
  if (engaged_) return engaged_->step(voxmap, path, substeps_for(path), load, dt);
  const MasterWindow& window = voxmap.window();
  const int substeps = substeps_for(path);
  const double voxel_edge = voxmap.bone().bone_from_index().mean_edge();
  const double relative_pitch = points_.pitch / voxel_edge;
  const double cell_share = relative_pitch * relative_pitch * relative_pitch;
  const bool by_rate = config_.law == ErosionLaw::rate;
  const RemovalLaw law{.scale = by_rate ? spin * cell_share : 1.0,
                       .dt = by_rate ? dt / substeps : 1.0,
                       .by_hardness = by_rate,
                       .least_hardness = kLeastHardness,
                       .minimum_density = config_.minimum_density};
  weigh_points(spin, voxel_edge);
  marks_.reset(window.box);
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  for (int n = 0; n < substeps; ++n) {
    outcome.outside += expose(window, path.at((n + 0.5) / substeps));
    const Removal removal = apply_removal(voxmap, law, exposure_, marks_);
    outcome.removed_mass += removal.mass;
    outcome.touched += removal.voxels;
  }
  outcome.removed_mass *= voxmap.bone().bone_from_index().cell_volume();
  outcome.changed = marks_.boxes();
  return outcome;
}

/// Weight of a point: its factor for `rate`, -ln(1 - e s) for `per_update`, so that the product becomes a sum. Recomputed when s changes.
void Erosion::weigh_points(double spin, double voxel_edge) {
  const double s = config_.law == ErosionLaw::per_update ? spin : 0.0;
  const auto weight = [s](float factor) {
    if (s == 0.0) return static_cast<double>(factor);
    const double keep = 1.0 - static_cast<double>(factor) * s;  // [AcostaLiu07] eq. 4
    return keep > 0.0 ? -portable_log(keep) : kGone;
  };
  if (config_.form == ErosionForm::gather) {
    if (weighed_for_ == s && strength_.voxel_edge() == voxel_edge) return;
    std::vector<double> weights;
    for (const float factor : points_.factors) weights.push_back(weight(factor));
    strength_ = StrengthField(points_, weights, voxel_edge);
  } else if (weighed_for_ != s) {
    std::vector<double> weights;
    for (const float factor : scatter_.distinct_factors()) weights.push_back(weight(factor));
    scatter_.set_weights(weights);
  }
  weighed_for_ = s;
}

/// Fills exposure_ for a pose. @returns the number of points outside the erodible box.
std::uint32_t Erosion::expose(const MasterWindow& window, const Affine& index_from_tool) {
  if (config_.form == ErosionForm::scatter) return scatter_.add(window, index_from_tool, exposure_);
  strength_.look_up(window, index_from_tool, exposure_);
  const VoxelBox allowed = window.erodible_box();
  bool inside = true;
  for (const Vec3& corner : tool_bounds_.corners()) inside = inside && allowed.contains(voxel_of(index_from_tool * corner));
  if (inside) return 0;
  std::uint32_t outside = 0;
  for (const Vec3& p : points_.positions) outside += allowed.contains(voxel_of(index_from_tool * p)) ? 0 : 1;
  return outside;
}

}  // namespace burrhole
