/// app/bench/contact_bones.h: what the contact rows share: bone in every form that contact reads, tools in it, and what is felt.
#pragma once

#include <memory>
#include <vector>

#include "app/bench/bench.h"
#include "core/base/simd.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/gradient_plane.h"

namespace burrhole {

inline constexpr double kBenchEdge = 0.25e-3;  ///< [m] voxels of the shipped scene

/// One bone, as it is published with floats, with packed words and with surface records, and in the paper's storage.
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

/// A ball of bone 4.5 mm wide: the tool inside it marches as far as in the published figures (about 14 voxels).
[[nodiscard]] Result<BoneForms> make_ball_of_bone();
/// A tilted plate thick enough for a tool 16 voxels deep.
[[nodiscard]] Result<BoneForms> make_thick_plate();

/// A round hole in bone, a tenth of a voxel wider all round than the balls of make_ball(): all their points are near its surface.
[[nodiscard]] Result<BoneForms> make_socket();

/// A ball's facets, and how many points of it are kept.
struct BallSize {
  int stacks, slices;
  std::size_t points;
};

/// A cutting ball of 3 mm with exactly `points` points, its centre the origin, in Morton order. Rings have even counts: up to two points at
/// the top are left out to meet a number.
[[nodiscard]] Result<PointShell> make_ball(int stacks, int slices, std::size_t points);

/// Turned every way, the centre within 1.2 voxels of that of the ball of bone, so that every point stays inside.
[[nodiscard]] std::vector<Pose> poses_in_ball();

/// Forces and torques of every pose; planes, too, if asked for. `contacts` counts the points that touch.
struct Felt {
  std::vector<double> numbers;
  std::vector<Vec3> forces;
  std::size_t contacts = 0;
};
[[nodiscard]] Felt feel(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses);
/// Largest difference of a force over the largest force.
[[nodiscard]] double force_difference(const Felt& a, const Felt& b);

[[nodiscard]] Side evaluate_all(const PenaltyModel& model, const ContactView& bone, const std::vector<Pose>& poses, ContactResult& scratch);

/// Whether what was felt by the vectors in use is, bit for bit, what f() feels by the weakest that the machine has. What was in use is in
/// use again afterwards.
template <class Numbers, class F>
[[nodiscard]] bool levels_agree(Bench& bench, const std::string& name, const Numbers& felt, F&& f) {
  const SimdLevelGuard guard;
  const auto levels = simd_levels();
  if (!levels.empty()) (void)choose_simd(name_of(levels.front()));
  const Numbers weakest = f();
  return bench.agree(name, bytes_of(weakest.numbers), bytes_of(felt.numbers));
}

/// The rows of other files of this area.
[[nodiscard]] Status bench_held_tool(Bench& bench);
[[nodiscard]] Status bench_contact_upkeep(Bench& bench);

}  // namespace burrhole
