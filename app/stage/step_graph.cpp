#include "app/stage/step_graph.h"

#include <algorithm>

namespace burrhole {

namespace {

/// Whether a session records what steps of the clock compute, so that steps of other clocks may read it.
bool is_recorded(Clock clock) noexcept { return clock == Clock::servo || clock == Clock::contact || clock == Clock::simulation; }

/// Whether a session records the numbers of the messages that a tick of the clock read.
bool records_messages(Clock clock) noexcept { return is_recorded(clock) || clock == Clock::audio; }

}  // namespace

const char* name_of(Clock clock) noexcept {
  switch (clock) {
    case Clock::servo:
      return "servo";
    case Clock::contact:
      return "contact";
    case Clock::simulation:
      return "simulation";
    case Clock::frame:
      return "frame";
    case Clock::audio:
      return "audio";
  }
  return "";
}

StepGraph::Binder StepGraph::step(Clock clock, std::string_view effect, std::string_view name, Run call, void* self) {
  steps_.push_back({.effect = std::string(effect), .name = std::string(name), .clock = clock, .run = call, .self = self});
  return {*this, steps_.size() - 1};
}

StepGraph::Binder& StepGraph::Binder::column(std::string name, std::string unit, const double* value, bool exact) {
  graph_->steps_[step_].columns.push_back({std::move(name), std::move(unit), value, exact});
  return *this;
}

StepGraph::Binder& StepGraph::Binder::column(std::string name, const ColumnStates& states, const double* value) {
  graph_->steps_[step_].columns.push_back({std::move(name), "", value, false, states});
  return *this;
}

std::size_t StepGraph::find_or_make(const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align) {
  BH_ASSERT(align <= alignof(std::max_align_t));
  static_cast<void>(align);
  for (std::size_t n = 0; n < slots_.size(); ++n)
    if (slots_[n].name == name) {
      if (slots_[n].type != type && mismatch_.empty()) mismatch_ = name;
      if (slots_[n].value.size >= size) return n;
      break;  // of another type and larger: a separate slot keeps the pointer valid until resolve() returns the error
    }
  const auto block = [&] {
    Block out{std::make_unique<std::max_align_t[]>((size + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t)), size};
    std::memcpy(out.data(), start, size);
    return out;
  };
  slots_.push_back(Slot{.name = name, .type = type, .start = block(), .value = block()});
  return slots_.size() - 1;
}

void* StepGraph::use(std::size_t step, const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align,
                     Access access) {
  const std::size_t at = find_or_make(name, type, start, size, align);
  Slot& slot = slots_[at];
  BoundStep& bound = steps_[step];
  bound.uses.push_back({at, access});
  if (access == Access::own || access == Access::add) {
    if (access == Access::own && slot.owner == kNone) slot.owner = step;
    if (access == Access::add) slot.adders.push_back(step);
    if (!slot.written) slot.writer = bound.clock;
    slot.written = true;
    return slot.value.data();
  }
  if (access != Access::latest) return slot.value.data();
  for (const Mirror& mirror : slot.mirrors)
    if (mirror.reader == bound.clock) return mirror.value.data();
  Block copy{std::make_unique<std::max_align_t[]>((size + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t)), size};
  std::memcpy(copy.data(), start, size);
  slot.mirrors.push_back({bound.clock, std::move(copy)});
  return slot.mirrors.back().value.data();
}

void* StepGraph::provide(Clock clock, const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align) {
  Slot& slot = slots_[find_or_make(name, type, start, size, align)];
  slot.provided = slot.written = true;
  slot.writer = clock;
  return slot.value.data();
}

bool StepGraph::is_written(std::string_view name) const noexcept {
  return std::ranges::any_of(slots_, [&](const Slot& slot) { return slot.name == name && (slot.owner != kNone || !slot.adders.empty()); });
}

bool StepGraph::is_read(std::string_view name) const noexcept {
  const auto reads = [&](const SlotUse& use) {
    return slots_[use.slot].name == name && use.access != Access::own && use.access != Access::add;
  };
  return std::ranges::any_of(steps_, [&](const BoundStep& step) { return std::ranges::any_of(step.uses, reads); });
}

std::string StepGraph::who(const Slot& slot) const {
  for (const BoundStep& step : steps_)
    for (const SlotUse& use : step.uses)
      if (&slots_[use.slot] == &slot) return "[" + step.effect + "]";
  return "the stage";
}

Status StepGraph::check_uses(const BoundStep& step) const {
  const std::string reader = "[" + step.effect + "]";
  for (const SlotUse& use : step.uses) {
    const Slot& slot = slots_[use.slot];
    const bool writes = use.access == Access::own || use.access == Access::add;
    if (!slot.written && use.optional) continue;
    if (!slot.written) return bad_input(reader + " needs \"" + slot.name + "\", which nothing in this scene provides");
    if (use.access == Access::own && (slot.provided || &steps_[slot.owner] != &step))
      return bad_input("\"" + slot.name + "\" has two owners: " + reader + " and " +
                       (slot.provided ? std::string("the stage") : "[" + steps_[slot.owner].effect + "]"));
    if (use.access == Access::add && (slot.owner != kNone || slot.provided))
      return bad_input(reader + " adds to \"" + slot.name + "\", which has an owner");
    if (writes && slot.writer != step.clock)
      return bad_input("\"" + slot.name + "\" is written on two clocks: " + name_of(slot.writer) + " and " + name_of(step.clock));
    if (writes) continue;
    if ((use.access == Access::latest) == (slot.writer == step.clock))
      return bad_input(reader + " reads \"" + slot.name + "\" of the " + name_of(slot.writer) + " clock on the " + name_of(step.clock) +
                       " clock by the wrong access");
    if (use.access == Access::last && !slot.adders.empty())
      return bad_input(reader + " reads the last \"" + slot.name + "\", which steps add to: it is reset before each tick");
    if (slot.writer != step.clock && !is_recorded(slot.writer))
      return bad_input(reader + " reads \"" + slot.name + "\" of the " + name_of(slot.writer) + " clock, which a replay does not run");
  }
  return {};
}

Status StepGraph::check_slots() const {
  if (!mismatch_.empty()) return bad_input("the slot \"" + mismatch_ + "\" is used with two types");
  for (const BoundStep& step : steps_)
    if (Status valid = check_uses(step); !valid) return valid;
  for (const auto& [name, clock] : read_by_stage_)
    for (const Slot& slot : slots_)
      if (slot.name == name && slot.written && slot.writer != clock)
        return bad_input("\"" + name + "\" of " + who(slot) + " must be written on the " + name_of(clock) +
                         " clock, where the stage reads it");
  return {};
}

Status StepGraph::check_columns() const {
  for (const BoundStep& step : steps_)
    if (!is_recorded(step.clock) && !step.columns.empty())
      return bad_input("the column \"" + step.columns.front().name + "\" is on the " + name_of(step.clock) +
                       " clock, which has no stream in a session");
  for (const BoundStep& step : steps_)
    for (const StepColumn& column : step.columns)
      if (column.states.kind != nullptr && step.clock != Clock::contact)
        return bad_input("the states \"" + column.name + "\" are on the " + name_of(step.clock) +
                         " clock: only those of contact are events");
  for (std::size_t n = 0; n < kClocks; ++n) {
    const auto clock = static_cast<Clock>(n);
    const std::vector<StepColumn>& all = columns(clock);
    if (all.size() > kMaxColumns)
      return bad_input("the steps of the " + std::string(name_of(clock)) + " clock record " + std::to_string(all.size()) +
                       " columns, at most " + std::to_string(kMaxColumns));
  }
  return {};
}

Status StepGraph::sort(Clock clock) {
  std::vector<std::size_t> own;
  for (std::size_t n = 0; n < steps_.size(); ++n)
    if (steps_[n].clock == clock) own.push_back(n);
  const auto writes = [&](std::size_t step, std::size_t slot) {
    return std::ranges::any_of(steps_[step].uses,
                               [&](const SlotUse& u) { return u.slot == slot && (u.access == Access::own || u.access == Access::add); });
  };
  // a runs before b if b reads (now) a slot that a writes, or if a reads (last) a slot that b owns.
  const auto before = [&](std::size_t a, std::size_t b) {
    const auto needs = [&](std::size_t reader, std::size_t writer, Access access) {
      return std::ranges::any_of(steps_[reader].uses, [&](const SlotUse& u) { return u.access == access && writes(writer, u.slot); });
    };
    return a != b && (needs(b, a, Access::now) || needs(a, b, Access::last));
  };
  Lane& lane = lanes_[index(clock)];
  while (!own.empty()) {
    const auto ready = std::ranges::find_if(
        own, [&](std::size_t step) { return std::ranges::none_of(own, [&](std::size_t other) { return before(other, step); }); });
    if (ready == own.end()) {
      std::string names;
      for (const std::size_t step : own) names += (names.empty() ? "[" : ", [") + steps_[step].effect + "]";
      return bad_input(std::string("on the ") + name_of(clock) + " clock each of these needs another's result of the same tick: " + names);
    }
    lane.steps.push_back(*ready);
    for (const StepColumn& column : steps_[*ready].columns) lane.columns.push_back(column);
    own.erase(ready);
  }
  for (std::size_t n = 0; n < slots_.size(); ++n)
    if (!slots_[n].adders.empty() && slots_[n].writer == clock) lane.resets.push_back(n);
  return {};
}

Status StepGraph::connect() {
  for (Slot& slot : slots_)
    for (Mirror& mirror : slot.mirrors) {
      if (!slot.written) continue;                                           // latest_if_written()
      std::memcpy(mirror.value.data(), slot.value.data(), slot.value.size);  // what the owner set while it was bound
      const auto found =
          std::ranges::find_if(links_, [&](const auto& link) { return link->writer == slot.writer && link->reader == mirror.reader; });
      Link* link = found != links_.end() ? found->get() : nullptr;
      if (link == nullptr) {
        links_.push_back(std::make_unique<Link>());
        link = links_.back().get();
        link->writer = slot.writer;
        link->reader = mirror.reader;
        lanes_[index(slot.writer)].links_out.push_back(link);
        lanes_[index(mirror.reader)].links_in.push_back(link);
        if (records_messages(mirror.reader))
          lanes_[index(mirror.reader)].columns.push_back({std::string("from_") + name_of(slot.writer), "", &link->taken, true});
      }
      const std::size_t at = link->out.empty() ? 0 : (link->out.back().at + link->out.back().size + 15) / 16 * 16;
      if (at + slot.value.size > kMessageBytes)
        return bad_input("what the " + std::string(name_of(slot.writer)) + " clock hands to the " + name_of(mirror.reader) +
                         " clock takes over " + std::to_string(kMessageBytes) + " bytes, with \"" + slot.name + "\" of " + who(slot));
      link->out.push_back({slot.value.data(), at, slot.value.size});
      link->in.push_back({mirror.value.data(), at, slot.value.size});
    }
  return {};
}

Status StepGraph::resolve() {
  if (Status sound = check_slots(); !sound) return sound;
  for (std::size_t n = 0; n < kClocks; ++n)
    if (Status sorted = sort(static_cast<Clock>(n)); !sorted) return sorted;
  if (Status connected = connect(); !connected) return connected;
  return check_columns();
}

void StepGraph::take(Link& link) noexcept {
  const Message* message = nullptr;
  if (keeps_messages_ && link.reader == Clock::frame) {
    // A replay draws each picture right after the simulation step that it shows.
    if (!link.kept.empty()) message = &link.kept.back();
  } else if (keeps_messages_) {
    for (const Message& kept : link.kept)
      if (static_cast<double>(kept.number) == link.wanted) message = &kept;
    while (!link.kept.empty() && static_cast<double>(link.kept.front().number) < link.wanted) link.kept.pop_front();
  } else {
    message = &link.buffer.latest();
  }
  if (message == nullptr || message->number == 0) return;
  link.taken = static_cast<double>(message->number);
  for (const Copy& copy : link.in) std::memcpy(copy.value, message->bytes.data() + copy.at, copy.size);
}

std::optional<Clock> StepGraph::want(Clock reader, std::span<const double> numbers) {
  Lane& lane = lanes_[index(reader)];
  BH_ASSERT(numbers.size() == lane.links_in.size());
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    Link& link = *lane.links_in[n];
    link.wanted = numbers[n];
    const bool there = numbers[n] == 0.0 ||
                       std::ranges::any_of(link.kept, [&](const Message& kept) { return static_cast<double>(kept.number) == numbers[n]; });
    if (!there) return link.writer;
  }
  return std::nullopt;
}

