// Contact of a tool whose spin has ended in its hole.
#include <algorithm>
#include <utility>

#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

// [voxel edges] a deeper overlap is not one that drilling leaves: a tool cuts at most a voxel ahead, and distances are known so far
constexpr double kDeepest = kRecordBand - 1.0;

}  // namespace

SurfaceView ConstrainedTool::lying_in(const SurfaceView& bone) const noexcept {
  SurfaceView out = bone;
  out.records.lying = lying_;
  return out;
}

void ConstrainedTool::let_overlap_lie(const SurfaceView& bone, bool was_spinning) noexcept {
  const bool starts = spinning_ && !was_spinning;
  if (was_spinning && !spinning_) {
    engaged_at_stop_ = engaged_;
    stop_unseen_ = true;
  }
  if (starts && lying_ > 0.0) {
    // It engages again as far as it still reaches into bone: from the tool's pose it would engage anew, on top of that.
    const double before = glm::length(engaged_at_stop_), most = lying_ * edge_;
    engaged_ = before > most ? engaged_at_stop_ * (most / before) : engaged_at_stop_;
  }
  if (spinning_ || (lying_ == 0.0 && !stop_unseen_)) {
    lying_ = 0.0;
    stop_unseen_ = false;
    return;
  }
  hits_.clear(false);
  const Affine index_from_tool =
      bone.records.bone_from_index.inverse() * Affine::from_pose({bone_from_tool_.rotation, bone_from_tool_ * middle_});
  for (const ContactShellPart* part : {&points_.cutting, &points_.passive}) probe_surface(bone.records, *part, index_from_tool, 0.0, hits_);
  if (hits_.outside) return;
  const bool stops = std::exchange(stop_unseen_, false);
  double least = 0.0;
  for (std::size_t n = 0; n < hits_.count; ++n) least = std::min(least, static_cast<double>(hits_.distance[n]));
  if (!stops) {
    // What holds the tool may lie between its points.
    const PlaceFinder finder(surface_.get(), bone.records, bone_from_tool_);
    for (const HoldPlane& plane : solver_.planes())
      if (const auto place = finder.sample(plane.place)) least = std::min(least, place->gap / edge_);
  }
  lying_ = std::min(stops ? kDeepest : lying_, -least);
}

}  // namespace burrhole
