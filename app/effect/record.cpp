// [record]: the session file, from which a run is replayed. The schedules write its rows between their steps; see app/run/run_log.h.

#include "app/effect/registry.h"
#include "app/stage/stage.h"

namespace burrhole {
namespace {

struct RecordConfig {
  std::string path = "session.sqlite";  ///< relative to the output folder
};

class RecordEffect final : public Effect {
 public:
  Status bind(StepGraph&) override { return {}; }
  [[nodiscard]] StepTimer& timer() noexcept { return timer_; }
  std::vector<NamedTimer> timers() const override {
    if (timer_.timing().count == 0) return {};  // a run without an output folder
    return {{"record", &timer_, false}};
  }

 private:
  StepTimer timer_;  // of the rows of one servo tick
};

class RecordPlan final : public ConfigPlan<RecordPlan, RecordConfig> {
 public:
  RecordPlan(TableReader& table, const StageConfig&) {
    config_.path = table.text("path", config_.path, "session file, relative to the output folder");
  }
  PlanRow row(const PlanContext& context) const override {
    // A second of exact columns (hand: pose, velocity, thrust, spin; counters) before compression; coarse ones are a few percent of them.
    constexpr std::uint64_t kExactColumns = 20;
    return {.table = "record",
            .clock = Clock::servo,
            .step = "session rows, after the steps",
            .needs = "everything above",
            .gives = "session file",
            .detail = "bytes of one second, committed every second",
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = kExactColumns * sizeof(double) * static_cast<std::uint64_t>(context.config.servo_hz)};
  }
  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto effect = std::make_unique<RecordEffect>();
    stage.offer_record(config_.path, effect->timer());
    return std::unique_ptr<Effect>(std::move(effect));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<RecordPlan>(table, stage);
}

}  // namespace

EffectEntry record_effect() { return {"record", "session file, from which a run is replayed; without it none is written", read}; }

}  // namespace burrhole
