// [record]: the session file, from which a run is replayed. The schedules write its rows between their steps; see app/run/run_log.h.

#include "app/effect/record.h"

#include "app/effect/registry.h"
#include "app/stage/stage.h"

namespace burrhole {
namespace {

class RecordEffect final : public Effect {
 public:
  Status bind(StepGraph&) override { return {}; }
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
            .clock = Clock::frame,
            .step = "session rows",
            .needs = "everything above",
            .gives = "session file",
            .detail = "bytes of one second, committed every second",
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = kExactColumns * sizeof(double) * static_cast<std::uint64_t>(context.config.servo_hz)};
  }
  Result<std::unique_ptr<Effect>> make(Stage&) const override { return std::unique_ptr<Effect>(std::make_unique<RecordEffect>()); }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<RecordPlan>(table, stage);
}

}  // namespace

EffectEntry record_effect() { return {"record", "session file, from which a run is replayed; without it none is written", read}; }

}  // namespace burrhole
