#include "app/cli/other_words.h"

#include <algorithm>
#include <array>

namespace burrhole::cli {
namespace {

struct OtherWord {
  std::string_view word, instead;
};

constexpr std::array<OtherWord, 25> kCommands{
    {{"run", "drill"},      {"start", "drill"}, {"simulate", "drill"}, {"play", "replay"},        {"view", "render"},
     {"show", "render"},    {"open", "render"}, {"draw", "render"},    {"screenshot", "render"},  {"load", "import"},
     {"read", "import"},    {"info", "import"}, {"convert", "export"}, {"save", "export"},        {"write", "export"},
     {"diff", "compare"},   {"list", "scenes"}, {"ls", "scenes"},      {"init", "scenes --copy"}, {"new", "scenes --copy"},
     {"validate", "check"}, {"lint", "check"},  {"bits", "tools"},     {"bench", "cost"},         {"log", "session"}}};

struct OtherName {
  std::string_view name, instead, option;
};
constexpr std::array<OtherName, 25> kOptions{{{"--tool", "--set tool.name=NAME", "--set"},
                                              {"--bit", "--set tool.name=NAME", "--set"},
                                              {"--spin", "--set tool.spin_rpm=RPM", "--set"},
                                              {"--rpm", "--set tool.spin_rpm=RPM", "--set"},
                                              {"--push", "--set hand.push_N=NEWTON", "--set"},
                                              {"--seed", "--set volume.seed=N", "--set"},
                                              {"--duration", "--set duration_s=SECONDS", "--set"},
                                              {"--time", "--set duration_s=SECONDS", "--set"},
                                              {"--volume", "--set volume.source=FILE", "--set"},
                                              {"--config", "the path of the scene alone", ""},
                                              {"--scene", "the path of the scene alone", ""},
                                              {"--input", "the path alone", ""},
                                              {"--file", "the path alone", ""},
                                              {"-i", "the path alone", ""},
                                              {"-f", "the path alone", ""},
                                              {"--headless", "--offscreen", "--offscreen"},
                                              {"--no-window", "--offscreen", "--offscreen"},
                                              {"--no-gui", "--offscreen", "--offscreen"},
                                              {"--batch", "--offscreen", "--offscreen"},
                                              {"--gui", "--window", "--window"},
                                              {"--silent", "--quiet", "--quiet"},
                                              {"-q", "--quiet", "--quiet"},
                                              {"--csv", "burrhole session RUN --csv, which prints the rows", "--stills"},
                                              {"--json", "--csv", "--stream"},
                                              {"--out", "> FILE after --csv: rows are printed on stdout", "--stream"}}};
constexpr std::array<std::string_view, 4> kOutputs{"-o", "--out", "--output", "--outfile"};

/// What is done by more than one command, or by none.
constexpr std::string_view kResults = "drill writes report.html into its folder, and compare lays runs side by side";
constexpr std::string_view kSweep =
    "a sweep is a loop of the shell: drill --set KEY=VALUE --out FOLDER for each value, then compare the folders";
constexpr std::array<OtherWord, 9> kAdvice{{{"report", kResults},
                                            {"score", kResults},
                                            {"result", kResults},
                                            {"results", kResults},
                                            {"plot", "compare ONE OTHER --out FOLDER draws curves; report.html has those of one run"},
                                            {"sweep", kSweep},
                                            {"batch", kSweep},
                                            {"gui", "burrhole alone opens the window"},
                                            {"window", "burrhole alone opens the window"}}};

}  // namespace

std::optional<std::string> advice_for(std::string_view word) {
  const auto found = std::ranges::find(kAdvice, word, &OtherWord::word);
  return found == kAdvice.end() ? std::nullopt : std::optional(std::string(found->instead));
}

std::optional<std::string> command_for(std::string_view word) {
  const auto found = std::ranges::find(kCommands, word, &OtherWord::word);
  return found == kCommands.end() ? std::nullopt : std::optional(std::string(found->instead));
}

std::optional<OtherOption> option_for(std::string_view option, const std::string& output) {
  if (!output.empty() && std::ranges::find(kOutputs, option) != kOutputs.end()) return OtherOption{output + " FILE", output};
  const auto found = std::ranges::find(kOptions, option, &OtherName::name);
  if (found == kOptions.end()) return std::nullopt;
  return OtherOption{std::string(found->instead), std::string(found->option)};
}

}  // namespace burrhole::cli
