// [contact]: force feedback. A contact model computes the tool's pose and the force on the hand from the hand's motion.

#include <fmt/format.h>

#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/force_loop.h"
#include "app/stage/stage.h"
#include "core/contact/contact_form.h"
#include "core/mesh/mesh_form.h"
#include "haptics/servo/multi_rate.h"

namespace burrhole {
namespace {

/// The contact models, by their word in a scene. The first is the default.
struct FormEntry {
  const char* word;
  std::unique_ptr<ContactForm> (*read)(TableReader& table);
};
constexpr FormEntry kForms[] = {
    {"surface", read_surface_form}, {"gradient-plane", read_gradient_plane_form}, {"voxmap", read_voxmap_form}, {"mesh", read_mesh_form}};

class ContactEffect final : public Effect {
 public:
  ContactEffect(std::unique_ptr<ContactModel> model, const ContactForm& form, const ContactOptions& options, Stage& stage)
      : model_(std::move(model)), form_(form.clone()), options_(options), turned_(stage.config.tool.spin > 0.0), turns_(turned_) {}

  Status bind(StepGraph& graph) override {
    const bool clutched = graph.is_written(slots::kClutch.name);
    // Of two forms of the step, so that a scene without a clutch has no instruction of it.
    const StepGraph::Run call =
        clutched ? StepGraph::Run([](void* self, const Tick& tick) noexcept { static_cast<ContactEffect*>(self)->run_clutched(tick); })
                 : StepGraph::Run([](void* self, const Tick& tick) noexcept { static_cast<ContactEffect*>(self)->run(tick); });
    auto step = graph.step(Clock::contact, "contact", "contact", call, this);
    if (clutched) clutch_ = step.latest(slots::kClutch);
    touch_ = step.now(slots::kTouch);
    state_ = step.own(slots::kContact);
    tangential_ = step.now_if_written(slots::kTangential);
    constraints_ = step.now_if_written(slots::kConstraints);
    const Vec3& t = state_->world_from_tool.translation;
    const auto& [force, torque] = state_->on_hand;
    step.column("tool_x", "m", &t.x).column("tool_y", "m", &t.y).column("tool_z", "m", &t.z);
    step.column("force_x", "N", &force.x).column("force_y", "N", &force.y).column("force_z", "N", &force.z);
    step.column("torque_x", "N m", &torque.x).column("torque_y", "N m", &torque.y).column("torque_z", "N m", &torque.z);
    step.column("engagement", "m", &state_->engagement).column("flags", "", &flags_, true);
    return {};
  }
  Status change_tool(Stage& stage) override {
    options_.cutting = stage.tool->cutting;
    options_.surface = stage.tool->surface;
    auto model = form_->make(stage.tool->shell, options_);
    if (!model) return model.error();
    model_ = std::move(model).value();
    return {};
  }
  void place(const Pose& world_from_tool) noexcept override { model_->place(world_from_tool); }
  void report(Figures& out) const override {
    out.add("points", static_cast<std::uint64_t>(model_->points()));
    out.add("constraints_dropped", dropped_);
    out.add("held", held_);
    out.add("degraded", degraded_);
    out.add("evaluations", evaluations_);
  }
  void warn(std::vector<std::string>& out) const override {
    if (held_ > 0)
      out.push_back(fmt::format("[contact] held the tool in place in {} evaluations: it came near bone that had not been read", held_));
  }

 private:
  void run_clutched(const Tick& tick) noexcept {
    turns_ = turned_ && clutch_->turns;
    run(tick);
  }
  void run(const Tick& tick) noexcept {
    evaluate(tick);
    flags_ = static_cast<double>(state_->flags);
    dropped_ += constraints_->dropped;
    if ((state_->flags & kContactOutsideWindow) != 0) ++held_;
    if (state_->flags != 0) ++degraded_;
    ++evaluations_;
  }
  void evaluate(const Tick& tick) noexcept {
    const HandState& hand = touch_->hand;
    const ContactAdditions added{{constraints_->items.data(), constraints_->size}, tangential_->law};
    const ToolSpin spin{turns_ && hand.spin > 0.0, tangential_->rate};
    model_->step({*touch_->bone, hand, tick.dt, spin, added}, *state_);
    state_->tick = hand.tick;
  }

