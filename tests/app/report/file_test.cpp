#include "app/report/file.h"

#include <doctest/doctest.h>

#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

TEST_CASE("write_file: makes folders, replaces whole, and leaves no temporary file") {
  const TemporaryFolder folder;
  const std::string path = folder.file("a/b/out.txt");
  REQUIRE(write_file(path, "first, and longer"));
  REQUIRE(write_file(path, "second"));
  const Result<std::string> back = read_file(path);
  REQUIRE(back);
  CHECK(*back == "second");
  const std::filesystem::directory_iterator files(folder.path() / "a" / "b");
  CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("write_file: a path that cannot be written is named, with the reason") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.file("plain"), "x"));
  // A file where a folder must be stops root too, unlike permissions.
  const Status status = write_file(folder.file("plain/out.txt"), "y");
  REQUIRE_FALSE(status);
  CHECK(status.error().code == ErrorCode::bad_input);
  CHECK(status.error().place.find("plain") != std::string::npos);
}

TEST_CASE("write_file: a write that fails half-way leaves the old file and no temporary one") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("out.txt"));
  REQUIRE(write_file(folder.file("out.txt/old"), "kept"));
  // Renaming a file onto a folder that is not empty must fail, after the temporary file was written.
  REQUIRE_FALSE(write_file(folder.file("out.txt"), "new"));
  CHECK(*read_file(folder.file("out.txt/old")) == "kept");
  const std::filesystem::directory_iterator files(folder.path());
  CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("read_file: a file that is not there is named, with the reason") {
  const TemporaryFolder folder;
  const Result<std::string> missing = read_file(folder.file("none"));
  REQUIRE_FALSE(missing);
  CHECK(missing.error().text().find("No such file") != std::string::npos);
}

}  // namespace
}  // namespace burrhole
