#include "app/engine/scene.h"

#include <filesystem>
#include <limits>

#include "app/engine/effect_names.h"
#include "core/base/units.h"
#include "haptics/servo/contact_age.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

NumberRule at_least_zero(double fallback, double to_si = 1.0, double max = 1e9) {
  return {.fallback = fallback, .min = 0.0, .max = max, .to_si = to_si};
}
NumberRule within(double fallback, double min, double max) { return {.fallback = fallback, .min = min, .max = max}; }
NumberRule above_zero(double fallback, double to_si = 1.0, double max = 1e9) {
  return {.fallback = fallback, .min = 0.0, .max = max, .min_open = true, .to_si = to_si};
}

std::string beside(const std::string& scene_file, const std::string& path) {
  const fs::path p(path);
  return p.is_absolute() ? path : (fs::path(scene_file).parent_path() / p).string();
}

std::optional<std::string> find_tool(const std::string& name, const std::string& scene_file, const SceneContext& context) {
  std::vector<std::string> places;
  const bool is_path = name.ends_with(".toml") || name.find('/') != std::string::npos;
  if (is_path) {
    places.push_back(beside(scene_file, name));
  } else {
    places.push_back(beside(scene_file, name + ".toml"));
    for (const std::string& folder : context.tool_folders) places.push_back((fs::path(folder) / (name + ".toml")).string());
  }
  for (const std::string& place : places)
    if (fs::is_regular_file(place)) return place;
  return std::nullopt;
}

std::vector<std::string> tool_names(const SceneContext& context) {
  std::vector<std::string> names;
  for (const std::string& folder : context.tool_folders) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  return names;
}

ToolScene read_tool(TableReader table, const std::string& file, const SceneContext& context) {
  ToolScene out;
  out.place = table.place_of("name");
  const std::string name =
      table.text("name", std::nullopt, "name of a tool beside the scene or among the shipped ones, or path of a tool file");
  if (!name.empty() && !context.tool_given) {
    if (const auto path = find_tool(name, file, context)) {
      out.path = *path;
    } else {
      const auto near = nearest_name(name, tool_names(context));
      table.fault("name", std::string("is no tool") + (near ? "; did you mean \"" + *near + "\"?" : " (burrhole tools lists them)"));
    }
  }
  out.spin = table.number("spin_rpm", {.fallback = std::nullopt, .min = 0.0, .max = 200e3, .to_si = kRevPerMinute}, "speed of the spindle");
  out.erosion_scale = table.number("erosion_scale", at_least_zero(1.0, 1.0, 1e6), "multiplies every erosion factor of the tool");
  table.finish();
  return out;
}

ApproachScene read_approach(TableReader table) {
  ApproachScene out;
  out.place = table.place_of("entry_mm");
  const NumberRule length{.fallback = std::nullopt, .min = -1e5, .max = 1e5, .to_si = kMillimetre};
  out.entry =
      table.vector("entry_mm", std::nullopt, length, "point near the outer surface, bone frame; it is moved onto the bone along the axis");
  const Vec3 axis = table.vector("axis", Vec3(0, 0, -1), {.fallback = 0.0, .min = -1e6, .max = 1e6},
                                 "direction of the drill into bone, bone frame, of any length but 0");
  if (glm::length(axis) < 1e-9)
    table.fault("axis", "has no length");
  else
    out.axis = glm::normalize(axis);
  table.finish();
  return out;
}

