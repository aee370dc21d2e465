// [zones]: how near the tip is to the dura, a sinus or another tissue; a warning, and a fixture that guides the hand away.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/effect/passive_keys.h"
#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "app/stage/zone_state.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "core/voxel/label_table.h"
#include "core/zone/distance_field.h"
#include "haptics/servo/virtual_fixture.h"

namespace burrhole {
namespace {

constexpr const char* kLevelTexts[] = {"clear", "near", "inside"};  // of ZoneState::level
constexpr double kReleased = 1.2;                                   // [-] of the warning's distance, beyond which the tip is clear again
constexpr double kMostTilt = 1e-6;                                  // [-] cosine between two axes of voxels that count as perpendicular

struct ZoneTube {
  Vec3 from{0.0}, to{0.0};  ///< [m] bone frame
  double radius = 0.0;      ///< [m]
};

struct ZoneSpec {
  std::string name = "dura";
  VoxelLabel label = VoxelLabel::dura;  ///< without a tube
  std::string user_label{};             ///< in place of label, if it is not empty
  std::optional<ZoneTube> tube{};
  std::string place{};
};

struct ZonesScene {
  std::vector<ZoneSpec> zones;
  double warn = 1e-3;    ///< [m] (an assumption)
  double reach = 10e-3;  ///< [m]
  double tone = 0.2;     ///< [-] (an assumption)
  std::optional<FixtureConfig> guidance;
  std::string place;
};

/// The brain lies under the dura, so a tip in it has passed the dura.
bool belongs(VoxelLabel label, float value) {
  const auto at = static_cast<VoxelLabel>(static_cast<int>(value));
  return at == label || (label == VoxelLabel::dura && at == VoxelLabel::brain);
}

/// A zone whose distance is known.
struct Zone {
  std::string name;
  std::optional<ZoneTube> tube;
  std::optional<DistanceField> field;
  double closest = std::numeric_limits<double>::infinity();  // [m]
};

class ZonesEffect final : public Effect {
 public:
  ZonesEffect(const ZonesScene& scene, std::vector<Zone> zones, std::optional<VirtualFixture> fixture, Stage& stage)
      : scene_(scene),
        zones_(std::move(zones)),
        fixture_(fixture),
        bone_from_index_(stage.voxmap->bone().bone_from_index()),
        index_from_bone_(bone_from_index_.inverse()),
        at_rest_(stage.config.volume.world_from_bone),
        dims_(stage.voxmap->bone().dims()),
        sees_bone_(stage.needs.reads_window) {
    for (int axis = 0; axis < 3; ++axis) axes_[axis] = glm::normalize(bone_from_index_.linear[axis]);
    distance_ = scene.reach;
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::contact, "zones", "zones", [](void* self, const Tick& tick) { static_cast<ZonesEffect*>(self)->measure(tick); }, this);
    state_ = step.now(slots::kContact);
    if (sees_bone_) touch_ = step.now(slots::kTouch);
    zone_ = step.own(slots::kZone);
    step.column(kZoneDistanceColumn, "m", &distance_);
    step.column(kZoneLevelColumn, {"zone", kLevelTexts}, &level_);
    if (!fixture_) return {};
    fixture_->restart();
    auto guide = graph.step(
        Clock::servo, "zones", "guidance", [](void* self, const Tick& tick) { static_cast<ZonesEffect*>(self)->guide(tick); }, this);
    hand_ = guide.now(slots::kHand);
    seen_ = guide.latest(slots::kZone);
    force_ = guide.add(slots::kAddedForce);
    return {};
  }
  void place(const Pose&) noexcept override {
    if (fixture_) fixture_->restart();
  }
  void report(Figures& out) const override {
    for (const Zone& zone : zones_)
      if (std::isfinite(zone.closest)) out.add("closest_" + zone.name + "_mm", zone.closest / kMillimetre);
    out.add("near_s", near_);
    out.add("inside_s", inside_);
    out.add("warnings", warnings_);
    out.add("unknown_s", unknown_);
    if (!fixture_) return;
    const PassiveForceFigures& f = fixture_->figures();
    out.add("guidance_peak_N", f.peak);
    out.add("guidance_given_mJ", f.most_given * 1e3);
    out.add("guidance_limited_ticks", f.limited);
    out.add("guidance_jumps", f.jumps);
  }
  void warn(std::vector<std::string>& out) const override {
    for (const Zone& zone : zones_) {
      if (zone.closest < 0.0)
        out.push_back(fmt::format("[zones] the tip was {:.2f} mm inside {}", -zone.closest / kMillimetre, zone.name));
      else if (zone.closest < scene_.warn)
        out.push_back(fmt::format("[zones] the tip came to {:.2f} mm from {}", zone.closest / kMillimetre, zone.name));
    }
    if (unknown_ > 0.0)
      out.push_back(fmt::format("[zones] for {:.2f} s the tip was where no distance is known: increase zones.reach_mm", unknown_));
    if (fixture_ && fixture_->figures().jumps > 0)
      out.push_back(fmt::format("[zones] the hand jumped {} times under the guidance, which was then off until the hand was clear",
                                fixture_->figures().jumps));
  }

