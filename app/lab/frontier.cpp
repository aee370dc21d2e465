#include "app/lab/frontier.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <thread>

#include "app/lab/frontier_search.h"

namespace burrhole {
namespace {

constexpr std::array<MultiRateScheme, 4> kSchemes{MultiRateScheme::hold, MultiRateScheme::linear, MultiRateScheme::gradient,
                                                  MultiRateScheme::planes};
constexpr std::array<int, 10> kDivisors{1, 2, 4, 5, 8, 10, 20, 25, 40, 50};       // of 1 kHz: 1 kHz to 20 Hz
constexpr std::array<double, 7> kDampings{0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0};  // [N s/m] 10 is the default of a scene
constexpr std::array<const char*, 4> kHands{"none", "light", "nominal", "firm"};
constexpr int kFastServo = 5000;  // [Hz] above this rate a run takes twice the ticks: its oscillations are slow relative to the tick

/// A point to measure and its known parameters.
struct Point {
  FrontierRow row{};
  FrontierLoopConfig loop{};
  const DeviceModel* device = nullptr;  ///< for the theoretical limits of the device alone
  bool release = false;
  Release start{};
};

/// A device in a hand as in the linear theory: no friction, no quantisation, no force limit.
SimulatedDeviceConfig without_limits(SimulatedDeviceConfig config) {
  config.plant.friction = 0.0;
  config.quantum = 0.0;
  config.largest_force = std::numeric_limits<double>::infinity();
  return config;
}

SimulatedDeviceConfig held(const DeviceModel& device, std::string_view hand) {
  const auto found = find_hand(hand);
  BH_ASSERT(found.ok());
  return make_simulated_config(device, **found);
}

void fill(Point& point, const char* part, std::string_view device, std::string_view hand) {
  FrontierRow& row = point.row;
  const FrontierLoopConfig& loop = point.loop;
  row.part = part;
  row.device = device;
  row.hand = hand;
  row.bone = loop.bone == FrontierBone::plate ? "plate" : "sphere";
  row.start = !point.release ? "preloaded" : loop.drilling ? "drilling" : point.start.pressed ? "pressed" : "falls";
  row.scheme = name_of(loop.scheme);
  const MassSpringDamperConfig& body = loop.device.plant.body;
  row.mass = body.mass;
  row.damping = body.damping;
  row.spring = body.stiffness;
  row.servo_hz = loop.servo_hz;
  row.delay = loop.device.delay;
  row.contact_ticks = loop.contact_ticks;
  row.latency_ticks = loop.latency();
  row.coupling_damping = loop.coupling_damping;
}

void add_known(std::vector<Point>& points) {
  for (const KnownLimit& known : known_limits()) {
    Point point{.loop = loop_of(known)};
    fill(point, "known", known.name, "");
    point.row.known = known.stiffness;
    points.push_back(point);
  }
}

/// K over B of every device in every hand, preloaded and released.
void add_dampings(std::vector<Point>& points, bool thin) {
  for (const DeviceModel& device : device_models()) {
    if (thin && device.name != "generic") continue;
    for (const char* hand : kHands)
      for (const double damping : kDampings) {
        if (thin && damping > 1.0) continue;
        Point point{.loop = {.device = without_limits(held(device, hand)), .latency_ticks = -1, .coupling_damping = damping},
                    .device = &device};
        fill(point, "damping", device.name, hand);
        points.push_back(point);
        point.loop.device = held(device, hand);
        point.release = true;
        fill(point, "released", device.name, hand);
        points.push_back(point);
      }
  }
}

/// K over the contact rate, for each scheme: preloaded on a plate; falling, pressed and drilling on a sphere of the tool's radius.
void add_rates(std::vector<Point>& points, bool thin) {
  const auto generic = find_device("generic");
  BH_ASSERT(generic.ok());
  for (const char* hand : {"none", "nominal"})
    for (const MultiRateScheme scheme : kSchemes)
      for (const int divisor : kDivisors) {
        if (thin && divisor != 10) continue;
        Point point{
            .loop = {.device = without_limits(held(**generic, hand)), .contact_ticks = divisor, .latency_ticks = -1, .scheme = scheme},
            .device = *generic};
        fill(point, "rate", (*generic)->name, hand);
        points.push_back(point);
        if (std::string_view(hand) == "none") continue;  // without a hand it slides off the sphere
        point.loop.device = held(**generic, hand);
        point.loop.bone = FrontierBone::sphere;
        point.release = true;
        for (const bool pressed : {false, true}) {
          point.start.pressed = pressed;
          fill(point, "rate", (*generic)->name, hand);
          points.push_back(point);
        }
        point.loop.drilling = true;
        fill(point, "rate", (*generic)->name, hand);
        points.push_back(point);
      }
}

Status measure(Point& point) {
  const auto loop = FrontierLoop::create(point.loop);
  if (!loop) return loop.error();
  FrontierRow& row = point.row;
  if (point.release) {
    // Below 50 N/m a hand penetrates by centimetres and oscillates for longer than the run.
    const auto limit = release_limit(*loop, point.start, 50.0);
    if (!limit) return limit.error();
    row.measured = *limit;
    return {};
  }
  const SampledWall wall = wall_of(point.loop);
  row.exact = exact_stability_limit(wall);
  row.linear = delayed_linear_limit(wall);
  if (point.device != nullptr && row.part == "damping") {
    const double damping = point.device->damping.value;
    SampledWall now = wall;
    if (point.loop.scheme == MultiRateScheme::planes) now.latency_ticks = 0;  // its force uses the hand pose read in this tick
    row.passive = passive_limit(now, damping);
    row.linear = delayed_linear_limit(now);
    const auto quantised =
        quantised_passive_limit(damping, point.device->friction.value, point.device->quantum.value, 1.0 / point.loop.servo_hz);
    if (quantised) row.quantised = *quantised;
  }
  const auto limit = pressed_limit(*loop, row.exact, point.loop.servo_hz > kFastServo ? 16000 : 8000);
  if (!limit) return limit.error();
  row.measured = *limit;
  return {};
}

/// Workers take points in order; each writes its own row only.
Status measure_all(std::vector<Point>& points, const FrontierOptions& options) {
  std::atomic<std::size_t> next{0};
  std::mutex reporting;
  std::size_t done = 0;
  std::vector<Status> found(points.size());
  const auto work = [&] {
    for (std::size_t n = next++; n < points.size(); n = next++) {
      found[n] = measure(points[n]);
      const std::lock_guard lock(reporting);
      ++done;
      if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(points.size()));
    }
  };
  const unsigned wanted = options.workers > 0 ? options.workers : std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> workers;
  for (unsigned n = 0; n < wanted; ++n) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  for (const Status& status : found)
    if (!status) return status;
  return {};
}

}  // namespace

Result<std::vector<FrontierRow>> measure_frontier(const FrontierOptions& options) {
  std::vector<Point> points;
  add_known(points);
  add_dampings(points, options.thin);
  add_rates(points, options.thin);
  if (!options.part.empty()) std::erase_if(points, [&](const Point& point) { return point.row.part != options.part; });
  if (const Status measured = measure_all(points, options); !measured) return measured.error();
  std::vector<FrontierRow> rows;
  rows.reserve(points.size());
  for (Point& point : points) rows.push_back(std::move(point.row));
  return rows;
}

}  // namespace burrhole