HandConfig read_hand(TableReader table, Issues& issues) {
  HandConfig out;
  const std::size_t before = issues.size();
  const std::string kind = table.text("kind", "script", "who holds the drill");
  if (kind == "device") {
    issues.push_back({ErrorCode::unavailable, "hand.kind = \"device\" needs a force device; this version knows none, only \"script\"",
                      table.place_of("kind")});
  } else if (issues.size() == before) {
    (void)table.choice("kind", "script", {"script"}, "who holds the drill", {"device", "mouse", "replay"});
  }
  out.dynamics.mass = table.number("mass_kg", above_zero(out.dynamics.mass, 1.0, 10.0), "mass of hands and drill");
  out.dynamics.damping = table.number("damping_N_s_per_m", at_least_zero(out.dynamics.damping, 1.0, 1e4), "damping of the arm");
  out.dynamics.stiffness = table.number("stiffness_N_per_m", at_least_zero(out.dynamics.stiffness, 1.0, 1e5), "stiffness of the arm");
  out.feed = table.number("feed_mm_per_s", above_zero(5.0, kMillimetre, 1e3), "speed of approach; withdrawal is twice as fast");
  out.push = table.number("push_N", at_least_zero(out.push, 1.0, 500.0), "thrust while leaning on the drill");
  out.ramp = table.number("ramp_s", at_least_zero(out.ramp, 1.0, 60.0), "time from first contact to full thrust");
  out.reaction = table.number("reaction_ms", at_least_zero(150.0, 1e-3, 1e4), "time from feeling the give to letting go");
  out.release = table.number("release_s", at_least_zero(out.release, 1.0, 60.0), "time over which the thrust then falls to nothing");
  out.contact_force = table.number("contact_N", above_zero(out.contact_force, 1.0, 100.0), "felt force that counts as contact");
  out.give_speed = table.number("give_mm_per_s", above_zero(8.0, kMillimetre, 1e3), "speed of advance that feels like breaking through");
  out.follow_time = table.number("follow_s", above_zero(out.follow_time, 1.0, 60.0),
                                 "time constant with which the arm's rest position follows the drill");
  out.standoff = table.number("standoff_mm", above_zero(3.0, kMillimetre, 100.0), "height above the entry at start and end");
  out.tremor_amplitude = table.number("tremor_mm", at_least_zero(0.04, kMillimetre, 5.0), "peak of the lateral tremor");
  out.tremor_frequency = table.number("tremor_hz", at_least_zero(9.0, 1.0, 50.0), "frequency of the tremor");
  out.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, INT64_MAX, "seed of the tremor's phases"));
  out.feels = table.boolean("feels", true, "whether the force reaches the hand; false is for comparison");
  table.finish();
  return out;
}

// Bone that is felt again under a hand that sank into it lifts that hand, and must give out what its spring takes. A return within 0.2 s
// gives no more than a slower one; at once it gives four times as much, and throws the hand (docs/servo.md).
constexpr double kSoftReturn = 0.2;  // [s]
constexpr double kJumpSpeed = 5.0;   // [m/s] of a hand: the quickest strokes of the hard cases have 1.25

/// [servo]: all that can be left as it is, so the table may be missing.
ServoConfig shipped_servo() {
  ServoConfig out;
  out.multi_rate.scheme = MultiRateScheme::planes;
  out.soft_start = kSoftReturn;
  out.soft_stop = 0.05;
  out.jump_speed = kJumpSpeed;
  return out;
}

ServoConfig read_servo(TableReader table) {
  ServoConfig out = shipped_servo();
  const std::string scheme = table.choice(
      "multirate", "planes", {"planes", "gradient", "hold", "linear"},
      "how forces are made between two contact results: from the planes of the last one, from its gradient, held, or on a line to it");
  out.multi_rate.scheme = scheme == "planes"     ? MultiRateScheme::planes
                          : scheme == "gradient" ? MultiRateScheme::gradient
                          : scheme == "hold"     ? MultiRateScheme::hold
                                                 : MultiRateScheme::linear;
  out.multi_rate.max_distance = table.number("reach_mm", above_zero(out.multi_rate.max_distance / kMillimetre, kMillimetre, 100.0),
                                             "how far from its pose planes and gradient are believed");
  out.largest_force = table.number("force_N", above_zero(out.largest_force, 1.0, 1e4), "largest force that reaches the hand");
  out.largest_slew = table.number("slew_N_per_s", at_least_zero(0.0, 1.0, 1e9), "largest change of it; 0 for no limit");
  out.soft_start =
      table.number("soft_start_s", at_least_zero(out.soft_start, 1.0, 60.0),
                   "time from no force to all of it, at the start, after a fault and after a jump; none where nothing is felt");
  out.soft_stop = table.number("soft_stop_s", at_least_zero(out.soft_stop, 1.0, 60.0),
                               "time in which it fades when contact is late or a stop is asked for");
  out.jump_speed = table.number("jump_m_per_s", at_least_zero(out.jump_speed, 1.0, 1e3),
                                "speed beyond which the hand did not move but is told elsewhere; 0 for none");
  out.energy.damping =
      table.number("relied_on_N_s_per_m", at_least_zero(0.0, 1.0, 1e4), "damping of device and hand that the energy detector may rely on");
  out.energy.tolerance = table.number("energy_mJ", at_least_zero(0.0, 1e-3, 1e6),
                                      "energy that the loop may give out beyond what is swallowed before it is a fault; 0 for no detector");
  out.energy.largest_damping = table.number("passivity_N_s_per_m", at_least_zero(0.0, 1.0, 1e4),
                                            "most damping that the passivity controller may add while energy is owed; 0 for none");
  table.finish();
  return out;
}

