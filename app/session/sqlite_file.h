/// app/session/sqlite_file.h: the wrapper round SQLite for session files: connections, statements, pragmas. Included by app/session alone.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace burrhole::sqlite_wrapper {

struct CloseDatabase {
  std::unique_ptr<std::int64_t> steps_left = nullptr;  ///< counted by a file that is opened for reading
  void operator()(sqlite3* database) const noexcept { sqlite3_close(database); }
};
struct EndStatement {
  void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

/// A prepared statement. Parameters count from 1, columns from 0, as in SQLite. If the SQL text does not compile, each step() fails.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql);
  void bind(int index, double value) { sqlite3_bind_double(statement_.get(), index, value); }
  void bind(int index, std::int64_t value) { sqlite3_bind_int64(statement_.get(), index, value); }
  void bind(int index, const std::string& text);
  void bind_blob(int index, const std::string& bytes);
  /// @returns SQLITE_ROW, SQLITE_DONE or an error code.
  int step() { return statement_ ? sqlite3_step(statement_.get()) : SQLITE_ERROR; }
  /// Runs a statement without results and makes it ready for the next. @returns whether it succeeded.
  bool run();
  void reset() { sqlite3_reset(statement_.get()); }
  [[nodiscard]] std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  [[nodiscard]] double real(int column) const { return sqlite3_column_double(statement_.get(), column); }
  [[nodiscard]] std::string bytes(int column) const;

 private:
  std::unique_ptr<sqlite3_stmt, EndStatement> statement_;
};

/// @returns whether all statements of `sql` succeeded.
[[nodiscard]] bool execute(sqlite3* database, const std::string& sql);

/// @returns the integer that a pragma answers, or nothing if it fails.
[[nodiscard]] std::optional<std::int64_t> pragma(sqlite3* database, const char* sql);

/// Opens a file that may come from anywhere, for reading alone: SQLite's settings for files that are not trusted, and a bound of the steps of
/// all statements together, after which each fails with SQLITE_INTERRUPT. Where no WAL remains it is opened as immutable, so that SQLite
/// makes no files beside it and plays no journal back; a WAL has committed rows and is read, and stays.
/// @returns null without memory; otherwise a connection whose first statement reports what is wrong with the file.
[[nodiscard]] Database open_existing(const std::string& path);

}  // namespace burrhole::sqlite_wrapper
