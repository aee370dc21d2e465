/// app/window/scan_reading.h: reads a scan on a thread of its own, for a window that shows how far it is.
///   Errors  those of import_bone(), one line.   Thread  create, poll and destroy on one; the destructor stops the reading.
#pragma once

#include <atomic>
#include <exception>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "app/window/skull_site.h"
#include "volumes/import_bone.h"

namespace burrhole {

/// @returns how a scan is read for a picture of the whole bone: at 1 mm; a bone model at its own voxels. @param is_grids a .vdb.
[[nodiscard]] ImportRequest overview_request(const SkullSource& source, bool is_grids);

class ScanReading {
 public:
  ScanReading(SkullSource source, bool is_grids);
  ScanReading(const ScanReading&) = delete;
  ScanReading& operator=(const ScanReading&) = delete;
  ~ScanReading();

  /// Asks the reading to end; does not wait.
  void stop() noexcept { stop_.request_stop(); }
  [[nodiscard]] const SkullSource& source() const noexcept { return source_; }
  [[nodiscard]] bool is_grids() const noexcept { return is_grids_; }
  [[nodiscard]] double share() const noexcept { return share_.load(std::memory_order_relaxed); }  ///< [-] done, 0..1
  [[nodiscard]] bool has_ended() const noexcept { return done_.load(std::memory_order_acquire); }
  /// @returns the bone or the error once the reading has ended; nothing before, and nothing the second time.
  [[nodiscard]] std::optional<Result<ImportedBone>> take();

 private:
  SkullSource source_;
  bool is_grids_;
  std::atomic<double> share_{0.0};
  std::atomic<bool> done_{false};
  std::optional<Result<ImportedBone>> bone_;
  std::exception_ptr thrown_;
  std::stop_source stop_;
  std::thread thread_;
};

}  // namespace burrhole
