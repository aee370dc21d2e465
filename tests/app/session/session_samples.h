// Sessions for tests: a meta with every field, rows whose values can be computed again, and readers that fail the test.
#pragma once

#include <doctest/doctest.h>
#include <sqlite3.h>

#include <bit>
#include <limits>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "core/base/random.h"

namespace burrhole::test {

inline const SessionMeta kMeta{.program = "burrhole 0.1.0",
                               .scene_path = "app/scenes/parietal.toml",
                               .scene = "title = \"Überprüfung\"\n",
                               .tool = "name = 'x'\n",
                               .seed = std::numeric_limits<std::uint64_t>::max(),
                               .created = "2026-01-02T03:04:05Z",
                               .physics_version = 17,
                               .cpu = "a CPU",
                               .renderer = "llvmpipe (LLVM 15.0.6, 256 bits)"};
inline const SessionStream kServo = {"servo", {{"time", "s"}, {"force", "N"}, {"depth", "m"}}};
inline const SessionStream kContact = {"contact", {{"tick", ""}, {"force", "N"}}};
inline const SessionStream kBone = {"bone", {{"mass", "m^3"}}};

inline SessionLayout servo_only(std::int64_t rows_per_second) { return {{kServo}, rows_per_second, 1}; }

inline SessionWriter make_writer(const std::string& path, std::int64_t rows_per_second = 100) {
  Result<SessionWriter> writer = SessionWriter::create(path, kMeta, servo_only(rows_per_second));
  REQUIRE_MESSAGE(writer.ok(), (writer ? "" : writer.error().text()));
  return std::move(*writer);
}

inline SessionReader open_reader(const std::string& path) {
  Result<SessionReader> reader = SessionReader::open(path);
  REQUIRE_MESSAGE(reader.ok(), (reader ? "" : reader.error().text()));
  return std::move(*reader);
}

/// @returns why `path` was refused; fails the test if it was not, or not as bad input that names the file.
inline std::string refusal(const std::string& path) {
  const Result<SessionReader> reader = SessionReader::open(path);
  REQUIRE_FALSE(reader.ok());
  CHECK(reader.error().code == ErrorCode::bad_input);
  CHECK(reader.error().place.find(path) != std::string::npos);
  return reader.error().text();
}

/// Row i of a run whose values can be made again: any bits, NaN with payloads included, as a double.
inline std::vector<double> any_bits(std::uint64_t i) {
  return {std::bit_cast<double>(mix64(3 * i)), std::bit_cast<double>(mix64(3 * i + 1)), std::bit_cast<double>(mix64(3 * i + 2))};
}

inline bool same_bits(const double* a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < b.size(); ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return true;
}

inline void run_sql(const std::string& path, const char* sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  CHECK(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
}

}  // namespace burrhole::test
