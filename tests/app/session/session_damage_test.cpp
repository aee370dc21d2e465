// Inputs and older schemas come back; what is foreign, newer, cut or damaged is refused in one line.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "tests/app/session/session_samples.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// Four inputs as a person gives them; the second and third parked all clocks.
const std::vector<SessionInput> kInputs = {{0, "spin", 1.0, "", "", {}},
                                           {12, "tool", 0.0, "pin_2mm", std::string("name = 'pin'\n\0\xff", 15), {12, 4, 1}},
                                           {12, "undo", 0.0, "", "", {12, 4, 1}},
                                           {20, "spin", 0.25, "", "", {}}};

void write_with_inputs(const std::string& path) {
  auto writer = SessionWriter::create(path, kMeta, {{kServo, kContact, kBone}, 10, 1});
  REQUIRE(writer.ok());
  auto input = kInputs.begin();
  for (std::int64_t n = 0; n < 25; ++n) {
    for (; input != kInputs.end() && input->tick == n; ++input) {
      if (!input->rows_before.empty()) CHECK(writer->rows() == input->rows_before);
      REQUIRE(writer->input(*input));
    }
    REQUIRE(writer->append(0, any_bits(static_cast<std::uint64_t>(n))));
    if (n % 3 == 0) REQUIRE(writer->append(1, std::vector<double>{double(n), 0.0}));
    if (n % 20 == 10) REQUIRE(writer->append(2, std::vector<double>{double(n)}));
  }
  REQUIRE(writer->still({1, "after the change", "0123456789abcdef"}));
  REQUIRE(writer->still({1, "cutaway", "fedcba9876543210"}));
  REQUIRE(writer->close());
}

TEST_CASE("session: inputs come back in order with the place of each that parked the clocks, and stills with their bone step") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  write_with_inputs(path);
  const SessionReader reader = open_reader(path);
  CHECK(reader.inputs() == kInputs);
  CHECK(reader.stills() ==
        std::vector<SessionStill>{{1, "after the change", "0123456789abcdef", {}, 2}, {1, "cutaway", "fedcba9876543210", {}, 2}});
}

TEST_CASE("session: an input that could not be replayed is not recorded") {
  const TemporaryFolder folder;
  SessionWriter writer = make_writer(folder.file("run.session"));
  REQUIRE(writer.input({10, "spin", 0.5, "", "", {}}));
  for (const SessionInput& wrong :
       {SessionInput{9, "spin", 0.5, "", "", {}}, SessionInput{11, "spin", std::numeric_limits<double>::quiet_NaN(), "", "", {}},
        SessionInput{11, "undo", 0.0, "", "", {1, 2}}}) {
    const Status status = writer.input(wrong);
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().text().find(wrong.kind) != std::string::npos);
  }
  REQUIRE(writer.close());
  CHECK(open_reader(folder.file("run.session")).inputs().size() == 1);
}

TEST_CASE("session: inputs that were cut, lost or changed are refused in one line") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  const char* kChanges[] = {"DELETE FROM inputs WHERE id = 4",
                            "DELETE FROM inputs WHERE id = 2",
                            "DELETE FROM inputs",
                            "UPDATE inputs SET tick = 13 WHERE id = 2",
                            "UPDATE inputs SET tick = -1 WHERE id = 1",
                            "UPDATE inputs SET value = 9e999 WHERE id = 1",
                            "DELETE FROM parks WHERE input = 2 AND stream = 2",
                            "DELETE FROM parks WHERE input = 2 AND stream = 0",
                            "UPDATE parks SET rows = 26 WHERE input = 3 AND stream = 0",
                            "UPDATE parks SET rows = 3 WHERE input = 3 AND stream = 1",
                            "UPDATE parks SET rows = -1 WHERE input = 2 AND stream = 1",
                            "INSERT INTO parks VALUES(9, 0, 1)",
                            "INSERT INTO parks VALUES(2, 3, 1)",
                            "DROP TABLE parks",
                            "DROP TABLE inputs",
                            "DELETE FROM blocks WHERE stream = 0 AND first_row = (SELECT max(first_row) FROM blocks WHERE stream = 0)",
                            "DELETE FROM streams WHERE position = 1",
                            "UPDATE columns SET keep = 'lossy' WHERE stream = 0 AND position = 0"};
  for (const char* sql : kChanges) {
    write_with_inputs(path);
    run_sql(path, sql);
    const std::string text = refusal(path);
    CHECK_MESSAGE(text.find("is damaged") != std::string::npos, std::string(sql), ": ", text);
    CHECK_MESSAGE(text.find('\n') == std::string::npos, text);
  }
  // A killed session names no ends: which inputs came after the last commit cannot be known, and what is there is read.
  write_with_inputs(path);
  run_sql(path, "DELETE FROM ends; DELETE FROM inputs WHERE id = 4");
  CHECK(open_reader(path).inputs().size() == 3);
}

