/// app/window/transport_bar.h: the time line of a watched session, below its picture: run, pause, step, speed, jump.
///   Units  pixels.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include "app/window/gui.h"
#include "app/window/window_state.h"

namespace burrhole {

[[nodiscard]] float transport_height(const Gui& gui) noexcept;

/// @pre view.transport. @param width, height of the picture.
void draw_transport(const Gui& gui, WindowState& state, const WindowView& view, const WindowPlan& plan, int width, int height);

}  // namespace burrhole
