/// app/run/run_log.h: output during a run: rows and events of the session, samples for plots, pictures at events.
///   Frame  world.   Units  SI.   Errors  those of session and display; bad_input of redraw().
///   Thread  one that may wait and allocate: that of lockstep, or the main thread of a live run. Never servo or contact.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "app/stage/stage.h"

namespace burrhole {

inline constexpr double kProgressEvery = 0.1;  ///< [s] between two reports of progress

/// A sample for plots, at contact rate.
struct RunSample {
  double time = 0.0;   ///< [s]
  double force = 0.0;  ///< [N] on the hand
  double depth = 0.0;  ///< [m] of the tip below the entry, along the axis
};

/// An event of the run, for the report.
struct RunEvent {
  double time = 0.0;  ///< [s]
  std::string kind, text;
};

class RunLog {
 public:
  /// `parts` must outlive it. `gather` fills the display's batch (FrameStep::gather) on the thread that owns the bone.
  RunLog(Stage& parts, SessionWriter* session, std::function<void()> gather)
      : parts_(&parts), session_(session), gather_(std::move(gather)) {}

  [[nodiscard]] SessionWriter* session() noexcept { return session_; }
  /// Receives the hand in each tick; records an event when the hand enters the next phase of its script.
  [[nodiscard]] Status hand(const HandState& hand);
  /// Receives each contact result, in order: the sample, and the progress of the tip.
  [[nodiscard]] Status contact(const RunSample& sample, const DrillProgress& progress, const Pose& world_from_tool);
  [[nodiscard]] Status note(double time, const std::string& kind, const std::string& text);
  /// For a replay: draws a recorded picture; the bone must be at the picture's step. bad_input: the recorded view is damaged.
  [[nodiscard]] Status redraw(const SessionStill& still);
  /// Names and hashes of the pictures redrawn, in order.
  [[nodiscard]] const std::vector<SessionStill>& redrawn() const noexcept { return redrawn_; }
  /// Draws one picture; records it as a still if there is a session. @param world_from_tool absent: the tool is not drawn.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut);

  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return samples_; }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return events_; }

 private:
  Stage* parts_;
  SessionWriter* session_;
  std::function<void()> gather_;
  std::vector<RunSample> samples_;
  std::vector<RunEvent> events_;
  std::vector<SessionStill> redrawn_;
  HandPhase phase_ = HandPhase::approach;
  bool drew_half_ = false, noted_passing_ = false, drew_breakthrough_ = false;
};

}  // namespace burrhole