/// A session as the first schema laid it out: rows of plain doubles, and one further stream where the run was live.
void write_schema_1(const std::string& path, bool live) {
  std::string bytes;
  for (const double value : {1.0, -2.5, 3.0, 4.0})
    for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(std::bit_cast<std::uint64_t>(value) >> shift & 0xffu);
  const auto hex = [&](std::size_t first, std::size_t count) {
    std::string out = "x'";
    for (const char c : bytes.substr(first, count)) {
      constexpr const char* kDigits = "0123456789abcdef";
      out += kDigits[static_cast<unsigned char>(c) >> 4];
      out += kDigits[static_cast<unsigned char>(c) & 15];
    }
    return out + "'";
  };
  const std::string table = "(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL);";
  const std::string block = "(first_row INTEGER PRIMARY KEY, rows INTEGER NOT NULL, data BLOB NOT NULL);";
  std::string sql =
      "PRAGMA application_id = 1651864178; PRAGMA user_version = 1; PRAGMA journal_mode = WAL;"
      "CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);"
      "INSERT INTO meta VALUES('program', 'burrhole 0.1.0'), ('seed', '7'), ('scene', 'x = 1');"
      "CREATE TABLE events(id INTEGER PRIMARY KEY, time_s REAL NOT NULL, tick INTEGER NOT NULL, kind TEXT NOT NULL,"
      " text TEXT NOT NULL, data BLOB NOT NULL);"
      "INSERT INTO events VALUES(1, 0.5, 500, 'breakthrough', 'no bone ahead', x'00ff');"
      "CREATE TABLE hashes(kind TEXT PRIMARY KEY, value TEXT NOT NULL);"
      "INSERT INTO hashes VALUES('voxels', 'abc');";
  sql += "CREATE TABLE columns" + table + "INSERT INTO columns VALUES(0, 'hand_x', 'm'), (1, 'contact', '');";
  sql += "CREATE TABLE ticks" + block + "INSERT INTO ticks VALUES(0, 1, " + hex(0, 16) + "), (1, 1, " + hex(16, 16) + ");";
  if (live) {
    sql += "CREATE TABLE columns_contact" + table + "INSERT INTO columns_contact VALUES(0, 'window', '');";
    sql += "CREATE TABLE ticks_contact" + block + "INSERT INTO ticks_contact VALUES(0, 4, " + hex(0, 32) + ");";
  }
  std::filesystem::remove(path);
  run_sql(path, sql.c_str());
}

