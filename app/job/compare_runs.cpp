#include "app/job/compare_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"
#include "app/session/session.h"
#include "app/stage/result_files.h"
#include "core/base/geometry.h"
#include "core/config/toml.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kCompareSchema = 1;

constexpr FileLimit kSummaryInput{"a summary.json", 4u << 20, false};
// Members of an ordered object are searched one by one when it is parsed, and the names of one run among those of the others, so time grows
// by the square of these numbers. What is longer is refused before it is parsed.
constexpr std::size_t kMostNested = 16;
constexpr std::size_t kMostMembers = 1000;    // of one object
constexpr std::size_t kMostElements = 10000;  // of one list: overrides, for example

/// @returns whether a JSON text has no more nested, members and elements than a summary.json can have. Lists and objects are printed by
/// recursion. A text that is no JSON may be within bounds.
bool is_within_bounds(std::string_view text) {
  std::array<std::size_t, kMostNested> left{};  // at each depth: the elements that may still begin
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char c = text[n];
    if (quoted && c == '\\') {
      ++n;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (quoted) {
      continue;
    } else if (c == '[' || c == '{') {
      if (depth == kMostNested) return false;
      left[depth++] = c == '{' ? kMostMembers : kMostElements;
    } else if (c == ',' && depth > 0) {
      if (--left[depth - 1] == 0) return false;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return true;
}

/// @returns the object of that name; an empty one if there is none.
Json object_of(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_object() ? *found : Json::object();
}

std::string text_of(const Json& value) {
  if (value.is_null()) return {};
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  for (const Json& one : value) out += (out.empty() ? "" : ", ") + text_of(one);
  return out.empty() ? "none" : out;
}

void add_facts(const Json& json, RunResults& out) {
  const auto add = [&](const char* name, const Json& value) { out.facts.emplace_back(name, text_of(value)); };
  for (const char* key : {"title", "scene", "result", "reason", "flags"}) add(key, json.value(key, Json()));
  const Json made = json.value("provenance", Json());
  if (!made.is_object()) return;
  for (const char* key : {"program", "date", "machine", "overrides", "tool_overrides", "drilled_before"}) add(key, made.value(key, Json()));
  const Json factors = object_of(made, "erosion_factors_per_rev"), hashes = object_of(made, "hash");
  for (const auto& [region, factor] : factors.items()) add(("erosion factor of the " + region).c_str(), factor);
  for (const auto& [of, hash] : hashes.items()) add(("hash of the " + of).c_str(), hash);
}

void add_volume(const Json& json, RunResults& out) {
  const Json volume = object_of(json, "volume");
  out.volume_format = text_of(volume.value("format", Json()));
  if (const Json spacing = volume.value("spacing_mm", Json()); spacing.is_number()) out.spacing_mm = spacing.get<double>();
}

void add_figures(const Json& json, RunResults& out) {
  const Json drilling = object_of(json, "drilling");
  for (const auto& [key, value] : drilling.items())
    if (value.is_number())
      out.figures.emplace_back(key, value.get<double>());
    else if (value.is_null())
      out.figures.emplace_back(key, std::nullopt);
    else if (value.is_boolean())
      out.facts.emplace_back(key, text_of(value));
  // The mean from the start of the run, its approach included: summary.json has no time of the contact.
  if (const Json depth = drilling.value("depth_mm", Json()), time = drilling.value("breakthrough_s", Json());
      depth.is_number() && time.is_number() && time.get<double>() > 0.0)
    out.figures.emplace_back("feed_mm_per_s", depth.get<double>() / time.get<double>());
  else
    out.figures.emplace_back("feed_mm_per_s", std::nullopt);
  for (const char* key : {"duration_s", "wall_s"})
    if (const Json value = json.value(key, Json()); value.is_number()) out.figures.emplace_back(key, value.get<double>());
  const Json hashes = object_of(json, "hash");
  for (const auto& [of, hash] : hashes.items()) out.facts.emplace_back("hash of the " + of + " of the run", text_of(hash));
}

std::string number_of(const std::optional<double>& value) { return value ? fmt::format("{:.5g}", *value) : std::string("-"); }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\"'"), last = text.find_last_not_of(" \t\"'");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

using Texts = std::vector<std::pair<std::string, std::string>>;
constexpr std::string_view kToolKey = "tool file ";    // in front of the keys of the tool's file
constexpr std::string_view kSceneKey = "scene file ";  // in front of keys without a table, as duration_s: figures have such names too

/// Adds changes as summary.json lists them, "table.key=value" or "unset table"; a later value of a key replaces the one before.
void add_overrides(const Json& changes, std::string_view prefix, Texts& out) {
  constexpr std::string_view kUnset = "unset ";
  if (!changes.is_array()) return;
  for (const Json& change : changes) {
    const std::string text = text_of(change);
    const std::size_t equals = text.find('=');
    const bool unset = equals == std::string::npos && text.starts_with(kUnset);
    const std::string_view path = unset ? std::string_view(text).substr(kUnset.size()) : std::string_view(text).substr(0, equals);
    const std::string name(trimmed(path));
    const std::string key = std::string(prefix.empty() && name.find('.') == std::string::npos ? kSceneKey : prefix) + name;
    const std::string value(unset ? "left out" : equals == std::string::npos ? "" : trimmed(std::string_view(text).substr(equals + 1)));
    const auto known = std::ranges::find(out, key, &Texts::value_type::first);
    if (known == out.end())
      out.emplace_back(key, value);
    else
      known->second = value;
  }
}

void add_settings(const Json& json, RunResults& out) {
  const Json made = json.value("provenance", Json()), tool = json.value("tool", Json());
  if (made.is_object()) {
    out.scene_place = text_of(made.value("scene_place", Json()));
    add_overrides(made.value("overrides", Json()), {}, out.overrides);
    add_overrides(made.value("tool_overrides", Json()), kToolKey, out.overrides);
  }
  if (!tool.is_object()) return;
  for (const auto& [key, of] : {std::pair("tool.name", "name"), std::pair("tool.spin_rpm", "spin_rpm"), std::pair("hand.push_N", "push_N")})
    if (const Json value = tool.value(of, Json()); !value.is_null())
      out.used.emplace_back(key, value.is_number() ? number_of(value.get<double>()) : text_of(value));
}

std::optional<Vec3> vector_of(const Json& value) {
  if (!value.is_array() || value.size() != 3) return std::nullopt;
  Vec3 out(0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    if (!value[c].is_number()) return std::nullopt;
    out[c] = value[c].get<double>();
  }
  return out;
}

/// Reads force and depth by time from the session. @returns why there are none; empty: they were read.
Result<std::string> add_curves(const Json& json, RunResults& out) {
  const std::string path = (fs::path(out.folder) / kSessionFile).string();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::string("no session.sqlite");
  const auto session = SessionReader::open(path);
  if (!session) return session.error();
  const auto has = [&](const char* stream, const char* name) {
    const SessionStream* const found = session->stream(stream);
    return found != nullptr && std::ranges::find(found->columns, name, &SessionColumn::name) != found->columns.end();
  };
  if (!has(kServoStream, "sent_x") || !has(kServoStream, "hand_tick")) return std::string("the session has no force");
  const auto scene = TomlDocument::parse(session->meta().scene, path);
  if (!scene) return scene.error();
  Issues unread;
  const auto servo_hz = static_cast<double>(scene->root(unread).integer("servo_hz", 1000, 1, 1'000'000, ""));
  const auto vectors = [&](const char* stream, std::array<const char*, 3> names, std::vector<double>& times) -> Result<std::vector<Vec3>> {
    std::array<std::vector<double>, 4> columns;
    for (std::size_t c = 0; c < 4; ++c) {
      auto read = session->column(stream, c < 3 ? names[c] : "hand_tick");
      if (!read) return read.error();
      columns[c] = std::move(read).value();
    }
    std::vector<Vec3> found;
    for (std::size_t n = 0; n < columns[3].size(); ++n) {
      times.push_back(columns[3][n] / servo_hz);
      found.emplace_back(columns[0][n], columns[1][n], columns[2][n]);
    }
    return found;
  };
  const auto forces = vectors(kServoStream, {"sent_x", "sent_y", "sent_z"}, out.time_s);
  if (!forces) return forces.error();
  for (const Vec3& force : *forces) out.force_N.push_back(glm::length(force));
  const Json approach = object_of(json, "approach");
  const auto entry = vector_of(approach.value("entry_mm", Json())), axis = vector_of(approach.value("axis", Json()));
  if (entry && axis && has(kContactStream, "tool_x")) {
    const auto tips = vectors(kContactStream, {"tool_x", "tool_y", "tool_z"}, out.depth_time_s);
    if (!tips) return tips.error();
    for (const Vec3& tip : *tips) out.depth_mm.push_back(glm::dot(tip * 1e3 - *entry, *axis));
  }
  return out.time_s.empty() ? std::string("the session has no row") : std::string();
}

/// @returns the names that any run has, in the order of the first run that has them.
template <class Value>
std::vector<std::string> names_of(std::span<const RunResults> runs, std::vector<std::pair<std::string, Value>> RunResults::*list) {
  std::vector<std::string> out;
  for (const RunResults& run : runs)
    for (const auto& row : run.*list)
      if (std::ranges::find(out, row.first) == out.end()) out.push_back(row.first);
  return out;
}

template <class Value>
Value value_of(const std::vector<std::pair<std::string, Value>>& list, const std::string& name) {
  for (const auto& [key, value] : list)
    if (key == name) return value;
  return Value();
}

Plot make_plot(std::span<const RunResults> runs) {
  Plot plot;
  plot.x_label = "Time (s)";
  PlotPanel force{.y_label = "Force (N)", .series = {}, .bands = {}, .from_zero = true},
      depth{.y_label = "Depth (mm)", .series = {}, .bands = {}, .y_down = true};
  for (const RunResults& run : runs) {
    if (!run.time_s.empty()) force.series.push_back({run.name, run.time_s, run.force_N});
    if (!run.depth_mm.empty()) depth.series.push_back({run.name, run.depth_time_s, run.depth_mm});
  }
  if (!force.series.empty()) plot.panels.push_back(force);
  if (!depth.series.empty()) plot.panels.push_back(depth);
  return plot;
}

Status add_plot(std::span<const RunResults> runs, const std::string& folder, HtmlPage& page) {
  page.heading("Curves");
  for (const RunResults& run : runs)
    if (!run.no_curves.empty()) page.paragraph(fmt::format("{}: no curves: {}.", run.name, run.no_curves));
  const Plot plot = make_plot(runs);
  if (plot.panels.empty()) return {};
  const auto svg = draw_svg(plot);
  if (!svg && svg.error().code != ErrorCode::unavailable) return svg.error();
  if (!svg) {
    page.paragraph("No plot: " + svg.error().message + ".");
    return {};
  }
  page.svg(*svg, "Force on the hand, and depth of the tip along the axis from the entry.");
  return write_file((fs::path(folder) / "compare.svg").string(), *svg);
}

}  // namespace

