#include "app/run/live_rows.h"

namespace burrhole {

EffectValues effect_values(const StepGraph& graph, Clock clock) noexcept {
  EffectValues out;
  for (const StepColumn& column : graph.columns(clock)) out.values[out.count++] = *column.value;
  return out;
}

namespace {

void append_columns(const StepGraph& graph, Clock clock, SessionStream& out) {
  for (const StepColumn& column : graph.columns(clock))
    out.columns.push_back({column.name, column.unit, column.exact ? Keep::exact : Keep::coarse});
}

void append_values(const EffectValues& values, std::vector<double>& out) {
  out.insert(out.end(), values.values.begin(), values.values.begin() + values.count);
}

}  // namespace

ServoRow servo_row(const Stage& stage, const ServoOutput& servo) noexcept {
  ServoRow row;
  row.hand = servo.hand;
  row.force = servo.force;
  row.contact = servo.contact_number;
  row.faults = servo.faults;
  row.effects = effect_values(stage.graph, Clock::servo);
  return row;
}

ContactRow contact_row(const Stage& stage, std::uint64_t window) noexcept {
  const ContactTick& contact = *stage.contact;
  const ContactState& state = contact.state();
  ContactRow row;
  row.number = state.number;
  row.hand_tick = contact.hand_tick();
  row.window = window;
  row.time = contact.time();
  row.world_from_tool = state.world_from_tool;
  row.world_from_rest = state.bone.world_from_rest;
  row.progress = contact.progress();
  row.step_us = contact.step_us();
  row.effects = effect_values(stage.graph, Clock::contact);
  return row;
}

BoneRow bone_row(Stage& stage, std::uint64_t contact) noexcept {
  BoneRow row;
  row.contact = contact;
  row.published = stage.bone->published();
  row.effects = effect_values(stage.graph, Clock::simulation);
  row.removed = stage.bone->removed_mass();
  return row;
}

SessionLayout session_layout(const Stage& stage) {
  constexpr Keep kCoarse = Keep::coarse;
  SessionStream servo{kServoStream, {{"hand_x", "m"},          {"hand_y", "m"},          {"hand_z", "m"},          {"hand_vx", "m/s"},
                                     {"hand_vy", "m/s"},       {"hand_vz", "m/s"},       {"hand_qw", ""},          {"hand_qx", ""},
                                     {"hand_qy", ""},          {"hand_qz", ""},          {"thrust", "N"},          {"phase", ""},
                                     {"hand_tick", ""},        {"hand_flags", ""},       {"spin_command", ""},     {"switches", ""},
                                     {"sent_x", "N", kCoarse}, {"sent_y", "N", kCoarse}, {"sent_z", "N", kCoarse}, {"contact", ""},
                                     {"faults", ""},           {"skipped", ""}}};
  SessionStream contact{kContactStream, {{"number", ""}, {"hand_tick", ""}, {"window", ""}, {"skipped", ""}}};
  SessionStream bone{kBoneStream, {{"contact", ""}, {"published", ""}, {"skipped", ""}}};
  append_columns(stage.graph, Clock::servo, servo);
  append_columns(stage.graph, Clock::contact, contact);
  append_columns(stage.graph, Clock::simulation, bone);
  if (records_audio(stage)) {
    SessionStream audio{kAudioStream, {}};
    append_columns(stage.graph, Clock::audio, audio);
    return {{servo, contact, bone, audio}, static_cast<std::int64_t>(stage.config.servo_hz), 1};
  }
  return {{servo, contact, bone}, static_cast<std::int64_t>(stage.config.servo_hz), 1};
}

void put(const ServoRow& row, const Stage&, std::vector<double>& out) {
  const Vec3& h = row.hand.world_from_hand.translation;
  const Quat& q = row.hand.world_from_hand.rotation;
  const Vec3& v = row.hand.velocity;
  out.assign({h.x,
              h.y,
              h.z,
              v.x,
              v.y,
              v.z,
              q.w,
              q.x,
              q.y,
              q.z,
              row.hand.thrust,
              static_cast<double>(row.hand.phase),
              static_cast<double>(row.hand.tick),
              static_cast<double>(row.hand.flags),
              row.hand.spin,
              static_cast<double>(row.hand.switches),
              row.force.x,
              row.force.y,
              row.force.z,
              static_cast<double>(row.contact),
              static_cast<double>(row.faults),
              static_cast<double>(row.skipped)});
  append_values(row.effects, out);
}

void put(const ContactRow& row, const Stage&, std::vector<double>& out) {
  out.assign({static_cast<double>(row.number), static_cast<double>(row.hand_tick), static_cast<double>(row.window),
              static_cast<double>(row.skipped)});
  append_values(row.effects, out);
}

void put(const BoneRow& row, const Stage&, std::vector<double>& out) {
  out.assign({static_cast<double>(row.contact), static_cast<double>(row.published), static_cast<double>(row.skipped)});
  append_values(row.effects, out);
}

bool records_audio(const Stage& stage) noexcept { return !stage.graph.columns(Clock::audio).empty(); }

void put_audio(const Stage& stage, std::vector<double>& out) {
  out.clear();
  append_values(effect_values(stage.graph, Clock::audio), out);
}

}  // namespace burrhole
