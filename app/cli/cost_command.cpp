#include <fmt/format.h>

#include <filesystem>
#include <functional>

#include "app/cli/commands.h"
#include "app/cli/cost_drilling.h"
#include "app/cli/cost_effects.h"
#include "app/cli/cost_mesh.h"
#include "app/cli/cost_study.h"
#include "app/lab/contact_accuracy.h"
#include "app/lab/multirate.h"
#ifdef BH_WITH_RENDER
#include "app/lab/render_cost.h"
#endif
#include "app/lab/sliding.h"
#include "app/lab/surface_accuracy.h"

namespace burrhole::cli {
namespace {

constexpr const char* kResumes = "An interrupted call is resumed.";

/// @returns bad_input if the bit of `cost contact` is neither a shipped tool nor a tool file.
Status check_contact_bit(const std::string& bit) {
  const std::filesystem::path path(bit);
  std::error_code ignored;
  const bool is_file = path.extension() == ".toml" && std::filesystem::exists(path, ignored);
  const bool is_shipped =
      path.filename() == path && std::filesystem::exists(std::filesystem::path(share_folder()) / "tools" / (bit + ".toml"), ignored);
  if (is_file || is_shipped) return {};
  return bad_input(
      fmt::format("--bit \"{}\" is no shipped tool (burrhole tools lists them) and no tool file (.toml): give one of these", bit));
}

/// Measures all rows of `cost contact` and writes them with three plots. @param bit presses alone; empty: the shipped three.
Status measure_contact(const std::string& bit, const StudyFolder& folder, std::size_t& row_count) {
  ContactAccuracyOptions options;
  options.tool_folder = (std::filesystem::path(share_folder()) / "tools").string();
  if (!bit.empty()) options.tools = {bit};
  SlidingOptions slides;
  slides.tool_folder = options.tool_folder;
  const auto subjects = sliding_subjects(slides);
  if (!subjects) return subjects.error();
  Progress progress(false, {}, true);
  Study study(study_runs(folder, progress), count_of_trials(options) + count_of_trials(slides, *subjects));
  options.study = slides.study = &study;
  auto pressing = measure_contact_accuracy(options);
  if (!pressing) return pressing.error();
  const auto sliding = measure_sliding(slides, *subjects);
  if (!sliding) return sliding.error();
  std::vector<CostRow>& rows = pressing->rows;
  const std::vector<CostRow> more = sliding_cost_rows(*sliding, slides.tool);
  rows.insert(rows.end(), more.begin(), more.end());
  row_count = rows.size();
  if (Status written = write_contact_accuracy(rows, pressing->curves, folder.folder); !written) return written;
  return write_sliding(*sliding, folder.folder);
}

Status measure_surface(const StudyFolder& folder, std::size_t& row_count) {
  Progress progress(false, {}, true);
  SurfaceAccuracyOptions options;
  Study study(study_runs(folder, progress), count_of_trials(options));
  options.study = &study;
  const auto rows = measure_surface_accuracy(options);
  if (!rows) return rows.error();
  row_count = rows->size();
  return write_surface_accuracy(*rows, folder.folder);
}

Status measure_multirate_cost(const StudyFolder& folder, std::size_t& row_count) {
  Progress progress(false, {}, true);
  MultirateOptions options;
  Study study(study_runs(folder, progress), count_of_trials(options));
  options.study = &study;
  const auto rows = measure_multirate(options);
  if (!rows) return rows.error();
  row_count = rows->size();
  return write_multirate(*rows, folder.folder);
}

/// Runs a study and prints where its rows are. @param measure writes them and counts them. @param beside files beside cost.csv.
int run_study(const StudyFolder& folder, const std::function<Status(const StudyFolder&, std::size_t&)>& measure,
              const std::string& beside) {
  const auto lock = begin_study(folder);
  if (!lock) return report(lock.error());
  std::size_t rows = 0;
  if (const Status measured = measure(folder, rows); !measured) return report(measured.error());
  end_study(folder);
  print(fmt::format("{} rows in {}/cost.csv, {} beside it\n", rows, folder.folder, beside));
  return kDone;
}

void add_contact(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "contact", "Subjects",
      {.summary = "Error of the contact force on plate, sphere and wedge",
       .about = std::string("Presses bits, the shipped three or that of --bit, into generated bone, without and with noise, and "
                            "compares the force with its closed form. Then "
                            "slides a round burr over tilted plates, where the exact force is constant, and tables the variation of the "
                            "force. ") +
                kResumes,
       .examples = {"burrhole cost contact --out out/cost", "burrhole cost contact --bit my_bit.toml --out out/my_bit"},
       .exits = {}});
  auto bit = std::make_shared<std::string>();
  command->add_option("--bit", *bit, "bit that is pressed: a shipped tool or a tool file; default: three shipped ones")
      ->type_name(kToolValue);
  auto folder = std::make_shared<StudyFolder>(StudyFolder{.folder = "out/cost", .partial = "partial_contact.txt"});
  add_study_options(*command, *folder, "cost.csv and the plots");
  add_simd_option(*command);
  command->callback([folder, bit, command, &exit_code] {
    if (command->count("--bit") > 0)
      if (const Status known = check_contact_bit(*bit); !known) {
        exit_code = report(known.error());
        return;
      }
    const auto measure = [&](const StudyFolder& into, std::size_t& rows) { return measure_contact(*bit, into, rows); };
    exit_code = run_study(*folder, measure, "plots contact_error.svg, contact_force.svg and sliding.svg");
  });
}

void add_surface(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "surface", "Subjects",
      {.summary = "Error of the surface records by their bits and voxel size",
       .about = std::string("Compares distance and normal of surface records with the closed form of generated bone, for records of 8 and "
                            "16 bits and voxels from 0.18 to 0.5 mm, and times the look-up. No bit is involved. ") +
                kResumes,
       .examples = {"burrhole cost surface --out out/cost_surface"},
       .exits = {}});
  auto folder = std::make_shared<StudyFolder>(StudyFolder{.folder = "out/cost_surface", .partial = "partial_surface.txt"});
  add_study_options(*command, *folder, "cost.csv and the plot");
  add_simd_option(*command);
  command->callback([folder, &exit_code] { exit_code = run_study(*folder, measure_surface, "plot surface_error.svg"); });
}