Result<RunResults> read_run(const std::string& path) {
  RunResults out;
  out.name = path;
  while (out.name.size() > 1 && out.name.back() == '/') out.name.pop_back();
  std::error_code ignored;
  out.folder = fs::is_directory(path, ignored) ? path : fs::path(path).parent_path().string();
  const std::string file = fs::is_directory(path, ignored) ? (fs::path(path) / kSummaryFile).string() : path;
  if (!fs::exists(file, ignored))
    return bad_input("holds no results: a RUN is a folder that burrhole drill wrote, with summary.json", path);
  const auto text = read_file(file, kSummaryInput);
  if (!text) return text.error();
  const Json json = is_within_bounds(*text) ? Json::parse(*text, nullptr, false) : Json();
  if (!json.is_object() || !json.contains("schema") || !json.contains("drilling"))
    return bad_input("is not a summary.json of burrhole drill, or a damaged one: the run is left out", file);
  add_facts(json, out);
  add_settings(json, out);
  add_volume(json, out);
  add_figures(json, out);
  const auto curves = add_curves(json, out);
  out.no_curves = curves ? *curves : "the session cannot be read: " + curves.error().message;
  out.damaged = !curves;
  for (fs::directory_iterator at(out.folder.empty() ? "." : out.folder, ignored); at != fs::directory_iterator(); at.increment(ignored))
    if (at->path().extension() == ".png") out.pictures.push_back(at->path().stem().string());
  std::ranges::sort(out.pictures);
  return out;
}

