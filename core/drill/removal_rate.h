/// core/drill/removal_rate.h: how fast a bit goes through bone and how much it takes, foretold from its points alone (law `rate`).
///   Frame  tool frame.   Units  SI.   Source  own derivation:
///   A bone voxel at a place (x, y) that the bit passes at the feed v loses remaining by d(ln r)/dt = -e(x, y, w) s / h, w the depth behind
///   the bit's leading end, dw = v dt. Bone at w is gone from the felt surface (r < 1/2) when E(x, y, w) = integral of e dw up to w >= v h
///   ln 2 / s. A spinning tool is engaged by d = F / K_cut where it cuts, and by nothing where it does not: the constrained tool feels bone
///   where its cutting points were before it was engaged, moved back along the push by d, whatever their planes. So bone must be gone at p
///   - d feed for a cutting point p, at p for a passive one. v = min over the points that look along the feed of E(...) s / (h ln 2), and Q
///   = A v, A the area of the bit's cutting part seen along the feed.
///   For an even factor: v = (F / K_cut) e s / (h ln 2).
///   Holds within 10 % where nothing but the end touches bone. In a bore the bit rests on the fillet between floor and wall, which lags:
///   flat ends are slower than foretold; bits_drilling_test.cpp holds by how much. Round, pointed and thin-walled ends: an estimate, within
///   a factor of 2.
#pragma once

#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

struct FeedConditions {
  double thrust = 20.0;              ///< [N] along the feed
  double spin = 1000.0 / 60.0;       ///< [rev/s]
  double hardness = 1.0;             ///< h in (0, 1]
  double cutting_stiffness = 100e3;  ///< [N/m] K_cut; a scene's default
};

/// Along the shaft into bone (-z), or sideways (+x).
enum class FeedDirection { plunge, sideways };

struct FeedPrediction {
  double engaged = 0.0;  ///< [m] F / K_cut
  double speed = 0.0;    ///< [m/s] 0: a face that does not cut is ahead
  double area = 0.0;     ///< [m^2] of the cutting part, seen along the feed
  double rate = 0.0;     ///< [m^3/s]
};

/// Points above the highest and (sideways) below the lowest cutting point are left out: a shaft or a foot is taken to be clear of bone.
/// @pre conditions are finite and > 0. Linear in points; not for the servo path.
[[nodiscard]] FeedPrediction predict_feed(const Tool& tool, FeedDirection direction, const FeedConditions& conditions);

}  // namespace burrhole