void add_multirate(CLI::App& cost, int& exit_code) {
  CLI::App* command =
      add_command(cost, "multirate", "Subjects",
                  {.summary = "Accuracy of the multi-rate schemes by the rate of contact",
                   .about = std::string("Slides and drills with contact at 1 kHz down to 20 Hz. For each scheme: the error of the "
                                        "force against servo and contact at 4 kHz, the "
                                        "share of the maximum stable stiffness that remains, and the time of a servo step. The tool is a "
                                        "ball, whose forces have a closed form, so there is no --bit. ") +
                            kResumes,
                   .examples = {"burrhole cost multirate --out out/cost_multirate"},
                   .exits = {}});
  auto folder = std::make_shared<StudyFolder>(StudyFolder{.folder = "out/cost_multirate", .partial = "partial_multirate.txt"});
  add_study_options(*command, *folder, "cost.csv, the plot and the page");
  add_simd_option(*command);
  command->callback([folder, &exit_code] { exit_code = run_study(*folder, measure_multirate_cost, "multirate.svg and multirate.html"); });
}

#ifdef BH_WITH_RENDER
struct RenderCostArguments {
  StudyFolder folder{.folder = "out/cost_render", .partial = "partial_render.txt"};
  std::string size = "400x300", gl = "auto";
  int frames = 9;
  bool knobs_only = false;
};

Result<RenderCostOptions> options_of(const RenderCostArguments& arguments) {
  RenderCostOptions options{.share_folder = share_folder(), .frames = arguments.frames, .pareto = !arguments.knobs_only};
  const auto size = split_numbers(arguments.size, 'x', 2);
  if (!size || !((*size)[0] >= 16 && (*size)[0] <= 4096 && (*size)[1] >= 16 && (*size)[1] <= 4096))
    return bad_input("--size " + arguments.size + " must be WIDTHxHEIGHT, each in [16, 4096]");
  options.width = static_cast<int>((*size)[0]);
  options.height = static_cast<int>((*size)[1]);
  for (const GlBackend backend : gl_backends())
    if (arguments.gl == gl_backend_name(backend)) options.gl = backend;
  return options;
}

Status measure_render(RenderCostOptions options, const StudyFolder& folder, std::size_t& row_count) {
  Progress progress(false, {}, true);
  Study study(study_runs(folder, progress), count_of_trials(options));
  options.study = &study;
  const auto cost = measure_render_cost(options);
  if (!cost) return cost.error();
  row_count = cost->rows.size();
  return write_render_cost(*cost, folder.folder);
}

void add_render_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "render", "Subjects",
      {.summary = "Accuracy of pictures against CPU time, by the quality settings",
       .about =
           "Draws the shipped skull patch, as loaded and drilled through, by ray casting, by slices and as translucent bone. Varies step "
           "length, bisections, finish, rays per pixel, resolution and texel precision. Tables PSNR, SSIM and FLIP against a reference "
           "picture of the highest quality, and the CPU time. Writes the Pareto front as quality_front.inc, from which [display] quality = "
           "\"auto\" chooses. An interrupted call is resumed.",
       .examples = {"burrhole cost render --out out/cost_render", "burrhole cost render --knobs-only --frames 3 --size 200x150"},
       .exits = "Exit 4 if there is no OpenGL."});
  auto arguments = std::make_shared<RenderCostArguments>();
  add_study_options(*command, arguments->folder, "cost.csv, the plot, the page and the pictures");
  command->add_option("--size", arguments->size, "size of the pictures in pixels")->type_name("WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--frames", arguments->frames, "timed pictures per setting")
      ->check(CLI::Range(1, 1000))
      ->type_name("COUNT")
      ->capture_default_str();
  command->add_flag("--knobs-only", arguments->knobs_only, "varies one setting at a time: no combinations, so no Pareto front");
  add_gl_option(*command, arguments->gl);
  add_simd_option(*command);
  command->callback([arguments, &exit_code] {
    const auto options = options_of(*arguments);
    if (!options) {
      exit_code = report(options.error());
      return;
    }
    const auto measure = [&](const StudyFolder& folder, std::size_t& rows) { return measure_render(*options, folder, rows); };
    exit_code = run_study(arguments->folder, measure, "render.html and pictures");
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
  add_contact(*command, exit_code);
  add_surface(*command, exit_code);
  add_drilling_cost(*command, exit_code);
  add_effects_cost(*command, exit_code);
  add_mesh_cost(*command, exit_code);
  add_multirate(*command, exit_code);
#ifdef BH_WITH_RENDER
  add_render_cost(*command, exit_code);
#endif
}

}  // namespace burrhole::cli
