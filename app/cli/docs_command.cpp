#include "app/cli/commands.h"
#include "app/job/outcome_doc.h"
#include "app/scene/schema_doc.h"

namespace burrhole::cli {

void add_docs(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "docs", kReferenceGroup,
                  {.summary = "Prints a reference as Markdown: file formats, outcomes of a run",
                   .about = "The reference is generated from the rules that read such files, so it matches this program: each key with its "
                            "range, default and meaning.",
                   .examples = {"burrhole docs scene | less", "burrhole docs tool > tool.md"},
                   .exits = {}});
  command->require_subcommand(1);
  const auto add_page = [&](const char* name, const char* summary, auto page) {
    add_command(*command, name, "Formats",
                {.summary = summary,
                 .about = "Prints only Markdown on stdout.",
                 .examples = {std::string("burrhole docs ") + name + " | less"},
                 .exits = {}})
        ->callback([page, &exit_code] {
          print(page());
          exit_code = kDone;
        });
  };
  const auto add = [&](const char* name, const char* summary, SchemaFile file) {
    add_page(name, summary, [file] { return schema_markdown(file); });
  };
  add("scene", "Every table and key of a scene file", SchemaFile::scene);
  add("tool", "Every table and key of a tool file", SchemaFile::tool);
  add("raw", "Every key of the file that describes a raw volume", SchemaFile::raw);
  add_page("outcome", "Results and flags of a run, and the terms of --expect", [] { return outcome_markdown(); });
}

}  // namespace burrhole::cli