bool has_same_bone(const RunResults& a, const RunResults& b) {
  constexpr double kSame = 1e-9;  // [mm]
  const auto hash_of = [](const RunResults& run, const char* of) { return value_of(run.facts, std::string("hash of the ") + of); };
  const std::string one = hash_of(a, "volume"), other = hash_of(b, "volume");
  if (!one.empty() && one == other) return true;
  if (!a.volume_format.empty() && !b.volume_format.empty() && a.volume_format != b.volume_format) return false;
  if (one.empty() || other.empty()) return true;
  const auto set_by = [](const RunResults& run) {  // overrides of the volume, without its spacing
    Texts out;
    for (const auto& change : run.overrides)
      if (change.first.starts_with("volume.") && change.first != "volume.spacing_mm") out.push_back(change);
    std::ranges::sort(out);
    return out;
  };
  const bool resized = a.spacing_mm && b.spacing_mm && std::abs(*a.spacing_mm - *b.spacing_mm) > kSame;
  return resized && !a.scene_place.empty() && a.scene_place == b.scene_place && set_by(a) == set_by(b);
}

namespace {

ComparedRow row_of(std::string name, std::vector<std::string> cells) {
  ComparedRow out;
  out.name = std::move(name);
  out.differs = std::ranges::any_of(cells, [&](const std::string& cell) { return cell != cells.front(); });
  out.cells = std::move(cells);
  return out;
}

/// @returns a row for each key whose value the runs do not share.
std::vector<ComparedRow> setting_rows(std::span<const RunResults> runs) {
  std::vector<std::string> names = names_of(runs, &RunResults::used);
  const std::size_t of_every_run = names.size();
  for (const std::string& name : names_of(runs, &RunResults::overrides))
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  std::vector<ComparedRow> out;
  for (std::size_t n = 0; n < names.size(); ++n) {
    const bool known = n < of_every_run;
    const char* const instead = known ? "-" : names[n].starts_with(kToolKey) ? "tool's" : "scene's";
    std::vector<std::string> cells;
    for (const RunResults& run : runs) {
      const auto& list = known ? run.used : run.overrides;
      const auto found = std::ranges::find(list, names[n], &Texts::value_type::first);
      cells.push_back(found == list.end() ? instead : found->second);
    }
    ComparedRow row = row_of(names[n], std::move(cells));
    row.is_setting = true;
    if (row.differs) out.push_back(std::move(row));
  }
  return out;
}

/// @returns whether a row is one of those that say who made the results, when and how fast.
bool is_of_the_making(const ComparedRow& row) {
  constexpr std::string_view kNames[] = {"program", "machine", "date", "wall_s"};
  return !row.is_setting && (row.name.starts_with("hash of ") || std::ranges::find(kNames, row.name) != std::end(kNames));
}

}  // namespace