DeviceScene read_device(TableReader table, Issues& issues) {
  DeviceScene out;
  const std::string name = table.text("name", "generic", "simulated device, one that the command devices lists");
  const std::string hand = table.text("hand", "nominal", "who holds it: none, light, nominal, firm or arm");
  const auto model = find_device(name);
  const auto holder = find_hand(hand);
  if (!model) issues.push_back(bad_input(model.error().message, table.place_of("name")));
  if (!holder) issues.push_back(bad_input(holder.error().message, table.place_of("hand")));
  if (model && holder) out.config = make_simulated_config(**model, **holder);
  out.hand = hand;
  SimulatedDeviceConfig& config = out.config;
  out.position_scale = table.number("position_scale", above_zero(1.0, 1.0, 100.0), "millimetres of the drill for one of the grip");
  if (table.has("force_scale"))
    out.force_scale =
        table.number("force_scale", above_zero(1.0, 1.0, 1.0), "newtons at the grip for one of the drill; left out: fitted to the push");
  config.plant.body.mass = table.number("mass_kg", above_zero(config.plant.body.mass, 1.0, 10.0), "mass of device and hand");
  config.plant.body.damping = table.number("damping_N_s_per_m", at_least_zero(config.plant.body.damping, 1.0, 1e4), "their damping");
  config.plant.body.stiffness =
      table.number("stiffness_N_per_m", at_least_zero(config.plant.body.stiffness, 1.0, 1e5), "the hand's stiffness");
  config.plant.friction = table.number("friction_N", at_least_zero(config.plant.friction, 1.0, 10.0), "Coulomb friction on each axis");
  config.quantum =
      table.number("step_mm", at_least_zero(config.quantum / kMillimetre, kMillimetre, 10.0), "step of the positions that it tells");
  config.largest_force = table.number("force_N", above_zero(config.largest_force, 1.0, 1e3), "most force that it can show");
  config.delay =
      static_cast<int>(table.integer("delay_ticks", config.delay, 0, kMaxReadingDelay, "servo ticks by which its positions are late"));
  table.finish();
  return out;
}

constexpr const char* kModeText = "what collides: the 0.5 surface of the bone, or, as in the papers, any density above 0";
constexpr const char* kStiffnessText = "stiffness of the penalty force, over the depth of a point";

LabelFactors read_label_stiffness(TableReader table) {
  LabelFactors out = kAllAlike;
  const auto read = [&](VoxelLabel label, std::string_view key, std::string_view about) {
    out[static_cast<std::size_t>(label)] = static_cast<float>(table.number(key, {.fallback = 1.0, .min = 0.01, .max = 1.0}, about));
  };
  read(VoxelLabel::bone, "bone", "bone whose layers are not told apart: scans and simple phantoms");
  read(VoxelLabel::outer_table, "outer_table", "outer table of the skull");
  read(VoxelLabel::diploe, "diploe", "diploe between the tables");
  read(VoxelLabel::inner_table, "inner_table", "inner table of the skull");
  read(VoxelLabel::forbidden, "forbidden", "bone marked as not to be cut");
  table.finish();
  return out;
}

