#include <fmt/format.h>

#include <filesystem>

#include "app/cli/front.h"
#include "app/cli/progress.h"
#include "app/lab/contact_accuracy.h"
#include "app/lab/multirate.h"
#ifdef BH_WITH_RENDER
#include "app/lab/render_cost.h"
#endif
#include "app/lab/sliding.h"
#include "app/lab/surface_accuracy.h"

namespace burrhole::cli {
namespace {

/// All rows of `cost contact` and its three plots.
Status measure_contact(const std::string& folder, std::size_t& row_count) {
  ContactAccuracyOptions options;
  options.tool_folder = (std::filesystem::path(share_folder()) / "tools").string();
  auto rows = measure_contact_accuracy(options);
  if (!rows) return rows.error();
  const auto curves = measure_force_curves(options);
  if (!curves) return curves.error();
  SlidingOptions slides;
  slides.tool_folder = options.tool_folder;
  const auto subjects = sliding_subjects(slides);
  if (!subjects) return subjects.error();
  const auto sliding = measure_sliding(slides, *subjects);
  if (!sliding) return sliding.error();
  const std::vector<CostRow> more = sliding_cost_rows(*sliding, slides.tool);
  rows->insert(rows->end(), more.begin(), more.end());
  row_count = rows->size();
  if (Status written = write_contact_accuracy(*rows, *curves, folder); !written) return written;
  return write_sliding(*sliding, folder);
}

Status measure_multirate_cost(const std::string& folder, std::size_t& row_count) {
  Progress progress(false);
  MultirateOptions options;
  options.progress = [&](double share) { progress.show(share, "schemes by contact rate"); };
  const auto rows = measure_multirate(options);
  if (!rows) return rows.error();
  row_count = rows->size();
  return write_multirate(*rows, folder);
}

void add_multirate(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "multirate", "Subjects",
      {.summary = "What contact slower than the servo costs, by the scheme that makes up for it",
       .about = "Slides and drills with contact at 1 kHz down to 20 Hz: how far the force is off that of contact at 1 kHz, how much of the "
                "largest stable stiffness is kept, and what a servo step takes.",
       .examples = {"burrhole cost multirate --out out/cost_multirate"},
       .exits = {}});
  auto folder = std::make_shared<std::string>("out/cost_multirate");
  command->add_option("--out", *folder, "folder for cost.csv, the plot and the page")->type_name(kFolderValue)->capture_default_str();
  add_simd_option(*command);
  command->callback([folder, &exit_code] {
    std::size_t rows = 0;
    const Status written = measure_multirate_cost(*folder, rows);
    exit_code = written ? kDone : report(written.error());
    if (written) print(fmt::format("{} rows in {}/cost.csv, multirate.svg and multirate.html beside it\n", rows, *folder));
  });
}

#ifdef BH_WITH_RENDER
struct RenderCostAsked {
  std::string folder = "out/cost_render", size = "400x300", gl = "auto";
  int frames = 9;
  bool knobs_only = false;
};

Status measure_render(const RenderCostAsked& asked, std::size_t& row_count) {
  RenderCostOptions options{.share_folder = share_folder(), .frames = asked.frames, .pareto = !asked.knobs_only};
  const auto size = split_numbers(asked.size, 'x', 2);
  if (!size || !((*size)[0] >= 16 && (*size)[0] <= 4096 && (*size)[1] >= 16 && (*size)[1] <= 4096))
    return bad_input("--size " + asked.size + " must be WIDTHxHEIGHT, each in [16, 4096]");
  options.width = static_cast<int>((*size)[0]);
  options.height = static_cast<int>((*size)[1]);
  for (const GlBackend backend : gl_backends())
    if (asked.gl == gl_backend_name(backend)) options.gl = backend;
  Progress progress(false);
  options.progress = [&](double share, const std::string& what) { progress.show(share, what); };
  const auto cost = measure_render_cost(options);
  if (!cost) return cost.error();
  row_count = cost->rows.size();
  return write_render_cost(*cost, asked.folder);
}

void add_render_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "render", "Subjects",
      {.summary = "What a picture's accuracy costs, and which knobs are worth it",
       .about =
           "Draws the shipped skull patch, as loaded and drilled through, by rays, slices and as translucent bone, with steps, "
           "bisections, finish, rays a pixel, resolution and texels of several precisions; tables PSNR, SSIM and FLIP against the best "
           "that can be drawn beside the CPU time, and draws the Pareto front. quality_front.inc is what [display] quality = "
           "\"auto\" chooses from.",
       .examples = {"burrhole cost render --out out/cost_render", "burrhole cost render --knobs-only --frames 3 --size 200x150"},
       .exits = "Exit 4 where no OpenGL can be had."});
  auto asked = std::make_shared<RenderCostAsked>();
  command->add_option("--out", asked->folder, "folder for cost.csv, the plot, the page and the pictures")
      ->type_name(kFolderValue)
      ->capture_default_str();
  command->add_option("--size", asked->size, "of the pictures in pixels")->type_name("WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--frames", asked->frames, "timed pictures for each setting")
      ->check(CLI::Range(1, 1000))
      ->type_name("COUNT")
      ->capture_default_str();
  command->add_flag("--knobs-only", asked->knobs_only, "each knob alone: no combinations, so no front");
  add_gl_option(*command, asked->gl);
  add_simd_option(*command);
  command->callback([asked, &exit_code] {
    std::size_t rows = 0;
    const Status written = measure_render(*asked, rows);
    exit_code = written ? kDone : report(written.error());
    if (written) print(fmt::format("{} rows in {}/cost.csv, render.html and pictures beside it\n", rows, asked->folder));
  });
}
#endif

}  // namespace

