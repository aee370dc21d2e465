#include "core/base/output_file.h"

#include <doctest/doctest.h>

#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <ostream>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "core/base/output_stream.h"
#include "tests/support/file_limit.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBuffer = 65536;  // of OutputFile

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void put(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::set<std::string> names_in(const TemporaryFolder& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder.path())) out.insert(entry.path().filename().string());
  return out;
}

/// @returns `size` bytes that differ from place to place.
std::string pattern(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::string out(size, '\0');
  for (char& byte : out) byte = static_cast<char>(random());
  return out;
}

/// Writes a text in pieces of `piece` bytes.
Status write_in_pieces(const std::string& path, std::string_view text, std::size_t piece) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  for (; !text.empty(); text.remove_prefix(std::min(piece, text.size())))
    if (Status written = file->write(text.substr(0, piece)); !written) return written;
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

TEST_CASE("output file: the name appears with the last byte, and the old content stays until then") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin"), text = pattern(3 * kBuffer + 5, 1);
  put(path, "old");
  {
    auto file = OutputFile::create(path);
    REQUIRE(file);
    CHECK(is_temporary_of(fs::path(file->temporary()).filename().string(), "out.bin"));
    REQUIRE(file->write(text));
    CHECK(bytes_of(path) == "old");
    const auto size = file->commit();
    REQUIRE(size);
    CHECK(*size == text.size());
  }
  CHECK(bytes_of(path) == text);
  CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
  {
    auto file = OutputFile::create(path);
    REQUIRE(file);
    REQUIRE(file->write("never committed"));
  }
  CHECK(bytes_of(path) == text);
  CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
}

TEST_CASE("output file: wherever a write fails, the error says so, the old file stays as it was and no temporary file is left") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin"), text = pattern(2 * kBuffer + 100, 2);
  put(path, "old");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{1000}, kBuffer, text.size()})
    for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, kBuffer - 1, kBuffer, kBuffer + 1, 2 * kBuffer, text.size() - 1}) {
      INFO(piece << " bytes at a time, a limit of " << limit);
      Status written;
      {
        const DiskLimit full(limit);
        written = write_in_pieces(path, text, piece);
      }
      REQUIRE_FALSE(written);
      CHECK(written.error().code == ErrorCode::bad_input);
      CHECK(written.error().place == path);
      CHECK(written.error().message.find("File too large: raise the limit") != std::string::npos);
      CHECK(bytes_of(path) == "old");
      CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
    }
  const DiskLimit enough(text.size());
  CHECK(write_in_pieces(path, text, 1000));
  CHECK(bytes_of(path) == text);
}

TEST_CASE("output file: of processes that write one file together, one has written all of it") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  constexpr unsigned kWriters = 4, kRounds = 25;
  std::vector<std::string> texts;
  for (unsigned n = 0; n < kWriters; ++n) texts.push_back(pattern(kBuffer * (n + 1) + n, 10 + n));
  for (unsigned round = 0; round < kRounds; ++round) {
    std::vector<pid_t> children;
    for (unsigned n = 0; n < kWriters; ++n) {
      const pid_t child = fork();
      REQUIRE(child >= 0);
      if (child == 0) {
        std::mt19937 random(round * kWriters + n);  // the offset of its writes to those of the others
        usleep(static_cast<useconds_t>(random() % 2000));
        _exit(write_in_pieces(path, texts[n], 500 + random() % 5000) ? 0 : 1);
      }
      children.push_back(child);
    }
    for (const pid_t child : children) {
      int status = 0;
      REQUIRE(waitpid(child, &status, 0) == child);
      CHECK(status == 0);
    }
    INFO("round " << round);
    CHECK(std::ranges::find(texts, bytes_of(path)) != texts.end());
    CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
  }
}

TEST_CASE("output file: a header is completed last") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  auto file = OutputFile::create(path);
  REQUIRE(file);
  REQUIRE(file->write("????"));
  REQUIRE(file->write(pattern(kBuffer, 3)));
  REQUIRE(file->seek(0));
  REQUIRE(file->write("head"));
  CHECK(file->position() == 4);
  const auto size = file->commit();
  REQUIRE(size);
  CHECK(*size == kBuffer + 4);
  CHECK(bytes_of(path) == "head" + pattern(kBuffer, 3));
}