/// The model `surface`.
void read_surface(TableReader& table, ContactScene& out) {
  ConstrainedToolConfig& tool = out.surface;
  tool.coupling_stiffness =
      table.number("coupling_N_per_m", above_zero(tool.coupling_stiffness, 1.0, 1e6), "stiffness of the spring from hand to tool");
  tool.coupling_damping = table.number("coupling_N_s_per_m", at_least_zero(tool.coupling_damping, 1.0, 1e4), "damper from hand to tool");
  const bool locked = table.choice("turning", "free", {"free", "locked"},
                                   "whether bone may turn the tool in the hand against a spring, or the hand alone turns it") == "locked";
  if (locked)
    tool.turn_stiffness = std::numeric_limits<double>::infinity();
  else
    tool.turn_stiffness = table.number("coupling_Nm_per_rad", above_zero(tool.turn_stiffness, 1.0, 1e6),
                                       "stiffness of that spring; damped with the time constant of the other one");
  tool.cutting_stiffness = table.number("cutting_N_per_m", above_zero(tool.cutting_stiffness, 1.0, 1e9),
                                        "thrust over the depth to which a spinning tool is engaged");
  tool.bone_stiffness = table.number("bone_N_per_m", above_zero(tool.bone_stiffness, 1.0, 1e12),
                                     "stiffness of bone of hardness 1 under a point that does not cut; in proportion to the hardness");
  if (auto labels =
          table.table("label_stiffness", "factors on that stiffness by tissue, so that a layer gives more than its hardness says"))
    out.label_stiffness = read_label_stiffness(*labels);
  out.record_bits =
      table.choice("record_bits", "16", {"8", "16"}, "bits of each number stored of the surface: memory against accuracy") == "8"
          ? RecordPrecision::bits8
          : RecordPrecision::bits16;
}

/// The model `gradient-plane`.
void read_gradient_plane(TableReader& table, ContactScene& out) {
  out.gradient_plane.paper_mode = table.choice("mode", "surface", {"surface", "paper"}, kModeText) == "paper";
  out.gradient_plane.stiffness = table.number("stiffness_N_per_m", above_zero(out.gradient_plane.stiffness, 1.0, 1e7), kStiffnessText);
  out.storage = table.choice("storage", "window", {"window", "vdb"},
                             "where bone is looked up: in a dense window, or in sparse grids as in the paper") == "vdb"
                    ? ContactStorage::vdb
                    : ContactStorage::window;
}

/// The model `voxmap`.
void read_voxmap(TableReader& table, ContactScene& out) {
  VoxmapContactConfig& voxmap = out.voxmap;
  voxmap.paper_mode = table.choice("mode", "surface", {"surface", "paper"}, kModeText) == "paper";
  voxmap.stiffness = table.number("stiffness_N_per_m", above_zero(voxmap.stiffness, 1.0, 1e7), kStiffnessText);
  const std::string stacking = table.choice("stacking", "sum-limited", {"sum", "sum-limited", "average", "deepest"},
                                            "how the forces of many points become one; sum-limited divides by n/10 above ten points");
  voxmap.stacking = stacking == "sum"       ? Stacking::sum
                    : stacking == "average" ? Stacking::average
                    : stacking == "deepest" ? Stacking::deepest
                                            : Stacking::sum_limited;
  voxmap.plane_voxel =
      table.choice("plane", "own", {"own", "surface"},
                   "the voxel that the tangent plane runs through: the point's own, or the last solid one along its vector") == "own"
          ? PlaneVoxel::own
          : PlaneVoxel::surface;
}

/// Virtual coupling of the penalty models.
void read_coupling(TableReader& table, ContactScene& out) {
  if (table.choice("coupling", "none", {"none", "virtual"},
                   "whether the tool is where the hand is, or a body of its own on a spring and damper") == "none")
    return;
  VirtualCouplingConfig& coupling = out.coupling.emplace();
  coupling.stiffness = table.number("coupling_N_per_m", within(coupling.stiffness, 1.0, 1e6), "stiffness of the spring from hand to tool");
  coupling.damping = table.number("coupling_N_s_per_m", at_least_zero(coupling.damping, 1.0, 1e4), "damper from hand to tool");
  coupling.angular_stiffness =
      table.number("coupling_Nm_per_rad", within(coupling.angular_stiffness, 1e-6, 1e4), "stiffness of that spring against turning");
  coupling.angular_damping =
      table.number("coupling_Nm_s_per_rad", at_least_zero(coupling.angular_damping, 1.0, 100.0), "damper against turning");
  coupling.mass = table.number("mass_kg", within(coupling.mass, 1e-6, 100.0), "mass of the body on the spring");
  coupling.inertia = table.number("inertia_kg_m2", within(coupling.inertia, 1e-12, 10.0), "its inertia, the same about every axis");
}

