#include "app/stage/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/stage/force_loop.h"
#include "app/stage/free_place.h"
#include "core/drill/removal_rate.h"
#include "haptics/hand/taken_hand.h"
#include "haptics/servo/contact_age.h"

namespace burrhole {
ServoConfig servo_config(const StageConfig& config, const Needs& needs, double voxel_edge) {
  const int contact_hz = needs.contact_hz > 0 ? needs.contact_hz : config.servo_hz;
  ServoConfig out = needs.servo;
  out.period = 1.0 / config.servo_hz;
  out.multi_rate.contact_ticks = std::max(1, config.servo_hz / contact_hz);
  out.multi_rate.max_distance = std::min(out.multi_rate.max_distance, needs.plane_reach_voxels * voxel_edge);
  if (!needs.feels) return out;
  out.swing = swing_config(config, needs);
  out.energy = energy_config(config, needs);
  out.max_contact_age = contact_age_limit(out.multi_rate.contact_ticks, out.period);
  // A latency set by the scene makes results old by design; this is not an error.
  if (needs.latency_ticks > 0) out.max_contact_age += static_cast<std::uint64_t>(needs.latency_ticks);
  return out;
}

HandConfig hand_config(const StageConfig& config, const Needs& needs, const Tool& tool, double voxel_edge) {
  constexpr double kVoxelPart = 0.4;  // [-] of a voxel edge, by which a point falls at most when a voxel breaks away: 0.32 seen
  HandConfig out = config.hand;
  if (!(needs.holds_back && needs.removes && config.tool.spin > 0.0)) return out;
  out.cut_compliance = 1.0 / needs.cutting_stiffness;
  out.softest *= feed_beside_pore(tool);
  out.rough_drop = kVoxelPart * voxel_edge * needs.coupling_stiffness;
  out.exit_drop = needs.coupling_stiffness / (needs.coupling_stiffness + needs.cutting_stiffness);
  out.watches_drill = needs.felt_hardness > 0.0;
  return out;
}

Result<std::unique_ptr<HandSource>> make_hand(const StageConfig& config, const Needs& needs, const Tool& tool, double voxel_edge,
                                              const Pose& world_from_approach, GoalMailbox* goals) {
  const double period = 1.0 / config.servo_hz;
  if (config.goal_hand) {
    if (goals == nullptr) return Error{ErrorCode::unavailable, "hand.kind = \"mouse\" needs the window, with a person at it", {}};
    auto hand = GoalHand::create(*config.goal_hand, world_from_approach, period, *goals);
    if (!hand) return hand.error();
    return std::unique_ptr<HandSource>(std::make_unique<GoalHand>(std::move(hand).value()));
  }
  if (config.feed_hand) {
    FeedHandConfig feed = *config.feed_hand;
    if (needs.holds_back) feed.compliance = 1.0 / needs.coupling_stiffness;
    auto hand = FeedHand::create(feed, world_from_approach, period);
    if (!hand) return hand.error();
    return std::unique_ptr<HandSource>(std::make_unique<FeedHand>(std::move(hand).value()));
  }
  auto hand = SimulatedHand::create(hand_config(config, needs, tool, voxel_edge), world_from_approach, period);
  if (!hand) return hand.error();
  if (goals == nullptr) return std::unique_ptr<HandSource>(std::make_unique<SimulatedHand>(std::move(hand).value()));
  auto taken = TakenHand::create(*hand, {}, world_from_approach, period, *goals);
  if (!taken) return taken.error();
  return std::unique_ptr<HandSource>(std::make_unique<TakenHand>(std::move(taken).value()));
}

/// @returns a result as seen from the bone at rest: the simulation moves the tool about a bone that stays in place.
ContactState seen_at_rest(const ContactState& found) noexcept {
  const Pose rest_from_world = found.bone.world_from_rest.inverse();
  ContactState out = found;
  out.world_from_tool = rest_from_world * found.world_from_tool;
  out.world_from_hand = rest_from_world * found.world_from_hand;
  out.hand_velocity = rest_from_world.rotate(found.hand_velocity - found.bone.velocity_at(found.world_from_hand.translation));
  out.on_hand = {rest_from_world.rotate(found.on_hand.force), rest_from_world.rotate(found.on_hand.torque)};
  return out;
}

Stage::Stage(const StageConfig& from, const Needs& asked, const Tool& with, const Outside& outside)
    : config(from), tool(&with), needs(asked), period(1.0 / from.servo_hz), outside_(outside) {
  const auto ticks = [&](int rate_hz) { return static_cast<std::uint64_t>(config.servo_hz / rate_hz); };
  if (needs.contact_hz > 0) contact_every = ticks(needs.contact_hz);
  if (needs.simulation_hz > 0) bone_every = ticks(needs.simulation_hz);
  contact_period = period * static_cast<double>(contact_every);
  bone_period = period * static_cast<double>(bone_every);
  latency = needs.latency_ticks >= 0 ? static_cast<std::uint64_t>(needs.latency_ticks) : contact_every;
}

Stage::~Stage() = default;

Result<std::unique_ptr<Stage>> Stage::make(const StageConfig& config, const EffectPlans& plans, std::shared_ptr<const BoneModel> bone,
                                           const Tool& tool, const Outside& outside) {
  std::unique_ptr<Stage> out(new Stage(config, plans.needs(config), tool, outside));
  if (Status built = out->build(plans, std::move(bone)); !built) return built.error();
  return out;
}

Status Stage::build_hand() {
  if (outside_.hand != nullptr) {
    hand = outside_.hand;
  } else if (offered_hand_ != nullptr) {
    hand = offered_hand_;
  } else {
    auto created = make_hand(config, needs, *tool, voxel_edge(), world_from_approach(), outside_.goals);
    if (!created) return created.error();
    own_hand_ = std::move(created).value();
    hand = own_hand_.get();
  }
  return {};
}

Status Stage::build(const EffectPlans& plans, std::shared_ptr<const BoneModel> model) {
  auto found = make_approach(*model, config.approach);
  if (Status read = model->read_status(); !read) return read;
  if (!found) return Error{found.error().code, found.error().message, config.approach.place};
  approach = std::move(found).value();

  auto made = Voxmap::create(model, {static_cast<float>(config.volume.gradient_dead_zone)});
  if (!made) return made.error();
  voxmap = std::make_unique<Voxmap>(std::move(made).value());
  if (!outside_.restore_path.empty())
    if (Status restored = voxmap->restore(outside_.restore_path); !restored) return restored;

  if (outside_.history) {
    auto kept = BoneHistory::create(*voxmap, {.preallocate = true});
    if (!kept) return kept.error();
    history_ = std::move(kept).value();
  }
  for (const EffectPlans::Item& item : plans.items()) {
    auto effect = item.plan->make(*this);
    if (!effect) return effect.error();
    effects_.push_back({item.table, std::move(effect).value()});
  }
  if (frame_ != nullptr)
    for (const MadeEffect& one : effects_)
      if (PictureSource* source = one.effect->picture_source()) frame_->add(*source);
  if (Status held = build_hand(); !held) return held;
  const ServoConfig limits = servo_config(config, needs, voxel_edge());
  if (Status valid = check(limits); !valid) return valid;
  servo.emplace(limits, *hand, force_mailbox, hand_mailbox);

  const Pose start{world_from_approach().rotation, world_from_approach() * Vec3(0.0, 0.0, config.hand.standoff)};
  if (needs.feels) coarse_ = std::make_unique<CoarseDistance>(*model);
  auto step = BoneStep::create(config, needs, *tool, *voxmap, world_from_rest_.inverse() * start, graph, approach, coarse_.get(),
                               outside_.one_thread);
  if (!step) return Error{step.error().code, step.error().message, config.tool.place};
  bone.emplace(std::move(step).value());
  if (outside_.runs) bone->publish();
  contact.emplace(graph, approach,
                  ContactTickConfig{{bone->publisher() != nullptr ? &bone->publisher()->exchange() : nullptr, bone->grids(), bone->axis(),
                                     model->bone_from_index(), config.volume.world_from_bone, coarse_.get()},
                                    period,
                                    contact_period});
  if (voxmap->starts_drilled()) {
    const std::vector<std::uint8_t> axis = bone_on_axis(approach, *voxmap);
    if (bone->axis() != nullptr) bone->axis()->set(axis);
    contact->bone_starts(axis);
  }
  if (Status bound = bind(); !bound) return Error{bound.error().code, bound.error().message, config.file};
  contact->place(start);
  place_effects(start);
  return model->read_status();
}

void Stage::place_effects(const Pose& world_from_tool) {
  for (const MadeEffect& made : effects_) made.effect->place(world_from_tool);
}

Status Stage::place(const Pose& world_from_tool) {
  contact->place(world_from_tool);
  place_effects(world_from_tool);
  const ContactState& last = contact->state();
  return bone->place((last.number > 0 ? last.bone.world_from_rest : world_from_rest_).inverse() * world_from_tool);
}

Status Stage::bind() {
  for (const MadeEffect& made : effects_)
    if (Status bound = made.effect->bind(graph); !bound) return bound;
  hand_slot_ = graph.is_read(slots::kHand.name) ? graph.provide(Clock::servo, slots::kHand) : nullptr;
  picture_slot_ = graph.provide(Clock::frame, slots::kPicture);
  picture_error_ = graph.provide(Clock::frame, slots::kPictureError);
  graph.reads(Clock::servo, slots::kAddedForce);
  graph.reads(Clock::contact, slots::kContact);
  graph.reads(Clock::simulation, slots::kSpin);
  graph.reads(Clock::simulation, slots::kRemoval);
  bone_slot_ = graph.is_read(slots::kBone.name) ? graph.provide(Clock::simulation, slots::kBone) : nullptr;
  added_force_ = graph.is_written(slots::kAddedForce.name) ? graph.find(slots::kAddedForce) : nullptr;
  if (added_force_ != nullptr || contact->bone_moves()) hand->watch_drill();
  contact->bind();
  bone->bind();
  if (bone->axis() != nullptr && graph.is_read(slots::kTouch.name))
    return bad_input("a step reads \"touch\", but no effect requires a copy of bone (Needs::reads_window)");
  return graph.resolve();
}

void Stage::watch_spin(double command) {
  const bool spins = command > 0.0 && config.tool.spin > 0.0;
  if (spins && !spun_) history_->begin_step();
  if (!spins && spun_) history_->end_step();
  spun_ = spins;
}

void Stage::cut(const ContactState& found) {
  if (history_) watch_spin(found.spin);
  if (contact->bone_moves()) {
    if (bone_slot_ != nullptr) *bone_slot_ = found.bone;
    (*bone)(seen_at_rest(found), thrust_(found), bone_period);
    return;
  }
  (*bone)(found, thrust_(found), bone_period);
}

Status Stage::bone_was_changed() {
  spun_ = false;
  const std::vector<std::uint8_t> on_axis = bone_on_axis(approach, *voxmap);
  contact->bone_grew(on_axis);
  bone->publish();
  if (AxisBone* const axis = bone->axis()) axis->set(on_axis);
  if (Status placed = free_tool(); !placed) return placed;
  servo->restart();
  notify_hand();
  return {};
}

Status Stage::free_tool() {
  const ContactState& now = contact->state();
  // Without a pose of its own the tool is where the hand is.
  const bool own_pose = needs.holds_back || now.world_from_tool.translation != now.world_from_hand.translation;
  if (!own_pose) {
    place_effects(now.world_from_tool);
    return {};
  }
  const Pose world_from_bone = (now.number > 0 ? now.bone.world_from_rest : world_from_rest_) * config.volume.world_from_bone;
  const double from = std::max(0.0, contact->progress().depth) + config.hand.standoff;
  const Pose free = place_free_of_bone(*voxmap, world_from_bone, *tool, now.world_from_tool, from);
  if (free.translation != now.world_from_tool.translation) return place(free);
  place_effects(free);
  return {};
}

void Stage::notify_hand() { hand->scene_changed(hand_config(config, needs, *tool, voxel_edge()).softest); }

Status Stage::change_tool(const Tool& other) {
  const ContactState before = contact->state();
  tool = &other;
  for (const MadeEffect& made : effects_)
    if (Status changed = made.effect->change_tool(*this); !changed) return changed;
  StepGraph old = std::move(graph);
  graph = StepGraph();
  if (Status changed = bone->change_tool(other); !changed) return changed;
  if (Status bound = bind(); !bound) return bound;
  graph.keep_timings(old);
  contact->resume(before);
  if (Status placed = free_tool(); !placed) return placed;
  servo->restart();
  notify_hand();
  return frame_ != nullptr ? frame_->change_tool(other) : Status();
}

Result<bool> Stage::undo() {
  if (!history_ || !history_->undo()) return false;
  if (Status changed = bone_was_changed(); !changed) return changed.error();
  return true;
}

Status Stage::reset() {
  if (!history_) return bad_input("reset: this run keeps no history");
  history_->reset();
  return bone_was_changed();
}

Status Stage::checkpoint(const std::string& name) {
  if (!history_) return bad_input("checkpoint: this run keeps no history");
  return history_->checkpoint(name);
}

Status Stage::restore(const std::string& name) {
  if (!history_) return bad_input("restore: this run keeps no history");
  if (Status restored = history_->restore(name); !restored) return restored;
  return bone_was_changed();
}

const ServoOutput& Stage::act() noexcept {
  hand->bone_ahead(contact->bone_ahead());
  if (hand_slot_ == nullptr && graph.empty(Clock::servo)) return servo->act();
  if (hand_slot_ != nullptr) *hand_slot_ = servo->hand();
  graph.receive(Clock::servo);
  graph.run_steps(Clock::servo, {servo_tick_++, period});
  // The contact state is taken before the message is sent. Otherwise a result that depends on this tick's message could reach this tick.
  const ServoOutput& out = added_force_ != nullptr ? servo->act(*added_force_) : servo->act();
  graph.send(Clock::servo);
  return out;
}

void Stage::gather(bool all) {
  if (frame_ == nullptr) return;
  gathered_ = bone->steps();
  graph.receive(Clock::frame);  // with the bone that the picture shows
  if (all)
    frame_->gather_rest(bone->turned());
  else
    frame_->gather(bone->turned());
}

Status Stage::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool opened) {
  return draw_picture({.name = &name, .world_from_tool = world_from_tool, .cut = opened});
}

