#include "app/window/selection.h"

namespace burrhole {

Selection::Selection(std::span<const Choice> choices) noexcept : choices_(choices) {
  if (!is_possible()) move(1);
}

void Selection::move(int by) noexcept {
  for (std::size_t n = at_ + static_cast<std::size_t>(by); n < choices_.size(); n += static_cast<std::size_t>(by))
    if (choices_[n].missing.empty()) {
      at_ = n;
      return;
    }
}

bool Selection::point_at(std::size_t line) noexcept {
  if (line >= choices_.size() || !choices_[line].missing.empty()) return false;
  at_ = line;
  return true;
}

Selection::Answer Selection::press(Key key) noexcept {
  constexpr int kPage = 8;
  if (key == Key::escape) return Answer::closed;
  if (key == Key::enter && is_possible()) return Answer::chosen;
  if (key == Key::up) move(-1);
  if (key == Key::down) move(1);
  for (int n = 0; n < kPage && (key == Key::page_up || key == Key::page_down); ++n) move(key == Key::page_up ? -1 : 1);
  if (key == Key::home) {
    at_ = 0;
    if (!is_possible()) move(1);
  }
  return Answer::none;
}

}  // namespace burrhole