namespace {

/// Receives the time of a call, for the statistics of its thread and for a mean that others read.
struct Meter {
  StepTimer& timer;
  std::atomic<float>& mean;
  void add(float us) noexcept {
    constexpr float kNew = 0.05f;
    timer.add(us);
    const float before = mean.load(std::memory_order_relaxed);  // this thread is the only writer
    mean.store(before + kNew * (us - before), std::memory_order_relaxed);
  }
};

}  // namespace

void StepGraph::run(Clock clock, const Tick& tick) {
  receive(clock);
  run_steps(clock, tick);
  send(clock);
}

void StepGraph::receive(Clock clock) {
  for (Link* link : lanes_[index(clock)].links_in) take(*link);
}

void StepGraph::run_steps(Clock clock, const Tick& tick) {
  Lane& lane = lanes_[index(clock)];
  for (const std::size_t slot : lane.resets) std::memcpy(slots_[slot].value.data(), slots_[slot].start.data(), slots_[slot].value.size);
  for (const std::size_t n : lane.steps) {
    BoundStep& step = steps_[n];
    Meter meter{step.timer, *step.mean_us};
    timed(meter, [&] { step.run(step.self, tick); });
  }
}

void StepGraph::send(Clock clock) {
  Lane& lane = lanes_[index(clock)];
  ++lane.ticks;
  for (Link* link : lane.links_out) {
    link->message.number = lane.ticks;
    for (const Copy& copy : link->out) std::memcpy(link->message.bytes.data() + copy.at, copy.value, copy.size);
    if (keeps_messages_ && link->reader == Clock::frame) link->kept.clear();  // only the newest is read
    if (keeps_messages_)
      link->kept.push_back(link->message);
    else
      link->buffer.publish(link->message);
  }
}

void StepGraph::keep_timings(StepGraph& before) {
  for (BoundStep& step : steps_)
    for (const BoundStep& old : before.steps_)
      if (old.name == step.name) step.timer = old.timer;
}

std::vector<Clock> StepGraph::sources(Clock reader) const {
  std::vector<Clock> out;
  for (const Link* link : lanes_[index(reader)].links_in) out.push_back(link->writer);
  return out;
}

std::vector<StepGraph::StepInfo> StepGraph::steps() {
  std::vector<StepInfo> out;
  for (const Lane& lane : lanes_)
    for (const std::size_t n : lane.steps)
      out.push_back({steps_[n].effect, steps_[n].name, steps_[n].clock, &steps_[n].timer, steps_[n].mean_us.get()});
  return out;
}

std::size_t StepGraph::bytes() const noexcept {
  std::size_t sum = 0;
  for (const Slot& slot : slots_) {
    sum += slot.start.size + slot.value.size;
    for (const Mirror& mirror : slot.mirrors) sum += mirror.value.size;
  }
  return sum + links_.size() * sizeof(Link);
}

}  // namespace burrhole
