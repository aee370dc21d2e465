#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "app/session/row_codec.h"
#include "app/session/session.h"
#include "app/session/session_format.h"
#include "app/session/sqlite_file.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

using namespace session_format;
using namespace sqlite_wrapper;

struct BlockPlace {
  std::int64_t first_row = 0, rows = 0;
};

/// @returns the suffix of the table names of a schema-1 stream.
std::string ending_of(const std::string& stream) { return stream == kServoStream ? "" : "_" + stream; }

/// @returns the tables of a session and the statements that made them, as SQLite keeps them.
std::map<std::string, std::string> session_tables() {
  constexpr std::string_view kCreate = "CREATE TABLE ";
  std::map<std::string, std::string> out;
  for (std::string_view rest = kSchemaSql; !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view statement = rest.substr(0, end);
    const std::string_view name = statement.substr(kCreate.size(), statement.find('(') - kCreate.size());
    out.emplace(name, statement);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return out;
}

bool is_table_of_schema_1(const std::string& name) {
  return name == "meta" || name == "events" || name == "hashes" || name == "ticks" || name == "columns" || name.starts_with("ticks_") ||
         name.starts_with("columns_");
}

template <class Integer>
bool parse(const std::string& text, Integer& out) {
  return std::from_chars(text.data(), text.data() + text.size(), out).ec == std::errc();
}

}  // namespace

struct SessionReader::State {
  std::string path;
  Database database;
  int schema = 0;
  SessionMeta meta;
  std::vector<SessionStream> streams;
  std::vector<std::vector<BlockPlace>> blocks;  // of each stream, in order of rows, none empty
  std::vector<SessionInput> inputs;
  std::vector<SessionEvent> events;
  std::vector<SessionStill> stills;
  std::vector<SessionHash> hashes;

  /// @param what may contain text from the file.
  Error damaged(const std::string& what) const { return bad_input("is damaged: " + one_line(what, 200), path); }
  Error damaged() const {
    if (sqlite3_errcode(database.get()) == SQLITE_INTERRUPT) return damaged("SQLite takes more steps to read it than any session does");
    return damaged(sqlite3_errmsg(database.get()));
  }
  /// Calls `take` on each row of `select` until it fails.
  template <class Take>
  Status each(Statement& select, const Take& take) const {
    int code = SQLITE_DONE;
    while ((code = select.step()) == SQLITE_ROW)
      if (Status taken = take(); !taken) return taken;
    if (code != SQLITE_DONE) return damaged();
    return {};
  }
  std::int64_t row_count(std::size_t stream) const {
    return blocks[stream].empty() ? 0 : blocks[stream].back().first_row + blocks[stream].back().rows;
  }
  std::optional<std::size_t> find(const std::string& name) const;

  Status check_identity();
  Status check_tables();
  Status check_pages();
  Status read_meta();
  Status read_streams();
  Status read_streams_of_schema_1();
  Status read_columns(SessionStream& stream, Statement& select);
  Status read_blocks();
  Status read_inputs();
  Status read_parks();
  Status read_results();
  Status check_ends();
  Statement select_blocks(std::size_t stream) const;
  /// Calls take(first row of the block, its rows, its values) on each block that holds rows of [begin, end).
  template <class Take>
  Status each_block(std::size_t stream, std::int64_t begin, std::int64_t end, const Take& take) const;
};

/// Checks that the file is an SQLite file of this program with a known schema.
Status SessionReader::State::check_identity() {
  sqlite3* raw = database.get();
  const std::optional<std::int64_t> id = pragma(raw, "PRAGMA application_id");
  if (!id) {
    if (sqlite3_errcode(raw) == SQLITE_NOTADB) return bad_input("is not a session of burrhole (not an SQLite file)", path);
    return bad_input(std::string("cannot be read: ") + sqlite3_errmsg(raw), path);
  }
  if (*id != kApplicationId) return bad_input("is not a session of burrhole: another program wrote it", path);
  const std::int64_t version = pragma(raw, "PRAGMA user_version").value_or(0);
  if (version > kSessionSchema)
    return bad_input(
        "is a session of schema " + std::to_string(version) + "; this program reads up to schema " + std::to_string(kSessionSchema), path);
  if (version < 1) return damaged("it names no schema");
  schema = static_cast<int>(version);
  return {};
}

/// Only the tables that this program makes and their own indexes may be there: a view or a trigger is a program of who made the file.
Status SessionReader::State::check_tables() {
  const std::map<std::string, std::string> ours = session_tables();
  Statement select(database.get(), "SELECT type, name, sql, rootpage FROM sqlite_master");
  return each(select, [&]() -> Status {
    const std::string type = select.bytes(0), name = select.bytes(1), sql = select.bytes(2);
    if (type == "index" && sql.empty() && name.starts_with("sqlite_autoindex_")) return {};
    const auto table = ours.find(name);
    const bool known = schema == 1 ? is_table_of_schema_1(name) : table != ours.end() && table->second == sql;
    if (type == "table" && known && select.integer(3) > 0) return {};
    return bad_input("is not a session of burrhole: it has the " + one_line(type, 20) + " \"" + one_line(name, 60) +
                         "\" that no session has; it was made or changed by another program",
                     path);
  });
}

