#include "app/scene/scene.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/scene/volume_scene.h"
#include "app/stage/requirement.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "volumes/phantom/head_sites.h"
#include "volumes/read/markups.h"
#include "volumes/read/written_path.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarkupsAbout =
    "markups file of 3D Slicer (.mrk.json or .fcsv), in place of entry_mm and axis: a line, or two points, entry and target; the axis runs "
    "from one to the other; relative to the scene's folder, or $NAME/... with an environment variable";
constexpr const char* kSiteAbout =
    "name of a site that the volume knows, in place of entry_mm and axis: the entry is there, and the axis is square to the skull";

std::string beside(const std::string& scene_file, const std::string& path) {
  const fs::path p(path);
  return p.is_absolute() ? path : (fs::path(scene_file).parent_path() / p).string();
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
      table.text("name", std::nullopt, "name of a tool in the scene's folder or of a shipped one, or path of a tool file");
  if (!name.empty() && !context.tool_given) {
    if (const auto path = find_tool(name, file, context)) {
      out.path = *path;
    } else {
      table.fault("name", tool_not_found(name, file, context));
    }
  }
  out.spin = table.number("spin_rpm", {.fallback = std::nullopt, .min = 0.0, .max = 200e3, .to_si = kRevPerMinute}, "speed of the spindle");
  out.erosion_scale = table.number("erosion_scale", at_least_zero(1.0, 1.0, 1e6), "factor on all erosion factors of the tool");
  table.finish();
  return out;
}

/// Reads `site` into the entry and the axis. @returns whether it is there.
bool read_site(TableReader& table, const VolumeScene& volume, ApproachScene& out) {
  if (!table.has("site")) return false;
  const std::string name = table.text("site", "", kSiteAbout);
  out.place = table.place_of("site");
  for (const char* key : {"entry_mm", "axis"})
    if (table.has(key)) table.fault(key, "is given by site: remove one of the two, or give --unset approach");
  const auto& phantom = volume.phantom;
  if (!phantom || phantom->kind != PhantomKind::head) {
    table.fault("site", "needs a volume that knows its sites, such as \"phantom:head\": give entry_mm and axis");
    return true;
  }
  const auto site = find_head_site(name);
  if (!site) {
    const std::vector<std::string> known = head_site_names();
    const auto near = nearest_name(name, known);
    table.fault("site", fmt::format("is no site of this head{}; known: {}", near ? ": did you mean \"" + *near + "\"?" : "",
                                    fmt::join(known, ", ")));
    return true;
  }
  out.entry = site->point;
  out.axis = -site->normal;
  return true;
}

/// Reads `markups` into entry, axis and target. @returns whether it is there.
bool read_plan(TableReader& table, const std::string& scene_file, ApproachScene& out) {
  if (!table.has("markups")) return false;
  const std::string written = table.text("markups", "", kMarkupsAbout);
  out.place = table.place_of("markups");
  for (const char* key : {"entry_mm", "axis"})
    if (table.has(key)) table.fault(key, "is given by markups: remove one of the two, or give --unset approach");
  const auto path = written_path(written, scene_file, "");
  if (!path) {
    table.fault("markups", "cannot be found: " + path.error().message);
    return true;
  }
  const auto line = read_planned_line(*path);
  if (!line) {
    table.fault("markups", "cannot be read: " + line.error().text());
    return true;
  }
  out.entry = line->entry;
  out.target = line->target;
  out.markups = *path;
  out.axis = glm::normalize(line->target - line->entry);
  return true;
}

