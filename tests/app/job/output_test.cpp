// What a run writes: everything by default, and of bone.vdb, report and plot only what the keys of [output] leave on.

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/job/drill_job.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

using Names = std::set<std::string>;

struct Written {
  Names files;
  std::string report;       ///< text of the page
  std::size_t samples = 0;  ///< that the run kept for plots
};

Written drill_into(const TemporaryFolder& folder, const std::string& tables, const std::string& name = "out") {
  const LoadedScene loaded = load_text(scene_text({.record = true}) + tables, {"duration_s=0.3"});
  Written out;
  DrillJob job;
  job.folder = folder.file(name);
  job.watch = [&](Simulation& simulation) { out.samples = simulation.samples().size(); };
  const auto summary = drill(loaded, job);
  REQUIRE_MESSAGE(summary.ok(), (summary ? "" : summary.error().text()));
  for (const auto& entry : std::filesystem::directory_iterator(job.folder)) out.files.insert(entry.path().filename().string());
  std::ifstream page(job.folder + "/report.html");
  out.report.assign(std::istreambuf_iterator<char>(page), {});
  return out;
}

TEST_CASE("output: everything is written by default, also with an empty table") {
  const TemporaryFolder folder;
  for (const char* tables : {"", "[output]\n", "[output]\nbone = true\nreport = true\nplots = true\n"}) {
    const Written all = drill_into(folder, tables);
    CHECK(all.files == Names{"bone.vdb", "report.html", "session.sqlite", "summary.json"});
    CHECK(all.report.find("Course") != std::string::npos);
    CHECK(all.samples >= 200);  // one a millisecond, at the last report of progress
  }
}

TEST_CASE("output: each key leaves out its file, and what only that file needs is not computed") {
  const TemporaryFolder folder;
  const Written no_bone = drill_into(folder, "[output]\nbone = false\n", "no_bone");
  CHECK(no_bone.files == Names{"report.html", "session.sqlite", "summary.json"});
  const Written no_plots = drill_into(folder, "[output]\nplots = false\n", "no_plots");
  CHECK(no_plots.files == Names{"bone.vdb", "report.html", "session.sqlite", "summary.json"});
  CHECK(no_plots.report.find("Course") == std::string::npos);
  CHECK(no_plots.report.find("Peak force") != std::string::npos);
  CHECK(no_plots.samples == 0);
  const Written no_report = drill_into(folder, "[output]\nreport = false\n", "no_report");
  CHECK(no_report.files == Names{"bone.vdb", "session.sqlite", "summary.json"});
  CHECK(no_report.samples == 0);
}

TEST_CASE("output: a report of an earlier run does not stay beside the results of one that writes none; its bone does, by another name") {
  const TemporaryFolder folder;
  CHECK(drill_into(folder, "").files.contains("report.html"));
  const Written again = drill_into(folder, "[output]\nreport = false\nbone = false\n");
  CHECK(again.files == Names{"bone.earlier.vdb", "session.sqlite", "summary.json"});
  CHECK(drill_into(folder, "[output]\nreport = false\n").files == Names{"bone.vdb", "session.sqlite", "summary.json"});
}

TEST_CASE("output: the keys can be set from the command line's overrides, and others are refused") {
  CHECK_FALSE(load_text(scene_text({}), {"output.bone=false"}).scene.output.bone);
  const auto document = TomlDocument::parse(scene_text({}) + "[output]\nsummary = false\n", "small.toml");
  REQUIRE(document);
  Issues issues;
  CHECK_FALSE(load_scene(*document, test_context(), issues).has_value());
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().text().find("summary") != std::string::npos);
}

