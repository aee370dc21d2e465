// A scan is read on a thread of the chooser: no exception may leave it, and a thread that the system refuses is an error. In a program of its
// own, since it replaces operator new.
#include "app/window/scan_reading.h"

#include <doctest/doctest.h>
#include <grp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>
#include <thread>

#include "app/run/start_thread.h"
#include "tests/support/temporary_folder.h"

namespace {

/// Requests of this size and larger find no memory. [bytes]
std::atomic<std::size_t> refused_from{std::numeric_limits<std::size_t>::max()};

}  // namespace

void* operator new(std::size_t size) {
  void* const found = size < refused_from.load(std::memory_order_relaxed) ? std::malloc(std::max<std::size_t>(size, 1)) : nullptr;
  if (found == nullptr) throw std::bad_alloc();
  return found;
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* at) noexcept { std::free(at); }
void operator delete(void* at, std::size_t) noexcept { std::free(at); }
void operator delete[](void* at) noexcept { std::free(at); }
void operator delete[](void* at, std::size_t) noexcept { std::free(at); }

using namespace burrhole;

namespace {

constexpr int kEdge = 40;  // [voxels] 128 KB of values

/// A ball of bone in air.
std::string write_scan(const TemporaryFolder& folder) {
  const std::string path = folder.file("scan.nrrd");
  std::ofstream file(path, std::ios::binary);
  file << "NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: 40 40 40\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
          "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n";
  for (int k = 0; k < kEdge; ++k)
    for (int j = 0; j < kEdge; ++j)
      for (int i = 0; i < kEdge; ++i) {
        const int x = 2 * i - kEdge, y = 2 * j - kEdge, z = 2 * k - kEdge;
        const auto value = static_cast<std::int16_t>(x * x + y * y + z * z < kEdge * kEdge / 2 ? 1200 : -1000);
        file.write(reinterpret_cast<const char*>(&value), sizeof value);
      }
  return path;
}

Result<ImportedBone> read_scan_at(const std::string& path, std::size_t from) {
  ScanReading reading({.path = path}, false);
  refused_from.store(from);
  std::optional<Result<ImportedBone>> read;
  while (!(read = reading.take())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  refused_from.store(std::numeric_limits<std::size_t>::max());
  return std::move(*read);
}

constexpr int kPassed = 10;  // exit code
constexpr const char* kLimited = "scan reading: in a process without threads";

/// Makes this process that of a user who may have no more threads. @returns whether it could.
bool forbid_threads() {
  constexpr uid_t kNobody = 65534;
  const bool ordinary = ::geteuid() != 0 || (::setgroups(0, nullptr) == 0 && ::setgid(kNobody) == 0 && ::setuid(kNobody) == 0);
  const rlimit none{0, 0};
  return ordinary && ::setrlimit(RLIMIT_NPROC, &none) == 0;
}

}  // namespace

// Run by the next case in a process of its own, as the limit cannot be taken back.
TEST_CASE(kLimited* doctest::skip()) {
  const auto refused = [](const Error& error) {
    return error.code == ErrorCode::unavailable && error.message.find("refused a thread") != std::string::npos;
  };
  if (!forbid_threads()) _exit(2);
  std::thread thread;
  const Status started = start_thread(thread, [] {});
  const bool start_refused = !started && !thread.joinable() && refused(started.error());
  ScanReading reading({.path = "none.nrrd"}, false);
  const auto read = reading.take();
  const bool reading_refused = read && !*read && refused(read->error());
  _exit(start_refused ? reading_refused ? kPassed : 4 : 3);  // without what sanitizers do at the end of a program: it takes a thread
}

TEST_CASE("scan reading: a thread that the system refuses is an error, and nothing waits for it") {
  // A program that is started anew: ThreadSanitizer starts no thread in a mere fork.
  const pid_t child = fork();
  if (child == 0) {
    const std::string chosen = std::string("--test-case=") + kLimited;
    execl("/proc/self/exe", "scan_reading_test", chosen.c_str(), "--no-skip", static_cast<char*>(nullptr));
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == kPassed);  // 0: the case was not found, 2: no limit, 3: start_thread(), 4: ScanReading
}

TEST_CASE("scan reading: an exception inside the reading, wherever it begins, is an error of one line, and the next reading succeeds") {
  const TemporaryFolder folder;
  const std::string path = write_scan(folder);
  int failed = 0;
  for (std::size_t from = 256; from <= 1 << 18; from += from / 4) {
    INFO("no memory for " << from << " bytes at once");
    const auto read = read_scan_at(path, from);
    if (read) continue;
    ++failed;
    CHECK((read.error().code == ErrorCode::unavailable || read.error().code == ErrorCode::bad_input));
    CHECK(read.error().text().find("memory") != std::string::npos);
    CHECK(read.error().text().find('\n') == std::string::npos);
  }
  CHECK(failed > 5);
  CHECK(read_scan_at(path, std::numeric_limits<std::size_t>::max()).ok());
}