ApproachScene read_approach(TableReader table, const VolumeScene& volume, const std::string& scene_file) {
  ApproachScene out;
  if (table.has("site") && table.has("markups"))
    table.fault("site", "is given by markups: remove one of the two, or give --unset approach");
  if (read_plan(table, scene_file, out) || read_site(table, volume, out)) {
    table.finish();
    return out;
  }
  out.place = table.place_of("entry_mm");
  const NumberRule length{.fallback = std::nullopt, .min = -1e5, .max = 1e5, .to_si = kMillimetre};
  out.entry =
      table.vector("entry_mm", std::nullopt, length,
                   "point within 20 mm of the outer surface along the axis, bone frame; the entry is where the axis through it meets bone");
  const Vec3 axis = table.vector("axis", Vec3(0, 0, -1), {.fallback = 0.0, .min = -1e6, .max = 1e6},
                                 "direction of drilling, bone frame; any length above 0");
  if (glm::length(axis) < 1e-9)
    table.fault("axis", "has length 0");
  else
    out.axis = glm::normalize(axis);
  table.finish();
  return out;
}

void read_body(TableReader& table, MassSpringDamperConfig& out) {
  out.mass = table.number("mass_kg", above_zero(out.mass, 1.0, 10.0), "mass of hands and drill");
  out.damping = table.number("damping_N_s_per_m", at_least_zero(out.damping, 1.0, 1e4), "damping of the arm");
}

HandConfig read_script(TableReader& table) {
  HandConfig out;
  read_body(table, out.dynamics);
  out.dynamics.stiffness = table.number("stiffness_N_per_m", at_least_zero(out.dynamics.stiffness, 1.0, 1e5), "stiffness of the arm");
  out.feed = table.number("feed_mm_per_s", above_zero(out.feed / kMillimetre, kMillimetre, 1e3),
                          "speed of the approach; the withdrawal is twice as fast");
  out.push = table.number("push_N", at_least_zero(out.push, 1.0, 500.0), "thrust while drilling");
  out.ramp = table.number("ramp_s", at_least_zero(out.ramp, 1.0, 60.0), "time from first contact to full thrust");
  out.reaction = table.number("reaction_ms", at_least_zero(out.reaction * 1e3, 1e-3, 1e4),
                              "time from breakthrough detection to the start of the release");
  out.release = table.number("release_s", at_least_zero(out.release, 1.0, 60.0),
                             "time in which the thrust falls to 0 after the start of the release");
  out.contact_force =
      table.number("contact_N", above_zero(out.contact_force, 1.0, 100.0), "force on the hand above which it is in contact");
  out.detects = table.boolean("detects", out.detects, "whether the hand detects breakthrough; false for comparison only");
  out.resumes = table.boolean("resumes", out.resumes,
                              "whether the hand drills on after a release if bone is left ahead of the tip; false: it withdraws");
  out.reach = table.number("reach_mm", above_zero(out.reach / kMillimetre, kMillimetre, 1e3),
                           "depth below the entry at which the thrust is released, with or without breakthrough");
  out.follow_time = table.number("follow_s", above_zero(out.follow_time, 1.0, 60.0),
                                 "time constant with which the arm's rest position follows the drill while drilling");
  out.standoff =
      table.number("standoff_mm", above_zero(out.standoff / kMillimetre, kMillimetre, 100.0), "height above the entry at start and end");
  out.tremor_amplitude = table.number("tremor_mm", at_least_zero(out.tremor_amplitude / kMillimetre, kMillimetre, 5.0),
                                      "peak amplitude of the lateral tremor");
  out.tremor_frequency = table.number("tremor_hz", at_least_zero(out.tremor_frequency, 1.0, 50.0), "frequency of the tremor");
  out.seed =
      static_cast<std::uint64_t>(table.integer("seed", static_cast<std::int64_t>(out.seed), 0, INT64_MAX, "seed of the tremor's phases"));
  out.feels = table.boolean("feels", out.feels, "whether the force acts on the hand; false for comparison only");
  return out;
}