Status Stage::film(const Pose& world_from_tool) { return draw_picture({.world_from_tool = world_from_tool, .film = true}); }

Status Stage::draw_picture(const Picture& picture) {
  *picture_slot_ = picture;
  Status drawn;
  *picture_error_ = &drawn;
  graph.run_steps(Clock::frame, {pictures_++, 0.0});
  return drawn;
}

void Stage::warn(std::vector<std::string>& out) const {
  for (const MadeEffect& made : effects_) made.effect->warn(out);
  if (const Swing& swing = servo->swing(); swing.force > 0.0)
    out.push_back(
        fmt::format("servo: the force on the hand swung by {:.3g} N at {:.0f} Hz from {:.3f} s on: a limit cycle of the loop of hand "
                    "and contact",
                    swing.force, swing.frequency, static_cast<double>(swing.tick) * period));
}

std::optional<double> Stage::figure(std::string_view table, std::string_view name) const {
  for (const MadeEffect& made : effects_) {
    if (made.table != table) continue;
    Figures figures;
    made.effect->report(figures);
    for (const auto& [key, value] : figures.rows()) {
      if (key != name) continue;
      if (const auto* number = std::get_if<double>(&value)) return *number;
      if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
    }
  }
  return std::nullopt;
}

}  // namespace burrhole
