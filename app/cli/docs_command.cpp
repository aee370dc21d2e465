#include "app/cli/commands.h"
#include "app/scene/schema_doc.h"

namespace burrhole::cli {

void add_docs(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "docs", kReferenceGroup,
                  {.summary = "Prints the reference of a file format as Markdown",
                   .about = "The reference is generated from the rules that read such files, so it matches this program: each key with its "
                            "range, default and meaning.",
                   .examples = {"burrhole docs scene | less", "burrhole docs tool > tool.md"},
                   .exits = {}});
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* summary, SchemaFile file) {
    add_command(*command, name, "Formats",
                {.summary = summary,
                 .about = "Prints only Markdown on stdout.",
                 .examples = {std::string("burrhole docs ") + name + " | less"},
                 .exits = {}})
        ->callback([file, &exit_code] {
          print(schema_markdown(file));
          exit_code = kDone;
        });
  };
  add("scene", "Every table and key of a scene file", SchemaFile::scene);
  add("tool", "Every table and key of a tool file", SchemaFile::tool);
  add("raw", "Every key of the file that describes a raw volume", SchemaFile::raw);
}

}  // namespace burrhole::cli
