// What is on the disk, and in which order: bytes, names, folders. In a program of its own, since it replaces fsync().
#include <doctest/doctest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "core/base/output_file.h"
#include "tests/support/temporary_folder.h"

namespace {

std::vector<std::string>* synced = nullptr;  // the paths that fsync() is called for, if a test asks
std::string sync_fails_for;                  // the path for which it fails

}  // namespace

extern "C" int fsync(int file) {
  char path[PATH_MAX] = {};
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t size = ::readlink(link.c_str(), path, sizeof path);
  const std::string name(path, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  if (synced != nullptr) synced->push_back(name);
  if (name != sync_fails_for) return static_cast<int>(::syscall(SYS_fsync, file));
  errno = EIO;
  return -1;
}

namespace burrhole {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> names_in(const TemporaryFolder& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder.path())) out.insert(entry.path().filename().string());
  return out;
}

Status write_file(const std::string& path, std::string_view text) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(text); !written) return written;
  const auto size = file->commit();
  return size ? Status() : Status(size.error());
}

/// @returns the last part of each path that `write` syncs, of the folder ".".
template <class Write>
std::vector<std::string> synced_by(const TemporaryFolder& folder, const Write& write) {
  std::vector<std::string> paths, out;
  synced = &paths;
  write();
  synced = nullptr;
  const std::string real = fs::canonical(folder.path()).string();
  for (const std::string& path : paths) out.push_back(path == real ? "." : fs::path(path).filename().string());
  return out;
}

TEST_CASE(
    "append: the bytes are synced, and the folder of a file that it made; a folder that cannot be synced is an error, and no file stays") {
  const TemporaryFolder folder;
  using Names = std::vector<std::string>;
  const auto add = [&] { CHECK(append_to_file(folder.file("lines"), "line\n")); };
  CHECK(synced_by(folder, add) == Names{"lines", "."});
  CHECK(synced_by(folder, add) == Names{"lines"});  // its name is on the disk
  fs::create_directory(folder.file("store"));
  fs::create_symlink("store/behind", folder.file("link"));
  CHECK(synced_by(folder, [&] { CHECK(append_to_file(folder.file("link"), "line\n")); }) == Names{"behind", "store"});
  sync_fails_for = fs::canonical(folder.path()).string();
  const Status refused = append_to_file(folder.file("new"), "line\n");
  sync_fails_for = fs::canonical(folder.file("lines")).string();
  const Status not_added = append_to_file(folder.file("lines"), "line\n");
  sync_fails_for.clear();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().text() == folder.file("new") + ": cannot be written: Input/output error");
  REQUIRE_FALSE(not_added);
  CHECK(names_in(folder) == std::set<std::string>{"lines", "link", "store"});
  CHECK(bytes_of(folder.file("lines")) == "line\nline\n");
}

TEST_CASE("output file: bytes are synced before the name is there, and the folder after it") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  const auto names = synced_by(folder, [&] { REQUIRE(write_file(path, "new")); });
  REQUIRE(names.size() == 2);
  CHECK(is_temporary_of(names[0], "out.bin"));
  CHECK(names[1] == ".");
  sync_fails_for = fs::canonical(folder.path()).string();
  CHECK_FALSE(write_file(path, "newer"));
  sync_fails_for.clear();
  CHECK(bytes_of(path) == "newer");  // whole, and its name may be lost
  CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
}

}  // namespace
}  // namespace burrhole