/// A bench. With push_N the carriage is a mass under that thrust; otherwise its speed is given, and it has no mass, damping or ramp.
FeedHandConfig read_feed(TableReader& table) {
  FeedHandConfig out;
  out.feed = table.number("feed_mm_per_s", above_zero(out.feed / kMillimetre, kMillimetre, 1e3),
                          "speed of the advance, with push_N only until contact; the withdrawal is twice as fast");
  out.stop = table.number("stop_mm", {.fallback = std::nullopt, .min = 0.0, .max = 1e3, .to_si = kMillimetre},
                          "depth of the tip below the entry at which the advance ends and the withdrawal starts");
  out.push = table.optional_number("push_N", above_zero(1.0, 1.0, 500.0), "thrust from contact to the stop; absent: the speed is fixed");
  out.contact_force =
      table.number("contact_N", above_zero(out.contact_force, 1.0, 100.0), "force on the hand above which it is in contact");
  out.standoff =
      table.number("standoff_mm", above_zero(out.standoff / kMillimetre, kMillimetre, 100.0), "height above the entry at start and end");
  MassSpringDamperConfig carriage{.mass = out.mass, .damping = out.damping};
  read_body(table, carriage);
  out.mass = carriage.mass;
  out.damping = carriage.damping;
  out.ramp = table.number("ramp_s", at_least_zero(out.ramp, 1.0, 60.0), "time from first contact to full thrust");
  for (const char* key : {"mass_kg", "damping_N_s_per_m", "ramp_s"})
    if (!out.push && table.has(key)) table.fault(key, "has no effect without push_N: a fixed feed needs no mass, damping or ramp");
  return out;
}

GoalHandConfig read_mouse(TableReader& table) {
  GoalHandConfig out;
  read_body(table, out.dynamics);
  out.dynamics.stiffness = table.number("stiffness_N_per_m", above_zero(out.dynamics.stiffness, 1.0, 1e5), "stiffness of the arm");
  out.push = table.number("push_N", above_zero(out.push, 1.0, 500.0), "largest thrust of the arm");
  out.speed = table.number("speed_mm_per_s", above_zero(out.speed / kMillimetre, kMillimetre, 1e3), "largest speed of the hand's goal");
  out.run_up = table.number("run_up_s", at_least_zero(out.run_up, 1.0, 60.0), "time of the drive from rest to full spin, and back");
  out.standoff =
      table.number("standoff_mm", above_zero(out.standoff / kMillimetre, kMillimetre, 100.0), "height above the entry at the start");
  return out;
}

void read_hand(TableReader table, StageConfig& out, Issues& issues, std::string& push_place) {
  push_place = table.place_of("push_N");
  const std::size_t before = issues.size();
  const std::string about =
      "what moves the hand: the script of a surgeon; the feed of a bench with a depth stop; or a user in the window, with mouse, keyboard "
      "or "
      "game pad";
  const std::string kind = table.text("kind", "script", about);
  if (kind == "device") {
    issues.push_back({ErrorCode::unavailable,
                      "hand.kind = \"device\" needs a force device; this version supports none, only \"script\", \"feed\" and \"mouse\"",
                      table.place_of("kind")});
  } else if (issues.size() == before) {
    (void)table.choice("kind", "script", {"script", "feed", "mouse"}, about, {"device", "replay"});
  }
  if (kind == "feed") {
    out.feed_hand = read_feed(table);
    out.hand.push = out.feed_hand->push.value_or(0.0);
    out.hand.standoff = out.feed_hand->standoff;
  } else if (kind == "mouse") {
    out.goal_hand = read_mouse(table);
    out.hand.dynamics = out.goal_hand->dynamics;
    out.hand.push = out.goal_hand->push;
    out.hand.standoff = out.goal_hand->standoff;
  } else {
    out.hand = read_script(table);
  }
  table.finish();
}

// The hand may sink into bone while the force is off. When the force returns it lifts the hand and does work on it. A return over 0.2 s
// does no more work than a slower one; an immediate return does four times as much and throws the hand (docs/servo.md).
constexpr double kSoftReturn = 0.2;  // [s]
constexpr double kJumpSpeed = 5.0;   // [m/s] of the hand; the fastest strokes of the stability cases have 1.25 m/s

