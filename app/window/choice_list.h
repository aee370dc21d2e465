/// app/window/choice_list.h: draws lines of which a person chooses one.
///   Units  pixels.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include <optional>

#include "app/window/gui.h"
#include "app/window/selection.h"

namespace burrhole {

/// @param name of the list, so that each keeps its own place. @param moved a key was pressed: the chosen line comes into view.
/// @param below [pixels] left free under the list. @returns the line that was clicked.
std::optional<std::size_t> draw_choices(const Gui& gui, const char* name, std::span<const Choice> choices, Selection& selection, bool moved,
                                        float below);

}  // namespace burrhole