  std::unique_ptr<ContactModel> model_;
  std::unique_ptr<ContactForm> form_;
  ContactOptions options_;
  bool turned_;  // the scene has a spin rate above 0; a stalled bit then still counts as spinning and stays engaged
  bool turns_;   // the same, and the clutch, if there is one, has not stopped the bit
  const DrillClutch* clutch_ = nullptr;
  const Touch* touch_ = nullptr;
  ContactState* state_ = nullptr;
  const Tangential* tangential_ = nullptr;
  const Constraints* constraints_ = nullptr;
  double flags_ = 0.0;                            // bits of ContactFlag
  std::uint64_t dropped_ = 0;                     // constraints beyond Constraints::kMax
  std::uint64_t held_ = 0;                        // evaluations with kContactOutsideWindow
  std::uint64_t degraded_ = 0, evaluations_ = 0;  // evaluations with any ContactFlag, and all
};

/// The thrust is then whatever bone requires.
bool has_fixed_feed(const StageConfig& config) { return config.feed_hand && !config.feed_hand->push; }

class ContactPlan final : public EffectPlan {
 public:
  ContactPlan(TableReader& table, const StageConfig& stage) {
    std::vector<std::string> words;
    for (const FormEntry& entry : kForms) words.emplace_back(entry.word);
    word_ =
        table.choice("model", words.front(), words,
                     "contact model; surface: a tool that is constrained by the bone's surface; gradient-plane: a penalty force by tangent "
                     "planes from the density gradient; voxmap: a penalty force by planes perpendicular to the tool's inward normals; "
                     "mesh: the nearest triangles of a mesh of the surface constrain the tool, or push it by a penalty force (key tool); a "
                     "large thrust can push the tool through bone against a penalty force");
    for (const FormEntry& entry : kForms)
      if (word_ == entry.word) form_ = entry.read(table);
    if (stage.volume.scan && stage.volume.scan->request.bone.segment) form_->take_scan_layers();
    rate_hz_ = read_rate(table, stage, rate_hz_, 20, "rate of contact evaluations; divides servo_hz");
    latency_ticks_ = static_cast<int>(
        table.integer("latency_ticks", latency_ticks_, -1, 1000, "latency from a motion to its force; -1 for one contact period"));
  }
  ContactPlan(const ContactPlan& other)
      : EffectPlan(other),
        word_(other.word_),
        form_(other.form_->clone()),
        rate_hz_(other.rate_hz_),
        latency_ticks_(other.latency_ticks_) {}
  ContactPlan& operator=(const ContactPlan&) = delete;

  std::unique_ptr<EffectPlan> clone() const override { return std::make_unique<ContactPlan>(*this); }
  void* config(std::type_index type) noexcept override { return form_->config(type); }

  void add_needs(const StageConfig&, Needs& needs) const override {
    const ContactFormNeeds own = form_->needs();
    needs.fields = own.fields;
    needs.paper_grids = own.paper_grids;
    needs.reads_window |= !own.paper_grids;
    needs.contact_hz = rate_hz_;
    needs.latency_ticks = latency_ticks_;
    needs.feels = true;
    needs.any_density = own.any_density;
    needs.holds_back = own.holds_back;
    needs.coupling_stiffness = own.coupling_stiffness;
    needs.coupling_damping = own.coupling_damping;
    needs.cutting_stiffness = own.cutting_stiffness;
    needs.felt_hardness = own.felt_hardness;
    needs.plane_reach_voxels = own.plane_reach;
    if (own.paper_grids)
      needs.not_live = "contact.storage = \"vdb\" cannot be read while another thread cuts: use storage = \"window\" for a live run";
  }

