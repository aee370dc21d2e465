/// app/window/panel_parts.h: small parts of panels: colours, lines of text, and words over the picture.
///   Units  pixels.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include <imgui/imgui.h>

#include <string>

#include "app/window/gui.h"

namespace burrhole {

/// Opacity of a window with text over the picture: its text keeps its contrast over black and over white.
inline constexpr float kOverPicture = 0.9f;

[[nodiscard]] ImVec4 color(unsigned rgb, float alpha = 1.0f);
[[nodiscard]] ImU32 paint(unsigned rgb, float alpha = 1.0f);

/// Text without a format; bytes that are not UTF-8, as of a file's name, are shown escaped.
void text(const std::string& line);
/// The same in rows of at most that width, broken as broken_lines() does.
void paragraph(const std::string& line, float width);
/// A small caption above what follows.
void caption(const Gui& gui, const char* words);

/// The next window is no larger than a picture of that size; what does not fit is reached by the wheel.
void fit_over(int width, int height);
/// A window without frame over the picture. @param takes_mouse it has buttons; other words leave the mouse to the picture below.
bool begin_over(const char* name, const ImVec2& place, const ImVec2& pivot, bool takes_mouse = false);

}  // namespace burrhole
