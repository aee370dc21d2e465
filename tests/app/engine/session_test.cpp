#include "app/engine/session.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <fstream>
#include <limits>

#include "core/base/random.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

const SessionMeta kMeta{.program = "burrhole 0.1.0",
                        .scene_path = "app/scenes/parietal.toml",
                        .scene = "title = \"Überprüfung\"\n",
                        .tool = "name = 'x'\n",
                        .seed = std::numeric_limits<std::uint64_t>::max(),
                        .created = "2026-01-02T03:04:05Z"};
const std::vector<SessionColumn> kColumns = {{"time", "s"}, {"force", "N"}, {"depth", "m"}};

SessionWriter make_writer(const std::string& path, std::int64_t rows_per_second = 100) {
  Result<SessionWriter> writer = SessionWriter::create(path, kMeta, kColumns, rows_per_second);
  REQUIRE_MESSAGE(writer.ok(), (writer ? "" : writer.error().text()));
  return std::move(*writer);
}

SessionReader open_reader(const std::string& path) {
  Result<SessionReader> reader = SessionReader::open(path);
  REQUIRE_MESSAGE(reader.ok(), (reader ? "" : reader.error().text()));
  return std::move(*reader);
}

/// @returns why `path` was refused; fails the test if it was not, or not as bad input that names the file.
std::string refusal(const std::string& path) {
  const Result<SessionReader> reader = SessionReader::open(path);
  REQUIRE_FALSE(reader.ok());
  CHECK(reader.error().code == ErrorCode::bad_input);
  CHECK(reader.error().place.find(path) != std::string::npos);
  return reader.error().text();
}

/// Row i of a run whose values can be made again: any bits, NaN with payloads included, as a double.
std::vector<double> any_bits(std::uint64_t i) {
  return {std::bit_cast<double>(mix64(3 * i)), std::bit_cast<double>(mix64(3 * i + 1)), std::bit_cast<double>(mix64(3 * i + 2))};
}

bool same_bits(const double* a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < b.size(); ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return true;
}

void run_sql(const std::string& path, const char* sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  CHECK(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
}

TEST_CASE("session: rows come back bit by bit, whatever the bits") {
  const TemporaryFolder folder;
  const std::string path = folder.file("new/folder/run.session");
  const std::vector<std::vector<double>> special = {
      {0.0, -0.0, std::numeric_limits<double>::denorm_min()},
      {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), std::bit_cast<double>(0x7ff4000000abcdefull)},
      {std::numeric_limits<double>::max(), std::numeric_limits<double>::min(), -std::numeric_limits<double>::denorm_min()}};
  SessionWriter writer = make_writer(path);
  for (const auto& row : special) REQUIRE(writer.append(row));
  // 1,234 is no multiple of the block of 100 rows, so the last block is short.
  for (std::uint64_t i = 0; i < 1234; ++i) REQUIRE(writer.append(any_bits(i)));
  REQUIRE(writer.close());

  const SessionReader reader = open_reader(path);
  REQUIRE(reader.row_count() == 1237);
  const Result<std::vector<double>> rows = reader.rows(0, reader.row_count());
  REQUIRE(rows);
  REQUIRE(rows->size() == 3 * 1237);
  for (std::size_t i = 0; i < special.size(); ++i) CHECK(same_bits(rows->data() + 3 * i, special[i]));
  bool same = true;
  for (std::uint64_t i = 0; i < 1234; ++i) same = same && same_bits(rows->data() + 3 * (i + 3), any_bits(i));
  CHECK(same);
}

