/// app/session/session.h: a recorded run in one SQLite file: scene and tool, every input, inputs and results of each step, events.
/// A replay can run the same steps again in the same order. SQLite is accessed through sqlite_file.h only.
///
/// Schema 2, in WAL mode while it is written and a single file once closed, application id "burr", user_version = schema:
///   meta(key, value)                            schema, physics_version, program, scene_path, scene, tool, seed, created, cpu, renderer
///   streams(position, name)                     of rows: "servo" has one row a servo tick; "contact" and "bone" one row a step
///   columns(stream, position, name, unit, keep) of a stream's rows; stream = streams.position; keep is "exact" or "coarse"
///   blocks(stream, first_row, rows, data)       consecutive rows of a stream, about a second each (row_codec.h)
///   inputs(id, tick, kind, value, text, data)   what a person changed while drilling, in order; id counts from 1
///   parks(input, stream, rows)                  of an input that parked the clocks: rows of each stream before it
///   events(id, time_s, tick, kind, text, data)  what happened, in order of id
///   stills(id, bone_step, name, hash, view, parks)   pictures, drawn after that number of bone steps and of parks, with all texels
///   hashes(kind, value)                         of the run's results
///   ends(name, rows)                            written by close(): rows of each stream, and of "inputs"
/// A park is a stop of all clocks between two steps, during which an input is applied that changes the tool or reads or replaces bone: tool
/// change, undo, reset, checkpoint, restore.
/// Schema 1 is read as well: one stream named "servo" (of a live run also "contact" and "bone"), rows of plain doubles, no inputs or
/// stills.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

inline constexpr int kSessionSchema = 2;

/// Origin of a run, sufficient to repeat it. Texts are contents of files, not paths.
struct SessionMeta {
  std::string program;  ///< version of the program that wrote it
  std::string scene_path;
  std::string scene;  ///< TOML with overrides applied
  std::string tool;   ///< TOML
  std::uint64_t seed = 0;
  std::string created;               ///< ISO 8601, given by the caller
  std::int64_t physics_version = 0;  ///< equal versions give equal hashes; 0: not recorded (schema 1)
  std::string cpu{};                 ///< with `renderer`: where equal stills are to be expected
  std::string renderer{};            ///< GL renderer, with the LLVM version of a software renderer
  friend bool operator==(const SessionMeta&, const SessionMeta&) = default;
};

/// How the values of a column are kept.
enum class Keep : std::uint8_t {
  exact,  ///< every bit of every row: what a replay needs
  coarse  ///< rounded to float, every SessionLayout::coarse_every-th row: what a replay computes again
};

struct SessionColumn {
  std::string name;
  std::string unit;
  Keep keep = Keep::exact;
  friend bool operator==(const SessionColumn&, const SessionColumn&) = default;
};

struct SessionStream {
  std::string name;  ///< lower-case letters and underscores
  std::vector<SessionColumn> columns;
  friend bool operator==(const SessionStream&, const SessionStream&) = default;
};

/// Names of the streams of a run; "servo" is the first of a layout.
inline constexpr const char* kServoStream = "servo";
inline constexpr const char* kContactStream = "contact";
inline constexpr const char* kBoneStream = "bone";
inline constexpr const char* kAudioStream = "audio";  ///< only of a run with sound

struct SessionLayout {
  std::vector<SessionStream> streams;   ///< at least one, with at least one column each; the first sets the pace of commits
  std::int64_t rows_per_second = 1000;  ///< > 0, of the first stream [Hz]
  std::int64_t coarse_every = 1;        ///< [samples] > 0, rows from one stored value of a coarse column to the next
};

/// Input of a user during the run: spin command, switch, tool change, undo, reset, checkpoint, mark. Applied before servo tick `tick`.
struct SessionInput {
  std::int64_t tick = 0;  ///< [ticks] of the servo; not below that of the previous input
  std::string kind;
  double value = 0.0;  ///< [-] finite; meaning depends on kind
  std::string text;    ///< of a tool change: the tool's name
  std::string data;    ///< of a tool change: the tool file's text
  /// For an input that parked the clocks: number of rows of each stream before it, in the layout's order. Otherwise empty.
  std::vector<std::int64_t> rows_before;
  friend bool operator==(const SessionInput&, const SessionInput&) = default;
};

struct SessionEvent {
  double time_s = 0.0;    ///< finite
  std::int64_t tick = 0;  ///< [ticks] of the servo
  std::string kind;
  std::string text;
  std::string data;  ///< bytes, meaning depends on kind
  friend bool operator==(const SessionEvent&, const SessionEvent&) = default;
};

