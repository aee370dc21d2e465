#include "app/job/expectation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/config/toml.h"

namespace burrhole {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

std::optional<double> percent(const std::optional<double>& share) { return share ? std::optional(100.0 * *share) : std::nullopt; }

std::optional<OutcomeFlag> flag_named(std::string_view name) {
  for (std::size_t n = 0; n < kOutcomeFlags; ++n)
    if (const auto flag = static_cast<OutcomeFlag>(1u << n); name == name_of(flag)) return flag;
  return std::nullopt;
}

/// @returns what may be written, in one line.
std::string allowed() {
  std::string out = "through";
  for (const OutcomeRow& row : result_rows({})) out += ", " + row.name;
  out += "; no FLAG, where FLAG is ";
  bool first = true;
  for (const OutcomeRow& row : flag_rows({})) out += (std::exchange(first, false) ? "" : ", ") + row.name;
  out += "; FIGURE<VALUE UNIT or FIGURE>VALUE UNIT, where FIGURE and UNIT are ";
  first = true;
  for (const ExpectedFigure& figure : expected_figures())
    out += fmt::format("{}{} {}", std::exchange(first, false) ? "" : ", ", figure.name, figure.unit);
  return out;
}

Error wrong(std::string_view term, const std::string& why) {
  return bad_input(fmt::format("--expect: \"{}\" {}; allowed: {}", term, why, allowed()));
}

/// The error of a term whose meaning is clear, with the term as it is written.
Error write_instead(std::string_view term, const std::string& why, const std::string& instead) {
  return bad_input(fmt::format("--expect: \"{}\" {}: write \"{}\" (burrhole docs outcome)", term, why, instead));
}

bool is_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && std::isfinite(value);
}

/// @returns the last part of the figure's key: its name in summary.json.
std::string_view summary_name(const ExpectedFigure& figure) {
  const std::string_view key = figure.about;
  return key.substr(key.rfind('.') + 1);
}

/// @returns the figure of a name as --expect has it, with hyphens or underscores, or as summary.json has it, with or without its table.
const ExpectedFigure* figure_named(std::string_view name) {
  std::string plain(name);
  std::ranges::replace(plain, '_', '-');
  for (const ExpectedFigure& figure : expected_figures())
    if (plain == figure.name || name == figure.about || name == summary_name(figure)) return &figure;
  return nullptr;
}

/// @returns the error of a name that no figure has: with the nearest name, and the figures alone.
Error no_figure(std::string_view term, std::string_view name) {
  std::vector<std::string> names, all;
  for (const ExpectedFigure& figure : expected_figures()) {
    names.emplace_back(figure.name);
    all.emplace_back(figure.name);
    all.emplace_back(summary_name(figure));
  }
  const auto near = nearest_name(name, all);
  return bad_input(fmt::format("--expect: \"{}\" names no figure: \"{}\"; {}figures: {} (burrhole docs outcome)", term, name,
                               near ? "did you mean \"" + *near + "\"? " : "", fmt::join(names, ", ")));
}

/// The same for a flag.
Error no_flag(std::string_view term, std::string_view name) {
  std::vector<std::string> names;
  for (const OutcomeRow& row : flag_rows({})) names.push_back(row.name);
  const auto near = nearest_name(name, names);
  return bad_input(fmt::format("--expect: \"{}\" names no flag: \"{}\"; {}flags: {} (burrhole docs outcome)", term, name,
                               near ? "did you mean \"no " + *near + "\"? " : "", fmt::join(names, ", ")));
}

/// @returns the error of two terms that another word or sign than a comma joins; nothing if none does.
std::optional<Error> joined_otherwise(std::string_view term) {
  const std::string_view first = term.substr(0, term.find(' '));
  const std::string_view after = trimmed(term.substr(first.size()));
  if (first == "through" && !after.empty() && std::isalpha(static_cast<unsigned char>(after.front())) != 0 && !after.starts_with("and ") &&
      !after.starts_with("or "))
    return write_instead(term, "joins terms by a blank", fmt::format("{}, {}", first, after));
  for (const std::string_view joint : {" and ", "&&", ";", " or ", "||"}) {
    const std::size_t at = term.find(joint);
    if (at == std::string_view::npos) continue;
    if (joint == " or " || joint == "||") return wrong(term, "joins terms by or: all terms of --expect must hold");
    return write_instead(term, "joins terms by another sign than a comma",
                         fmt::format("{}, {}", trimmed(term.substr(0, at)), trimmed(term.substr(at + joint.size()))));
  }
  return std::nullopt;
}

