/// app/job/outcome_doc.h: the reference of results, flags and expectations, docs/outcome.md, from the tables that judge runs.
///   Units  in the text.   Frame  none.   Errors  none.   Thread  any.
#pragma once

#include <string>

namespace burrhole {

/// @returns the page as `burrhole docs outcome` prints it.
[[nodiscard]] std::string outcome_markdown();

}  // namespace burrhole
