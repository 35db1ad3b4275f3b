// How the commands and their options describe themselves: --help, in groups; what completion and man page are made of.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace raypool {

/// Groups of commands.
namespace command_group {
inline constexpr char kSimulate[] = "Simulate";
inline constexpr char kVerify[] = "Verify";
inline constexpr char kConvert[] = "Look at and convert";
inline constexpr char kMachine[] = "Machine and synthesis";
inline constexpr char kStudies[] = "Studies";
inline constexpr char kShell[] = "Shell";
}  // namespace command_group

/// Groups of options. What is in none of them stands under "Options".
namespace option_group {
inline constexpr char kScene[] = "Scene and view";
inline constexpr char kMachine[] = "Machine";
inline constexpr char kEngine[] = "Engine";
inline constexpr char kSampling[] = "Sampling";
inline constexpr char kOutput[] = "Output";
}  // namespace option_group

/// The commands of `app` in the order of their groups.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

struct OptionText {
  std::vector<std::string> names;  ///< with their dashes; none: a positional
  std::string positional;          ///< its name; empty: none
  std::string description;
  std::string type;                 ///< FILE, N, model|rtl, ...; empty: a flag
  std::vector<std::string> values;  ///< when these are all there are
  std::string default_value;
  std::vector<std::string> needs;  ///< options without which this one is refused
  std::string group;
};

/// Those of a command, with those of which at most one may be given.
std::vector<OptionText> options_of(const CLI::App& app);

/// Set it before commands are added: they inherit it.
std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace raypool
