// What becomes of the results of an earlier run, also after a kill between any two steps.

#include "app/job/run_folder.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "app/session/session.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

namespace fs = std::filesystem;

using Contents = std::map<std::string, std::string>;  // of the files of a folder, by their paths in it

void put(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

Contents contents(const fs::path& folder) {
  Contents out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    out[entry.path().lexically_relative(folder).string()].assign(std::istreambuf_iterator<char>(file), {});
  }
  return out;
}

void make_session(const fs::path& path) {
  fs::create_directories(path.parent_path());
  auto writer = SessionWriter::create(path.string(), {}, {{{"servo", {{"time", "s"}}}}, 100, 1});
  REQUIRE(writer);
  REQUIRE(writer->close());
}

EarlierResultsConfig config_of(const fs::path& folder) { return {.folder = folder.string(), .session = "session.sqlite", .inputs = {}}; }

/// Sets the results aside, as a run does, and puts them back, as one does that does not begin.
void set_aside_and_put_back(const fs::path& folder) {
  const auto earlier = EarlierResults::set_aside(config_of(folder));
  REQUIRE_MESSAGE(earlier.ok(), (earlier ? "" : earlier.error().text()));
}

TEST_CASE("run folder: results that a killed run has set aside come back, in place of what it had made itself") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", aside = out / ".burrhole-earlier";
  put(out / "summary.json", "{}"), put(out / "bone.vdb", "bone"), make_session(out / "session.sqlite"), make_session(out / "a/b.sqlite");
  Contents before = contents(out);
  before["session.sqlite-wal"] = "of the earlier run";
  for (const char* name : {"summary.json", "bone.vdb", "session.sqlite", "a/b.sqlite"}) {
    fs::create_directories((aside / name).parent_path());
    fs::rename(out / name, aside / name);
  }
  put(aside / "session.sqlite-wal", "of the earlier run");
  make_session(out / "session.sqlite");
  put(out / "session.sqlite-wal", "of the killed run"), put(out / "session.sqlite-shm", "of the killed run");
  set_aside_and_put_back(out);
  CHECK(contents(out) == before);
  CHECK_FALSE(fs::exists(aside));
}

TEST_CASE("run folder: a session of a killed run comes back too, though it has no summary") {
  const TemporaryFolder folder;
  make_session(folder.path() / ".burrhole-earlier/session.sqlite");
  put(folder.path() / ".burrhole-earlier/session.sqlite-wal", "rows of the first run");
  make_session(folder.path() / "session.sqlite");
  set_aside_and_put_back(folder.path());
  CHECK(contents(folder.path()).at("session.sqlite-wal") == "rows of the first run");
}

TEST_CASE("run folder: what comes back replaces no results of a run that has ended, and what is being deleted does not come back") {
  const TemporaryFolder folder;
  put(folder.path() / ".burrhole-earlier/after.png", "old"), put(folder.path() / ".burrhole-earlier/before.png", "old");
  put(folder.path() / ".burrhole-dropped/cutaway.png", "old");
  put(folder.path() / "summary.json", "{}"), put(folder.path() / "before.png", "new");
  set_aside_and_put_back(folder.path());
  CHECK(contents(folder.path()) == Contents{{"after.png", "old"}, {"before.png", "new"}, {"summary.json", "{}"}});
}

TEST_CASE("run folder: earlier results that cannot be dropped stay, with their bone") {
  const TemporaryFolder folder;
  put(folder.path() / "bone.vdb", "bone"), put(folder.path() / "summary.json", "{}");
  {
    auto earlier = EarlierResults::set_aside(config_of(folder.path()));
    REQUIRE(earlier);
    put(folder.path() / ".burrhole-dropped", "in the way");
    const Status dropped = earlier->drop();
    REQUIRE_FALSE(dropped);
    CHECK(dropped.error().place == folder.file(".burrhole-earlier"));
  }
  CHECK(contents(folder.path()) == Contents{{".burrhole-dropped", "in the way"}, {"bone.vdb", "bone"}, {"summary.json", "{}"}});
}

