#include "app/run/live_replay.h"

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <set>

#include "haptics/servo/realtime.h"

namespace burrhole {
namespace {

/// One column of a stream, by name.
Result<std::vector<std::uint64_t>> counts(const SessionReader& session, const char* stream, const char* name) {
  const auto values = session.column(stream, name);
  if (!values) return Error{values.error().code, values.error().message, {}};
  std::vector<std::uint64_t> out;
  out.reserve(values->size());
  for (const double value : *values) {
    if (!(value >= 0.0 && value < 9e15)) return bad_input(std::string("the session holds no count in its column ") + name);
    out.push_back(static_cast<std::uint64_t>(value));
  }
  return out;
}

/// What each step took, as far as its order depends on it.
struct Journal {
  std::vector<std::uint64_t> servo_contact, servo_faults;   // a servo tick: the result that it used, and what was wrong
  std::vector<std::uint64_t> contact_hand, contact_window;  // an evaluation: the motion and the copy of bone
  std::vector<std::uint64_t> bone_contact, bone_published;  // a step of bone: the result that it cut by, copies handed over after it
  // Of each clock: the messages that each of its ticks took from the other clocks, one list per source.
  std::array<std::vector<std::vector<std::uint64_t>>, kClocks> messages;
};

constexpr std::pair<Clock, const char*> kStreamOf[] = {
    {Clock::servo, kServoStream}, {Clock::contact, kContactStream}, {Clock::simulation, kBoneStream}};

Result<Journal> read_journal(const SessionReader& session, const StepGraph& graph) {
  Journal out;
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
  Replay(Stage& parts, RecordedHand& hand, const SessionReader& session, const ReplayHooks& hooks, Journal journal)
      : parts_(&parts),
        hand_(&hand),
        hooks_(&hooks),
        stills_(&session.stills()),
        journal_(std::move(journal)),
        wanted_(journal_.bone_contact.begin(), journal_.bone_contact.end()),
        published_(parts.bone->publisher().published()) {
    parts.graph.keep_messages();
  }

  Status servo(std::size_t tick) {
    while (contacts_ < journal_.servo_contact[tick])
      if (Status looked = contact(); !looked) return looked;
    if (Status there = fetch(Clock::servo, tick); !there) return there;
    // The result that the servo used then: later ones may be there already, where the clocks rested meanwhile.
    for (; !results_.empty() && results_.front().number <= journal_.servo_contact[tick]; results_.pop_front())
      parts_->force_mailbox.publish(results_.front());
    parts_->servo->sense();
    // A stop came from outside: the tick in which it was answered tells it.
    if ((journal_.servo_faults[tick] & kServoStopped) != 0) parts_->servo->request_stop();
    sent_.add(parts_->act().force);
    return {};
  }
  /// What came after the last servo tick.
  Status finish() {
    if (Status done = until(journal_.contact_hand.size(), journal_.bone_contact.size()); !done) return done;
    return draw_stills();
  }
  /// Steps of contact and bone up to so many.
  Status until(std::size_t contacts, std::size_t bones) {
    while (contacts_ < contacts)
      if (Status looked = contact(); !looked) return looked;
    while (bones_ < bones)
      if (Status cut = bone(); !cut) return cut;
    return {};
  }
  /// An input for which all clocks rested, `rows` of each stream being before it.
  Status park(const Input& input, const std::vector<std::int64_t>& rows) {
    if (rows.size() != 3) return disorder();
    if (Status done = until(static_cast<std::size_t>(rows[1]), static_cast<std::size_t>(rows[2])); !done) return done;
    if (Status drawn = draw_stills(); !drawn) return drawn;
    const std::uint64_t before = parts_->bone->publisher().published();
    if (hooks_->apply)
      if (Status applied = hooks_->apply(input); !applied) return applied;
    ++parks_;
    published_ += parts_->bone->publisher().published() - before;
    parts_->graph.keep_messages();  // a tool change makes the graph anew
    return {};
  }
  [[nodiscard]] const Hash64& sent() const noexcept { return sent_; }
  /// A step was asked for of which no row is there: what a killed run leaves at its end.
  [[nodiscard]] bool ran_out() const noexcept { return ran_out_; }

 private:
  static Error disorder() {
    return bad_input("the session's steps do not follow from one another: rows of it are missing or were changed");
  }
  Error out_of_rows() {
    ran_out_ = true;
    return disorder();
  }

  /// The messages of other clocks that a tick took: the ticks that wrote them run first.
  Status fetch(Clock reader, std::size_t tick) {
    const auto& lists = journal_.messages[static_cast<std::size_t>(reader)];
    if (lists.empty()) return {};
    const std::vector<Clock> sources = parts_->graph.sources(reader);
    std::vector<double> numbers;
    for (const std::vector<std::uint64_t>& list : lists) {
      if (tick >= list.size()) return out_of_rows();
      numbers.push_back(static_cast<double>(list[tick]));
    }
    while (!parts_->graph.want(reader, numbers)) {
      if (std::ranges::find(sources, Clock::simulation) != sources.end() && reader != Clock::simulation) {
        if (Status cut = bone(); !cut) return cut;
      } else if (std::ranges::find(sources, Clock::contact) != sources.end() && reader != Clock::contact) {
        if (Status looked = contact(); !looked) return looked;
      } else {
        return disorder();
      }
    }
    return {};
  }
  [[nodiscard]] bool is_due(const SessionStill& still) const noexcept {
    return still.parks <= parks_ && static_cast<std::size_t>(still.bone_step) <= bones_;
  }
  /// Pictures of the bone as it is now.
  Status draw_stills() {
    if (!hooks_->redraw) return {};
    for (; next_still_ < stills_->size() && is_due((*stills_)[next_still_]); ++next_still_)
      if (Status drawn = hooks_->redraw((*stills_)[next_still_]); !drawn) return drawn;
    return {};
  }

  Status contact() {
    if (contacts_ == journal_.contact_hand.size()) return out_of_rows();
    // It read this copy of bone, so the steps that made it came before; later ones may wait for what they cut by. The record alone gives
    // the order: a replay that comes to other bone runs to its end, and its hashes differ.
    while (published_ < journal_.contact_window[contacts_])
      if (Status cut = bone(); !cut) return cut;
    if (published_ != journal_.contact_window[contacts_]) return disorder();
    const HandState* hand = hand_->at(journal_.contact_hand[contacts_]);
    if (hand == nullptr) return out_of_rows();
    if (Status there = fetch(Clock::contact, contacts_); !there) return there;
    const ContactState& state = (*parts_->contact)(*hand);
    ++contacts_;
    results_.push_back(state);
    if (wanted_.contains(contacts_)) kept_[contacts_] = state;
    return {};
  }
  Status bone() {
    if (bones_ == journal_.bone_contact.size()) return out_of_rows();
    if (Status drawn = draw_stills(); !drawn) return drawn;
    const auto by = kept_.find(journal_.bone_contact[bones_]);
    if (by == kept_.end()) return disorder();
    kept_.erase(kept_.begin(), by);  // steps cut by ever newer results
    if (Status there = fetch(Clock::simulation, bones_); !there) return there;
    parts_->cut(by->second);
    if (journal_.bone_published[bones_] < published_) return disorder();
    published_ = journal_.bone_published[bones_++];
    return {};
  }

  Stage* parts_;
  RecordedHand* hand_;
  const ReplayHooks* hooks_;
  const std::vector<SessionStill>* stills_;
  std::size_t next_still_ = 0;
  std::int64_t parks_ = 0;  // inputs for which the clocks rested so far
  Journal journal_;
  std::deque<ContactState> results_;            // not used by the servo yet
  std::set<std::uint64_t> wanted_;              // results that bone is cut by
  std::map<std::uint64_t, ContactState> kept_;  // of those, the ones found and still needed
  std::uint64_t contacts_ = 0;
  std::size_t bones_ = 0;
  std::uint64_t published_;  // copies of bone handed over so far, as recorded
  bool ran_out_ = false;
  Hash64 sent_;
};

}  // namespace

bool has_order(const SessionReader& session) noexcept {
  return session.stream(kContactStream) != nullptr && session.stream(kBoneStream) != nullptr;
}

Result<LiveReplayed> replay_live(Stage& parts, RecordedHand& hand, const SessionReader& session, const ReplayHooks& hooks) {
  auto journal = read_journal(session, parts.graph);
  if (!journal) return journal.error();
  const std::size_t ticks = journal->servo_contact.size();
  const bool unfinished = session.hashes().empty();  // the run did not come to its end
  const FlushToZero guard;
  Replay replay(parts, hand, session, hooks, std::move(journal).value());
  LiveReplayed out;
  auto input = session.inputs().begin();
  // Inputs for which the clocks rested come between two ticks; what the others did is in the hand's rows.
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
      if (hooks.stop != nullptr && hooks.stop->load(std::memory_order_relaxed)) return {};
      if (Status done = apply_parked(tick); !done) return done;
      if (Status done = replay.servo(tick); !done) return done;
      ++out.ticks;
      if (hooks.progress && tick % 100 == 0) hooks.progress(static_cast<double>(tick) * parts.period);
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
