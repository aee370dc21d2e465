#include "app/cli/command_text.h"
#include "app/cli/completion.h"

namespace burrhole::cli {
namespace {

/// @returns lines of a `case`: commands, options and arguments of each command.
std::string table_cases(const CommandNode& program) {
  std::string out;
  for (const CommandNode* node : every_command(program)) {
    std::vector<std::string> commands, options, arguments;
    for (const CommandNode& command : node->commands) commands.push_back(command.name);
    for (const OptionNode& option : node->options) options.insert(options.end(), option.names.begin(), option.names.end());
    for (const ArgumentNode& argument : node->arguments) arguments.push_back(shell_quoted(argument.value));
    out += "    " + shell_quoted(node->path) + ") commands=" + shell_quoted(joined(commands)) +
           " options=" + shell_quoted(joined(options)) + " arguments=(" + joined(arguments) + ") ;;\n";
  }
  return out;
}

/// @returns lines of a `case`: the kind of value of each option that takes one.
std::string value_cases(const CommandNode& program) {
  std::string out;
  for (const CommandNode* node : every_command(program))
    for (const OptionNode& option : node->options)
      for (const std::string& name : option.names)
        if (!option.value.empty()) out += "    " + shell_quoted(node->path + " " + name) + ") kind=" + shell_quoted(option.value) + " ;;\n";
  return out;
}

constexpr const char* kOffer = R"SH(
# Fills COMPREPLY for a value of kind $1 that begins with $2.
_burrhole_offer() {
  local names=''
  case $1 in
    SCENE | SHIPPED) names=@SCENES@ ;;
    NAME) names=@TOOLS@ ;;
    *:\{*\})
      names=${1#*:\{}
      names=${names%\}}
      names=${names//,/ }
      mapfile -t COMPREPLY < <(compgen -W "$names" -- "$2")
      ;;
    FOLDER) mapfile -t COMPREPLY < <(compgen -d -- "$2") ;;
    FILE) mapfile -t COMPREPLY < <(compgen -f -- "$2") ;;
  esac
  case $1 in
    SHIPPED) mapfile -t COMPREPLY < <(compgen -W "$names" -- "$2") ;;
    SCENE | NAME) mapfile -t COMPREPLY < <(compgen -W "$names" -- "$2"; compgen -d -- "$2"; compgen -f -X '!*.toml' -- "$2") ;;
  esac
  case $1 in SCENE | NAME | FOLDER | FILE) compopt -o filenames 2>/dev/null ;; esac
}

_burrhole() {
  local cur=${COMP_WORDS[COMP_CWORD]} path='' given=0 kind commands options arguments i word
  COMPREPLY=()
  _burrhole_table ''
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    if [[ $word == '=' ]]; then
      ((++i)) # bash splits KEY=VALUE into three words
    elif [[ $word == -* ]]; then
      _burrhole_value "$path $word"
      if [[ -n $kind ]]; then
        [[ ${COMP_WORDS[i + 1]} == '=' ]] && ((++i))
        ((++i))
        if ((i >= COMP_CWORD)); then
          [[ $cur == '=' ]] && cur=''
          _burrhole_offer "$kind" "$cur"
          return
        fi
      fi
    elif [[ " $commands " == *" $word "* ]]; then
      path=${path:+$path }$word
      given=0
      _burrhole_table "$path"
    else
      ((++given))
    fi
  done
  if ((i > COMP_CWORD)) || [[ $cur == '=' ]]; then return; fi
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [[ -n $commands ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$cur")
  elif ((given < ${#arguments[@]})); then
    _burrhole_offer "${arguments[given]}" "$cur"
  elif [[ -z $cur ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  fi
}

complete -F _burrhole burrhole
)SH";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

std::string bash_completion(const CommandNode& program, const ShippedNames& shipped) {
  return "# bash completion of burrhole; printed by `burrhole completion bash`.\n# shellcheck shell=bash disable=SC2034\n\n"
         "# Sets commands, options and arguments (kinds of value) of the command $1, words joined by spaces.\n"
         "_burrhole_table() {\n  commands='' options='' arguments=()\n  case $1 in\n" +
         table_cases(program) + "  esac\n}\n\n# Sets kind: of the value that an option takes, '' for a flag; $1 is \"COMMAND OPTION\".\n" +
         "_burrhole_value() {\n  kind=''\n  case $1 in\n" + value_cases(program) + "  esac\n}\n" +
         replaced(replaced(kOffer, "@SCENES@", shell_quoted(joined(shipped.scenes))), "@TOOLS@", shell_quoted(joined(shipped.tools)));
}

}  // namespace burrhole::cli
