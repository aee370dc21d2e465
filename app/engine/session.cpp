#include "app/engine/session.h"

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr int kApplicationId = 0x62757272;  // "burr"
constexpr const char* kSchemaSql =
    "CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE events(id INTEGER PRIMARY KEY, time_s REAL NOT NULL, tick INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL, data "
    "BLOB "
    "NOT NULL);"
    "CREATE TABLE hashes(kind TEXT PRIMARY KEY, value TEXT NOT NULL);";

/// What the names of a stream's tables end in; the ticks' own have no ending.
std::string ending_of(const std::string& stream) { return stream.empty() ? "" : "_" + stream; }

std::string tables_sql(const std::string& stream) {
  const std::string ending = ending_of(stream);
  return "CREATE TABLE columns" + ending + "(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL);" +
         "CREATE TABLE ticks" + ending + "(first_row INTEGER PRIMARY KEY, rows INTEGER NOT NULL, data BLOB NOT NULL);";
}

struct CloseDatabase {
  void operator()(sqlite3* database) const noexcept { sqlite3_close(database); }
};
struct EndStatement {
  void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

/// A prepared statement. Binding counts from 1, columns from 0, as in SQLite; an SQL text that does not compile is a damaged file.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
    statement_.reset(statement);
  }
  void bind(int index, double value) { sqlite3_bind_double(statement_.get(), index, value); }
  void bind(int index, std::int64_t value) { sqlite3_bind_int64(statement_.get(), index, value); }
  void bind(int index, const std::string& text) {
    sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  }
  void bind_blob(int index, const std::string& bytes) {
    // A null pointer would bind NULL, and an empty string may hold one.
    sqlite3_bind_blob64(statement_.get(), index, bytes.empty() ? "" : bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  }
  /// @returns SQLITE_ROW, SQLITE_DONE or a fault.
  int step() { return statement_ ? sqlite3_step(statement_.get()) : SQLITE_ERROR; }
  /// Runs a statement without results. @returns whether it was done.
  bool run() {
    const bool done = step() == SQLITE_DONE;
    sqlite3_reset(statement_.get());
    return done;
  }
  [[nodiscard]] std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  [[nodiscard]] double real(int column) const { return sqlite3_column_double(statement_.get(), column); }
  [[nodiscard]] std::string bytes(int column) const {
    const void* data = sqlite3_column_blob(statement_.get(), column);
    return data == nullptr
               ? std::string()
               : std::string(static_cast<const char*>(data), static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
  }

 private:
  std::unique_ptr<sqlite3_stmt, EndStatement> statement_;
};

bool execute(sqlite3* database, const std::string& sql) {
  return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

/// @returns the integer that a pragma answers, or nothing if it fails.
std::optional<std::int64_t> pragma(sqlite3* database, const char* sql) {
  Statement statement(database, sql);
  if (statement.step() != SQLITE_ROW) return std::nullopt;
  return statement.integer(0);
}

void put_little_endian(double value, std::string& out) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int shift = 0; shift < 64; shift += 8) out += static_cast<char>(bits >> shift & 0xffu);
}

double get_little_endian(const char* bytes) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return std::bit_cast<double>(bits);
}

/// The meta rows and their fields: one list for writing and reading. The seed travels as text: SQLite's integers are signed.
std::vector<std::pair<const char*, std::string SessionMeta::*>> meta_texts() {
  return {{"program", &SessionMeta::program},
          {"scene_path", &SessionMeta::scene_path},
          {"scene", &SessionMeta::scene},
          {"tool", &SessionMeta::tool},
          {"created", &SessionMeta::created}};
}

bool write_columns(sqlite3* database, const SessionStream& stream) {
  Statement insert(database, "INSERT INTO columns" + ending_of(stream.name) + " VALUES(?, ?, ?)");
  bool done = true;
  for (std::size_t i = 0; i < stream.columns.size(); ++i) {
    insert.bind(1, static_cast<std::int64_t>(i));
    insert.bind(2, stream.columns[i].name);
    insert.bind(3, stream.columns[i].unit);
    done = done && insert.run();
  }
  return done;
}

