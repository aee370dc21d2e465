#include "app/engine/live_replay.h"

#include <map>
#include <set>

#include "app/engine/realtime.h"

namespace burrhole {
namespace {

/// One column of a stream, by name.
Result<std::vector<std::uint64_t>> counts(const SessionReader& session, const std::string& stream, const std::string& name) {
  const std::vector<SessionColumn>& columns = stream.empty() ? session.columns() : session.stream(stream)->columns;
  std::size_t at = 0;
  while (at < columns.size() && columns[at].name != name) ++at;
  if (at == columns.size()) return bad_input("the session has no column " + name + (stream.empty() ? "" : " of " + stream));
  const auto rows = stream.empty() ? session.rows(0, session.row_count()) : session.stream_rows(stream);
  if (!rows) return rows.error();
  std::vector<std::uint64_t> out;
  for (std::size_t n = at; n < rows->size(); n += columns.size()) {
    const double value = (*rows)[n];
    if (!(value >= 0.0 && value < 9e15)) return bad_input("the session holds no count in its column " + name);
    out.push_back(static_cast<std::uint64_t>(value));
  }
  return out;
}

/// What each step took, as far as its order depends on it.
struct Journal {
  std::vector<std::uint64_t> servo_contact, servo_faults;   // a servo tick: the result that it used, and what was wrong
  std::vector<std::uint64_t> contact_hand, contact_window;  // an evaluation: the motion and the copy of bone
  std::vector<std::uint64_t> bone_contact, bone_published;  // a step of bone: the result that it cut by, copies handed over after it
};

Result<Journal> read_journal(const SessionReader& session) {
  Journal out;
  struct Column {
    const char *stream, *name;
    std::vector<std::uint64_t>* values;
  };
  for (const Column& column : {Column{"", "contact", &out.servo_contact}, Column{"", "faults", &out.servo_faults},
                               Column{"contact", "hand_tick", &out.contact_hand}, Column{"contact", "window", &out.contact_window},
                               Column{"bone", "contact", &out.bone_contact}, Column{"bone", "published", &out.bone_published}}) {
    auto values = counts(session, column.stream, column.name);
    if (!values) return values.error();
    *column.values = std::move(values).value();
  }
  return out;
}

class Replay {
 public:
  Replay(DrillParts& parts, RecordedHand& hand, Journal journal)
      : parts_(&parts), hand_(&hand), journal_(std::move(journal)), wanted_(journal_.bone_contact.begin(), journal_.bone_contact.end()) {}

  Status servo(std::size_t tick) {
    while (contacts_ < journal_.servo_contact[tick])
      if (Status looked = contact(); !looked) return looked;
    parts_->servo->sense();
    // A stop came from outside: the tick in which it was answered tells it.
    if ((journal_.servo_faults[tick] & kServoStopped) != 0) parts_->servo->request_stop();
    sent_.add(parts_->servo->act().force);
    return {};
  }
  /// What came after the last servo tick.
  Status finish() {
    while (contacts_ < journal_.contact_hand.size())
      if (Status looked = contact(); !looked) return looked;
    while (bones_ < journal_.bone_contact.size())
      if (Status cut = bone(); !cut) return cut;
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

  Status contact() {
    if (contacts_ == journal_.contact_hand.size()) return out_of_rows();
    // It read this copy of bone, so the steps that made it came before; later ones may wait for what they cut by.
    while (parts_->bone->publisher().published() < journal_.contact_window[contacts_])
      if (Status cut = bone(); !cut) return cut;
    if (parts_->bone->publisher().published() != journal_.contact_window[contacts_]) return disorder();
    const HandState* hand = hand_->at(journal_.contact_hand[contacts_]);
    if (hand == nullptr) return out_of_rows();
    const ContactState& state = (*parts_->contact)(*hand);
    ++contacts_;
    parts_->force_mailbox.publish(state);
    if (wanted_.contains(contacts_)) kept_[contacts_] = state;
    return {};
  }
  Status bone() {
    if (bones_ == journal_.bone_contact.size()) return out_of_rows();
    const auto by = kept_.find(journal_.bone_contact[bones_]);
    if (by == kept_.end()) return disorder();
    kept_.erase(kept_.begin(), by);  // steps cut by ever newer results
    parts_->cut(by->second);
    if (parts_->bone->publisher().published() != journal_.bone_published[bones_]) return disorder();
    ++bones_;
    return {};
  }

  DrillParts* parts_;
  RecordedHand* hand_;
  Journal journal_;
  std::set<std::uint64_t> wanted_;              // results that bone is cut by
  std::map<std::uint64_t, ContactState> kept_;  // of those, the ones found and still needed
  std::uint64_t contacts_ = 0;
  std::size_t bones_ = 0;
  bool ran_out_ = false;
  Hash64 sent_;
};

}  // namespace

bool is_live(const SessionReader& session) noexcept { return session.stream("contact") != nullptr && session.stream("bone") != nullptr; }

Result<LiveReplayed> replay_live(DrillParts& parts, RecordedHand& hand, const SessionReader& session, const std::atomic<bool>* stop,
                                 const std::function<void(double time)>& progress) {
  auto journal = read_journal(session);
  if (!journal) return journal.error();
  const std::size_t ticks = journal->servo_contact.size();
  const bool unfinished = session.hashes().empty();  // the run did not come to its end
  const FlushToZero guard;
  Replay replay(parts, hand, std::move(journal).value());
  LiveReplayed out;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) return out;
    if (Status done = replay.servo(tick); !done) {
      if (!(replay.ran_out() && unfinished)) return done.error();
      out.cut_short = true;
      break;
    }
    ++out.ticks;
    if (progress && tick % 100 == 0) progress(static_cast<double>(tick) * parts.period);
  }
  if (!out.cut_short)
    if (Status done = replay.finish(); !done) {
      if (!(replay.ran_out() && unfinished)) return done.error();
      out.cut_short = true;
    }
  parts.voxmap->write_back();
  out.sent = replay.sent();
  return out;
}

}  // namespace burrhole
