// Any text as a markups file, JSON or comma-separated: faults are values with a place, and an accepted line has a direction.
#include <cstdlib>
#include <string_view>

#include "volumes/read/markups.h"

namespace {

void demand_line(const burrhole::Result<burrhole::PlannedLine>& line) {
  if (!line) {
    if (!line.error().place.starts_with("fuzzed:") || line.error().message.empty()) std::abort();
    return;
  }
  if (!burrhole::is_finite(line->entry) || !burrhole::is_finite(line->target)) std::abort();
  if (!(glm::length(line->target - line->entry) > 0.0)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  demand_line(burrhole::parse_markups_json(text, "fuzzed"));
  demand_line(burrhole::parse_markups_fcsv(text, "fuzzed"));
  return 0;
}
