/// app/window/over_bone.h: what lies over the picture of the bone: the handle of the cut, the edge of a microscope's field.
///   Units  pixels.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include <string>

#include "app/window/gui.h"
#include "app/window/window_state.h"

namespace burrhole {

/// [pixels] edge of a slice through the tip at scale 1, at most.
inline constexpr int kSliceSize = 200;

/// The handle of the plane at which the picture is cut open; a drag moves the plane along its normal. Draws nothing without a cut,
/// and where the picture is not that of the camera (two eyes, workbench): there the sliders move it.
/// @param width, height of the picture.
void draw_cut_handle(const Gui& gui, WindowState& state, const WindowView& view, const WindowPlan& plan, int width, int height);

/// The dark edge of a microscope's round field, over a picture of that size.
void draw_eyepiece(int width, int height);

/// What of the picture is assumed, at its upper edge. @param width of the picture.
void draw_note(const std::string& note, const Gui& gui, int width);

/// Offset and direction of the cut, for the panel.
void draw_cut_sliders(const Gui& gui, WindowState& state, const WindowView& view);

}  // namespace burrhole
