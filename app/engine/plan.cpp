#include "app/engine/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/engine/bone_step.h"
#include "app/engine/effect_names.h"
#include "app/engine/simulation.h"
#include "core/base/units.h"
#include "core/tool/cutting_field.h"

namespace burrhole {
namespace {

std::uint64_t window_voxels(const LoadedScene& loaded) {
  const BoneModel& bone = *loaded.bone;
  const Vec3 up = -loaded.scene.approach.axis;
  const Pose bone_from_tool{rotation_from_z(up), loaded.scene.approach.entry};
  const WindowMargins margins = window_margins(loaded.scene, bone.bone_from_index());
  return tool_box(loaded.tool, bone.bone_from_index().inverse() * Affine::from_pose(bone_from_tool), margins.placed).count();
}

PlanRow hand_row(const EffectInfo& effect, const LoadedScene& loaded) {
  return {effect, static_cast<double>(loaded.scene.servo_hz), 0,
          fmt::format("{:.0f} N, {:.2f} kg, {:.0f} N/m", loaded.scene.hand.push, loaded.scene.hand.dynamics.mass,
                      loaded.scene.hand.dynamics.stiffness)};
}

PlanRow device_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const SimulatedDeviceConfig& config = loaded.scene.device->config;
  return {effect, static_cast<double>(loaded.scene.servo_hz), sizeof(SimulatedDevice),
          fmt::format("{} in a {} hand, at most {:.3g} N, {:.3g} kg, {:.0f} um steps, {} ticks late, forces times {:.3g}", config.name,
                      loaded.scene.device->hand, config.largest_force, config.plant.body.mass, config.quantum * 1e6, config.delay,
                      force_scale_of(loaded.scene))};
}

PlanRow volume_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const Vec3i d = loaded.bone->dims();
  const std::uint64_t bytes = loaded.bone->bytes() + window_voxels(loaded) * 4 * sizeof(float);
  return {effect, 0.0, bytes,
          fmt::format("{} x {} x {} voxels of {:.3g} mm", d.x, d.y, d.z, 1e3 * loaded.bone->bone_from_index().mean_edge())};
}

std::string contact_text(const ContactScene& contact) {
  if (contact.model == ContactModelKind::surface)
    return fmt::format("surface, {}-bit records, tool held back by bone", contact.record_bits == RecordPrecision::bits8 ? 8 : 16);
  const bool voxmap = contact.model == ContactModelKind::voxmap;
  const bool paper = voxmap ? contact.voxmap.paper_mode : contact.gradient_plane.paper_mode;
  return fmt::format("{}, {} mode, {}", voxmap ? "voxmap" : "gradient-plane", paper ? "paper" : "surface",
                     contact.coupling ? "tool on a virtual coupling" : "tool where the hand is");
}

PlanRow contact_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const ContactScene& contact = *loaded.scene.contact;
  // Three copies, and once more what is made for them and the master window does not hold.
  const ContactFields fields = contact_fields(loaded.scene);
  ContactFields made = fields;
  made.density = made.gradient = false;
  const std::uint64_t copies = window_voxels(loaded) * (3 * bytes_a_voxel(fields) + bytes_a_voxel(made));
  const std::uint64_t shell = loaded.tool.shell.size() * (2 * sizeof(Vec3) + 1 + sizeof(Contact));
  return {effect, static_cast<double>(contact.rate_hz), copies + shell,
          fmt::format("{} points, {}", loaded.tool.shell.size(), contact_text(contact))};
}

const char* name_of(ErosionLaw law) {
  switch (law) {
    case ErosionLaw::rate:
      return "rate";
    case ErosionLaw::per_update:
      return "per-update";
    case ErosionLaw::energy:
      return "energy";
  }
  return "";
}

PlanRow erosion_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const ErosionConfig& erosion = loaded.scene.erosion->config;
  const std::uint64_t points = loaded.tool.erosion.size() * (sizeof(Vec3) + sizeof(float));
  // By points a float of exposure a voxel of the window; sub-voxel the tool's own field and a mask and its sleep a voxel where the bit has
  // been.
  const std::uint64_t field = erosion.subvoxel && loaded.tool.cutting ? loaded.tool.cutting->bytes() : 0;
  const std::uint64_t voxels = window_voxels(loaded) * (erosion.subvoxel ? sizeof(std::uint64_t) + sizeof(double) : sizeof(float));
  return {effect, static_cast<double>(loaded.scene.erosion->rate_hz), points + field + voxels,
          fmt::format("{} points, law {}{}", loaded.tool.erosion.size(), name_of(erosion.law), erosion.subvoxel ? ", sub-voxel" : "")};
}

PlanRow spindle_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const SpindleScene& spindle = *loaded.scene.spindle;
  return {effect, loaded.scene.erosion ? static_cast<double>(loaded.scene.erosion->rate_hz) : 0.0, sizeof(Spindle),
          fmt::format("{:.0f} rpm free, stalls at {:.3g} N m", loaded.scene.tool.spin / kRevPerMinute, spindle.stall_torque)};
}

