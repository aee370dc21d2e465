#include "app/run/simulation.h"

#include "app/run/effect_events.h"
#include "app/scene/load.h"
#include "app/view/frame_step.h"
#include "haptics/servo/realtime.h"

namespace burrhole {
namespace {

Error not_for_runs() { return {ErrorCode::internal, "the simulation was built without the bone that contact reads", {}}; }

}  // namespace

Simulation::Simulation(std::unique_ptr<Stage> parts, const SimulationOptions& options) : parts_(std::move(parts)), options_(options) {
  set_session(options.session);
}
Simulation::~Simulation() = default;

std::unique_ptr<Simulation> Simulation::create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                               const SimulationOptions& options, Issues& issues) {
  if (options.live)
    if (const Needs needs = scene.effects.needs(scene); !needs.not_live.empty()) {
      issues.push_back(bad_input(needs.not_live, scene.file));
      return nullptr;
    }
  auto parts = Stage::make(scene, scene.effects, std::move(bone), tool,
                           {.sink = options.sink,
                            .hand = options.hand,
                            .goals = options.user != nullptr ? &options.user->goals() : nullptr,
                            .restore_path = options.restore_path,
                            .history = options.history,
                            .sound = options.sound,
                            .one_thread = !options.live,
                            .runs = options.runs});
  if (!parts) {
    Error error = parts.error();
    if (error.place.empty()) error.place = scene.file;
    issues.push_back(std::move(error));
    return nullptr;
  }
  std::unique_ptr<Simulation> out(new Simulation(std::move(parts).value(), options));
  const auto* display = scene.find<DisplayConfig>();
  out->has_overview_ = display != nullptr && display->overview.has_value();
  return out;
}

double charged_us(std::span<const TimedStep> steps, std::string_view table) noexcept {
  double sum = 0.0;
  for (const TimedStep& step : steps) {
    if (step.table == table && !step.within_step) sum += step.timing.total_us;
    if (step.part_of == table) sum -= step.timing.total_us;
  }
  return sum;
}

void Simulation::set_session(SessionWriter* session) {
  const auto gather = [this] {
    // A recorded still shows every change up to its step, so it ignores the display's budget.
    if (!hand_off_.fetch(log_->session() != nullptr)) parts_->gather(log_->session() != nullptr);
  };
  log_ = std::make_unique<RunLog>(*parts_, session, gather,
                                  RunLogConfig{.samples = options_.samples, .event_pictures = options_.user == nullptr});
}

Status Simulation::run() {
  if (!options_.runs) return not_for_runs();
  if (has_overview_)
    if (Status drawn = log_->draw(kOverview, parts_->contact->state().world_from_tool, false); !drawn) return drawn;
  if (Status drawn = log_->draw("before", parts_->contact->state().world_from_tool, false); !drawn) return drawn;
  Status ran;
  {
    const FlushToZero guard;
    ran = options_.live ? run_on_threads() : run_lockstep();
  }
  if (!ran) end_ = RunEnd::stopped;
  if (Status read = parts_->voxmap->bone().read_status(); !read) return read;
  parts_->voxmap->write_back();
  parts_->gather(true);  // the last pictures show every change
  if (ran) ran = log_->draw("after", {}, false);
  if (ran) ran = log_->draw("cutaway", {}, true);
  const Status read = parts_->voxmap->bone().read_status();
  return read ? ran : read;
}

Status Simulation::run_lockstep() {
  const StageConfig& config = parts_->config;
  const ContactTick& contact = *parts_->contact;
  const auto last = static_cast<std::uint64_t>(config.duration * config.servo_hz + 0.5);
  const auto progress_every = static_cast<std::uint64_t>(kProgressEvery * config.servo_hz);
  const std::uint64_t film_every = film_ticks();
  Lockstep steps(*parts_);
  EffectEvents events(parts_->graph);
  end_ = RunEnd::duration;
  while (tick_ < last) {
    if (Status applied = apply_inputs(tick_); !applied) return applied;
    // In a tick contact runs before bone, so it reads the newest copy. ContactTick::window() is not valid with storage "vdb".
    const std::uint64_t window = parts_->bone->published();
    servo_now_ = steps.tick();
    tick_ = steps.ticks();
    sent_.add(servo_now_.force);
    if (log_->session() != nullptr) {
      StepTimer* const timer = parts_->record_timer();
      const auto record = [&] { return record_rows(steps, window); };
      if (Status recorded = timer != nullptr ? (*timer)(record) : record(); !recorded) return recorded;
    }
    if (Status noted = log_->record_hand(servo_now_.hand); !noted) return noted;
    if (Status noted = log_->record_faults(servo_now_.faults, time(), options_.warn); !noted) return noted;
    if (steps.ran_contact()) {
      const RunSample sample{contact.time(), glm::length(servo_now_.force), contact.progress().depth};
      if (Status seen = log_->record_contact(sample, contact.progress(), contact.state().world_from_tool); !seen) return seen;
      if (Status noted = events.look(parts_->graph, contact.time(), *log_); !noted) return noted;
    }
    if (film_every > 0 && tick_ % film_every == 0)
      if (Status filmed = film(); !filmed) return filmed;
    if (options_.progress && progress_every > 0 && tick_ % progress_every == 0) options_.progress(time(), progress());
    if (finished()) break;
  }
  servo_timer_ = steps.servo_timer();
  return {};
}

