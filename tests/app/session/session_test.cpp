#include "app/session/session.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/app/session/session_samples.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

TEST_CASE("session: rows come back bit by bit, whatever the bits") {
  const TemporaryFolder folder;
  const std::string path = folder.file("new/folder/run.session");
  const std::vector<std::vector<double>> special = {
      {0.0, -0.0, std::numeric_limits<double>::denorm_min()},
      {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), std::bit_cast<double>(0x7ff4000000abcdefull)},
      {std::numeric_limits<double>::max(), std::numeric_limits<double>::min(), -std::numeric_limits<double>::denorm_min()}};
  SessionWriter writer = make_writer(path);
  for (const auto& row : special) REQUIRE(writer.append(0, row));
  // 1,234 is no multiple of the block of 100 rows, so the last block is short.
  for (std::uint64_t i = 0; i < 1234; ++i) REQUIRE(writer.append(0, any_bits(i)));
  REQUIRE(writer.close());

  const SessionReader reader = open_reader(path);
  REQUIRE(reader.row_count("servo") == 1237);
  const Result<std::vector<double>> rows = reader.rows("servo");
  REQUIRE(rows);
  REQUIRE(rows->size() == 3 * 1237);
  for (std::size_t i = 0; i < special.size(); ++i) CHECK(same_bits(rows->data() + 3 * i, special[i]));
  bool same = true;
  for (std::uint64_t i = 0; i < 1234; ++i) same = same && same_bits(rows->data() + 3 * (i + 3), any_bits(i));
  CHECK(same);
}

TEST_CASE("session: each stream keeps its own columns and rows") {
  const TemporaryFolder folder;
  const std::string path = folder.file("streams.sqlite");
  {
    auto writer = SessionWriter::create(path, kMeta, {{kServo, kContact, kBone}, 10, 1});
    REQUIRE(writer.ok());
    for (std::uint64_t n = 0; n < 25; ++n) {
      REQUIRE(writer->append(0, any_bits(n)).ok());
      for (std::uint64_t m = 0; m < n % 3; ++m) REQUIRE(writer->append(1, std::vector<double>{double(n), double(m)}).ok());
      if (n % 10 == 0) REQUIRE(writer->append(2, std::vector<double>{double(n)}).ok());
    }
    CHECK(writer->rows() == std::vector<std::int64_t>{25, 24, 3});
    REQUIRE(writer->close().ok());
  }
  const SessionReader reader = open_reader(path);
  CHECK(reader.row_count("servo") == 25);
  CHECK(reader.streams() == std::vector<SessionStream>{kServo, kContact, kBone});
  REQUIRE(reader.stream("contact") != nullptr);
  CHECK(*reader.stream("contact") == kContact);
  CHECK(reader.stream("frame") == nullptr);
  CHECK(reader.row_count("frame") == 0);
  CHECK_FALSE(reader.rows("frame").ok());
  std::vector<double> expected, ticks;
  for (std::uint64_t n = 0; n < 25; ++n)
    for (std::uint64_t m = 0; m < n % 3; ++m) {
      expected.insert(expected.end(), {double(n), double(m)});
      ticks.push_back(double(n));
    }
  CHECK(*reader.rows("contact") == expected);
  CHECK(*reader.column("contact", "tick") == ticks);
  CHECK(*reader.rows("bone") == std::vector<double>{0.0, 10.0, 20.0});
  CHECK_FALSE(reader.column("contact", "tock").ok());
  CHECK_FALSE(reader.column("frame", "tick").ok());
}

TEST_CASE("session: what was asked, what happened and the hashes come back") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  const std::vector<SessionEvent> events = {{0.5, 500, "breakthrough", "no bone ahead", ""},
                                            {0.25, 250, "switch", "", std::string("\0\xff b", 4)}};
  SessionWriter writer = make_writer(path);
  for (const SessionEvent& event : events) REQUIRE(writer.event(event));
  REQUIRE(writer.hash({"voxels", "old"}));
  REQUIRE(writer.hash({"voxels", "0123456789abcdef"}));
  REQUIRE(writer.hash({"forces", "fedcba9876543210"}));
  REQUIRE(writer.close());
  REQUIRE(writer.close());

  const SessionReader reader = open_reader(path);
  CHECK(reader.meta() == kMeta);
  CHECK(reader.schema() == 2);
  CHECK(reader.streams() == std::vector<SessionStream>{kServo});
  CHECK(reader.events() == events);
  CHECK(reader.hashes() == std::vector<SessionHash>{{"forces", "fedcba9876543210"}, {"voxels", "0123456789abcdef"}});
  CHECK(reader.row_count("servo") == 0);
  CHECK(reader.rows("servo", 0, 10)->empty());
}

