/// app/engine/run_log.h: what a run leaves behind while it goes: rows and events of the session, figures for plots, pictures at events.
///   Thread: one, that may wait and allocate: the lockstep's own, or the main thread of a live run. Never servo or contact.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/engine/drill_parts.h"
#include "app/engine/session.h"

namespace burrhole {

inline constexpr double kProgressEvery = 0.1;  ///< [s] between two reports of progress

/// One moment for plots, at contact rate.
struct RunSample {
  double time = 0.0;   ///< [s]
  double force = 0.0;  ///< [N] on the hand
  double depth = 0.0;  ///< [m] of the tip
};

/// What happened when, for people.
struct RunEvent {
  double time = 0.0;  ///< [s]
  std::string kind, text;
};

class RunLog {
 public:
  /// `parts` must outlive it. `gather` has the display's parcel filled (FrameStep::gather) by whoever owns the bone.
  RunLog(DrillParts& parts, SessionWriter* session, std::function<void()> gather)
      : parts_(&parts), session_(session), gather_(std::move(gather)) {}

  [[nodiscard]] SessionWriter* session() noexcept { return session_; }
  /// The hand, in each tick: says when it goes on to the next part of its script.
  [[nodiscard]] Status hand(const HandState& hand);
  /// A result of contact, in order: the sample, and what the tip has come to.
  [[nodiscard]] Status contact(const RunSample& sample, const DrillProgress& progress, const Pose& world_from_tool);
  [[nodiscard]] Status note(double time, const std::string& kind, const std::string& text);
  /// `world_from_tool`: nothing when it is out of the picture.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut);

  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return samples_; }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return events_; }

 private:
  DrillParts* parts_;
  SessionWriter* session_;
  std::function<void()> gather_;
  std::vector<RunSample> samples_;
  std::vector<RunEvent> events_;
  HandPhase phase_ = HandPhase::approach;
  bool drew_half_ = false, noted_passing_ = false, drew_breakthrough_ = false;
};

}  // namespace burrhole
