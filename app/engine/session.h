/// app/engine/session.h: a recorded run in one SQLite file: what was asked, what each tick took and gave, what happened. SQLite stays in
/// session.cpp. Layout (schema 1), in WAL mode, application id "burr", user_version = schema:
///   meta(key, value)                            program, scene_path, scene, tool, seed, created
///   columns(position, name, unit)               of a row
///   ticks(first_row, rows, data)                blocks of rows: little-endian IEEE 754 doubles, row after row
///   columns_NAME, ticks_NAME                    the same of a further stream of rows, where there is one (steps that ran at their own
///   pace) events(id, time_s, tick, kind, text, data)  in order of id
///   hashes(kind, value)
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

inline constexpr int kSessionSchema = 1;

/// What a run was made from; enough to make it again. Texts are whole files, not paths.
struct SessionMeta {
  std::string program;  ///< version of the program that wrote it
  std::string scene_path;
  std::string scene;  ///< TOML with overrides applied
  std::string tool;   ///< TOML
  std::uint64_t seed = 0;
  std::string created;  ///< ISO 8601, given by the caller
  friend bool operator==(const SessionMeta&, const SessionMeta&) = default;
};

struct SessionColumn {
  std::string name;
  std::string unit;
  friend bool operator==(const SessionColumn&, const SessionColumn&) = default;
};

/// Rows of their own beside the ticks.
struct SessionStream {
  std::string name;  ///< letters and underscores
  std::vector<SessionColumn> columns;
};

struct SessionEvent {
  double time_s = 0.0;  ///< finite
  std::int64_t tick = 0;
  std::string kind;
  std::string text;
  std::string data;  ///< bytes, meaning by kind
  friend bool operator==(const SessionEvent&, const SessionEvent&) = default;
};

struct SessionHash {
  std::string kind;
  std::string value;
  friend bool operator==(const SessionHash&, const SessionHash&) = default;
};

/// Writes one session. Valid at every commit; commits after each `rows_per_second` rows, after the first row, and at close, so a process
/// killed at any moment loses at most the last second of recorded time. (A power cut may lose what the system had not yet put on the disk.)
/// Allocates and waits for files: never on the servo path. One owner. Faults are bad_input with the path.
class SessionWriter {
 public:
  /// Replaces an older session at `path`; refuses any other file there. Makes the folder.
  /// @param rows_per_second > 0, the recorded rate [Hz]. @param columns at least one.
  [[nodiscard]] static Result<SessionWriter> create(const std::string& path, const SessionMeta& meta,
                                                    const std::vector<SessionColumn>& columns, std::int64_t rows_per_second,
                                                    const std::vector<SessionStream>& streams = {});
  SessionWriter(SessionWriter&&) noexcept;
  SessionWriter& operator=(SessionWriter&&) noexcept;
  ~SessionWriter();  ///< closes; a fault then goes unheard, so call close() first

  /// One value a column, kept bit by bit.
  [[nodiscard]] Status append(std::span<const double> row);
  /// To a further stream, by its place in the list given to create(); made permanent with the ticks.
  [[nodiscard]] Status append_to(std::size_t stream, std::span<const double> row);
  [[nodiscard]] Status event(const SessionEvent& event);
  /// A later value of the same kind replaces the earlier one.
  [[nodiscard]] Status hash(const SessionHash& hash);
  /// Commits everything. Calls after the first do nothing.
  [[nodiscard]] Status close();

 private:
  struct State;
  explicit SessionWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Reads a session, also one whose writer was killed or still runs. Faults are bad_input with the path: missing, no SQLite file, not a
/// session of this program, schema newer than kSessionSchema, damaged.
class SessionReader {
 public:
  [[nodiscard]] static Result<SessionReader> open(const std::string& path);
  SessionReader(SessionReader&&) noexcept;
  SessionReader& operator=(SessionReader&&) noexcept;
  ~SessionReader();

  [[nodiscard]] const SessionMeta& meta() const noexcept;
  [[nodiscard]] const std::vector<SessionColumn>& columns() const noexcept;
  [[nodiscard]] const std::vector<SessionEvent>& events() const noexcept;
  [[nodiscard]] const std::vector<SessionHash>& hashes() const noexcept;
  [[nodiscard]] std::int64_t row_count() const noexcept;
  /// The columns of a further stream; nothing when there is none of that name.
  [[nodiscard]] const SessionStream* stream(const std::string& name) const noexcept;
  /// All its rows, as rows() gives them.
  [[nodiscard]] Result<std::vector<double>> stream_rows(const std::string& name) const;
  /// Rows [first, first + count), cut to those there are. @returns their values row after row: size() == rows * columns().size().
  [[nodiscard]] Result<std::vector<double>> rows(std::int64_t first, std::int64_t count) const;

 private:
  struct State;
  explicit SessionReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace burrhole