TEST_CASE("session: any range of rows equals that part of the whole") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  SessionWriter writer = make_writer(path, 7);
  for (std::uint64_t i = 0; i < 50; ++i) REQUIRE(writer.append(0, any_bits(i)));
  REQUIRE(writer.close());
  const SessionReader reader = open_reader(path);
  for (std::int64_t first = 0; first <= 50; ++first) {
    for (std::int64_t count = 0; count <= 60; count += 3) {
      const Result<std::vector<double>> rows = reader.rows("servo", first, count);
      REQUIRE(rows);
      REQUIRE(rows->size() == static_cast<std::size_t>(3 * std::min<std::int64_t>(count, 50 - first)));
      for (std::size_t i = 0; i < rows->size() / 3; ++i)
        REQUIRE(same_bits(rows->data() + 3 * i, any_bits(static_cast<std::uint64_t>(first) + i)));
    }
  }
}

/// @returns bytes 18 and 19 of an SQLite file, which say the journal it uses: 1 a rollback journal, 2 a WAL (SQLite's file format, section
/// 1.3).
std::pair<int, int> journal_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(18);
  const int write = file.get();
  return {write, file.get()};
}

TEST_CASE("session: the file is in WAL mode while it is written, and a destroyed writer has closed it as one file") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  {
    SessionWriter writer = make_writer(path);
    REQUIRE(writer.append(0, any_bits(0)));
    REQUIRE(writer.append(0, any_bits(1)));
    CHECK(journal_bytes(path) == std::pair(2, 2));
    CHECK(std::filesystem::exists(path + "-wal"));
  }
  CHECK(open_reader(path).row_count("servo") == 2);
  CHECK(journal_bytes(path) == std::pair(1, 1));
  for (const char* suffix : {"-wal", "-shm", "-journal"}) CHECK_FALSE(std::filesystem::exists(path + suffix));
}