 private:
  void measure(const Tick& tick) noexcept {
    const Pose world_from_bone = sees_bone_ ? touch_->bone->world_from_bone : state_->bone.world_from_rest * at_rest_;
    const Vec3 tip = world_from_bone.inverse() * state_->world_from_tool.translation;
    const Vec3 index = index_from_bone_ * tip;
    NearestZone nearest{scene_.reach, Vec3(0.0)};
    bool known = true;
    for (Zone& zone : zones_) {
      NearestZone found{scene_.reach, Vec3(0.0)};
      if (zone.tube)
        found = distance_to_tube(zone.tube->from, zone.tube->to, zone.tube->radius, tip);
      else if (zone.field->knows(index))
        found = in_bone_frame(zone.field->at(index));
      else
        known = known && is_outside(index);
      if (!(found.distance < scene_.reach)) continue;
      zone.closest = std::min(zone.closest, found.distance);
      if (found.distance < nearest.distance) nearest = found;
    }
    if (!known) unknown_ += tick.dt;
    distance_ = nearest.distance;
    watch(nearest.distance, tick.dt);
    const double nearness =
        level_ > kZoneClear ? std::clamp(1.0 - nearest.distance / scene_.warn, std::numeric_limits<double>::min(), 1.0) : 0.0;
    *zone_ = {nearest.distance, world_from_bone.rotate(nearest.away), nearness, level_, scene_.tone};
  }
  void watch(double distance, double dt) noexcept {
    if (distance < 0.0)
      level_ = kZoneInside;
    else if (distance < scene_.warn || (level_ > kZoneClear && distance < kReleased * scene_.warn)) {
      warnings_ += level_ == kZoneClear ? 1 : 0;
      level_ = kZoneNear;
    } else {
      level_ = kZoneClear;
    }
    near_ += level_ > kZoneClear ? dt : 0.0;
    inside_ += level_ == kZoneInside ? dt : 0.0;
  }
  [[nodiscard]] NearestZone in_bone_frame(const NearestZone& found) const noexcept {
    return {found.distance, axes_[0] * found.away.x + axes_[1] * found.away.y + axes_[2] * found.away.z};
  }
  /// Above the bone, where a tool stands before and after: beyond the reach of what is guarded.
  [[nodiscard]] bool is_outside(const Vec3& index) const noexcept {
    const Vec3 most(dims_ - 1);
    return index.x < 0.0 || index.y < 0.0 || index.z < 0.0 || index.x > most.x || index.y > most.y || index.z > most.z;
  }
  void guide(const Tick& tick) noexcept {
    *force_ += (*fixture_)(hand_->world_from_hand.translation, seen_->distance, seen_->away, tick.dt);
  }

