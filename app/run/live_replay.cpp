#include "app/run/live_replay.h"

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <set>

#include "app/run/live_rows.h"
#include "haptics/servo/realtime.h"

namespace burrhole {
namespace {

/// @returns one column of a stream as counts. bad_input: no such column, or a value that is no count.
Result<std::vector<std::uint64_t>> counts(const SessionReader& session, const char* stream, const char* name) {
  const auto values = session.column(stream, name);
  if (!values) return Error{values.error().code, values.error().message, {}};
  std::vector<std::uint64_t> out;
  out.reserve(values->size());
  for (const double value : *values) {
    if (!(value >= 0.0 && value < 9e15)) return bad_input(std::string("the session has a value that is not a count in its column ") + name);
    out.push_back(static_cast<std::uint64_t>(value));
  }
  return out;
}

/// The recorded inputs of each step that determine the order of steps.
struct RecordedOrder {
  std::vector<std::uint64_t> servo_contact, servo_faults;   // per servo tick: number of the contact result used, servo faults
  std::vector<std::uint64_t> contact_hand, contact_window;  // per evaluation: tick of the hand state used, number of the copy of bone used
  std::vector<std::uint64_t> bone_contact,
      bone_published;  // per simulation step: number of the contact result used, copies published since
  // Per clock: the number of the message that each of its ticks read from each other clock, one list per source.
  std::array<std::vector<std::vector<std::uint64_t>>, kClocks> messages;
};

constexpr std::pair<Clock, const char*> kStreamOf[] = {
    {Clock::servo, kServoStream}, {Clock::contact, kContactStream}, {Clock::simulation, kBoneStream}, {Clock::audio, kAudioStream}};

Result<RecordedOrder> read_order(const SessionReader& session, const StepGraph& graph) {
  RecordedOrder out;
  struct Column {
    const char *stream, *name;
    std::vector<std::uint64_t>* values;
  };
  for (const Column& column :
       {Column{kServoStream, "contact", &out.servo_contact}, Column{kServoStream, "faults", &out.servo_faults},
        Column{kContactStream, "hand_tick", &out.contact_hand}, Column{kContactStream, "window", &out.contact_window},
        Column{kBoneStream, "contact", &out.bone_contact}, Column{kBoneStream, "published", &out.bone_published}}) {
    auto values = counts(session, column.stream, column.name);
    if (!values) return values.error();
    *column.values = std::move(values).value();
  }
  for (const auto& [clock, stream] : kStreamOf)
    for (const Clock source : graph.sources(clock)) {
      auto values = counts(session, stream, (std::string("from_") + name_of(source)).c_str());
      if (!values) return values.error();
      out.messages[static_cast<std::size_t>(clock)].push_back(std::move(values).value());
    }
  return out;
}

class Replay {
 public:
  Replay(Stage& parts, RecordedHand& hand, const SessionReader& session, const ReplayHooks& hooks, RecordedOrder order)
      : parts_(&parts),
        hand_(&hand),
        hooks_(&hooks),
        stills_(&session.stills()),
        order_(std::move(order)),
        needed_(order_.bone_contact.begin(), order_.bone_contact.end()),
        published_(parts.bone->published()) {
    parts.graph.keep_messages();
    for (const SessionInput& input : session.inputs())
      if (input.rows_before.size() > kAudioRows) blocks_before_park_.push_back(static_cast<std::size_t>(input.rows_before[kAudioRows]));
  }

