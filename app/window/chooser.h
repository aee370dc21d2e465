/// app/window/chooser.h: a window with a list, from which a person chooses what to do.
///   Thread  main.   Errors  unavailable: no display, or no OpenGL 4.5 core.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string>

#include "app/window/window_event.h"
#include "core/base/result.h"

namespace burrhole {

/// A line of the list.
struct Choice {
  std::string heading{};  ///< above this line; empty: the line belongs to the heading before
  std::string title;
  std::string about{};    ///< below the title, small
  std::string missing{};  ///< why it cannot be chosen; empty: it can
};

struct ChooserConfig {
  bool light = false;
  double text_scale = 1.0;        ///< [-] of the desktop's own scale
  int width = 900, height = 640;  ///< [pixels]
};

/// The line that is chosen, and how keys move it. It knows no window.
class Selection {
 public:
  explicit Selection(std::span<const Choice> choices) noexcept;
  enum class Answer { none, chosen, closed };
  /// Up and Down move to the next line that can be chosen, Home to the first, Enter chooses, Escape closes.
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

/// Shows the list until a line is chosen. @param stop set by a signal handler: ends it; may be null.
/// @returns the line; nothing if the person closed the window.
[[nodiscard]] Result<std::optional<std::size_t>> choose_in_window(const std::string& title, std::span<const Choice> choices,
                                                                  const ChooserConfig& config, const std::atomic<bool>* stop);

}  // namespace burrhole
