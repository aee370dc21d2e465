#include "core/config/renamed_keys.h"

#include <algorithm>

namespace burrhole {

RenamedKeys renamed_keys() noexcept {
  // One line a key: {"table.old_key_unit", "table.new_key_unit", factor}.
  static constexpr std::span<const RenamedKey> kNone;
  return kNone;
}

const RenamedKey* find_renamed(RenamedKeys table, std::string_view path) noexcept {
  const auto found = std::ranges::find(table, path, &RenamedKey::old_path);
  return found == table.end() ? nullptr : &*found;
}

}  // namespace burrhole