TEST_CASE("output stream: writes and seeks go to the file, and a failed write makes the stream bad") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  {
    auto file = OutputFile::create(path);
    REQUIRE(file);
    OutputStreambuf buffer(*file);
    std::ostream out(&buffer);
    out << "one " << 2 << ' ' << 'x';
    CHECK(out.tellp() == std::streampos(7));
    out.seekp(4).put('3');
    out.seekp(7) << "!";
    CHECK(out.good());
    REQUIRE(file->commit());
  }
  CHECK(bytes_of(path) == "one 3 x!");
  const DiskLimit full(kBuffer);
  auto file = OutputFile::create(path);
  REQUIRE(file);
  OutputStreambuf buffer(*file);
  std::ostream out(&buffer);
  const std::string text = pattern(kBuffer + 1, 4);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  CHECK(out.bad());
  CHECK_FALSE(file->commit());
  CHECK(bytes_of(path) == "one 3 x!");
}

TEST_CASE("output file: links are followed, devices are written directly, and what cannot be written is named with its reason") {
  const TemporaryFolder folder;
  put(folder.file("real"), "old");
  fs::create_symlink("real", folder.file("link"));
  REQUIRE(write_in_pieces(folder.file("link"), "new", 1));
  CHECK(fs::is_symlink(folder.file("link")));
  CHECK(bytes_of(folder.file("real")) == "new");
  fs::create_symlink("/dev/full", folder.file("full"));
  const Status full = write_in_pieces(folder.file("full"), "text", 4);
  REQUIRE_FALSE(full);
  CHECK(full.error().text() ==
        folder.file("full") + ": cannot be written: No space left on device: free space there, or name another place");
  CHECK(fs::is_symlink(folder.file("full")));
  fs::create_symlink("/dev/null", folder.file("null"));
  CHECK(write_in_pieces(folder.file("null"), "text", 4));
  CHECK(fs::is_character_file("/dev/null"));
  fs::create_directory(folder.file("folder"));
  const auto is_folder = OutputFile::create(folder.file("folder"));
  REQUIRE_FALSE(is_folder);
  CHECK(is_folder.error().message == "cannot be written: Is a directory: name a file");
  const auto nowhere = OutputFile::create(folder.file("real/out"));
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().message == "cannot be written: Not a directory: a part of its path is a file, not a folder");
  CHECK(names_in(folder) == std::set<std::string>{"real", "link", "full", "null", "folder"});
}

TEST_CASE("output file: a missing folder is made by the write, and the check before it makes nothing") {
  const TemporaryFolder folder;
  CHECK(check_folder_of(folder.file("one/two/out")));
  CHECK(names_in(folder).empty());
  REQUIRE(write_in_pieces(folder.file("one/two/out"), "text", 1));
  CHECK(bytes_of(folder.file("one/two/out")) == "text");
  CHECK(check_folder_of(folder.file("one/two/other")));
  CHECK_FALSE(check_folder_of(folder.file("one/two/out/below")));
  CHECK_FALSE(OutputFile::create("/proc/none/out"));
}

TEST_CASE("output file: permissions of the old file stay, and a name may be as long as the system allows") {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string(255, 'n'));
  put(path, "old");
  fs::permissions(path, fs::perms(0640));
  REQUIRE(write_in_pieces(path, "new", 3));
  CHECK(bytes_of(path) == "new");
  CHECK(fs::status(path).permissions() == fs::perms(0640));
  CHECK_FALSE(OutputFile::create(folder.file(std::string(256, 'n'))));
}

TEST_CASE("output file: a link to a file that is not there stays a link, and the file is made") {
  const TemporaryFolder folder;
  fs::create_directory(folder.file("store"));
  fs::create_symlink("store/first", folder.file("out"));
  fs::create_symlink("second", folder.file("store/first"));
  REQUIRE(write_in_pieces(folder.file("out"), "new", 3));
  CHECK(fs::is_symlink(folder.file("out")));
  CHECK(fs::is_symlink(folder.file("store/first")));
  CHECK(bytes_of(folder.file("store/second")) == "new");
  fs::create_symlink("none/file", folder.file("nowhere"));
  const auto nowhere = OutputFile::create(folder.file("nowhere"));
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().message == "cannot be written: No such file or directory");
  CHECK(fs::is_symlink(folder.file("nowhere")));
}

constexpr uid_t kNobody = 65534;

