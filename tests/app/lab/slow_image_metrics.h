/// tests/app/lab/slow_image_metrics.h: the image metrics once more, pixel by pixel with windows in the plane, sharing no code with app/lab.
#pragma once

#include "app/view/view.h"

namespace burrhole::test {

/// Deliberate faults, each of which the comparison must notice.
enum class MetricSabotage { none, no_gamma, wide_window, no_features, no_hunt };

[[nodiscard]] double slow_ssim(const Image& a, const Image& b, MetricSabotage sabotage = MetricSabotage::none);
[[nodiscard]] double slow_flip(const Image& a, const Image& b, double pixels_per_degree, MetricSabotage sabotage = MetricSabotage::none);

}  // namespace burrhole::test