/// What is in the shader beyond the light of the paper.
std::string looks_text(const LookView& looks) {
  std::string out;
  const auto add = [&out](bool on, const char* name) {
    if (on) out += std::string(", ") + name;
  };
  add(looks.tissue, "tissue");
  add(looks.occlusion, "ambient occlusion");
  add(looks.shadow, "shadow");
  add(looks.specular, "specular");
  add(!looks.labels, "one colour");
  add(looks.normals == NormalSource::recomputed, "normals recomputed");
  return out;
}

std::string method_text(const DisplayScene& display) {
  const std::string looks = looks_text(display.looks);
  if (!display.transfer.empty()) return fmt::format("{}, translucent{}", display.method, looks);
  if (display.method != "slices") return display.method + looks;
  return fmt::format("slices, {:g} a voxel{}{}", display.slices_per_voxel, display.opacity_correction ? "" : ", opacity a slice", looks);
}

/// What a picture shows beside the bone, and how often it is drawn.
std::string picture_text(const DisplayScene& display) {
  std::string out;
  if (display.cut.kind != CutKind::none) out += display.cut.kind == CutKind::tip ? ", cut at the tip" : ", cut at a plane";
  if (display.stereo.mode != StereoMode::off)
    out += fmt::format(", {} of two eyes {:.3g} mm apart",
                       display.stereo.mode == StereoMode::anaglyph     ? "anaglyph"
                       : display.stereo.mode == StereoMode::top_bottom ? "top-bottom"
                                                                       : "side-by-side",
                       display.stereo.separation / kMillimetre);
  return out + (display.scale_bar ? ", scale bar" : "");
}

PlanRow display_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const DisplayScene& display = *loaded.scene.display;
  const std::uint64_t a_voxel = kTexelBytes + sizeof(Rgba8) + (display.looks.tissue ? sizeof(TissueTexel) : 0);
  const std::uint64_t texels = loaded.bone->bounds().count() * a_voxel;
  const std::string budget = display.budget ? fmt::format(", quality for {:g} ms a picture", *display.budget * 1e3) : std::string();
  return {
      effect, 0.0, texels,
      fmt::format("{}{}, {} x {} pixels{}, at events", method_text(display), picture_text(display), display.width, display.height, budget)};
}

PlanRow record_row(const EffectInfo& effect, const LoadedScene& loaded) {
  const std::uint64_t per_second =
      session_columns(loaded.scene).size() * sizeof(double) * static_cast<std::uint64_t>(loaded.scene.servo_hz);
  return {effect, static_cast<double>(loaded.scene.servo_hz), per_second, "bytes of one second, committed every second"};
}

/// Stiffness of the coupling that the hand's and its own damping bear at this delay: K < (b + B) / (T/2 + d T), the linear rule for sampled
/// systems with delay [Gil et al. 2009]. It overstates the limit where most damping is virtual, by a fifth at the figures in use.
double bearable_coupling(const Scene& scene) {
  // Forces made at the servo's rate answer the motion of their own tick, however old the planes are that they are made from.
  const bool at_once = uses_planes(scene.servo.multi_rate.scheme);
  const double contact_period = 1.0 / (at_once ? scene.servo_hz : scene.contact->rate_hz);
  const double delay = at_once                             ? 0.0
                       : scene.contact->latency_ticks >= 0 ? static_cast<double>(scene.contact->latency_ticks) / scene.servo_hz
                                                           : contact_period;
  return 0.8 * (scene.hand.dynamics.damping + scene.contact->surface.coupling_damping) / (0.5 * contact_period + delay);
}

void warn_of_device(const Scene& scene, Plan& plan) {
  if (force_scale_of(scene) < 1.0)
    plan.warnings.push_back(
        fmt::format("[device] {} cannot show {:.0f} N: forces at the grip are {:.3g} times those of the drill; figures and "
                    "records are of the drill",
                    scene.device->config.name, scene.hand.push, force_scale_of(scene)));
  if (!scene.contact || !scene.contact->holds_back()) return;
  const auto model = find_device(scene.device->config.name);
  if (!model || (*model)->library_stiffness.provenance == Provenance::absent) return;
  const double coupling = scene.contact->surface.coupling_stiffness, most = (*model)->library_stiffness.value;
  const double shown = coupling * scene.device->position_scale * force_scale_of(scene);
  if (shown > most)
    plan.warnings.push_back(fmt::format("coupling_N_per_m = {:.0f} is {:.0f} N/m at the grip of {}, whose library allows {:.0f}", coupling,
                                        shown, scene.device->config.name, most));
}

