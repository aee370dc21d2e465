#include "app/window/selection.h"

#include <doctest/doctest.h>

#include <array>

namespace burrhole {
namespace {

using Answer = Selection::Answer;

TEST_CASE("keys move over what can be chosen, and stop at both ends") {
  const std::array<Choice, 5> choices{
      {{"Scenes", "a", "", "no data"}, {"", "b"}, {"", "c", "", "no data"}, {"Runs", "d"}, {"", "e", "", "gone"}}};
  Selection selection(choices);
  CHECK(selection.at() == 1);
  CHECK(selection.press(Key::up) == Answer::none);
  CHECK(selection.at() == 1);
  CHECK(selection.press(Key::down) == Answer::none);
  CHECK(selection.at() == 3);
  (void)selection.press(Key::down);
  CHECK(selection.at() == 3);
  (void)selection.press(Key::home);
  CHECK(selection.at() == 1);
  CHECK(selection.press(Key::enter) == Answer::chosen);
  CHECK(selection.press(Key::escape) == Answer::closed);
  CHECK(selection.press(Key::x) == Answer::none);
  CHECK_FALSE(selection.point_at(2));
  CHECK_FALSE(selection.point_at(99));
  CHECK(selection.at() == 1);
  CHECK(selection.point_at(3));
  CHECK(selection.at() == 3);
}

TEST_CASE("a page is eight lines, and ends at both ends") {
  std::array<Choice, 20> choices{};
  choices[3].missing = "gone";
  Selection selection(choices);
  (void)selection.press(Key::page_down);
  CHECK(selection.at() == 9);  // one of the lines cannot be chosen
  (void)selection.press(Key::page_down);
  (void)selection.press(Key::page_down);
  CHECK(selection.at() == 19);
  (void)selection.press(Key::page_up);
  CHECK(selection.at() == 11);
  (void)selection.press(Key::page_up);
  (void)selection.press(Key::page_up);
  CHECK(selection.at() == 0);
}

TEST_CASE("of nothing, nothing is chosen") {
  Selection none({});
  CHECK(none.press(Key::enter) == Answer::none);
  CHECK(none.press(Key::down) == Answer::none);
  const std::array<Choice, 1> gone{{{"", "a", "", "no data"}}};
  Selection only(gone);
  CHECK(only.press(Key::enter) == Answer::none);
  CHECK(only.press(Key::home) == Answer::none);
}

}  // namespace
}  // namespace burrhole
