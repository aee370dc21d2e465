// [record]: the session file, from which a run is replayed. The schedules write its rows between their steps; see app/run/run_log.h.

#include <filesystem>

#include "app/effect/registry.h"
#include "app/stage/result_files.h"
#include "app/stage/stage.h"

namespace burrhole {
namespace {

struct RecordConfig {
  std::string path = kSessionFile;  ///< relative to the output folder
};

/// @returns why a path is no name for a session below the output folder; empty: it is one.
std::string why_no_path(const std::string& path) {
  const std::filesystem::path given(path), plain = given.lexically_normal();
  bool leaves = given.is_absolute();
  for (const auto& part : given) leaves = leaves || part == "..";
  if (leaves) return "leaves the output folder: give a path below it, without a leading / and without ..";
  if (!plain.has_filename() || plain == ".") return "names no file";
  if (is_result_name(plain.begin()->string())) return "is the name of another result of a run: choose another";
  // SQLite keeps files of these names beside a session, and would read one into the next session of the folder.
  for (const char* ending : {"-wal", "-shm", "-journal"})
    if (plain.filename().string().ends_with(ending)) return "ends as a file that SQLite keeps beside a session: choose another";
  return {};
}

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
    config_.path = table.text("path", config_.path, "session file below the output folder; no name of another result of a run");
    if (const std::string why = why_no_path(config_.path); !why.empty()) table.fault("path", why);
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
