#include "tests/support/drill_scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/support/scene_hand.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr const char* kPin = R"(title = "Pin: a flat cutting cylinder of 2 mm"
[shell]
pitch_mm = 0.25
[[region]]
name = "pin"
shape = "cylinder"
z_mm = 0
height_mm = 5
diameter_mm = 2
erosion_factor = 0.1
)";
constexpr const char* kPunch = R"(title = "Punch: a flat cutting cylinder of 4 mm"
[shell]
pitch_mm = 2.0
[[region]]
name = "punch"
shape = "cylinder"
z_mm = 0
height_mm = 6
diameter_mm = 4
erosion_factor = 0.1
)";
constexpr const char* kBall = R"(title = "Ball: a cutting sphere of 2 mm"
[shell]
pitch_mm = 0.25
[[region]]
name = "ball"
shape = "sphere"
z_mm = 0
diameter_mm = 2
erosion_factor = 0.1
)";

void write_tools(const std::string& folder) {
  for (const auto& [name, text] : {std::pair{"pin", kPin}, std::pair{"ball", kBall}, std::pair{"punch", kPunch}})
    std::ofstream(folder + "/" + name + ".toml") << text;
}

}  // namespace

std::string scene_text(const SmallScene& scene) {
  // No tremor, so that figures have closed forms.
  std::string text = "title = \"Small plate\"\nduration_s = 6.0\n\n[volume]\n" + scene.volume +
                     "\n[tool]\nname = \"ball\"\nspin_rpm = 1000.0\n\n[approach]\nentry_mm = [0.0, 0.0, 0.0]\n"
                     "\n[hand]\npush_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0\n";
  if (scene.contact) text += "\n[contact]\n" + scene.contact_keys;
  if (scene.erosion) text += "\n[erosion]\n";
  if (scene.spindle) text += "\n[spindle]\n";
  if (scene.record) text += "\n[record]\n";
  if (scene.display) text += "\n[display]\n";
  return text;
}

SceneContext test_context() {
  static const TemporaryFolder folder;  // goes with the process
  write_tools(folder.path().string());
  return {{folder.path().string(), test::in_source("app/tools")}};
}

LoadedScene load_text(const std::string& text, const std::vector<std::string>& sets, const std::string& file_name) {
  auto document = TomlDocument::parse(text, file_name);
  REQUIRE_MESSAGE(document.ok(), (document ? "" : document.error().text()));
  for (const std::string& set : sets) {
    const Status applied = document->set(set);
    REQUIRE_MESSAGE(applied.ok(), (applied ? "" : applied.error().text()));
  }
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*loaded);
}

LoadedScene load_small(const SmallScene& scene) { return load_text(scene_text(scene), scene.sets); }

LoadedScene load_parietal(const std::vector<std::string>& sets) {
  const std::string file = in_source("app/scenes/parietal.toml");
  LoadedScene out = load_text((std::ostringstream() << std::ifstream(file).rdbuf()).str(), sets, file);
  (void)out.scene.effects.remove("display");
  if (std::ranges::none_of(sets, [](const std::string& set) { return set.starts_with("clutch."); }))
    (void)out.scene.effects.remove("clutch");
  return out;
}

DrillRun::DrillRun(LoadedScene loaded, const SimulationOptions& options) : loaded_(std::make_unique<LoadedScene>(std::move(loaded))) {
  Issues issues;
  simulation_ = Simulation::create(loaded_->scene, loaded_->bone, loaded_->tool, options, issues);
  REQUIRE_MESSAGE(simulation_ != nullptr, (issues.empty() ? "" : issues.front().text()));
}

DrillRun& DrillRun::run() {
  const Status ran = simulation_->run();
  REQUIRE_MESSAGE(ran.ok(), (ran ? "" : ran.error().text()));
  return *this;
}

WatchedHand::WatchedHand(const LoadedScene& loaded, std::function<void()> watch) : hand_(scene_hand(loaded)), watch_(std::move(watch)) {}

ReplayRun::ReplayRun(const std::string& path, SimulationOptions options) {
  auto session = SessionReader::open(path);
  REQUIRE_MESSAGE(session.ok(), (session ? "" : session.error().text()));
  session_ = std::make_unique<SessionReader>(std::move(session).value());
  auto hand = RecordedHand::create(*session_);
  REQUIRE_MESSAGE(hand.ok(), (hand ? "" : hand.error().text()));
  hand_ = std::make_unique<RecordedHand>(std::move(hand).value());
  options.hand = hand_.get();
  run_ = std::make_unique<DrillRun>(load_text(session_->meta().scene, {}), options);
  const Status replayed = run_->simulation().run_recorded(*session_, *hand_);
  REQUIRE_MESSAGE(replayed.ok(), (replayed.ok() ? "" : replayed.error().text()));
}

DrillRun& run_recorded(DrillRun& run, const std::string& path) {
  const LoadedScene& loaded = run.loaded();
  const SessionMeta meta{.program = "test",
                         .scene_path = loaded.scene.file,
                         .scene = loaded.scene.text,
                         .tool = loaded.tool_text,
                         .seed = loaded.scene.hand.seed,
                         .created = "2026-01-01T00:00:00Z"};
  auto session = SessionWriter::create(path, meta, session_layout(run.simulation().stage()));
  REQUIRE_MESSAGE(session.ok(), (session ? "" : session.error().text()));
  run.simulation().set_session(&*session);
  run.run();
  run.simulation().set_session(nullptr);
  REQUIRE(session->hash({"voxels", std::to_string(run.voxel_hash())}));
  REQUIRE(session->hash({"forces", std::to_string(run.simulation().force_hash())}));
  REQUIRE(session->close());
  return run;
}

std::vector<double> session_column(const std::string& path, const std::string& name) {
  const auto session = SessionReader::open(path);
  REQUIRE_MESSAGE(session.ok(), (session ? "" : session.error().text()));
  for (const SessionStream& stream : session->streams()) {
    if (std::ranges::find(stream.columns, name, &SessionColumn::name) == stream.columns.end()) continue;
    const auto values = session->column(stream.name, name);
    REQUIRE(values);
    return *values;
  }
  FAIL(name);
  return {};
}

double slowest_spin(const Simulation& simulation) {
  const auto rpm = simulation.stage().figure("spindle", "slowest_rpm");
  return rpm ? *rpm * kRevPerMinute : simulation.stage().config.tool.spin;
}

double figure(const Simulation& simulation, const std::string& table, const std::string& name) {
  const auto value = simulation.stage().figure(table, name);
  REQUIRE_MESSAGE(value.has_value(), table << " reports no " << name);
  return *value;
}

double first_contact(const Simulation& simulation, double force) {
  for (const RunSample& sample : simulation.samples())
    if (sample.force > force) return sample.time;
  return -1.0;
}

double time_at_depth(const Simulation& simulation, double depth) {
  const std::vector<RunSample>& samples = simulation.samples();
  for (std::size_t n = 1; n < samples.size(); ++n) {
    if (samples[n].depth < depth) continue;
    const double share = (depth - samples[n - 1].depth) / (samples[n].depth - samples[n - 1].depth);
    return samples[n - 1].time + share * (samples[n].time - samples[n - 1].time);
  }
  return -1.0;
}

}  // namespace burrhole::test
