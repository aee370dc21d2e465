#include "app/window/chooser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "app/render/picture_texture.h"
#include "app/scene/volume_scene.h"
#include "app/window/choice_list.h"
#include "app/window/file_browser.h"
#include "app/window/glfw_window.h"
#include "app/window/panel_parts.h"
#include "app/window/scan_reading.h"
#include "app/window/skull_screen.h"
#include "app/window/text_scale.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;
constexpr double kWait = 0.05, kFrame = 0.016;  // [s] for events, at most: in a list, and over a bone
const Vec3 kGround(0.06, 0.065, 0.075);

/// What the window shows.
enum class Screen { choices, files, units, reading, skull };

const std::array<Choice, 4>& unit_choices() {
  static const std::array<Choice, 4> kUnits{
      {{"THE FILE HAS NO UNIT OF LENGTH. ITS NUMBERS ARE", "millimetres", "usual for a printed or segmented bone", "", false},
       {"", "centimetres", "", "", false},
       {"", "metres", "", "", false},
       {"", "inches", "", "", false}}};
  return kUnits;
}

class ChooserWindow {
 public:
  ChooserWindow(GlfwWindow& window, std::span<const Choice> choices, const ChooserConfig& config)
      : window_(&window), choices_(choices), config_(&config), text_scale_(config.text_scale), first_(choices), units_(unit_choices()) {}

  ChooserWindow(const ChooserWindow&) = delete;
  ChooserWindow& operator=(const ChooserWindow&) = delete;
  ~ChooserWindow() {
    // Before the context, which the picture of a bone may own.
    ground_.reset();
    gui_.reset();
  }

  Status open() {
    auto context = window_->context();
    if (!context) return context.error();
    window_->set_interval(0);
    auto gui = Gui::create(static_cast<float>(text_scale_) * window_->scale(), config_->light);
    if (!gui) return gui.error();
    gui_ = std::move(gui).value();
    ground_ = std::make_unique<PictureTexture>(*context);
    context_ = std::move(context).value();
    return {};
  }

  /// Shows screens until something is chosen, or the window is to go.
  Result<std::optional<Chosen>> run(const std::atomic<bool>* stop) {
    std::vector<WindowEvent> events;
    window_->set_handler([&](const WindowEvent& event) { events.push_back(event); });
    auto before = Steady::now();
    while (!done_) {
      window_->wait(screen_ == Screen::skull ? kFrame : kWait);
      if (window_->is_lost()) return Error{ErrorCode::unavailable, "the display was lost", {}};
      if (stop != nullptr && stop->load(std::memory_order_relaxed)) break;
      moved_ = false;
      for (const WindowEvent& event : events) handle(event);
      gui_->feed(events);
      events.clear();
      const auto now = Steady::now();
      const double dt = std::chrono::duration<double>(now - before).count();
      before = now;
      if (Status took = take_bone(); !took) return took.error();
      std::erase_if(stopped_, [](const auto& reading) { return reading->has_ended(); });
      if (screen_ == Screen::skull) skull_->step(dt);
      if (window_->width() > 0 && window_->height() > 0) draw(dt);
    }
    return std::move(chosen_);
  }

