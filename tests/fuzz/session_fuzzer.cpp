// Any bytes as a session: the file itself, or edits of a valid one, of its schema, types, values, blocks and pages. Errors are one line with
// the file's name; what is accepted has whole rows and inputs in order. SQLite is not built with the fuzzer's instruments.
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "app/session/session.h"
#include "app/session/sqlite_file.h"

namespace {

using namespace burrhole;
using sqlite_wrapper::Statement;

constexpr int kMostEdits = 16;
constexpr std::int64_t kMostRows = 4096;  // that are decoded of a stream: more only take longer

void demand(bool holds) {
  if (!holds) std::abort();
}

/// A folder in memory with the one file that every input is written into. It goes with the process.
struct Place {
  std::string folder, file;
  Place() {
    std::string name = "/dev/shm/burrhole-fuzz-XXXXXX";
    demand(mkdtemp(name.data()) != nullptr);
    folder = name;
    file = folder + "/s.sqlite";
  }
  ~Place() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

const Place& place() {
  static const Place made;
  return made;
}

std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A session with rows, inputs with a park, events, stills and hashes, in pages of 512 bytes and without a log.
std::string make_valid() {
  const SessionMeta meta{
      .program = "p", .scene_path = "s", .scene = "a = 1\n", .tool = "b = 2\n", .seed = 3, .created = "2026", .physics_version = 4};
  const SessionLayout layout{
      {{"servo", {{"time", "s", Keep::exact}, {"force", "N", Keep::coarse}}}, {"bone", {{"mass", "", Keep::exact}}}}, 10, 4};
  auto writer = SessionWriter::create(place().file, meta, layout);
  demand(writer.ok());
  for (int n = 0; n < 25; ++n) {
    const double t = 0.001 * n;
    demand(writer->append(0, std::array{t, std::sin(t)}).ok() && writer->append(1, std::array{static_cast<double>(n)}).ok());
  }
  demand(writer->input({3, "spin", 1.0, "t", "d", {}}).ok() && writer->input({5, "undo", 0.0, "", "", {20, 20}}).ok());
  demand(writer->event({0.5, 7, "k", "t", "d"}).ok() && writer->hash({"voxels", "0123"}).ok());
  demand(writer->still({2, "after", "99", "view"}).ok() && writer->close().ok());
  sqlite3* raw = nullptr;
  demand(sqlite3_open(place().file.c_str(), &raw) == SQLITE_OK);
  demand(sqlite_wrapper::execute(raw, "PRAGMA journal_mode = DELETE; PRAGMA page_size = 512; VACUUM"));
  sqlite3_close(raw);
  return content_of(place().file);
}

/// What is left of an input, taken in pieces.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  [[nodiscard]] bool more() const { return left_ > 0; }
  std::uint8_t byte() { return left_ > 0 ? (--left_, *at_++) : std::uint8_t{0}; }
  std::string bytes(std::size_t count) {
    count = std::min(count, left_);
    std::string out(reinterpret_cast<const char*>(at_), count);
    at_ += count;
    left_ -= count;
    return out;
  }
  template <class Number>
  Number number() {
    Number out{};
    const std::string taken = bytes(sizeof out);
    std::memcpy(&out, taken.data(), taken.size());
    return out;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

struct Table {
  const char* name;
  std::array<const char*, 6> columns;
};
constexpr Table kTables[] = {{"meta", {"key", "value"}},
                             {"streams", {"position", "name"}},
                             {"columns", {"stream", "position", "name", "unit", "keep"}},
                             {"blocks", {"stream", "first_row", "rows", "data"}},
                             {"inputs", {"id", "tick", "kind", "value", "text", "data"}},
                             {"parks", {"input", "stream", "rows"}},
                             {"events", {"id", "time_s", "tick", "kind", "text", "data"}},
                             {"stills", {"id", "bone_step", "name", "hash", "view", "parks"}},
                             {"hashes", {"kind", "value"}},
                             {"ends", {"name", "rows"}},
                             {"sqlite_master", {"type", "name", "tbl_name", "rootpage", "sql"}}};

/// Binds a value of any type that SQLite has.
void bind_value(Statement& statement, int index, Source& source) {
  switch (source.byte() % 6) {
    case 0:
      statement.bind(index, std::int64_t{source.byte()});
      break;
    case 1:
      statement.bind(index, source.number<std::int64_t>());
      break;
    case 2:
      statement.bind(index, source.number<double>());
      break;
    case 3:
      statement.bind(index, source.bytes(source.byte()));
      break;
    case 4:
      statement.bind_blob(index, source.bytes(source.byte()));
      break;
    default:  // stays NULL
      break;
  }
}

/// One row of one table: another value, no row, or one row more. The constraints of the tables may refuse it.
void edit_value(sqlite3* database, Source& source) {
  const Table& table = kTables[source.byte() % std::size(kTables)];
  const std::string row =
      " WHERE rowid = (SELECT rowid FROM " + std::string(table.name) + " LIMIT 1 OFFSET " + std::to_string(source.byte() % 32) + ")";
  const auto used = static_cast<std::size_t>(std::ranges::find(table.columns, nullptr) - table.columns.begin());
  const std::uint8_t kind = source.byte() % 4;
  if (kind == 0) {
    static_cast<void>(sqlite_wrapper::execute(database, "DELETE FROM " + std::string(table.name) + row));
  } else if (kind == 1) {
    std::string marks = "?";
    for (std::size_t n = 1; n < used; ++n) marks += ",?";
    Statement insert(database, "INSERT INTO " + std::string(table.name) + " VALUES (" + marks + ")");
    for (std::size_t n = 0; n < used; ++n) bind_value(insert, static_cast<int>(n) + 1, source);
    static_cast<void>(insert.run());
  } else {
    Statement update(database, "UPDATE " + std::string(table.name) + " SET " + table.columns[source.byte() % used] + " = ?1" + row);
    bind_value(update, 1, source);
    static_cast<void>(update.run());
  }
}

/// The payload of a block of rows: bytes as they are within a valid zlib stream, with a header that may say anything.
void edit_block(sqlite3* database, Source& source) {
  const auto row = std::int64_t{source.byte() % 8};
  std::string header = source.bytes(5), payload = source.bytes(source.number<std::uint16_t>() % 2048);
  uLongf size = compressBound(payload.size());
  std::string packed(size, '\0');
  demand(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(payload.data()), payload.size()) == Z_OK);
  packed.resize(size);
  Statement update(database, "UPDATE blocks SET data = ?1 WHERE rowid = (SELECT rowid FROM blocks LIMIT 1 OFFSET ?2)");
  update.bind_blob(1, header + packed);
  update.bind(2, row);
  static_cast<void>(update.run());
}

void edit_schema(sqlite3* database, Source& source) {
  constexpr const char* kStatements[] = {"CREATE VIEW v AS SELECT key, value FROM meta",
                                         "CREATE TABLE ticks(first_row INTEGER, rows INTEGER, data BLOB)",
                                         "CREATE TABLE ticks_bone(first_row INTEGER, rows INTEGER, data BLOB)",
                                         "CREATE INDEX i ON meta(value)",
                                         "CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM meta; END",
                                         "DROP TABLE parks",
                                         "DROP TABLE columns; CREATE TABLE columns(position INTEGER, name TEXT, unit TEXT)",
                                         "ALTER TABLE events ADD COLUMN more",
                                         "ALTER TABLE meta RENAME TO other",
                                         "PRAGMA user_version = 1",
                                         "PRAGMA encoding = 'UTF-16'; VACUUM"};
  static_cast<void>(sqlite_wrapper::execute(database, kStatements[source.byte() % std::size(kStatements)]));
}

/// @returns the valid session after the edits that the source lists.
std::string edited(const std::string& valid, Source& source) {
  sqlite3* raw = nullptr;
  demand(sqlite3_open(":memory:", &raw) == SQLITE_OK);
  auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(valid.size()));
  std::memcpy(copy, valid.data(), valid.size());
  const auto bytes = static_cast<sqlite3_int64>(valid.size());
  demand(sqlite3_deserialize(raw, "main", copy, bytes, bytes, SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) == SQLITE_OK);
  static_cast<void>(sqlite_wrapper::execute(raw, "PRAGMA writable_schema = ON"));
  for (int n = source.byte() % kMostEdits; n > 0 && source.more(); --n) {
    const std::uint8_t kind = source.byte() % 8;
    kind == 0 ? edit_schema(raw, source) : kind < 3 ? edit_block(raw, source) : edit_value(raw, source);
  }
  sqlite3_int64 size = 0;
  unsigned char* image = sqlite3_serialize(raw, "main", &size, 0);
  std::string out(reinterpret_cast<const char*>(image), image != nullptr ? static_cast<std::size_t>(size) : 0);
  sqlite3_free(image);
  sqlite3_close(raw);
  // What is left of the source are bytes of pages, then an end.
  for (int n = source.byte() % kMostEdits; n > 0 && source.more() && !out.empty(); --n) {
    const auto at = source.number<std::uint16_t>() % out.size();
    out[at] = static_cast<char>(source.byte());
  }
  if (source.byte() == 1) out.resize(std::min<std::size_t>(out.size(), source.number<std::uint16_t>()));
  return out;
}

void check_accepted(const SessionReader& session) {
  demand(session.schema() >= 1 && session.schema() <= kSessionSchema && !session.streams().empty());
  for (const SessionStream& stream : session.streams()) {
    demand(!stream.columns.empty() && session.row_count(stream.name) >= 0);
    const std::int64_t count = std::min(session.row_count(stream.name), kMostRows);
    const auto rows = session.rows(stream.name, 0, count);
    if (rows) demand(rows->size() == static_cast<std::size_t>(count) * session.stream(stream.name)->columns.size());
    if (!rows) demand(!rows.error().message.empty() && rows.error().text().find('\n') == std::string::npos);
  }
  std::int64_t tick = 0;
  for (const SessionInput& input : session.inputs()) {
    demand(input.tick >= tick && std::isfinite(input.value));
    demand(input.rows_before.empty() || input.rows_before.size() == session.streams().size());
    tick = input.tick;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string valid = make_valid();
  if (size == 0) return 0;
  Source source(data + 1, size - 1);
  const std::string file = data[0] % 8 == 0 ? source.bytes(size) : edited(valid, source);
  std::ofstream(place().file, std::ios::binary | std::ios::trunc) << file;
  const auto session = SessionReader::open(place().file);
  if (session) {
    check_accepted(*session);
  } else {
    demand(session.error().place == place().file && !session.error().message.empty());
    demand(session.error().text().find('\n') == std::string::npos);
  }
  static_cast<void>(is_session_file(place().file));
  return 0;
}