ContactScene read_contact(TableReader table) {
  ContactScene out;
  const std::string model = table.choice(
      "model", "surface", {"surface", "gradient-plane", "voxmap"},
      "how a touch becomes a force: the tool held back by the bone's surface, or a penalty by planes from the density's gradient "
      "or across the tool's own vectors; a strong push goes through a penalty",
      {"mesh"});
  if (model == "surface") {
    read_surface(table, out);
  } else if (model == "gradient-plane") {
    out.model = ContactModelKind::gradient_plane;
    read_gradient_plane(table, out);
    read_coupling(table, out);
  } else {
    out.model = ContactModelKind::voxmap;
    read_voxmap(table, out);
    read_coupling(table, out);
  }
  out.rate_hz = static_cast<int>(table.integer("rate_hz", 1000, 20, 20000, "contact evaluations a second; divides servo_hz"));
  out.latency_ticks =
      static_cast<int>(table.integer("latency_ticks", -1, -1, 1000, "servo ticks from a motion to its force; -1 for one contact period"));
  table.finish();
  return out;
}

SpindleScene read_spindle(TableReader table) {
  SpindleScene out;
  out.stall_torque =
      table.number("stall_torque_Nm", above_zero(out.stall_torque, 1.0, 1e3), "cutting torque under which the spindle stands still");
  out.inertia = table.number("inertia_kg_m2", at_least_zero(out.inertia, 1.0, 1.0), "of all that turns, seen at the bit");
  table.finish();
  return out;
}

ErosionScene read_erosion(TableReader table, double& pitch_voxels) {
  ErosionScene out;
  const std::string law = table.choice(
      "law", "rate", {"rate", "per-update", "energy"},
      "how erosion adds up: at a rate, update by update as eq. 4 of the paper is printed, or by the cutting power of thrust and spin");
  out.config.law = law == "rate" ? ErosionLaw::rate : law == "energy" ? ErosionLaw::energy : ErosionLaw::per_update;
  if (out.config.law != ErosionLaw::per_update)
    out.config.subvoxel = table.boolean(
        "subvoxel", true, "whether a voxel that the tool covers in part goes in part: the wall of the hole is then where the tool was");
  if (out.config.subvoxel)
    out.config.clear_below = static_cast<float>(table.number(
        "clear_below", {.fallback = 0.5, .min = 0.0, .max = 0.5},
        "part of its covered share below which a voxel at the wall is cleared: 0.5 keeps the wall from holding the tool, 0 removes "
        "mass exactly by the law"));
  if (out.config.law == ErosionLaw::energy) {
    EnergyConfig& energy = out.config.energy;
    energy.specific_energy = table.number("specific_energy_J_per_mm3", above_zero(energy.specific_energy * 1e-9, 1e9, 1e3),
                                          "energy that a volume of bone of hardness 1 takes to remove; in proportion to the hardness");
    energy.cutting_ratio = table.number("cutting_ratio", above_zero(energy.cutting_ratio, 1.0, 10.0), "cutting force over normal force");
  }
  out.config.minimum_density = static_cast<float>(table.number(
      "minimum_density", {.fallback = 0.05, .min = 0.0, .max = 0.5, .max_open = true}, "density below which a voxel becomes empty"));
  out.config.longest_substep = table.number("substep_voxels", {.fallback = 0.5, .min = 0.0, .max = 1.0, .min_open = true},
                                            "longest path of the tool between two applications of the law");
  out.rate_hz = static_cast<int>(table.integer("rate_hz", 100, 1, 20000, "erosion steps a second; divides servo_hz"));
  pitch_voxels =
      table.number("point_pitch_voxels", {.fallback = 0.5, .min = 0.1, .max = 1.0}, "distance between the tool's erosion points");
  table.finish();
  return out;
}

