#include "app/cli/cost_effects.h"

#include <fmt/format.h>

#include <memory>

#include "app/cli/commands.h"
#include "app/cli/cost_study.h"
#include "app/lab/effects_cost.h"

namespace burrhole::cli {
namespace {

struct EffectsCostArguments {
  StudyFolder folder{.folder = "out/cost_effects", .partial = "partial_effects.txt"};
  std::string scene = "parietal";
  EffectsCostOptions options;
  bool quick = false, no_prices = false, no_knobs = false, no_accuracy = false, json = false;
};

int run_effects_cost(const EffectsCostArguments& arguments) {
  const auto lock = begin_study(arguments.folder);
  if (!lock) return report(lock.error());
  Progress progress(arguments.json, {}, true);
  EffectsCostOptions options = arguments.options;
  options.scene_file = find_scene(arguments.scene);
  options.context = scene_context();
  options.prices = !arguments.no_prices;
  options.knobs = !arguments.no_knobs && !arguments.quick;
  options.ladders = !arguments.no_accuracy && !arguments.quick;
  if (arguments.quick) options.repeats = 1;
  options.runs = study_runs(arguments.folder, progress);
  const auto cost = measure_effects_cost(options);
  if (!cost) return report(cost.error());
  if (const Status written = write_effects_cost(*cost, arguments.folder.folder); !written) return report(written.error());
  end_study(arguments.folder);
  if (arguments.json) {
    print(effects_cost_json(*cost));
    return kDone;
  }
  print(effects_cost_tables(*cost));
  print(fmt::format(
      "{} effects, {} values of keys and {} keys from coarse to fine in {}/cost.csv; effects.md, effects.html and plots beside it\n",
      cost->prices.size(), cost->knobs.size(), cost->ladders.size(), arguments.folder.folder));
  return kDone;
}

}  // namespace

void add_effects_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "effects", "Subjects",
      {.summary = "Time and memory of each effect, what its keys change, and what accuracy costs",
       .about =
           "Drills a scene in lockstep, without pictures: as it is, and with or without each effect of the program, in turns. Tables the "
           "CPU "
           "time and memory that an effect adds, and whether it changes bone and forces. Then sets each number of its table to half and to "
           "twice its default, and names the figure of the run that changes most. Then sets the keys that trade time for accuracy, those "
           "of the "
           "effect and those that act on all effects, from coarse to fine, and tables and plots the error of each figure against a finer "
           "run, "
           "with the time of the effect's steps and its memory. An interrupted call is resumed.",
       .examples = {"burrhole cost effects --out out/cost_effects", "burrhole cost effects --effect heat", "burrhole cost effects --quick",
                    "burrhole cost effects --no-prices --no-knobs"},
       .exits = {}});
  auto arguments = std::make_shared<EffectsCostArguments>();
  add_study_options(*command, arguments->folder, "the tables, the plot and the page");
  command->add_option("--scene", arguments->scene, "scene file, or name of a shipped scene")->type_name(kFileValue)->capture_default_str();
  command->add_option("--effect", arguments->options.only, "measure only these effects, by the names of their tables")->type_name("TABLE");
  command->add_option("--repeats", arguments->options.repeats, "runs of each kind, of which the median counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("COUNT")
      ->capture_default_str();
  command->add_flag("--no-prices", arguments->no_prices, "not with and without each effect");
  command->add_flag("--no-knobs", arguments->no_knobs, "no keys at half and twice their default");
  command->add_flag("--no-accuracy", arguments->no_accuracy, "no keys from coarse to fine");
  command->add_flag("--quick", arguments->quick, "one run of each kind, and no other values of keys");
  command->add_flag("--json", arguments->json, "print only the figures on stdout, as JSON");
  add_simd_option(*command);
  command->callback([arguments, &exit_code] { exit_code = run_effects_cost(*arguments); });
}

}  // namespace burrhole::cli
