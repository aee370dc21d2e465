#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "haptics/device/device_model.h"

namespace burrhole::cli {
namespace {

using Json = nlohmann::ordered_json;

/// @returns "8 r": the scaled value and the initial of its provenance; "-" if there is no such figure.
std::string text_of(const Figure& figure, double scale) {
  if (figure.provenance == Provenance::absent) return "-";
  return fmt::format("{:.4g} {}", figure.value * scale, name_of(figure.provenance).substr(0, 1));
}

Json json_of(const Figure& figure) {
  if (figure.provenance == Provenance::absent) return nullptr;
  return {{"value", figure.value}, {"provenance", name_of(figure.provenance)}, {"source", figure.source}};
}

Json device_json(const DeviceModel& device) {
  Json out{{"name", device.name}, {"title", device.title}, {"simulated", true}, {"connected", false}};
  for (const DeviceFigureName& row : device_figure_names())
    out[std::string(row.name)] = {{"unit", row.unit}, {"figure", json_of(device.*row.figure)}};
  return out;
}

Json hand_json(const HandModel& hand) {
  return {{"name", hand.name},
          {"title", hand.title},
          {"mass_kg", json_of(hand.mass)},
          {"damping_N_s_per_m", json_of(hand.damping)},
          {"stiffness_N_per_m", json_of(hand.stiffness)}};
}

void print_devices() {
  print("Simulated devices: [device] name = \"NAME\" puts one between hand and drill.\n");
  print(fmt::format("{:<12} {:>10} {:>12} {:>10} {:>10} {:>10} {:>10}  {}\n", "name", "force N", "friction N", "mass kg", "N s/m",
                    "quantum um", "radius mm", "device"));
  for (const DeviceModel& d : device_models())
    print(fmt::format("{:<12} {:>10} {:>12} {:>10} {:>10} {:>10} {:>10}  {}\n", d.name, text_of(d.largest_force, 1.0),
                      text_of(d.friction, 1.0), text_of(d.mass, 1.0), text_of(d.damping, 1.0), text_of(d.quantum, 1e6),
                      text_of(d.workspace_radius, 1e3), d.title));
  print("\nHands: [device] hand = \"NAME\" selects the hand on it.\n");
  print(fmt::format("{:<12} {:>10} {:>10} {:>10}  {}\n", "name", "mass kg", "N s/m", "N/m", "hand"));
  for (const HandModel& h : hand_models())
    print(fmt::format("{:<12} {:>10} {:>10} {:>10}  {}\n", h.name, text_of(h.mass, 1.0), text_of(h.damping, 1.0), text_of(h.stiffness, 1.0),
                      h.title));
  print("\nr read in its source, d derived from it, u recalled and unverified, a assumed. This version supports no connected device.\n");
}

}  // namespace

void add_devices(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "devices", kSceneGroup,
      {.summary = "Lists the force devices and hands that can be simulated",
       .about = "Lists the devices and hands for a scene's [device] table. Each figure has its provenance: read in a source, derived from "
                "it, recalled and unverified, or assumed. This version supports no connected device.",
       .examples = {"burrhole devices", "burrhole drill parietal --set device.name=falcon --out out/falcon"},
       .exits = {}});
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "print the list as JSON on stdout, with the source of each figure, SI units");
  command->callback([json, &exit_code] {
    exit_code = kDone;
    if (!*json) return print_devices();
    Json out{{"devices", Json::array()}, {"hands", Json::array()}};
    for (const DeviceModel& device : device_models()) out["devices"].push_back(device_json(device));
    for (const HandModel& hand : hand_models()) out["hands"].push_back(hand_json(hand));
    print(out.dump(2) + "\n");
  });
}

}  // namespace burrhole::cli
