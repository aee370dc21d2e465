// What an hour of a session takes on the disk, and its writer of the processor: a short run with tremor and spindle, extrapolated.
#include <doctest/doctest.h>

#include <ctime>
#include <filesystem>

#include "app/run/live_rows.h"
#include "app/session/session.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kSeconds = 4.0;        // touches down after 0.1 s and drills through
constexpr double kLargestHour = 500e6;  // bytes

SmallScene drilling() {
  return {.spindle = true, .record = true, .sets = {"hand.tremor_mm=0.1", "hand.standoff_mm=0.5", "erosion.rate_hz=250", "duration_s=4"}};
}

struct Copy {
  double bytes = 0.0, cpu_seconds = 0.0;
};

/// Writes the rows of a session once more, `times` one after the other.
Copy write_again(const SessionReader& from, const std::string& to, const SessionLayout& layout, int times) {
  std::vector<std::vector<double>> rows;
  for (const SessionStream& stream : from.streams()) rows.push_back(*from.rows(stream.name));
  const std::clock_t start = std::clock();
  auto writer = SessionWriter::create(to, from.meta(), layout);
  REQUIRE(writer);
  const std::size_t ticks = rows[0].size() / layout.streams[0].columns.size();
  for (int turn = 0; turn < times; ++turn) {
    std::vector<std::size_t> at(rows.size(), 0);
    for (std::size_t tick = 1; tick <= ticks; ++tick)
      for (std::size_t s = rows.size(); s-- > 0;) {
        const std::size_t width = layout.streams[s].columns.size(), due = rows[s].size() / width * tick / ticks;
        for (; at[s] < due; ++at[s]) REQUIRE(writer->append(s, std::span(rows[s]).subspan(at[s] * width, width)));
      }
  }
  REQUIRE(writer->close());
  return {static_cast<double>(std::filesystem::file_size(to)), static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC};
}

TEST_CASE("session: an hour of servo and contact at 1 kHz and bone at 250 Hz takes less than 500 MB") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite"), again = folder.file("again.sqlite");
  DrillRun run(drilling());
  run_recorded(run, path);
  CHECK(run.simulation().bone_step().removed_mass() > 0.0);
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  CHECK(session->row_count(kServoStream) == 4000);
  CHECK(session->row_count(kContactStream) == 4000);
  CHECK(session->row_count(kBoneStream) == 1000);
  const SessionLayout layout = session_layout(run.simulation().stage());
  CHECK(layout.streams == session->streams());

  // Between ten and one times the rows, so that the fixed part of the file does not count.
  const Copy once = write_again(*session, again, layout, 1), ten = write_again(*session, again, layout, 10);
  const double hour = (ten.bytes - once.bytes) / (9.0 * kSeconds) * 3600.0;
  double plain = 0.0;
  for (const SessionStream& stream : layout.streams)
    plain += 8.0 * static_cast<double>(stream.columns.size()) * static_cast<double>(session->row_count(stream.name)) / kSeconds * 3600.0;
  MESSAGE("an hour takes " << hour / 1e6 << " MB, as doubles " << plain / 1e6 << " MB; the writer takes "
                           << (ten.cpu_seconds - once.cpu_seconds) / (9.0 * kSeconds) * 1e3 << " ms of a processor per recorded second");
  CHECK(hour < kLargestHour);
  CHECK(plain > kLargestHour);  // the same rows as they are fail
}

}  // namespace
}  // namespace burrhole::test
