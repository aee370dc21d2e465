#include "app/lab/contact_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "app/lab/contact_rig.h"
#include "app/lab/oracle/contact_reference.h"
#include "app/report/file.h"
#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/units.h"
#include "core/mesh/mesh_contact.h"
#include "core/tool/make_tool.h"

namespace burrhole {
namespace {

struct LabTool {
  std::string name;
  std::string text;  // of its file
  PointShell shell;
  std::unique_ptr<PenaltyModel> planes, mesh, deepest;
};

Result<std::vector<LabTool>> load_tools(const ContactAccuracyOptions& options) {
  std::vector<LabTool> tools;
  for (const std::string& name : options.tools) {
    Issues issues;
    const std::string file = options.tool_folder + "/" + name + ".toml";
    // Erosion points are not used here: coarse ones are made quickly.
    auto tool = load_tool(file, {.erosion_pitch = 1e-3}, issues);
    if (!tool) return issues.front();
    auto text = read_file(file);
    if (!text) return text.error();
    auto model = GradientPlane::create(options.model, tool->shell);
    if (!model) return model.error();
    auto mesh = MeshContact::create({.stiffness = options.model.stiffness}, tool->shell);
    if (!mesh) return mesh.error();
    auto deepest = MeshContact::create({.stiffness = options.model.stiffness, .stacking = MeshStacking::deepest}, tool->shell);
    if (!deepest) return deepest.error();
    tools.push_back({name, std::move(text).value(), std::move(tool->shell), std::move(model).value(), std::move(mesh).value(),
                     std::move(deepest).value()});
  }
  return tools;
}

/// A bone to press on, and the direction out of it.
struct LabBone {
  std::string name;
  PhantomSpec spec;
  Vec3 out{0.0, 0.0, 1.0};
};

std::vector<LabBone> bones_of(const ContactAccuracyOptions& options) {
  PhantomSpec base;
  base.kind = PhantomKind::plate;
  base.pitch = options.pitch;
  base.seed = options.seed;
  base.extent = Vec3(22.0, 22.0, 15.0) * kMillimetre;                         // the 14 mm bit, tilted by 45 degrees
  base.above = std::ceil(6.0 * kMillimetre / options.pitch) * options.pitch;  // voxel faces on the surface of a level plate
  base.thickness = 4.0 * kMillimetre;
  std::vector<LabBone> bones{{"plate, level", base}};
  bones.push_back({"plate, level, 0.3 voxel off the grid", base});
  bones.back().spec.above += 0.3 * options.pitch;
  for (const int degrees : {10, 25, 45}) {
    const Vec3 out(portable_sin(degrees * kDegree), 0.0, portable_cos(degrees * kDegree));
    bones.push_back({fmt::format("plate, tilted {} deg", degrees), base, out});
    bones.back().spec.plate_normal = out;
  }
  for (const auto& [name, kind] : {std::pair{"sphere of 8 mm", PhantomKind::sphere}, {"wedge of 90 deg", PhantomKind::wedge}}) {
    bones.push_back({name, base});
    bones.back().spec.kind = kind;
    bones.back().spec.sphere_radius = 8.0 * kMillimetre;
  }
  const std::size_t clean = bones.size();
  for (std::size_t n = 0; n < clean && options.noise > 0.0; ++n) {
    bones.push_back(bones[n]);
    bones.back().name += fmt::format(", noise {:g} %", 100.0 * options.noise);
    bones.back().spec.noise = options.noise;
  }
  return bones;
}

/// Tool axis along the outward direction, rotated about it, up to half a voxel aside, the tip `depth` [m] below the surface.
Pose placed(const LabBone& bone, const ContactAccuracyOptions& options, double depth, int placement) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const auto at = 3 * static_cast<std::uint64_t>(placement);
  const double half_turn = 0.5 * std::numbers::pi * uniform11(seed, at);
  const Quat to_surface = rotation_from_z(bone.out);
  const Quat about_axis(portable_cos(half_turn), 0.0, 0.0, portable_sin(half_turn));
  const Vec3 aside = to_surface * (0.5 * options.pitch * Vec3(uniform11(seed, at + 1), uniform11(seed, at + 2), 0.0));
  return {to_surface * about_axis, aside - depth * bone.out};
}

constexpr const char* kShippedForm = "gradient-plane, words";
constexpr const char* kLawReference = "average over colliding points of closed-form depths";
constexpr const char* kDeepestReference = "largest closed-form depth";

/// Results of one setting, one value per placement (times: one per evaluation).
struct Samples {
  std::vector<double> own_law, translation;  // [%] of the reference force
  std::vector<double> own_law_voxel;         // force difference over stiffness, as a length
  std::vector<double> time_us;
};

/// A model with the form of the bone that it reads, and the closed form of its law.
struct BoneForm {
  const char* model;
  ContactView view;
  double bytes;
  std::unique_ptr<PenaltyModel> LabTool::*evaluated = &LabTool::planes;
  Vec3 (*law)(const Truth&, const PointShell&, const Pose&, double) noexcept = exact_average_force;
  const char* law_text = kLawReference;
};

Samples sample(const LabBone& bone, const Truth& truth, const BoneForm& form, const LabTool& tool, double depth,
               const ContactAccuracyOptions& options) {
  const PenaltyModel& model = *(tool.*form.evaluated);
  Samples out;
  ContactResult result;
  result.contacts.reserve(tool.shell.size());
  for (int n = 0; n < options.placements; ++n) {
    const Pose pose = placed(bone, options, depth, n);
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      const auto start = std::chrono::steady_clock::now();
      model.evaluate(form.view, pose, result);
      out.time_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    const double k = options.model.stiffness;
    const Vec3 law = form.law(truth, tool.shell, pose, k);
    const Vec3 translation = bone.out * (k * exact_translation_distance(truth, tool.shell, pose, bone.out));
    if (law == Vec3(0.0)) continue;  // beside the edge of the wedge the tip may be in air
    const double off_law = glm::length(result.wrench.force - law);
    out.own_law.push_back(100.0 * off_law / glm::length(law));
    out.own_law_voxel.push_back(off_law / (k * options.pitch));
    out.translation.push_back(100.0 * glm::length(result.wrench.force - translation) / glm::length(translation));
  }
  return out;
}

constexpr const char* kWayReference = "k x closed-form translation distance along the push";

struct ContactError {
  const char *name, *unit, *reference;  // null: that of the form's law
};
constexpr std::array kErrors{ContactError{"own_law_median", "%", nullptr}, ContactError{"own_law_worst", "%", nullptr},
                             ContactError{"own_law_worst_length", "voxel", nullptr}, ContactError{"translation_median", "%", kWayReference},
                             ContactError{"translation_worst", "%", kWayReference}};
constexpr std::size_t kFigures = kErrors.size() + 2;  // and the median and the 99th percentile of the times [us]

/// @returns the errors in the order of kErrors, then the times; NaN if the tool met no bone.
Study::Figures figures_of(const Samples& samples) {
  if (samples.own_law.empty()) return Study::Figures(kFigures, std::numeric_limits<double>::quiet_NaN());
  return {at_share(samples.own_law, 0.5),     at_share(samples.own_law, 1.0),     at_share(samples.own_law_voxel, 1.0),
          at_share(samples.translation, 0.5), at_share(samples.translation, 1.0), at_share(samples.time_us, 0.5),
          at_share(samples.time_us, 0.99)};
}

void add_rows(std::vector<CostRow>& rows, CostRow row, const Study::Figures& figures, const std::string& law_text) {
  if (std::isnan(figures.front())) return;
  row.median_us = figures[kErrors.size()];
  row.p99_us = figures[kErrors.size() + 1];
  for (std::size_t n = 0; n < kErrors.size(); ++n) {
    row.error_name = std::string(kErrors[n].name);
    row.error = figures[n];
    row.unit = std::string(kErrors[n].unit);
    row.reference = kErrors[n].reference == nullptr ? law_text : std::string(kErrors[n].reference);
    rows.push_back(row);
  }
}

StudyTrial trial_of(const std::string& name, const LabTool& tool, const ContactAccuracyOptions& options, std::size_t figures) {
  StudyTrial out{.key = {}, .name = name, .figures = figures};
  const GradientPlaneConfig& model = options.model;
  out.key.add("contact").add(name).add(tool.text).add(options.pitch).add(options.noise).add(static_cast<double>(options.seed));
  out.key.add(model.stiffness).add(model.paper_mode ? 1.0 : 0.0).add(model.max_march).add(model.max_ascent);
  return out;
}

Status measure_bone(const LabBone& bone, const std::vector<LabTool>& tools, const ContactAccuracyOptions& options, Study& study,
                    std::vector<CostRow>& rows) {
  auto rig = ContactRig::create(bone.spec);
  if (!rig) return rig.error();
  const BoneForm forms[] = {
      {kShippedForm, rig->word_view(), rig->word_bytes()},
      {"gradient-plane, floats", rig->float_view(), rig->float_bytes()},
      {"gradient-plane, vdb", rig->vdb_view(), std::numeric_limits<double>::quiet_NaN()},
      {"mesh", rig->mesh_view(), rig->mesh_bytes(), &LabTool::mesh},
      {"mesh, deepest", rig->mesh_view(), rig->mesh_bytes(), &LabTool::deepest, exact_deepest_force, kDeepestReference}};
  for (const LabTool& tool : tools)
    for (const double depth : options.depths_voxel)
      for (const BoneForm& form : forms) {
        CostRow common;
        common.subject = tool.name + " on " + bone.name;
        common.model = form.model;
        common.knob = "depth_voxel";
        common.setting = depth;
        common.bytes = form.bytes;
        StudyTrial trial = trial_of(fmt::format("{}, {:g} voxels deep, {}", common.subject, depth, form.model), tool, options, kFigures);
        trial.key.add(depth).add(options.placements).add(options.repeats);
        const auto figures = study.run(trial, [&]() -> Result<Study::Figures> {
          return figures_of(sample(bone, rig->truth(), form, tool, depth * options.pitch, options));
        });
        if (!figures) return figures.error();
        add_rows(rows, common, *figures, form.law_text);
      }
  return {};
}

constexpr int kCurveSteps = 380;      // to 1.9 mm, almost the middle of the plate
constexpr double kCurveStep = 0.005;  // [mm]
constexpr std::size_t kForces = 4;    // of a step: of the model, of its own law, of the translation distance, of the mesh

Study::Figures forces_of(const LabBone& level, const ContactRig& rig, const LabTool& tool, const ContactAccuracyOptions& options) {
  Study::Figures out;
  ContactResult result;
  for (int step = 1; step <= kCurveSteps; ++step) {
    const Pose pose = placed(level, options, step * kCurveStep * kMillimetre, 0);
    tool.planes->evaluate(rig.word_view(), pose, result);
    const double k = options.model.stiffness;
    out.push_back(glm::dot(result.wrench.force, level.out));
    out.push_back(glm::dot(exact_average_force(rig.truth(), tool.shell, pose, k), level.out));
    out.push_back(k * exact_translation_distance(rig.truth(), tool.shell, pose, level.out));
    tool.deepest->evaluate(rig.mesh_view(), pose, result);
    out.push_back(glm::dot(result.wrench.force, level.out));
  }
  return out;
}

Result<std::vector<ForceCurve>> measure_curves(const std::vector<LabTool>& tools, const ContactAccuracyOptions& options, Study& study) {
  const LabBone level = bones_of(options).front();
  auto rig = ContactRig::create(level.spec);
  if (!rig) return rig.error();
  std::vector<ForceCurve> curves;
  for (const LabTool& tool : tools) {
    const auto figures = study.run(trial_of(tool.name + " pressed into " + level.name, tool, options, kForces * kCurveSteps),
                                   [&]() -> Result<Study::Figures> { return forces_of(level, *rig, tool, options); });
    if (!figures) return figures.error();
    ForceCurve curve{tool.name, {}, {}, {}, {}, {}};
    for (std::size_t n = 0; n < figures->size(); n += kForces) {
      curve.depth_mm.push_back(static_cast<double>(n / kForces + 1) * kCurveStep);
      curve.model_N.push_back((*figures)[n]);
      curve.law_N.push_back((*figures)[n + 1]);
      curve.translation_N.push_back((*figures)[n + 2]);
      curve.mesh_N.push_back((*figures)[n + 3]);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

Status check(const ContactAccuracyOptions& options) {
  if (options.placements < 1 || options.repeats < 1) return Error{ErrorCode::out_of_range, "placements and repeats must be at least 1", {}};
  if (options.tools.empty() || options.depths_voxel.empty())
    return Error{ErrorCode::out_of_range, "contact accuracy needs a tool and a depth", {}};
  for (const double depth : options.depths_voxel)
    if (!(depth > 0.0 && depth * options.pitch < 2.0 * kMillimetre))
      return Error{ErrorCode::out_of_range, "a depth must be above 0 and under 2 mm, half the plate", {}};
  return {};
}

}  // namespace

double largest_loss_percent(const std::vector<double>& force) noexcept {
  double highest = 0.0, loss = 0.0;
  for (const double f : force) {
    highest = std::max(highest, f);
    if (highest > 0.0) loss = std::max(loss, 100.0 * (highest - f) / highest);
  }
  return loss;
}

std::size_t count_of_trials(const ContactAccuracyOptions& options) {
  constexpr std::size_t kForms = 5;
  return options.tools.size() * (bones_of(options).size() * options.depths_voxel.size() * kForms + 1);
}

Result<std::vector<ForceCurve>> measure_force_curves(const ContactAccuracyOptions& options) {
  auto tools = load_tools(options);
  if (!tools) return tools.error();
  Study study({}, tools->size());
  return measure_curves(*tools, options, study);
}

Result<ContactAccuracy> measure_contact_accuracy(const ContactAccuracyOptions& options) {
  if (const Status ok = check(options); !ok) return ok.error();
  auto tools = load_tools(options);
  if (!tools) return tools.error();
  Study own({}, count_of_trials(options));
  Study& study = options.study != nullptr ? *options.study : own;
  ContactAccuracy out;
  for (const LabBone& bone : bones_of(options))
    if (const Status measured = measure_bone(bone, *tools, options, study, out.rows); !measured) return measured.error();
  auto curves = measure_curves(*tools, options, study);
  if (!curves) return curves.error();
  out.curves = std::move(curves).value();
  for (const ForceCurve& curve : out.curves)
    for (const auto& [model, force] :
         {std::pair{kShippedForm, &curve.model_N}, {"exact average", &curve.law_N}, {"mesh, deepest", &curve.mesh_N}}) {
      CostRow row;
      row.subject = curve.tool + " pressed into plate, level";
      row.model = model;
      row.knob = "depth_mm";
      row.setting = curve.depth_mm.back();
      row.error_name = "force_lost";
      row.error = largest_loss_percent(*force);
      row.unit = std::string("%");
      row.reference = "largest force at a lesser depth";
      out.rows.push_back(row);
    }
  return out;
}

}  // namespace burrhole