struct SessionStill {
  std::int64_t bone_step = 0;  ///< [steps] rows of stream "bone" before the picture
  std::string name;
  std::string hash;
  std::string view{};  ///< bytes, written by the display: sufficient to draw the picture again
  /// Number of parks before it; counted by the writer. With bone_step it determines the state of bone, since an undo changes bone between
  /// two bone steps.
  std::int64_t parks = 0;
  friend bool operator==(const SessionStill&, const SessionStill&) = default;
};

struct SessionHash {
  std::string kind;
  std::string value;
  friend bool operator==(const SessionHash&, const SessionHash&) = default;
};

/// @returns whether a file is a session of this program, or empty.
[[nodiscard]] bool is_session_file(const std::string& path);

/// Writes one session. Valid at every commit; commits after each `rows_per_second` rows of the first stream, after its first row, and at
/// close, so a process killed at any moment loses at most the last second of recorded time. (A power cut may lose what the system had not
/// yet put on the disk.) Allocates and waits for files: never on the servo path. One owner. Errors are bad_input with the path.
class SessionWriter {
 public:
  /// Replaces an older session at `path`; refuses any other file there. Makes the folder.
  [[nodiscard]] static Result<SessionWriter> create(const std::string& path, const SessionMeta& meta, const SessionLayout& layout);
  SessionWriter(SessionWriter&&) noexcept;
  SessionWriter& operator=(SessionWriter&&) noexcept;
  ~SessionWriter();  ///< closes; an error is then lost, so call close() first

  /// One row. @param stream its place in the layout. @param row one value a column.
  [[nodiscard]] Status append(std::size_t stream, std::span<const double> row);
  /// @returns rows appended to each stream so far, in the layout's order.
  [[nodiscard]] std::vector<std::int64_t> rows() const;
  /// bad_input when the value is not finite, the tick is below that of the input before, or `rows_before` names another number of streams.
  [[nodiscard]] Status input(const SessionInput& input);
  [[nodiscard]] Status event(const SessionEvent& event);
  /// `parks` of `still` is not read.
  [[nodiscard]] Status still(const SessionStill& still);
  /// A later value of the same kind replaces the earlier one.
  [[nodiscard]] Status hash(const SessionHash& hash);
  /// Commits everything. Calls after the first do nothing.
  [[nodiscard]] Status close();

 private:
  struct State;
  explicit SessionWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Reads a session, also one whose writer was killed or still runs. Errors are bad_input with the path: missing, no SQLite file, not a
/// session of this program, schema newer than kSessionSchema, damaged (rows or inputs that are missing included).
class SessionReader {
 public:
  [[nodiscard]] static Result<SessionReader> open(const std::string& path);
  SessionReader(SessionReader&&) noexcept;
  SessionReader& operator=(SessionReader&&) noexcept;
  ~SessionReader();

  [[nodiscard]] int schema() const noexcept;
  [[nodiscard]] const SessionMeta& meta() const noexcept;
  [[nodiscard]] const std::vector<SessionStream>& streams() const noexcept;
  [[nodiscard]] const std::vector<SessionInput>& inputs() const noexcept;
  [[nodiscard]] const std::vector<SessionEvent>& events() const noexcept;
  [[nodiscard]] const std::vector<SessionStill>& stills() const noexcept;
  [[nodiscard]] const std::vector<SessionHash>& hashes() const noexcept;

  /// @returns the stream of that name, null when there is none.
  [[nodiscard]] const SessionStream* stream(const std::string& name) const noexcept;
  /// @returns how many rows it has; 0 when there is no such stream.
  [[nodiscard]] std::int64_t row_count(const std::string& stream) const noexcept;
  /// Rows [first, first + count) of a stream, clipped to those that exist. Rows of a coarse column that were not kept have the value of the
  /// last kept one. @returns their values row after row: size() == rows * columns. bad_input when there is no such stream.
  [[nodiscard]] Result<std::vector<double>> rows(const std::string& stream, std::int64_t first = 0,
                                                 std::int64_t count = std::numeric_limits<std::int64_t>::max()) const;
  /// One column of all rows; bad_input when there is no such stream or column.
  [[nodiscard]] Result<std::vector<double>> column(const std::string& stream, const std::string& name) const;

 private:
  struct State;
  explicit SessionReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace burrhole