 private:
  void handle(const WindowEvent& event) {
    if (event.kind == WindowEvent::Kind::close) done_ = true;
    const bool pressed = event.kind == WindowEvent::Kind::key && event.down;
    const Key key = static_cast<Key>(event.code);
    if (event.kind == WindowEvent::Kind::focus) control_ = false;
    if (event.kind == WindowEvent::Kind::key && (key == Key::left_control || key == Key::right_control)) control_ = event.down;
    if (pressed && control_ && change_text(key)) return;
    moved_ = moved_ || pressed;
    switch (screen_) {
      case Screen::choices:
        if (pressed)
          answer(
              first_.press(key), [this] { choose(first_.at()); }, [this] { done_ = true; });
        return;
      case Screen::files:
        if (pressed && (key == Key::backspace || key == Key::left)) return files_->leave();
        if (pressed)
          answer(
              files_->selection().press(key), [this] { open_file(files_->selection().at()); }, [this] { screen_ = Screen::choices; });
        return;
      case Screen::units:
        if (pressed)
          answer(
              units_.press(key), [this] { read_with_unit(units_.at()); }, [this] { screen_ = Screen::files; });
        return;
      case Screen::reading:
        if (!pressed || key != Key::escape) return;
        reading_->stop();
        stopped_.push_back(std::move(reading_));
        screen_ = Screen::files;
        return;
      case Screen::skull:
        if (pressed && key == Key::escape)
          screen_ = Screen::files;
        else if (pressed && key == Key::enter)
          start_drilling();
        else
          skull_->handle(event, gui_->wants_mouse());
        return;
    }
  }

  /// @returns whether the key, with Ctrl, changes the size of texts.
  bool change_text(Key key) {
    const bool larger = key == Key::equal || key == Key::pad_plus;
    if (!larger && key != Key::minus && key != Key::pad_minus) return false;
    text_scale_ = next_text_scale(text_scale_, larger);
    return true;
  }

  template <class Choose, class Leave>
  static void answer(Selection::Answer answer, Choose choose, Leave leave) {
    if (answer == Selection::Answer::chosen) choose();
    if (answer == Selection::Answer::closed) leave();
  }

  void choose(std::size_t line) {
    if (choices_[line].opens_files) {
      if (!files_) files_ = std::make_unique<FileBrowser>(first_folder());
      screen_ = Screen::files;
      return;
    }
    chosen_ = Chosen{.line = line};
    done_ = true;
  }

  void open_file(std::size_t line) {
    const auto file = files_->open(line);
    if (!file) return;
    if (file->kind == FileKind::scene && file->about.starts_with("not valid: ")) return files_->set_problem(file->about);
    if (file->kind == FileKind::scene) {
      chosen_ = Chosen{.scene = file->path.string()};
      done_ = true;
      return;
    }
    source_ = {file->path.string()};
    is_grids_ = file->kind == FileKind::grids;
    files_->set_problem({});
    if (file->kind == FileKind::mesh)
      screen_ = Screen::units;
    else
      read();
  }

  void read_with_unit(std::size_t n) {
    source_.unit = length_unit_names()[n];
    read();
  }

  void read() {
    reading_ = std::make_unique<ScanReading>(source_, is_grids_);
    screen_ = Screen::reading;
  }

  /// Shows a bone that has been read. @returns an error after which there is no picture at all.
  Status take_bone() {
    if (!reading_) return {};
    auto bone = reading_->take();
    if (!bone) return {};
    reading_.reset();
    if (!*bone) {
      const Error& error = bone->error();
      screen_ = Screen::files;
      if (is_grids_ && source_.unit.empty() && error.message.find("needs a unit") != std::string::npos)
        screen_ = Screen::units;
      else
        files_->set_problem(error.text());
      return {};
    }
    source_.is_bone_model = is_grids_ && source_.unit.empty();
    // The folder may get another series that is better, so the scene names this one.
    const auto& series = (*bone)->report.scan.series;
    const auto taken = std::ranges::find_if(series, &SeriesLine::taken);
    source_.series = taken != series.end() ? taken->name : std::string();
    if (!skull_) {
      auto made = SkullScreen::create(std::move(*context_), *gui_, config_->bit, config_->solid);
      context_.reset();
      if (!made) return made.error();
      skull_ = std::move(made).value();
    }
    screen_ = Screen::skull;
    if (Status set = skull_->show(std::move(*bone).value(), source_); !set) {
      screen_ = Screen::files;
      files_->set_problem("The bone cannot be drawn: " + set.error().text());
    }
    return {};
  }

  void start_drilling() {
    if (!skull_->site()) return;
    chosen_ = Chosen{.site = skull_->site(), .source = source_};
    done_ = true;
  }

