// Files of the bone that an input asks for in the middle of a run: each is the bone of a run that ends at that moment, and the run goes on as
// without it.
#include "app/job/bone_exports.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "app/job/drill_job.h"
#include "app/job/run_folder.h"
#include "app/stage/result_files.h"
#include "tests/support/drill_scene.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"
#include "volumes/export_bone.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

namespace fs = std::filesystem;

LoadedScene scene_of(double seconds) {
  const SmallScene scene{.record = true, .sets = {"hand.standoff_mm=0.2"}};
  LoadedScene out = load_small(scene);
  out.scene.duration = seconds;
  return out;
}

Input export_at(double time, const std::string& format) {
  return {static_cast<std::uint64_t>(time * 1000.0 + 0.5), InputKind::export_bone, 0.0, format, {}};
}

/// The bone of a run that ends at `seconds`, written by the exporter itself.
std::string bone_at(double seconds, const std::string& format, const TemporaryFolder& folder) {
  DrillRun run(scene_of(seconds));
  run.run();
  const std::string path = folder.file("alone." + format);
  const auto done = export_bone(run.simulation().voxmap(), {.path = path, .ball = true});
  REQUIRE_MESSAGE(done.ok(), (done ? "" : done.error().text()));
  return bytes_of(path);
}

DrillJob job_into(const std::string& folder, std::vector<Input> inputs) {
  DrillJob job;
  job.folder = folder;
  job.inputs = std::move(inputs);
  return job;
}

}  // namespace

TEST_CASE("exported bone: it is that of a run which ends at that moment, in every format, and the run goes on to the same bits") {
  const TemporaryFolder folder;
  std::vector<std::string> lines;
  DrillJob job = job_into(folder.file("out"), {export_at(0.4, "stl"), export_at(0.4, "nrrd"), export_at(0.7, "stl"), export_at(0.7, "ply"),
                                               export_at(0.7, "vdb")});
  job.say = [&](const std::string& line) { lines.push_back(line); };
  const auto with = drill(scene_of(1.0), job);
  REQUIRE_MESSAGE(with.ok(), (with ? "" : with.error().text()));
  const auto without = drill(scene_of(1.0), {});
  REQUIRE(without);
  CHECK(with->voxel_hash == without->voxel_hash);
  CHECK(with->force_hash == without->force_hash);
  REQUIRE(lines.size() == 5);
  CHECK(lines.front().starts_with("bone_at_0.400s.stl: STL, "));
  CHECK(lines[1].starts_with("bone_at_0.400s.nrrd: NRRD, 24 x 24 x "));

  const fs::path out(job.folder);
  const std::string early = bytes_of(out / "bone_at_0.400s.stl"), late = bytes_of(out / "bone_at_0.700s.stl");
  CHECK(early == bone_at(0.4, "stl", folder));
  CHECK(bytes_of(out / "bone_at_0.400s.nrrd") == bone_at(0.4, "nrrd", folder));
  CHECK(late == bone_at(0.7, "stl", folder));
  CHECK(bytes_of(out / "bone_at_0.700s.ply") == bone_at(0.7, "ply", folder));
  CHECK(fs::file_size(out / "bone_at_0.700s.vdb") > 0);
  CHECK(early != late);  // bone is cut between the two, so a copy that is made late would be seen

  ReplayRun replayed((out / "session.sqlite").string(), {.history = true});
  CHECK(hash_text(replayed.run().voxel_hash()) == with->voxel_hash);
}

TEST_CASE("exported bone: it holds an undo, and a bone that was drilled before the run") {
  const TemporaryFolder folder;
  const Input off{500, InputKind::spin, 0.0, {}, {}}, undo{550, InputKind::undo, 0.0, {}, {}};
  const auto first = drill(scene_of(0.9), job_into(folder.file("first"), {off, undo, export_at(0.6, "nrrd")}));
  REQUIRE_MESSAGE(first.ok(), (first ? "" : first.error().text()));
  CHECK(bytes_of(folder.file("first") + "/bone_at_0.600s.nrrd") == bone_at(0.001, "nrrd", folder));

  REQUIRE(drill(scene_of(0.6), job_into(folder.file("drilled"), {})));
  DrillJob again = job_into(folder.file("again"), {export_at(0.0, "nrrd")});
  again.restore_path = folder.file("drilled") + "/bone.vdb";
  const auto second = drill(scene_of(0.1), again);
  REQUIRE_MESSAGE(second.ok(), (second ? "" : second.error().text()));
  CHECK(bytes_of(folder.file("again") + "/bone_at_0.000s.nrrd") == bone_at(0.6, "nrrd", folder));
}