/// Corners of [[display.transfer]]; without any, a bone that glows through where it is thin.
TransferFunction read_transfer(TableReader& table) {
  TransferFunction out;
  for (TableReader& row :
       table.tables("transfer", "corners of the line from density to what it does to light; by their default bone is hazy")) {
    TransferPoint point;
    point.density = row.number("density", {.fallback = std::nullopt, .min = 0.0, .max = 1.0}, "of bone, as left: 0 none, 1 whole");
    point.extinction = row.number("opacity_per_mm", {.fallback = std::nullopt, .min = 0.0, .max = 1000.0, .to_si = 1.0 / kMillimetre},
                                  "light falls by exp(-this) a millimetre");
    const auto tint = row.numbers("tint", std::vector<double>{1.0, 1.0, 1.0}, 3, {.min = 0.0, .max = 1.0},
                                  "red, green and blue, times the tissue's own colour");
    point.tint = Vec3(tint[0], tint[1], tint[2]);
    if (!out.empty() && point.density <= out.back().density) row.fault("density", "must be larger than the one before");
    row.finish();
    out.push_back(point);
  }
  if (out.empty()) out = {{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 0.25 / kMillimetre}};
  return out;
}

/// What a picture may cost, key by key or by a budget; `rays`: bone is drawn by rays, `finish`: by its surface.
void read_quality(TableReader& table, bool rays, bool finish, DisplayScene& out) {
  const std::string choice = table.choice("quality", "fixed", {"fixed", "auto"},
                                          "by the keys of this table, or the best that this machine draws within budget_ms");
  if (choice == "auto") {
    if (!rays) table.fault("quality", "is for method = \"raycast\"");
    out.budget = table.number("budget_ms", above_zero(100.0, 1e-3, 1e5), "time of a picture that the quality is chosen for");
    for (const char* key : {"step_voxels", "bisections", "finish", "supersample", "resolution"})
      if (table.has(key)) table.fault(key, "is what quality = \"auto\" chooses: leave out one of the two");
    return;
  }
  DrawingQuality& quality = out.quality;
  if (rays)
    quality.step_voxels =
        table.number("step_voxels", {.fallback = 0.5, .min = 0.0, .max = 1.0, .min_open = true}, "distance of samples along a ray");
  if (finish) {
    quality.bisections =
        static_cast<int>(table.integer("bisections", quality.bisections, 0, 16, "halvings of the step in which a ray met bone"));
    quality.finish = table.boolean("finish", true, "smooth normals, and ambient occlusion if it is on; false: the light alone");
  }
  quality.supersample =
      static_cast<int>(table.integer("supersample", quality.supersample, 1, 4, "rays along each side of a pixel, which smooth edges"));
  quality.resolution =
      table.number("resolution", {.fallback = 1.0, .min = 0.25, .max = 1.0}, "share of width and height that is drawn, then enlarged");
}

/// Keys of light and tissue. What only an opaque surface drawn by rays can show is asked for there alone.
LookView read_looks(TableReader& table, bool surface, bool translucent) {
  LookView out;
  out.labels = table.boolean("label_colours", true, "colours by tissue and mineral density; false: all of one ivory");
  if (!translucent && table.choice("normals", "texture", {"texture", "recomputed"},
                                   "from the normals sent, or from differences of the density") == "recomputed")
    out.normals = NormalSource::recomputed;
  if (!surface) return out;
  out.tissue = table.choice("tissue", "procedural", {"procedural", "plain"},
                            "old surface unlike cut bone, pores in diploe, vessels on dura; or plain colours") == "procedural";
  out.occlusion = table.boolean("ambient_occlusion", true, "less light in hollows");
  out.shadow = table.boolean("shadow", false, "bone throws a shadow on bone");
  out.specular = table.boolean("specular", false, "the glint of a wet surface");
  return out;
}

Vec3 read_color(TableReader& table, const char* key, const Vec3& fallback, const char* about) {
  const auto rgb = table.numbers(key, std::vector<double>{fallback.x, fallback.y, fallback.z}, 3, {.min = 0.0, .max = 1.0}, about);
  return {rgb[0], rgb[1], rgb[2]};
}

