#include "cli/refusal.hpp"

#include <gtest/gtest.h>

#include "cli/help.hpp"

namespace raypool {
namespace {

/// What a program with a few commands prints for these words.
std::string refusal_of(const std::string& words) {
  CLI::App app("a program", "raypool");
  app.require_subcommand(1);
  std::string scene, size, kernel, data;
  int units = 1;
  uint32_t depth = 1;
  bool verilog = false;
  CLI::App* sim = app.add_subcommand("sim", "draw")->group(command_group::kSimulate);
  sim->add_option("--scene,scene", scene);
  sim->add_option("--size", size);
  sim->add_option("--depth", depth);
  CLI::App* run = app.add_subcommand("run", "compute")->group(command_group::kSimulate);
  run->add_option("kernel", kernel, "saxpy, matmul, or an assembly file")->required();
  run->add_option("data", data, "its data")->required();
  run->add_option("--units", units)->check(CLI::IsMember({1, 2, 4}));
  run->add_option("--out,-o", kernel);
  CLI::App* isa = app.add_subcommand("isa", "print")->group(command_group::kMachine);
  isa->add_option_group("Format (at most one)")->add_flag("--verilog", verilog);
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return refusal(app, error);
  }
  return "no error";
}

TEST(Refusal, AnUnknownCommandNamesTheNearest) {
  EXPECT_EQ(refusal_of("smi"), "there is no command 'smi': did you mean sim? (raypool --help lists all)");
  EXPECT_EQ(refusal_of("smi --scene room"), "there is no command 'smi': did you mean sim? (raypool --help lists all)");
  EXPECT_EQ(refusal_of("sim"), "no error");
  EXPECT_EQ(refusal_of("paint"), "there is no command 'paint'; raypool --help lists all");
  EXPECT_EQ(refusal_of("smi run"), "there is no command 'smi': did you mean sim? (raypool --help lists all)");
}

TEST(Refusal, AnUnknownOptionNamesTheNearestOfItsCommand) {
  EXPECT_EQ(refusal_of("sim --scen room"),
            "sim has no option --scen: did you mean --scene? (raypool sim --help lists all)");
  EXPECT_EQ(refusal_of("sim --scen=room"),
            "sim has no option --scen: did you mean --scene? (raypool sim --help lists all)");
  EXPECT_EQ(refusal_of("sim cornell --sise 8x8"),
            "sim has no option --sise: did you mean --size? (raypool sim --help lists all)")
      << "the value has no place, which is no fault of its own";
  EXPECT_EQ(refusal_of("sim --scene cornell --scen room"),
            "sim has no option --scen: did you mean --scene? (raypool sim --help lists all)")
      << "the value is taken for a second scene";
  EXPECT_EQ(refusal_of("sim -size 8x8"),
            "sim has no option -size: did you mean --size? (raypool sim --help lists all)");
  EXPECT_EQ(refusal_of("run --ot x"), "run has no option --ot: did you mean --out? (raypool run --help lists all)");
  EXPECT_EQ(refusal_of("isa --verilgo"),
            "isa has no option --verilgo: did you mean --verilog? (raypool isa --help lists all)");
  EXPECT_EQ(refusal_of("run x -p"), "run has no option -p; raypool run --help lists all");
  EXPECT_EQ(refusal_of("--hlep"),
            "before the command there is no option --hlep: did you mean --help? (raypool --help lists all)");
}

TEST(Refusal, AnOptionBeforeTheCommandIsToldSo) {
  EXPECT_EQ(refusal_of("--size 8x8 sim"), "before the command there is no option --size; raypool --help lists all");
}

TEST(Refusal, WhatElseIsWrongSaysWhereToLook) {
  EXPECT_EQ(refusal_of(""), "give a command, such as sim; raypool --help lists all");
  EXPECT_EQ(refusal_of("sim room cornell"), "sim does not take 'cornell'; raypool sim --help shows what it takes");
  EXPECT_EQ(refusal_of("sim --size 8x8 --size 9x9"),
            "--size is given 2 times (8x8, 9x9): give it once (raypool sim --help shows what there is)");
  EXPECT_EQ(refusal_of("run"),
            "run needs kernel, saxpy, matmul, or an assembly file: raypool run kernel data (raypool run --help shows "
            "what there is)");
  EXPECT_EQ(refusal_of("run saxpy"),
            "run needs data, its data: raypool run kernel data (raypool run --help shows what there is)");
  EXPECT_EQ(refusal_of("run saxpy data --units 3"),
            "--units is 3: give 1, 2 or 4 (raypool run --help shows what there is)");
}

TEST(Refusal, WhatIsNoNumberIsToldSo) {
  EXPECT_EQ(refusal_of("sim --depth many"), "--depth is many: give a number (raypool sim --help shows what there is)");
  for (const char* value : {"-5", "2.5", "99999999999"})
    EXPECT_EQ(refusal_of(std::string("sim --depth=") + value),
              std::string("--depth is ") + value +
                  ": give a whole number in its range (raypool sim --help shows what there is)");
}

}  // namespace
}  // namespace raypool