TEST_CASE("exported bone: the next run of the folder takes it away; in a folder without a run its name is that of a foreign file") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  REQUIRE(drill(scene_of(0.3), job_into(out, {export_at(0.2, "stl")})));
  CHECK(fs::exists(out + "/bone_at_0.200s.stl"));
  REQUIRE(drill(scene_of(0.3), job_into(out, {})));
  CHECK_FALSE(fs::exists(out + "/bone_at_0.200s.stl"));
  CHECK(fs::exists(out + "/bone.vdb"));
  fs::create_directories(folder.file("foreign"));
  CHECK(check_is_ours(folder.file("foreign")).ok());
  std::ofstream(folder.file("foreign") + "/bone_at_0.200s.stl") << "someone's";
  CHECK_FALSE(check_is_ours(folder.file("foreign")).ok());
  for (const char* other : {"bone_at_.stl", "bone_at_home.stl", "bone_at_1.0.stl", "my_bone_at_1.000s.stl"})
    CHECK_FALSE(is_result_name(other));
}

TEST_CASE("exported bone: a file that cannot be written fails the run, whose other results are there; without a folder it is refused") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  fs::create_directories(out + "/bone_at_0.200s.stl/full");
  const auto failed = drill(scene_of(0.3), job_into(out, {export_at(0.2, "stl")}));
  REQUIRE_FALSE(failed.ok());
  CHECK(failed.error().text().find("bone_at_0.200s.stl") != std::string::npos);
  CHECK(fs::exists(out + "/summary.json"));
  CHECK(fs::exists(out + "/bone.vdb"));

  std::vector<std::string> warnings;
  DrillJob nowhere = job_into({}, {export_at(0.2, "stl")});
  nowhere.warn = [&](const std::string& line) { warnings.push_back(line); };
  REQUIRE(drill(scene_of(0.3), nowhere));
  CHECK(std::ranges::count(warnings, "there is no output folder for the bone") == 1);
}

TEST_CASE("exported bone: a path that cannot be written is found before a mesh is made, and a write that fails makes no second one") {
  const TemporaryFolder folder;
  DrillRun run(scene_of(0.1));
  const Voxmap& bone = run.simulation().voxmap();
  const auto meshes = [&](const std::string& path, bool writes) {
    int made = 0;
    const auto done = write_bone(bone, path, [&] { ++made; });
    CHECK(done.ok() == writes);
    if (!done) CHECK(done.error().text().find(fs::path(path).filename().string()) != std::string::npos);
    return made;
  };
  for (const char* format : {"stl", "ply", "obj"}) {
    CAPTURE(format);
    const std::string taken = folder.file(std::string("taken.") + format), full = folder.file(std::string("full.") + format);
    fs::create_directories(taken + "/inside");
    CHECK(meshes(taken, false) == 0);
    fs::create_symlink("/dev/full", full);  // can be opened, and takes no byte
    CHECK(meshes(full, false) == 1);
    CHECK(meshes(folder.file(std::string("bone.") + format), true) == 1);
  }
  std::ofstream(folder.file("file")) << "no folder";
  CHECK(meshes(folder.file("file") + "/bone.stl", false) == 0);
  std::vector<std::string> left;  // no temporary file
  for (const auto& entry : fs::directory_iterator(folder.path())) left.push_back(entry.path().filename().string());
  CHECK(left.size() == 3 * 3 + 1);
}

TEST_CASE("exported bone: an unknown format is refused where it is written") {
  const auto read = [](const std::string& text, Issues& issues) {
    const auto document = TomlDocument::parse(text, "inputs.toml");
    REQUIRE(document);
    return read_inputs(*document, 1000, issues);
  };
  Issues none, issues;
  const auto inputs =
      read("[[input]]\ntime_s = 0.5\nkind = \"export\"\n[[input]]\ntime_s = 1\nkind = \"export\"\nformat = \"nii.gz\"\n", none);
  REQUIRE(inputs);
  CHECK(inputs->front().text == "stl");
  CHECK(inputs->back().text == "nii.gz");
  CHECK(inputs->back().tick == 1000);
  CHECK_FALSE(read("[[input]]\ntime_s = 0.5\nkind = \"export\"\nformat = \"png\"\n", issues));
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().text().starts_with("inputs.toml:4:"));
}