bool write_meta(sqlite3* database, const SessionMeta& meta) {
  Statement insert(database, "INSERT INTO meta VALUES(?, ?)");
  const auto put = [&](const std::string& key, const std::string& value) {
    insert.bind(1, key);
    insert.bind(2, value);
    return insert.run();
  };
  bool done = put("seed", std::to_string(meta.seed));
  for (const auto& [key, field] : meta_texts()) done = done && put(key, meta.*field);
  return done;
}

/// Opens without creating. A file that only may be read, in a folder that only may be read, opens as one that nobody can change: SQLite
/// would otherwise want to make its shared-memory file beside it. With a WAL still there that would hide committed rows, so then it stays
/// a fault.
Database open_existing(const std::string& path) {
  sqlite3* raw = nullptr;
  sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE, nullptr);
  Database database(raw);
  if (!database || pragma(raw, "PRAGMA schema_version")) return database;
  if (sqlite3_errcode(raw) != SQLITE_CANTOPEN && sqlite3_errcode(raw) != SQLITE_READONLY) return database;
  std::error_code ignored;
  if (std::filesystem::file_size(path + "-wal", ignored) > 0 && !ignored) return database;
  std::string uri = "file:";
  for (const char c : path) {
    constexpr std::string_view kReserved = "%?#";
    constexpr const char* kEscapes[] = {"%25", "%3f", "%23"};
    const std::size_t at = kReserved.find(c);
    uri += at == std::string_view::npos ? std::string(1, c) : kEscapes[at];
  }
  raw = nullptr;
  sqlite3_open_v2((uri + "?immutable=1").c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  return Database(raw);
}

/// An older session goes; anything else that stands at `path` is not ours to remove.
Status make_way(const std::string& path) {
  std::error_code fault;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, fault);
  if (fault) return bad_input("cannot make the folder: " + fault.message(), folder.string());
  // SQLite says only that it could not open; the system's reason is asked for here.
  if (::access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0)
    return bad_input(std::string("cannot be written: ") + std::strerror(errno), path);
  if (std::filesystem::exists(path, fault)) {
    const bool ours =
        std::filesystem::is_regular_file(path, fault) &&
        (std::filesystem::file_size(path, fault) == 0 || pragma(open_existing(path).get(), "PRAGMA application_id") == kApplicationId);
    if (!ours) return bad_input("is there already and is no burrhole session; it is left as it was", path);
  }
  for (const char* suffix : {"", "-wal", "-shm"}) {
    std::filesystem::remove(path + suffix, fault);
    if (fault) return bad_input("cannot replace: " + fault.message(), path + suffix);
  }
  return {};
}

Error damaged(const std::string& path, const std::string& what) { return bad_input("is damaged: " + what, path); }

/// Rows of one stream on their way into blocks.
struct RowBlocks {
  std::string ending;          // of the table's name
  std::size_t columns = 0;     // values in a row
  std::int64_t first_row = 0;  // of the block being filled
  std::int64_t rows = 0;       // in it
  std::string block;

  void add(std::span<const double> row) {
    BH_ASSERT(row.size() == columns);
    for (const double value : row) put_little_endian(value, block);
    ++rows;
  }
  /// Puts the block away.
  bool flush(sqlite3* database) {
    if (rows == 0) return true;
    Statement insert(database, "INSERT INTO ticks" + ending + " VALUES(?, ?, ?)");
    insert.bind(1, first_row);
    insert.bind(2, rows);
    insert.bind_blob(3, block);
    if (!insert.run()) return false;
    first_row += rows;
    rows = 0;
    block.clear();
    return true;
  }
};

}  // namespace

struct SessionWriter::State {
  std::string path;
  Database database;
  std::int64_t rows_per_block = 1;
  std::vector<RowBlocks> streams;  // the ticks first

  Error fault(const char* doing) const {
    return bad_input(std::string("cannot ") + doing + " the session: " + (database ? sqlite3_errmsg(database.get()) : "no memory"), path);
  }
  /// Puts the blocks away and makes everything so far permanent; the next transaction begins at once.
  Status commit() {
    for (RowBlocks& stream : streams)
      if (!stream.flush(database.get())) return fault("write");
    if (!execute(database.get(), "COMMIT; BEGIN")) return fault("write");
    return {};
  }
};