std::uint64_t Simulation::film_ticks() const noexcept {
  return options_.film_hz > 0.0 ? static_cast<std::uint64_t>(parts_->config.servo_hz / options_.film_hz + 0.5) : 0;
}

Status Simulation::film() {
  if (parts_->frame() == nullptr) return {};
  parts_->gather(true);
  return parts_->film(parts_->contact->state().world_from_tool);
}

Status Simulation::apply(const Input& input) {
  const double time = static_cast<double>(input.tick) * parts_->period;
  const auto refused = [&](const std::string& why) {
    if (options_.user != nullptr)
      options_.user->hear(why, true);
    else if (options_.warn)
      options_.warn(why);
    return log_->record_event(time, "refused", why);
  };
  switch (input.kind) {
    case InputKind::spin:
      parts_->servo->set_spin(input.value);
      return {};
    case InputKind::switches:
      parts_->servo->set_switches(static_cast<std::uint32_t>(input.value));
      return {};
    case InputKind::tool: {
      Issues issues;
      auto tool = load_tool(input.data, input.text, parts_->config, parts_->needs, parts_->voxel_edge(), issues);
      if (!tool) return issues.front();
      tools_.push_back(std::make_unique<Tool>(std::move(*tool)));
      if (Status changed = parts_->change_tool(*tools_.back()); !changed) return changed;
      tools_.erase(tools_.begin(), tools_.end() - 1);  // nothing refers to the one before any more
      return log_->record_event(time, "tool", input.text);
    }
    case InputKind::undo: {
      const Result<bool> undone = parts_->undo();
      if (!undone) return undone.error();
      return *undone ? log_->record_event(time, "undo", "") : refused("there is nothing to undo");
    }
    case InputKind::reset:
      if (Status done = parts_->reset(); !done) return refused(done.error().message);
      return log_->record_event(time, "reset", "");
    case InputKind::checkpoint:
      if (Status done = parts_->checkpoint(input.text); !done) return refused(done.error().message);
      return log_->record_event(time, "checkpoint", input.text);
    case InputKind::restore:
      if (Status done = parts_->restore(input.text); !done) return refused(done.error().message);
      return log_->record_event(time, "restored", input.text);
    case InputKind::pause:
      return pause(input.tick);
    case InputKind::mark:
      return log_->record_event(time, "mark", input.text);
    case InputKind::export_bone: {
      parts_->voxmap->write_back();
      if (!options_.export_bone) return {};
      const auto file = options_.export_bone(*parts_->voxmap, time, input.text);
      return file ? log_->record_event(time, "export", *file) : refused(file.error().message);
    }
  }
  return {};
}

Status Simulation::pause(std::uint64_t tick) {
  if (options_.user == nullptr) return {};
  while (std::optional<Input> input = options_.user->wait_until_resumed()) {
    input->tick = tick;
    if (Status applied = record_and_apply(*input); !applied) return applied;
  }
  return {};
}

Status Simulation::apply_next(std::uint64_t tick) {
  Input input = options_.inputs[next_input_++];
  input.tick = tick;
  return record_and_apply(input);
}

Status Simulation::record_and_apply(const Input& input) {
  if (SessionWriter* session = log_->session()) {
    SessionInput row = to_record(input);
    if (parks(input.kind)) row.rows_before = session->rows();
    if (Status recorded = session->input(row); !recorded) return recorded;
  }
  return apply(input);
}

bool Simulation::input_is_due(std::uint64_t tick) const noexcept {
  return next_input_ < options_.inputs.size() && options_.inputs[next_input_].tick <= tick;
}

Status Simulation::apply_inputs(std::uint64_t tick) {
  while (input_is_due(tick))
    if (Status applied = apply_next(tick); !applied) return applied;
  return {};
}

LiveInput Simulation::live_input(std::uint64_t tick, bool parked, Status& status) {
  if (options_.user != nullptr)
    while (auto input = options_.user->next_input()) {
      input->tick = tick;
      options_.inputs.push_back(std::move(*input));
    }
  while (input_is_due(tick)) {
    if (!parked && parks(options_.inputs[next_input_].kind)) return LiveInput::park;
    if (status = apply_next(tick); !status.ok()) return LiveInput::failed;
  }
  return LiveInput::none;
}