TEST_CASE("run folder: an input is never replaced by the bone of an earlier run") {
  const TemporaryFolder folder;
  put(folder.path() / "bone.vdb", "bone"), put(folder.path() / "bone.earlier.vdb", "input"), put(folder.path() / "summary.json", "{}");
  const Contents before = contents(folder.path());
  EarlierResultsConfig config = config_of(folder.path());
  config.inputs = {folder.file("bone.earlier.vdb")};
  {
    const auto refused = EarlierResults::set_aside(config);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::bad_input);
    CHECK(refused.error().place == folder.file("bone.earlier.vdb"));
  }
  CHECK(contents(folder.path()) == before);
  fs::remove(folder.file("bone.vdb"));  // then nothing gets its name
  auto earlier = EarlierResults::set_aside(config);
  REQUIRE(earlier);
  REQUIRE(earlier->drop());
  earlier->replaced();
  CHECK(contents(folder.path()) == Contents{{"bone.earlier.vdb", "input"}});
}

TEST_CASE("run folder: a result that is a link is set aside as the link, and what it leads to stays") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  put(folder.path() / "store/bone.vdb", "bone"), put(folder.path() / "store/after.png", "picture"), put(out / "summary.json", "{}");
  fs::create_symlink("../store/bone.vdb", out / "bone.vdb");
  fs::create_symlink("../store/after.png", out / "after.png");
  auto earlier = EarlierResults::set_aside(config_of(out));
  REQUIRE(earlier);
  REQUIRE(earlier->drop());
  CHECK(fs::is_symlink(out / "bone.earlier.vdb"));
  CHECK(contents(out) == Contents{{"bone.earlier.vdb", "bone"}});
  CHECK(contents(folder.path() / "store") == Contents{{"after.png", "picture"}, {"bone.vdb", "bone"}});
}

TEST_CASE("run folder: temporary files of a killed run are removed, those of the check and of a chosen scene too") {
  const TemporaryFolder folder;
  for (const char* name : {".burrhole-probe", "scene.toml", "sound.wav", "after.png", "notes.txt"})
    put(folder.file(std::string(name) + ".99-0123456789abcdef.tmp"), "part");
  auto earlier = EarlierResults::set_aside(config_of(folder.path()));
  REQUIRE(earlier);
  REQUIRE(earlier->drop());
  CHECK(contents(folder.path()) == Contents{{"notes.txt.99-0123456789abcdef.tmp", "part"}});
}

TEST_CASE("run folder: files with the names of results are taken for results only beside a sign of a run") {
  const TemporaryFolder folder;
  CHECK(check_is_ours(folder.file("none")));
  CHECK(check_is_ours(folder.path().string()));
  put(folder.file("notes.txt"), "x"), put(folder.file("scene.toml"), "x");  // which a drill does not replace
  CHECK(check_is_ours(folder.path().string()));
  for (const char* name : {"report.html", "bone.vdb", "before.png", "sound.wav"}) {
    put(folder.file(name), "of a person");
    const Status refused = check_is_ours(folder.path().string());
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::bad_input);
    CHECK(refused.error().place == folder.file(name));
    for (const char* sign : {"summary.json", "bone.earlier.vdb", ".burrhole-run", ".burrhole-earlier/x"}) {
      put(folder.file(sign), "");
      CHECK_MESSAGE(check_is_ours(folder.path().string()), sign);
      fs::remove_all(folder.path() / *fs::path(sign).begin());
    }
    make_session(folder.file("mine.sqlite"));
    CHECK(check_is_ours(folder.path().string()));
    fs::remove(folder.file("mine.sqlite"));
    fs::remove(folder.file(name));
  }
}

}  // namespace
}  // namespace burrhole::test
