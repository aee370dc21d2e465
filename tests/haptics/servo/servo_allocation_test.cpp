#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "haptics/servo/servo_step.h"
#include "tests/support/local_states.h"

using namespace burrhole;

namespace {
std::atomic<long> taken{0};
}

void* operator new(std::size_t size) {
  taken.fetch_add(1, std::memory_order_relaxed);
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

class StillHand final : public HandSource {
 public:
  [[nodiscard]] const HandState& read() noexcept override { return state_; }
  void apply(const Wrench&) noexcept override {
    ++state_.tick;
    state_.world_from_hand.translation.z = -1e-4 * static_cast<double>(state_.tick % 20);
  }

 private:
  HandState state_;
};

}  // namespace

TEST_CASE("ServoStep: a tick takes no memory, in any scheme, with every limit on and through servo faults and resets") {
  for (const MultiRateScheme scheme : {MultiRateScheme::hold, MultiRateScheme::linear, MultiRateScheme::gradient, MultiRateScheme::planes})
    for (const LocalKind kind : {LocalKind::none, LocalKind::penalty, LocalKind::coupled}) {
      StillHand hand;
      TripleBuffer<ContactState> contact;
      TripleBuffer<HandState> hands;
      ServoStep servo({.period = 1e-3,
                       .multi_rate = {.scheme = scheme, .contact_ticks = 10},
                       .largest_force = 5.0,
                       .largest_slew = 1e3,
                       .soft_start = 0.01,
                       .soft_stop = 0.01,
                       .max_contact_age = 10,
                       .max_hand_age = 10,
                       .energy = {.damping = 1.0, .tolerance = 1e-3, .largest_damping = 20.0}},
                      hand, contact, hands);
      ContactState state = test::coupled_state({});
      state.local.kind = kind;
      for (std::uint32_t n = 0; n < kMaxLocalPlanes; ++n) {
        HoldPlane plane = test::make_plane(test::random_unit(3, n), 1e-4 * uniform11(4, n), 1e-5, n);
        plane.arm = 0.01 * test::random_vector(5, n);
        plane.force = uniform01(6, n);
        state.local.planes[state.local.count++] = plane;
      }
      state.on_hand.force = Vec3(0.0, 0.0, 3.0);
      const long before = taken.load();
      for (std::uint64_t n = 0; n < 300; ++n) {
        state.number = 1 + n / 10;
        state.tick = hands.latest().tick;
        state.on_hand.force.x = n == 200 ? INFINITY : 0.0;
        if (n < 250) contact.publish(state);
        if (n == 220) servo.request_reset();
        servo();
      }
      CHECK(taken.load() == before);
    }
  const long before = taken.load();
  ::operator delete(::operator new(8));  // called by name, or a compiler may leave the pair out
  CHECK(taken.load() == before + 1);     // sabotage: the trap sees one
}
