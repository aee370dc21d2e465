#include "app/engine/run_log.h"

namespace burrhole {
namespace {

const char* name_of(HandPhase phase) {
  switch (phase) {
    case HandPhase::approach:
      return "approach";
    case HandPhase::lean:
      return "lean";
    case HandPhase::give_felt:
      return "give felt";
    case HandPhase::release:
      return "release";
    case HandPhase::withdraw:
      return "withdraw";
    case HandPhase::done:
      return "done";
  }
  return "";
}

}  // namespace

Status RunLog::hand(const HandState& hand) {
  if (hand.phase == phase_) return {};
  phase_ = hand.phase;
  return note(static_cast<double>(hand.tick) * parts_->period, "hand", name_of(phase_));
}

Status RunLog::contact(const RunSample& sample, const DrillProgress& progress, const Pose& world_from_tool) {
  samples_.push_back(sample);
  if (!drew_half_ && progress.depth > 0.5 * parts_->approach.thickness) {
    drew_half_ = true;
    if (Status drawn = draw("during", world_from_tool, false); !drawn) return drawn;
  }
  if (!noted_passing_ && progress.passed_time) {
    noted_passing_ = true;
    if (!progress.breakthrough_time)
      if (Status noted = note(sample.time, "passed", "the tip is beyond the bone, which is not cut through on the axis"); !noted)
        return noted;
  }
  if (!drew_breakthrough_ && progress.breakthrough_time) {
    drew_breakthrough_ = true;
    if (Status noted = note(sample.time, "breakthrough", "no bone ahead, and none behind but what the bit is engaged in"); !noted)
      return noted;
    return draw("breakthrough", world_from_tool, true);
  }
  return {};
}

Status RunLog::note(double time, const std::string& kind, const std::string& text) {
  events_.push_back({time, kind, text});
  if (session_ == nullptr) return {};
  return session_->event({time, static_cast<std::int64_t>(time / parts_->period + 0.5), kind, text, {}});
}

Status RunLog::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut) {
  if (!parts_->frame) return {};
  gather_();
  return parts_->frame->draw(name, world_from_tool, cut);
}

}  // namespace burrhole