/// Runs `check` in a process of a user whom permissions bind, in no group but its own. @returns its answer.
bool as_ordinary_user(const std::function<bool()>& check) {
  const pid_t child = fork();
  if (child == 0) {
    const bool ordinary = ::geteuid() != 0 || (::setgroups(0, nullptr) == 0 && ::setgid(kNobody) == 0 && ::setuid(kNobody) == 0);
    _exit(ordinary && check() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// @returns the group and the permissions of a file.
std::pair<gid_t, mode_t> rights_of(const std::string& path) {
  struct stat status {};
  REQUIRE(::stat(path.c_str(), &status) == 0);
  return {status.st_gid, status.st_mode & 0777};
}

TEST_CASE("output file: the group of the old file stays; where it cannot, no group gets its rights") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  put(path, "old");
  if (::geteuid() != 0) {  // of another group than its own, only root makes a file for sure
    REQUIRE(write_in_pieces(path, "new", 3));
    CHECK(rights_of(path).first == ::getegid());
    return;
  }
  constexpr gid_t kGroup = 4242;
  REQUIRE(::chown(path.c_str(), 0, kGroup) == 0);
  REQUIRE(::chmod(path.c_str(), 0664) == 0);
  REQUIRE(write_in_pieces(path, "new", 3));
  CHECK(rights_of(path) == std::pair<gid_t, mode_t>(kGroup, 0664));
  REQUIRE(::chown(folder.path().c_str(), kNobody, kNobody) == 0);
  REQUIRE(::chown(path.c_str(), kNobody, kGroup) == 0);
  CHECK(as_ordinary_user([&] { return write_in_pieces(path, "newer", 5).ok(); }));
  CHECK(bytes_of(path) == "newer");
  CHECK(rights_of(path) == std::pair<gid_t, mode_t>(kNobody, 0604));
}

TEST_CASE("output file: a file that is protected against writing is not replaced") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.bin");
  put(path, "old");
  if (::geteuid() == 0) {
    REQUIRE(::chown(folder.path().c_str(), kNobody, kNobody) == 0);
    REQUIRE(::chown(path.c_str(), kNobody, kNobody) == 0);
  }
  REQUIRE(::chmod(path.c_str(), 0444) == 0);
  CHECK(as_ordinary_user([&] {
    const auto refused = OutputFile::create(path);
    return !refused && refused.error().text() == path + ": cannot be written: Permission denied: name a place that may be written";
  }));
  CHECK(bytes_of(path) == "old");
  CHECK(names_in(folder) == std::set<std::string>{"out.bin"});
}

std::atomic<bool> stop_writing{false};

TEST_CASE("output file: a stop ends the wait for the reader of a pipe") {
  const TemporaryFolder folder;
  const std::string path = folder.file("pipe");
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  struct sigaction action {
  }, before{};
  action.sa_handler = +[](int) { stop_writing.store(true); };
  REQUIRE(::sigaction(SIGALRM, &action, &before) == 0);  // without SA_RESTART
  const itimerval every{{0, 20'000}, {0, 20'000}}, never{};
  for (const bool opened : {false, true}) {
    INFO("a reader has opened it: " << opened);
    const int reader = opened ? ::open(path.c_str(), O_RDONLY | O_NONBLOCK) : -1;
    REQUIRE(::setitimer(ITIMER_REAL, &every, nullptr) == 0);
    const Status written = [&]() -> Status {
      auto file = OutputFile::create(path, &stop_writing);
      return file ? file->write(pattern(1 << 20, 5)) : Status(file.error());
    }();
    REQUIRE(::setitimer(ITIMER_REAL, &never, nullptr) == 0);
    if (reader >= 0) ::close(reader);
    REQUIRE_FALSE(written);
    CHECK(written.error().code == ErrorCode::unavailable);
    stop_writing.store(false);
  }
  ::sigaction(SIGALRM, &before, nullptr);
}

TEST_CASE("append: a file that it made does not stay when the text cannot be written") {
  const TemporaryFolder folder;
  fs::create_symlink("behind", folder.file("link"));
  {
    const DiskLimit full(2);
    CHECK_FALSE(append_to_file(folder.file("lines"), "line\n"));
    CHECK_FALSE(append_to_file(folder.file("link"), "line\n"));
  }
  CHECK(names_in(folder) == std::set<std::string>{"link"});
  REQUIRE(append_to_file(folder.file("link"), "line\n"));
  CHECK(bytes_of(folder.file("behind")) == "line\n");
}

TEST_CASE("append: what another process adds meanwhile is not cut off after an error") {
  const TemporaryFolder folder;
  const std::string path = folder.file("lines");
  REQUIRE(append_to_file(path, "one\n"));
  const int other = ::open(path.c_str(), O_WRONLY | O_APPEND);
  REQUIRE(other >= 0);
  REQUIRE(::flock(other, LOCK_EX) == 0);
  const pid_t child = fork();
  if (child == 0) {
    ::close(other);
    const DiskLimit full(6);
    _exit(append_to_file(path, "of the child\n") ? 1 : 0);
  }
  ::usleep(50'000);  // the child waits; one that did not would have written and cut off by now
  CHECK(bytes_of(path) == "one\n");
  CHECK(waitpid(child, nullptr, WNOHANG) == 0);
  REQUIRE(::write(other, "two\n", 4) == 4);
  ::close(other);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  CHECK(bytes_of(path) == "one\ntwo\n");
}

TEST_CASE("append: a line is added whole or not at all") {
  const TemporaryFolder folder;
  const std::string path = folder.file("lines");
  REQUIRE(append_to_file(path, "one\n"));
  {
    const DiskLimit full(6);
    const Status second = append_to_file(path, "second\n");
    REQUIRE_FALSE(second);
    CHECK(second.error().place == path);
  }
  CHECK(bytes_of(path) == "one\n");
  REQUIRE(append_to_file(path, "second\n"));
  CHECK(bytes_of(path) == "one\nsecond\n");
  CHECK_FALSE(append_to_file("/dev/full", "x"));
}

/// Starts to write a file in another process. @returns the process, which waits for a signal; `name` gets that of its temporary file.
pid_t start_writing(const TemporaryFolder& folder, const std::string& file, std::string& name) {
  const std::set<std::string> before = names_in(folder);
  int ready[2] = {};
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    auto out = OutputFile::create(folder.file(file));
    const bool whole = out.ok() && out->write("part").ok() && ::write(ready[1], "x", 1) == 1;
    while (whole) pause();
    _exit(1);
  }
  close(ready[1]);
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  close(ready[0]);
  for (const std::string& one : names_in(folder))
    if (!before.contains(one)) name = one;
  REQUIRE(is_temporary_of(name, file));
  return child;
}

void kill_writer(pid_t process) {
  REQUIRE(kill(process, SIGKILL) == 0);
  int status = 0;
  REQUIRE(waitpid(process, &status, 0) == process);
}

TEST_CASE("output file: the next write to a name removes what killed processes have left of it, and nothing else") {
  const TemporaryFolder folder;
  std::string dead, other, alive;
  const pid_t writer = start_writing(folder, "out.bin", alive);
  kill_writer(start_writing(folder, "out.bin", dead));
  kill_writer(start_writing(folder, "out.bin.2", other));
  const std::string locked =
      "out.bin" + dead.substr(7, dead.rfind('-') - 7) + "-00000000000000aa.tmp";  // as of a process of another machine
  const std::string link = "out.bin" + dead.substr(7, dead.rfind('-') - 7) + "-00000000000000bb.tmp";
  put(folder.file(locked), "x");
  fs::create_symlink(folder.file(locked), folder.file(link));
  const int held = open(folder.file(locked).c_str(), O_RDONLY | O_CLOEXEC);
  REQUIRE(flock(held, LOCK_EX) == 0);
  CHECK(names_in(folder) == std::set<std::string>{dead, other, alive, locked, link});
  REQUIRE(write_in_pieces(folder.file("out.bin"), "whole", 5));
  CHECK(names_in(folder) == std::set<std::string>{"out.bin", other, alive, locked, link});
  close(held);
  kill_writer(writer);
  REQUIRE(write_in_pieces(folder.file("out.bin"), "whole", 5));
  CHECK(names_in(folder) == std::set<std::string>{"out.bin", other, link});
  REQUIRE(write_in_pieces(folder.file("out.bin.2"), "whole", 5));
  CHECK(names_in(folder) == std::set<std::string>{"out.bin", "out.bin.2", link});
}

TEST_CASE("temporary names: those of a file, and no others") {
  CHECK(is_temporary_of("sound.wav.12-0123456789abcdef.tmp", "sound.wav"));
  for (const char* const other :
       {"sound.wav", "sound.wav.tmp", "sound.wav.12.tmp", "sound.wav.12-0123456789abcdeg.tmp", "sound.wav.-0123456789abcdef.tmp",
        "sound.wav.12-0123456789abcde.tmp", "sound.wavx12-0123456789abcdef.tmp", "other.wav.12-0123456789abcdef.tmp"})
    CHECK_FALSE_MESSAGE(is_temporary_of(other, "sound.wav"), other);
}

}  // namespace
}  // namespace burrhole
