/// app/job/expectation.h: what a run is expected to result in, as `burrhole drill --expect` writes it: "through, plunge<0.5mm".
///   Terms are separated by commas; all must hold.
///     RESULT             a result of core/measure/outcome.h; "through" stands for drilled-through
///     no FLAG            the flag is not set
///     FIGURE < VALUE UNIT, FIGURE > VALUE UNIT      a figure of expected_figures(), with its unit; its name may have "_" in place of "-"
///     KEY < VALUE, KEY > VALUE      the same by its key in summary.json, "plunge_mm" or "drilling.plunge_mm"; the unit may be left out
///   A figure that the run does not have, as the plunge of a run that is not through, does not hold.
///   Units  in the texts.   Frame  none.   Errors  bad_input: a term that is none of these, with what is allowed; an unknown figure, with the nearest.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/job/summary.h"

namespace burrhole {

/// A figure that an expectation may name.
struct ExpectedFigure {
  const char* name;   ///< "plunge"
  const char* unit;   ///< "mm"
  const char* about;  ///< key of summary.json
  std::optional<double> (*value)(const RunSummary&);
};
[[nodiscard]] const std::vector<ExpectedFigure>& expected_figures();

struct ExpectedTerm {
  std::string text;                   ///< as written, without blanks around it
  std::optional<DrillResult> result;  ///< of a term RESULT
  std::optional<OutcomeFlag> no_flag;
  const ExpectedFigure* figure = nullptr;  ///< of a term with < or >
  bool below = true;                       ///< the term is FIGURE < VALUE
  double value = 0.0;                      ///< [unit of the figure]
};

[[nodiscard]] Result<std::vector<ExpectedTerm>> parse_expectation(std::string_view text);
/// @returns one line for each term that does not hold, with what was found; empty if all hold.
[[nodiscard]] std::vector<std::string> missed_terms(const std::vector<ExpectedTerm>& terms, const RunSummary& summary);

}  // namespace burrhole
