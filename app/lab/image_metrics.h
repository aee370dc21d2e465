/// app/lab/image_metrics.h: metrics of the difference between a picture and its reference. Alpha is ignored.
///   Shape   both pictures have the same size, at least 11 x 11 pixels (precondition); channels are sRGB as stored, 0..255.   Errors  none.
///   Source  [Wang04] Wang, Bovik, Sheikh, Simoncelli: Image quality assessment, IEEE Transactions on Image Processing 13(4), 2004;
///           [Andersson20] Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator for Alternating
///           Images, Proceedings of the ACM on Computer Graphics 3(2), 2020.
#pragma once

#include "app/view/view.h"

namespace burrhole {

/// Peak signal to noise over the three channels, 10 log10(255^2 / mean square) [dB]; infinite for equal pictures.
[[nodiscard]] double psnr(const Image& image, const Image& reference);

/// Mean structural similarity of the luma (Rec. 601), -1..1, 1 for equal pictures: 11 x 11 Gaussian windows of sigma 1.5 completely inside
/// the picture, K1 = 0.01, K2 = 0.03. [Wang04]
[[nodiscard]] double ssim(const Image& image, const Image& reference);

/// [pixels/deg] of a monitor 0.7 m wide with 3840 pixels, seen from 0.7 m, as in [Andersson20].
inline constexpr double kPixelsPerDegree = 67.02;

/// Mean perceived difference when alternating between the two, 0 (none) to 1. [Andersson20], for pictures of low dynamic range.
[[nodiscard]] double flip(const Image& image, const Image& reference, double pixels_per_degree = kPixelsPerDegree);

}  // namespace burrhole