/// The defaults of [servo], also those of a scene without that table.
ServoConfig shipped_servo() {
  ServoConfig out;
  out.multi_rate.scheme = MultiRateScheme::planes;
  out.soft_start = kSoftReturn;
  out.soft_stop = 0.05;
  out.jump_speed = kJumpSpeed;
  return out;
}

void read_servo(TableReader table, Scene& scene) {
  ServoConfig& out = scene.servo;
  const std::string scheme = table.choice(
      "multirate", "planes", {"planes", "gradient", "hold", "linear"},
      "force between two contact results; planes: from all local planes of the last result, also those not touched yet; gradient: the last "
      "force and its change with the motion since, by the planes that carry load; hold: the last force; linear: interpolation to the last "
      "force, one contact period late");
  out.multi_rate.scheme = scheme == "planes"     ? MultiRateScheme::planes
                          : scheme == "gradient" ? MultiRateScheme::gradient
                          : scheme == "hold"     ? MultiRateScheme::hold
                                                 : MultiRateScheme::linear;
  out.multi_rate.max_distance =
      table.number("reach_mm", above_zero(out.multi_rate.max_distance / kMillimetre, kMillimetre, 100.0),
                   "only for planes and gradient: displacement of the hand since the last contact result up to which the force is "
                   "extrapolated; beyond it the force is that at this displacement");
  out.largest_force = table.number("force_N", above_zero(out.largest_force, 1.0, 1e4),
                                   "largest force on the hand, in the world: before the force scale of a device");
  out.largest_slew = table.number("slew_N_per_s", at_least_zero(0.0, 1.0, 1e9), "largest rate of change of the force; 0 for no limit");
  out.soft_start = table.number(
      "soft_start_s", at_least_zero(out.soft_start, 1.0, 60.0),
      "time in which the force rises from 0 at the start, after the reset of a latched fault, after a jump and "
      "after stale contact; the rise ends early if the computed force is 0 meanwhile; after an undo and the like the old force "
      "fades in the same time");
  out.soft_stop = table.number("soft_stop_s", at_least_zero(out.soft_stop, 1.0, 60.0),
                               "time in which the force falls to 0 when contact is stale or a stop is requested");
  out.jump_speed = table.number("jump_m_per_s", at_least_zero(out.jump_speed, 1.0, 1e3),
                                "speed above which a change of position counts as a jump and not as motion; 0 for no limit");
  scene.relied_on =
      table.optional_number("relied_on_N_s_per_m", at_least_zero(0.0, 1.0, 1e4),
                            "damping of device and hand, at the drill, that the energy detector counts as dissipation; absent: 0, with "
                            "[device] the damping at its grip over (position_scale x force_scale)");
  scene.energy_tolerance = table.optional_number(
      "energy_mJ", at_least_zero(0.0, 1e-3, 1e6),
      "passivity deficit above which a fault is latched; 0: no detector; absent: 0, but with [device] and contact.model = "
      "\"surface\" F (F / (2 K) + s), where F is the smallest of 2 push_N, force_N, and force_N of [device] over its "
      "force_scale, K is coupling_N_per_m of [contact], and s is step_mm x position_scale of [device]");
  out.energy.damping = scene.relied_on.value_or(0.0);
  out.energy.tolerance = scene.energy_tolerance.value_or(0.0);
  out.energy.largest_damping =
      table.number("passivity_N_s_per_m", at_least_zero(0.0, 1.0, 1e4),
                   "largest damping that the passivity controller adds while there is a passivity deficit; 0: no controller");
  table.finish();
}

OutputScene read_output(TableReader table) {
  OutputScene out;
  out.bone = table.boolean("bone", out.bone, "bone.vdb: the drilled bone, for --restore and other programs; about as large as the bone");
  if (out.bone)
    out.whole_bone =
        table.boolean("whole_bone", out.whole_bone,
                      "true: bone.vdb holds the bone as loaded too, so it can be a source; false: only blocks that were changed, for "
                      "--restore with the same bone; small and quick for a whole head");
  out.report = table.boolean("report", out.report, "report.html: figures, plot and pictures on one page");
  out.plots =
      table.boolean("plots", out.plots, "the plot of force, depth and speed over time in the report; without it no samples are kept");
  table.finish();
  return out;
}