void add_cost(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "cost", kMeasureGroup,
                  {.summary = "Accuracy against time of one subject",
                   .about = "Measures a part of the simulator against closed forms and tables its errors beside what it costs: "
                            "as CSV, and as plots where gnuplot is installed.",
                   .examples = {"burrhole cost contact --out out/cost"},
                   .exits = {}});
  command->require_subcommand(1);
  CLI::App* contact =
      add_command(*command, "contact", "Subjects",
                  {.summary = "Error of the contact force on plate, sphere and wedge",
                   .about = "Presses bits into generated bone, clean and noisy, and compares the force with its closed form; then slides a "
                            "round burr over tilted plates, where the true force is constant, and tables how far it jumps.",
                   .examples = {"burrhole cost contact --out out/cost"},
                   .exits = {}});
  auto folder = std::make_shared<std::string>("out/cost");
  contact->add_option("--out", *folder, "folder for cost.csv and the plots")->type_name(kFolderValue)->capture_default_str();
  add_simd_option(*contact);
  contact->callback([folder, &exit_code] {
    std::size_t rows = 0;
    const Status written = measure_contact(*folder, rows);
    exit_code = written ? kDone : report(written.error());
    if (written)
      print(fmt::format("{} rows in {}/cost.csv, plots contact_error.svg, contact_force.svg and sliding.svg beside it\n", rows, *folder));
  });
  CLI::App* surface = add_command(
      *command, "surface", "Subjects",
      {.summary = "Error of the felt surface, by the bits and the pitch of its records",
       .about = "Looks distance and normal of the surface up where the closed form of generated bone is known, for records of 8 and "
                "16 bits and voxels from 0.18 to 0.5 mm, and times the look-up.",
       .examples = {"burrhole cost surface --out out/cost_surface"},
       .exits = {}});
  auto surface_folder = std::make_shared<std::string>("out/cost_surface");
  surface->add_option("--out", *surface_folder, "folder for cost.csv and the plot")->type_name(kFolderValue)->capture_default_str();
  add_simd_option(*surface);
  surface->callback([surface_folder, &exit_code] {
    const auto rows = measure_surface_accuracy({});
    if (!rows) {
      exit_code = report(rows.error());
      return;
    }
    const Status written = write_surface_accuracy(*rows, *surface_folder);
    exit_code = written ? kDone : report(written.error());
    if (written) print(fmt::format("{} rows in {}/cost.csv, plot surface_error.svg beside it\n", rows->size(), *surface_folder));
  });
  add_multirate(*command, exit_code);
#ifdef BH_WITH_RENDER
  add_render_cost(*command, exit_code);
#endif
}

}  // namespace burrhole::cli
