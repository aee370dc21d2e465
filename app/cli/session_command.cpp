#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/recorded_scene.h"
#include "app/report/csv.h"
#include "app/session/session.h"
#include "core/config/toml_messages.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string session, stream = kContactStream;
  bool csv = false;
};

/// @returns the name of a column with its unit, as names in summary.json have it: "tool_x_m", "hand_vx_m_per_s".
std::string header_of(const SessionColumn& column) {
  if (column.unit.empty()) return column.name;
  std::string unit;
  for (const char c : column.unit) unit += c == '/' ? std::string("_per_") : std::string(1, c == ' ' ? '_' : c);
  return column.name + "_" + unit;
}

Result<double> servo_hz_of(const SessionReader& session) {
  const auto scene = TomlDocument::parse(session.meta().scene, session.meta().scene_path);
  if (!scene) return scene.error();
  Issues unread;
  return static_cast<double>(scene->root(unread).integer("servo_hz", 1000, 1, 1'000'000, ""));
}

/// One row a step; the first column is the time where the stream has the tick of the hand's motion.
Result<std::string> stream_csv(const SessionReader& session, const SessionStream& stream) {
  const auto servo_hz = servo_hz_of(session);
  if (!servo_hz) return servo_hz.error();
  const auto values = session.rows(stream.name);
  if (!values) return values.error();
  const std::size_t width = stream.columns.size();
  const auto tick = static_cast<std::size_t>(std::ranges::find(stream.columns, "hand_tick", &SessionColumn::name) - stream.columns.begin());
  std::vector<std::string> names;
  if (tick < width) names.emplace_back("time_s");
  for (const SessionColumn& column : stream.columns) names.push_back(header_of(column));
  CsvTable table(names);
  std::vector<CsvCell> cells;
  for (std::size_t row = 0; row < values->size() / width; ++row) {
    cells.clear();
    if (tick < width) cells.emplace_back((*values)[row * width + tick] / *servo_hz);
    for (std::size_t c = 0; c < width; ++c) cells.emplace_back((*values)[row * width + c]);
    table.add_row(cells);
  }
  return table.text();
}

std::string events_csv(const SessionReader& session) {
  CsvTable table({"time_s", "tick", "kind", "text"});
  for (const SessionEvent& event : session.events()) table.add_row({event.time_s, event.tick, event.kind, event.text});
  return table.text();
}

std::string inputs_csv(const SessionReader& session) {
  CsvTable table({"tick", "kind", "value", "text"});
  for (const SessionInput& input : session.inputs()) table.add_row({input.tick, input.kind, input.value, input.text});
  return table.text();
}

std::string overview(const SessionReader& session) {
  const SessionMeta& meta = session.meta();
  const auto word = [](const std::string& text) { return one_line(text, 500); };  // of the file: a line feed would make a line of its own
  std::string out = fmt::format("program    burrhole {}\ncreated    {}\nscene      {}\nmachine    {}\nschema     {}\n", word(meta.program),
                                word(meta.created), word(fs::path(meta.scene_path).filename().string()), word(meta.cpu), session.schema());
  for (const SessionStream& stream : session.streams()) {
    out += fmt::format("stream     {:<8} {} rows of", word(stream.name), session.row_count(stream.name));
    for (const SessionColumn& column : stream.columns) out += " " + word(header_of(column));
    out += "\n";
  }
  for (const SessionInput& input : session.inputs())
    out += fmt::format("input      tick {:<7} {} {}{}{}\n", input.tick, word(input.kind), input.value, input.text.empty() ? "" : " ",
                       word(input.text));
  for (const SessionEvent& event : session.events())
    out += fmt::format("event      {:8.3f} s  {}{}{}\n", event.time_s, word(event.kind), event.text.empty() ? "" : ": ",
                       word(event.kind == "restore" || event.kind == "markups" ? fs::path(event.text).filename().string() : event.text));
  for (const SessionHash& hash : session.hashes()) out += fmt::format("hash       {:<8} {}\n", word(hash.kind), word(hash.value));
  return out;
}

Result<std::string> csv_of(const SessionReader& session, const std::string& name) {
  if (name == "events") return events_csv(session);
  if (name == "inputs") return inputs_csv(session);
  if (const SessionStream* stream = session.stream(name)) return stream_csv(session, *stream);
  std::vector<std::string> known{"events", "inputs"};
  for (const SessionStream& stream : session.streams()) known.push_back(stream.name);
  const auto near = nearest_name(name, known);
  return bad_input(fmt::format("the session has no stream \"{}\"{}; it has {}", name, near ? "; did you mean \"" + *near + "\"?" : "",
                               fmt::join(known, ", ")));
}

int run_session(const Options& option) {
  const auto path = session_of(option.session);
  if (!path) return report(path.error());
  const auto session = SessionReader::open(*path);
  if (!session) return report(session.error());
  const auto text = option.csv ? csv_of(*session, option.stream) : Result<std::string>(overview(*session));
  if (!text) return report(Error{text.error().code, text.error().message, *path});
  print(*text);
  return kDone;
}

}  // namespace

void add_session(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "session", kDrillGroup,
      {.summary = "Describes a recorded session, or prints its rows as CSV",
       .about = "Prints what a session holds: its origin, its streams of rows with their columns, inputs, events and hashes. With --csv, "
                "prints the rows of one stream on stdout, one line a step, with units in the names of the columns; docs/session.md "
                "describes the file and reads it in Python.",
       .examples = {"burrhole session out", "burrhole session out/session.sqlite --csv > contact.csv",
                    "burrhole session out --csv --stream servo | head"},
       .exits = {}});
  auto option = std::make_shared<Options>();
  command->add_option("session", option->session, "session file, or folder of results")->type_name(kFileValue)->required();
  CLI::Option* csv = command->add_flag("--csv", option->csv, "print the rows of a stream as CSV");
  command->add_option("--stream", option->stream, "with --csv: servo, contact, bone, audio, events or inputs")
      ->type_name("STREAM")
      ->needs(csv)
      ->capture_default_str();
  command->callback([option, &exit_code] { exit_code = run_session(*option); });
}

}  // namespace burrhole::cli
