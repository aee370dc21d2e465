/// app/run/run_log.h: records what a run produces: events of the session, samples for plots, and pictures at events.
///   Frame  world.   Units  SI.   Errors  those of SessionWriter and of the display; redraw() also bad_input.
///   Thread  the lockstep thread or the main thread of a live run. It blocks and allocates: never call it from the servo or contact thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "app/stage/stage.h"
#include "core/measure/layer_loads.h"

namespace burrhole {

inline constexpr double kProgressEvery = 0.1;  ///< [s] of simulated time between two reports of progress

/// A sample for the plots, one per contact evaluation.
struct RunSample {
  double time = 0.0;   ///< [s]
  double force = 0.0;  ///< [N] magnitude of the force on the hand, before the force scale
  double depth = 0.0;  ///< [m] of the tip below the entry, along the approach axis
};

/// An event with its text for the report; also written to the session.
struct RunEvent {
  double time = 0.0;  ///< [s]
  std::string kind, text;
};

/// What a log keeps beyond events.
struct RunLogConfig {
  bool samples = true;         ///< record_contact() stores its samples
  bool event_pictures = true;  ///< record_contact() draws pictures at events
};

class RunLog {
 public:
  /// `parts` must outlive it. @param session null: nothing is written to a session. @param gather called before each picture: collects the
  /// changed texels (Stage::gather) on the thread that owns the bone, and returns when the batch is ready.
  RunLog(Stage& parts, SessionWriter* session, std::function<void()> gather, const RunLogConfig& keeps = {})
      : parts_(&parts), session_(session), gather_(std::move(gather)), keeps_(keeps), loads_(parts.approach) {}

  [[nodiscard]] SessionWriter* session() noexcept { return session_; }
  /// Call at each servo tick. Records an event when the hand enters the next phase of its script.
  [[nodiscard]] Status record_hand(const HandState& hand);
  /// Call with each contact result, in order. Stores the sample if samples are kept; draws a picture at half the thickness of bone and at breakthrough; records
  /// breakthrough, or that the tip passed uncut bone.
  [[nodiscard]] Status record_contact(const RunSample& sample, const DrillProgress& progress, const Pose& world_from_tool);
  [[nodiscard]] Status record_event(double time, const std::string& kind, const std::string& text);
  /// Call at each servo tick. Warns of latched faults and records them when they appear.
  [[nodiscard]] Status record_faults(std::uint32_t faults, double time, const std::function<void(const std::string&)>& warn);
  /// For a replay: draws the picture of a recorded still. The bone must be in the state of that still (SessionStill::bone_step). bad_input if
  /// the pose of the tool in the still cannot be parsed.
  [[nodiscard]] Status redraw(const SessionStill& still);
  /// Names and hashes of the pictures redrawn, in order.
  [[nodiscard]] const std::vector<SessionStill>& redrawn() const noexcept { return redrawn_; }
  /// Draws one picture; records it as a still if there is a session. @param world_from_tool absent: the tool is not drawn. @param cut whether
  /// the picture is clipped by the scene's cutting plane.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut);

  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return samples_; }
  [[nodiscard]] const std::vector<LayerLoad>& layer_loads() const noexcept { return loads_.loads(); }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return events_; }

 private:
  Stage* parts_;
  SessionWriter* session_;
  std::function<void()> gather_;
  RunLogConfig keeps_;
  LayerLoads loads_;
  std::vector<RunSample> samples_;
  std::vector<RunEvent> events_;
  std::vector<SessionStill> redrawn_;
  HandPhase phase_ = HandPhase::approach;
  std::uint32_t reported_faults_ = 0;
  bool drew_half_ = false, noted_passing_ = false, noted_breakthrough_ = false, drew_breakthrough_ = false;
};

}  // namespace burrhole