Status Simulation::run_recorded(const SessionReader& session, RecordedHand& hand) {
  if (!options_.runs) return not_for_runs();
  const auto every = static_cast<std::uint64_t>(kProgressEvery / parts_->period + 0.5);
  const std::uint64_t film_every = film_ticks();
  std::uint64_t next = 0;
  const auto tick = [&](double time) -> Status {
    const std::uint64_t ran = next++;
    if (options_.progress && ran % every == 0) options_.progress(time, progress());
    if (film_every > 0 && ran > 0 && ran % film_every == 0)
      if (Status filmed = film(); !filmed) return filmed;
    return options_.watch ? options_.watch(time) : Status();
  };
  ReplayHooks hooks{options_.stop, tick, [this](const Input& input) { return apply(input); }, {}};
  if (!options_.watch) hooks.redraw = [this](const SessionStill& still) { return log_->redraw(still); };
  auto replayed = replay_live(*parts_, hand, session, hooks);
  if (!replayed) return replayed.error();
  tick_ = replayed->ticks;
  sent_ = replayed->sent;
  return film_every > 0 && tick_ > 0 && tick_ % film_every == 0 ? film() : Status();
}

Status Simulation::run_on_threads() {
  live_.emplace();
  LiveOptions options{options_.require_realtime, options_.stop, options_.progress, options_.warn};
  options.untimed = options_.untimed;
  options.read_failed = parts_->voxmap->bone().read_failed();
  options.inputs = [this](std::uint64_t tick, bool parked, Status& status) { return live_input(tick, parked, status); };
  if (options_.user != nullptr) {
    options.see = [this](const LiveState& state) { options_.user->see(state); };
    if (FrameStep* const frame = parts_->frame()) options.send = [frame] { return frame->send(); };
  }
  Status ran = run_live(*parts_, *log_, options, hand_off_, *live_);
  if (options_.user != nullptr) options_.user->ended();
  tick_ = live_->ticks;
  servo_now_ = live_->last;
  end_ = live_->stopped ? RunEnd::stopped : live_->done ? RunEnd::done : RunEnd::duration;
  return ran;
}

bool Simulation::finished() {
  const std::atomic<bool>* const read_failed = parts_->voxmap->bone().read_failed();
  if (is_set(options_.stop) || is_set(read_failed))
    end_ = RunEnd::stopped;
  else if (servo_now_.hand.phase == HandPhase::done)
    end_ = RunEnd::done;
  return end_ != RunEnd::duration;
}

Status Simulation::record_rows(const Lockstep& steps, std::uint64_t window) {
  SessionWriter& session = *log_->session();
  const auto append = [&](std::size_t stream, const auto& row) {
    put(row, *parts_, row_);
    return session.append(stream, row_);
  };
  if (steps.ran_contact())
    if (Status written = append(kContactRows, contact_row(*parts_, window)); !written) return written;
  if (steps.ran_bone())
    if (Status written = append(kBoneRows, bone_row(*parts_, parts_->contact->state().number)); !written) return written;
  if (records_audio(*parts_))
    for (std::uint64_t n = 0; n < steps.ran_audio(); ++n) {
      put_audio(*parts_, row_);
      if (Status written = session.append(kAudioRows, row_); !written) return written;
    }
  return append(kServoRows, servo_row(*parts_, servo_now_));  // last: this row commits
}

std::vector<TimedStep> Simulation::timings() {
  std::vector<TimedStep> out{{"hand", "servo", live_ ? live_->servo.timing() : servo_timer_.timing()}};
  for (const StepGraph::StepInfo& step : parts_->graph.steps()) out.push_back({step.effect, step.name, step.timer->timing()});
  for (const Stage::MadeEffect& made : parts_->effects())
    for (const NamedTimer& timer : made.effect->timers()) out.push_back({made.table, timer.name, timer.timer->timing(), timer.within_step});
  if (parts_->needs.feels) out.push_back({"contact", "planes", parts_->servo->multi_rate_timer().timing(), false, "hand"});
  const bool axis = parts_->bone->axis() != nullptr;
  out.push_back({axis ? "volume" : "publish", axis ? "axis" : "publish", parts_->bone->publish_timer().timing()});
  return out;
}

StepTiming Simulation::timing(std::string_view name) {
  for (const TimedStep& step : timings())
    if (step.name == name) return step.timing;
  return {};
}

std::string Simulation::sound_hash() const {
  for (const Stage::MadeEffect& made : parts_->effects()) {
    if (made.table != "sound") continue;
    Figures figures;
    made.effect->report(figures);
    for (const auto& [name, value] : figures.rows())
      if (const auto* text = std::get_if<std::string>(&value); text != nullptr && name == "hash") return *text;
  }
  return {};
}

std::optional<std::uint64_t> Simulation::image_hash() const {
  return parts_->frame() != nullptr ? std::optional(parts_->frame()->image_hash()) : std::nullopt;
}

}  // namespace burrhole
