/// tests/support/image_compare.h: pictures compared by tolerance; a failure leaves actual, expected and difference as PNG files.
#pragma once

#include <string>

#include "app/view/view.h"

namespace burrhole::test {

/// How far two pictures of one size may differ: channels in 0..255 levels.
struct PictureTolerance {
  int level = 0;       ///< a pixel differs when a channel is further off than this
  double share = 0.0;  ///< 0..1, of pixels that may differ
};

struct PictureDifference {
  bool same_size = false;
  double differing_share = 1.0;  ///< of pixels beyond the level
  int largest = 255;             ///< [levels]
  Image picture;                 ///< absolute difference, brightened eight times
};

[[nodiscard]] PictureDifference compare_pictures(const Image& actual, const Image& expected, int level);

/// @returns whether they agree; if not, writes <build>/test-pictures/NAME-{actual,expected,difference}.png and says so on stderr.
[[nodiscard]] bool pictures_agree(const std::string& name, const Image& actual, const Image& expected, const PictureTolerance& tolerance);

}  // namespace burrhole::test