Status SessionReader::State::check_pages() {
  sqlite3* raw = database.get();
  // SQLite reads the missing bytes of a last page as zeros, without an error.
  std::error_code error;
  const std::int64_t page = pragma(raw, "PRAGMA page_size").value_or(0);
  if (page < 1 || static_cast<std::int64_t>(std::filesystem::file_size(path, error)) % page != 0 || error)
    return damaged("it was cut short");
  Statement check(raw, "PRAGMA quick_check(1)");
  if (check.step() != SQLITE_ROW) return damaged();
  // The first line of the answer only names the database.
  if (const std::string answer = check.bytes(0); answer != "ok") return damaged(answer.substr(answer.find_last_of('\n') + 1));
  return {};
}

Status SessionReader::State::read_meta() {
  Statement select(database.get(), "SELECT key, value FROM meta");
  return each(select, [&]() -> Status {
    const std::string key = select.bytes(0), value = select.bytes(1);
    for (const auto& [name, field] : meta_texts())
      if (key == name) meta.*field = value;
    if ((key == "seed" && !parse(value, meta.seed)) || (key == "physics_version" && !parse(value, meta.physics_version)))
      return damaged("its " + key + " is '" + value + "'");
    return {};
  });
}

Status SessionReader::State::read_columns(SessionStream& stream, Statement& select) {
  const Status read = each(select, [&]() -> Status {
    const std::string keep = select.bytes(2);
    if (keep != name_of(Keep::exact) && keep != name_of(Keep::coarse))
      return damaged("column " + select.bytes(0) + " is kept as '" + keep + "'");
    stream.columns.push_back({select.bytes(0), select.bytes(1), keep == name_of(Keep::exact) ? Keep::exact : Keep::coarse});
    return {};
  });
  if (!read) return read;
  if (stream.columns.empty()) return damaged("stream " + stream.name + " has no columns");
  return {};
}

Status SessionReader::State::read_streams_of_schema_1() {
  streams.push_back({kServoStream, {}});
  constexpr std::size_t kPrefix = std::string_view("ticks_").size();
  Statement table(database.get(), "SELECT name FROM sqlite_master WHERE type = 'table' AND name GLOB 'ticks_*' ORDER BY name");
  while (table.step() == SQLITE_ROW) streams.push_back({table.bytes(0).substr(kPrefix), {}});
  for (SessionStream& stream : streams) {
    // The name comes from the file and becomes part of a statement.
    constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyz_";
    if (stream.name.find_first_not_of(kLetters) != std::string::npos) return damaged("it names a stream '" + stream.name + "'");
    Statement select(database.get(), "SELECT name, unit, 'exact' FROM columns" + ending_of(stream.name) + " ORDER BY position");
    if (Status read = read_columns(stream, select); !read) return read;
  }
  return {};
}

Status SessionReader::State::read_streams() {
  if (schema == 1) return read_streams_of_schema_1();
  Statement select(database.get(), "SELECT position, name FROM streams ORDER BY position");
  const Status read = each(select, [&]() -> Status {
    if (select.integer(0) != static_cast<std::int64_t>(streams.size())) return damaged("a stream is missing");
    streams.push_back({select.bytes(1), {}});
    return {};
  });
  if (!read) return read;
  if (streams.empty()) return damaged("it has no streams");
  for (std::size_t n = 0; n < streams.size(); ++n) {
    Statement columns(database.get(), "SELECT name, unit, keep FROM columns WHERE stream = ? ORDER BY position");
    columns.bind(1, static_cast<std::int64_t>(n));
    if (Status done = read_columns(streams[n], columns); !done) return done;
  }
  return {};
}

Statement SessionReader::State::select_blocks(std::size_t stream) const {
  if (schema == 1) return {database.get(), "SELECT first_row, rows FROM ticks" + ending_of(streams[stream].name) + " ORDER BY first_row"};
  Statement out(database.get(), "SELECT first_row, rows FROM blocks WHERE stream = ? ORDER BY first_row");
  out.bind(1, static_cast<std::int64_t>(stream));
  return out;
}

