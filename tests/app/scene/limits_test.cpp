// [limits] memory_mb: the bone of a scene that is predicted to need more is kept in a file; where that does not suffice the scene is refused
// after the headers of its volume, with the sizes. That the prediction
// is near the measured memory is judged by commands_test.py, which runs the program.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <fstream>

#include "app/scene/memory_plan.h"
#include "core/voxel/paged_bone.h"
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

TEST_CASE("limits: the predicted memory decides to the megabyte: bone in memory, bone in a file, or a line with the key and the sizes") {
  const std::string text = scene_text({});
  const LoadedScene loaded = load_text(text, {});
  const Vec3i dims = loaded.bone->dims();
  // What load_scene() knows before the bone exists: its grid, and no more than an upper bound of its bytes.
  const BoneShape shape{dims, loaded.bone->bone_from_index(), dense_bone_bytes(dims, true)};
  const BoneShape paged{dims, loaded.bone->bone_from_index(), PagedBone::index_bytes(dims, 1.0)};
  CHECK(shape.bytes >= loaded.bone->bytes());
  const double peak = static_cast<double>(plan_memory(loaded.scene, loaded.tool, shape, 0).peak) * 1e-6;
  const double least = static_cast<double>(plan_memory(loaded.scene, loaded.tool, paged, dense_fields_bytes(dims)).peak) * 1e-6;
  REQUIRE(least < peak - 0.1);
  const LoadedScene in_memory = load_text(text + limit(peak + 0.001), {});
  CHECK(!in_memory.bone->file_bytes());
  CHECK(in_memory.paged_note.empty());
  for (const double megabytes : {peak - 0.001, least + 0.001}) {
    const LoadedScene in_file = load_text(text + limit(megabytes), {});
    REQUIRE(in_file.bone->file_bytes());
    CHECK(in_file.bone->bytes() <= paged.bytes);
    CHECK(*in_file.bone->file_bytes() <= PagedBone::file_bytes(dims, true, 1.0));
    for (const std::string& part : {fmt::format("may need {:.0f} MB, more than memory_mb = {:.0f}", peak, megabytes),
                                    fmt::format("so it may need {:.0f} MB", least), std::string("bone.vdb will hold the changes alone")})
      CHECK_MESSAGE(in_file.paged_note.find(part) != std::string::npos, in_file.paged_note);
  }
  CHECK(load_text(text + limit(peak - 0.001) + "[output]\nwhole_bone = false\n", {}).paged_note.find("bone.vdb") == std::string::npos);
  const std::string line = refusal(text + limit(least - 0.001));
  CHECK(line.starts_with("limits.toml:"));
  CHECK(line.find("limits.memory_mb is exceeded: the run may need ") != std::string::npos);
  CHECK(line.find("program 55") != std::string::npos);
  CHECK(line.find(fmt::format("{:.0f} MB with the bone in a temporary file", least)) != std::string::npos);
  CHECK(line.find('\n') == std::string::npos);
}

TEST_CASE("limits: without room for the file the scene is refused with the folder and the bytes") {
  const std::string text = scene_text({});
  const LoadedScene loaded = load_text(text, {});
  const Vec3i dims = loaded.bone->dims();
  const BoneShape shape{dims, loaded.bone->bone_from_index(), dense_bone_bytes(dims, true)};
  const double peak = static_cast<double>(plan_memory(loaded.scene, loaded.tool, shape, 0).peak) * 1e-6;
  const auto document = TomlDocument::parse(text + limit(peak - 0.001), "limits.toml");
  Issues issues;
  CHECK(!load_scene(*document, test_context(), issues, {.tool_text = {}, .progress = {}, .say = {}, .page_folder = "/no/such/folder"}));
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().code == ErrorCode::unavailable);
  CHECK(issues.front().text().starts_with("limits.toml:"));
  CHECK(issues.front().text().find("in /no/such/folder cannot be made") != std::string::npos);
  CHECK(issues.front().text().find("it needs about 0.2 MB") != std::string::npos);  // 3^3 blocks of 512 voxels of 13 bytes
}

TEST_CASE("limits: a scan is refused by its header, before its voxels are read") {
  const TemporaryFolder folder;
  const std::string text = scene_on_broken_scan(folder);
  const std::string unread = refusal(text);
  CHECK(unread.find("scan.nrrd") != std::string::npos);  // the voxels are what is wrong
  CHECK(refusal(text + limit(100000.0)) == unread);
  const std::string line = refusal(text + limit(200.0));
  CHECK(line.find("memory_mb is exceeded") != std::string::npos);
  // 256 MB of the scan, and 250 bytes a voxel of a layer of 400 x 400.
  CHECK(line.find("while the bone is made 296 MB") != std::string::npos);
}

TEST_CASE("limits: a generated bone counts with the fields that it is made from, and is refused before they are made") {
  // 650 x 650 x 650 voxels, 275 million: 3.6 GB of fields and 4.8 GB of bone, which no test has.
  const std::string text =
      scene_text({.volume = "source = \"phantom:plate\"\nspacing_mm = 0.1\nextent_mm = [65, 65, 65]\nabove_mm = 2\nthickness_mm = 6\n"});
  const std::string line = refusal(text + limit(1000.0));
  CHECK(line.find("memory_mb is exceeded") != std::string::npos);
  CHECK(line.find("and while the bone is made 3570") != std::string::npos);  // 13 bytes a voxel
}

TEST_CASE("limits: memory_mb has a range, and the table no other key") {
  CHECK(refusal(scene_text({}) + limit(0.5)).find("limits.memory_mb = 0.5 must be in") != std::string::npos);
  CHECK(refusal(scene_text({}) + "[limits]\nmemory = 5\n").find("memory") != std::string::npos);
  CHECK(refusal(scene_text({}) + "[limits]\n").empty());
}

}  // namespace
}  // namespace burrhole::test