SessionWriter::SessionWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SessionWriter::SessionWriter(SessionWriter&&) noexcept = default;
SessionWriter& SessionWriter::operator=(SessionWriter&& other) noexcept {
  if (this != &other) {
    if (state_) static_cast<void>(close());
    state_ = std::move(other.state_);
  }
  return *this;
}
SessionWriter::~SessionWriter() {
  if (state_) static_cast<void>(close());
}

Result<SessionWriter> SessionWriter::create(const std::string& path, const SessionMeta& meta, const std::vector<SessionColumn>& columns,
                                            std::int64_t rows_per_second, const std::vector<SessionStream>& streams) {
  BH_ASSERT(rows_per_second > 0 && !columns.empty());
  if (const Status free = make_way(path); !free) return free.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->rows_per_block = rows_per_second;
  std::vector<SessionStream> all{{"", columns}};
  all.insert(all.end(), streams.begin(), streams.end());
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  state->database.reset(raw);
  if (code != SQLITE_OK) return state->fault("create");
  // NORMAL: no wait for the disk at a commit, which a killed process does not need. The checkpoint puts the schema into the file itself.
  std::string set_up = "PRAGMA application_id = " + std::to_string(kApplicationId) +
                       "; PRAGMA user_version = " + std::to_string(kSessionSchema) +
                       "; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN;" + kSchemaSql;
  for (const SessionStream& stream : all) set_up += tables_sql(stream.name);
  bool made = execute(raw, set_up) && write_meta(raw, meta);
  for (const SessionStream& stream : all) {
    made = made && write_columns(raw, stream);
    state->streams.push_back({ending_of(stream.name), stream.columns.size(), 0, 0, {}});
  }
  if (!made || !execute(raw, "COMMIT; PRAGMA wal_checkpoint; BEGIN")) return state->fault("create");
  return SessionWriter(std::move(state));
}

Status SessionWriter::append(std::span<const double> row) {
  BH_ASSERT(state_ && state_->database);
  RowBlocks& ticks = state_->streams.front();
  ticks.add(row);
  // The first row alone: a session is never without one for a second after its start.
  if (ticks.rows < state_->rows_per_block && ticks.first_row > 0) return {};
  return state_->commit();
}

Status SessionWriter::append_to(std::size_t stream, std::span<const double> row) {
  BH_ASSERT(state_ && state_->database && stream + 1 < state_->streams.size());
  state_->streams[stream + 1].add(row);
  return {};
}

Status SessionWriter::event(const SessionEvent& event) {
  BH_ASSERT(state_ && state_->database);
  Statement insert(state_->database.get(), "INSERT INTO events(time_s, tick, kind, text, data) VALUES(?, ?, ?, ?, ?)");
  insert.bind(1, event.time_s);
  insert.bind(2, event.tick);
  insert.bind(3, event.kind);
  insert.bind(4, event.text);
  insert.bind_blob(5, event.data);
  if (!insert.run()) return state_->fault("write");
  return {};
}

Status SessionWriter::hash(const SessionHash& hash) {
  BH_ASSERT(state_ && state_->database);
  Statement insert(state_->database.get(), "INSERT OR REPLACE INTO hashes VALUES(?, ?)");
  insert.bind(1, hash.kind);
  insert.bind(2, hash.value);
  if (!insert.run()) return state_->fault("write");
  return {};
}

Status SessionWriter::close() {
  if (!state_->database) return {};
  Status status = state_->commit();
  if (status && !execute(state_->database.get(), "COMMIT")) status = state_->fault("close");
  state_->database.reset();
  return status;
}

struct SessionReader::State {
  std::string path;
  Database database;
  SessionMeta meta;
  std::vector<SessionStream> streams;    // the ticks first, without a name
  std::vector<std::int64_t> row_counts;  // of each stream
  std::vector<SessionEvent> events;
  std::vector<SessionHash> hashes;

  Status check_identity();
  Status read_meta();
  Status read_streams();
  Status read_events_and_hashes();
  Status check_blocks();
  Result<std::int64_t> count_rows(const SessionStream& stream) const;
  Result<std::vector<double>> rows(std::size_t stream, std::int64_t first, std::int64_t count) const;
};