/// Blocks must follow one another without a gap.
Status SessionReader::State::read_blocks() {
  constexpr std::int64_t kMostRows = std::int64_t{1} << 40;  // 35 years at 1 kHz: sums of damaged counts do not overflow
  blocks.resize(streams.size());
  for (std::size_t stream = 0; stream < streams.size(); ++stream) {
    Statement select = select_blocks(stream);
    const Status read = each(select, [&]() -> Status {
      const BlockPlace block{select.integer(0), select.integer(1)};
      if (block.first_row != row_count(stream) || block.rows < 1 || block.rows > kMostRows)
        return damaged("rows of stream " + streams[stream].name + " are missing after row " + std::to_string(row_count(stream)));
      blocks[stream].push_back(block);
      return {};
    });
    if (!read) return read;
  }
  return {};
}

Status SessionReader::State::read_inputs() {
  if (schema == 1) return {};
  Statement select(database.get(), "SELECT id, tick, kind, value, text, data FROM inputs ORDER BY id");
  const Status read = each(select, [&]() -> Status {
    const SessionInput input{select.integer(1), select.bytes(2), select.real(3), select.bytes(4), select.bytes(5), {}};
    if (select.integer(0) != static_cast<std::int64_t>(inputs.size()) + 1 || input.tick < (inputs.empty() ? 0 : inputs.back().tick) ||
        !std::isfinite(input.value))
      return damaged("its inputs do not follow from one another after input " + std::to_string(inputs.size()));
    inputs.push_back(input);
    return {};
  });
  return read ? read_parks() : read;
}

Status SessionReader::State::read_parks() {
  Statement select(database.get(), "SELECT input, stream, rows FROM parks ORDER BY input, stream");
  std::vector<std::int64_t> before(streams.size(), 0);
  const Status read = each(select, [&]() -> Status {
    const std::int64_t input = select.integer(0), rows = select.integer(2);
    const bool known = input >= 1 && input <= static_cast<std::int64_t>(inputs.size());
    std::vector<std::int64_t> none;
    std::vector<std::int64_t>& park = known ? inputs[static_cast<std::size_t>(input) - 1].rows_before : none;
    if (!known || park.size() >= streams.size() || select.integer(1) != static_cast<std::int64_t>(park.size()) ||
        rows < before[park.size()] || rows > row_count(park.size()))
      return damaged("rows before input " + std::to_string(input) + " are missing");
    before[park.size()] = rows;
    park.push_back(rows);
    return {};
  });
  if (!read) return read;
  for (const SessionInput& input : inputs)
    if (!input.rows_before.empty() && input.rows_before.size() != streams.size())
      return damaged("the place of input '" + input.kind + "' at tick " + std::to_string(input.tick) + " is not whole");
  return {};
}

Status SessionReader::State::read_results() {
  Statement event(database.get(), "SELECT time_s, tick, kind, text, data FROM events ORDER BY id");
  Status read = each(event, [&]() -> Status {
    events.push_back({event.real(0), event.integer(1), event.bytes(2), event.bytes(3), event.bytes(4)});
    return {};
  });
  if (!read) return read;
  Statement hash(database.get(), "SELECT kind, value FROM hashes ORDER BY kind");
  read = each(hash, [&]() -> Status {
    hashes.push_back({hash.bytes(0), hash.bytes(1)});
    return {};
  });
  if (!read || schema == 1) return read;
  Statement still(database.get(), "SELECT bone_step, name, hash, view, parks FROM stills ORDER BY id");
  return each(still, [&]() -> Status {
    stills.push_back({still.integer(0), still.bytes(1), still.bytes(2), still.bytes(3), still.integer(4)});
    return {};
  });
}

/// Compares with the numbers of rows that close() wrote. A killed run wrote none, so rows lost at its end are not detected.
Status SessionReader::State::check_ends() {
  if (schema == 1) return {};
  std::map<std::string, std::int64_t> ends;
  Statement select(database.get(), "SELECT name, rows FROM ends");
  const Status read = each(select, [&]() -> Status {
    ends[select.bytes(0)] = select.integer(1);
    return {};
  });
  if (!read || ends.empty()) return read;
  const auto check = [&](const std::string& name, std::int64_t rows) -> Status {
    const auto end = ends.find(name);
    if (end != ends.end() && end->second == rows) return {};
    return damaged("it ends with " + std::to_string(rows) + " rows of " + name +
                   (end == ends.end() ? "" : " instead of " + std::to_string(end->second)));
  };
  for (std::size_t stream = 0; stream < streams.size(); ++stream)
    if (Status whole = check(streams[stream].name, row_count(stream)); !whole) return whole;
  return check(kInputsEnd, static_cast<std::int64_t>(inputs.size()));
}

SessionReader::SessionReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SessionReader::SessionReader(SessionReader&&) noexcept = default;
SessionReader& SessionReader::operator=(SessionReader&&) noexcept = default;
SessionReader::~SessionReader() = default;

