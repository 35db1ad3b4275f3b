#include "cli/refusal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>
#include <vector>

#include "cli/help.hpp"
#include "isa/did_you_mean.hpp"

namespace raypool {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  return names;
}

/// With their dashes; the letters behind them are compared. A longer name is not meant to be one letter.
std::vector<std::string> nearest_options(const std::string& given, const CLI::App& app) {
  const auto letters = [](const std::string& name) {
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
  };
  std::vector<std::string> names, all;
  for (const OptionText& option : options_of(app))
    for (const std::string& name : option.names)
      if (letters(name).size() > 1 || letters(given).size() == 1) all.push_back(name);
  for (const std::string& name : all) names.push_back(letters(name));
  std::vector<std::string> nearest = nearest_names(letters(given), names);
  for (std::string& name : nearest) name = all[std::find(names.begin(), names.end(), name) - names.begin()];
  return nearest;
}

/// What no command takes, with the nearest that one does; empty if all is taken.
std::string not_taken(const CLI::App& app) {
  const bool in_command = app.remaining().empty() && !app.get_subcommands().empty();
  const CLI::App& taker = in_command ? *app.get_subcommands().front() : app;
  const std::string name = taker.get_name();
  const std::string call = in_command ? app.get_name() + " " + name : name;
  const std::vector<std::string> words = taker.remaining();
  if (words.empty()) return "";
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  if (!in_command && !is_option(words[0])) {
    return fmt::format("there is no command '{}'{}", words[0],
                       did_you_mean(words[0], command_names(app), call + " --help lists all"));
  }
  // A word behind an unknown option is its value.
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  if (option == words.end())
    return fmt::format("{} does not take '{}'; {} --help shows what it takes", name, words[0], call);
  const std::string given = option->substr(0, option->find('='));
  return fmt::format("{} {}{}", in_command ? name + " has no option" : "before the command there is no option", given,
                     did_you_mean(nearest_options(given, taker), call + " --help lists all"));
}

/// "--size is given 2 times (8x8, 16x16): give it once", of an option that takes one
/// value; empty if there is none such.
std::string given_twice(const CLI::App& app) {
  for (const CLI::App* sub : app.get_subcommands()) {
    for (const CLI::Option* option : sub->get_options()) {
      const std::vector<std::string>& values = option->results();
      if (option->get_expected_max() != 1 || values.size() < 2) continue;
      return fmt::format("{} is given {} times ({}): give it once", option->get_name(), values.size(),
                         fmt::join(values, ", "));
    }
  }
  return "";
}

/// "compare needs b, report.json of the other run: raypool compare a b", of the first word that is missing; empty if
/// none is.
std::string missing_word(const CLI::App& app) {
  if (app.get_subcommands().empty()) return "";
  const CLI::App& command = *app.get_subcommands().front();
  const auto words = command.get_options([](const CLI::Option* option) { return option->get_positional(); });
  std::string call = app.get_name() + " " + command.get_name();
  for (const CLI::Option* word : words)
    if (word->get_required()) call += " " + word->get_name(true);
  for (const CLI::Option* word : words) {
    if (!word->get_required() || word->count() > 0) continue;
    return fmt::format("{} needs {}, {}: {}", command.get_name(), word->get_name(true), word->get_description(), call);
  }
  return "";
}

/// "--units is 3: give 1, 2 or 4", from CLI11's message about a value that is not a choice; empty otherwise.
std::string not_among(const std::string& text) {
  static const std::regex kNotIn(R"((-\S+|\w+): (.*) not in \{(.*)\})");
  std::smatch match;
  if (!std::regex_match(text, match, kNotIn)) return "";
  std::string choices = std::regex_replace(match[3].str(), std::regex(","), ", ");
  if (const size_t last = choices.rfind(", "); last != std::string::npos) choices.replace(last, 2, " or ");
  return fmt::format("{} is {}: give {}", match[1].str(), match[2].str(), choices);
}

/// "--programs is many: give a number", from CLI11's message about a value that it cannot convert; empty otherwise.
std::string not_converted(const std::string& text) {
  static const std::regex kNot(R"(Could not convert: (-\S+|\w+) = (.*))"), kNumber(R"([+-]?\d+(\.\d*)?)");
  std::smatch match;
  if (!std::regex_match(text, match, kNot)) return "";
  const bool number = std::regex_match(match[2].first, match[2].second, kNumber);
  return fmt::format("{} is {}: give a {}", match[1].str(), match[2].str(),
                     number ? "whole number in its range" : "number");
}

}  // namespace

std::string refusal(const CLI::App& app, const CLI::ParseError& error) {
  std::string unknown = not_taken(app);
  if (!unknown.empty()) return unknown;
  const std::string twice = given_twice(app);
  const auto commands = app.get_subcommands();
  if (twice.empty() && commands.empty())
    return fmt::format("give a command, such as sim; {} --help lists all", app.get_name());
  std::string text = twice;
  if (text.empty() && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) text = missing_word(app);
  if (text.empty()) text = not_among(error.what());
  if (text.empty()) text = not_converted(error.what());
  if (text.empty()) text = error.what();
  return fmt::format("{} ({}{} --help shows what there is)", text, app.get_name(),
                     commands.empty() ? "" : " " + commands.front()->get_name());
}

}  // namespace raypool
