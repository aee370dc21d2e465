#include <doctest/doctest.h>

#include <cstdlib>
#include <memory>
#include <new>

#include "tests/haptics/device/wall_loop.h"

using namespace burrhole;

namespace {

// Allocations of this program, counted while armed. One thread runs the tests.
bool g_armed = false;
int g_allocations = 0;

void* counted(std::size_t size) {
  if (g_armed) ++g_allocations;
  if (void* block = std::malloc(size > 0 ? size : 1)) return block;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t) noexcept { std::free(block); }

namespace {

template <class Work>
int allocations_of(Work&& work) {
  g_allocations = 0;
  g_armed = true;
  work();
  g_armed = false;
  return g_allocations;
}

}  // namespace

TEST_CASE("servo path: a simulated device, the hand on it and its script allocate nothing in a tick") {
  test::WallLoopConfig config;
  config.device = make_simulated_config(*find_device("falcon").value(), *find_hand("nominal").value());
  const auto loop = std::make_unique<test::WallLoop>(config, 1000.0, 1e-3, 0.1);
  CHECK(allocations_of([&] {
          for (int n = 0; n < 2000; ++n) loop->tick();
        }) == 0);
  SimulatedDevice device = SimulatedDevice::create(config.device, 1e-3).value();
  ScriptedDeviceHand hand = ScriptedDeviceHand::create(device, {}, {}, {}, 1e-3).value();
  const auto drill = [&] {
    for (int n = 0; n < 6000; ++n) {
      const double height = hand.read().world_from_hand.translation.z;
      hand.apply({{0.0, 0.0, n < 4000 && height < 0.0 ? -1000.0 * height : 0.0}, Vec3(0.0)});
    }
  };
  CHECK(allocations_of(drill) == 0);
  CHECK(allocations_of([] { static_cast<void>(std::make_unique<int>(1)); }) == 1);  // sabotage: the count counts
}
