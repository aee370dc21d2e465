/// app/window/selection.h: the lines of a list, the line that is chosen, and how keys move it. It knows no window.
///   Errors  none.   Thread  one at a time.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "app/window/window_event.h"

namespace burrhole {

/// A line of the list.
struct Choice {
  std::string heading{};  ///< above this line; empty: the line belongs to the heading before
  std::string title;
  std::string about{};       ///< below the title, small
  std::string missing{};     ///< why it cannot be chosen; empty: it can
  bool opens_files = false;  ///< it shows files to open
};

/// The line that is chosen, and how keys move it.
class Selection {
 public:
  explicit Selection(std::span<const Choice> choices) noexcept;
  enum class Answer { none, chosen, closed };
  /// Up and Down move to the next line that can be chosen, Page Up and Down by eight, Home to the first, Enter chooses, Escape closes.
  Answer press(Key key) noexcept;
  [[nodiscard]] std::size_t at() const noexcept { return at_; }
  [[nodiscard]] bool is_possible() const noexcept { return at_ < choices_.size() && choices_[at_].missing.empty(); }
  /// @returns whether the line can be chosen.
  bool point_at(std::size_t line) noexcept;

 private:
  void move(int by) noexcept;
  std::span<const Choice> choices_;
  std::size_t at_ = 0;
};

}  // namespace burrhole