/// Is it SQLite, ours, not newer than we are, and whole?
Status SessionReader::State::check_identity() {
  sqlite3* raw = database.get();
  const std::optional<std::int64_t> id = pragma(raw, "PRAGMA application_id");
  if (!id) {
    if (sqlite3_errcode(raw) == SQLITE_NOTADB) return bad_input("is no burrhole session (not an SQLite file)", path);
    return bad_input(std::string("cannot be read: ") + sqlite3_errmsg(raw), path);
  }
  if (*id != kApplicationId) return bad_input("is no burrhole session", path);
  const std::int64_t schema = pragma(raw, "PRAGMA user_version").value_or(0);
  if (schema > kSessionSchema)
    return bad_input(
        "is a session of schema " + std::to_string(schema) + "; this program reads up to schema " + std::to_string(kSessionSchema), path);
  if (schema < 1) return damaged(path, "it names no schema");
  // SQLite reads the bytes that lack from a last page as zeros, and says nothing.
  std::error_code fault;
  const std::int64_t page = pragma(raw, "PRAGMA page_size").value_or(0);
  if (page < 1 || static_cast<std::int64_t>(std::filesystem::file_size(path, fault)) % page != 0 || fault)
    return damaged(path, "it was cut short");
  Statement check(raw, "PRAGMA quick_check(1)");
  if (check.step() != SQLITE_ROW) return damaged(path, sqlite3_errmsg(raw));
  if (const std::string answer = check.bytes(0); answer != "ok") return damaged(path, answer);
  return {};
}

Status SessionReader::State::read_meta() {
  Statement select(database.get(), "SELECT key, value FROM meta");
  int code = SQLITE_DONE;
  while ((code = select.step()) == SQLITE_ROW) {
    const std::string key = select.bytes(0), value = select.bytes(1);
    for (const auto& [name, field] : meta_texts())
      if (key == name) meta.*field = value;
    if (key == "seed" && std::from_chars(value.data(), value.data() + value.size(), meta.seed).ec != std::errc())
      return damaged(path, "its seed is '" + value + "'");
  }
  if (code != SQLITE_DONE) return damaged(path, sqlite3_errmsg(database.get()));
  return {};
}

Status SessionReader::State::read_streams() {
  streams.push_back({});
  constexpr std::size_t kPrefix = std::string_view("ticks_").size();
  Statement table(database.get(), "SELECT name FROM sqlite_master WHERE type = 'table' AND name GLOB 'ticks_*' ORDER BY name");
  while (table.step() == SQLITE_ROW) streams.push_back({table.bytes(0).substr(kPrefix), {}});
  for (SessionStream& stream : streams) {
    // The name comes from a file that may be anyone's, and goes into a statement.
    constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyz_";
    if (stream.name.find_first_not_of(kLetters) != std::string::npos) return damaged(path, "it names a stream '" + stream.name + "'");
    Statement column(database.get(), "SELECT name, unit FROM columns" + ending_of(stream.name) + " ORDER BY position");
    int code = SQLITE_DONE;
    while ((code = column.step()) == SQLITE_ROW) stream.columns.push_back({column.bytes(0), column.bytes(1)});
    if (code != SQLITE_DONE) return damaged(path, sqlite3_errmsg(database.get()));
    if (stream.columns.empty()) return damaged(path, "it has no columns");
  }
  return {};
}

Status SessionReader::State::read_events_and_hashes() {
  Statement event(database.get(), "SELECT time_s, tick, kind, text, data FROM events ORDER BY id");
  int code = SQLITE_DONE;
  while ((code = event.step()) == SQLITE_ROW)
    events.push_back({event.real(0), event.integer(1), event.bytes(2), event.bytes(3), event.bytes(4)});
  if (code != SQLITE_DONE) return damaged(path, sqlite3_errmsg(database.get()));
  Statement hash(database.get(), "SELECT kind, value FROM hashes ORDER BY kind");
  while ((code = hash.step()) == SQLITE_ROW) hashes.push_back({hash.bytes(0), hash.bytes(1)});
  if (code != SQLITE_DONE) return damaged(path, sqlite3_errmsg(database.get()));
  return {};
}

Status SessionReader::State::check_blocks() {
  for (const SessionStream& stream : streams) {
    const auto count = count_rows(stream);
    if (!count) return count.error();
    row_counts.push_back(*count);
  }
  return {};
}