/// @returns whether SQLite itself, as other programs use it, reads rows of the file.
bool plain_sqlite_reads(const std::string& path) {
  sqlite3* database = nullptr;
  const bool read = sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK &&
                    sqlite3_exec(database, "SELECT count(*) FROM blocks", nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_close(database);
  return read;
}

TEST_CASE("session: a writer that closes beside a reader keeps the WAL, and every row is there") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  SessionWriter writer = make_writer(path);
  REQUIRE(writer.append(0, any_bits(0)));
  sqlite3* reader = nullptr;
  REQUIRE(sqlite3_open_v2(path.c_str(), &reader, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  REQUIRE(sqlite3_exec(reader, "SELECT count(*) FROM blocks", nullptr, nullptr, nullptr) == SQLITE_OK);
  CHECK(writer.close());
  sqlite3_close(reader);
  CHECK(open_reader(path).row_count("servo") == 1);
}

TEST_CASE("session: a reader that opens the new file at once, as a backup does, does not end the run") {
  // A name for each, since SQLite does not bear that a file is removed while it is read in the same process.
  constexpr int kSessions = 60;
  const TemporaryFolder folder;
  const auto path = [&](int n) { return folder.file("run" + std::to_string(n) + ".session"); };
  std::atomic<int> current = 0;
  int refused = 0;
  {
    const std::jthread reader([&] {
      while (current < kSessions) {
        sqlite3* database = nullptr;
        if (sqlite3_open_v2(path(current).c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK)
          sqlite3_exec(database, "BEGIN; SELECT count(*) FROM sqlite_schema; COMMIT", nullptr, nullptr, nullptr);
        sqlite3_close(database);
      }
    });
    for (; current < kSessions; ++current)
      if (!SessionWriter::create(path(current), kMeta, servo_only(10))) ++refused;
  }
  CHECK(refused == 0);
}

TEST_CASE("session: a new run replaces an old session, and nothing else") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session"), precious = folder.file("precious.txt");
  {
    SessionWriter writer = make_writer(path);
    REQUIRE(writer.append(0, any_bits(0)));
  }
  make_writer(path);
  CHECK(open_reader(path).row_count("servo") == 0);
  std::ofstream(precious) << "not a session";
  const Result<SessionWriter> refused = SessionWriter::create(precious, kMeta, servo_only(100));
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::bad_input);
  CHECK(std::filesystem::file_size(precious) == 13);
  run_sql(folder.file("other.db"), "CREATE TABLE t(x)");
  CHECK_FALSE(SessionWriter::create(folder.file("other.db"), kMeta, servo_only(100)).ok());
}

constexpr std::uint64_t kInputEvery = 37;

/// A writer in a process of its own, killed without warning once it has appended `after` rows. @returns how many rows it had appended by
/// then.
std::int64_t write_and_kill(const std::string& path, std::int64_t rows_per_second, std::int64_t after) {
  void* shared = ::mmap(nullptr, sizeof(std::atomic<std::int64_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto* appended = new (shared) std::atomic<std::int64_t>(0);
  const pid_t child = ::fork();
  if (child == 0) {
    Result<SessionWriter> writer = SessionWriter::create(path, kMeta, servo_only(rows_per_second));
    for (std::uint64_t i = 0; writer && i < 100'000'000; ++i) {
      if (i % kInputEvery == 0 && !writer->input({static_cast<std::int64_t>(i), "mark", 0.0, "", "", writer->rows()})) break;
      if (!writer->append(0, any_bits(i))) break;
      appended->store(static_cast<std::int64_t>(i) + 1);
    }
    ::_exit(1);
  }
  while (appended->load() < after && ::waitpid(child, nullptr, WNOHANG) == 0) ::usleep(200);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  const std::int64_t count = appended->load();
  ::munmap(shared, sizeof(std::atomic<std::int64_t>));
  CHECK(count >= after);
  return count;
}

TEST_CASE("session: a writer killed at any moment loses at most the last second") {
  constexpr std::int64_t kRate = 100;
  for (const std::int64_t after : {1, 99, 100, 101, 5'000, 77'777}) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.session");
    const std::int64_t appended = write_and_kill(path, kRate, after);
    const SessionReader reader = open_reader(path);
    CHECK(reader.row_count("servo") >= appended - kRate);
    // The child may have committed the row that it had not yet counted.
    CHECK(reader.row_count("servo") <= appended + 1);
    // Inputs are committed with the rows before them; one may stand after the last row.
    const auto every = static_cast<std::int64_t>(kInputEvery), inputs = static_cast<std::int64_t>(reader.inputs().size());
    CHECK(inputs >= (reader.row_count("servo") + every - 1) / every);
    CHECK(inputs <= reader.row_count("servo") / every + 1);
    for (const SessionInput& input : reader.inputs()) CHECK(input.rows_before == std::vector<std::int64_t>{input.tick});
    CHECK(reader.meta() == kMeta);
    const Result<std::vector<double>> rows = reader.rows("servo");
    REQUIRE(rows);
    bool same = true;
    for (std::int64_t i = 0; i < reader.row_count("servo"); ++i)
      same = same && same_bits(rows->data() + 3 * i, any_bits(static_cast<std::uint64_t>(i)));
    CHECK(same);
  }
}

TEST_CASE("session: a link to the session of a killed writer shows the same rows") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("runs"));
  const std::string path = folder.file("runs/run.session"), link = folder.file("link.session");
  write_and_kill(path, 100, 5'000);
  std::filesystem::create_symlink("runs/run.session", link);
  REQUIRE(std::filesystem::file_size(path + "-wal") > 0);
  const std::int64_t rows = open_reader(link).row_count("servo");
  CHECK(rows >= 4'900);
  CHECK(rows == open_reader(path).row_count("servo"));
}

TEST_CASE("session: a writer that commits only at its end fails that check") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  const std::int64_t appended = write_and_kill(path, 1'000'000'000, 5'000);
  CHECK_FALSE(open_reader(path).row_count("servo") >= appended - 100);
}

TEST_CASE("session: a run can be read while it is still being written") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  SessionWriter writer = make_writer(path, 10);
  for (std::uint64_t i = 0; i < 25; ++i) REQUIRE(writer.append(0, any_bits(i)));
  // Blocks: row 0 alone, then 1 to 10 and 11 to 20; the other four wait.
  CHECK(open_reader(path).row_count("servo") == 21);
  for (std::uint64_t i = 25; i < 40; ++i) REQUIRE(writer.append(0, any_bits(i)));
  REQUIRE(writer.close());
  CHECK(open_reader(path).row_count("servo") == 40);
}

/// Runs `check` as a user without rights of root, whom permissions bind. @returns its answer.
bool as_ordinary_user(bool (*check)(const std::string&), const std::string& argument) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
    ::_exit(check(argument) ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST_CASE("session: a folder that cannot be written is bad input with the path and the reason") {
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  CHECK(as_ordinary_user(
      [](const std::string& path) {
        const Result<SessionWriter> writer = SessionWriter::create(path, kMeta, servo_only(10));
        return !writer && writer.error().code == ErrorCode::bad_input &&
               writer.error().text().find("Permission denied") != std::string::npos;
      },
      folder.file("run.session")));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
}

TEST_CASE("session: a closed session on a medium that cannot be written is read") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run #1.session");
  {
    SessionWriter writer = make_writer(path);
    REQUIRE(writer.append(0, any_bits(0)));
  }
  std::filesystem::permissions(path, std::filesystem::perms(0444));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  CHECK(as_ordinary_user(
      [](const std::string& file) {
        const Result<SessionReader> reader = SessionReader::open(file);
        return reader.ok() && reader->row_count("servo") == 1;
      },
      path));
  CHECK(as_ordinary_user(plain_sqlite_reads, path));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
}

}  // namespace
}  // namespace burrhole::test
