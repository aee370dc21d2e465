#include "app/lab/sliding.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/lab/contact_rig.h"
#include "app/report/file.h"
#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/units.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/voxmap_contact.h"
#include "core/mesh/mesh_contact.h"
#include "core/mesh/mesh_tool.h"
#include "core/tool/make_tool.h"

namespace burrhole {
namespace {

constexpr double kAir = 1.5e-3;   // [m] margin above the plate: deeper than the deepest slide
constexpr double kHead = 5e-3;    // [m] height of the bit that has shell points
constexpr int kSettle = 20;       // steps at the first pose before the slide
constexpr double kPeriod = 1e-3;  // [s] irrelevant without damping

Status check(const SlidingOptions& options) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (options.tilts_deg.empty() || options.depths_voxel.empty()) return refuse("sliding needs a tilt and a depth");
  if (options.lanes < 1) return refuse("sliding needs at least one lane");
  for (const double tilt : options.tilts_deg)
    if (!(tilt >= 0.0 && tilt <= 60.0)) return refuse("a tilt must be in [0, 60] degrees");
  for (const double depth : options.depths_voxel)
    if (!(depth > 0.0 && depth * options.pitch < 2.0 * kMillimetre))
      return refuse("a depth must be above 0 and under 2 mm, half the plate");
  if (!(options.length > 0.0 && options.length <= 8.0 * kMillimetre)) return refuse("a slide must be above 0 and at most 8 mm long");
  if (!(options.step > 0.0 && options.step <= options.length && options.length / options.step <= 1e6))
    return refuse("a step must be above 0 and at most a slide, which has at most a million of them");
  return {};
}

std::string tool_file(const SlidingOptions& options) { return options.tool_folder + "/" + options.tool + ".toml"; }

/// A plate whose level form has its surface on voxel faces, with a margin for the slide and the bit.
PhantomSpec plate_of(const SlidingOptions& options, const Vec3& normal) {
  PhantomSpec spec;
  spec.kind = PhantomKind::plate;
  spec.pitch = options.pitch;
  spec.extent = Vec3(20.0, 14.0, 18.0) * kMillimetre;
  spec.above = std::ceil(9.0 * kMillimetre / options.pitch) * options.pitch;
  spec.thickness = 4.0 * kMillimetre;
  spec.plate_normal = normal;
  return spec;
}

struct Slope {
  Vec3 normal, down;  ///< unit
  explicit Slope(double tilt_deg)
      : normal(portable_sin(tilt_deg * kDegree), 0.0, portable_cos(tilt_deg * kDegree)), down(normal.z, 0.0, -normal.x) {}
};

/// Start of a lane: axis along the normal, rotated about it and displaced by the lane's random numbers.
Pose start_of(const SlidingOptions& options, const Slope& slope, double depth, int lane) {
  const auto seed = static_cast<std::uint64_t>(options.seed), at = 3 * static_cast<std::uint64_t>(lane);
  const double half_turn = 0.5 * std::numbers::pi * uniform11(seed, at);
  const Quat about_axis(portable_cos(half_turn), 0.0, 0.0, portable_sin(half_turn));
  const double along = 0.5 * options.pitch * uniform11(seed, at + 1) - 0.5 * options.length;
  return {rotation_from_z(slope.normal) * about_axis,
          slope.down * along + Vec3(0.0, 0.5 * options.pitch * uniform11(seed, at + 2), 0.0) - slope.normal * depth};
}

/// @param depth [m] @returns mean, largest step, root mean square of the steps [N], ripple [-], median and 99th percentile of the times [us].
Study::Figures slide(const SlidingSubject& subject, const SlidingBone& bone, const Slope& slope, double depth,
                     const SlidingOptions& options) {
  double mean = 0.0, largest_step = 0.0, ripple = 0.0;
  std::vector<double> time_us;
  double squares = 0.0;
  const int steps = static_cast<int>(options.length / options.step + 0.5);
  for (int lane = 0; lane < options.lanes; ++lane) {
    const ForceAt force = subject.on(bone);
    const Pose start = start_of(options, slope, depth, lane);
    std::vector<Vec3> forces;
    for (int n = 0; n <= steps; ++n) {
      const Pose pose{start.rotation, start.translation + slope.down * (n * options.step)};
      const auto before = std::chrono::steady_clock::now();
      forces.push_back(force(pose));
      time_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - before).count());
    }
    const SlideFigures figures = slide_figures(forces, slope.normal);
    largest_step = std::max(largest_step, figures.largest_step);
    mean += figures.mean / options.lanes;
    squares += figures.rms_step * figures.rms_step;
    ripple = std::isnan(figures.ripple) ? figures.ripple : std::max(ripple, figures.ripple);
  }
  return {mean, largest_step, std::sqrt(squares / options.lanes), ripple, at_share(time_us, 0.5), at_share(time_us, 0.99)};
}
constexpr std::size_t kFigures = 6;