  ZonesScene scene_;
  std::vector<Zone> zones_;
  std::optional<VirtualFixture> fixture_;
  Affine bone_from_index_, index_from_bone_;
  Vec3 axes_[3];  // [-] of the voxels, bone frame
  Pose at_rest_;
  Vec3i dims_;
  bool sees_bone_;  // contact reads the bone, with its pose
  double distance_ = 0.0, level_ = kZoneClear;
  double near_ = 0.0, inside_ = 0.0, unknown_ = 0.0;  // [s]
  std::uint64_t warnings_ = 0;
  const ContactState* state_ = nullptr;
  const Touch* touch_ = nullptr;
  const HandState* hand_ = nullptr;
  const ZoneState* seen_ = nullptr;
  ZoneState* zone_ = nullptr;
  Vec3* force_ = nullptr;
};

constexpr std::size_t kMostZones = 8;

constexpr std::pair<const char*, VoxelLabel> kLabels[] = {{"dura", VoxelLabel::dura},
                                                          {"brain", VoxelLabel::brain},
                                                          {"forbidden", VoxelLabel::forbidden},
                                                          {"diploe", VoxelLabel::diploe},
                                                          {"inner_table", VoxelLabel::inner_table},
                                                          {"outer_table", VoxelLabel::outer_table},
                                                          {"bone", VoxelLabel::bone}};

VoxelLabel read_label(TableReader& table) {
  std::vector<std::string> words;
  for (const auto& [word, label] : kLabels) words.emplace_back(word);
  const std::string word = table.choice("label", words.front(), words,
                                        "tissue of the bone as loaded that makes the zone; dura: dura and brain; not with from_mm");
  return std::ranges::find(kLabels, word, [](const auto& one) { return std::string(one.first); })->second;
}

ZoneSpec read_zone(TableReader& table) {
  constexpr double kFar = 1e5;  // [mm]
  const NumberRule length{.min = -kFar, .max = kFar, .to_si = kMillimetre};
  ZoneSpec out;
  out.place = table.place();
  out.name = table.text("name", {}, "name of the zone in figures: small letters, digits and _");
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (table.has("name") && (out.name.empty() || !std::ranges::all_of(out.name, allowed)))
    table.fault("name", "must be of small letters, digits and _");
  const auto from = table.optional_numbers("from_mm", 3, length, "start of a tube, such as a venous sinus, bone frame; in place of label");
  if (!from) {
    out.label = read_label(table);
    out.user_label = table.text("user_label", "", "name of a label of the user, in place of label");
    if (!out.user_label.empty() && table.has("label")) table.fault("user_label", "is not valid with label: a zone has one tissue");
    for (const char* const key : {"label", "user_label"})
      if (table.has(key)) out.place = table.place_of(key);
    for (const char* const key : {"to_mm", "radius_mm"})
      if (table.has(key)) table.fault(key, "needs from_mm");
  } else {
    for (const char* const key : {"label", "user_label"})
      if (table.has(key)) table.fault(key, "is not valid with from_mm: a zone is a tissue or a tube");
    const Vec3 to = table.vector("to_mm", std::nullopt, length, "end of the tube, bone frame; only with from_mm");
    const double radius = table.number("radius_mm", {.min = 0.0, .max = 100.0, .min_open = true, .to_si = kMillimetre},
                                       "radius of the tube; only with from_mm");
    out.tube = {Vec3((*from)[0], (*from)[1], (*from)[2]), to, radius};
  }
  table.finish();
  return out;
}

FixtureConfig read_guidance(TableReader table) {
  FixtureConfig c;
  c.start =
      table.number("start_mm", within(c.start / kMillimetre, 0.0, 100.0), "distance of the tip from a zone at which the force begins") *
      kMillimetre;
  c.stiffness = table.number("stiffness_N_per_m", above_zero(c.stiffness, 1.0, 1e6), "force over the depth below start_mm (an assumption)");
  c.damping = table.number("damping_N_s_per_m", at_least_zero(c.damping, 1.0, 1e4),
                           "force over the speed of the hand towards the zone (an assumption)");
  c.largest =
      table.number("largest_N", above_zero(c.largest, 1.0, 1e3), "largest force on the hand; that of a small device (an assumption)");
  read_passive_limit(table, "the guidance", c.limit);
  table.finish();
  return c;
}

class ZonesPlan final : public ConfigPlan<ZonesPlan, ZonesScene> {
 public:
  explicit ZonesPlan(TableReader& table) {
    ZonesScene& c = config_;
    c.place = table.place();
    c.warn = table.number("warn_mm", above_zero(c.warn / kMillimetre, kMillimetre, 100.0),
                          "distance of the tip from a zone below which it warns (an assumption)");
    c.reach = table.number("reach_mm", above_zero(c.reach / kMillimetre, kMillimetre, 100.0),
                           "distances are known up to this, within this distance of the drilled line");
    c.tone = table.number("tone_level", within(c.tone, 0.0, 1.0), "amplitude of the tone of the warning, with [sound] (an assumption)");
    if (c.warn * kReleased >= c.reach) table.fault("reach_mm", fmt::format("must be above {:g} x warn_mm", kReleased));
    for (TableReader& one : table.tables("zone", "zones, at most 8; without any: the dura")) c.zones.push_back(read_zone(one));
    if (c.zones.size() > kMostZones) table.fault("zone", fmt::format("has {} zones, at most {}", c.zones.size(), kMostZones));
    for (std::size_t n = 1; n < c.zones.size(); ++n)
      if (std::ranges::find(c.zones.begin(), c.zones.begin() + static_cast<std::ptrdiff_t>(n), c.zones[n].name, &ZoneSpec::name) !=
          c.zones.begin() + static_cast<std::ptrdiff_t>(n))
        table.fault("zone", fmt::format("has two zones with the name \"{}\"", c.zones[n].name));
    if (c.zones.empty()) c.zones.push_back({.place = c.place});
    if (const auto guidance = table.table("guidance", "a force that guides the hand away from the zones; absent: none")) {
      c.guidance = read_guidance(*guidance);
      if (c.guidance->start >= c.reach) table.fault("reach_mm", "must be above guidance.start_mm");
    }
  }

