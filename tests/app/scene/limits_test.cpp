// [limits] memory_mb: a scene that is predicted to need more is refused after the headers of its volume, with the sizes. That the prediction
// is near the measured memory is judged by commands_test.py, which runs the program.

#include <doctest/doctest.h>

#include <fstream>

#include "app/scene/memory_plan.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// The one line that a scene is refused with; empty: it is not.
std::string refusal(const std::string& text) {
  const auto document = TomlDocument::parse(text, "limits.toml");
  REQUIRE(document.ok());
  Issues issues;
  const auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE(loaded.has_value() == issues.empty());
  REQUIRE(issues.size() <= 1);
  return issues.empty() ? "" : issues.front().text();
}

std::string limit(double megabytes) { return "[limits]\nmemory_mb = " + std::to_string(megabytes) + "\n"; }

/// A scene on a scan whose header is sound and whose voxels are not: 400 x 400 x 400 floats, 256 MB, said to be compressed.
std::string scene_on_broken_scan(const TemporaryFolder& folder) {
  std::ofstream(folder.file("scan.nrrd")) << "NRRD0004\ntype: float\ndimension: 3\nsizes: 400 400 400\nspace: left-posterior-superior\n"
                                             "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: gzip\n"
                                             "endian: little\n\n"
                                          << std::string(300'000, 'x');  // as many bytes as such a scan may be packed into
  return scene_text({.volume = "source = \"" + folder.file("scan.nrrd") + "\"\n"});
}

TEST_CASE("limits: the predicted memory decides to the megabyte, and the line names the key and the sizes") {
  const LoadedScene loaded = load_text(scene_text({}), {});
  const Vec3i dims = loaded.bone->dims();
  // What load_scene() knows before the bone exists: its grid, and no more than an upper bound of its bytes.
  const BoneShape shape{dims, loaded.bone->bone_from_index(), dense_bone_bytes(dims, true)};
  CHECK(shape.bytes >= loaded.bone->bytes());
  const double peak = static_cast<double>(plan_memory(loaded.scene, loaded.tool, shape, 0).peak) * 1e-6;
  CHECK(refusal(scene_text({}) + limit(peak + 0.001)).empty());
  const std::string line = refusal(scene_text({}) + limit(peak - 0.001));
  CHECK(line.starts_with("limits.toml:"));
  CHECK(line.find("limits.memory_mb is exceeded: the run may need ") != std::string::npos);
  CHECK(line.find("program 55") != std::string::npos);
  CHECK(line.find('\n') == std::string::npos);
}

TEST_CASE("limits: a scan is refused by its header, before its voxels are read") {
  const TemporaryFolder folder;
  const std::string text = scene_on_broken_scan(folder);
  const std::string unread = refusal(text);
  CHECK(unread.find("scan.nrrd") != std::string::npos);  // the voxels are what is wrong
  CHECK(refusal(text + limit(100000.0)) == unread);
  const std::string line = refusal(text + limit(200.0));
  CHECK(line.find("memory_mb is exceeded") != std::string::npos);
  CHECK(line.find("while the scan is read 256 MB") != std::string::npos);
}

TEST_CASE("limits: memory_mb has a range, and the table no other key") {
  CHECK(refusal(scene_text({}) + limit(0.5)).find("limits.memory_mb = 0.5 must be in") != std::string::npos);
  CHECK(refusal(scene_text({}) + "[limits]\nmemory = 5\n").find("memory") != std::string::npos);
  CHECK(refusal(scene_text({}) + "[limits]\n").empty());
}

}  // namespace
}  // namespace burrhole::test