TEST_CASE("session: schema 1 is read as streams without inputs and stills") {
  const TemporaryFolder folder;
  const std::string path = folder.file("old.session");
  for (const bool live : {false, true}) {
    write_schema_1(path, live);
    const SessionReader reader = open_reader(path);
    CHECK(reader.schema() == 1);
    CHECK(reader.meta().program == "burrhole 0.1.0");
    CHECK(reader.meta().seed == 7);
    CHECK(reader.meta().physics_version == 0);
    REQUIRE(reader.streams().size() == (live ? 2 : 1));
    CHECK(reader.streams()[0] == SessionStream{"servo", {{"hand_x", "m"}, {"contact", ""}}});
    CHECK(*reader.rows("servo") == std::vector<double>{1.0, -2.5, 3.0, 4.0});
    CHECK(*reader.rows("servo", 1, 1) == std::vector<double>{3.0, 4.0});
    CHECK(*reader.column("servo", "contact") == std::vector<double>{-2.5, 4.0});
    if (live) CHECK(*reader.rows("contact") == std::vector<double>{1.0, -2.5, 3.0, 4.0});
    CHECK(reader.inputs().empty());
    CHECK(reader.stills().empty());
    CHECK(reader.events() == std::vector<SessionEvent>{{0.5, 500, "breakthrough", "no bone ahead", std::string("\0\xff", 2)}});
    CHECK(reader.hashes() == std::vector<SessionHash>{{"voxels", "abc"}});
  }
  for (const char* sql : {"UPDATE ticks SET rows = 2 WHERE first_row = 1", "UPDATE ticks SET data = substr(data, 2) WHERE first_row = 1",
                          "ALTER TABLE ticks_contact RENAME TO ticks_Contact2", "DELETE FROM columns_contact"}) {
    write_schema_1(path, true);
    run_sql(path, sql);
    const auto reader = SessionReader::open(path);
    const Error error = reader ? reader->rows("servo").error() : reader.error();
    CHECK_MESSAGE(error.text().find(path + ": is damaged") == 0, error.text());
  }
}

TEST_CASE("session: missing, foreign and empty files are refused by name") {
  const TemporaryFolder folder;
  CHECK(refusal(folder.file("none.session")).find("No such file") != std::string::npos);
  CHECK(refusal(folder.path().string()).find("is no file") != std::string::npos);
  std::ofstream(folder.file("text")) << std::string(5000, 'x');
  CHECK(refusal(folder.file("text")).find("not an SQLite file") != std::string::npos);
  std::ofstream(folder.file("empty")).flush();
  CHECK(refusal(folder.file("empty")).find("is not a session of burrhole") != std::string::npos);
  run_sql(folder.file("other.db"), "CREATE TABLE t(x)");
  CHECK(refusal(folder.file("other.db")).find("is not a session of burrhole") != std::string::npos);
}

TEST_CASE("session: a newer schema is refused by its number") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  make_writer(path);
  for (const std::string version : {"3", "7"}) {
    run_sql(path, ("PRAGMA user_version = " + version).c_str());
    CHECK(refusal(path) == path + ": is a session of schema " + version + "; this program reads up to schema 2");
  }
}

TEST_CASE("session: a file cut short anywhere is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  {
    SessionWriter writer = make_writer(path);
    for (std::uint64_t i = 0; i < 3000; ++i) REQUIRE(writer.append(0, any_bits(i)));
  }
  const auto whole = static_cast<std::int64_t>(std::filesystem::file_size(path));
  for (const std::int64_t size : {std::int64_t{50}, std::int64_t{4096}, whole / 2, whole - 4096, whole - 1}) {
    const std::string cut = folder.file("cut" + std::to_string(size));
    std::filesystem::copy_file(path, cut);
    std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(size));
    CHECK_MESSAGE(refusal(cut) != "", size);
  }
}

