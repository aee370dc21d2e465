/// core/contact/tool_candidates.h: the hits of the last probe as candidate planes of the constrained tool's hold problem.
///   Frame  bone, as constrained_tool.h.   Units  SI.   Errors  none.   Thread  contact; never allocates.
///   Where the tool's surface is known, bone between shell points is a candidate as well: a hit whose cell may hold deeper bone is searched
///   once (contact_place.h), and the place found stands for the hit.
#pragma once

#include <array>

#include "core/contact/constrained_tool.h"
#include "core/contact/worst_hit.h"

namespace burrhole {

class ConstrainedTool::Candidates final : public HoldCandidates {
 public:
  Candidates(ConstrainedTool& tool, const SurfaceView& bone, bool spinning) noexcept;
  ~Candidates() override {
    for (std::size_t n = 0; n < masked_; ++n) restore(n);
  }
  Candidates(const Candidates&) = delete;
  Candidates& operator=(const Candidates&) = delete;

  std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                         std::span<const HoldPlane> kept) noexcept override;
  [[nodiscard]] HoldPlane plane_of(std::size_t hit) const noexcept;

 private:
  [[nodiscard]] PointMotion motion(const HoldMove& move, const Vec3& shift) const noexcept;
  [[nodiscard]] std::optional<WorstHit> worst_hit(const HoldProblem& problem, const HoldMove& move) const noexcept;
  /// The most violated place that was searched; null when none is below -tolerance.
  [[nodiscard]] SearchedPlaces::Place* worst_place(const HoldProblem& problem, const HoldMove& move,
                                                   std::span<const HoldPlane> kept) noexcept;
  [[nodiscard]] bool same_place(const HoldPlane& plane, const ContactPlace& place) const noexcept;
  /// [m] Gap of a place after the move.
  [[nodiscard]] double after(const ContactPlace& place, const HoldMove& move) const noexcept;
  [[nodiscard]] HoldPlane plane_at(SearchedPlaces::Place& place) const noexcept;
  /// Searches the cell of a hit and hides the hit. @returns false when no more places fit.
  bool search(std::size_t hit) noexcept;
  /// A kept plane yields under its own load, so the search must skip it.
  void mask_kept(std::span<const HoldPlane> kept) noexcept;
  void unmask_dropped(std::span<const HoldPlane> kept) noexcept;
  void restore(std::size_t n) noexcept { distances()[hidden_[n].hit] = hidden_[n].distance; }
  [[nodiscard]] float* distances() const noexcept {
    ProbeHits& hits = tool_->hits_;
    return hits.lowered ? hits.lower.data() : hits.distance.data();
  }

  struct Hidden {
    std::size_t hit;
    float distance;
  };
  ConstrainedTool* tool_;
  const SurfaceView* bone_;
  bool spinning_;
  Mat3 axes_;  // of the tool, bone frame
  PlaceFinder finder_;
  std::array<Hidden, kMaxHoldPlanes> hidden_{};
  std::size_t masked_ = 0;
};

}  // namespace burrhole
