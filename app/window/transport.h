/// app/window/transport.h: the head of a watched session: run, pause, step, speed, jumps.
///   The replay computes the steps up to the head and reports how far it is. A jump back makes it begin again.
///   Units  s of recorded time.   Errors  none: every value is kept in its range.   Thread  one at a time.
#pragma once

namespace burrhole {

class Transport {
 public:
  static constexpr double kSlowest = 1.0 / 16.0, kFastest = 16.0;  ///< [-] of real time

  /// @param duration of the session. @param tick of its servo.
  Transport(double duration, double tick) noexcept;

  /// At the end it runs from the start.
  void run(bool runs) noexcept;
  void set_speed(double speed) noexcept;  ///< kept within kSlowest and kFastest
  void jump(double time) noexcept;
  /// Pauses, and moves the head by a signed time.
  void step(double by) noexcept;
  /// Moves the head of a session that runs. @param dt [s] of real time.
  void advance(double dt) noexcept;
  /// The replay has computed all steps before `time`.
  void arrive(double time) noexcept;
  /// There is nothing after `time`: the session of a process that was killed is shorter than its record of the hand.
  void end_at(double time) noexcept;

  [[nodiscard]] double head() const noexcept { return head_; }
  [[nodiscard]] double arrived() const noexcept { return arrived_; }
  [[nodiscard]] double duration() const noexcept { return duration_; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] bool runs() const noexcept { return runs_; }
  /// The head is before what has been computed.
  [[nodiscard]] bool is_behind() const noexcept { return head_ < arrived_ - 0.5 * tick_; }
  /// The replay has nothing to compute until the head moves.
  [[nodiscard]] bool has_arrived() const noexcept { return head_ < arrived_ + 0.5 * tick_; }
  /// The replay is on its way to the place of a jump; until it is there the picture stays as it is.
  [[nodiscard]] bool seeks() const noexcept { return seeks_; }

 private:
  double duration_, tick_;
  double head_ = 0.0, arrived_ = 0.0, speed_ = 1.0;
  bool runs_ = true, seeks_ = false;
};

}  // namespace burrhole
