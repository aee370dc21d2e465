/// app/session/session_format.h: definitions shared by writer and reader of session files: application id, SQL of schema 2, fields of meta.
///   Private to app/session.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/session/session.h"

namespace burrhole::session_format {

inline constexpr int kApplicationId = 0x62757272;  // "burr"

inline constexpr const char* kSchemaSql =
    "CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE streams(position INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);"
    "CREATE TABLE columns(stream INTEGER NOT NULL, position INTEGER NOT NULL, name TEXT NOT NULL, unit TEXT NOT NULL, keep TEXT NOT NULL,"
    " PRIMARY KEY(stream, position));"
    "CREATE TABLE blocks(stream INTEGER NOT NULL, first_row INTEGER NOT NULL, rows INTEGER NOT NULL, data BLOB NOT NULL,"
    " PRIMARY KEY(stream, first_row));"
    "CREATE TABLE inputs(id INTEGER PRIMARY KEY, tick INTEGER NOT NULL, kind TEXT NOT NULL, value REAL NOT NULL, text TEXT NOT NULL,"
    " data BLOB NOT NULL);"
    "CREATE TABLE parks(input INTEGER NOT NULL, stream INTEGER NOT NULL, rows INTEGER NOT NULL, PRIMARY KEY(input, stream));"
    "CREATE TABLE events(id INTEGER PRIMARY KEY, time_s REAL NOT NULL, tick INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL,"
    " data BLOB NOT NULL);"
    "CREATE TABLE stills(id INTEGER PRIMARY KEY, bone_step INTEGER NOT NULL, name TEXT NOT NULL, hash TEXT NOT NULL, view BLOB NOT NULL,"
    " parks INTEGER NOT NULL);"
    "CREATE TABLE hashes(kind TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE ends(name TEXT PRIMARY KEY, rows INTEGER NOT NULL);";

/// Name of the inputs in table ends.
inline constexpr const char* kInputsEnd = "inputs";

/// The texts of meta and their fields. `seed` and `physics_version` are kept as decimal text beside them: SQLite's integers are signed.
[[nodiscard]] inline std::vector<std::pair<const char*, std::string SessionMeta::*>> meta_texts() {
  return {{"program", &SessionMeta::program},  {"scene_path", &SessionMeta::scene_path}, {"scene", &SessionMeta::scene},
          {"tool", &SessionMeta::tool},        {"created", &SessionMeta::created},       {"cpu", &SessionMeta::cpu},
          {"renderer", &SessionMeta::renderer}};
}

[[nodiscard]] inline const char* name_of(Keep keep) noexcept { return keep == Keep::exact ? "exact" : "coarse"; }

}  // namespace burrhole::session_format
