/// core/config/renamed_keys.h: keys of TOML files that earlier versions wrote by another name or in another unit.
///   TomlDocument::rename converts a recorded text to the present keys with this table. An unknown key in the table is reported
///   with its new name.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace burrhole {

/// A word that a text key takes, by its old and its new name.
struct RenamedWord {
  std::string_view old_word, new_word;
};

struct RenamedKey {
  std::string_view old_path;  ///< dotted from the root, elements of arrays of tables as "region[].key"; also a whole table
  std::string_view new_path;  ///< the same arrays of tables before its last keys as in old_path; empty: the key is no longer read
  double factor = 1.0;        ///< [-] new value = factor x old value, for a number and for each number of an array
  std::span<const RenamedWord> words{};  ///< what a text value becomes; other texts stay
};
using RenamedKeys = std::span<const RenamedKey>;

/// One key that was renamed in a document, with the paths of the table's entry.
struct Renaming {
  std::string old_path;
  std::string new_path;  ///< empty: it was removed
  bool dropped = false;  ///< the document had the new key too, which stays as it is
  friend bool operator==(const Renaming&, const Renaming&) = default;
};

/// The table of this version, used by every document that is given no other.
[[nodiscard]] RenamedKeys renamed_keys() noexcept;

/// @returns the entry for a dotted path, elements of arrays written as "region[]"; null when it has none.
[[nodiscard]] const RenamedKey* find_renamed(RenamedKeys table, std::string_view path) noexcept;

}  // namespace burrhole
