#include "tools/command_description.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <string_view>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/help.hpp"
#include "cli/version.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

std::string replaced(std::string_view text, std::string_view characters, std::string_view before) {
  std::string result;
  for (const char c : text) {
    if (characters.find(c) != std::string_view::npos) result += before;
    result += c;
  }
  return result;
}

/// Text within single quotes of a shell.
std::string shell_quoted(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "'" + result + "'";
}

/// What may stand in a command's place for a word: its options, and the words of a positional that has a set of them.
std::string bash_words(const CLI::App& app) {
  std::vector<std::string> words;
  for (const OptionText& option : options_of(app)) {
    words.insert(words.end(), option.names.begin(), option.names.end());
    if (option.names.empty()) words.insert(words.end(), option.values.begin(), option.values.end());
  }
  return fmt::format("{}", fmt::join(words, " "));
}

std::string bash(const CLI::App& app) {
  std::vector<std::string> names;
  std::string words, values;
  for (const CLI::App* command : commands_of(app)) {
    names.push_back(command->get_name());
    words += fmt::format("    {}) words='{}' ;;\n", command->get_name(), bash_words(*command));
    for (const OptionText& option : options_of(*command)) {
      if (option.values.empty()) continue;
      for (const std::string& name : option.names)
        values += fmt::format("    {},{}) values='{}' ;;\n", command->get_name(), name, fmt::join(option.values, " "));
    }
  }
  return fmt::format(R"(# bash completion of raypool, made by `raypool completion bash`
_raypool() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command='' words='' values='' i
  for ((i = 1; i < COMP_CWORD; i++)); do
    [[ ${{COMP_WORDS[i]}} == -* ]] || {{ command=${{COMP_WORDS[i]}}; break; }}
  done
  case $command in
    '') words='{} {}' ;;
{}  esac
  case $command,$previous in
{}  esac
  if [[ -n $values ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word"; [[ -z $command || $word == -* ]] || compgen -f -- "$word")
  fi
}}
complete -o filenames -F _raypool raypool
)",
                     fmt::join(names, " "), bash_words(app), words, values);
}

std::string zsh_option(const OptionText& option) {
  const std::string description = replaced(option.description, "[]:\\", "\\");
  const std::string action = option.values.empty() ? "_files" : fmt::format("({})", fmt::join(option.values, " "));
  if (option.names.empty()) return shell_quoted(fmt::format("1:{}:{}", description, action));
  std::vector<std::string> words;
  for (const std::string& name : option.names) {
    words.push_back(shell_quoted(option.type.empty() ? fmt::format("{}[{}]", name, description)
                                                     : fmt::format("*{}[{}]:value:{}", name, description, action)));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

std::string zsh_arguments(const CLI::App& app) {
  std::string text = "_arguments";
  for (const OptionText& option : options_of(app)) text += " \\\n        " + zsh_option(option);
  return text;
}

std::string zsh(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands +=
        "    " + shell_quoted(command->get_name() + ":" + replaced(command->get_description(), ":\\", "\\")) + "\n";
    cases += fmt::format("    {})\n      {} ;;\n", command->get_name(), zsh_arguments(*command));
  }
  return fmt::format(R"(#compdef raypool
# zsh completion of raypool, made by `raypool completion zsh`
_raypool() {{
  local -a commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    {}
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{}  esac
}}
_raypool "$@"
)",
                     commands, zsh_arguments(app), cases);
}

std::string fish_options(const CLI::App& app, const std::string& condition) {
  std::string text;
  for (const OptionText& option : options_of(app)) {
    std::string line = fmt::format("complete -c raypool -n {}", shell_quoted(condition));
    for (const std::string& name : option.names)
      line += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.names.empty() && !option.type.empty()) line += " -r";
    if (!option.values.empty()) line += fmt::format(" -f -a '{}'", fmt::join(option.values, " "));
    if (option.names.empty() && option.values.empty()) continue;
    text += line + " -d " + shell_quoted(option.description) + "\n";
  }
  return text;
}

std::string fish(const CLI::App& app) {
  std::string text = "# fish completion of raypool, made by `raypool completion fish`\n";
  text += fish_options(app, "__fish_use_subcommand");
  for (const CLI::App* command : commands_of(app)) {
    text += fmt::format("complete -c raypool -n __fish_use_subcommand -f -a {} -d {}\n", command->get_name(),
                        shell_quoted(command->get_description()));
    text += fish_options(*command, "__fish_seen_subcommand_from " + command->get_name());
  }
  return text;
}

std::string roff(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
  return !result.empty() && (result[0] == '.' || result[0] == '\'') ? "\\&" + result : result;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string roff_options(const CLI::App& app) {
  std::string text;
  for (const OptionText& option : options_of(app)) {
    std::vector<std::string> names;
    for (const std::string& name : option.names) names.push_back("\\fB" + roff(name) + "\\fR");
    if (!option.positional.empty()) names.push_back("\\fI" + roff(option.positional) + "\\fR");
    text += fmt::format(".TP\n{}{}\n{}", fmt::join(names, ", "),
                        option.names.empty() || option.type.empty() ? "" : " \\fI" + roff(option.type) + "\\fR",
                        roff(option.description));
    text += option.default_value.empty() ? "\n" : fmt::format(" (default: {})\n", roff(option.default_value));
  }
  return text;
}

}  // namespace

std::string completion(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash(app);
  if (shell == "zsh") return zsh(app);
  if (shell == "fish") return fish(app);
  throw InputError(fmt::format("there is no completion for shell '{}'{}", shell,
                               did_you_mean(shell, {"bash", "zsh", "fish"}, "use bash, zsh or fish")));
}

std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(".TH RAYPOOL 1 \"\" \"raypool {}\"\n.SH NAME\n{}\n", kVersion,
                                 roff("raypool - a ray-tracing GPU to render on, measure, verify and synthesise"));
  text += ".SH SYNOPSIS\n.B raypool\n.I COMMAND\n.RI [ OPTIONS ]\n.SH OPTIONS\n" + roff_options(app);
  std::string group;
  for (const CLI::App* command : commands_of(app)) {
    if (command->get_group() != group) text += ".SH " + upper(command->get_group()) + "\n";
    group = command->get_group();
    text +=
        fmt::format(".SS {}\n{}\n{}", command->get_name(), roff(command->get_description()), roff_options(*command));
  }
  text += ".SH EXIT STATUS\n";
  for (const ExitCode& row : kExitCodes) text += fmt::format(".TP\n{}\n{}\n", row.code, roff(row.meaning));
  text += ".SH ENVIRONMENT\n.TP\nRAYPOOL_CONFIGS\na folder of configurations, looked up before all others\n";
  text += ".TP\nXDG_CACHE_HOME\nwhere an installed program keeps Verilated units, in raypool/; default ~/.cache\n";
  return text;
}

}  // namespace raypool
