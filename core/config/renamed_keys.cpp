#include "core/config/renamed_keys.h"

#include <algorithm>
#include <array>

namespace burrhole {

RenamedKeys renamed_keys() noexcept {
  // One line a key: {"table.old_key_unit", "table.new_key_unit", factor}.
  static constexpr std::array<RenamedKey, 2> kTable{{
      {.old_path = "erosion.clear_below", .new_path = ""},  // walls are the tool's without it
      {.old_path = "hand.give_mm_per_s", .new_path = ""},   // breakthrough is detected by force
  }};
  return kTable;
}

const RenamedKey* find_renamed(RenamedKeys table, std::string_view path) noexcept {
  const auto found = std::ranges::find(table, path, &RenamedKey::old_path);
  return found == table.end() ? nullptr : &*found;
}

}  // namespace burrhole