  void draw(double dt) {
    const int width = window_->width(), height = window_->height();
    const auto scale = static_cast<float>(text_scale_) * window_->scale();
    if (scale != gui_->scale()) gui_->rescale(scale);
    if (screen_ == Screen::skull) skull_->draw_picture(width, height);
    ground_->clear_window(width, height, kGround);
    gui_->begin(width, height, dt);
    if (screen_ == Screen::skull) {
      const SkullScreen::Answer answer = skull_->draw_panel(width, height);
      if (answer == SkullScreen::Answer::starts) start_drilling();
      if (answer == SkullScreen::Answer::leaves) screen_ = Screen::files;
    } else {
      draw_page(width, height);
    }
    gui_->end();
    window_->swap();
  }

  /// A list, with a headline and a line of help.
  void draw_page(int width, int height) {
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), static_cast<float>(height)));
    ImGui::Begin("chooser", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    ImGui::PushFont(gui_->big());
    text("burrhole");
    ImGui::PopFont();
    const float below = 2.2f * ImGui::GetFontSize();
    if (screen_ == Screen::choices) {
      if (const auto line = draw_choices(*gui_, "choices", choices_, first_, moved_, below)) choose(*line);
      caption(*gui_, "Click, or up, down and Enter; Esc closes. burrhole --help lists the commands.");
    } else if (screen_ == Screen::files) {
      draw_files(below);
    } else if (screen_ == Screen::units) {
      caption(*gui_, source_.path.c_str());
      if (const auto line = draw_choices(*gui_, "units", unit_choices(), units_, moved_, below)) read_with_unit(*line);
      caption(*gui_, "Click, or up, down and Enter; Esc goes back.");
    } else {
      draw_reading();
    }
    ImGui::End();
  }

  void draw_files(float below) {
    text(files_->folder().string());
    if (!files_->problem().empty()) {
      ImGui::PushTextWrapPos(0.0f);
      ImGui::PushStyleColor(ImGuiCol_Text, color(gui_->colors().orange));
      text(files_->problem());
      ImGui::PopStyleColor();
      ImGui::PopTextWrapPos();
    }
    if (const auto line = draw_choices(*gui_, files_->folder().string().c_str(), files_->choices(), files_->selection(), moved_, below))
      open_file(*line);
    caption(*gui_, "Click, or up, down and Enter; Backspace shows the folder above; Esc goes back.");
  }

  void draw_reading() {
    text("Reading " + source_.path);
    ImGui::ProgressBar(static_cast<float>(reading_ ? reading_->share() : 1.0), ImVec2(-1.0f, 0.0f));
    caption(*gui_, "Then the bone is shown from outside, and you point to the place of the hole. Esc stops the reading.");
  }

  GlfwWindow* window_;
  std::span<const Choice> choices_;
  const ChooserConfig* config_;
  std::optional<GlContext> context_;  // until the picture of a bone has it
  std::unique_ptr<Gui> gui_;
  std::unique_ptr<PictureTexture> ground_;
  std::unique_ptr<SkullScreen> skull_;
  double text_scale_;
  bool control_ = false;
  Screen screen_ = Screen::choices;
  Selection first_, units_;
  std::unique_ptr<FileBrowser> files_;
  std::unique_ptr<ScanReading> reading_;
  std::vector<std::unique_ptr<ScanReading>> stopped_;  // their threads end at the next file or slice
  SkullSource source_;
  bool is_grids_ = false, moved_ = false, done_ = false;
  std::optional<Chosen> chosen_;
};

}  // namespace

Result<std::optional<Chosen>> choose_in_window(const std::string& title, std::span<const Choice> choices, const ChooserConfig& config,
                                               const std::atomic<bool>* stop) {
  auto window = GlfwWindow::create(title, config.width, config.height);
  if (!window) return window.error();
  ChooserWindow chooser(*window, choices, config);
  if (Status opened = chooser.open(); !opened) return opened.error();
  return chooser.run(stop);
}

}  // namespace burrhole
