#include "app/session/sqlite_file.h"

#include <filesystem>
#include <string_view>

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

}  // namespace burrhole::sqlite_wrapper
