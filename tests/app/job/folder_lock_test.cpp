#include "app/job/folder_lock.h"

#include <doctest/doctest.h>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

TEST_CASE("a folder is taken once, the error names its owner, and afterwards nothing is left") {
  const TemporaryFolder folder;
  {
    const auto first = FolderLock::take(folder.path().string());
    REQUIRE(first);
    const auto second = FolderLock::take(folder.path().string());
    REQUIRE_FALSE(second);
    CHECK(second.error().code == ErrorCode::bad_input);
    CHECK(second.error().message.find("process " + std::to_string(getpid())) != std::string::npos);
    CHECK_FALSE(FolderLock::take(folder.path().string()));  // the refusal has not removed the other's file
  }
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK(FolderLock::take(folder.path().string()));
}

TEST_CASE("the file of a killed run locks nothing") {
  const TemporaryFolder folder;
  std::ofstream(folder.file(".burrhole-run")) << "process 1 since long ago\n";
  CHECK(FolderLock::take(folder.path().string()));
}

TEST_CASE("without a folder nothing is locked; where the file cannot be made there is one line") {
  CHECK(FolderLock::take({}));
  const TemporaryFolder folder;
  const auto none = FolderLock::take(folder.file("none"));
  REQUIRE_FALSE(none);
  CHECK(none.error().place.find("none") != std::string::npos);
}

TEST_CASE("of processes that take a folder together, never two have it") {
  const TemporaryFolder folder;
  constexpr int kProcesses = 4, kRounds = 200;
  const std::string inside = folder.file("inside");
  std::vector<pid_t> children;
  for (int n = 0; n < kProcesses; ++n) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      int wrong = 0, taken = 0;
      while (taken < kRounds) {
        const auto lock = FolderLock::take(folder.path().string());
        if (!lock) continue;
        ++taken;
        wrong += mkdir(inside.c_str(), 0700) == 0 ? 0 : 1;  // exists: somebody else is inside
        rmdir(inside.c_str());
      }
      _exit(wrong == 0 ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(status == 0);
  }
}

}  // namespace
}  // namespace burrhole
