#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "app/bench/areas.h"
#include "app/bench/dicom_series.h"
#include "volumes/import_bone.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr int kSlices = 300, kQuickSlices = 4;
constexpr double kMegabyte = 1e6;

/// A temporary folder, removed by the destructor.
class Folder {
 public:
  Folder()
      : path_(fs::temp_directory_path() / fmt::format("burrhole-bench-{}", std::chrono::steady_clock::now().time_since_epoch().count())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

/// @returns the peak memory of the process since the last call of forget_peak() [MB].
double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kilobytes = 0.0;
      status >> kilobytes;
      return kilobytes * 1024.0 / kMegabyte;
    }
  return 0.0;
}
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace

Status bench_import(Bench& bench) {
  const char* data = std::getenv("BURRHOLE_DATA");
  if (data == nullptr) {
    fmt::print(stderr, "bench: import needs real slices: BURRHOLE_DATA is not set; skipped\n");
    return {};
  }
  const Folder folder;
  const auto files =
      write_long_series((fs::path(data) / "head_ct_dicom_phantom_1mm").string(), folder.path(), bench.quick() ? kQuickSlices : kSlices);
  if (!files) return files.error();

  std::optional<Result<ReadScan>> scan;
  std::optional<Result<std::vector<float>>> plain;
  const Side reading{[&] { scan.reset(); }, [&] { scan.emplace(read_scan(folder.path(), {})); }};
  const Side plainly{[&] { plain.reset(); }, [&] { plain.emplace(read_plainly(*files)); }};
  plainly.run();
  reading.run();
  if (!*plain) return plain->error();
  if (!*scan) return scan->error();
  const std::string reads = fmt::format("{} DICOM slices of 512x512 to HU", files->size());
  if (bench.agree(reads, bytes_of(**plain), bytes_of((**scan).scan.values))) bench.add_cost(reads, "s", 1.0, bench.time(plainly, reading));
  scan.reset();
  plain.reset();

  // The complete import: wall time, and peak memory beyond that of the benchmark itself.
  forget_peak();
  const double before = peak_megabytes();
  const auto start = std::chrono::steady_clock::now();
  const auto imported = import_bone({folder.path(), {}, {}}, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!imported) return imported.error();
  const std::string whole = fmt::format("{} DICOM slices to a bone model", files->size());
  if (!bench.require(whole, imported->report.bone_voxels > 0, "no bone")) return {};
  bench.add_absolute(whole + ", wall", "s", seconds, true, {.ship = 10.0, .aim = 5.0});
  bench.add_absolute(whole + ", peak memory", "MB", peak_megabytes() - before, true, {.ship = 1500.0, .aim = 700.0});
  return {};
}

}  // namespace burrhole
