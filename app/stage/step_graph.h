/// app/stage/step_graph.h: the steps of a run, the values that they exchange (slots), and the execution order that follows from slot uses.
///   A slot has a name and a type. While a step is bound, it declares its access to each slot that it uses:
///     own     writes; the only writer
///     add     writes; one of several contributors. The slot is reset before each tick of its clock.
///     now     reads the value of this tick: runs after the writers
///     last    reads the value of the previous tick: runs before the writer. Not for slots with `add`, which keep no previous value.
///     latest  reads a slot of another clock: the newest message at the start of the reader's tick. The number of the message is recorded.
///   Steps of one clock run in an order that satisfies these uses. Steps that do not depend on each other run in the order of binding.
///   Steps of other clocks cannot read slots of the frame and audio clocks, and steps of these two have no columns. A session has no rows
///   for the frame clock, and for the audio clock only the numbers of the messages that it read. A picture reads the values that the simulation wrote up to the step that the picture shows.
///   Errors   bad_input, of resolve().
///   Threads  bind and resolve() while no clock runs. run(clock) by the thread of that clock: never waits, never allocates.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeindex>
#include <vector>

#include "core/base/assert.h"
#include "core/base/result.h"
#include "core/base/step_timer.h"
#include "core/base/triple_buffer.h"

namespace burrhole {

/// frame: one tick per picture. audio: one tick per block of sound, of length kAudioPeriod.
enum class Clock : std::uint8_t { servo, contact, simulation, frame, audio };
inline constexpr std::size_t kClocks = 5;
inline constexpr double kAudioPeriod = 0.01;  ///< [s]
[[nodiscard]] const char* name_of(Clock clock) noexcept;

enum class Access : std::uint8_t { own, add, now, last, latest };

/// Identifies a slot. `start` is its value before the first write, and the value to which an `add` slot is reset.
template <class T>
struct SlotKey {
  const char* name;
  T start{};
};

struct Tick {
  std::uint64_t number = 0;  ///< number of the tick of its clock, from 0
  double dt = 0.0;           ///< [s] duration of the tick; 0 on the frame clock
};

/// What the values of a column mean if they are states: the value, rounded down, is the index of a text. The run starts in the first state;
/// each change is an event of the run, with this kind and the text of the new state.
struct ColumnStates {
  const char* kind = nullptr;            ///< null: the values are no states
  std::span<const char* const> texts{};  ///< of static storage; at least one
};

/// A recorded value: a column in the session's stream of a clock.
struct StepColumn {
  std::string name, unit;
  const double* value = nullptr;  ///< [unit] as in `unit`
  bool exact = false;             ///< true: every bit of every tick is recorded; false: rounded, and not every tick, for plots
  ColumnStates states{};
};

class StepGraph {
 public:
  static constexpr std::size_t kMaxColumns = 24;  ///< of all steps of a clock
  /// Steps of the servo and contact clocks must not throw or allocate.
  using Run = void (*)(void* self, const Tick& tick);

  /// Declares the slot uses of a step. The returned pointers are valid as long as the graph.
  class Binder {
   public:
    template <class T>
    [[nodiscard]] T* own(const SlotKey<T>& key) {
      return static_cast<T*>(use(key, Access::own));
    }
    template <class T>
    [[nodiscard]] T* add(const SlotKey<T>& key) {
      return static_cast<T*>(use(key, Access::add));
    }
    template <class T>
    [[nodiscard]] const T* now(const SlotKey<T>& key) {
      return static_cast<const T*>(use(key, Access::now));
    }
    template <class T>
    [[nodiscard]] const T* last(const SlotKey<T>& key) {
      return static_cast<const T*>(use(key, Access::last));
    }
    template <class T>
    [[nodiscard]] const T* latest(const SlotKey<T>& key) {
      return static_cast<const T*>(use(key, Access::latest));
    }
    /// As now(), but the slot need not have a writer; it then keeps its start value.
    template <class T>
    [[nodiscard]] const T* now_if_written(const SlotKey<T>& key) {
      const T* value = now(key);
      graph_->steps_[step_].uses.back().optional = true;
      return value;
    }
    /// As latest(), but the slot need not have a writer; it then keeps its start value.
    template <class T>
    [[nodiscard]] const T* latest_if_written(const SlotKey<T>& key) {
      const T* value = latest(key);
      graph_->steps_[step_].uses.back().optional = true;
      return value;
    }
    /// Records `*value` with each tick of the step's clock.
    /// @param exact as StepColumn::exact.
    Binder& column(std::string name, std::string unit, const double* value, bool exact = false);
    /// The same for a value that is a state, whose changes are events of the run. Only on the contact clock.
    Binder& column(std::string name, const ColumnStates& states, const double* value);