  Status servo(std::size_t tick) {
    while (contacts_ < order_.servo_contact[tick])
      if (Status ran = contact(); !ran) return ran;
    if (Status fetched = fetch(Clock::servo, tick); !fetched) return fetched;
    // Only results up to the one that the servo used: later ones may exist already if the clocks were stopped for an input.
    for (; !results_.empty() && results_.front().number <= order_.servo_contact[tick]; results_.pop_front())
      parts_->force_mailbox.publish(results_.front());
    parts_->servo->sense();
    // A stop request is an external event; the recorded servo faults show in which tick it took effect.
    if ((order_.servo_faults[tick] & kServoStopped) != 0) parts_->servo->request_stop();
    sent_.add(parts_->act().force);
    sound();
    return {};
  }
  /// Runs the steps recorded after the last servo tick.
  Status finish() {
    if (Status done = until(order_.contact_hand.size(), order_.bone_contact.size()); !done) return done;
    sound();
    if (blocks_ < block_count()) return out_of_rows();
    return draw_stills();
  }
  /// Runs steps until `contacts` evaluations and `bones` simulation steps have run in all.
  Status until(std::size_t contacts, std::size_t bones) {
    while (contacts_ < contacts)
      if (Status ran = contact(); !ran) return ran;
    while (bones_ < bones)
      if (Status cut = bone(); !cut) return cut;
    return {};
  }
  /// Applies an input for which all clocks were stopped. @param rows of each stream recorded before it.
  Status park(const Input& input, const std::vector<std::int64_t>& rows) {
    if (rows.size() < 3) return disorder();
    if (Status done = until(static_cast<std::size_t>(rows[1]), static_cast<std::size_t>(rows[2])); !done) return done;
    sound();
    if (block_count() > 0 && (rows.size() <= kAudioRows || blocks_ != static_cast<std::size_t>(rows[kAudioRows]))) return disorder();
    if (Status drawn = draw_stills(); !drawn) return drawn;
    const std::uint64_t before = parts_->bone->published();
    if (hooks_->apply)
      if (Status applied = hooks_->apply(input); !applied) return applied;
    ++parks_;
    published_ += parts_->bone->published() - before;
    parts_->graph.keep_messages();  // a tool change creates a new graph
    return {};
  }
  [[nodiscard]] const Hash64& sent() const noexcept { return sent_; }
  /// @returns whether a step without a recorded row was needed. The last rows of a killed run refer to such steps.
  [[nodiscard]] bool ran_out() const noexcept { return ran_out_; }

 private:
  static Error disorder() { return bad_input("the order of the session's steps is inconsistent: rows are missing or were changed"); }
  Error out_of_rows() {
    ran_out_ = true;
    return disorder();
  }

  /// Provides the messages of other clocks that a tick read; runs the steps that wrote them first.
  Status fetch(Clock reader, std::size_t tick) {
    const auto& lists = order_.messages[static_cast<std::size_t>(reader)];
    if (lists.empty()) return {};
    std::vector<double> numbers;
    for (const std::vector<std::uint64_t>& list : lists) {
      if (tick >= list.size()) return out_of_rows();
      numbers.push_back(static_cast<double>(list[tick]));
    }
    while (const auto missing = parts_->graph.want(reader, numbers)) {
      Status ran = disorder();  // a servo tick never comes later than the ticks that read it
      if (*missing == Clock::simulation) ran = bone();
      if (*missing == Clock::contact) ran = contact();
      if (!ran) return ran;
    }
    return {};
  }
  [[nodiscard]] std::size_t block_count() const noexcept {
    const auto& lists = order_.messages[static_cast<std::size_t>(Clock::audio)];
    return lists.empty() ? 0 : lists.front().size();
  }
  /// Computes the blocks of sound whose messages exist, up to the next input for which the clocks were stopped: that may change the tool.
  /// No other step reads what they compute, so it does not matter when they run.
  void sound() {
    const auto& lists = order_.messages[static_cast<std::size_t>(Clock::audio)];
    std::vector<double> numbers(lists.size());
    const auto park = static_cast<std::size_t>(parks_);
    const std::size_t end = park < blocks_before_park_.size() ? std::min(block_count(), blocks_before_park_[park]) : block_count();
    for (; blocks_ < end; ++blocks_) {
      for (std::size_t n = 0; n < lists.size(); ++n) numbers[n] = static_cast<double>(lists[n][blocks_]);
      if (parts_->graph.want(Clock::audio, numbers)) return;
      parts_->graph.run(Clock::audio, {blocks_, kAudioPeriod});
    }
  }
  [[nodiscard]] bool is_due(const SessionStill& still) const noexcept {
    return still.parks <= parks_ && static_cast<std::size_t>(still.bone_step) <= bones_;
  }
  /// Draws the recorded pictures of the present state of the bone.
  Status draw_stills() {
    if (!hooks_->redraw) return {};
    for (; next_still_ < stills_->size() && is_due((*stills_)[next_still_]); ++next_still_)
      if (Status drawn = hooks_->redraw((*stills_)[next_still_]); !drawn) return drawn;
    return {};
  }

  /// While a step provides what it read, the same clock's next step is never needed, except in rows that were changed.
  class Providing {
   public:
    explicit Providing(bool& flag) noexcept : flag_(&flag) { flag = true; }
    ~Providing() { *flag_ = false; }
    Providing(const Providing&) = delete;
    Providing& operator=(const Providing&) = delete;

   private:
    bool* flag_;
  };