/// @returns the error of a comparison by other signs than < and >, or with the number first; nothing for another term.
std::optional<Error> compared_otherwise(std::string_view term) {
  const std::size_t from = term.find_first_of("<>=!"), end = term.find_first_not_of("<>=!", from);
  if (from == std::string_view::npos || from == 0 || end == std::string_view::npos) return std::nullopt;
  const std::string_view left = trimmed(term.substr(0, from)), signs = term.substr(from, end - from), right = trimmed(term.substr(end));
  const std::size_t way = signs.find_first_of("<>");
  if (is_number(left) && figure_named(right) != nullptr && way != std::string_view::npos)
    return write_instead(term, "has its number first", fmt::format("{}{}{}", right, signs[way] == '<' ? '>' : '<', left));
  if (signs == "<" || signs == ">" || !is_number(right)) return std::nullopt;
  if (way != std::string_view::npos)
    return write_instead(term, fmt::format("compares by {}, and there are only < and >", signs),
                         fmt::format("{}{}{}", left, signs[way], right));
  return write_instead(term, fmt::format("compares by {}, and a figure is only below or above a number", signs),
                       fmt::format("{0}>LOW, {0}<HIGH", left));
}

Result<ExpectedTerm> parse_comparison(std::string_view term, std::size_t sign) {
  ExpectedTerm out;
  out.text = term;
  out.below = term[sign] == '<';
  const std::string_view name = trimmed(term.substr(0, sign)), right = trimmed(term.substr(sign + 1));
  const ExpectedFigure* const found = figure_named(name);
  if (found == nullptr) return no_figure(term, name);
  out.figure = found;
  const auto [end, error] = std::from_chars(right.data(), right.data() + right.size(), out.value);
  if (error != std::errc() || !std::isfinite(out.value)) return wrong(term, "has no number after " + std::string(1, term[sign]));
  const std::string_view number = right.substr(0, static_cast<std::size_t>(end - right.data()));
  const std::string_view unit = trimmed(right.substr(number.size()));
  // A name of summary.json holds its unit; a share is in [0, 1] there.
  if (unit.empty() && name.ends_with(summary_name(*found))) {
    if (name.ends_with("_share")) out.value *= 100.0;
    return out;
  }
  if (!unit.empty() && unit != found->unit)
    return bad_input(fmt::format("--expect: \"{}\" has the unit {}: {} is in {} (burrhole docs outcome)", term, unit, name, found->unit));
  if (unit != found->unit)
    return write_instead(term, fmt::format("needs the unit {} after its number", found->unit),
                         fmt::format("{}{}{}{}", name, term[sign], number, found->unit));
  return out;
}

Result<ExpectedTerm> parse_term(std::string_view term) {
  if (term.empty()) return wrong(term, "is an empty term");
  if (const auto joined = joined_otherwise(term)) return *joined;
  if (const auto compared = compared_otherwise(term)) return *compared;
  if (const auto sign = term.find_first_of("<>"); sign != std::string_view::npos) return parse_comparison(term, sign);
  ExpectedTerm out;
  out.text = term;
  if (term.starts_with("no ")) {
    out.no_flag = flag_named(trimmed(term.substr(3)));
    if (!out.no_flag) return no_flag(term, trimmed(term.substr(3)));
    return out;
  }
  for (const std::string_view negated : {"not ", "!", "without "})
    if (term.starts_with(negated))
      if (const std::string_view name = trimmed(term.substr(negated.size())); flag_named(name))
        return write_instead(term, "excludes a flag in other words", fmt::format("no {}", name));
  if (flag_named(term)) return write_instead(term, "is a flag, which can only be excluded", fmt::format("no {}", term));
  out.result = term == "through" ? DrillResult::drilled_through : result_named(term);
  if (!out.result) {
    std::vector<std::string> words{"through"};
    for (std::size_t n = 0; n < kDrillResults; ++n) words.emplace_back(name_of(static_cast<DrillResult>(n)));
    const auto near = nearest_name(term, words);
    return wrong(term, near ? "is no result; did you mean \"" + *near + "\"?" : "is no result");
  }
  return out;
}

