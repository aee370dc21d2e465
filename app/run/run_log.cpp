#include "app/run/run_log.h"

#include <cstring>

#include "core/base/hash.h"

namespace burrhole {
namespace {

const char* name_of(HandPhase phase) {
  switch (phase) {
    case HandPhase::approach:
      return "approach";
    case HandPhase::lean:
      return "lean";
    case HandPhase::give_felt:
      return "breakthrough detected";
    case HandPhase::release:
      return "release";
    case HandPhase::withdraw:
      return "withdraw";
    case HandPhase::done:
      return "done";
  }
  return "";
}

/// The view of a still: the inputs of the picture apart from the bone.
struct StillView {
  std::optional<Pose> world_from_tool;
  bool cut = false;
};

/// @returns eight doubles as raw memory: flags (1: with the tool, 2: cut), rotation w, x, y, z and translation [m] of the tool's pose.
std::string view_bytes(const StillView& view) {
  const Pose pose = view.world_from_tool.value_or(Pose{});
  const Quat& q = pose.rotation;
  const Vec3& t = pose.translation;
  const double values[] = {(view.world_from_tool ? 1.0 : 0.0) + (view.cut ? 2.0 : 0.0), q.w, q.x, q.y, q.z, t.x, t.y, t.z};
  return {reinterpret_cast<const char*>(values), sizeof values};
}

std::optional<StillView> view_from(const std::string& bytes) {
  double v[8];
  if (bytes.size() != sizeof v) return std::nullopt;
  std::memcpy(v, bytes.data(), sizeof v);
  if (!(v[0] >= 0.0 && v[0] <= 3.0)) return std::nullopt;
  const auto flags = static_cast<int>(v[0]);
  StillView out;
  if ((flags & 1) != 0) out.world_from_tool = Pose{Quat(v[1], v[2], v[3], v[4]), Vec3(v[5], v[6], v[7])};
  out.cut = (flags & 2) != 0;
  return out;
}

}  // namespace

Status RunLog::record_hand(const HandState& hand) {
  if (hand.phase == phase_) return {};
  phase_ = hand.phase;
  return record_event(static_cast<double>(hand.tick) * parts_->period, "hand", name_of(phase_));
}

Status RunLog::record_contact(const RunSample& sample, const DrillProgress& progress, const Pose& world_from_tool) {
  loads_.add(sample.depth, sample.force, sample.time);
  if (keeps_.samples) samples_.push_back(sample);
  if (!drew_half_ && progress.depth > 0.5 * parts_->approach.thickness) {
    drew_half_ = true;
    if (keeps_.event_pictures)
      if (Status drawn = draw("during", world_from_tool, false); !drawn) return drawn;
  }
  if (!noted_passing_ && progress.passed_time) {
    noted_passing_ = true;
    if (!progress.breakthrough_time)
      if (Status noted = record_event(sample.time, "passed", "no bone is left on the axis ahead of the tip, but some is left behind it");
          !noted)
        return noted;
  }
  if (!progress.breakthrough_time) noted_breakthrough_ = false;  // an undo
  if (!noted_breakthrough_ && progress.breakthrough_time) {
    noted_breakthrough_ = true;
    if (Status noted =
            record_event(sample.time, "breakthrough", "no bone ahead of the tip; behind it only the bone in which the bit is engaged");
        !noted)
      return noted;
    if (!keeps_.event_pictures || drew_breakthrough_) return {};
    drew_breakthrough_ = true;
    return draw("breakthrough", world_from_tool, true);
  }
  return {};
}

Status RunLog::record_faults(std::uint32_t faults, double time, const std::function<void(const std::string&)>& warn) {
  for (std::uint32_t fresh = faults & kServoLatched & ~reported_faults_; fresh != 0; fresh &= fresh - 1) {
    const std::string name = name_of(static_cast<ServoFault>(fresh & ~(fresh - 1)));
    if (warn) warn("servo: " + name + ": the force on the hand is zero from now on");
    if (Status noted = record_event(time, "fault", name); !noted) return noted;
  }
  reported_faults_ |= faults & kServoLatched;
  return {};
}

Status RunLog::record_event(double time, const std::string& kind, const std::string& text) {
  events_.push_back({time, kind, text});
  if (session_ == nullptr) return {};
  return session_->event({time, static_cast<std::int64_t>(time / parts_->period + 0.5), kind, text, {}});
}

Status RunLog::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut) {
  if (parts_->frame() == nullptr) return {};
  gather_();
  if (Status drawn = parts_->draw(name, world_from_tool, cut); !drawn) return drawn;
  if (session_ == nullptr) return {};
  return session_->still({static_cast<std::int64_t>(parts_->frame_step()), name, hash_text(parts_->frame()->picture_hash()),
                          view_bytes({world_from_tool, cut})});
}

Status RunLog::redraw(const SessionStill& still) {
  if (parts_->frame() == nullptr) return {};
  const auto view = view_from(still.view);
  if (!view) return bad_input("the view of the still \"" + still.name + "\" cannot be read");
  parts_->gather(true);
  if (Status drawn = parts_->draw(still.name, view->world_from_tool, view->cut); !drawn) return drawn;
  redrawn_.push_back({still.bone_step, still.name, hash_text(parts_->frame()->picture_hash()), still.view});
  return {};
}

}  // namespace burrhole
