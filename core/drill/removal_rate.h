/// core/drill/removal_rate.h: feed speed of a bit in bone and its removal rate, predicted from its points (law `rate`).
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any; not for the servo path.   Source  own derivation:
///   The bit passes a bone voxel at (x, y) with the feed speed v. The voxel loses remaining by d(ln r)/dt = -e(x, y, w) s / h, with w the
///   depth behind the leading end of the bit, dw = v dt. Bone at w has left the felt surface (r < 1/2) when E(x, y, w) = integral of e dw
///   up to w >= v h ln 2 / s. A spinning tool is engaged by d = F / K_cut at its cutting points and by 0 at passive points: the constrained
///   tool meets bone at the position of its cutting points moved back along the push by d. So bone must be gone at p - d feed for a cutting
///   point p, and at p for a passive point. v = min of E(...) s / (h ln 2) over the points that face the feed, and Q = A v, with A the area
///   of the cutting part seen along the feed. For a uniform factor: v = (F / K_cut) e s / (h ln 2).
///   Accuracy: 10 % if only the end touches bone. In a bore the bit rests on the fillet between floor and wall, which is removed later, so
///   flat ends are slower than predicted (bound in bits_drilling_test.cpp). Round, pointed and thin-walled ends: an estimate within a voxel of the
///   engaged depth and a factor of 2.
#pragma once

#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

struct FeedConditions {
  double thrust = 20.0;              ///< [N] along the feed
  double spin = 1000.0 / 60.0;       ///< [rev/s]
  double hardness = 1.0;             ///< [-] h in (0, 1]
  double cutting_stiffness = 100e3;  ///< [N/m] K_cut; the default of a scene
};

/// Direction of the feed: along the shaft into bone (-z), or sideways (+x).
enum class FeedDirection { plunge, sideways };

struct FeedPrediction {
  double engaged = 0.0;  ///< [m] F / K_cut
  double speed = 0.0;    ///< [m/s] 0: a face that does not cut is ahead
  double area = 0.0;     ///< [m^2] of the cutting part, seen along the feed
  double rate = 0.0;     ///< [m^3/s]
};

/// Points above the highest and (sideways) below the lowest cutting point are ignored: a shaft or a foot is assumed to be clear of bone.
/// Linear in the number of points. @pre conditions are finite and > 0.
[[nodiscard]] FeedPrediction predict_feed(const Tool& tool, FeedDirection direction, const FeedConditions& conditions);

}  // namespace burrhole
