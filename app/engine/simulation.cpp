#include "app/engine/simulation.h"

#include "app/engine/live_rows.h"
#include "app/engine/lockstep.h"
#include "app/engine/realtime.h"

namespace burrhole {
std::vector<SessionColumn> session_columns(const Scene& scene) {
  std::vector<SessionColumn> columns = hand_columns();
  if (scene.contact) {
    const std::vector<SessionColumn> tool = tool_columns();
    columns.insert(columns.end(), tool.begin(), tool.end());
  }
  if (scene.erosion) columns.push_back({"removed_mass", "m^3"});
  if (scene.spindle) columns.push_back({"spin", "rev/s"});
  return columns;
}

Simulation::Simulation(std::unique_ptr<DrillParts> parts, const SimulationOptions& options) : parts_(std::move(parts)), options_(options) {
  set_session(options.session);
}
Simulation::~Simulation() = default;

SessionLayout session_layout(const Scene& scene, bool live) {
  if (live) return {servo_columns(), live_streams()};
  return {session_columns(scene), {}};
}

std::unique_ptr<Simulation> Simulation::create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                               const SimulationOptions& options, Issues& issues) {
  if (options.live)
    if (const auto refused = refusal_of_live(scene)) {
      issues.push_back(bad_input(*refused, scene.file));
      return nullptr;
    }
  auto parts = DrillParts::make(scene, std::move(bone), tool, {options.sink, options.hand, options.restore_path});
  if (!parts) {
    Error error = parts.error();
    if (error.place.empty()) error.place = scene.file;
    issues.push_back(std::move(error));
    return nullptr;
  }
  return std::unique_ptr<Simulation>(new Simulation(std::move(parts).value(), options));
}

void Simulation::set_session(SessionWriter* session) {
  log_ = std::make_unique<RunLog>(*parts_, session, [this] {
    if (!desk_.fetch()) parts_->frame->gather(parts_->bone->turned());
  });
}

Status Simulation::run() {
  if (Status drawn = log_->draw("before", parts_->contact->state().world_from_tool, false); !drawn) return drawn;
  {
    const FlushToZero guard;
    if (Status ran = options_.live ? run_on_threads() : run_lockstep(); !ran) return ran;
  }
  parts_->voxmap->write_back();
  if (parts_->frame) parts_->frame->gather_rest(parts_->bone->turned());  // the last pictures show all that was done
  if (Status drawn = log_->draw("after", {}, false); !drawn) return drawn;
  return log_->draw("cutaway", {}, true);
}

Status Simulation::run_lockstep() {
  const Scene& scene = parts_->scene;
  const ContactTick& contact = *parts_->contact;
  const auto last = static_cast<std::uint64_t>(scene.duration * scene.servo_hz + 0.5);
  const auto progress_every = static_cast<std::uint64_t>(kProgressEvery * scene.servo_hz);
  Lockstep steps(*parts_);
  end_ = RunEnd::duration;
  while (tick_ < last) {
    servo_now_ = steps.tick();
    tick_ = steps.ticks();
    sent_.add(servo_now_.force);
    if (log_->session() != nullptr)
      if (Status recorded = timers_.record([&] { return record_row(); }); !recorded) return recorded;
    if (Status noted = log_->hand(servo_now_.hand); !noted) return noted;
    if (steps.looked()) {
      const RunSample sample{contact.time(), glm::length(contact.state().on_hand.force), contact.progress().depth};
      if (Status seen = log_->contact(sample, contact.progress(), contact.state().world_from_tool); !seen) return seen;
    }
    if (options_.progress && progress_every > 0 && tick_ % progress_every == 0) options_.progress(time(), progress());
    if (finished()) break;
  }
  timers_.servo = std::move(steps.timers().servo);
  if (scene.contact) timers_.contact = std::move(steps.timers().contact);
  return {};
}

Status Simulation::run_recorded(const SessionReader& session, RecordedHand& hand) {
  const auto progress_of = [&](double time) {
    if (options_.progress) options_.progress(time, progress());
  };
  auto replayed = replay_live(*parts_, hand, session, options_.stop, progress_of);
  if (!replayed) return replayed.error();
  tick_ = replayed->ticks;
  sent_ = replayed->sent;
  return {};
}

Status Simulation::run_on_threads() {
  live_.emplace();
  const LiveOptions options{options_.require_realtime, options_.stop, options_.progress, options_.warn};
  const Status ran = run_live(*parts_, *log_, options, desk_, *live_);
  tick_ = live_->ticks;
  servo_now_ = live_->last;
  end_ = live_->stopped ? RunEnd::stopped : live_->done ? RunEnd::done : RunEnd::duration;
  timers_.servo = live_->servo;
  if (parts_->scene.contact) timers_.contact = live_->contact_step;
  return ran;
}

bool Simulation::finished() {
  if (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed))
    end_ = RunEnd::stopped;
  else if (servo_now_.hand.phase == HandPhase::done)
    end_ = RunEnd::done;
  return end_ != RunEnd::duration;
}

Status Simulation::record_row() {
  const ContactState& contact = parts_->contact->state();
  const Vec3& t = contact.world_from_tool.translation;
  const Wrench& w = contact.on_hand;
  const auto hand = hand_values(servo_now_.hand);
  row_.assign(hand.begin(), hand.end());
  if (parts_->scene.contact)
    row_.insert(row_.end(), {t.x, t.y, t.z, w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z, contact.engagement,
                             static_cast<double>(contact.flags)});
  if (parts_->scene.erosion) row_.push_back(parts_->bone->removed_mass());
  if (parts_->scene.spindle) row_.push_back(parts_->bone->spin());
  return log_->session()->append(row_);
}

std::optional<std::uint64_t> Simulation::image_hash() const {
  return parts_->frame ? std::optional(parts_->frame->image_hash()) : std::nullopt;
}

}  // namespace burrhole