  PlanRow row(const PlanContext& context) const override {
    const VoxelBox domain =
        domain_of(drilling_way(context.config, context.bone), context.bone.bone_from_index, context.config.hand.standoff);
    const auto fields = static_cast<std::uint64_t>(std::ranges::count_if(config_.zones, [](const ZoneSpec& zone) { return !zone.tube; }));
    const Vec3 grown = Vec3(domain.size()) + 2.0 * glm::ceil(margin_of(context.bone.bone_from_index));
    const std::uint64_t bytes = sizeof(ZonesEffect) + fields * domain.count() * sizeof(float);
    return {.table = "zones",
            .clock = Clock::contact,
            .step = config_.guidance ? "distance of the tip from zones, and a force away from them" : "distance of the tip from zones",
            .needs = "contact state",
            .gives = config_.guidance ? "distance, added force" : "distance",
            .detail = fmt::format("{} zones, warning at {:g} mm, {} voxels", config_.zones.size(), config_.warn / kMillimetre,
                                  fields * domain.count()),
            .rate_hz = static_cast<double>(context.needs.contact_hz > 0 ? context.needs.contact_hz : context.config.servo_hz),
            .bytes = bytes,
            .start_bytes = bytes + static_cast<std::uint64_t>(grown.x * grown.y * grown.z) * (2 * sizeof(float) + 1)};
  }
  std::string setting() const override {
    return fmt::format("zones, warning at {:g} mm{}", config_.warn / kMillimetre, config_.guidance ? ", guidance" : "");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    std::vector<Zone> zones;
    for (const ZoneSpec& spec : config_.zones) {
      Zone zone{.name = spec.name, .tube = spec.tube, .field = {}};
      if (!spec.tube) {
        auto field = field_of(stage, spec);
        if (!field) return field.error();
        zone.field = std::move(field).value();
      }
      zones.push_back(std::move(zone));
    }
    std::optional<VirtualFixture> fixture;
    if (config_.guidance) {
      auto made = VirtualFixture::create(*config_.guidance);
      if (!made) return made.error();
      fixture = *made;
    }
    return std::unique_ptr<Effect>(std::make_unique<ZonesEffect>(config_, std::move(zones), fixture, stage));
  }