OutcomeLimits read_outcome(TableReader table) {
  OutcomeLimits out;
  out.plunge_mm =
      table.number("plunge_limit_mm", at_least_zero(out.plunge_mm, 1.0, 100.0),
                   "plunge above which the result has the flag plunged; the default is of the order of the dura, 0.3 to 0.8 mm thick");
  table.finish();
  return out;
}

void read_effects(TableReader& root, const SceneContext& context, Scene& scene, Issues& issues) {
  for (const EffectEntry& entry : *context.registry) {
    auto table = root.table(entry.table, entry.about);
    if (!table) continue;
    scene.effects.add(entry.table, entry.read(*table, scene, issues));
    table->finish();
  }
}

/// Pushes an issue at each table that has no effect without another one. For a scene without other errors, of which these may be consequences.
void check_requirements(const TableReader& root, const Scene& scene, Issues& issues) {
  for (const UnmetRequirement& unmet : unmet_requirements(scene.effects, scene))
    issues.push_back(bad_input(unmet.text(), root.place_of(unmet.table)));
}

}  // namespace

/// @returns whether [tool] name is the path of a file, and not a name.
static bool is_path(const std::string& name) { return name.ends_with(".toml") || name.find('/') != std::string::npos; }

/// @returns the files that a tool's name or path may mean, in the order of the search.
static std::vector<std::string> tool_places(const std::string& name, const std::string& scene_file, const SceneContext& context) {
  std::vector<std::string> places;
  if (is_path(name)) {
    places.push_back(beside(scene_file, name));
  } else {
    places.push_back(beside(scene_file, name + ".toml"));
    for (const std::string& folder : context.tool_folders) places.push_back((fs::path(folder) / (name + ".toml")).string());
  }
  return places;
}

std::optional<std::string> mesh_as_tool(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".stl" && ending != ".ply" && ending != ".obj") return std::nullopt;
  return fmt::format(
      "is a mesh, not a tool file: write a tool file with a table [mesh], file = \"{}\", pitch_mm and erosion_factor "
      "(burrhole docs tool), and give that",
      fs::path(name).filename().string());
}

std::string tool_not_found(const std::string& name, const std::string& scene_file, const SceneContext& context) {
  if (auto mesh = mesh_as_tool(name)) return *mesh;
  std::string where;
  for (const std::string& place : tool_places(name, scene_file, context)) {
    const std::string folder = fs::path(place).parent_path().string();
    where += (where.empty() ? "" : ", ") + (folder.empty() ? std::string("the current folder") : folder);
  }
  const auto near = nearest_name(fs::path(name).stem().string(), tool_names(context));
  return fmt::format("not found in {}{}", where,
                     near            ? "; did you mean \"" + *near + "\"?"
                     : is_path(name) ? std::string("; ") + kPathsCount
                                     : " (burrhole tools lists the shipped ones)");
}

std::optional<std::string> find_tool(const std::string& name, const std::string& scene_file, const SceneContext& context) {
  if (mesh_as_tool(name)) return std::nullopt;
  std::error_code unreadable;  // a name that is too long, or a folder without permission: not there
  for (const std::string& place : tool_places(name, scene_file, context))
    if (fs::is_regular_file(place, unreadable)) return place;
  return std::nullopt;
}

void add_effect(Scene& scene, const std::string& name) {
  if (scene.effects.has(name)) return;
  Issues issues;
  const auto document = TomlDocument::parse("[" + name + "]\n", "defaults");
  BH_ASSERT(document.ok());
  TableReader root = document->root(issues);
  EffectPlans all;  // in the order of the registry
  for (const EffectEntry& entry : shipped_effects()) {
    if (name == entry.table) {
      auto table = root.table(name, entry.about);
      all.add(name, entry.read(*table, scene, issues));
    }
    for (const EffectPlans::Item& item : scene.effects.items())
      if (item.table == entry.table) all.add(item.table, item.plan->clone());
  }
  scene.effects = std::move(all);
  BH_ASSERT(issues.empty());
}

