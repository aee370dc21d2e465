#include "core/contact/tool_sweep.h"

namespace burrhole {

bool suppress_reversal(const SweptTool& tool, const Vec3& target, const Vec3& before, double voxel_edge) noexcept {
  Vec3 now(0.0);
  for (const HoldPlane& plane : tool.solver.planes()) now += plane.normal * plane.force;
  if (tool.law != nullptr) now += tool.tangential.on_tool().force;
  const Vec3 back = target - tool.position;
  if (glm::dot(now, before) >= 0.0 || glm::length(back) > kSuppressedReversal * voxel_edge) return false;
  tool.position += back;
  tool.since_look.translation += back;
  tool.since_look.engagement -= tool.engaged;
  tool.engaged = Vec3(0.0);
  tool.solver.clear();
  if (tool.law != nullptr) {
    tool.law->clear();
    tool.tangential.clear();
  }
  return true;
}

}  // namespace burrhole
