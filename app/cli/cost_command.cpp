#include <fmt/format.h>

#include <filesystem>

#include "app/cli/commands.h"
#include "app/cli/cost_drilling.h"
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

/// Measures all rows of `cost contact` and writes them with three plots.
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
  Progress progress(false, {}, true);
  MultirateOptions options;
  options.progress = [&](double share) { progress.show(share, "multi-rate schemes"); };
  const auto rows = measure_multirate(options);
  if (!rows) return rows.error();
  row_count = rows->size();
  return write_multirate(*rows, folder);
}

void add_multirate(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(cost, "multirate", "Subjects",
                                  {.summary = "Accuracy of the multi-rate schemes by the rate of contact",
                                   .about = "Slides and drills with contact at 1 kHz down to 20 Hz. For each scheme: the error of the "
                                            "force against servo and contact at 4 kHz, the "
                                            "share of the maximum stable stiffness that remains, and the time of a servo step.",
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
struct RenderCostArguments {
  std::string folder = "out/cost_render", size = "400x300", gl = "auto";
  int frames = 9;
  bool knobs_only = false;
};

Status measure_render(const RenderCostArguments& arguments, std::size_t& row_count) {
  RenderCostOptions options{.share_folder = share_folder(), .frames = arguments.frames, .pareto = !arguments.knobs_only};
  const auto size = split_numbers(arguments.size, 'x', 2);
  if (!size || !((*size)[0] >= 16 && (*size)[0] <= 4096 && (*size)[1] >= 16 && (*size)[1] <= 4096))
    return bad_input("--size " + arguments.size + " must be WIDTHxHEIGHT, each in [16, 4096]");
  options.width = static_cast<int>((*size)[0]);
  options.height = static_cast<int>((*size)[1]);
  for (const GlBackend backend : gl_backends())
    if (arguments.gl == gl_backend_name(backend)) options.gl = backend;
  Progress progress(false, {}, true);
  options.progress = [&](double share, const std::string& what) { progress.show(share, what); };
  const auto cost = measure_render_cost(options);
  if (!cost) return cost.error();
  row_count = cost->rows.size();
  return write_render_cost(*cost, arguments.folder);
}

void add_render_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "render", "Subjects",
      {.summary = "Accuracy of pictures against CPU time, by the quality settings",
       .about =
           "Draws the shipped skull patch, as loaded and drilled through, by ray casting, by slices and as translucent bone. Varies step "
           "length, bisections, finish, rays per pixel, resolution and texel precision. Tables PSNR, SSIM and FLIP against a reference "
           "picture of the highest quality, and the CPU time. Writes the Pareto front as quality_front.inc, from which [display] quality = "
           "\"auto\" chooses.",
       .examples = {"burrhole cost render --out out/cost_render", "burrhole cost render --knobs-only --frames 3 --size 200x150"},
       .exits = "Exit 4 if there is no OpenGL."});
  auto arguments = std::make_shared<RenderCostArguments>();
  command->add_option("--out", arguments->folder, "folder for cost.csv, the plot, the page and the pictures")
      ->type_name(kFolderValue)
      ->capture_default_str();
  command->add_option("--size", arguments->size, "size of the pictures in pixels")->type_name("WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--frames", arguments->frames, "timed pictures per setting")
      ->check(CLI::Range(1, 1000))
      ->type_name("COUNT")
      ->capture_default_str();
  command->add_flag("--knobs-only", arguments->knobs_only, "varies one setting at a time: no combinations, so no Pareto front");
  add_gl_option(*command, arguments->gl);
  add_simd_option(*command);
  command->callback([arguments, &exit_code] {
    std::size_t rows = 0;
    const Status written = measure_render(*arguments, rows);
    exit_code = written ? kDone : report(written.error());
    if (written) print(fmt::format("{} rows in {}/cost.csv, render.html and pictures beside it\n", rows, arguments->folder));
  });
}
#endif

}  // namespace

void add_cost(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "cost", kMeasureGroup,
      {.summary = "Measures accuracy and computation time of one subject",
       .about = "Compares a part of the simulator with closed forms and tables its errors and computation times, as CSV, and as "
                "plots if gnuplot is installed.",
       .examples = {"burrhole cost contact --out out/cost"},
       .exits = {}});
  command->require_subcommand(1);
  CLI::App* contact = add_command(
      *command, "contact", "Subjects",
      {.summary = "Error of the contact force on plate, sphere and wedge",
       .about = "Presses bits into generated bone, without and with noise, and compares the force with its closed form. Then slides "
                "a round burr over tilted plates, where the exact force is constant, and tables the variation of the force.",
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
      {.summary = "Error of the surface records by their bits and voxel size",
       .about = "Compares distance and normal of surface records with the closed form of generated bone, for records of 8 and 16 bits and "
                "voxels from 0.18 to 0.5 mm, and times the look-up.",
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
  add_drilling_cost(*command, exit_code);
  add_multirate(*command, exit_code);
#ifdef BH_WITH_RENDER
  add_render_cost(*command, exit_code);
#endif
}

}  // namespace burrhole::cli
