#include "app/session/sqlite_file.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace burrhole::sqlite_wrapper {

Statement::Statement(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
  statement_.reset(statement);
}

void Statement::bind(int index, const std::string& text) {
  sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
}

void Statement::bind_blob(int index, const std::string& bytes) {
  // A null pointer would bind NULL, and data() of an empty string may be null.
  sqlite3_bind_blob64(statement_.get(), index, bytes.empty() ? "" : bytes.data(), bytes.size(), SQLITE_TRANSIENT);
}

bool Statement::run() {
  const bool done = step() == SQLITE_DONE;
  sqlite3_reset(statement_.get());
  return done;
}

std::string Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  if (data == nullptr) return {};
  return {static_cast<const char*>(data), static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

bool execute(sqlite3* database, const std::string& sql) {
  return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

std::optional<std::int64_t> pragma(sqlite3* database, const char* sql) {
  Statement statement(database, sql);
  if (statement.step() != SQLITE_ROW) return std::nullopt;
  return statement.integer(0);
}

namespace {

constexpr int kStepsAtOnce = 100'000;             // of SQLite's virtual machine, between two calls of on_steps()
constexpr std::int64_t kMostSteps = 300'000'000;  // some seconds; a session of an hour takes less than a hundredth of them

/// @returns the path as a URI of SQLite.
std::string uri_of(const std::string& path) {
  std::string uri = path.starts_with('/') ? "file://" : "file:";  // "file:" and "//folder" would name a machine
  for (const char c : path) {
    constexpr std::string_view kReserved = "%?#";
    constexpr const char* kEscapes[] = {"%25", "%3f", "%23"};
    const std::size_t at = kReserved.find(c);
    uri += at == std::string_view::npos ? std::string(1, c) : kEscapes[at];
  }
  return uri;
}

/// @returns not 0 to end the statement.
int on_steps(void* left) {
  auto& calls = *static_cast<std::int64_t*>(left);
  return --calls < 0 ? 1 : 0;
}

/// SQLite's advice for files from elsewhere (sqlite.org/security.html): no writing of the schema, no functions, views or triggers by the
/// schema, small limits.
void distrust(sqlite3* database) {
  for (const auto& [option, value] : {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1}, std::pair{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                      std::pair{SQLITE_DBCONFIG_ENABLE_VIEW, 0}, std::pair{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}})
    sqlite3_db_config(database, option, value, nullptr);
  for (const auto& [limit, value] :
       {std::pair{SQLITE_LIMIT_SQL_LENGTH, 10'000}, std::pair{SQLITE_LIMIT_COLUMN, 50}, std::pair{SQLITE_LIMIT_EXPR_DEPTH, 10},
        std::pair{SQLITE_LIMIT_COMPOUND_SELECT, 3}, std::pair{SQLITE_LIMIT_VDBE_OP, 25'000}, std::pair{SQLITE_LIMIT_FUNCTION_ARG, 8},
        std::pair{SQLITE_LIMIT_ATTACHED, 0}, std::pair{SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 50}, std::pair{SQLITE_LIMIT_VARIABLE_NUMBER, 10},
        std::pair{SQLITE_LIMIT_TRIGGER_DEPTH, 1}, std::pair{SQLITE_LIMIT_WORKER_THREADS, 0}})
    sqlite3_limit(database, limit, value);
}

}  // namespace

Database open_existing(const std::string& named) {
  std::error_code ignored;
  // SQLite names the WAL after the file that a link leads to.
  const std::filesystem::path real = std::filesystem::canonical(named, ignored);
  const std::string path = real.empty() ? named : real.string();
  const auto size_of = [&](const std::string& file) {
    const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
    return ignored ? 0 : bytes;
  };
  const std::string uri = uri_of(path) + (size_of(path + "-wal") > 0 ? "" : "?immutable=1");
  sqlite3* raw = nullptr;
  sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  if (raw == nullptr) return {};
  auto left = std::make_unique<std::int64_t>((kMostSteps + static_cast<std::int64_t>(size_of(path))) / kStepsAtOnce);
  Database database(raw, CloseDatabase{std::move(left)});
  distrust(raw);
  sqlite3_progress_handler(raw, kStepsAtOnce, on_steps, database.get_deleter().steps_left.get());
  return database;
}

}  // namespace burrhole::sqlite_wrapper