  PlanRow row(const PlanContext& context) const override {
    const std::uint64_t shell = context.tool.shell.size() * (2 * sizeof(Vec3) + 1 + sizeof(Contact));
    return {.table = "contact",
            .clock = Clock::contact,
            .step = context.needs.fields.triangles != nullptr
                        ? "point shell against the triangles of the window copy, and its planes at the servo's rate"
                        : "point shell against the window copy, and its planes at the servo's rate",
            .needs = "window copy, hand motion",
            .gives = "contact state",
            .detail = fmt::format("{} points, {}", context.tool.shell.size(), form_->text()),
            .rate_hz = static_cast<double>(rate_hz_),
            .bytes = shell};
  }

  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    const Needs& needs = context.needs;
    if (!needs.holds_back) return;
    if (needs.removes && !needs.cutting_field && context.config.tool.spin > 0.0 && !has_fixed_feed(context.config)) {
      const double engaged = context.config.hand.push / needs.cutting_stiffness, edge = context.voxel_edge();
      if (engaged < edge)
        out.push_back(
            fmt::format("engaged depth push_N / cutting_N_per_m = {:.3f} mm is less than a voxel ({:.3f} mm): little will be cut; set "
                        "push_N to {:.0f} or more, or use a smaller spacing_mm",
                        1e3 * engaged, 1e3 * edge, std::ceil(edge * needs.cutting_stiffness)));
    }
    if (auto unstable = loop_warning(context.config, needs)) out.push_back(std::move(*unstable));
  }

  std::string setting() const override { return "contact " + word_; }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const ContactOptions options{.voxel_edge = stage.voxel_edge(),
                                 .cutting = stage.tool->cutting,
                                 .surface = stage.tool->surface,
                                 .planes = uses_planes(stage.config.servo.multi_rate.scheme),
                                 .foresight = stage.contact_period + stage.period * static_cast<double>(stage.latency)};
    auto model = form_->make(stage.tool->shell, options);
    if (!model) return model.error();
    return std::unique_ptr<Effect>(std::make_unique<ContactEffect>(std::move(model).value(), *form_, options, stage));
  }

 private:
  std::string word_;
  std::unique_ptr<ContactForm> form_;
  int rate_hz_ = 1000;      // [Hz]
  int latency_ticks_ = -1;  // [servo ticks] from a motion to its force; -1: one contact period
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<ContactPlan>(table, stage);
}

}  // namespace

EffectEntry contact_effect() {
  return {"contact",
          "force feedback; without it bone exerts no force",
          read,
          {"turning = \"locked\"", "[contact.label_stiffness]", "record_bits = \"8\"", "model = \"gradient-plane\"",
           "model = \"gradient-plane\"\ncoupling = \"virtual\"", "model = \"voxmap\"", "model = \"voxmap\"\ncoupling = \"virtual\"",
           "model = \"gradient-plane\"\nmode = \"paper\"", "model = \"gradient-plane\"\nstorage = \"vdb\"",
           "model = \"voxmap\"\nstacking = \"sum\"", "model = \"voxmap\"\nstacking = \"sum-limited\"",
           "model = \"voxmap\"\nstacking = \"average\"", "model = \"voxmap\"\nstacking = \"deepest\"",
           "model = \"voxmap\"\nplane = \"surface\"", "model = \"mesh\"", "model = \"mesh\"\ntool = \"hand\"",
           "model = \"mesh\"\ntool = \"hand\"\nstacking = \"deepest\"", "model = \"mesh\"\ntool = \"hand\"\ncoupling = \"virtual\""},
          {.figures = {{"breakthrough_s"}, {"peak_force_N"}, {"reached_mm"}},
           .knobs = {{.key = "rate_hz", .multiples = {0.5, 1, 2}, .reference = 4, .of_all = true, .along = {{"servo_hz", 1.0}}}}}};
}

}  // namespace burrhole
