/// app/render/tip_slices_picture.h: draws three slices through a point into one picture. No OpenGL.
///   Units  pixels.   Errors  none.   Thread  any.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/view/tip_slices.h"
#include "app/view/view.h"

namespace burrhole {

/// Draws the slices side by side.
[[nodiscard]] Image draw_tip_slices(const TipSlices& slices);

/// Square cells in a picture, from the upper left on, row by row.
struct CellLayout {
  int width = 0, height = 0;  ///< [pixels] of the picture
  int columns = 1, rows = 1;  ///< [-] at least three cells
  int size = 0, gap = 0;      ///< [pixels] edge of a cell; between cells and around them
  int left = 0, top = 0;      ///< [pixels] of the first cell
};
/// @returns the layout with the largest cells: a row or a column of three, or two rows of two. @param width, height at least 64.
[[nodiscard]] CellLayout fit_cells(int width, int height);
/// @returns the same with two rows of two, above a strip of `below` pixels.
[[nodiscard]] CellLayout square_cells(int width, int height, int below);
/// Draws the slices into the first three cells. @param slices of the size of a cell. @param legend lines of text in the fourth cell, if any.
[[nodiscard]] Image draw_tip_slices(const TipSlices& slices, const CellLayout& layout, const std::vector<std::string>& legend);
/// Copies a picture to a place; what lies outside `to` is left out.
void copy_into(Image& to, const Image& from, int left, int top);

}  // namespace burrhole
