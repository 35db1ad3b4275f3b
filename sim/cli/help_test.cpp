#include "cli/help.hpp"

#include <gtest/gtest.h>

namespace raypool {
namespace {

/// A program with commands whose groups come in another order than that of --help.
class HelpTest : public testing::Test {
 protected:
  HelpTest() {
    app_.formatter(help_formatter());
    app_.add_subcommand("fit", "study")->group(command_group::kStudies);
    CLI::App* sim = app_.add_subcommand("sim", "draw a scene")->group(command_group::kSimulate);
    app_.add_subcommand("cosim", "compare")->group(command_group::kVerify);
    sim->add_option("--out", out_, std::string(40, 'a') + " " + std::string(60, 'b'))->type_name("FOLDER");
    sim->add_option("--scene,scene", scene_, "what is drawn")
        ->type_name("SCENE")
        ->group(option_group::kScene)
        ->capture_default_str();
    CLI::Option* engine =
        sim->add_option("--engine", engine_, "what simulates")->type_name("model|rtl")->group(option_group::kEngine);
    sim->add_option("--units", units_, "compute units")->group(option_group::kMachine)->check(CLI::Range(1, 4));
    sim->add_flag("--waves", waves_, "a waveform")->group(option_group::kScene)->needs(engine);
    auto* format = sim->add_option_group("Format (at most one)");
    format->add_flag("--json", json_, "as JSON");
  }
  std::string help_of(const std::string& words) {
    try {
      app_.parse(words);
    } catch (const CLI::CallForHelp&) {
      return app_.help();
    } catch (const CLI::ParseError& error) {
      return error.what();
    }
    return "";
  }

  CLI::App app_{"a program", "raypool"};
  std::string scene_ = "room", out_, engine_;
  int units_ = 1;
  bool waves_ = false, json_ = false;
};

TEST_F(HelpTest, CommandsStandInGroupsOfOneOrder) {
  EXPECT_EQ(help_of("--help"),
            "a program\n"
            "Usage: raypool COMMAND [OPTIONS]\n"
            "\nSimulate:\n"
            "  sim             draw a scene\n"
            "\nVerify:\n"
            "  cosim           compare\n"
            "\nStudies:\n"
            "  fit             study\n"
            "\nOptions:\n"
            "  -h,--help       Print this help message and exit\n");
}

TEST_F(HelpTest, OptionsOfACommandStandInGroupsWithTheRestLast) {
  EXPECT_EQ(help_of("sim --help"),
            "draw a scene\n"
            "Usage: raypool sim [OPTIONS] [scene]\n"
            "\nScene and view:\n"
            "  [--scene] SCENE           what is drawn (default: room)\n"
            "  --waves                   a waveform (needs --engine)\n"
            "\nEngine:\n"
            "  --engine model|rtl        what simulates\n"
            "\nMachine:\n"
            "  --units N                 compute units\n"
            "\nFormat (at most one):\n"
            "  --json                    as JSON\n"
            "\nOptions:\n"
            "  --out FOLDER              " +
                std::string(40, 'a') + "\n" + std::string(28, ' ') + std::string(60, 'b') +
                "\n  -h,--help                 Print this help message and exit\n");
}

TEST_F(HelpTest, HelpOfAllHasThatOfEachCommand) {
  help_of("--help");
  const std::string all = app_.help("", CLI::AppFormatMode::All);
  for (const char* text : {"\n  sim   ", "\nUsage: raypool sim [OPTIONS] [scene]\n", "\n  --units N", "raypool fit"})
    EXPECT_NE(all.find(text), std::string::npos) << text;
}

TEST_F(HelpTest, AnOptionSaysWhatItTakes) {
  const std::vector<OptionText> options = options_of(*commands_of(app_).front());
  const auto named = [&](const std::string& name) {
    for (const OptionText& option : options)
      if (option.names.front() == name) return option;
    return OptionText();
  };
  EXPECT_EQ(named("--engine").values, (std::vector<std::string>{"model", "rtl"}));
  EXPECT_EQ(named("--units").type, "N");
  EXPECT_EQ(named("--waves").type, "");
  EXPECT_EQ(named("--scene").default_value, "room");
  EXPECT_EQ(named("--json").group, "Format (at most one)");
}

}  // namespace
}  // namespace raypool