/// Blocks must follow one another without a hole and hold as many values as they say.
Result<std::int64_t> SessionReader::State::count_rows(const SessionStream& stream) const {
  Statement block(database.get(), "SELECT first_row, rows, length(data) FROM ticks" + ending_of(stream.name) + " ORDER BY first_row");
  const auto row_bytes = static_cast<std::int64_t>(8 * stream.columns.size());
  std::int64_t row_count = 0;
  int code = SQLITE_DONE;
  while ((code = block.step()) == SQLITE_ROW) {
    const std::int64_t rows = block.integer(1);
    if (block.integer(0) != row_count || rows < 1 || rows > block.integer(2) || block.integer(2) != rows * row_bytes)
      return damaged(path, "its rows are not whole after row " + std::to_string(row_count));
    row_count += rows;
  }
  if (code != SQLITE_DONE) return damaged(path, sqlite3_errmsg(database.get()));
  return row_count;
}

SessionReader::SessionReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SessionReader::SessionReader(SessionReader&&) noexcept = default;
SessionReader& SessionReader::operator=(SessionReader&&) noexcept = default;
SessionReader::~SessionReader() = default;

Result<SessionReader> SessionReader::open(const std::string& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) return bad_input(fault ? "cannot be opened: " + fault.message() : "is no file", path);
  auto state = std::make_unique<State>();
  state->path = path;
  state->database = open_existing(path);
  if (!state->database) return bad_input("cannot be opened: no memory", path);
  for (const auto step :
       {&State::check_identity, &State::read_meta, &State::read_streams, &State::read_events_and_hashes, &State::check_blocks})
    if (const Status done = (state.get()->*step)(); !done) return done.error();
  return SessionReader(std::move(state));
}

const SessionMeta& SessionReader::meta() const noexcept { return state_->meta; }
const std::vector<SessionColumn>& SessionReader::columns() const noexcept { return state_->streams.front().columns; }
const std::vector<SessionEvent>& SessionReader::events() const noexcept { return state_->events; }
const std::vector<SessionHash>& SessionReader::hashes() const noexcept { return state_->hashes; }
std::int64_t SessionReader::row_count() const noexcept { return state_->row_counts.front(); }

const SessionStream* SessionReader::stream(const std::string& name) const noexcept {
  const auto found =
      std::find_if(state_->streams.begin() + 1, state_->streams.end(), [&](const SessionStream& s) { return s.name == name; });
  return found == state_->streams.end() ? nullptr : &*found;
}

Result<std::vector<double>> SessionReader::stream_rows(const std::string& name) const {
  const SessionStream* found = stream(name);
  if (found == nullptr) return bad_input("the session has no rows of " + name, state_->path);
  const auto at = static_cast<std::size_t>(found - state_->streams.data());
  return state_->rows(at, 0, state_->row_counts[at]);
}

Result<std::vector<double>> SessionReader::rows(std::int64_t first, std::int64_t count) const { return state_->rows(0, first, count); }

Result<std::vector<double>> SessionReader::State::rows(std::size_t stream, std::int64_t first, std::int64_t count) const {
  const std::int64_t begin = std::clamp<std::int64_t>(first, 0, row_counts[stream]);
  const std::int64_t end = begin + std::clamp<std::int64_t>(count, 0, row_counts[stream] - begin);
  const std::size_t width = streams[stream].columns.size();
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(end - begin) * width);
  Statement block(database.get(), "SELECT first_row, rows, data FROM ticks" + ending_of(streams[stream].name) +
                                      " WHERE first_row < ? AND first_row + rows > ? ORDER BY first_row");
  block.bind(1, end);
  block.bind(2, begin);
  int code = SQLITE_DONE;
  while ((code = block.step()) == SQLITE_ROW) {
    const std::int64_t block_first = block.integer(0);
    const std::string data = block.bytes(2);
    const auto from = static_cast<std::size_t>(std::max<std::int64_t>(begin - block_first, 0)) * width;
    const auto to = static_cast<std::size_t>(std::min(end - block_first, block.integer(1))) * width;
    for (std::size_t i = from; i < to; ++i) values.push_back(get_little_endian(data.data() + 8 * i));
  }
  if (code != SQLITE_DONE || values.size() != static_cast<std::size_t>(end - begin) * width)
    return damaged(path, sqlite3_errmsg(database.get()));
  return values;
}

}  // namespace burrhole
