/// app/view/color_bar.h: the scale of colours that pictures of a run show.
///   Units  in the texts.   Frame  none.   Thread  any.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace burrhole {

/// The colours are those of core/base/color_ramp.h. Texts are in the letters of app/render/overlay.h.
struct ColorBar {
  std::string title;
  std::vector<std::pair<double, std::string>> marks;  ///< place on the scale 0..1, and its value
};

}  // namespace burrhole
