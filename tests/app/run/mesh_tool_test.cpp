// A user's mesh as a tool: drills like the primitive of the same shape, and a session finds its file again.

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "app/session/recorded_hand.h"
#include "tests/support/drill_scene.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr const char* kMeshTool = "title = \"Ball from a file\"\n[mesh]\nfile = \"a ball.stl\"\nerosion_factor = 0.1\npitch_mm = 0.25\n";

/// The tool of the small scenes, a sphere of 2 mm, as a file beside `tool.toml`.
std::string write_tool(const TemporaryFolder& folder) {
  write_mesh(folder.file("a ball"), sphere_mesh({0, 0, 1e-3}, 1e-3, 4), MeshForm::stl_binary);
  std::ofstream(folder.file("tool.toml")) << kMeshTool;
  return folder.file("tool.toml");
}

}  // namespace

TEST_CASE("mesh tool: a ball from a file drills as the primitive does") {
  const TemporaryFolder folder;
  DrillRun primitive(SmallScene{.sets = {"duration_s=1.2"}});
  DrillRun mesh(SmallScene{.sets = {"duration_s=1.2", "tool.name=" + write_tool(folder)}});
  primitive.run();
  mesh.run();
  const double expected = time_at_depth(primitive.simulation(), 0.5e-3), found = time_at_depth(mesh.simulation(), 0.5e-3);
  MESSAGE("0.5 mm deep after " << expected << " s with the primitive, " << found << " s with the mesh");
  REQUIRE(expected > 0.0);
  REQUIRE(found > 0.0);
  // The same erosion points but for a few at the chords; the shells are sampled apart, by up to 0.7 of 0.25 mm, which moves the contact.
  CHECK(std::abs(found - expected) < 0.1 * expected);
}

TEST_CASE("mesh tool: a session replays from any folder while the mesh is there, and says so when it is gone") {
  const TemporaryFolder folder;
  const LoadedScene loaded = load_small(SmallScene{.record = true, .sets = {"duration_s=0.3", "tool.name=" + write_tool(folder)}});
  CHECK(loaded.tool_text.find(folder.file("a ball.stl")) != std::string::npos);
  const auto document = TomlDocument::parse(scene_text(SmallScene{}), "elsewhere/small.toml");
  REQUIRE(document.ok());
  Issues issues;
  const auto again = load_scene(*document, {}, issues, {.tool_text = loaded.tool_text, .progress = {}, .say = {}});
  REQUIRE_MESSAGE(again.has_value(), (issues.empty() ? "" : issues.front().text()));
  CHECK(again->tool.shell.positions == loaded.tool.shell.positions);
  CHECK(again->tool.erosion.positions == loaded.tool.erosion.positions);
  CHECK(again->tool_text == loaded.tool_text);
  std::filesystem::remove(folder.file("a ball.stl"));
  CHECK_FALSE(load_scene(*document, {}, issues, {.tool_text = loaded.tool_text, .progress = {}, .say = {}}));
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].code == ErrorCode::bad_input);
  CHECK(issues[0].text().find("the session's tool:") == 0);
  CHECK(issues[0].text().find("a ball.stl\" cannot be read: No such file or directory") != std::string::npos);
}

}  // namespace burrhole::test