   private:
    friend class StepGraph;
    Binder(StepGraph& graph, std::size_t step) : graph_(&graph), step_(step) {}
    template <class T>
    void* use(const SlotKey<T>& key, Access access) {
      static_assert(std::is_trivially_copyable_v<T>, "a slot carries plain values only");
      return graph_->use(step_, key.name, typeid(T), &key.start, sizeof(T), alignof(T), access);
    }
    StepGraph* graph_;
    std::size_t step_;
  };

  /// Adds a step. @param effect table of its effect. @param name unique name, used in timings. @param self must outlive the run.
  Binder step(Clock clock, std::string_view effect, std::string_view name, Run call, void* self);
  /// Declares that the stage reads a slot on a clock, after the clock's steps. resolve() refuses writers on another clock.
  template <class T>
  void reads(Clock clock, const SlotKey<T>& key) {
    read_by_stage_.push_back({key.name, clock});
  }
  /// Adds a slot that the stage writes before it runs the clock's steps.
  template <class T>
  [[nodiscard]] T* provide(Clock clock, const SlotKey<T>& key) {
    static_assert(std::is_trivially_copyable_v<T>, "a slot carries plain values only");
    return static_cast<T*>(provide(clock, key.name, typeid(T), &key.start, sizeof(T), alignof(T)));
  }

  /// For the stage: @returns the value of a declared slot; null if there is none.
  template <class T>
  [[nodiscard]] const T* find(const SlotKey<T>& key) const noexcept {
    for (const Slot& slot : slots_)
      if (slot.name == key.name && slot.type == typeid(T)) return static_cast<const T*>(slot.value.data());
    return nullptr;
  }

  /// The same with write access, for the stage to complete a slot that an effect owns.
  template <class T>
  [[nodiscard]] T* written(const SlotKey<T>& key) noexcept {
    return const_cast<T*>(find(key));
  }

  /// Sorts the steps of each clock and connects clocks. bad_input, with the slot and the effects: a slot that is read but not written, two
  /// owners, an owner and contributors, a slot of two types, `now` or `last` across clocks, `latest` within one clock, `last` of a slot
  /// that is added to, a cycle, a column that cannot be recorded, more than kMaxColumns on a clock, states on another clock than contact.
  [[nodiscard]] Status resolve();
  /// @returns whether a step owns or adds to the slot of that name.
  [[nodiscard]] bool is_written(std::string_view slot) const noexcept;
  /// @returns whether a step reads the slot of that name.
  [[nodiscard]] bool is_read(std::string_view slot) const noexcept;

  /// Runs one tick of a clock: receives messages of other clocks, resets `add` slots, runs the steps, sends the values that other clocks
  /// read.
  void run(Clock clock, const Tick& tick) BH_REALTIME;
  /// The parts of run(), for a stage that hands over more than messages: what it publishes for another clock goes before send(), and what
  /// it takes from another clock comes after receive(). So a message never precedes the copy of bone that belongs to it.
  void receive(Clock clock) BH_REALTIME;
  void run_steps(Clock clock, const Tick& tick) BH_REALTIME;
  void send(Clock clock) BH_REALTIME;
  /// @returns whether the clock has no step.
  [[nodiscard]] bool empty(Clock clock) const noexcept { return lanes_[index(clock)].steps.empty(); }

