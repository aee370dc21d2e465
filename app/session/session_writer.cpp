#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "app/session/row_codec.h"
#include "app/session/session.h"
#include "app/session/session_format.h"
#include "app/session/sqlite_file.h"
#include "core/base/assert.h"
#include "core/base/descriptor.h"
#include "core/base/output_file.h"

namespace burrhole {
namespace {

using namespace session_format;
using namespace sqlite_wrapper;

/// Removes an older session; any other file at `path` is refused.
Status clear_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) return bad_input("cannot make the folder: " + error.message(), folder.string());
  // SQLite reports only that it could not open the file; access() gives the system's reason.
  if (::access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0)
    return bad_input(std::string("cannot be written: ") + std::strerror(errno), path);
  if (std::filesystem::exists(path, error) && !is_session_file(path))
    return bad_input("is there already and is no burrhole session; it is left as it was", path);
  for (const char* suffix : {"", "-wal", "-shm"}) {
    std::filesystem::remove(path + suffix, error);
    if (error) return bad_input("cannot replace: " + error.message(), path + suffix);
  }
  return {};
}

bool write_meta(sqlite3* database, const SessionMeta& meta) {
  Statement insert(database, "INSERT INTO meta VALUES(?, ?)");
  const auto put = [&](const std::string& key, const std::string& value) {
    insert.bind(1, key);
    insert.bind(2, value);
    return insert.run();
  };
  bool done = put("schema", std::to_string(kSessionSchema)) && put("seed", std::to_string(meta.seed)) &&
              put("physics_version", std::to_string(meta.physics_version));
  for (const auto& [key, field] : meta_texts()) done = done && put(key, meta.*field);
  return done;
}

bool write_streams(sqlite3* database, const std::vector<SessionStream>& streams) {
  Statement stream(database, "INSERT INTO streams VALUES(?, ?)");
  Statement column(database, "INSERT INTO columns VALUES(?, ?, ?, ?, ?)");
  bool done = true;
  for (std::size_t s = 0; s < streams.size(); ++s) {
    stream.bind(1, static_cast<std::int64_t>(s));
    stream.bind(2, streams[s].name);
    done = done && stream.run();
    for (std::size_t c = 0; c < streams[s].columns.size(); ++c) {
      const SessionColumn& now = streams[s].columns[c];
      column.bind(1, static_cast<std::int64_t>(s));
      column.bind(2, static_cast<std::int64_t>(c));
      column.bind(3, now.name);
      column.bind(4, now.unit);
      column.bind(5, std::string(name_of(now.keep)));
      done = done && column.run();
    }
  }
  return done;
}

/// Rows of one stream that are not written as a block yet.
struct Pending {
  std::int64_t first_row = 0, rows = 0;
  std::vector<double> values;
};

}  // namespace

/// Reads the header of the file itself: to open a database in WAL mode, SQLite would write beside it.
bool is_session_file(const std::string& path) {
  constexpr std::string_view kStart("SQLite format 3\0", 16);
  constexpr std::size_t kIdAt = 68;  // big-endian, of the database header
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::array<char, kIdAt + 4> header{};
  const Descriptor file(open_descriptor(path.c_str(), O_RDONLY));
  const ssize_t count = ::pread(file.get(), header.data(), header.size(), 0);  // none of a descriptor that is none
  if (count != static_cast<ssize_t>(header.size())) return count == 0;
  std::int64_t id = 0;
  for (std::size_t n = kIdAt; n < header.size(); ++n) id = id << 8 | static_cast<unsigned char>(header[n]);
  return std::string_view(header.data(), kStart.size()) == kStart && id == kApplicationId;
}

struct SessionWriter::State {
  std::string path;
  Database database;
  SessionLayout layout;
  std::vector<Pending> pending;  // of each stream
  std::int64_t inputs = 0, last_input_tick = 0;
  std::int64_t parks = 0;  // of the inputs, those that parked the clocks

  Error failed_to(const char* doing) const {
    if (!database) return bad_input(std::string("cannot ") + doing + " the session: no memory", path);
    std::string message = std::string("cannot ") + doing + " the session: " + sqlite3_errmsg(database.get());
    // SQLite keeps the system's reason of some failures only.
    if (const int reason = sqlite3_system_errno(database.get()); reason != 0)
      message += "; it " + write_error(path, reason).message;
    else if (const int code = sqlite3_errcode(database.get()); code == SQLITE_FULL)
      message += ": free space there, or name another place";
    else if (code == SQLITE_IOERR)
      message += "; the disk or a limit of the size of files (ulimit -f) refuses it: name another place";
    return bad_input(std::move(message), path);
  }
  bool write_block(std::size_t stream);
  bool write_ends();
  /// Writes all blocks and commits; the next transaction begins immediately.
  Status commit();
};

bool SessionWriter::State::write_block(std::size_t stream) {
  Pending& now = pending[stream];
  if (now.rows == 0) return true;
  Statement insert(database.get(), "INSERT INTO blocks VALUES(?, ?, ?, ?)");
  insert.bind(1, static_cast<std::int64_t>(stream));
  insert.bind(2, now.first_row);
  insert.bind(3, now.rows);
  insert.bind_blob(4, encode_rows(now.values, layout.streams[stream].columns, layout.coarse_every));
  if (!insert.run()) return false;
  now.first_row += now.rows;
  now.rows = 0;
  now.values.clear();
  return true;
}

bool SessionWriter::State::write_ends() {
  Statement insert(database.get(), "INSERT INTO ends VALUES(?, ?)");
  const auto put = [&](const std::string& name, std::int64_t rows) {
    insert.bind(1, name);
    insert.bind(2, rows);
    return insert.run();
  };
  bool done = put(kInputsEnd, inputs);
  for (std::size_t s = 0; s < pending.size(); ++s) done = done && put(layout.streams[s].name, pending[s].first_row);
  return done;
}

