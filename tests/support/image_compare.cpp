#include "tests/support/image_compare.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "app/render/png.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {

PictureDifference compare_pictures(const Image& actual, const Image& expected, int level) {
  PictureDifference result;
  result.same_size = actual.width == expected.width && actual.height == expected.height && actual.pixels.size() == expected.pixels.size();
  if (!result.same_size) return result;
  result.picture = Image{actual.width, actual.height, {}};
  result.largest = 0;
  std::size_t differing = 0;
  for (std::size_t n = 0; n < actual.pixels.size(); ++n) {
    const Rgba8& a = actual.pixels[n];
    const Rgba8& b = expected.pixels[n];
    const int d[] = {std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)};
    const int most = *std::max_element(std::begin(d), std::end(d));
    result.largest = std::max(result.largest, most);
    if (most > level) ++differing;
    const auto bright = [](int difference) { return static_cast<std::uint8_t>(std::min(255, 8 * difference)); };
    result.picture.pixels.push_back({bright(d[0]), bright(d[1]), bright(d[2]), 255});
  }
  result.differing_share = static_cast<double>(differing) / static_cast<double>(std::max<std::size_t>(1, actual.pixels.size()));
  return result;
}

bool pictures_agree(const std::string& name, const Image& actual, const Image& expected, const PictureTolerance& tolerance) {
  const PictureDifference difference = compare_pictures(actual, expected, tolerance.level);
  if (difference.same_size && difference.differing_share <= tolerance.share) return true;
  const std::filesystem::path folder = test::in_build("test-pictures");
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  std::cerr << name << ": " << 100.0 * difference.differing_share << " % of the pixels differ by more than " << tolerance.level
            << " levels, the most by " << difference.largest << "; see " << (folder / name).string() << "-*.png\n";
  for (const auto& [what, image] :
       {std::pair("actual", &actual), std::pair("expected", &expected), std::pair("difference", &difference.picture)}) {
    const Status written = write_png(folder / (name + "-" + what + ".png"), *image);
    if (!written) std::cerr << written.error().text() << '\n';
  }
  return false;
}

}  // namespace burrhole::test
