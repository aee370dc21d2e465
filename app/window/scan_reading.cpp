#include "app/window/scan_reading.h"

#include <utility>

#include "app/run/start_thread.h"
#include "app/scene/volume_scene.h"

namespace burrhole {
namespace {

constexpr double kOverviewVoxel = 1.0e-3;  // [m] enough for a picture of a head and for the direction of its surface

}  // namespace

ImportRequest overview_request(const SkullSource& source, bool is_grids) {
  ImportRequest out{source.path, {}, {}};
  if (!source.unit.empty()) out.read.unit = length_unit(source.unit);
  // A .vdb without a unit is a bone model, which is used at its own voxels, or an error.
  if (!is_grids || !source.unit.empty()) out.bone.spacing = out.read.pitch = kOverviewVoxel;
  return out;
}

ScanReading::ScanReading(SkullSource source, bool is_grids) : source_(std::move(source)), is_grids_(is_grids) {
  const Status started = start_thread(thread_, [this] {
    // An exception may not leave the thread, and its text needs memory, of which there may be none.
    try {
      ImportRequest request = overview_request(source_, is_grids_);
      request.read.stop = stop_.get_token();
      request.read.progress = [this](double share) { share_.store(share, std::memory_order_relaxed); };
      bone_.emplace(import_bone(request, {}));
    } catch (...) {
      thrown_ = std::current_exception();
    }
    done_.store(true, std::memory_order_release);
  });
  if (started) return;
  bone_.emplace(started.error());
  done_.store(true, std::memory_order_release);
}

ScanReading::~ScanReading() {
  stop_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::optional<Result<ImportedBone>> ScanReading::take() {
  if (!has_ended()) return std::nullopt;
  if (thrown_) return Result<ImportedBone>(error_of(std::exchange(thrown_, nullptr)));
  return std::exchange(bone_, std::nullopt);
}

}  // namespace burrhole
