/// app/view/color_bar.h: the scale of colours that the pictures of a run need. An effect whose pictures have one returns it from
///   EffectPlan::config(typeid(ColorBar)); pictures, films and the window draw that of scene.find<ColorBar>(), whatever effect it is of.
///   Units  in the texts.   Frame  none.   Thread  any.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace burrhole {

/// The colours are those of core/base/color_ramp.h. Texts of pictures are in the letters of app/render/overlay.h.
struct ColorBar {
  std::string title;                                  ///< what is shown, and its unit
  std::vector<std::pair<double, std::string>> marks;  ///< place on the scale 0..1, and its value; ascending
};

}  // namespace burrhole