 private:
  [[nodiscard]] static Vec3 edges_of(const Affine& frame) {
    return {glm::length(frame.linear[0]), glm::length(frame.linear[1]), glm::length(frame.linear[2])};
  }
  [[nodiscard]] Vec3 margin_of(const Affine& frame) const { return Vec3(config_.reach) / edges_of(frame); }
  /// @returns the voxels within reach of the line along which the scene drills, from where the tool stands before.
  [[nodiscard]] VoxelBox domain_of(const DrillingWay& way, const Affine& frame, double standoff) const {
    const Vec3 entry = way.index_from_tool.offset, end = entry + way.along;
    const Vec3 start = entry + way.index_from_tool.linear * Vec3(0.0, 0.0, standoff);
    const Vec3 margin = margin_of(frame);
    const Vec3 lo = glm::min(glm::min(start, entry), end) - margin, hi = glm::max(glm::max(start, entry), end) + margin;
    return {floor_int(lo), floor_int(hi) + 2};
  }

  /// @returns the label of a zone; bad_input if the volume has no label of that name.
  static Result<VoxelLabel> label_of(const BoneModel& bone, const ZoneSpec& spec) {
    if (spec.user_label.empty()) return spec.label;
    std::string known;
    for (const NamedLabel& one : labels_of(bone.notes())) {
      if (one.name == spec.user_label) return one.label;
      known += (known.empty() ? "" : ", ") + one.name;
    }
    return Error{ErrorCode::bad_input,
                 fmt::format("the volume has no label \"{}\" of the user; {}", spec.user_label,
                             known.empty() ? std::string("it has none: give label volumes with volume.labels") : "it has: " + known),
                 spec.place};
  }

  Result<DistanceField> field_of(Stage& stage, const ZoneSpec& spec) const {
    const BoneModel& bone = stage.voxmap->bone();
    const Affine& frame = bone.bone_from_index();
    for (int a = 0; a < 3; ++a)
      if (std::abs(glm::dot(glm::normalize(frame.linear[a]), glm::normalize(frame.linear[(a + 1) % 3]))) > kMostTilt)
        return Error{ErrorCode::bad_input, "[zones] needs voxels with perpendicular edges: set volume.spacing_mm to resample the scan",
                     config_.place};
    const auto label = label_of(bone, spec);
    if (!label) return label.error();
    const BoneShape shape{.dims = bone.dims(), .bone_from_index = frame, .thickness = stage.approach.thickness};
    const VoxelBox domain = domain_of(drilling_way(stage.config, shape), frame, stage.config.hand.standoff);
    const auto members = [&](const VoxelBox& box, std::span<std::uint8_t> inside) {
      // Beyond the grid, a zone goes on as at the edge.
      const VoxelBox known{glm::clamp(box.lo, Vec3i(0), bone.dims() - 1), glm::clamp(box.hi, Vec3i(1), bone.dims())};
      std::vector<float> labels(known.count());
      bone.read_labels(known, labels);
      std::size_t n = 0;
      for_each_voxel(box, [&](const Vec3i& v) {
        inside[n++] = belongs(*label, labels[known.offset_of(glm::clamp(v, known.lo, known.hi - 1))]) ? 1 : 0;
      });
    };
    auto field = DistanceField::create(domain, edges_of(frame), config_.reach, members);
    if (!field) return Error{ErrorCode::bad_input, "[zones] " + field.error().message, config_.place};
    if (!field->has_members())
      return Error{
          ErrorCode::bad_input,
          fmt::format("no voxel of zone \"{}\" lies within zones.reach_mm of the drilled line: the volume has no such label there; name "
                      "another label, or give the zone as a tube (from_mm, to_mm, radius_mm)",
                      spec.name),
          spec.place};
    return field;
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<ZonesPlan>(table); }

}  // namespace

EffectEntry zones_effect() {
  std::vector<std::string> samples{"[[zones.zone]]\nname = \"here\"\nfrom_mm = [0, 0, 0]\nto_mm = [1, 0, 0]\nradius_mm = 1",
                                   "[zones.guidance]"};
  for (const auto& [word, label] : kLabels) samples.push_back(fmt::format("[[zones.zone]]\nname = \"here\"\nlabel = \"{}\"", word));
  return {"zones",
          "distance of the tip from dura, sinuses and other zones, with a warning; without it there is none",
          read,
          std::move(samples),
          {.figures = {{"closest_dura_mm", 1.0}, {"near_s", 1.0}, {"inside_s", 1.0}}}};
}

}  // namespace burrhole
