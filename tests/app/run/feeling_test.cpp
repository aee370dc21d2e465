// The force reaches the hand: with it the hand stops at the bone and drills at the bone's pace; cut, the hand goes on as if nothing were
// there.

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// Heights and speeds of the hand along the axis [m], [m/s], a value a servo tick.
struct HandTrack {
  std::vector<double> height, speed, tool_height;
};

HandTrack track(std::vector<std::string> sets) {
  const TemporaryFolder folder;
  DrillRun run(SmallScene{.record = true, .sets = std::move(sets)});
  run_recorded(run, folder.file("run.sqlite"));
  return {session_column(folder.file("run.sqlite"), "hand_z"), session_column(folder.file("run.sqlite"), "hand_vz"),
          session_column(folder.file("run.sqlite"), "tool_z")};
}

TEST_CASE("force feedback: bone stops the hand, and without it the hand goes on at its feed") {
  const HandTrack felt = track({"tool.spin_rpm=0", "hand.push_N=0", "duration_s=1"});
  const HandTrack cut = track({"tool.spin_rpm=0", "hand.push_N=0", "duration_s=1", "hand.feels=false"});
  const std::size_t before = 90, after = 900;  // ticks: 0.5 mm at 5 mm/s are met at 0.1 s
  MESSAGE("speed into bone before contact " << -felt.speed[before] * 1e3 << " mm/s; 0.8 s later " << -felt.speed[after] * 1e3
                                            << " mm/s felt, " << -cut.speed[after] * 1e3 << " mm/s with the feedback cut");
  CHECK(felt.speed[before] == cut.speed[before]);                            // nothing is felt in air: the same bits
  CHECK(-felt.speed[before] > 4.0e-3);                                       // about its feed, which a springy arm overshoots
  CHECK(std::abs(felt.speed[after]) < 0.05 * std::abs(felt.speed[before]));  // the rest position of the arm still creeps after it
  // 1 %: a second-order arm of 0.6 kg, 10 N s/m and 1000 N/m has forgotten its start (0.12 s) many times over.
  CHECK(std::abs(-cut.speed[after] - 5.0e-3) < 0.05e-3);
  MESSAGE("hand past the surface after 1 s: " << -felt.height.back() * 1e3 << " mm felt, " << -cut.height.back() * 1e3 << " mm cut");
  // Contact counts from 1 N, which is 0.2 mm of the coupling of 5000 N/m; without thrust the hand then rests no deeper.
  CHECK(-felt.height.back() < 0.3e-3);
  CHECK(-cut.height.back() > 3.5e-3);
}

TEST_CASE("force feedback: while drilling, a hand that feels nothing runs ahead of the tool") {
  const HandTrack felt = track({"duration_s=1.2"});
  const HandTrack cut = track({"duration_s=1.2", "hand.feels=false", "hand.feed_mm_per_s=8"});
  const auto ahead = [](const HandTrack& t) { return t.tool_height.back() - t.height.back(); };
  MESSAGE("hand ahead of the tool after 1.2 s: " << ahead(felt) * 1e3 << " mm felt, " << ahead(cut) * 1e3 << " mm cut; tool at "
                                                 << -felt.tool_height.back() * 1e3 << " and " << -cut.tool_height.back() * 1e3 << " mm");
  // In balance the coupling carries the thrust: 20 N over 5000 N/m are 4 mm, less what the arm holds back.
  CHECK(ahead(felt) < 4.05e-3);
  CHECK(ahead(felt) > 3.6e-3);
  CHECK(ahead(cut) > 1.2 * ahead(felt));
}

}  // namespace
}  // namespace burrhole::test
