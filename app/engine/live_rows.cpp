#include "app/engine/live_rows.h"

namespace burrhole {

std::vector<SessionColumn> hand_columns() {
  return {{"hand_x", "m"},    {"hand_y", "m"}, {"hand_z", "m"},   {"hand_vx", "m/s"}, {"hand_vy", "m/s"},
          {"hand_vz", "m/s"}, {"hand_qw", ""}, {"hand_qx", ""},   {"hand_qy", ""},    {"hand_qz", ""},
          {"thrust", "N"},    {"phase", ""},   {"hand_tick", ""}, {"hand_flags", ""}};
}

std::array<double, kHandColumns> hand_values(const HandState& hand) noexcept {
  const Vec3& h = hand.world_from_hand.translation;
  const Quat& q = hand.world_from_hand.rotation;
  const Vec3& v = hand.velocity;
  return {h.x,
          h.y,
          h.z,
          v.x,
          v.y,
          v.z,
          q.w,
          q.x,
          q.y,
          q.z,
          hand.thrust,
          static_cast<double>(hand.phase),
          static_cast<double>(hand.tick),
          static_cast<double>(hand.flags)};
}

std::vector<SessionColumn> servo_columns() {
  std::vector<SessionColumn> columns = hand_columns();
  columns.insert(columns.end(), {{"sent_x", "N"}, {"sent_y", "N"}, {"sent_z", "N"}, {"contact", ""}, {"faults", ""}, {"skipped", ""}});
  return columns;
}

std::vector<SessionColumn> tool_columns() {
  return {{"tool_x", "m"},     {"tool_y", "m"},     {"tool_z", "m"},     {"force_x", "N"},    {"force_y", "N"}, {"force_z", "N"},
          {"torque_x", "N m"}, {"torque_y", "N m"}, {"torque_z", "N m"}, {"engagement", "m"}, {"flags", ""}};
}

std::vector<SessionStream> live_streams() {
  std::vector<SessionColumn> contact{{"number", ""}, {"hand_tick", ""}, {"window", ""}};
  const std::vector<SessionColumn> tool = tool_columns();
  contact.insert(contact.end(), tool.begin(), tool.end());
  contact.push_back({"skipped", ""});
  return {{"contact", contact},
          {"bone", {{"contact", ""}, {"published", ""}, {"removed_mass", "m^3"}, {"spin", "rev/s"}, {"skipped", ""}}}};
}

void put(const ServoRow& row, std::vector<double>& out) {
  const auto hand = hand_values(row.hand);
  out.assign(hand.begin(), hand.end());
  out.insert(out.end(), {row.force.x, row.force.y, row.force.z, static_cast<double>(row.contact), static_cast<double>(row.faults),
                         static_cast<double>(row.skipped)});
}

void put(const ContactRow& row, std::vector<double>& out) {
  const Vec3& t = row.world_from_tool.translation;
  const Vec3& f = row.on_hand.force;
  const Vec3& m = row.on_hand.torque;
  out.assign({static_cast<double>(row.number), static_cast<double>(row.hand_tick), static_cast<double>(row.window), t.x, t.y, t.z, f.x, f.y,
              f.z, m.x, m.y, m.z, row.engagement, static_cast<double>(row.flags), static_cast<double>(row.skipped)});
}

void put(const BoneRow& row, std::vector<double>& out) {
  out.assign(
      {static_cast<double>(row.contact), static_cast<double>(row.published), row.removed_mass, row.spin, static_cast<double>(row.skipped)});
}

}  // namespace burrhole
