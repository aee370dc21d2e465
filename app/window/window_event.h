/// app/window/window_event.h: what a person does at a window, as plain values. Recordings of them take a person's place in tests.
///   Units  pixels of the window, origin at the top left; steps of a wheel.
#pragma once

namespace burrhole {

/// Keys that the program knows; the values are those of GLFW.
enum class Key : int {
  space = 32,
  minus = 45,
  digit_0 = 48,
  digit_9 = 57,
  equal = 61,
  a = 65,
  c = 67,
  d = 68,
  e = 69,
  f = 70,
  g = 71,
  h = 72,
  i = 73,
  k = 75,
  l = 76,
  m = 77,
  n = 78,
  p = 80,
  q = 81,
  r = 82,
  s = 83,
  t = 84,
  u = 85,
  v = 86,
  w = 87,
  x = 88,
  z = 90,
  escape = 256,
  enter = 257,
  tab = 258,
  backspace = 259,
  right = 262,
  left = 263,
  down = 264,
  up = 265,
  page_up = 266,
  page_down = 267,
  home = 268,
  f1 = 290,
  f2 = 291,
  f3 = 292,
  f9 = 298,
  f11 = 300,
  f12 = 301,
  pad_minus = 333,
  pad_plus = 334,
  left_shift = 340,
  left_control = 341,
  left_alt = 342,
  right_shift = 344,
  right_control = 345,
  right_alt = 346
};

enum class MouseButton : int { left = 0, right = 1, middle = 2 };

struct WindowEvent {
  enum class Kind { key, character, button, motion, scroll, size, focus, close };
  Kind kind = Kind::motion;
  int code = 0;             ///< Key, MouseButton, or Unicode of a character
  bool down = false;        ///< key and button: pressed; focus: gained
  double x = 0.0, y = 0.0;  ///< button and motion: place [pixels]; scroll: y [steps]; size: width, height [pixels]
};

/// A game pad with the mapping of GLFW's database; axes -1..1, triggers 0..1.
struct PadState {
  bool present = false;
  double left_x = 0.0, left_y = 0.0, right_x = 0.0, right_y = 0.0;  ///< [-] sticks, -1..1, right and down
  double left_trigger = 0.0, right_trigger = 0.0;                   ///< [-] 0 released .. 1
  bool a = false, b = false, x = false, y = false, start = false, left_bumper = false, right_bumper = false;
};

}  // namespace burrhole
