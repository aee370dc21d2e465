/// app/window/held_input.h: the keys that a person holds, and the mouse button with which they drag.
///   Units  pixels of the window.   Errors  none.   Thread  one.
#pragma once

#include <optional>
#include <set>

#include "app/window/window_event.h"

namespace burrhole {

class HeldInput {
 public:
  [[nodiscard]] bool has(Key key) const { return keys_.contains(static_cast<int>(key)); }
  [[nodiscard]] const std::optional<MouseButton>& dragging() const noexcept { return dragging_; }

  /// Takes an event of a key. @returns the key if it went down with this event, not if it repeats.
  std::optional<Key> take_key(const WindowEvent& event) {
    if (!event.down) {
      keys_.erase(event.code);
      return std::nullopt;
    }
    return keys_.insert(event.code).second ? std::optional(static_cast<Key>(event.code)) : std::nullopt;
  }
  /// Takes an event of a mouse button. A drag begins only in a picture of `width`, and where `taken` does not give the event to a panel.
  /// @returns whether a drag begins.
  bool take_button(const WindowEvent& event, bool taken, int width) {
    if (!event.down) dragging_.reset();
    const bool begins = event.down && !taken && event.x < width && event.code <= static_cast<int>(MouseButton::middle);
    if (begins) dragging_ = static_cast<MouseButton>(event.code);
    return begins;
  }
  /// A window without focus gets no release of a key.
  void clear() noexcept {
    keys_.clear();
    dragging_.reset();
  }

 private:
  std::set<int> keys_;
  std::optional<MouseButton> dragging_;
};

}  // namespace burrhole
