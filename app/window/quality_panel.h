/// app/window/quality_panel.h: the quality of a picture at rest, with the time that it takes and the error that is known of it.
///   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include "app/window/panel.h"

namespace burrhole {

void draw_quality(const Gui& gui, WindowState& state, const DisplayFigures& figures);

}  // namespace burrhole