void warn(const LoadedScene& loaded, Plan& plan) {
  const Scene& scene = loaded.scene;
  if (scene.device) warn_of_device(scene, plan);
  if (scene.contact && scene.contact->holds_back() && scene.erosion && scene.tool.spin > 0.0) {
    const double engaged = scene.hand.push / scene.contact->surface.cutting_stiffness;
    const double edge = loaded.bone->bone_from_index().mean_edge();
    if (engaged < edge)
      plan.warnings.push_back(
          fmt::format("engaged depth push_N / cutting_N_per_m = {:.3f} mm is under a voxel ({:.3f} mm): little will be cut; push with "
                      "{:.0f} N or more, "
                      "or take a finer spacing_mm",
                      1e3 * engaged, 1e3 * edge, std::ceil(edge * scene.contact->surface.cutting_stiffness)));
  }
  if (scene.contact && scene.contact->holds_back() && scene.hand.feels && !scene.device &&
      scene.contact->surface.coupling_stiffness > bearable_coupling(scene))
    plan.warnings.push_back(
        fmt::format("coupling_N_per_m = {:.0f} is more than the damping bears at this latency (about {:.0f}): the hand may swing",
                    scene.contact->surface.coupling_stiffness, bearable_coupling(scene)));
  if (scene.contact && scene.contact->holds_back() && scene.erosion && scene.tool.spin > 0.0 && !scene.erosion->config.subvoxel)
    plan.warnings.push_back(
        fmt::format("{} leaves walls as rough as a voxel, on which the model \"surface\" may hold the bit for good: {}",
                    scene.erosion->config.law == ErosionLaw::per_update ? "[erosion] law = \"per-update\"" : "[erosion] subvoxel = false",
                    scene.erosion->config.law == ErosionLaw::per_update ? "another law takes parts of voxels" : "leave it true"));
  if (scene.spindle && !(scene.erosion && scene.contact && scene.tool.spin > 0.0))
    plan.warnings.push_back("[spindle] without [contact], [erosion] and a spin: nothing loads it, so it does not slow");
  if (loaded.import)
    for (const std::string& line : loaded.import->scan.assumed) plan.warnings.push_back("[volume] assumed: " + line);
  if (scene.erosion && !scene.contact && scene.erosion->config.law == ErosionLaw::energy)
    plan.warnings.push_back("[erosion] law = \"energy\" without [contact]: there is no thrust, so nothing is removed");
  if (scene.erosion && !scene.contact)
    plan.warnings.push_back("no [contact]: the hand feels nothing and the tool goes where the script goes");
}

}  // namespace

const std::vector<EffectInfo>& known_effects() {
  static const std::vector<EffectInfo> effects{
      {"volume", Clock::simulation, "master window: slide, write back", "bone model", "window, store of record", false},
      {"hand", Clock::servo, "hand integrated exactly over a tick under the latest force", "contact state", "hand motion", false},
      {"device", Clock::servo, "simulated force device and the hand on it, integrated exactly over a tick", "force", "hand motion", true},
      {"contact", Clock::contact, "point shell against the window copy", "window copy, hand motion", "contact state", true},
      {"erosion", Clock::simulation, "erosion points along the tool's path, gradients, publishing", "window, contact state",
       "window copy, changed boxes", true},
      {"spindle", Clock::simulation, "speed under the cutting torque", "contact state", "spin", true},
      {"display", Clock::frame, "changed boxes to the texture, one picture", "changed boxes, tool pose", "pictures", true},
      {"record", Clock::frame, "session row", "everything above", "session file", true},
  };
  return effects;
}

const char* name_of(Clock clock) {
  switch (clock) {
    case Clock::servo:
      return "servo";
    case Clock::contact:
      return "contact";
    case Clock::simulation:
      return "simulation";
    case Clock::frame:
      return "frame";
  }
  return "";
}

Plan make_plan(const LoadedScene& loaded) {
  using MakeRow = PlanRow (*)(const EffectInfo&, const LoadedScene&);
  const Scene& scene = loaded.scene;
  const auto row_maker = [&](const std::string& table) -> MakeRow {
    if (table == "volume") return volume_row;
    if (table == "hand") return hand_row;
    if (table == "device" && scene.device) return device_row;
    if (table == "contact" && scene.contact) return contact_row;
    if (table == "erosion" && scene.erosion) return erosion_row;
    if (table == "spindle" && scene.spindle) return spindle_row;
    if (table == "display" && scene.display) return display_row;
    if (table == "record" && scene.record) return record_row;
    return nullptr;
  };
  Plan plan;
  for (const EffectInfo& effect : known_effects()) {
    if (const MakeRow make = row_maker(effect.table))
      plan.rows.push_back(make(effect, loaded));
    else
      plan.not_built.push_back(effect.table);
  }
  for (const std::string_view later : kLaterEffects) plan.not_built.emplace_back(later);
  warn(loaded, plan);
  return plan;
}

}  // namespace burrhole