/// @returns what was found in place of the term; empty if it holds.
std::string found_instead(const ExpectedTerm& term, const RunSummary& summary, const RunOutcome& outcome) {
  if (term.result)
    return *term.result == outcome.result ? "" : fmt::format("the result is {}: {}", name_of(outcome.result), outcome.reason);
  if (term.no_flag) return (outcome.flags & *term.no_flag) == 0 ? "" : fmt::format("the flag {} is set", name_of(*term.no_flag));
  const auto value = term.figure->value(summary);
  if (!value) return fmt::format("the run has no {}", term.figure->name);
  if (term.below ? *value < term.value : *value > term.value) return {};
  return fmt::format("{} is {:.6g} {}", term.figure->name, *value, term.figure->unit);
}

}  // namespace

const std::vector<ExpectedFigure>& expected_figures() {
  using Summary = const RunSummary&;
  using Value = std::optional<double>;
  static const std::vector<ExpectedFigure> kFigures{
      {"plunge", "mm", "drilling.plunge_mm", [](Summary s) -> Value { return s.plunge_mm; }},
      {"depth", "mm", "drilling.reached_mm", [](Summary s) -> Value { return s.reached_mm; }},
      {"breakthrough-depth", "mm", "drilling.depth_mm", [](Summary s) -> Value { return s.depth_mm; }},
      {"beyond", "mm", "drilling.beyond_mm", [](Summary s) -> Value { return s.beyond_mm; }},
      {"thickness", "mm", "drilling.thickness_mm", [](Summary s) -> Value { return s.thickness_mm; }},
      {"hole", "mm", "drilling.hole_diameter_mm", [](Summary s) -> Value { return s.hole_diameter_mm; }},
      {"inner-hole", "mm", "drilling.inner_diameter_mm", [](Summary s) -> Value { return s.inner_diameter_mm; }},
      {"aside", "mm", "drilling.aside_mm", [](Summary s) -> Value { return s.aside_mm; }},
      {"removed", "mm3", "drilling.removed_mm3", [](Summary s) -> Value { return s.removed_mm3; }},
      {"removed-mass", "mm3", "drilling.removed_mass_mm3", [](Summary s) -> Value { return s.removed_mass_mm3; }},
      {"cleared", "%", "drilling.cleared_share", [](Summary s) -> Value { return percent(s.cleared_share); }},
      {"uncut", "%", "drilling.uncut_share", [](Summary s) -> Value { return percent(s.uncut_share); }},
      {"peak-force", "N", "drilling.peak_force_N", [](Summary s) -> Value { return s.peak_force_N; }},
      {"angle", "deg", "drilling.angle_deg", [](Summary s) -> Value { return s.angle_deg; }},
      {"time", "s", "drilling.breakthrough_s", [](Summary s) -> Value { return s.breakthrough_s; }},
      {"duration", "s", "duration_s", [](Summary s) -> Value { return s.duration_s; }}};
  return kFigures;
}

Result<std::vector<ExpectedTerm>> parse_expectation(std::string_view text) {
  std::vector<ExpectedTerm> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    auto term = parse_term(trimmed(text.substr(from, comma - from)));
    if (!term) return term.error();
    out.push_back(std::move(term).value());
    from = comma + 1;
  }
  return out;
}

std::vector<std::string> missed_terms(const std::vector<ExpectedTerm>& terms, const RunSummary& summary) {
  const RunOutcome outcome = outcome_of(summary);
  std::vector<std::string> out;
  for (const ExpectedTerm& term : terms)
    if (const std::string instead = found_instead(term, summary, outcome); !instead.empty())
      out.push_back(fmt::format("expected {}: {}", term.text, instead));
  return out;
}

}  // namespace burrhole