  /// @returns the columns of a clock: those of its steps, in execution order, then one with the message number for each of sources().
  [[nodiscard]] const std::vector<StepColumn>& columns(Clock clock) const noexcept { return lanes_[index(clock)].columns; }
  /// For replay: selects the messages that the next tick of `reader` receives. @param numbers one message number for each of
  /// sources(reader), in that order; 0: none. @returns the clock of the first message that does not exist yet; nothing when all exist.
  [[nodiscard]] std::optional<Clock> want(Clock reader, std::span<const double> numbers);
  /// @returns the clocks whose messages `reader` receives, in the order of the columns with their message numbers.
  [[nodiscard]] std::vector<Clock> sources(Clock reader) const;
  /// For replay, before the first tick: from now on every message is kept until it has been received, and a tick receives the messages
  /// selected by want() instead of the newest. The frame clock still receives the newest.
  void keep_messages() noexcept { keeps_messages_ = true; }

  /// Copies the timings of another graph's steps, by name, so that timings continue after a rebind.
  void keep_timings(StepGraph& before);

  struct StepInfo {
    std::string effect, name;
    Clock clock;
    StepTimer* timer;
    const std::atomic<float>* mean_us;  ///< [us] of the latest calls; any thread may read it
  };
  /// @returns all steps in execution order, clock by clock.
  [[nodiscard]] std::vector<StepInfo> steps();
  /// @returns the bytes of all slots.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::size_t kMessageBytes = 256;
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  static constexpr std::size_t index(Clock clock) noexcept { return static_cast<std::size_t>(clock); }

  struct Message {
    std::uint64_t number = 0;  // of the writer's tick, from 1; 0: none yet
    std::array<std::byte, kMessageBytes> bytes{};
  };
  struct Block {  // zeroed memory of one value, aligned for any type
    std::unique_ptr<std::max_align_t[]> memory;
    std::size_t size = 0;
    void* data() const noexcept { return memory.get(); }
  };
  struct Mirror {  // of a slot, for readers on another clock
    Clock reader;
    Block value;
  };
  struct Slot {
    std::string name;
    std::type_index type;
    Block start, value;
    bool provided = false;
    std::size_t owner = kNone;
    std::vector<std::size_t> adders{};
    Clock writer = Clock::servo;
    bool written = false;
    std::vector<Mirror> mirrors{};
  };
  struct SlotUse {
    std::size_t slot;
    Access access;
    bool optional = false;
  };
  struct BoundStep {
    std::string effect, name;
    Clock clock;
    Run run;
    void* self;
    std::vector<SlotUse> uses{};
    std::vector<StepColumn> columns{};
    StepTimer timer{};
    std::shared_ptr<std::atomic<float>> mean_us = std::make_shared<std::atomic<float>>(0.0f);
  };
  struct Copy {  // of one value between a slot and a message
    void* value;
    std::size_t at, size;
  };
  struct Link {
    Clock writer, reader;
    std::vector<Copy> out, in;
    TripleBuffer<Message> buffer;
    Message message;           // scratch of the writer
    double taken = 0.0;        // number of the message that the reader took last
    std::deque<Message> kept;  // for replay: messages not received yet
    double wanted = -1.0;      // for replay: number of the message to take next
  };
  struct Lane {                      // a clock
    std::vector<std::size_t> steps;  // sorted
    std::vector<std::size_t> resets;
    std::vector<Link*> links_in, links_out;
    std::vector<StepColumn> columns;
    std::uint64_t ticks = 0;
  };

  [[nodiscard]] std::size_t find_or_make(const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align);
  [[nodiscard]] void* use(std::size_t step, const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align,
                          Access access);
  [[nodiscard]] void* provide(Clock clock, const char* name, std::type_index type, const void* start, std::size_t size, std::size_t align);
  [[nodiscard]] Status check_slots() const;
  [[nodiscard]] Status check_uses(const BoundStep& step) const;
  [[nodiscard]] Status check_columns() const;
  [[nodiscard]] Status sort(Clock clock);
  [[nodiscard]] Status connect();
  [[nodiscard]] std::string who(const Slot& slot) const;
  void take(Link& link) noexcept;

  std::deque<BoundStep> steps_;
  std::deque<Slot> slots_;
  std::vector<std::unique_ptr<Link>> links_;
  std::array<Lane, kClocks> lanes_;
  std::vector<std::pair<std::string, Clock>> read_by_stage_;
  std::string mismatch_;  // a slot that was named with two types
  bool keeps_messages_ = false;
};

}  // namespace burrhole