std::vector<ComparedRow> compared_rows(std::span<const RunResults> runs) {
  std::vector<ComparedRow> out;
  for (const std::string& name : names_of(runs, &RunResults::facts)) {
    if (name == "overrides" || name == "tool_overrides") continue;  // a row each key: setting_rows()
    std::vector<std::string> cells;
    for (const RunResults& run : runs) cells.push_back(value_of(run.facts, name));
    out.push_back(row_of(name, std::move(cells)));
    if (name == "scene") std::ranges::move(setting_rows(runs), std::back_inserter(out));
  }
  for (const std::string& name : names_of(runs, &RunResults::figures)) {
    std::vector<std::string> cells;
    for (const RunResults& run : runs) cells.push_back(number_of(value_of(run.figures, name)));
    out.push_back(row_of(name, std::move(cells)));
    if (runs.size() != 2) continue;
    if (const auto a = value_of(runs[0].figures, name), b = value_of(runs[1].figures, name); a && b && *a != *b)
      out.back().difference = fmt::format("{:+.4g}", *b - *a);
  }
  std::ranges::stable_partition(out, [](const ComparedRow& row) { return !is_of_the_making(row); });
  return out;
}

namespace {

/// @returns the number of characters of a UTF-8 text: of its bytes that do not continue one.
std::size_t length_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

/// @returns the text as lines of at most `widest` characters, broken at spaces where there are any.
std::vector<std::string> broken(std::string_view text, std::size_t widest) {
  std::vector<std::string> out;
  while (length_of(text) > widest) {
    std::size_t characters = 0, end = 0, space = 0;
    for (; end < text.size(); ++end) {
      const bool begins = (static_cast<unsigned char>(text[end]) & 0xc0u) != 0x80u;
      if (begins && characters++ == widest) break;
      if (text[end] == ' ') space = end;
    }
    if (text[end] == ' ' || space == 0) space = end;
    out.emplace_back(text.substr(0, space));
    text.remove_prefix(text[space] == ' ' ? space + 1 : space);
  }
  out.emplace_back(text);
  return out;
}

}  // namespace

