/// core/drill/removal_rate.h: feed speed of a bit in bone and its removal rate, predicted from its points (law `rate`).
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any; not for the servo path.   Source  own derivation:
///   A spinning tool is engaged by d = F / K_cut: the constrained tool touches bone at its pose moved back along the push by d, so the face
///   of bone lags the tool by d. A face recedes at e s / h times its lag (core/drill/cut_face.h), e the erosion factor of the tool at the
///   face. So v = min of e d s / h over the points that face the feed, and Q = A v, with A the area of the cutting part seen along the
///   feed. A passive point ahead of which nothing cuts stops the bit: v = 0. For a uniform factor: v = (F / K_cut) e s / h.
///   Where e changes within a voxel, as on the axis of a round burr, the face is interpolated between voxels, and v depends on where the axis
///   lies between them: from e at the place itself to the mean of e at the corners of a voxel round it. The speed is the middle of this
///   range, and unknown if the range is wider than 10 % either way.
///   Accuracy: bits_feed_test.cpp measures every shipped bit: 10 %, or unknown.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

struct FeedConditions {
  double thrust = 20.0;              ///< [N] along the feed
  double spin = 1000.0 / 60.0;       ///< [rev/s]
  double hardness = 1.0;             ///< [-] h in (0, 1]
  double cutting_stiffness = 140e3;  ///< [N/m] K_cut; the default of a scene
  double voxel_edge = 0.25e-3;       ///< [m] of the bone
};

/// Direction of the feed: along the shaft into bone (-z), or sideways (+x).
enum class FeedDirection { plunge, sideways };

struct FeedPrediction {
  double engaged = 0.0;            ///< [m] F / K_cut
  double speed = 0.0;              ///< [m/s] 0: a face that does not cut is ahead; an estimate if `unknown` is not empty
  double area = 0.0;               ///< [m^2] of the cutting part, seen along the feed
  double rate = 0.0;               ///< [m^3/s]
  double least = 0.0, most = 0.0;  ///< [m/s] range of the speed by where the limiting point lies between voxels
  std::string unknown{};           ///< why the speed is not known to 10 %; empty: it is
};

/// Points above the highest and (sideways) below the lowest cutting point are ignored: a shaft or a foot is assumed to be clear of bone.
/// Linear in the number of points. @pre conditions are finite and > 0.
[[nodiscard]] FeedPrediction predict_feed(const Tool& tool, FeedDirection direction, const FeedConditions& conditions);

/// A bit that cuts least near its axis, as a round burr, is faster where a pore of the diploe lies there.
/// @returns by how many times: the least factor beside a pore of 0.35 mm radius on the axis over that within, at least 1.
[[nodiscard]] double feed_beside_pore(const Tool& tool) noexcept;

}  // namespace burrhole