/// @returns the trial of a subject. @param tool text of the tool's file. @param depth [voxels]
StudyTrial trial_of(const SlidingSubject& subject, double tilt_deg, double depth, const std::string& tool, const SlidingOptions& options) {
  StudyTrial out{.key = {}, .name = fmt::format("sliding, {:g} deg, {}", tilt_deg, subject.model), .figures = kFigures};
  out.key.add("sliding").add(subject.model).add(tool).add(tilt_deg).add(depth).add(options.pitch).add(options.step).add(options.length);
  out.key.add(options.lanes).add(static_cast<double>(options.seed));
  return out;
}

}  // namespace

SlideFigures slide_figures(std::span<const Vec3> forces, const Vec3& normal) noexcept {
  SlideFigures out;
  if (forces.empty()) return out;
  double squares = 0.0, sum = 0.0, lowest = glm::dot(forces[0], normal), highest = lowest;
  for (std::size_t n = 0; n < forces.size(); ++n) {
    const double along = glm::dot(forces[n], normal);
    sum += along;
    lowest = std::min(lowest, along);
    highest = std::max(highest, along);
    if (n == 0) continue;
    const double change = glm::length(forces[n] - forces[n - 1]);
    out.largest_step = std::max(out.largest_step, change);
    squares += change * change;
  }
  const auto count = static_cast<double>(forces.size());
  if (forces.size() > 1) out.rms_step = std::sqrt(squares / (count - 1.0));
  out.mean = sum / count;
  out.ripple = sum > 0.0 ? (highest - lowest) * count / sum : std::numeric_limits<double>::quiet_NaN();
  return out;
}

std::size_t count_of_trials(const SlidingOptions& options, std::span<const SlidingSubject> subjects) noexcept {
  return options.tilts_deg.size() * options.depths_voxel.size() * subjects.size();
}

Result<std::vector<SlidingRow>> measure_sliding(const SlidingOptions& options, std::span<const SlidingSubject> subjects) {
  if (const Status ok = check(options); !ok) return ok.error();
  if (subjects.empty()) return Error{ErrorCode::out_of_range, "sliding needs a model", {}};
  Study own({}, count_of_trials(options, subjects));
  Study& study = options.study != nullptr ? *options.study : own;
  const auto file = read_file(tool_file(options));
  const std::string tool = file ? *file : std::string();
  std::vector<SlidingRow> rows;
  for (const double tilt : options.tilts_deg) {
    const Slope slope(tilt);
    auto rig = ContactRig::create(plate_of(options, slope.normal));
    if (!rig) return rig.error();
    const SlidingBone bone{rig->word_view(), rig->mesh_view(), rig->surface_view()};
    for (const double depth : options.depths_voxel)
      for (const SlidingSubject& subject : subjects) {
        const auto figures = study.run(trial_of(subject, tilt, depth, tool, options), [&]() -> Result<Study::Figures> {
          return slide(subject, bone, slope, depth * options.pitch, options);
        });
        if (!figures) return figures.error();
        const Study::Figures& f = *figures;
        rows.push_back({tilt, depth, subject.model, kSlidingStiffness * depth * options.pitch, f[0], f[1], f[2], f[3], f[4], f[5]});
      }
  }
  return rows;
}

