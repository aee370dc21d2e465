#include "app/bench/step_replay.h"

#include "app/bench/stopwatch.h"
#include "core/base/hash.h"

namespace burrhole {
namespace {

constexpr std::size_t kNodeBytes = 2 * sizeof(float) + sizeof(Record16) + sizeof(std::int16_t);  // of CutSurface::Block, by node
using Blocks = std::vector<std::pair<Vec3i, CutSurface::Block>>;

bool same(const Record16& a, const Record16& b) noexcept {
  return a.distance == b.distance && a.nx == b.nx && a.ny == b.ny && a.nz == b.nz;
}

std::size_t count_changed_nodes(const CutSurface& before, const CutSurface& now) {
  const CutSurface::Block none{};
  std::size_t changed = 0;
  for_each_voxel(blocks_of(now.box()), [&](const Vec3i& at) {
    const CutSurface::Block *was = before.find(at), *is = now.find(at);
    if (is == nullptr) return;
    if (was == nullptr) was = &none;
    for (std::size_t n = 0; n < kBlockVoxels; ++n)
      changed += was->base[n] == is->base[n] && was->cut[n] == is->cut[n] && same(was->record[n], is->record[n]) ? 0 : 1;
  });
  return changed;
}

CutSurface copy_of(const CutSurface& cut) {
  CutSurface out;
  for_each_voxel(blocks_of(cut.box()), [&](const Vec3i& at) {
    if (const auto* nodes = cut.find(at)) out.add(at) = *nodes;
  });
  return out;
}

std::span<const Record16> records_of(const ContactWindow& copy) {
  const auto* records = std::get_if<std::vector<Record16>>(&copy.records);
  return records != nullptr ? std::span<const Record16>(*records) : std::span<const Record16>();
}

}  // namespace

// Each value counts once where a step must read or write it.
//   removal     nodes that change; occupancy, hardness and remaining of voxels that change
//   commit      occupancy and remaining in, density out, of all voxels of the committed boxes
//   publishing  records that change; all fields of the voxels that are copied to the snapshot
std::size_t StepCounts::bytes_read() const noexcept {
  return nodes * kNodeBytes + 3 * sizeof(float) * voxels + 2 * sizeof(float) * committed + copied_bytes;
}

std::size_t StepCounts::bytes_written() const noexcept {
  return nodes * kNodeBytes + sizeof(float) * voxels + sizeof(float) * committed + sizeof(Record16) * records + copied_bytes;
}

Result<StepReplay> StepReplay::create(RecordedSteps& recorded) {
  const ContactFields& fields = recorded.loaded->scene.effects.needs(recorded.loaded->scene).fields;
  if (fields.records != RecordPrecision::bits16 || recorded.inputs.size() <= kWarmUp)
    return Error{ErrorCode::internal, "the bone steps have no records of 16 bits, or are too few", {}};
  StepReplay out(recorded);
  if (Status begun = out.begin(); !begun) return begun.error();
  return out;
}

Status StepReplay::begin() {
  const LoadedScene& loaded = *recorded_->loaded;
  auto erosion = Erosion::create(*loaded.scene.find<ErosionConfig>(), loaded.tool.erosion, loaded.tool.cutting);
  if (!erosion) return erosion.error();
  erosion_.emplace(std::move(erosion).value());
  // An Erosion knows no mean lag in its first step, and finds lags at a rim that differ by the last digits. That step is taken on a copy of
  // its own.
  for (const bool first : {true, false}) {
    auto bone = copy_of_bone(loaded.bone, *recorded_->before, recorded_->window);
    if (!bone) return bone.error();
    bone_.emplace(std::move(bone).value());
    if (first) (void)erode(recorded_->inputs.front());
  }
  publisher_ = std::make_unique<ContactWindowPublisher>(*bone_, loaded.scene.effects.needs(loaded.scene).fields, true);  // as in lockstep
  publish();  // the copy is written whole once
  StepTimes times;
  for (const StepInput& input : std::span(recorded_->inputs).first(kWarmUp)) run(input, times);
  return {};
}

const ContactWindow& StepReplay::publish() {
  publisher_->publish(*bone_);
  return publisher_->exchange().latest();
}

ErosionOutcome StepReplay::erode(const StepInput& input) {
  if (input.cut.far) return {};
  return erosion_->step(*bone_, input.cut.path, CuttingLoad{input.spin, input.cut.thrust, input.cut.reaction}, input.dt);
}

void StepReplay::run(const StepInput& input, StepTimes& times) {
  const double start = cpu_seconds();
  const ErosionOutcome outcome = erode(input);
  const double removed = cpu_seconds();
  bone_->commit(outcome.changed);
  const double committed = cpu_seconds();
  if (!outcome.changed.empty()) publish();
  times.removal += removed - start;
  times.commit += committed - removed;
  times.publishing += cpu_seconds() - committed;
  committed_ = outcome.changed.count();
}

StepCounts StepReplay::count(const StepInput& input) {
  const MasterWindow& window = bone_->window();
  const std::vector<float> remaining = window.remaining;
  const CutSurface cut = copy_of(bone_->cut());
  const std::span<const Record16> newest = records_of(publisher_->exchange().latest());
  const std::vector<Record16> records(newest.begin(), newest.end());
  const std::uint64_t copied = publisher_->copied_voxels();
  StepTimes times;
  run(input, times);
  StepCounts out;
  for_each_voxel(window.box, [&](const Vec3i& v) {
    const std::size_t at = window.box.offset_of(v);
    if (window.remaining[at] == remaining[at]) return;
    out.box.include(v);
    ++out.voxels;
  });
  out.nodes = count_changed_nodes(cut, bone_->cut());
  const std::span<const Record16> now = records_of(publisher_->exchange().latest());
  for (std::size_t n = 0; n < now.size(); ++n) out.records += same(now[n], records[n]) ? 0 : 1;
  out.committed = committed_;
  out.copied = publisher_->copied_voxels() - copied;
  out.copied_bytes = out.copied * bytes_a_voxel(publisher_->fields());
  return out;
}

std::vector<std::uint64_t> StepReplay::hashes() {
  Hash64 remaining, density, records;
  for (const float left : bone_->window().remaining) remaining.add(left);
  const ContactWindow& copy = publisher_->exchange().latest();
  for (const float each : copy.density) density.add(each);
  for (const Record16& each : records_of(copy)) records.add(std::bit_cast<std::uint64_t>(each));
  return {remaining.value(), density.value(), records.value()};
}

}  // namespace burrhole