CutScene read_cut(TableReader& table) {
  CutScene out;
  const std::string kind = table.choice("cut", "none", {"none", "plane", "tip"},
                                        "cuts pictures open: at a plane, or at the depth of the tool's tip, square to the view");
  if (kind == "none") return out;
  out.kind = kind == "tip" ? CutKind::tip : CutKind::plane;
  if (out.kind == CutKind::tip) return out;
  const NumberRule millimetres{.fallback = std::nullopt, .min = -5000.0, .max = 5000.0, .to_si = kMillimetre};
  const auto point = table.numbers("cut_point_mm", std::nullopt, 3, millimetres, "a point of the plane, in the bone's frame");
  const auto normal = table.numbers("cut_normal", std::nullopt, 3, {.fallback = std::nullopt, .min = -1e6, .max = 1e6},
                                    "towards the side that is cut away, in the bone's frame; of any length but 0");
  out.point = {point[0], point[1], point[2]};
  out.normal = {normal[0], normal[1], normal[2]};
  if (glm::length(out.normal) == 0.0) table.fault("cut_normal", "must not be zero");
  return out;
}

StereoView read_stereo(TableReader& table, double distance) {
  StereoView out;
  const std::string mode =
      table.choice("stereo", "off", {"off", "side-by-side", "top-bottom", "anaglyph"},
                   "two eyes in one picture, each of `size`; an anaglyph is for red and cyan glasses", {"quad-buffered"});
  if (mode == "off") return out;
  out.mode = mode == "anaglyph" ? StereoMode::anaglyph : mode == "top-bottom" ? StereoMode::top_bottom : StereoMode::side_by_side;
  out.separation = table
                       .optional_number("eye_separation_mm", above_zero(0.0, kMillimetre, 200.0),
                                        "between the eyes; a thirtieth of distance_mm unless said")
                       .value_or(distance / 30.0);
  out.screen = table
                   .optional_number("screen_mm", above_zero(0.0, kMillimetre, 5000.0),
                                    "from the eyes to the plane that seems to lie in the screen; distance_mm unless said")
                   .value_or(distance);
  return out;
}

DisplayScene read_display(TableReader table) {
  DisplayScene out;
  out.method = table.choice("method", "raycast", {"raycast", "slices"},
                            "how bone is drawn: by rays to its surface, or by slices blended back to front", {"mesh"});
  if (out.method == "raycast") {
    const std::string shading = table.choice("shading", "surface", {"surface", "translucent"},
                                             "bone as an opaque surface, or as a body that light passes, by a transfer function");
    if (shading == "translucent") out.transfer = read_transfer(table);
  }
  if (out.method == "slices") {
    out.slices_per_voxel = table.number("slices_per_voxel", {.fallback = 1.0, .min = 0.0, .max = 8.0, .min_open = true},
                                        "slices for each voxel along the view's axis");
    out.opacity_correction = table.boolean(
        "opacity_correction", true, "opacity is per voxel edge, whatever the distance between slices; false: per slice, as in the paper");
  }
  read_quality(table, out.method == "raycast", out.method == "raycast" && out.transfer.empty(), out);
  out.looks = read_looks(table, out.method == "raycast" && out.transfer.empty(), !out.transfer.empty());
  out.background.top = read_color(table, "background_top", out.background.top, "red, green and blue behind the upper edge");
  out.background.bottom = read_color(table, "background_bottom", out.background.bottom, "and behind the lower edge");
  const auto size =
      table.numbers("size", std::vector<double>{1200, 900}, 2, {.min = 16, .max = 8192}, "width and height of a picture in pixels");
  out.width = static_cast<int>(size[0]);
  out.height = static_cast<int>(size[1]);
  out.upload_budget = static_cast<std::size_t>(table.integer("upload_budget_kb", 65536, 1, 4'000'000,
                                                             "changed texels sent for one picture; the rest follows with the next ones")) *
                      1024;
  out.upload_time = table.number("upload_budget_ms", {.fallback = 0.0, .min = 0.0, .max = 1000.0, .to_si = 1e-3},
                                 "time for making them, by the clock, so pictures may differ from run to run; 0: as long as it takes");
  out.azimuth = table.number("azimuth_deg", {.fallback = 35.0, .min = -360, .max = 360, .to_si = kDegree},
                             "angle of the camera round the axis, from the patient's -y");
  out.elevation = table.number("elevation_deg", {.fallback = 42.0, .min = -89, .max = 89, .to_si = kDegree},
                               "angle of the camera above the entry's tangent plane");
  out.distance = table.number("distance_mm", above_zero(74.0, kMillimetre, 5000.0), "distance of the camera from the entry");
  out.scale_bar = table.boolean("scale_bar", true, "a bar of a length that fits, as it looks at the distance of the point looked at");
  out.cut = read_cut(table);
  out.stereo = read_stereo(table, out.distance);
  table.finish();
  return out;
}