TEST_CASE("session: rows that do not add up are refused, at the latest when they are read") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  for (const char* sql :
       {"DELETE FROM blocks WHERE first_row = 1", "UPDATE blocks SET data = substr(data, 2) WHERE first_row = 1",
        "UPDATE blocks SET rows = -1 WHERE first_row = 1", "UPDATE blocks SET rows = 9223372036854775807 WHERE first_row = 1",
        "UPDATE blocks SET rows = 8 WHERE first_row = 31", "UPDATE blocks SET data = zeroblob(length(data)) WHERE first_row = 11",
        "UPDATE blocks SET data = x'' WHERE first_row = 11",
        "UPDATE blocks SET data = (SELECT data FROM blocks WHERE first_row = 0) WHERE first_row = 11", "DROP TABLE events",
        "DELETE FROM columns", "DELETE FROM streams"}) {
    {
      SessionWriter writer = make_writer(path, 10);
      for (std::uint64_t i = 0; i < 40; ++i) REQUIRE(writer.append(0, any_bits(i)));
    }
    run_sql(path, sql);
    const auto reader = SessionReader::open(path);
    const auto rows = reader ? reader->rows("servo") : Result<std::vector<double>>(reader.error());
    REQUIRE_FALSE_MESSAGE(rows.ok(), std::string(sql));
    CHECK_MESSAGE(rows.error().text().find(path + ": is damaged") == 0, std::string(sql), ": ", rows.error().text());
    CHECK(rows.error().code == ErrorCode::bad_input);
  }
}

TEST_CASE("session: what is no table of ours is refused by its name, and its queries are not run") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  const std::string without_end =
      " AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS first_row, 1 AS rows FROM n";
  for (const auto& [sql, what] :
       {std::pair{"DROP TABLE blocks; CREATE VIEW blocks" + without_end, "the view \"blocks\""},
        {"CREATE VIEW ticks" + without_end, "the view \"ticks\""},
        {"CREATE VIEW ticks" + without_end + "; PRAGMA user_version = 1", ""},
        {"CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM events; END", "the trigger \"t\""},
        {"CREATE TABLE more(x)", "the table \"more\""},
        {"CREATE INDEX slow ON blocks(rows)", "the index \"slow\""},
        {"DROP TABLE hashes; CREATE TABLE hashes(kind TEXT PRIMARY KEY, value TEXT AS (hex(zeroblob(9))))", "the table \"hashes\""},
        {"CREATE TABLE \"a\nb\"(x)", "the table \"a\\nb\""}}) {
    { SessionWriter writer = make_writer(path); }
    run_sql(path, sql.c_str());
    CHECK_MESSAGE(refusal(path).find(std::string("is not a session of burrhole: it has ") + what) != std::string::npos, sql);
  }
}

TEST_CASE("session: a reader writes nothing, into the file or beside it") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session");
  { SessionWriter writer = make_writer(path); }
  const auto time = std::filesystem::last_write_time(path);
  std::ofstream(path + "-journal") << "a journal that another program would play back";
  (void)open_reader(path).rows("servo");
  CHECK(std::filesystem::last_write_time(path) == time);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  CHECK(files == 2);
}

TEST_CASE("session: a file with any bytes changed is refused or read, and every refusal names it in one line") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.session"), changed = folder.file("changed.session");
  write_with_inputs(path);
  std::ifstream file(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  std::size_t refused = 0;
  constexpr std::uint64_t kRounds = 400;
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    CAPTURE(round);
    std::string bytes = whole;
    for (std::uint64_t n = 0; n <= round % 8; ++n) {
      const std::uint64_t draw = mix64(1000 * round + n);
      bytes[(draw >> 8) % bytes.size()] = static_cast<char>(draw & 0xffu);
    }
    std::ofstream(changed, std::ios::binary) << bytes;
    const auto reader = SessionReader::open(changed);
    std::vector<Error> errors;
    if (!reader) errors.push_back(reader.error());
    if (reader)
      for (const SessionStream& stream : reader->streams())
        if (const auto rows = reader->rows(stream.name); !rows) errors.push_back(rows.error());
    refused += !errors.empty();
    for (const Error& error : errors) {
      CHECK(error.code == ErrorCode::bad_input);
      CHECK(error.text().find(changed) == 0);
      CHECK(error.text().find('\n') == std::string::npos);
    }
    for (const char* suffix : {"-wal", "-shm"}) std::filesystem::remove(changed + suffix);
  }
  MESSAGE(refused << " of " << kRounds << " changed files were refused");
  CHECK(refused > 0);
}

}  // namespace
}  // namespace burrhole::test
