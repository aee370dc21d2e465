/// app/cli/program.h: the command line of the program as CLI11 parses it, and the texts of errors in it. Nothing runs but what a parsed
///   command's callback runs.
///   Thread  main.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace burrhole::cli {

/// @returns the program with all commands. The callback of the command that is parsed runs it and sets `exit_code`.
[[nodiscard]] std::unique_ptr<CLI::App> make_program(int& exit_code);

/// @param words after the program's name. @returns what is wrong with a word in place of a command, with the nearest known command, which
/// CLI11 does not name; nothing if the commands are known. May hold control characters of the words.
[[nodiscard]] std::optional<std::string> unknown_command(const CLI::App& program, std::span<const char* const> words);

/// @returns what is wrong with the words after the program's name. May hold control characters of the words.
[[nodiscard]] std::string usage_text(const CLI::App& program, const CLI::ParseError& error);

}  // namespace burrhole::cli