TEST_CASE("session: further streams keep their own columns and rows, and a run without them has none") {
  TemporaryFolder folder;
  const std::string path = folder.file("streams.sqlite");
  {
    auto writer =
        SessionWriter::create(path, kMeta, kColumns, 10, {{"contact", {{"tick", ""}, {"force", "N"}}}, {"bone", {{"mass", "m^3"}}}});
    REQUIRE(writer.ok());
    for (std::uint64_t n = 0; n < 25; ++n) {
      REQUIRE(writer->append(any_bits(n)).ok());
      for (std::uint64_t m = 0; m < n % 3; ++m) REQUIRE(writer->append_to(0, std::vector<double>{double(n), double(m)}).ok());
      if (n % 10 == 0) REQUIRE(writer->append_to(1, std::vector<double>{double(n)}).ok());
    }
    REQUIRE(writer->close().ok());
  }
  const SessionReader reader = open_reader(path);
  CHECK(reader.row_count() == 25);
  CHECK(reader.columns() == kColumns);
  REQUIRE(reader.stream("contact") != nullptr);
  CHECK(reader.stream("contact")->columns.size() == 2);
  CHECK(reader.stream("frame") == nullptr);
  CHECK(!reader.stream_rows("frame").ok());
  std::vector<double> expected;
  for (std::uint64_t n = 0; n < 25; ++n)
    for (std::uint64_t m = 0; m < n % 3; ++m) expected.insert(expected.end(), {double(n), double(m)});
  CHECK(*reader.stream_rows("contact") == expected);
  CHECK(*reader.stream_rows("bone") == std::vector<double>{0.0, 10.0, 20.0});
  const std::string plain = folder.file("plain.sqlite");
  (void)make_writer(plain).append(any_bits(1));
  CHECK(open_reader(plain).stream("contact") == nullptr);
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
  CHECK(reader.columns() == kColumns);
  CHECK(reader.events() == events);
  CHECK(reader.hashes() == std::vector<SessionHash>{{"forces", "fedcba9876543210"}, {"voxels", "0123456789abcdef"}});
  CHECK(reader.row_count() == 0);
  CHECK(reader.rows(0, 10)->empty());
}

TEST_CASE("session: any range of rows equals that part of the whole") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  SessionWriter writer = make_writer(path, 7);
  for (std::uint64_t i = 0; i < 50; ++i) REQUIRE(writer.append(any_bits(i)));
  REQUIRE(writer.close());
  const SessionReader reader = open_reader(path);
  for (std::int64_t first = 0; first <= 50; ++first) {
    for (std::int64_t count = 0; count <= 60; count += 3) {
      const Result<std::vector<double>> rows = reader.rows(first, count);
      REQUIRE(rows);
      REQUIRE(rows->size() == static_cast<std::size_t>(3 * std::min<std::int64_t>(count, 50 - first)));
      for (std::size_t i = 0; i < rows->size() / 3; ++i)
        REQUIRE(same_bits(rows->data() + 3 * i, any_bits(static_cast<std::uint64_t>(first) + i)));
    }
  }
}

TEST_CASE("session: the file is in WAL mode and a destroyed writer has closed it") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  {
    SessionWriter writer = make_writer(path);
    REQUIRE(writer.append(any_bits(0)));
    REQUIRE(writer.append(any_bits(1)));
  }
  CHECK(open_reader(path).row_count() == 2);
  CHECK_FALSE(std::filesystem::exists(path + "-wal"));
  // Bytes 18 and 19 of an SQLite file say which journal it uses; 2 is WAL (SQLite's file format, section 1.3).
  std::ifstream file(path, std::ios::binary);
  file.seekg(18);
  CHECK(file.get() == 2);
  CHECK(file.get() == 2);
}

TEST_CASE("session: a new run replaces an old session, and nothing else") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session"), precious = folder.file("precious.txt");
  {
    SessionWriter writer = make_writer(path);
    REQUIRE(writer.append(any_bits(0)));
  }
  make_writer(path);
  CHECK(open_reader(path).row_count() == 0);
  std::ofstream(precious) << "not a session";
  const Result<SessionWriter> refused = SessionWriter::create(precious, kMeta, kColumns, 100);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::bad_input);
  CHECK(std::filesystem::file_size(precious) == 13);
  run_sql(folder.file("other.db"), "CREATE TABLE t(x)");
  CHECK_FALSE(SessionWriter::create(folder.file("other.db"), kMeta, kColumns, 100).ok());
}

