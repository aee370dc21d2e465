/// app/bench/contact_bones.h: common parts of the contact rows: bone in every storage that contact reads, tools in it, contact results.
///   Frame  bone and world coincide by default.   Units  SI.   Thread  main.   Errors  those of phantom, voxmap and tool; internal for a
///   ball whose number of points is not reached.
#pragma once

#include <memory>
#include <vector>

#include "app/bench/bench.h"
#include "core/base/simd.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/gradient_plane.h"

namespace burrhole {

inline constexpr double kBenchEdge = 0.25e-3;  ///< [m] voxel edge of the shipped scene

/// One bone, published as floats, as packed words and as surface records, and stored in sparse grids as in [AcostaLiu07].
struct BoneForms {
  std::unique_ptr<Voxmap> voxmap;
  std::unique_ptr<ContactWindowPublisher> floats, words, records8, records16;
  std::unique_ptr<VdbContactGrids> grids;

  explicit BoneForms(Voxmap placed);
  [[nodiscard]] ContactView float_view(const Pose& world_from_bone = {}) const;
  [[nodiscard]] ContactView word_view(const Pose& world_from_bone = {}) const;
  [[nodiscard]] ContactView grid_view(const Pose& world_from_bone = {}) const;
  [[nodiscard]] SurfaceView surface_view(RecordPrecision precision, const Pose& world_from_bone = {}) const;
};

/// A ball of bone of 4.5 mm diameter. Points of the tool inside it march as far as in the published figures, about 14 voxels.
[[nodiscard]] Result<BoneForms> make_ball_of_bone();
/// A tilted plate, thick enough for a tool 16 voxels deep.
[[nodiscard]] Result<BoneForms> make_thick_plate();

/// A spherical hole in bone with a radius a tenth of a voxel larger than the balls of make_ball(): all their points are near its surface.
[[nodiscard]] Result<BoneForms> make_socket();

/// Tessellation of a ball and the number of its points that are used.
struct BallSize {
  int stacks, slices;
  std::size_t points;
};

/// A cutting ball of 3 mm diameter with exactly `points` points in Morton order, its centre at the origin. A ring has an even number of
/// points, so up to two points at the top are left out to reach the number.
[[nodiscard]] Result<PointShell> make_ball(int stacks, int slices, std::size_t points);

/// @returns poses with random rotations and centres within 1.2 voxels of the centre of the ball of bone; every point stays inside it.
[[nodiscard]] std::vector<Pose> poses_in_ball();

/// Contact results of a list of poses.
struct ContactSamples {
  std::vector<double> numbers;  ///< [N], [N m], [m], [-] per pose: force, torque, and the planes if the model lists them
  std::vector<Vec3> forces;     ///< [N] per pose
  std::size_t contacts = 0;     ///< number of touching points, all poses
};
[[nodiscard]] ContactSamples evaluate_poses(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses);
/// @returns the largest difference of a force over the largest force [-].
[[nodiscard]] double force_difference(const ContactSamples& a, const ContactSamples& b);

/// @returns a side that evaluates all poses without listing planes, as a contact tick does. The arguments must outlive it.
[[nodiscard]] Side evaluate_all(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses, ContactResult& scratch);

/// @returns whether `result` equals, bit for bit, the result of f() at the lowest SIMD level of the machine. The level in use is restored.
template <class Numbers, class F>
[[nodiscard]] bool levels_agree(Bench& bench, const std::string& name, const Numbers& result, F&& f) {
  const SimdLevelGuard guard;
  const auto levels = simd_levels();
  if (!levels.empty()) (void)choose_simd(name_of(levels.front()));
  const Numbers lowest = f();
  return bench.agree(name, bytes_of(lowest.numbers), bytes_of(result.numbers));
}

/// Rows of the constrained tool.
[[nodiscard]] Status bench_constrained_tool(Bench& bench);
/// Rows of contact between the points of the shell.
[[nodiscard]] Status bench_surface_contact(Bench& bench);
/// Rows of updating and sliding the published window.
[[nodiscard]] Status bench_contact_updates(Bench& bench);

}  // namespace burrhole
