// What is wrong with a scene, and where, as the user is told: exact lines.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "core/contact/constrained_tool.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/virtual_coupling.h"
#include "core/contact/voxmap_contact.h"
#include "core/drill/erosion.h"
#include "core/drill/spindle.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"
#include "volumes/phantom/head_sites.h"
#include "volumes/write/planned_line.h"

namespace burrhole::test {
namespace {

/// Every fault of a text, found by reading it and by putting the run together; one line each.
std::vector<std::string> faults(const std::string& text, Issues& issues) {
  const auto document = TomlDocument::parse(text, "bad.toml");
  if (!document) return {document.error().text()};
  const auto loaded = load_scene(*document, test_context(), issues);
  if (loaded) (void)Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
  std::vector<std::string> lines;
  for (const Error& issue : issues) lines.push_back(issue.text());
  return lines;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  return text.replace(at, from.size(), to);
}

/// One edit of a sound scene and the lines it must bring; a line that starts with "~" need only be contained.
struct BadScene {
  std::string from, to;
  std::vector<std::string> lines;
};

const BadScene kBadScenes[] = {
    {"spin_rpm = 1000.0", "spin_rpm = ", {"~bad.toml:14:12: "}},
    {"spin_rpm",
     "spin_rmp",
     {"bad.toml:12:2: tool.spin_rpm is missing (speed of the spindle)",
      "bad.toml:14:1: unknown key \"spin_rmp\" in [tool]; did you mean \"spin_rpm\"?"}},
    {"push_N", "pusch_N", {"bad.toml:20:1: unknown key \"pusch_N\" in [hand]; did you mean \"push_N\"?"}},
    {"[record]", "[recrod]", {"bad.toml:30:2: unknown table [recrod]; did you mean [record]?"}},
    {"spin_rpm = 1000.0", "spin = 1000.0", {"bad.toml:14:1: tool.spin lacks its unit: write \"spin_rpm\""}},
    {"push_N = 20.0", "push_N = -3", {"bad.toml:20:1: hand.push_N = -3 must be in [0, 500]"}},
    {"push_N = 20.0", "push_N = nan", {"bad.toml:20:1: hand.push_N = nan must be a finite number"}},
    {"push_N = 20.0", "push_N = \"hard\"", {"bad.toml:20:1: hand.push_N = \"hard\" must be a number"}},
    {"spacing_mm = 0.25", "spacing_mm = [1, 2]", {"bad.toml:6:1: volume.spacing_mm = [1, 2] must be a number"}},
    {"[hand]",
     "[hande]",
     {"bad.toml:1:1: [hand] is missing: every scene needs this table; add it; it may be empty",
      "bad.toml:19:2: unknown table [hande]; did you mean [hand]?"}},
    {"spin_rpm = 1000.0\n", "", {"bad.toml:12:2: tool.spin_rpm is missing (speed of the spindle)"}},
    {"\"ball\"", "\"perforator_14\"", {"~bad.toml:13:1: tool.name = \"perforator_14\" not found in the current folder, "}},
    {"\"ball\"",
     "\"no/such.toml\"",
     {"bad.toml:13:1: tool.name = \"no/such.toml\" not found in no; a path in a scene counts from the scene's folder, one on the command "
      "line "
      "also from the current one"}},
    {"cutting_N_per_m = 40e3", "rate_hz = 300", {"bad.toml:26:1: contact.rate_hz = 300 must divide servo_hz = 1000"}},
    {"[erosion]", "[erosion]\nrate_hz = 333", {"bad.toml:29:1: erosion.rate_hz = 333 must divide servo_hz = 1000"}},
    {"[0.0, 0.0, 0.0]",
     "[40.0, 0.0, 0.0]",
     {"bad.toml:17:1: the approach axis meets no bone within 20 mm of entry_mm: the nearest bone lies 37 mm away: 37 mm right; bone begins "
      "at "
      "entry_mm = [2.9, -0.1, 0.0], axis = [0.000, 0.000, -1.000]"}},
    {"[0.0, 0.0, 0.0]", "[0.0, 0.0, 0.0]\naxis = [0, 0, 0]", {"bad.toml:18:1: approach.axis has length 0"}},
    {"[6.0, 6.0, 6.0]",
     "[300, 300, 300]",
     {"bad.toml:6:1: volume.spacing_mm = 0.25 with volume.extent_mm makes 1200 x 1200 x 1200 = 1.73e+09 voxels, more than the 3e+08 that "
      "are "
      "built: use a larger spacing or a smaller extent"}},
    {"spacing_mm = 0.25",
     "spacing_mm = 1.5",
     {"bad.toml:6:1: volume.spacing_mm = 1.5 is too coarse for the 3 mm of bone or hole that volume.thickness_mm leaves: at most 0.75"}},
    {"phantom:plate",
     "phantom:plat",
     {"bad.toml:5:1: volume.source = \"phantom:plat\" names no phantom: did you mean \"phantom:plate\"?; known: skull_patch, block, plate, "
      "sphere, wedge, pit, capsule, head"}},
    {"[hand]",
     "[hand]\nkind = \"device\"",
     {"bad.toml:20:1: hand.kind = \"device\" needs a force device; this version supports none, only \"script\", \"feed\" and \"mouse\""}},
    {"[hand]",
     "[hand]\nkind = \"replay\"",
     {"bad.toml:20:1: hand.kind = \"replay\" is not in this version; it knows \"script\", \"feed\", \"mouse\""}},
    {"[hand]",
     "[hand]\nkind = \"feed\"",
     {"bad.toml:19:2: hand.stop_mm is missing (depth of the tip below the entry at which the advance ends and the withdrawal starts)",
      "bad.toml:24:1: unknown key \"tremor_mm\" in [hand]"}},
    {"push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0",
     "kind = \"feed\"\nstop_mm = 3\nramp_s = 0.1\nreaction_ms = 10",
     {"bad.toml:22:1: hand.ramp_s = 0.1 has no effect without push_N: a fixed feed needs no mass, damping or ramp",
      "bad.toml:23:1: unknown key \"reaction_ms\" in [hand]"}},
    {"push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0",
     "kind = \"feed\"\nstop_mm = -1\n[device]",
     {"bad.toml:21:1: hand.stop_mm = -1 must be in [0, 1000]",
      "bad.toml:22:2: [device] has no effect on hand.kind = \"feed\", only on \"script\""}},
    {"push_N = 20.0", "give_mm_per_s = 2", {"~bad.toml:20:1: "}},
    {"[contact]",
     "[contact]\nmodel = \"mesh\"\ntool = \"hand\"\nstacking = \"sum\"",
     {"~contact.stacking = \"sum\" must be one of \"average\", \"deepest\"", "~unknown key \"cutting_N_per_m\""}},
    // A key of another branch is as unknown as one that was never there.
    {"[contact]", "[contact]\nmodel = \"gradient-plane\"", {"~unknown key \"cutting_N_per_m\" in [contact]"}},
    {"[contact]", "[contact]\ntool = \"device\"", {"~unknown key \"tool\" in [contact]"}},
    {"[contact]",
     "[contact]\nmodel = \"voxmap\"\ncoupling = \"virtual\"\ncoupling_N_per_m = 0.5",
     {"~contact.coupling_N_per_m = 0.5 must be in [1, ", "~unknown key \"cutting_N_per_m\""}},
    {"[contact]", "[contact]\nmass_kg = 0.05", {"~unknown key \"mass_kg\" in [contact]"}},
    {"[contact]", "[contact]\nturning = \"locked\"\ncoupling_Nm_per_rad = 20", {"~unknown key \"coupling_Nm_per_rad\" in [contact]"}},
    {"[contact]", "[contact]\nrecord_bits = \"12\"", {"~contact.record_bits = \"12\""}},
    {"[contact]", "[contact]\nrecord_bits = 12", {"~contact.record_bits = 12 must be one of \"8\", \"16\""}},
    {"[erosion]", "[erosion]\nlaw = \"power\"", {"~erosion.law = \"power\""}},
    {"[erosion]", "[erosion]\nlaw = \"per-update\"\nsubvoxel = true", {"~unknown key \"subvoxel\" in [erosion]"}},
    {"[erosion]", "[erosion]\ncutting_ratio = 0.5", {"~unknown key \"cutting_ratio\" in [erosion]"}},
    {"[erosion]", "[erosion]\nsubvoxel = 1", {"~erosion.subvoxel = 1 must be"}},
    {"[record]", "[spindle]\nstall_torque_Nm = 0", {"bad.toml:31:1: spindle.stall_torque_Nm = 0 must be in (0, 1000]"}},
    {"[record]", "[spindle]\ninertia = 1", {"bad.toml:31:1: spindle.inertia lacks its unit: write \"inertia_kg_m2\""}},
    {"[record]",
     "[display]\nmethod = \"mesh\"\nbisections = 3\nambient_occlusion = true\nspecular = true\nnormals = \"texture\"\ntissue = "
     "\"plain\"\nshadow = true",
     {"~unknown key \"bisections\" in [display]", "~unknown key \"ambient_occlusion\" in [display]",
      "~unknown key \"normals\" in [display]", "~unknown key \"tissue\" in [display]", "~unknown key \"shadow\" in [display]"}},
    {"[record]", "[display]\nmethod = \"mesh\"\nquality = \"auto\"", {"~display.quality = \"auto\" needs method = \"raycast\""}},
    {"[record]",
     "[display]\nquality = \"auto\"\nbudget_ms = 0\nsupersample = 2",
     {"~bad.toml:32:1: display.budget_ms = 0 must be ",
      "bad.toml:33:1: display.supersample = 2 is chosen by quality = \"auto\": remove one of the two"}},
    {"[record]",
     "[display]\nmethod = \"slices\"\nquality = \"auto\"",
     {"bad.toml:32:1: display.quality = \"auto\" needs method = \"raycast\""}},
    {"[record]",
     "[display]\nbudget_ms = 30\nresolution = 0.1",
     {"~bad.toml:32:1: display.resolution = 0.1 must be in [0.25, 1]", "~bad.toml:31:1: unknown key \"budget_ms\" in [display]"}},
    {"[record]", "[display]\nstereo = \"quad-buffered\"", {"~display.stereo = \"quad-buffered\" must be one of \"off\", \"side-by-side\""}},
    {"[record]", "[display]\neye_separation_mm = 3", {"~unknown key \"eye_separation_mm\" in [display]"}},
    {"[record]", "[display]\ncut = \"plane\"\ncut_point_mm = [0, 0, 0]\ncut_normal = [0, 0, 0]", {"~display.cut_normal must not be zero"}},
    {"[record]", "[display]\ncut = \"tip\"\ncut_normal = [0, 0, 1]", {"~unknown key \"cut_normal\" in [display]"}},
    {"[record]", "[display]\nmethod = \"slices\"\nshadow = true", {"~unknown key \"shadow\" in [display]"}},
    {"[record]", "[display]\nbackground_top = [0, 2, 0]", {"~display.background_top[1] = 2 must be in [0, 1]"}},
    {"phantom:plate",
     "skull.nii",
     {"~bad.toml:5:1: volume.source = \"skull.nii\" is not there: tried skull.nii; a path in a scene counts from the scene's folder"}},
};

TEST_CASE("scene: each error is reported by file, line, column, value and remedy") {
  for (const BadScene& bad : kBadScenes) {
    CAPTURE(bad.to);
    Issues issues;
    const std::vector<std::string> lines = faults(replaced(scene_text({.record = true}), bad.from, bad.to), issues);
    // Keys of a phantom are unknown beside a file, and that is told too: only the first lines are compared.
    REQUIRE(lines.size() >= bad.lines.size());
    if (bad.to != "skull.nii") CHECK(lines.size() == bad.lines.size());
    for (std::size_t n = 0; n < bad.lines.size(); ++n) {
      if (bad.lines[n].starts_with('~'))
        CHECK_MESSAGE(lines[n].find(bad.lines[n].substr(1)) != std::string::npos, lines[n]);
      else
        CHECK(lines[n] == bad.lines[n]);
    }
  }
}

TEST_CASE("scene: without any error the same text is valid") {
  Issues issues;
  CHECK(faults(scene_text({.record = true}), issues).empty());
}

TEST_CASE("scene: all errors of a file come at once, in the order of the file") {
  std::string text = replaced(scene_text({}), "push_N = 20.0", "push_N = -3");
  text = replaced(replaced(text, "spin_rpm = 1000.0", "spin_rpm = 1e9"), "thickness_mm = 3.0", "thickness_mm = 0");
  Issues issues;
  CHECK(faults(text, issues) == std::vector<std::string>{"bad.toml:9:1: volume.thickness_mm = 0 must be in (0, 100]",
                                                         "bad.toml:14:1: tool.spin_rpm = 1000000000 must be in [0, 200000]",
                                                         "bad.toml:20:1: hand.push_N = -3 must be in [0, 500]"});
}

TEST_CASE("scene: an empty table means the defaults of the core, in every branch") {
  const auto read = [](const SmallScene& scene) { return load_small(scene).scene; };
  const ConstrainedToolConfig held = *read({.contact_keys = ""}).find<ConstrainedToolConfig>(), held_default;
  CHECK(held.coupling_stiffness == held_default.coupling_stiffness);
  CHECK(held.coupling_damping == held_default.coupling_damping);
  CHECK(held.turn_stiffness == held_default.turn_stiffness);
  CHECK(held.cutting_stiffness == held_default.cutting_stiffness);
  CHECK(held.bone_stiffness == held_default.bone_stiffness);
  Scene planes = read({.contact_keys = "model = \"gradient-plane\"\ncoupling = \"virtual\"\n"});
  const auto* coupling = planes.find<VirtualCouplingConfig>();
  const VirtualCouplingConfig coupling_default;
  CHECK(planes.find<GradientPlaneConfig>()->stiffness == GradientPlaneConfig{}.stiffness);
  REQUIRE(coupling != nullptr);
  CHECK(coupling->mass == coupling_default.mass);
  CHECK(coupling->inertia == coupling_default.inertia);
  CHECK(coupling->stiffness == coupling_default.stiffness);
  CHECK(coupling->damping == coupling_default.damping);
  CHECK(coupling->angular_stiffness == coupling_default.angular_stiffness);
  CHECK(coupling->angular_damping == coupling_default.angular_damping);
  CHECK(read({.contact_keys = "model = \"voxmap\"\n"}).find<VoxmapContactConfig>()->stiffness == VoxmapContactConfig{}.stiffness);
  const ErosionConfig energy = *read({.sets = {"erosion.law=energy"}}).find<ErosionConfig>();
  // The key is in J/mm^3, the value in J/m^3: a rounding of the conversion may stay.
  CHECK(std::abs(energy.energy.specific_energy / EnergyConfig{}.specific_energy - 1.0) < 1e-15);
  CHECK(energy.energy.cutting_ratio == EnergyConfig{}.cutting_ratio);
  CHECK(energy.subvoxel);
  const SpindleConfig spindle_default;
  const SpindleConfig spindle = *read({.spindle = true}).find<SpindleConfig>();
  CHECK(spindle.stall_torque == spindle_default.stall_torque);
  CHECK(spindle.inertia == spindle_default.inertia);
}

TEST_CASE("scene: a feed has a speed or a thrust, a stop, and the defaults of its struct") {
  const auto read = [](const std::string& keys) {
    const std::string hand = "push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0";
    return load_text(replaced(scene_text({}), hand, "kind = \"feed\"\n" + keys), {}, "feed.toml").scene;
  };
  const FeedHandConfig defaults;
  const Scene speed = read("feed_mm_per_s = 0.25\nstop_mm = 2");
  REQUIRE(speed.feed_hand.has_value());
  CHECK(speed.feed_hand->feed == doctest::Approx(0.25e-3));
  CHECK(speed.feed_hand->stop == doctest::Approx(2e-3));
  CHECK_FALSE(speed.feed_hand->push.has_value());
  CHECK(speed.feed_hand->standoff == doctest::Approx(defaults.standoff));
  const Scene thrust = read("push_N = 20\nstop_mm = 3\nmass_kg = 2\nramp_s = 0.1");
  REQUIRE(thrust.feed_hand.has_value());
  CHECK(thrust.feed_hand->push == 20.0);
  CHECK(thrust.feed_hand->feed == doctest::Approx(defaults.feed));
  CHECK(thrust.feed_hand->mass == 2.0);
  CHECK(thrust.feed_hand->damping == defaults.damping);
  CHECK(thrust.feed_hand->ramp == 0.1);
  CHECK_FALSE(load_small({}).scene.feed_hand.has_value());
}

TEST_CASE("scene: a user's hand has the defaults of its struct, and its arm is that of the force loop") {
  const auto read = [](const std::string& keys) {
    const std::string hand = "push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0";
    return load_text(replaced(scene_text({}), hand, "kind = \"mouse\"\n" + keys), {}, "mouse.toml").scene;
  };
  const GoalHandConfig defaults;
  const Scene plain = read("");
  REQUIRE(plain.goal_hand.has_value());
  CHECK(plain.goal_hand->push == defaults.push);
  CHECK(plain.goal_hand->speed == doctest::Approx(defaults.speed));
  CHECK(plain.goal_hand->run_up == defaults.run_up);
  CHECK(plain.hand.push == defaults.push);
  CHECK(plain.hand.dynamics.stiffness == defaults.dynamics.stiffness);
  const Scene other = read("push_N = 30\nstiffness_N_per_m = 2000\nmass_kg = 1\nspeed_mm_per_s = 50\nstandoff_mm = 1");
  CHECK(other.hand.push == 30.0);
  CHECK(other.hand.dynamics.stiffness == 2000.0);
  CHECK(other.hand.dynamics.mass == 1.0);
  CHECK(other.goal_hand->speed == doctest::Approx(0.05));
  CHECK(other.goal_hand->standoff == doctest::Approx(1e-3));
  CHECK_FALSE(load_small({}).scene.goal_hand.has_value());
}

TEST_CASE("scene: a device that is not there is unavailable, not bad input") {
  Issues issues;
  (void)faults(replaced(scene_text({}), "[hand]", "[hand]\nkind = \"device\""), issues);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().code == ErrorCode::unavailable);
}

TEST_CASE("scene: a volume file that is not there is named") {
  Issues issues;
  const std::vector<std::string> lines = faults(replaced(scene_text({}), "phantom:plate", "no_skull.vdb"), issues);
  REQUIRE_FALSE(lines.empty());
  CHECK_MESSAGE(lines.front().find("no_skull.vdb") != std::string::npos, lines.front());
  CHECK_MESSAGE(lines.front().find("is not there") != std::string::npos, lines.front());
}

TEST_CASE("scene: a site gives entry and axis; one that the volume does not know is an error that names those known") {
  const std::string plain = scene_text({.volume = "source = \"phantom:head\"\nspacing_mm = 0.5\nsurroundings_mm = 3\n"});
  const std::size_t from = plain.find("entry_mm"), to = plain.find("[hand]");
  REQUIRE(from < to);
  const auto with = [&](const std::string& text, const std::string& keys) {
    return text.substr(0, text.find("entry_mm")) + keys + "\n" + text.substr(text.find("[hand]"));
  };
  const LoadedScene loaded = load_text(with(plain, "site = \"kocher_right\""), {});
  const auto site = find_head_site("kocher_right");
  REQUIRE(site);
  CHECK(loaded.scene.approach.entry == site->point);
  CHECK(glm::length(loaded.scene.approach.axis + site->normal) < 1e-12);
  Issues issues;
  const auto fails = [&](const std::string& text, const std::string& words) {
    issues.clear();
    const std::vector<std::string> lines = faults(text, issues);
    REQUIRE(lines.size() == 1);
    CHECK_MESSAGE(lines[0].find(words) != std::string::npos, lines[0]);
  };
  fails(with(plain, "site = \"kocher_rigth\""),
        "is no site of this head: did you mean \"kocher_right\"?; known: kocher_left, kocher_right");
  fails(with(plain, "site = \"kocher_left\"\naxis = [0, 0, -1]"), "approach.axis is given by site");
  fails(with(scene_text({}), "site = \"kocher_left\""), "needs a volume that knows its sites");
  fails(scene_text({.display = true}) + "drape = \"round\"\n", "needs volume.source = \"phantom:head\"");
  fails(scene_text({.display = true}) + "skin = true\n", "display.skin = true needs a whole head");
  const std::string head = scene_text({.volume = "source = \"phantom:head\"\nspacing_mm = 0.5\nsurroundings_mm = 3\n", .display = true});
  fails(head + "skin = true\nmethod = \"slices\"\n", "display.skin = true needs method = \"raycast\"");
  fails(head + "skin_opacity = 0.5\n", "skin_opacity");
}

TEST_CASE(
    "scene: markups of 3D Slicer give entry, axis and target; the same line in RAS is the same approach, and errors name both files") {
  const TemporaryFolder folder;
  const PlannedLine line{Vec3(0.5e-3, -0.25e-3, 1e-3), Vec3(1.5e-3, -0.25e-3, -2e-3)};
  const auto write = [&](const std::string& name, const std::string& text) { std::ofstream(folder.file(name)) << text; };
  write("lps.mrk.json", markups_json(line));
  write("ras.mrk.json", markups_json(line, MarkupsFrame::ras));
  write("lps.fcsv", markups_fcsv(line));
  write("ras.fcsv", markups_fcsv(line, MarkupsFrame::ras));
  const std::string plain = scene_text({});
  const auto with = [&](const std::string& keys) {
    return plain.substr(0, plain.find("entry_mm")) + keys + "\n" + plain.substr(plain.find("[hand]"));
  };
  for (const char* const name : {"lps.mrk.json", "ras.mrk.json", "lps.fcsv", "ras.fcsv"}) {
    const ApproachScene read = load_text(with(fmt::format("markups = \"{}\"", name)), {}, folder.file("scene.toml")).scene.approach;
    CHECK(glm::length(read.entry - line.entry) < 1e-15);
    CHECK(glm::length(read.axis - glm::normalize(line.target - line.entry)) < 1e-12);
    REQUIRE(read.target.has_value());
    CHECK(glm::length(*read.target - line.target) < 1e-15);
  }
  CHECK_FALSE(load_small({}).scene.approach.target.has_value());
  write("bad.mrk.json", "{\"markups\": [\n  {\"type\": \"ROI\"}]}");
  Issues issues;
  const auto fails = [&](const std::string& keys, const std::string& words) {
    issues.clear();
    const std::vector<std::string> lines = faults(with(keys), issues);
    REQUIRE(lines.size() == 1);
    CHECK_MESSAGE(lines[0].find(words) != std::string::npos, lines[0]);
  };
  fails(fmt::format("markups = \"{}\"", folder.file("bad.mrk.json")),
        "cannot be read: " + folder.file("bad.mrk.json") + ":2:3: is a markup of another type");
  fails("markups = \"none.mrk.json\"",
        "approach.markups = \"none.mrk.json\" cannot be read: none.mrk.json: cannot be read: No such file or directory");
  const std::string good = fmt::format("markups = \"{}\"\n", folder.file("lps.fcsv"));
  fails(good + "entry_mm = [0, 0, 0]", "approach.entry_mm is given by markups: remove one of the two");
  fails(good + "site = \"kocher_left\"", "approach.site = \"kocher_left\" is given by markups: remove one of the two");
}

TEST_CASE("scene: a tool too large for the window is refused with the numbers, and with the voxels that fit") {
  std::string text = replaced(scene_text({}), "\"ball\"", "\"perforator_14_11\"");
  Issues issues;
  const std::vector<std::string> found = faults(replaced(text, "spacing_mm = 0.25", "spacing_mm = 0.09"), issues);
  REQUIRE(found.size() == 1);
  CHECK(
      found[0] ==
      "bad.toml:13:1: tool \"perforator_14_11\" is too large for this bone's voxels: the window would be 189 x 189 x 478 voxels; each edge "
      "must be in [5, 512], and all voxels at most 16777216; in this direction it fits voxels of 0.1 mm (spacing_mm)");
}

TEST_CASE("scene: an error of an override names the override") {
  auto document = TomlDocument::parse(scene_text({}), "bad.toml");
  REQUIRE(document);
  REQUIRE(document->set("hand.push_N=-3"));
  Issues issues;
  CHECK_FALSE(load_scene(*document, test_context(), issues).has_value());
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().text() == "--set hand.push_N: hand.push_N = -3 must be in [0, 500]");
}

}  // namespace
}  // namespace burrhole::test
