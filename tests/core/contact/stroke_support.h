/// tests/core/contact/stroke_support.h: thin and narrow bones that a stroke might pass, their truth, and the bench they are felt on.
///   Units  SI.
#pragma once

#include <optional>

#include "shipped_bone.h"
#include "true_records.h"

namespace burrhole::contact_test {

inline constexpr double kFine = 0.25e-3;  ///< [m] pitch of these bones
inline constexpr double kPeriod = 1e-3;   ///< [s]
inline constexpr double kBallRadius = 2e-3;
inline constexpr double kHeld = 0.1;  ///< [voxel] what the project promises at spin 0
inline const ConstrainedToolConfig kConfig;

inline PhantomSpec fine_spec(PhantomKind kind) {
  PhantomSpec spec;
  spec.kind = kind;
  spec.pitch = kFine;
  spec.extent = Vec3(0.012, 0.012, 0.012);
  spec.above = 0.005;
  spec.thickness = 0.0017;  // of the inner table: 6.8 voxels
  return spec;
}

/// A bone, its truth, and a stroke of the hand into it.
struct Stroke {
  std::string name;
  PhantomSpec spec;
  Vec3 from{0.0, 0.0, 1e-3};   ///< [m] of the tip at the start, in air
  Vec3 along{0.0, 0.0, -1.0};  ///< unit
  double length = 11e-3;       ///< [m] then the hand rests: 10 mm beyond the surface are 50 N at 5 N/mm
  double allowed = 0.1;        ///< [voxel] largest depth of a shell point under the true surface; under the felt one it is kHeld for all
};

inline std::vector<Stroke> every_stroke() {
  std::vector<Stroke> all;
  all.push_back({"thin plate", fine_spec(PhantomKind::plate)});
  all.push_back({"thin plate, tilted 25 degrees", fine_spec(PhantomKind::plate)});
  all.back().spec.plate_normal = Vec3(0.466, 0.0, 1.0);
  all.back().along = -glm::normalize(all.back().spec.plate_normal);
  all.push_back({"thin curved shell", fine_spec(PhantomKind::skull_patch)});
  PhantomSpec& curved = all.back().spec;
  curved.curvature = 0.015;
  curved.outer_table = curved.inner_table = 0.85e-3;
  curved.dura = 0.0;
  // A convex edge: trilinear interpolation rounds it by a fraction of a voxel (phantom.h), and the tool rests on what is left.
  all.push_back({"corner", fine_spec(PhantomKind::block), Vec3(6e-3, 0.0, 0.0), -glm::normalize(Vec3(1.0, 0.0, 1.0)), 11e-3, 0.5});
  all.back().spec.block_size = Vec3(0.008, 0.010, 0.005);
  // A snug bore with a 1.7 mm floor: wall and floor at once.
  all.push_back({"slot", fine_spec(PhantomKind::pit), Vec3(0.0), -glm::normalize(Vec3(0.3, 0.0, 1.0)), 11e-3, 0.5});
  all.back().spec.thickness = 0.0037;
  all.back().spec.hole_depth = 0.002;
  all.back().spec.hole_radius = 0.0023;
  return all;
}

/// [voxel] of the deepest shell point under the true surface, negative in air.
inline double deepest_of(const PointShell& shell, const Pose& pose, const Truth& truth) {
  double deepest = -1e9;
  for (const Vec3& p : shell.positions) deepest = std::max(deepest, -truth.signed_distance(pose * p) / kFine);
  return deepest;
}

/// [voxel] depth of a point under the 0.5 level of the trilinear density, 0 in air: rays all round, no record and no normal. At most
/// `most`.
inline double felt_depth(const ShippedBone& bone, const Vec3& p_bone, double most = 2.0) {
  constexpr int kRays = 600;  // 0.14 rad apart: the nearest way out is within 0.1 rad of one, which is half a percent longer
  if (bone.density(p_bone) < 0.5) return 0.0;
  double least = most;
  for (int n = 0; n < kRays; ++n) {
    const double c = 1.0 - (2.0 * n + 1.0) / kRays, s = std::sqrt(1.0 - c * c), turn = 2.399963229728653 * n;
    const Vec3 way = kFine * Vec3(s * std::cos(turn), s * std::sin(turn), c);
    double out = 0.0;
    do out += 0.02;
    while (out < least && bone.density(p_bone + way * out) >= 0.5);
    if (out >= least) continue;
    double in = out - 0.02;
    for (int k = 0; k < 12; ++k) (bone.density(p_bone + way * (0.5 * (in + out))) >= 0.5 ? in : out) = 0.5 * (in + out);
    least = out;
  }
  return least;
}

/// [voxel] of the deepest shell point under the felt surface, 0 in air.
inline double felt_deepest_of(const PointShell& shell, const Pose& pose, const ShippedBone& bone) {
  double deepest = 0.0;
  for (const Vec3& p : shell.positions) deepest = std::max(deepest, felt_depth(bone, pose * p));
  return deepest;
}

/// Where records come from: the phantom's closed form, or its voxels by way of voxmap and publisher.
enum class Records { of_truth, shipped };
inline constexpr Records kBoth[] = {Records::of_truth, Records::shipped};
inline const char* name_of(Records records) { return records == Records::shipped ? "shipped records" : "true records"; }

struct Bench {
  Stroke stroke;
  Phantom phantom;
  std::optional<TrueRecords> true_bone;
  std::optional<ShippedBone> shipped_bone;
  PointShell shell;
  explicit Bench(Stroke s, Records records = Records::of_truth, const std::string& tool = "acosta_liu_round")
      : stroke(std::move(s)), phantom(phantom_of(stroke.spec)), shell(shipped_shell(tool)) {
    if (records == Records::shipped)
      shipped_bone.emplace(phantom);
    else
      true_bone.emplace(phantom);
  }
  [[nodiscard]] SurfaceView view() const { return true_bone ? true_bone->view() : shipped_bone->view(); }

  [[nodiscard]] ConstrainedTool tool(const ConstrainedToolConfig& config = kConfig) const {
    auto made = ConstrainedTool::create(config, shell, kFine);
    REQUIRE(made.ok());
    made->place({Quat(1.0, 0.0, 0.0, 0.0), stroke.from});
    return std::move(made).value();
  }
};

}  // namespace burrhole::contact_test
