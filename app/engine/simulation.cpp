#include "app/engine/simulation.h"

namespace burrhole {
namespace {

constexpr double kProgressEvery = 0.1;  // [s]

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

std::vector<SessionColumn> session_columns(const Scene& scene) {
  std::vector<SessionColumn> columns{{"hand_x", "m"},    {"hand_y", "m"}, {"hand_z", "m"},  {"hand_vx", "m/s"}, {"hand_vy", "m/s"},
                                     {"hand_vz", "m/s"}, {"hand_qw", ""}, {"hand_qx", ""},  {"hand_qy", ""},    {"hand_qz", ""},
                                     {"thrust", "N"},    {"phase", ""},   {"hand_tick", ""}};
  if (scene.contact)
    columns.insert(columns.end(), {{"tool_x", "m"},
                                   {"tool_y", "m"},
                                   {"tool_z", "m"},
                                   {"force_x", "N"},
                                   {"force_y", "N"},
                                   {"force_z", "N"},
                                   {"torque_x", "N m"},
                                   {"torque_y", "N m"},
                                   {"torque_z", "N m"},
                                   {"engagement", "m"},
                                   {"flags", ""}});
  if (scene.erosion) columns.push_back({"removed_mass", "m^3"});
  if (scene.spindle) columns.push_back({"spin", "rev/s"});
  return columns;
}

Simulation::Simulation(const Scene& scene, const Tool& tool, const SimulationOptions& options)
    : scene_(scene), tool_(&tool), options_(options) {}
Simulation::~Simulation() = default;

std::unique_ptr<Simulation> Simulation::create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                               const SimulationOptions& options, Issues& issues) {
  std::unique_ptr<Simulation> out(new Simulation(scene, tool, options));
  if (Status built = out->build(std::move(bone)); !built) {
    Error error = built.error();
    if (error.place.empty()) error.place = scene.file;
    issues.push_back(std::move(error));
    return nullptr;
  }
  return out;
}

Status Simulation::build(std::shared_ptr<const BoneModel> bone) {
  period_ = 1.0 / scene_.servo_hz;
  contact_every_ = scene_.contact ? static_cast<std::uint64_t>(scene_.servo_hz / scene_.contact->rate_hz) : 1;
  bone_every_ = scene_.erosion ? static_cast<std::uint64_t>(scene_.servo_hz / scene_.erosion->rate_hz) : 4;
  latency_ =
      scene_.contact && scene_.contact->latency_ticks >= 0 ? static_cast<std::uint64_t>(scene_.contact->latency_ticks) : contact_every_;
  in_flight_.resize(latency_ + 1);

  auto approach = make_approach(*bone, scene_.approach);
  if (!approach) return Error{approach.error().code, approach.error().message, scene_.approach.place};
  approach_ = std::move(approach).value();
  monitor_.emplace(approach_);

  auto voxmap = Voxmap::create(bone, {static_cast<float>(scene_.volume.gradient_dead_zone)});
  if (!voxmap) return voxmap.error();
  voxmap_ = std::make_unique<Voxmap>(std::move(voxmap).value());
  if (!options_.restore_path.empty())
    if (Status restored = voxmap_->restore(options_.restore_path); !restored) return restored;

  const Pose world_from_approach = scene_.volume.world_from_bone * approach_.bone_from_approach;
  if (options_.hand == nullptr) {
    auto hand = SimulatedHand::create(scene_.hand, world_from_approach, period_);
    if (!hand) return hand.error();
    own_hand_.emplace(std::move(hand).value());
  }
  const Pose start{world_from_approach.rotation, world_from_approach * Vec3(0.0, 0.0, scene_.hand.standoff)};
  servo_ =
      std::make_unique<ServoStep>(ServoConfig{}, options_.hand != nullptr ? *options_.hand : *own_hand_, force_mailbox_, hand_mailbox_);

  auto bone_step = BoneStep::create(scene_, *tool_, *voxmap_, start);
  if (!bone_step) return Error{bone_step.error().code, bone_step.error().message, scene_.tool.place};
  bone_.emplace(std::move(bone_step).value());
  if (scene_.contact) {
    auto contact = ContactStep::create(*scene_.contact, tool_->shell, bone->bone_from_index().mean_edge(), scene_.tool.spin > 0.0);
    if (!contact) return contact.error();
    contact_.emplace(std::move(contact).value());
    contact_->place(start);
  }
  contact_now_.world_from_tool = start;
  if (scene_.display && options_.sink != nullptr) {
    auto frame = FrameStep::create(scene_, approach_, *tool_, *voxmap_, *options_.sink);
    if (!frame) return frame.error();
    frame_.emplace(std::move(frame).value());
  }
  return {};
}

void Simulation::deliver_due() {
  // A result computed from the motion at the end of tick t reaches the servo at tick t + 1 + latency.
  if (tick_ <= latency_) return;
  const ContactState& due = in_flight_[(tick_ - 1 - latency_) % in_flight_.size()];
  force_mailbox_.publish(due);
}

void Simulation::run_contact() {
  const HandState& hand = hand_mailbox_.latest();
  const ContactBone bone{&bone_->publisher().exchange(), bone_->grids(), voxmap_->bone().bone_from_index(), scene_.volume.world_from_bone};
  const BoneView view = bone.view();
  if (contact_) {
    contact_now_ = timers_.contact([&] { return (*contact_)(view, hand, period_ * static_cast<double>(contact_every_)); });
  } else {
    contact_now_.world_from_tool = hand.world_from_hand;  // no [contact]: nothing is felt, the tool goes where the hand goes
    contact_now_.tick = hand.tick;
  }
  flags_seen_ |= contact_now_.flags;
  thrust_sum_ += contact_now_.cutting_force;
  ++thrust_count_;
  force_hash_.add(contact_now_.on_hand.force);
  force_hash_.add(contact_now_.on_hand.torque);
  const Vec3 tip = scene_.volume.world_from_bone.inverse() * contact_now_.world_from_tool.translation;
  monitor_->look(view.voxels, tip, contact_now_.on_hand.force, contact_now_.engagement, static_cast<double>(tick_ + 1) * period_);
  samples_.push_back({static_cast<double>(tick_ + 1) * period_, glm::length(contact_now_.on_hand.force), monitor_->progress().depth});
}

void Simulation::run_bone() {
  // The mean over the step: one sample of a force that rings would alias into what is cut. No contact in this step: the last force holds.
  if (thrust_count_ > 0) thrust_ = thrust_sum_ / static_cast<double>(thrust_count_);
  thrust_sum_ = 0.0;
  thrust_count_ = 0;
  (*bone_)(contact_now_.world_from_tool, thrust_, period_ * static_cast<double>(bone_every_));
}

Status Simulation::run() {
  if (Status drawn = draw("before", true, false); !drawn) return drawn;
  const auto last = static_cast<std::uint64_t>(scene_.duration * scene_.servo_hz + 0.5);
  const auto progress_every = static_cast<std::uint64_t>(kProgressEvery * scene_.servo_hz);
  end_ = RunEnd::duration;
  while (tick_ < last) {
    deliver_due();
    servo_now_ = timers_.servo([&] { return (*servo_)(); });
    if (tick_ % contact_every_ == 0) run_contact();
    in_flight_[tick_ % in_flight_.size()] = contact_now_;
    ++tick_;
    if (tick_ % bone_every_ == 0) run_bone();
    if (Status status = after_tick(); !status) return status;
    if (options_.progress && progress_every > 0 && tick_ % progress_every == 0) options_.progress(time(), monitor_->progress());
    if (finished()) break;
  }
  voxmap_->write_back();
  if (Status drawn = draw("after", false, false); !drawn) return drawn;
  return draw("cutaway", false, true);
}

bool Simulation::finished() {
  if (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed))
    end_ = RunEnd::stopped;
  else if (servo_now_.hand.phase == HandPhase::done)
    end_ = RunEnd::done;
  return end_ != RunEnd::duration;
}

