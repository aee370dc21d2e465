#include "haptics/device/device_model.h"

#include <array>
#include <string>
#include <vector>

#include "core/base/units.h"
#include "core/config/toml.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

constexpr std::string_view kGenericSource = "generic test device", kLibrary = "CHAI3D 3.3.0", kSheet = "vendor sheet",
                           kDiolaiti = "Diolaiti et al. 2006";

constexpr Figure read(double value) { return {value, Provenance::read, kLibrary}; }
constexpr Figure recalled(double value, std::string_view source = kSheet) { return {value, Provenance::unverified, source}; }
constexpr Figure assumed(double value) { return {value, Provenance::assumed, kGenericSource}; }
constexpr Figure kAbsent{0.0, Provenance::absent, "none"};

// The generic test device.
constexpr Figure kForce = assumed(8.0), kRadius = assumed(0.10), kFriction = assumed(0.05), kMass = assumed(0.10), kDamping = assumed(0.5),
                 kQuantum = assumed(0.05 * kMillimetre);

constexpr std::array<DeviceModel, 12> kDevices{{
    {"falcon",
     "Novint Falcon",
     read(8.0),
     read(3000.0),
     read(20.0),
     read(0.04),
     kFriction,
     kMass,
     kDamping,
     // At the end of a leg: 0.0364 degrees of the 60 mm upper arm.
     {0.038 * kMillimetre, Provenance::derived, "libnifalcon geometry"}},
    {"touch", "Touch", read(3.3), read(400.0), read(4.0), read(0.075), recalled(0.26), recalled(0.045), kDamping,
     recalled(0.055 * kMillimetre)},
    {"omni", "PHANTOM Omni", read(3.3), read(700.0), read(5.0), read(0.10), recalled(0.26), recalled(0.045), kDamping,
     recalled(0.055 * kMillimetre)},
    {"desktop", "PHANTOM Desktop", read(7.9), read(1000.0), read(5.0), read(0.10), kFriction, kMass, kDamping, kQuantum},
    {"premium_1_5", "PHANTOM Premium 1.5 6DOF", read(8.5), read(800.0), read(5.0), read(0.12), recalled(0.04), recalled(0.075), kDamping,
     recalled(0.03 * kMillimetre)},
    {"premium_3_0", "PHANTOM Premium 3.0 6DOF", read(22.0), read(1000.0), read(5.0), read(0.25), kFriction, kMass, kDamping, kQuantum},
    {"omega_3", "omega.3", read(12.0), read(5000.0), read(30.0), read(0.075), kFriction, kMass, kDamping, recalled(0.01 * kMillimetre)},
    {"delta_3", "delta.3", read(20.0), read(5000.0), read(30.0), read(0.15), kFriction, kMass, kDamping, kQuantum},
    {"sigma_7", "sigma.7", read(12.0), read(4000.0), read(30.0), read(0.075), kFriction, kMass, kDamping, kQuantum},
    {"lambda_7", "lambda.7", read(12.0), read(8000.0), read(30.0), read(0.1125), kFriction, kMass, kDamping, kQuantum},
    {"phantom_1_0", "PHANToM 1.0", kForce, kAbsent, kAbsent, kRadius, recalled(0.038, kDiolaiti), recalled(0.072, kDiolaiti),
     recalled(0.005, kDiolaiti), recalled(0.03 * kMillimetre, kDiolaiti)},
    {"generic", "generic test device", kForce, kAbsent, kAbsent, kRadius, kFriction, kMass, kDamping, kQuantum},
}};

constexpr std::string_view kArm = "Sci Rep srep18004 fig. 3, one fitted trial", kGrip = "values chosen for tests";
constexpr Figure grip(double value) { return {value, Provenance::assumed, kGrip}; }
constexpr Figure arm(double value) { return {value, Provenance::read, kArm}; }

constexpr std::array<HandModel, 5> kHands{{
    {"none", "no hand", kAbsent, kAbsent, kAbsent},
    {"nominal", "nominal stylus grip", grip(0.15), grip(4.5), grip(300.0)},
    {"light", "light grip", grip(0.05), grip(0.5), grip(0.0)},
    {"firm", "firm grip", grip(0.6), grip(10.0), grip(1000.0)},
    {"arm", "arm on a HapticMaster", arm(0.554), arm(6.45), arm(135.0)},
}};

constexpr std::array<DeviceFigureName, 8> kFigures{{
    {"largest force", "N", &DeviceModel::largest_force},
    {"library stiffness limit", "N/m", &DeviceModel::library_stiffness},
    {"library damping limit", "N s/m", &DeviceModel::library_damping},
    {"workspace radius", "m", &DeviceModel::workspace_radius},
    {"friction", "N", &DeviceModel::friction},
    {"mass", "kg", &DeviceModel::mass},
    {"damping", "N s/m", &DeviceModel::damping},
    {"position step", "m", &DeviceModel::quantum},
}};

template <class Model>
Result<const Model*> find(std::span<const Model> models, std::string_view name, const char* what) {
  std::vector<std::string> names;
  for (const Model& model : models) {
    if (model.name == name) return &model;
    names.emplace_back(model.name);
  }
  std::string message = std::string("unknown ") + what + " \"" + one_line(name) + '"';
  if (const auto near = nearest_name(name, names)) return bad_input(message + "; did you mean \"" + *near + "\"?");
  message += "; there are";
  for (const std::string& known : names) message += ' ' + known;
  return bad_input(std::move(message));
}

}  // namespace

std::string_view name_of(Provenance provenance) noexcept {
  switch (provenance) {
    case Provenance::read:
      return "read";
    case Provenance::derived:
      return "derived";
    case Provenance::unverified:
      return "unverified";
    case Provenance::assumed:
      return "assumed";
    case Provenance::absent:
      break;
  }
  return "absent";
}

std::span<const DeviceFigureName> device_figure_names() noexcept { return kFigures; }
std::span<const DeviceModel> device_models() noexcept { return kDevices; }
std::span<const HandModel> hand_models() noexcept { return kHands; }
Result<const DeviceModel*> find_device(std::string_view name) { return find(device_models(), name, "device"); }
Result<const HandModel*> find_hand(std::string_view name) { return find(hand_models(), name, "hand"); }

MassSpringDamperConfig body_of(const DeviceModel& device, const HandModel& hand) noexcept {
  return {device.mass.value + hand.mass.value, device.damping.value + hand.damping.value, hand.stiffness.value};
}

}  // namespace burrhole