/// Rates must divide the servo rate: every step then falls on a tick.
void check_rates(const Scene& scene, TableReader& root) {
  const auto check = [&](const char* name, int rate) {
    auto table = root.table(name, "");
    if (table && scene.servo_hz % rate != 0) table->fault("rate_hz", "must divide servo_hz = " + std::to_string(scene.servo_hz));
  };
  if (scene.contact) check("contact", scene.contact->rate_hz);
  if (scene.erosion) check("erosion", scene.erosion->rate_hz);
}

void set_servo_rates(Scene& scene) {
  const int contact_hz = scene.contact ? scene.contact->rate_hz : scene.servo_hz;
  ServoConfig& servo = scene.servo;
  servo.period = 1.0 / scene.servo_hz;
  servo.multi_rate.contact_ticks = std::max(1, scene.servo_hz / std::max(1, contact_hz));
  servo.max_contact_age = contact_age_limit(servo.multi_rate.contact_ticks, servo.period);
  // Where a scene's own latency makes results old by design, that is no fault.
  if (scene.contact && scene.contact->latency_ticks > 0) servo.max_contact_age += static_cast<std::uint64_t>(scene.contact->latency_ticks);
  if (!scene.contact) servo.max_contact_age = 0;
}

}  // namespace

std::optional<Scene> read_scene(const TomlDocument& document, const SceneContext& context, Issues& issues, KeyLog* log) {
  const std::size_t before = issues.size();
  Scene scene;
  scene.file = document.file_name();
  scene.text = document.to_text();
  TableReader root = document.root(issues, log);
  scene.title = root.text("title", "", "what the scene is, in one line");
  scene.duration = root.number("duration_s", above_zero(120.0, 1.0, 3600.0), "simulated time after which the run ends at the latest");
  scene.servo_hz = static_cast<int>(root.integer("servo_hz", 1000, 100, 20000, "servo ticks a second; every other rate divides it"));

  const auto required = [&](const char* name, const char* about) {
    auto table = root.table(name, about);
    if (!table) root.fault(name, "is missing: every scene needs this table");
    return table;
  };
  if (auto table = required("volume", "the bone; every scene has it")) scene.volume = read_volume(*table, scene.file);
  if (auto table = required("tool", "the bit and its spindle; every scene has it")) scene.tool = read_tool(*table, scene.file, context);
  if (auto table = required("approach", "where the drill enters, and which way; every scene has it"))
    scene.approach = read_approach(*table);
  if (auto table = required("hand", "who holds the drill, and how; every scene has it")) scene.hand = read_hand(*table, issues);
  scene.servo = shipped_servo();
  if (auto table = root.table("servo", "how forces are made and limited at the servo's rate; every scene has it, with these values"))
    scene.servo = read_servo(*table);
  if (auto table = root.table("device", "a simulated force device between hand and drill; without it the hand holds the drill itself"))
    scene.device = read_device(*table, issues);
  if (auto table = root.table("contact", "force feedback; without it bone is not felt")) scene.contact = read_contact(*table);
  if (auto table = root.table("erosion", "drilling; without it no bone is removed"))
    scene.erosion = read_erosion(*table, scene.tool.erosion_pitch_voxels);
  if (auto table = root.table("spindle", "the spindle slows under load; without it the spin is what is asked for"))
    scene.spindle = read_spindle(*table);
  if (auto table = root.table("display", "pictures; without it none is drawn")) scene.display = read_display(*table);
  if (auto table = root.table("record", "the session file, from which a run is replayed; without it none is written")) {
    scene.record = RecordScene{table->text("path", "session.sqlite", "session file, from the output folder")};
    table->finish();
  }
  for (const std::string_view later : kLaterEffects)
    if (root.has(later)) root.fault(later, "is an effect that is not in this version");
  check_rates(scene, root);
  set_servo_rates(scene);
  root.finish();
  if (issues.size() != before) return std::nullopt;
  return scene;
}

}  // namespace burrhole