Status SessionWriter::State::commit() {
  for (std::size_t stream = 0; stream < pending.size(); ++stream)
    if (!write_block(stream)) return failed_to("write");
  if (!execute(database.get(), "COMMIT; BEGIN")) return failed_to("write");
  return {};
}

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

Result<SessionWriter> SessionWriter::create(const std::string& path, const SessionMeta& meta, const SessionLayout& layout) {
  BH_ASSERT(layout.rows_per_second > 0 && layout.coarse_every > 0 && !layout.streams.empty());
  for (const SessionStream& stream : layout.streams) BH_ASSERT(!stream.columns.empty() && stream.name != kInputsEnd);
  if (const Status free = clear_path(path); !free) return free.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->layout = layout;
  state->pending.resize(layout.streams.size());
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  state->database.reset(raw);
  // What there is by then is no session.
  const auto failed = [&] {
    Error error = state->failed_to("create");
    state->database.reset();
    static_cast<void>(clear_path(path));
    return error;
  };
  if (code != SQLITE_OK) return failed();
  constexpr int kWait = 5000;  // [ms] for a reader that has opened the new file, such as a backup
  sqlite3_busy_timeout(raw, kWait);
  // NORMAL: no wait for the disk at a commit, which a killed process does not need. The checkpoint puts the schema into the file itself.
  const std::string set_up = "PRAGMA application_id = " + std::to_string(kApplicationId) +
                             "; PRAGMA user_version = " + std::to_string(kSessionSchema) +
                             "; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN;" + kSchemaSql;
  if (!execute(raw, set_up) || !write_meta(raw, meta) || !write_streams(raw, layout.streams) ||
      !execute(raw, "COMMIT; PRAGMA wal_checkpoint; BEGIN"))
    return failed();
  return SessionWriter(std::move(state));
}

Status SessionWriter::append(std::size_t stream, std::span<const double> row) {
  BH_ASSERT(state_ && state_->database && stream < state_->pending.size());
  BH_ASSERT(row.size() == state_->layout.streams[stream].columns.size());
  Pending& pending = state_->pending[stream];
  pending.values.insert(pending.values.end(), row.begin(), row.end());
  ++pending.rows;
  // The first row is committed alone: a session always has one within a second of its start.
  if (stream > 0 || (pending.rows < state_->layout.rows_per_second && pending.first_row > 0)) return {};
  return state_->commit();
}

std::vector<std::int64_t> SessionWriter::rows() const {
  std::vector<std::int64_t> out;
  for (const Pending& pending : state_->pending) out.push_back(pending.first_row + pending.rows);
  return out;
}

Status SessionWriter::input(const SessionInput& input) {
  BH_ASSERT(state_ && state_->database);
  if (!std::isfinite(input.value) || input.tick < state_->last_input_tick ||
      (!input.rows_before.empty() && input.rows_before.size() != state_->pending.size()))
    return bad_input("an input that cannot be recorded: '" + input.kind + "' at tick " + std::to_string(input.tick), state_->path);
  Statement insert(state_->database.get(), "INSERT INTO inputs VALUES(?, ?, ?, ?, ?, ?)");
  const std::int64_t id = state_->inputs + 1;
  insert.bind(1, id);
  insert.bind(2, input.tick);
  insert.bind(3, input.kind);
  insert.bind(4, input.value);
  insert.bind(5, input.text);
  insert.bind_blob(6, input.data);
  if (!insert.run()) return state_->failed_to("write");
  Statement park(state_->database.get(), "INSERT INTO parks VALUES(?, ?, ?)");
  for (std::size_t stream = 0; stream < input.rows_before.size(); ++stream) {
    park.bind(1, id);
    park.bind(2, static_cast<std::int64_t>(stream));
    park.bind(3, input.rows_before[stream]);
    if (!park.run()) return state_->failed_to("write");
  }
  state_->inputs = id;
  if (!input.rows_before.empty()) ++state_->parks;
  state_->last_input_tick = input.tick;
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
  if (!insert.run()) return state_->failed_to("write");
  return {};
}

Status SessionWriter::still(const SessionStill& still) {
  BH_ASSERT(state_ && state_->database);
  Statement insert(state_->database.get(), "INSERT INTO stills(bone_step, name, hash, view, parks) VALUES(?, ?, ?, ?, ?)");
  insert.bind(1, still.bone_step);
  insert.bind(2, still.name);
  insert.bind(3, still.hash);
  insert.bind_blob(4, still.view);
  insert.bind(5, state_->parks);
  if (!insert.run()) return state_->failed_to("write");
  return {};
}

Status SessionWriter::hash(const SessionHash& hash) {
  BH_ASSERT(state_ && state_->database);
  Statement insert(state_->database.get(), "INSERT OR REPLACE INTO hashes VALUES(?, ?)");
  insert.bind(1, hash.kind);
  insert.bind(2, hash.value);
  if (!insert.run()) return state_->failed_to("write");
  return {};
}

Status SessionWriter::close() {
  if (!state_->database) return {};
  Status status = state_->commit();
  // The checkpoint puts all rows into the file itself; when the database is closed, SQLite would do so without reporting an error.
  if (status && !(state_->write_ends() && execute(state_->database.get(), "COMMIT; PRAGMA wal_checkpoint(TRUNCATE)")))
    status = state_->failed_to("close");
  // A file in WAL mode needs a folder that can be written to even for reading. A reader that has it open keeps the mode: no error.
  if (status) (void)execute(state_->database.get(), "PRAGMA journal_mode = DELETE");
  state_->database.reset();
  return status;
}

}  // namespace burrhole