Result<SessionReader> SessionReader::open(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return bad_input(error ? "cannot be opened: " + error.message() : "is no file: give the session.sqlite of a run", path);
  auto state = std::make_unique<State>();
  state->path = path;
  state->database = open_existing(path);
  if (!state->database) return bad_input("cannot be opened: no memory", path);
  for (const auto step : {&State::check_identity, &State::check_tables, &State::check_pages, &State::read_meta, &State::read_streams,
                          &State::read_blocks, &State::read_inputs, &State::read_results, &State::check_ends})
    if (const Status done = (state.get()->*step)(); !done) return done.error();
  return SessionReader(std::move(state));
}

int SessionReader::schema() const noexcept { return state_->schema; }
const SessionMeta& SessionReader::meta() const noexcept { return state_->meta; }
const std::vector<SessionStream>& SessionReader::streams() const noexcept { return state_->streams; }
const std::vector<SessionInput>& SessionReader::inputs() const noexcept { return state_->inputs; }
const std::vector<SessionEvent>& SessionReader::events() const noexcept { return state_->events; }
const std::vector<SessionStill>& SessionReader::stills() const noexcept { return state_->stills; }
const std::vector<SessionHash>& SessionReader::hashes() const noexcept { return state_->hashes; }

std::optional<std::size_t> SessionReader::State::find(const std::string& name) const {
  const auto found = std::ranges::find(streams, name, &SessionStream::name);
  return found == streams.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - streams.begin()));
}

const SessionStream* SessionReader::stream(const std::string& name) const noexcept {
  const auto at = state_->find(name);
  return at ? &state_->streams[*at] : nullptr;
}

std::int64_t SessionReader::row_count(const std::string& stream) const noexcept {
  const auto at = state_->find(stream);
  return at ? state_->row_count(*at) : 0;
}

template <class Take>
Status SessionReader::State::each_block(std::size_t stream, std::int64_t begin, std::int64_t end, const Take& take) const {
  const std::vector<SessionColumn>& columns = streams[stream].columns;
  Statement select(database.get(), schema == 1 ? "SELECT data FROM ticks" + ending_of(streams[stream].name) + " WHERE first_row = ?1"
                                               : "SELECT data FROM blocks WHERE first_row = ?1 AND stream = ?2");
  const auto last_row_below = [](const BlockPlace& block, std::int64_t row) { return block.first_row + block.rows <= row; };
  auto block = std::lower_bound(blocks[stream].begin(), blocks[stream].end(), begin, last_row_below);
  for (; block != blocks[stream].end() && block->first_row < end; ++block) {
    select.reset();
    select.bind(1, block->first_row);
    if (schema > 1) select.bind(2, static_cast<std::int64_t>(stream));
    if (select.step() != SQLITE_ROW) return damaged();
    const std::string data = select.bytes(0);
    const auto values = schema == 1 ? decode_plain_rows(data, columns.size(), block->rows) : decode_rows(data, columns, block->rows);
    if (!values)
      return damaged(values.error().message + " (stream " + streams[stream].name + ", row " + std::to_string(block->first_row) + ")");
    take(block->first_row, block->rows, *values);
  }
  return {};
}

Result<std::vector<double>> SessionReader::rows(const std::string& stream, std::int64_t first, std::int64_t count) const {
  const auto at = state_->find(stream);
  if (!at) return bad_input("the session has no stream " + stream, state_->path);
  const std::int64_t begin = std::clamp<std::int64_t>(first, 0, state_->row_count(*at));
  const std::int64_t end = begin + std::clamp<std::int64_t>(count, 0, state_->row_count(*at) - begin);
  const auto width = static_cast<std::int64_t>(state_->streams[*at].columns.size());
  std::vector<double> out;
  const Status read =
      state_->each_block(*at, begin, end, [&](std::int64_t first_row, std::int64_t rows, const std::vector<double>& values) {
        const std::int64_t from = std::max<std::int64_t>(begin - first_row, 0), to = std::min(end - first_row, rows);
        out.insert(out.end(), values.begin() + from * width, values.begin() + to * width);
      });
  if (!read) return read.error();
  return out;
}

Result<std::vector<double>> SessionReader::column(const std::string& stream, const std::string& name) const {
  const auto at = state_->find(stream);
  if (!at) return bad_input("the session has no stream " + stream, state_->path);
  const std::vector<SessionColumn>& columns = state_->streams[*at].columns;
  const auto found = std::ranges::find(columns, name, &SessionColumn::name);
  if (found == columns.end()) return bad_input("the session has no column " + name + " of stream " + stream, state_->path);
  std::vector<double> out;
  const Status read =
      state_->each_block(*at, 0, state_->row_count(*at), [&](std::int64_t, std::int64_t, const std::vector<double>& values) {
        for (auto n = static_cast<std::size_t>(found - columns.begin()); n < values.size(); n += columns.size()) out.push_back(values[n]);
      });
  if (!read) return read.error();
  return out;
}

}  // namespace burrhole
