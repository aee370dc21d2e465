#include "app/cli/man_page.h"

#include <algorithm>

#include "app/cli/command_text.h"

namespace burrhole::cli {
namespace {

std::string escaped(std::string_view text, bool code) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool starts_line = i == 0 || text[i - 1] == '\n';
    if (starts_line && (c == '.' || c == '\'')) out += "\\&";  // would be a request
    if (c == '\\')
      out += "\\e";
    else if (code && c == '-')
      out += "\\-";
    else if (code && c == '\'')
      out += "\\(aq";
    else if (code && c == '`')
      out += "\\(ga";
    else if (code && c == '^')
      out += "\\(ha";
    else if (code && c == '~')
      out += "\\(ti";
    else
      out += c;
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + troff_code(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + troff_code(text) + "\\fR"; }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// "burrhole drill [OPTIONS] SCENE"
std::string usage(const CommandNode& node) {
  std::string out = bold("burrhole" + (node.path.empty() ? "" : " " + node.path));
  const auto own = std::count_if(node.options.begin(), node.options.end(), [](const OptionNode& o) { return o.names.back() != "--help"; });
  if (own > 0) out += " [" + italic("OPTIONS") + "]";
  for (const ArgumentNode& argument : node.arguments)
    out += argument.required ? " " + italic(upper(argument.name)) : " [" + italic(upper(argument.name)) + "]";
  return node.commands.empty() ? out : out + " " + italic("COMMAND");
}

/// @returns lines that keep their breaks, in a fixed-width font.
std::string verbatim(const std::string& lines) { return ".PP\n.EX\n" + troff_code(lines) + "\n.EE\n"; }

std::string option_item(const OptionNode& option) {
  std::string out = ".TP\n";
  for (std::size_t n = 0; n < option.names.size(); ++n) out += (n > 0 ? ", " : "") + bold(option.names[n]);
  if (!option.value.empty()) out += " " + italic(option.value);
  out += "\n" + troff_text(option.about);
  return out + (option.fallback.empty() ? "" : " (default: " + troff_code(option.fallback) + ")") + "\n";
}

std::string command_section(const CommandNode& node) {
  std::string out = ".SS \"burrhole " + troff_code(node.path) + "\"\n" + usage(node) + "\n.PP\n" + troff_text(node.summary) + ".\n";
  if (!node.about.empty()) out += ".PP\n" + troff_text(node.about) + "\n";
  for (const ArgumentNode& argument : node.arguments)
    out += ".TP\n" + italic(upper(argument.name)) + "\n" + troff_text(argument.about) + "\n";
  for (const OptionNode& option : node.options)
    if (option.names.back() != "--help") out += option_item(option);
  if (!node.footer.empty()) out += verbatim(node.footer);
  return out;
}

constexpr const char* kTail = R"(.SH EXIT STATUS
.TP
.B 0
Done.
.TP
.B 1
Internal error of the program.
.TP
.B 2
Error in the input or on the command line; one line per error on standard error, with file, line and column for files.
Also an output that cannot be written: a file that was there before stays as it was.
.TP
.B 3
A check or a bound failed: a replay that differs, a stability case beyond its bounds.
.TP
.B 4
No usable device, display or OpenGL.
.TP
.B 130
Interrupted; the results so far are written.
.SH FILES
.TP
.I PREFIX/share/burrhole/scenes
Shipped scenes. A scene is named by its path or, when shipped, by its name alone.
.TP
.I PREFIX/share/burrhole/tools
Shipped tools. The scene's own folder is searched first.
.TP
.I out
Folder for results unless \fB\-\-out\fR names another: pictures, session.sqlite, bone.vdb, summary.json and report.html.
.SH ENVIRONMENT
.TP
.B BURRHOLE_DATA
Folder of real scans. The shipped head scenes name it; the test programs read it, and skip those tests without it.
.TP
.B GALLIUM_DRIVER
Driver of OSMesa, which draws the pictures: llvmpipe, or not set.
.SH EXAMPLES
)";

constexpr const char* kExamples = R"(# drill the shipped scene, then open out/parietal/report.html
burrhole drill parietal --out out/parietal

# the same with another spin rate and more thrust
burrhole drill parietal --set tool.spin_rpm=800 --set hand.push_N=35 --out out/harder

# a picture of the drilled bone, section through the axis
burrhole render parietal --restore out/parietal/bone.vdb --cut --image hole.png

# run a recorded session again and compare the results bit for bit
burrhole replay out/parietal/session.sqlite)";

}  // namespace

std::string troff_text(std::string_view text) { return escaped(text, false); }
std::string troff_code(std::string_view text) { return escaped(text, true); }

std::string man_page(const CommandNode& program, std::string_view version) {
  std::string out = ".\\\" Printed by `burrhole man`.\n.TH BURRHOLE 1 \"\" \"burrhole " + troff_code(version) + "\" \"User Commands\"\n";
  out +=
      ".SH NAME\nburrhole \\- simulate the drilling of craniotomy burrholes in a voxel skull, with haptic contact, erosion and "
      "rendering\n.SH SYNOPSIS\n";
  for (const CommandNode* node : every_command(program))
    if (node->commands.empty()) out += usage(*node) + "\n.br\n";
  out += bold("burrhole") + " [" + bold("--help") + " | " + bold("--version") + "]\n.SH DESCRIPTION\n";
  out +=
      "Bone is a voxel map of density. Contact is computed with a point shell of the tool, bone is removed at its erosion points, and\n"
      "pictures are drawn by ray casting. A scene is one TOML file: an effect exists if, and only if, the file has its table. A scene\n"
      "gives bit-identical results on every machine.\n"
      "Results go to files and to standard output, messages to standard error.\n.SH COMMANDS\n";
  for (const CommandNode* node : every_command(program)) {
    if (node == &program) continue;
    out += command_section(*node);
  }
  return out + kTail + ".EX\n" + troff_code(kExamples) + "\n.EE\n" +
         ".SH SEE ALSO\nThe references of the formats: " + bold("burrhole docs scene") + ", " + bold("burrhole docs tool") + " and " +
         bold("burrhole docs raw") + ".\nEvery command's own help: " + bold("burrhole COMMAND --help") + ".\n";
}

}  // namespace burrhole::cli