std::optional<Scene> read_scene(const TomlDocument& document, const SceneContext& context, Issues& issues, KeyLog* log) {
  const std::size_t before = issues.size();
  Scene scene;
  scene.file = document.file_name();
  scene.text = document.to_text();
  TableReader root = document.root(issues, log);
  scene.title = root.text("title", "", "title of the scene, one line");
  scene.duration = root.number("duration_s", above_zero(120.0, 1.0, 3600.0), "longest simulated time of a run");
  scene.servo_hz = static_cast<int>(root.integer("servo_hz", 1000, 100, 20000, "rate of the servo; every other rate divides it"));

  std::string push_place;
  const auto required = [&](const char* name, const char* about, const char* keys) {
    auto table = root.table(name, about);
    if (!table && !root.has(name))
      issues.push_back(bad_input(fmt::format("[{}] is missing: every scene needs this table; add it{}", name, keys), scene.file + ":1:1"));
    return table;
  };
  if (auto table = required("volume", "the bone; required", " with the key source")) scene.volume = read_volume(*table, scene.file);
  if (auto table = required("tool", "the bit and its spindle; required", " with the keys name and spin_rpm"))
    scene.tool = read_tool(*table, scene.file, context);
  if (auto table =
          required("approach", "where the drill enters the bone, and its direction; required", " with the key entry_mm, site or markups"))
    scene.approach = read_approach(*table, scene.volume, scene.file);
  if (scene.volume.phantom) {
    scene.volume.phantom->head_entry = scene.approach.entry;
    scene.volume.phantom->head_axis = scene.approach.axis;
  }
  if (auto table = required("hand", "the hand that holds the drill; required", "; it may be empty"))
    read_hand(*table, scene, issues, push_place);
  scene.servo = shipped_servo();
  if (auto table = root.table("servo", "how forces are computed and limited at the servo's rate; without the table these defaults hold"))
    read_servo(*table, scene);
  if (auto table = root.table("limits", "limits of the resources of a run")) {
    const double megabytes =
        table->number("memory_mb", {.fallback = 0.0, .min = 1.0, .max = 1e6},
                      "limit of the predicted peak of the resident memory of the process, 1 MB = 10^6 bytes; the prediction is computed "
                      "before the run, which is not limited itself, and includes the schedule (lockstep or live), the tools and the "
                      "history of inputs. A scene that exceeds it keeps the bone as loaded in a temporary file, in TMPDIR or /var/tmp, "
                      "and a warning says so; if that is not enough, it is refused. Absent: no limit");
    if (table->has("memory_mb")) scene.memory_limit = static_cast<std::uint64_t>(megabytes * 1e6);
    scene.memory_place = table->place_of("memory_mb");
    table->finish();
  }
  if (auto table = root.table("output", "files that a run writes besides summary.json, [display]'s pictures and [record]'s session"))
    scene.output = read_output(*table);
  if (auto table = root.table("outcome", "limits by which the result of a run is judged (docs/outcome.md)"))
    scene.outcome = read_outcome(*table);
  if (scene.hand.feels && scene.hand.push > scene.servo.largest_force)
    issues.push_back(bad_input(fmt::format("hand.push_N = {:g} is over the largest force on the hand, servo.force_N = {:g}: bone could not "
                                           "hold the hand",
                                           scene.hand.push, scene.servo.largest_force),
                               push_place));
  read_effects(root, context, scene, issues);
  root.finish();
  if (issues.size() == before) check_requirements(root, scene, issues);
  if (issues.size() != before) return std::nullopt;
  return scene;
}

}  // namespace burrhole