namespace {

/// The lowest part of a bit, which touches. A shank outside the window would make the constrained tool wait for the window.
PointShell head_of(const PointShell& shell) {
  PointShell out;
  for (std::size_t n = 0; n < shell.size(); ++n) {
    if (shell.positions[n].z > kHead) continue;
    out.positions.push_back(shell.positions[n]);
    out.inward_normals.push_back(shell.inward_normals[n]);
    out.cutting.push_back(shell.cutting[n]);
  }
  return out;
}

/// The constrained tool at rest, with the hand at the pose.
Result<SlidingSubject> surface_subject(const PointShell& shell, double pitch) {
  ConstrainedToolConfig config;
  config.coupling_stiffness = kSlidingStiffness;
  config.coupling_damping = 0.0;
  config.turn_stiffness = std::numeric_limits<double>::infinity();
  auto made = ConstrainedTool::create(config, head_of(shell), pitch);
  if (!made) return made.error();
  const auto first = std::make_shared<const ConstrainedTool>(std::move(made).value());
  return SlidingSubject{"surface", [first](const SlidingBone& bone) -> ForceAt {
                          const auto tool = std::make_shared<ConstrainedTool>(*first);
                          const auto placed = std::make_shared<bool>(false);
                          return [tool, placed, view = &bone.surface](const Pose& pose) {
                            if (!*placed) {
                              // Into bone from above, as a hand moves: a tool placed inside bone would have no side to return to.
                              tool->place({pose.rotation, pose.translation + pose.rotate(Vec3(0.0, 0.0, kAir))});
                              for (int n = 0; n < kSettle; ++n) (void)tool->step(*view, {pose, Vec3(0.0)}, kPeriod);
                              *placed = true;
                            }
                            return tool->step(*view, {pose, Vec3(0.0)}, kPeriod).on_hand.force;
                          };
                        }};
}

/// The tool of the model `mesh` at rest, as surface_subject().
Result<SlidingSubject> held_mesh_subject(const PointShell& shell, double pitch) {
  const auto make = [head = head_of(shell), pitch] {
    return make_mesh_tool({.coupling_stiffness = kSlidingStiffness, .coupling_damping = 0.0}, head, {.voxel_edge = pitch, .planes = false});
  };
  if (auto tried = make(); !tried) return tried.error();
  return SlidingSubject{"mesh, held", [make](const SlidingBone& bone) -> ForceAt {
                          const std::shared_ptr<ContactModel> tool = make().value();
                          const auto placed = std::make_shared<bool>(false);
                          const auto step = [tool, view = &bone.mesh](const Pose& pose) {
                            const BoneView seen{.voxels = *view, .surface = {}, .world_from_bone = {}};
                            const HandMotion hand{pose, Vec3(0.0)};
                            ContactState out;
                            tool->step({.bone = seen, .hand = hand, .dt = kPeriod}, out);
                            return out.on_hand.force;
                          };
                          return [tool, placed, step](const Pose& pose) {
                            if (!*placed) {
                              tool->place({pose.rotation, pose.translation + pose.rotate(Vec3(0.0, 0.0, kAir))});
                              for (int n = 0; n < kSettle; ++n) (void)step(pose);
                              *placed = true;
                            }
                            return step(pose);
                          };
                        }};
}

}  // namespace

Result<std::vector<SlidingSubject>> sliding_subjects(const SlidingOptions& options) {
  Issues issues;
  auto tool = load_tool(tool_file(options), {.erosion_pitch = 1e-3}, issues);
  if (!tool) return issues.front();
  std::vector<SlidingSubject> subjects;
  const auto add = [&](const char* name, Result<std::unique_ptr<PenaltyModel>> made,
                       ContactView SlidingBone::*form = &SlidingBone::voxels) -> Status {
    if (!made) return made.error();
    const std::shared_ptr<const PenaltyModel> model = std::move(made).value();
    subjects.push_back({name, [model, form](const SlidingBone& bone) -> ForceAt {
                          auto result = std::make_shared<ContactResult>();
                          result->contacts.reserve(model->shell().size());
                          return [model, view = &(bone.*form), result](const Pose& pose) {
                            model->evaluate(*view, pose, *result);
                            return result->wrench.force;
                          };
                        }});
    return {};
  };
  const auto voxmap = [&](PlaneVoxel voxel, Stacking stacking) {
    return VoxmapContact::create({.stiffness = kSlidingStiffness, .stacking = stacking, .plane_voxel = voxel}, tool->shell);
  };
  auto surface = surface_subject(tool->shell, options.pitch);
  if (!surface) return surface.error();
  subjects.push_back(std::move(surface).value());
  if (const Status ok = add("gradient-plane", GradientPlane::create({.stiffness = kSlidingStiffness}, tool->shell)); !ok) return ok.error();
  if (const Status ok = add("voxmap, own voxel, sum limited", voxmap(PlaneVoxel::own, Stacking::sum_limited)); !ok) return ok.error();
  if (const Status ok = add("voxmap, surface voxel, average", voxmap(PlaneVoxel::surface, Stacking::average)); !ok) return ok.error();
  if (const Status ok = add("voxmap, surface voxel, deepest", voxmap(PlaneVoxel::surface, Stacking::deepest)); !ok) return ok.error();
  for (const auto& [name, stacking] : {std::pair{"mesh, deepest", MeshStacking::deepest}, {"mesh, average", MeshStacking::average}})
    if (const Status ok =
            add(name, MeshContact::create({.stiffness = kSlidingStiffness, .stacking = stacking}, tool->shell), &SlidingBone::mesh);
        !ok)
      return ok.error();
  auto held = held_mesh_subject(tool->shell, options.pitch);
  if (!held) return held.error();
  subjects.push_back(std::move(held).value());
  return subjects;
}

}  // namespace burrhole