  Status contact() {
    if (contacts_ == order_.contact_hand.size()) return out_of_rows();
    if (contact_waits_) return disorder();
    const Providing providing(contact_waits_);
    // The evaluation read this copy of bone, so the steps that published it ran before. The order comes from the record alone: a replay
    // whose bone deviates still runs to its end, and its hashes differ.
    while (published_ < order_.contact_window[contacts_])
      if (Status cut = bone(); !cut) return cut;
    if (published_ != order_.contact_window[contacts_]) return disorder();
    const HandState* hand = hand_->at(order_.contact_hand[contacts_]);
    if (hand == nullptr) return out_of_rows();
    if (Status fetched = fetch(Clock::contact, contacts_); !fetched) return fetched;
    const ContactState& state = (*parts_->contact)(*hand);
    ++contacts_;
    results_.push_back(state);
    if (needed_.contains(contacts_)) kept_[contacts_] = state;
    return {};
  }
  Status bone() {
    if (bones_ == order_.bone_contact.size()) return out_of_rows();
    if (bone_waits_) return disorder();
    const Providing providing(bone_waits_);
    // An evaluation that read an older copy of bone than this step publishes began before it, even where its result came later.
    while (contacts_ < order_.contact_window.size() && order_.contact_window[contacts_] < order_.bone_published[bones_])
      if (Status ran = contact(); !ran) return ran;
    if (Status drawn = draw_stills(); !drawn) return drawn;
    const auto by = kept_.find(order_.bone_contact[bones_]);
    if (by == kept_.end()) return disorder();
    kept_.erase(kept_.begin(), by);  // later steps never use an older result
    if (Status fetched = fetch(Clock::simulation, bones_); !fetched) return fetched;
    parts_->cut(by->second);
    if (order_.bone_published[bones_] < published_) return disorder();
    published_ = order_.bone_published[bones_++];
    return {};
  }

  Stage* parts_;
  RecordedHand* hand_;
  const ReplayHooks* hooks_;
  const std::vector<SessionStill>* stills_;
  std::size_t next_still_ = 0;
  std::int64_t parks_ = 0;  // inputs so far for which all clocks were parked
  RecordedOrder order_;
  std::deque<ContactState> results_;            // contact results that the servo has not received yet
  std::set<std::uint64_t> needed_;              // numbers of the contact results that simulation steps use
  std::map<std::uint64_t, ContactState> kept_;  // those that were computed and are still needed
  std::uint64_t contacts_ = 0;
  std::size_t bones_ = 0, blocks_ = 0;
  std::vector<std::size_t> blocks_before_park_;
  std::uint64_t published_;  // copies of bone published so far, as recorded
  bool ran_out_ = false, contact_waits_ = false, bone_waits_ = false;
  Hash64 sent_;
};

}  // namespace

bool has_order(const SessionReader& session) noexcept {
  return session.stream(kContactStream) != nullptr && session.stream(kBoneStream) != nullptr;
}

bool lacks_rows(const SessionReader& session) noexcept {
  return std::ranges::find(session.events(), kUnrecordedEvent, &SessionEvent::kind) != session.events().end();
}

Result<LiveReplayed> replay_live(Stage& parts, RecordedHand& hand, const SessionReader& session, const ReplayHooks& hooks) {
  if (lacks_rows(session)) return bad_input("rows of this run were not recorded: its steps cannot be repeated");
  auto order = read_order(session, parts.graph);
  if (!order) return order.error();
  const std::size_t ticks = order->servo_contact.size();
  const bool unfinished = session.hashes().empty();  // the recorded process was killed
  const FlushToZero guard;
  Replay replay(parts, hand, session, hooks, std::move(order).value());
  LiveReplayed out;
  auto input = session.inputs().begin();
  // Inputs for which the clocks were stopped are applied between two ticks; the effect of the others is in the hand's rows.
  const auto apply_parked = [&](std::size_t tick) -> Status {
    for (; input != session.inputs().end(); ++input) {
      if (input->rows_before.empty()) continue;
      if (static_cast<std::size_t>(input->rows_before.front()) > tick) break;
      auto read = input_from(*input);
      if (!read) return read.error();
      if (Status done = replay.park(*read, input->rows_before); !done) return done;
    }
    return {};
  };
  const auto run = [&]() -> Status {
    for (std::size_t tick = 0; tick < ticks; ++tick) {
      if (hooks.tick)
        if (Status done = hooks.tick(static_cast<double>(tick) * parts.period); !done) return done;
      if (hooks.stop != nullptr && hooks.stop->load(std::memory_order_relaxed)) return {};
      if (Status done = apply_parked(tick); !done) return done;
      if (Status done = replay.servo(tick); !done) return done;
      ++out.ticks;
    }
    if (Status done = apply_parked(ticks); !done) return done;
    return replay.finish();
  };
  if (Status done = run(); !done) {
    if (!(replay.ran_out() && unfinished)) return done.error();
    out.cut_short = true;
  }
  parts.voxmap->write_back();
  out.sent = replay.sent();
  return out;
}

}  // namespace burrhole
