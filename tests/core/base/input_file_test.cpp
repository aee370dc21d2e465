#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/input_file.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

constexpr FileLimit kText{"a test", 100, true}, kBytes{"a test", 100, false};

std::string refusal(const std::string& path, const FileLimit& limit = kText) {
  const auto text = read_input(path, limit);
  REQUIRE_FALSE(text.ok());
  CHECK(text.error().code == ErrorCode::bad_input);
  return text.error().message;
}

}  // namespace

TEST_CASE("read_input: a regular file of at most its limit is read as it is") {
  const TemporaryFolder folder;
  for (const std::size_t size : {0u, 1u, 99u, 100u}) {
    std::ofstream(folder.file("f")) << std::string(size, 'x');
    const auto text = read_input(folder.file("f"), kText);
    REQUIRE(text.ok());
    CHECK(*text == std::string(size, 'x'));
  }
  std::ofstream(folder.file("f")) << std::string(101, 'x');
  CHECK(refusal(folder.file("f")) == "is larger than 100 bytes, the most that a test may have");
  CHECK(refusal("/proc/self/maps") == "is larger than 100 bytes, the most that a test may have");  // reports a size of 0
  std::ofstream(folder.file("f")) << std::string(200'000, 'x');
  const auto large = read_input(folder.file("f"), kTomlInput);
  REQUIRE(large.ok());
  CHECK(large->size() == 200'000);
  CHECK(large->capacity() < 250'000);  // the end is found without memory of twice the size
}

TEST_CASE("read_input: a sparse file of a terabyte is refused before it is read") {
  const TemporaryFolder folder;
  std::ofstream(folder.file("f")) << 'x';
  std::filesystem::resize_file(folder.file("f"), std::uintmax_t{1} << 40);
  CHECK(refusal(folder.file("f"), kTomlInput).find("is larger than 4194304 bytes") == 0);
  CHECK(refusal(folder.file("f"), kCheckpointInput).find("is larger than 1000000000 bytes") == 0);
}

TEST_CASE("read_input: what is no regular file is refused by its kind, without waiting") {
  const TemporaryFolder folder;
  REQUIRE(::mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  CHECK(refusal(folder.file("pipe")) == "is a pipe: write its content into a regular file first, and give that");
  std::filesystem::create_symlink(folder.file("pipe"), folder.file("link"));
  CHECK(refusal(folder.file("link")).find("is a pipe") == 0);
  CHECK(refusal("/dev/zero") == "is a device: give a regular file");
  CHECK(refusal(folder.path().string()) == "is a folder: give a file");
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  CHECK(refusal("/dev/fd/" + std::to_string(ends[0])).find("is a pipe") == 0);
  ::close(ends[0]);
  ::close(ends[1]);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = folder.file("s");
  REQUIRE(name.size() < sizeof address.sun_path);
  std::memcpy(address.sun_path, name.c_str(), name.size());
  REQUIRE(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  CHECK(refusal(name) == "is a socket or a device: give a regular file");
  ::close(socket);
  CHECK(check_regular_file(folder.file("pipe")).error().message.find("is a pipe") == 0);
}

TEST_CASE("read_input: paths that name nothing") {
  CHECK(refusal("") == "names no file: the path is empty");
  CHECK(refusal("/nowhere/x") == "cannot be read: No such file or directory");
  CHECK(refusal(std::string(5000, 'n')) == "cannot be read: File name too long");
  CHECK(refusal(std::string("/dev/null\0x", 11)) == "a path must not contain a byte 0");
}

TEST_CASE("read_input: a byte 0 is refused with its line and column in text, and read otherwise") {
  const TemporaryFolder folder;
  std::ofstream(folder.file("f"), std::ios::binary) << std::string("ab\nc\0d", 6);
  const auto text = read_input(folder.file("f"), kText);
  REQUIRE_FALSE(text.ok());
  CHECK(text.error().place == folder.file("f") + ":2:2");
  CHECK(read_input(folder.file("f"), kBytes).value().size() == 6);
}