std::string comparison_text(std::span<const RunResults> runs) {
  constexpr std::size_t kWidest = 44;  // [characters] of a cell; longer ones go on below, but not settings
  std::vector<std::vector<std::string>> lines;
  const auto add_row = [&](const std::vector<std::vector<std::string>>& cells) {
    std::size_t height = 0;
    for (const auto& cell : cells) height = std::max(height, cell.size());
    for (std::size_t n = 0; n < height; ++n) {
      lines.emplace_back();
      for (const auto& cell : cells) lines.back().push_back(n < cell.size() ? cell[n] : std::string());
    }
  };
  std::vector<std::vector<std::string>> head{{""}, {""}};
  for (const RunResults& run : runs) head.push_back(broken(run.name, kWidest));
  if (runs.size() == 2) head.push_back({"difference"});
  add_row(head);
  for (const ComparedRow& row : compared_rows(runs)) {
    std::vector<std::vector<std::string>> cells{{row.differs ? "*" : " "}, {row.name}};
    for (const std::string& cell : row.cells) cells.push_back(row.is_setting ? std::vector{cell} : broken(cell, kWidest));
    if (runs.size() == 2) cells.push_back({row.difference});
    add_row(cells);
  }
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines)
    for (std::size_t n = 0; n < line.size(); ++n) widths[n] = std::max(widths[n], length_of(line[n]));
  std::string out;
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t n = 0; n < line.size(); ++n) text += line[n] + std::string(widths[n] - length_of(line[n]) + (n == 0 ? 1 : 2), ' ');
    out += text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  return out;
}

std::string comparison_json(std::span<const RunResults> runs) {
  Json json;
  json["schema"] = kCompareSchema;
  json["runs"] = Json::array();
  for (const RunResults& run : runs) {
    Json facts = Json::object(), settings = Json::object(), figures = Json::object();
    for (const auto* list : {&run.used, &run.overrides})
      for (const auto& [name, value] : *list) settings.emplace(name, value);
    for (const auto& [name, value] : run.facts) facts[name] = value;
    for (const auto& [name, value] : run.figures) figures[name] = value ? Json(*value) : Json();
    json["runs"].push_back({{"name", run.name}, {"facts", facts}, {"settings", settings}, {"figures", figures}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

void add_table(std::span<const RunResults> runs, const std::vector<std::string>& names, HtmlPage& page) {
  std::vector<std::string> columns{""};
  columns.insert(columns.end(), names.begin(), names.end());
  if (runs.size() == 2) columns.emplace_back("Difference");
  std::vector<std::vector<std::string>> rows;
  for (const ComparedRow& row : compared_rows(runs)) {
    std::vector<std::string> line{row.differs ? row.name + " *" : row.name};
    line.insert(line.end(), row.cells.begin(), row.cells.end());
    if (runs.size() == 2) line.push_back(row.difference);
    rows.push_back(std::move(line));
  }
  page.heading("Figures");
  page.table(columns, rows);
  page.paragraph("* The values differ.");
}

Status add_views(const std::vector<ComparedView>& views, HtmlPage& page) {
  if (views.empty()) return {};
  page.heading("Pictures");
  page.paragraph(
      "The view of the first run, then that of each run that differs, followed by the place of the difference: orange over the first in "
      "grey.");
  for (const ComparedView& view : views) {
    page.begin_pictures();
    for (const ComparedPicture& picture : view.pictures)
      if (Status added = page.picture(picture.png_path, picture.caption); !added) return added;
    page.end_pictures();
    if (!view.same.empty()) page.paragraph(view.same);
  }
  return {};
}

}  // namespace

Status write_comparison(std::span<const RunResults> runs, const std::vector<ComparedView>& views, const std::string& folder) {
  std::vector<std::string> names;
  for (const RunResults& run : runs) names.push_back(run.name);
  HtmlPage page("Comparison of runs", fmt::format("{}", fmt::join(names, " · ")));
  add_table(runs, names, page);
  if (Status drawn = add_plot(runs, folder, page); !drawn) return drawn;
  for (const RunResults& run : runs)
    if (!has_same_bone(runs.front(), run))
      page.paragraph(fmt::format("{}: another bone than that of {}: their pictures are not compared.", run.name, runs.front().name));
  if (Status added = add_views(views, page); !added) return added;
  return write_file((fs::path(folder) / "compare.html").string(), page.text());
}

}  // namespace burrhole
