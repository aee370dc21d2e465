#include "app/window/controls.h"

#include <algorithm>
#include <cmath>

#include "app/window/text_scale.h"
#include "haptics/hand/bone_drive.h"

namespace burrhole {
namespace {

constexpr double kZoomStep = 1.1;  // of a key or a step of the wheel
constexpr double kFarAway = 0.05;  // [m] of the goal from the approach axis, and above the entry

/// @returns -1, 0 or 1.
double between(bool minus, bool plus) { return (plus ? 1.0 : 0.0) - (minus ? 1.0 : 0.0); }

/// @returns a stick's axis without its idle middle, -1..1.
double beyond(double axis, double idle) {
  const double size = std::abs(axis);
  return std::isfinite(axis) && size > idle ? std::copysign(std::min(1.0, (size - idle) / (1.0 - idle)), axis) : 0.0;
}

}  // namespace

Controls::Controls(const ControlsSetup& setup, const OrbitCamera& camera, const ControlsConfig& config)
    : setup_(setup), camera_(camera), config_(config) {
  goal_.place = Vec3(0.0, 0.0, setup.hand.standoff);
  requests_.text_scale = setup.text_scale;
}

void Controls::set_picture_size(int width, int height) noexcept {
  width_ = std::max(1, width);
  height_ = std::max(1, height);
}

bool Controls::fine() const noexcept { return held(Key::left_shift) || held(Key::right_shift) || pad_before_.left_bumper; }

void Controls::handle(const WindowEvent& event, bool taken) {
  switch (event.kind) {
    case WindowEvent::Kind::key:
      if (const auto key = held_.take_key(event)) press(*key);
      return;
    case WindowEvent::Kind::button:
      held_.take_button(event, taken, width_);
      x_ = event.x;
      y_ = event.y;
      return;
    case WindowEvent::Kind::motion:
      if (held_.dragging()) drag(event.x - x_, event.y - y_);
      x_ = event.x;
      y_ = event.y;
      return;
    case WindowEvent::Kind::scroll:
      if (!taken) scroll(event.y);
      return;
    case WindowEvent::Kind::focus:
      // A window without focus gets no release of a key: nothing may stay pressed, the drive above all.
      held_.clear();
      if (!event.down) locked_on_ = false;
      return;
    case WindowEvent::Kind::close:
      end();
      return;
    case WindowEvent::Kind::character:
    case WindowEvent::Kind::size:
      return;
  }
}

bool Controls::press_watching(Key key) {
  Transport& transport = *setup_.transport;
  const double jump = fine() ? config_.jump_fine : config_.jump;
  switch (key) {
    case Key::space:
    case Key::p:
      transport.run(!transport.runs());
      return true;
    case Key::left:
    case Key::right:
      // With Ctrl the arrows turn the view.
      if (held(Key::left_control) || held(Key::right_control)) return true;
      fine() ? transport.step(key == Key::left ? -jump : jump) : transport.jump(transport.head() + (key == Key::left ? -jump : jump));
      return true;
    case Key::up:
    case Key::down:
      if (held(Key::left_control) || held(Key::right_control)) return true;
      transport.set_speed(transport.speed() * (key == Key::up ? 2.0 : 0.5));
      return true;
    case Key::home:
      transport.jump(0.0);
      return true;
    case Key::escape:
      if (!requests_.help) end();
      requests_.help = false;
      return true;
    case Key::z:
    case Key::x:
    case Key::r:
    case Key::h:
    case Key::enter:
      return true;
    default:
      return false;
  }
}

bool Controls::press_text(Key key) {
  if (key == Key::digit_0)
    requests_.text_scale = setup_.text_scale;
  else if (key == Key::equal || key == Key::pad_plus || key == Key::minus || key == Key::pad_minus)
    change_text(key == Key::equal || key == Key::pad_plus);
  else
    return false;
  return true;
}

void Controls::change_text(bool larger) noexcept { requests_.text_scale = next_text_scale(requests_.text_scale, larger); }

void Controls::press(Key key) {
  const bool control = held(Key::left_control) || held(Key::right_control);
  if (control && press_text(key)) return;
  if (setup_.transport && press_watching(key)) return;
  const int digit = static_cast<int>(key) - static_cast<int>(Key::digit_0);
  if (digit >= 0 && digit <= 9) return change_tool(static_cast<std::size_t>(digit == 0 ? 9 : digit - 1));
  switch (key) {
    case Key::p:
      return toggle_pause();
    case Key::z:
      return undo();
    case Key::x:
      locked_on_ = !locked_on_;
      return;
    case Key::r:
      return control ? reset() : straighten();
    case Key::home:
      return back_to_entry();
    case Key::f:
      return camera_.frame();
    case Key::v:
    case Key::c:
      return camera_.next_mode();
    case Key::k:
      return toggle_cut();
    case Key::t:
      return take_over();
    case Key::g:
      return relax();
    case Key::u:
      return use_instrument(kSuctionSwitch);
    case Key::i:
      return use_instrument(kIrrigationSwitch);
    case Key::m:
      return use_instrument(kWaxSwitch);
    case Key::l:
      requests_.slices = !requests_.slices;
      return;
    case Key::equal:
    case Key::pad_plus:
      return camera_.zoom(kZoomStep);
    case Key::minus:
    case Key::pad_minus:
      return camera_.zoom(1.0 / kZoomStep);
    case Key::h:
      requests_.hints = !requests_.hints;
      return;
    case Key::f1:
      requests_.help = !requests_.help;
      return;
    case Key::f2:
      requests_.lab = !requests_.lab;
      return;
    case Key::f9:
      return export_bone();
    case Key::f11:
      requests_.full_screen = !requests_.full_screen;
      return;
    case Key::f12:
      requests_.screenshot = true;
      return;
    case Key::escape:
      if (requests_.help)
        requests_.help = false;
      else
        requests_.asks_end = !requests_.asks_end;
      return;
    case Key::enter:
      if (requests_.asks_end) end();
      return;
    default:
      return;
  }
}

void Controls::scroll(double steps) {
  if (!std::isfinite(steps)) return;
  if (setup_.transport || held(Key::left_control) || held(Key::right_control))
    return camera_.zoom(std::pow(kZoomStep, std::clamp(steps, -20.0, 20.0)));
  if (!moves()) return;
  // A step away from the person advances, as a hand would.
  goal_.place.z -= std::clamp(steps, -20.0, 20.0) * scale() * (touches_ ? config_.wheel_press : config_.wheel);
  if (steps > 0.0) rest_ = std::max(rest_, hand_.z - goal_.place.z);  // a wheel stays where it was turned to
}

void Controls::drag(double dx, double dy) {
  if (*held_.dragging() == MouseButton::right || (setup_.transport && *held_.dragging() == MouseButton::left))
    return camera_.turn(-dx * config_.turn, dy * config_.turn);
  const double metres = camera_.length_of(1.0 / height_);
  if (*held_.dragging() == MouseButton::middle) return camera_.pan(-dx * metres, dy * metres);
  slide(dx * metres * scale(), -dy * metres * scale());
}

void Controls::straighten() noexcept {
  if (moves()) goal_.tilt_right = goal_.tilt_away = 0.0;
}

void Controls::slide(double right, double up) {
  if (moves()) goal_.place += right * camera_.right_across() + up * camera_.up_across();
}

void Controls::advance(double towards_bone, double dt) {
  const double speed = towards_bone < 0.0 ? config_.withdraw : touches_ ? config_.press : config_.advance;
  goal_.place.z -= towards_bone * speed * scale() * dt;
}

void Controls::turn_by_keys(double dt) {
  if (!(held(Key::left_control) || held(Key::right_control))) return;
  const double right = between(held(Key::left), held(Key::right)), up = between(held(Key::down), held(Key::up));
  if (right != 0.0 || up != 0.0) camera_.turn(right * config_.turn_by_key * dt, up * config_.turn_by_key * dt);
}

void Controls::move_by_keys(double dt) {
  const double along = between(held(Key::s), held(Key::w));
  moves_along_ = along != 0.0;
  advance(along, dt);
  if (!(held(Key::left_control) || held(Key::right_control))) {
    const double right = between(held(Key::left), held(Key::right)), up = between(held(Key::down), held(Key::up));
    slide(right * config_.slide * scale() * dt, up * config_.slide * scale() * dt);
  }
  // Tilts as seen in the picture.
  const double lean = config_.tilt * scale() * dt;
  const Vec3 tilt =
      lean * (between(held(Key::a), held(Key::d)) * camera_.right_across() + between(held(Key::q), held(Key::e)) * camera_.up_across());
  goal_.tilt_right += tilt.x;
  goal_.tilt_away += tilt.y;
}

std::uint32_t Controls::bone_switches() const {
  if (!has_bone() || !runs_ || paused_ || goal_.ends || setup_.transport) return 0;
  // In pairs, positive first: along the bone's axes x, y, z, then about them.
  constexpr Key kKeys[BoneSwitch::kDirections] = {Key::d,  Key::a,    Key::w,         Key::s,       Key::e,    Key::q,
                                                  Key::up, Key::down, Key::page_down, Key::page_up, Key::left, Key::right};
  std::uint32_t out = 0;
  for (int n = 0; n < BoneSwitch::kDirections; ++n)
    if (held(kKeys[n])) out |= BoneSwitch::bit(n);
  return out;
}

void Controls::use_instrument(InstrumentSwitch instrument) {
  if (setup_.transport || goal_.ends) return;
  if ((setup_.instruments & instrument) == 0)
    answer_ = instrument == kWaxSwitch ? "This scene has no wax by hand ([bleeding] wax = \"switch\")"
              : instrument == kSuctionSwitch
                  ? "This scene has no suction by hand (by_switch in [dust.suction], suction_by_switch in [bleeding])"
                  : "This scene has no irrigation by hand ([irrigation] by_switch)";
  else if (paused_)
    answer_ = "Paused: P goes on";
  else if (instrument == kWaxSwitch)
    wax_left_ = config_.wax;
  else
    instruments_on_ ^= instrument;
}

void Controls::ask_switches(double dt) {
  if (!paused_) wax_left_ = std::max(0.0, wax_left_ - dt);
  const std::uint32_t wanted = bone_switches() | instruments_on_ | (wax_left_ > 0.0 ? kWaxSwitch : 0u);
  if (wanted == switches_ || setup_.transport) return;
  switches_ = wanted;
  inputs_.push_back({0, InputKind::switches, static_cast<double>(wanted), {}, {}});
}

void Controls::move_by_pad(double dt, const PadState& pad) {
  if (!pad.present) return;
  const double idle = config_.pad_idle;
  slide(beyond(pad.left_x, idle) * config_.slide * scale() * dt, -beyond(pad.left_y, idle) * config_.slide * scale() * dt);
  const double lean = config_.tilt * scale() * dt;
  const Vec3 tilt = lean * (beyond(pad.right_x, idle) * camera_.right_across() - beyond(pad.right_y, idle) * camera_.up_across());
  goal_.tilt_right += tilt.x;
  goal_.tilt_away += tilt.y;
  const double along = beyond(pad.right_bumper ? -1.0 : pad.left_trigger, idle);
  moves_along_ = moves_along_ || along != 0.0;
  advance(along, dt);
}

void Controls::press_pad(const PadState& pad) {
  const PadState before = std::exchange(pad_before_, pad);
  if (pad.start && !before.start) toggle_pause();
  if (pad.b && !before.b) undo();
  if (pad.y && !before.y) camera_.next_mode();
  if (pad.x && !before.x) straighten();
}

double Controls::held_push() const noexcept {
  return touches_ && is_own() && rest_ > light_lead() ? rest_ * setup_.hand.dynamics.stiffness : 0.0;
}

void Controls::relax_push(double dt) {
  const double lead = hand_.z - goal_.place.z;
  rest_ = std::clamp(rest_, 0.0, std::max(0.0, lead));  // what drilling or a move back has used up is not held any more
  const double wanted = std::max(rest_, light_lead());
  if (touches_ && !moves_along_ && lead > wanted) goal_.place.z += (lead - wanted) * (1.0 - std::exp(-dt / config_.relax));
}

void Controls::keep_in_reach() {
  // The goal of an arm at its largest force waits there, so that the first move back lowers the thrust.
  const double reach = setup_.hand.push / setup_.hand.dynamics.stiffness;
  const Vec3 pull = goal_.place - hand_;
  if (touches_ && glm::length(pull) > reach) goal_.place = hand_ + pull * (reach / glm::length(pull));
  // Bone beside the bit holds it too; a goal far aside would swing it there once it is free.
  const glm::dvec2 aside(goal_.place - hand_);
  if (const double far = glm::length(aside); touches_ && far > config_.aside) {
    goal_.place.x = hand_.x + aside.x * (config_.aside / far);
    goal_.place.y = hand_.y + aside.y * (config_.aside / far);
  }
  goal_.place = glm::clamp(goal_.place, Vec3(-kFarAway, -kFarAway, -setup_.deepest), Vec3(kFarAway));
  const double lean = std::hypot(goal_.tilt_right, goal_.tilt_away);
  if (lean > setup_.hand.largest_tilt) {
    goal_.tilt_right *= setup_.hand.largest_tilt / lean;
    goal_.tilt_away *= setup_.hand.largest_tilt / lean;
  }
}

void Controls::step(double dt, const LiveState& now, const PadState& pad) {
  runs_ = now.hand.tick > 0;
  touches_ = glm::length(now.force) > config_.touch;
  in_bone_ = touches_ || now.progress.depth > 0.0;
  spins_ = now.hand.spin > 0.0;
  hand_ = setup_.world_from_approach.inverse() * now.hand.world_from_hand.translation;
  thrust_ = now.hand.thrust;
  press_pad(pad);
  turn_by_keys(dt);
  if (setup_.transport) setup_.transport->advance(dt);
  ask_switches(dt);
  if (moves()) {
    if (!has_bone()) move_by_keys(dt);
    move_by_pad(dt, pad);
    relax_push(dt);
    keep_in_reach();
  }
  const bool pad_spins = pad.present && beyond(pad.right_trigger, config_.pad_idle) > 0.0;
  goal_.spins = moves() && (locked_on_ || held(Key::space) || pad_spins);
  camera_.follow(setup_.world_from_approach.inverse() * now.world_from_tool.translation, dt);
}

void Controls::change_tool(std::size_t index) {
  if (index < setup_.tools.size()) (void)ask(InputKind::tool, setup_.tools[index].name, setup_.tools[index].text);
}

bool Controls::ask(InputKind kind, const std::string& text, const std::string& data) {
  const bool query = is_query(kind);
  if (goal_.ends || !(is_own() || query || kind == InputKind::pause)) return false;
  // Bone that grows round a bit, and a larger bit in a hole, would press on each other with several times the thrust.
  const bool changes_bit_or_bone =
      kind == InputKind::tool || kind == InputKind::undo || kind == InputKind::reset || kind == InputKind::restore;
  if (paused_ && !query)
    answer_ = "Paused: P goes on";
  else if (changes_bit_or_bone && in_bone_)
    answer_ = "Move the drill out of the bone first (S)";
  else
    inputs_.push_back({0, kind, 0.0, text, data});
  return answer_.empty();
}

void Controls::toggle_pause() {
  if (setup_.transport) return setup_.transport->run(!setup_.transport->runs());
  if (!paused_) (void)ask(InputKind::pause);
  paused_ = !paused_ && !goal_.ends;
  locked_on_ = false;
}

void Controls::take_over() noexcept {
  if (!runs_ || is_own() || setup_.transport || paused_ || goal_.ends) return;
  goal_.takes_over = true;
  inputs_.push_back({0, InputKind::mark, 0.0, "the user takes the drill over", {}});
  goal_.place = hand_ - Vec3(0.0, 0.0, thrust_ / setup_.hand.dynamics.stiffness);
  rest_ = thrust_ / setup_.hand.dynamics.stiffness;
  locked_on_ = spins_;
  answer_ = spins_ ? "You have the drill; it spins until X is pressed" : "You have the drill";
}

void Controls::toggle_cut() noexcept {
  if (cut_.on)
    cut_.on = false;
  else
    cut_.open_towards(camera_.camera(), setup_.world_from_approach);
}

void Controls::back_to_entry() noexcept {
  if (!moves()) return;
  straighten();
  goal_.place = Vec3(0.0, 0.0, setup_.hand.standoff);
}

void Controls::end() noexcept {
  goal_.ends = true;
  paused_ = locked_on_ = requests_.asks_end = false;
}

bool Controls::has_query() const noexcept {
  return std::ranges::any_of(inputs_, [](const Input& input) { return is_query(input.kind); });
}

std::optional<Input> Controls::take_query() {
  const auto found = std::ranges::find_if(inputs_, [](const Input& input) { return is_query(input.kind); });
  if (found == inputs_.end()) return std::nullopt;
  Input out = std::move(*found);
  inputs_.erase(found);
  return out;
}

std::optional<Input> Controls::take_input() {
  if (inputs_.empty()) return std::nullopt;
  Input next = std::move(inputs_.front());
  inputs_.pop_front();
  return next;
}

}  // namespace burrhole
