#include "cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace raypool {
namespace {

constexpr size_t kWidth = 100;   // of a line
constexpr size_t kOptions = 28;  // of the column of their names
constexpr size_t kCommands = 18;
constexpr char kPositionals[] = "Arguments";
constexpr char kOthers[] = "Options";  // CLI11's group of what is in none
constexpr std::array<const char*, 6> kCommandGroups = {command_group::kSimulate, command_group::kVerify,
                                                       command_group::kConvert,  command_group::kMachine,
                                                       command_group::kStudies,  command_group::kShell};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream rest(text);
  for (std::string word; std::getline(rest, word, '|');) words.push_back(word);
  return words;
}

/// CLI11's name without the ranges that it adds; numbers are all N.
std::string type_of(const CLI::Option& option) {
  const std::string name = option.get_type_name();
  const std::string type = name.substr(0, name.find(':'));
  return type == "INT" || type == "UINT" || type == "FLOAT" ? "N" : type;
}

OptionText describe(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  text.positional = option.get_positional() ? option.get_name(true) : "";
  text.description = option.get_description();
  text.group = option.get_group();
  for (const CLI::Option* needed : option.get_needs()) text.needs.push_back(needed->get_name());
  if (option.get_items_expected_max() > 0) {
    text.type = type_of(option);
    text.default_value = option.get_default_str();
    if (text.type.find('|') != std::string::npos) text.values = split(text.type);
  }
  return text;
}

/// "  --size WxH                 pixels, ...", wrapped.
std::string row(size_t column, const std::string& name, const std::string& description) {
  std::string line = "  " + name;
  std::string text;
  const auto end_line = [&] {
    text += line + "\n";
    line = std::string(column, ' ');
  };
  if (line.size() + 2 > column)
    end_line();
  else
    line.resize(column, ' ');
  std::istringstream words(description);
  bool first = true;
  for (std::string word; words >> word; first = false) {
    if (!first && line.size() + 1 + word.size() > kWidth) {
      end_line();
      first = true;
    }
    line += (first ? "" : " ") + word;
  }
  end_line();
  return text;
}

/// "-o,--out FILE", "[--scene] SCENE", "kernel"
std::string name_of(const OptionText& option) {
  if (option.names.empty()) return option.positional;
  std::string name = fmt::format("{}", fmt::join(option.names, ","));
  if (!option.positional.empty()) name = "[" + name + "]";
  return option.type.empty() ? name : name + " " + option.type;
}

std::string description_of(const OptionText& option) {
  std::string text = option.description;
  if (!option.needs.empty()) text += fmt::format(" (needs {})", fmt::join(option.needs, ", "));
  if (!option.default_value.empty()) text += fmt::format(" (default: {})", option.default_value);
  return text;
}

class Help : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const std::vector<const CLI::App*> commands = commands_of(*app);
    std::string text = app->get_description() + "\n" + usage(*app, name);
    for (const char* group : kCommandGroups) {
      std::string rows;
      for (const CLI::App* command : commands)
        if (command->get_group() == group) rows += row(kCommands, command->get_name(), command->get_description());
      if (!rows.empty()) text += fmt::format("\n{}:\n{}", group, rows);
    }
    text += options(*app, commands.empty() ? kOptions : kCommands);
    if (!app->get_footer().empty()) text += "\n" + app->get_footer();
    if (mode != CLI::AppFormatMode::All) return text;
    for (const CLI::App* command : commands)
      text += "\n" + make_help(command, name + " " + command->get_name(), CLI::AppFormatMode::Normal);
    return text;
  }

 private:
  static std::string usage(const CLI::App& app, const std::string& name) {
    if (!commands_of(app).empty()) return fmt::format("Usage: {} COMMAND [OPTIONS]\n", name);
    std::string text = fmt::format("Usage: {} [OPTIONS]", name);
    for (const CLI::Option* option : app.get_options([](const CLI::Option* each) { return each->get_positional(); }))
      text += fmt::format(option->get_required() ? " {}" : " [{}]", option->get_name(true));
    return text + "\n";
  }
  /// In their groups; what a command must be given comes first, what is in no group last.
  static std::string options(const CLI::App& app, size_t column) {
    std::vector<OptionText> all = options_of(app);
    // Of a command, which is asked for its own options, --help comes last.
    if (app.get_parent() != nullptr) std::rotate(all.begin(), all.begin() + 1, all.end());
    std::vector<std::string> groups;
    for (OptionText& option : all) {
      if (option.names.empty()) option.group = kPositionals;
      if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
    }
    const auto rank = [](const std::string& group) { return group == kPositionals ? 0 : group == kOthers ? 2 : 1; };
    std::stable_sort(groups.begin(), groups.end(),
                     [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
    std::string text;
    for (const std::string& group : groups) {
      text += fmt::format("\n{}:\n", group);
      for (const OptionText& option : all)
        if (option.group == group) text += row(column, name_of(option), description_of(option));
    }
    return text;
  }
};

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> commands =
      app.get_subcommands([](const CLI::App* sub) { return !sub->get_name().empty(); });
  const auto rank = [](const CLI::App* command) {
    return std::find(kCommandGroups.begin(), kCommandGroups.end(), command->get_group()) - kCommandGroups.begin();
  };
  std::stable_sort(commands.begin(), commands.end(),
                   [&](const CLI::App* a, const CLI::App* b) { return rank(a) < rank(b); });
  return commands;
}

std::vector<OptionText> options_of(const CLI::App& app) {
  std::vector<OptionText> texts;
  for (const CLI::Option* option : app.get_options([](const CLI::Option*) { return true; }))
    texts.push_back(describe(*option));
  // CLI11 has these as commands without a name, each with a --help of its own.
  for (const CLI::App* group : app.get_subcommands([](const CLI::App* sub) { return sub->get_name().empty(); })) {
    for (const CLI::Option* option : group->get_options([](const CLI::Option*) { return true; })) {
      OptionText text = describe(*option);
      text.group = group->get_group();
      if (std::none_of(texts.begin(), texts.end(), [&](const OptionText& other) { return other.names == text.names; }))
        texts.push_back(text);
    }
  }
  return texts;
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<Help>(); }

}  // namespace raypool