Status Simulation::after_tick() {
  if (options_.session != nullptr)
    if (Status recorded = timers_.record([&] { return record_row(); }); !recorded) return recorded;
  if (servo_now_.hand.phase != phase_seen_) {
    phase_seen_ = servo_now_.hand.phase;
    if (Status noted = note("hand", name_of(phase_seen_)); !noted) return noted;
  }
  const DrillProgress& progress = monitor_->progress();
  if (!drew_half_ && progress.depth > 0.5 * approach_.thickness) {
    drew_half_ = true;
    if (Status drawn = draw("during", true, false); !drawn) return drawn;
  }
  if (!noted_passing_ && progress.passed_time) {
    noted_passing_ = true;
    if (!progress.breakthrough_time)
      if (Status noted = note("passed", "the tip is beyond the bone, which is not cut through on the axis"); !noted) return noted;
  }
  if (!drew_breakthrough_ && progress.breakthrough_time) {
    drew_breakthrough_ = true;
    if (Status noted = note("breakthrough", "no bone ahead, and none behind but what the bit is engaged in"); !noted) return noted;
    if (Status drawn = draw("breakthrough", true, true); !drawn) return drawn;
  }
  return {};
}

Status Simulation::record_row() {
  const HandState& hand = servo_now_.hand;
  const Vec3& h = hand.world_from_hand.translation;
  const Vec3& t = contact_now_.world_from_tool.translation;
  const Wrench& w = contact_now_.on_hand;
  const Quat& q = hand.world_from_hand.rotation;
  row_ = {h.x,
          h.y,
          h.z,
          hand.velocity.x,
          hand.velocity.y,
          hand.velocity.z,
          q.w,
          q.x,
          q.y,
          q.z,
          hand.thrust,
          static_cast<double>(hand.phase),
          static_cast<double>(hand.tick)};
  if (contact_)
    row_.insert(row_.end(), {t.x, t.y, t.z, w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z, contact_now_.engagement,
                             static_cast<double>(contact_now_.flags)});
  if (scene_.erosion) row_.push_back(bone_->removed_mass());
  if (scene_.spindle) row_.push_back(bone_->spin());
  return options_.session->append(row_);
}

Status Simulation::note(const std::string& kind, const std::string& text) {
  events_.push_back({time(), kind, text});
  if (options_.session == nullptr) return {};
  return options_.session->event({time(), static_cast<std::int64_t>(tick_), kind, text, {}});
}

Status Simulation::draw(const std::string& name, bool with_tool, bool cut) {
  if (!frame_) return {};
  return frame_->draw(name, with_tool ? std::optional(contact_now_.world_from_tool) : std::nullopt, cut);
}

std::optional<std::uint64_t> Simulation::image_hash() const { return frame_ ? std::optional(frame_->image_hash()) : std::nullopt; }

}  // namespace burrhole
