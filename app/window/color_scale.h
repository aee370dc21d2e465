/// app/window/color_scale.h: the scale of colours that effects show, over the picture of the bone.
///   Units  pixels.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include "app/view/color_bar.h"
#include "app/window/gui.h"
#include "app/window/window_state.h"

namespace burrhole {

/// Part of the picture's left edge for a scale of colours.
struct ScaleRoom {
  float bottom = 0.0f;  ///< [pixels] of all of it
  float tall = 0.0f;    ///< [pixels] of the colours; 0: there is no room
};
/// @param above, below what is taken at the upper and lower edge of a picture of that height. @param letter height of a line of the scale's texts.
/// @returns the place of the scale of a still picture, from 0.3 to 0.7 of the height, or what is free of it.
[[nodiscard]] ScaleRoom scale_room(float height, float above, float below, float letter) noexcept;
/// The scale of colours that effects show, at the left edge of the picture: its colours with a mark at each value, its title above. In the present
/// font; a value for which there is no room is left out. @param scale of texts and spaces.
void draw_scale(const ColorBar& bar, const ScaleRoom& room, float scale);

/// The same for a view of a window, where its slices, hints and time line leave room. @param hints height of the hints; 0: none are shown. @param
/// height of the picture.
void draw_scale(const ColorBar& bar, const Gui& gui, const WindowView& view, float hints, int height);

}  // namespace burrhole