TEST_CASE("output: a run that drills and ends with the bit in bone says so, and no other") {
  RunSummary s;
  s.erosion_points = 1000, s.spin_rpm = 1000.0, s.thickness_mm = 7.04, s.reached_mm = 3.18;
  const auto warning = [](RunSummary of, const char* end, bool bench) {
    of.end = end, of.bench = bench;
    return unfinished_warning(of).value_or("");
  };
  CHECK(warning(s, "done", false) ==
        "hand: it detected a breakthrough 3.18 mm deep in 7.04 mm of bone, which is not drilled through: "
        "hand.kind = \"feed\" drills on, to hand.stop_mm");
  CHECK(warning(s, "duration", false) ==
        "hand: the time ended 3.18 mm deep in 7.04 mm of bone, which is not drilled through: raise duration_s");
  CHECK(warning(s, "duration", true) ==
        "hand: its stop was not reached 3.18 mm deep in 7.04 mm of bone, which is not drilled through: raise duration_s");
  CHECK(warning(s, "done", true).empty());  // a blind hole
  CHECK(warning(s, "stopped", false).empty());
  CHECK(outcome_text([&] {
          RunSummary b = s;
          b.end = "done", b.bench = true;
          return b;
        }())
            .find("breakthrough") == std::string::npos);
  for (auto change : {+[](RunSummary& r) { r.breakthrough_s = 20.0; }, +[](RunSummary& r) { r.passed_s = 20.0; },
                      +[](RunSummary& r) { r.spin_rpm = 0.0; }, +[](RunSummary& r) { r.erosion_points = 0; }}) {
    RunSummary other = s;
    change(other);
    CHECK(warning(other, "done", false).empty());
    CHECK(warning(other, "duration", false).empty());
  }
}

/// Draws nothing, and fails at one picture or frame.
class FailingSink final : public PictureSink {
 public:
  explicit FailingSink(std::string fails_at) : fails_at_(std::move(fails_at)) {}
  Status start(const VolumeView&, const TriangleMesh&) override { return {}; }
  void update(const TexelBox&) override {}
  Status draw(const std::string& name, const FrameView&, int, int, Hash64&) override { return answer(name); }
  Status film(const FrameView&, int, int) override { return answer(++frames_ == 3 ? "frame" : ""); }
  Result<std::vector<std::string>> files() override {
    if (fails_at_ == "files") return bad_input("no file");
    return std::vector<std::string>();
  }
  std::string driver() const override { return "none"; }
  RunSummary::Display display() const override { return {}; }

 private:
  Status answer(const std::string& name) const { return name == fails_at_ ? Status(bad_input("no " + name)) : Status(); }
  std::string fails_at_;
  int frames_ = 0;
};

TEST_CASE("output: a picture that fails costs a run neither its bone nor its figures, and is its error") {
  const TemporaryFolder folder;
  const LoadedScene loaded = load_text(scene_text({.record = true, .display = true}), {"duration_s=0.3"});
  for (const char* at : {"before", "frame", "after", "cutaway", "files"}) {
    INFO("fails at " << at);
    DrillJob job;
    job.folder = folder.file(at);
    job.film_hz = 10.0;
    job.make_sink = [&](const DisplayConfig&, const std::string&) -> Result<std::unique_ptr<PictureSink>> {
      return std::unique_ptr<PictureSink>(std::make_unique<FailingSink>(at));
    };
    std::filesystem::create_directory(job.folder);
    std::ofstream(job.folder + "/bone.earlier.vdb") << "of an earlier run";
    const auto summary = drill(loaded, job);
    REQUIRE_FALSE(summary);
    CHECK(summary.error().message == (std::string(at) == "files" ? "no file" : "no " + std::string(at)));
    Names files;
    for (const auto& entry : std::filesystem::directory_iterator(job.folder)) files.insert(entry.path().filename().string());
    const bool began = std::string(at) != "before";
    CHECK(files.contains("bone.vdb") == began);
    CHECK(files.contains("summary.json") == began);
    CHECK(files.contains("report.html") == began);
    CHECK(files.contains("bone.earlier.vdb") == (std::string(at) != "files"));
    if (!began) continue;
    std::ifstream file(job.folder + "/summary.json");
    const std::string json(std::istreambuf_iterator<char>(file), {});
    CHECK((json.find("an error ended the run at 0.300 s: no frame") != std::string::npos) == (std::string(at) == "frame"));
    CHECK((json.find("\"end\": \"stopped\"") != std::string::npos) == (std::string(at) == "frame"));
  }
}

TEST_CASE("output: the warning of an unfinished hole reaches the caller and summary.json") {
  const LoadedScene loaded = load_text(scene_text({.record = true}), {"duration_s=0.3"});
  std::vector<std::string> warned;
  DrillJob job;
  job.warn = [&](const std::string& line) { warned.push_back(line); };
  const auto summary = drill(loaded, job);
  REQUIRE(summary.ok());
  REQUIRE(!summary->warnings.empty());
  CHECK(summary->warnings.back() == unfinished_warning(*summary));
  CHECK(warned.back() == summary->warnings.back());
  CHECK(summary_json(*summary).find(warned.back()) != std::string::npos);
}

}  // namespace
}  // namespace burrhole::test