/// A writer in a process of its own, killed without warning once it has appended `after` rows. @returns how many rows it had appended by
/// then.
std::int64_t write_and_kill(const std::string& path, std::int64_t rows_per_second, std::int64_t after) {
  void* shared = ::mmap(nullptr, sizeof(std::atomic<std::int64_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto* appended = new (shared) std::atomic<std::int64_t>(0);
  const pid_t child = ::fork();
  if (child == 0) {
    Result<SessionWriter> writer = SessionWriter::create(path, kMeta, kColumns, rows_per_second);
    for (std::uint64_t i = 0; writer && i < 100'000'000; ++i) {
      if (!writer->append(any_bits(i))) break;
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
    CHECK(reader.row_count() >= appended - kRate);
    // The child may have committed the row that it had not yet counted.
    CHECK(reader.row_count() <= appended + 1);
    CHECK(reader.meta() == kMeta);
    const Result<std::vector<double>> rows = reader.rows(0, reader.row_count());
    REQUIRE(rows);
    bool same = true;
    for (std::int64_t i = 0; i < reader.row_count(); ++i)
      same = same && same_bits(rows->data() + 3 * i, any_bits(static_cast<std::uint64_t>(i)));
    CHECK(same);
  }
}

TEST_CASE("session: a writer that commits only at its end fails that check") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  const std::int64_t appended = write_and_kill(path, 1'000'000'000, 5'000);
  CHECK_FALSE(open_reader(path).row_count() >= appended - 100);
}

TEST_CASE("session: a run can be read while it is still being written") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  SessionWriter writer = make_writer(path, 10);
  for (std::uint64_t i = 0; i < 25; ++i) REQUIRE(writer.append(any_bits(i)));
  // Blocks: row 0 alone, then 1 to 10 and 11 to 20; the other four wait.
  CHECK(open_reader(path).row_count() == 21);
  for (std::uint64_t i = 25; i < 40; ++i) REQUIRE(writer.append(any_bits(i)));
  REQUIRE(writer.close());
  CHECK(open_reader(path).row_count() == 40);
}

TEST_CASE("session: missing, foreign and empty files are refused by name") {
  const TemporaryFolder folder;
  CHECK(refusal(folder.file("none.session")).find("No such file") != std::string::npos);
  CHECK(refusal(folder.path().string()).find("is no file") != std::string::npos);
  std::ofstream(folder.file("text")) << std::string(5000, 'x');
  CHECK(refusal(folder.file("text")).find("not an SQLite file") != std::string::npos);
  std::ofstream(folder.file("empty")).flush();
  CHECK(refusal(folder.file("empty")).find("is no burrhole session") != std::string::npos);
  run_sql(folder.file("other.db"), "CREATE TABLE t(x)");
  CHECK(refusal(folder.file("other.db")).find("is no burrhole session") != std::string::npos);
}

TEST_CASE("session: a newer schema is refused by its number") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  make_writer(path);
  run_sql(path, "PRAGMA user_version = 7");
  const std::string text = refusal(path);
  CHECK(text.find("schema 7") != std::string::npos);
  CHECK(text.find("up to schema 1") != std::string::npos);
}

TEST_CASE("session: a file cut short anywhere is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  {
    SessionWriter writer = make_writer(path);
    for (std::uint64_t i = 0; i < 3000; ++i) REQUIRE(writer.append(any_bits(i)));
  }
  const auto whole = static_cast<std::int64_t>(std::filesystem::file_size(path));
  for (const std::int64_t size : {std::int64_t{50}, std::int64_t{4096}, whole / 2, whole - 4096, whole - 1}) {
    const std::string cut = folder.file("cut" + std::to_string(size));
    std::filesystem::copy_file(path, cut);
    std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(size));
    CHECK_MESSAGE(refusal(cut) != "", size);
  }
}

TEST_CASE("session: rows that do not add up are refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  for (const char* sql : {"DELETE FROM ticks WHERE first_row = 1", "UPDATE ticks SET data = substr(data, 2) WHERE first_row = 1",
                          "UPDATE ticks SET rows = -1 WHERE first_row = 1", "DROP TABLE events", "DELETE FROM columns"}) {
    {
      SessionWriter writer = make_writer(path, 10);
      for (std::uint64_t i = 0; i < 40; ++i) REQUIRE(writer.append(any_bits(i)));
    }
    run_sql(path, sql);
    CHECK_MESSAGE(refusal(path).find("is damaged") != std::string::npos, std::string(sql));
  }
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
        const Result<SessionWriter> writer = SessionWriter::create(path, kMeta, kColumns, 10);
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
    REQUIRE(writer.append(any_bits(0)));
  }
  std::filesystem::permissions(path, std::filesystem::perms(0444));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  CHECK(as_ordinary_user(
      [](const std::string& file) {
        const Result<SessionReader> reader = SessionReader::open(file);
        return reader.ok() && reader->row_count() == 1;
      },
      path));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
}

}  // namespace
}  // namespace burrhole
