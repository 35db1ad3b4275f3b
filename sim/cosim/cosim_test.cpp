// What random programs, their files, their minimising and the covering sets promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <set>
#include <string>

#include "cosim/coverage.hpp"
#include "cosim/covering.hpp"
#include "cosim/minimise.hpp"
#include "cosim/program_check.hpp"
#include "cosim/program_file.hpp"
#include "cosim/program_profile.hpp"
#include "isa/encoding.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;

Configuration configuration_of(int warps, int lanes, int stack_depth = 8) {
  Configuration configuration;
  configuration.warps = warps;
  configuration.lanes = lanes;
  configuration.stack_depth = stack_depth;
  return configuration;
}

/// A program of one kernel with `code`, without random parts.
RandomProgram program_of(const std::vector<uint64_t>& code, uint32_t threads = 1) {
  RandomProgram program;
  program.program.code = code;
  program.program.entries["main"] = 0;
  program.data_begin = 1024;
  program.memory_bytes = 4096;
  program.kernels.push_back({threads, 0, ImportKind::None});
  fill_memory(program);
  return program;
}

bool contains(const RandomProgram& program, Opcode opcode) {
  return std::any_of(program.program.code.begin(), program.program.code.end(),
                     [&](uint64_t word) { return unpack(word).info == &instruction(opcode); });
}

TEST(RandomPrograms, KeepTheirPromisesForEveryConfiguration) {
  for (const Configuration& configuration :
       {configuration_of(1, 1, 2), configuration_of(4, 4), configuration_of(32, 2, 32), configuration_of(2, 32, 3)}) {
    for (const int units : {1, 4}) {
      for (uint64_t seed = 1; seed <= 80; ++seed) {
        const RandomProgram program = make_random_program(configuration, seed, 120, units);
        EXPECT_EQ(check_program(configuration, program), "")
            << configuration.warps << "w, seed " << seed << ", " << units << " units";
      }
    }
  }
}

// Registers, predicates, arguments and PCs that a fit leaves, and the fewest that there may be.
TEST(RandomPrograms, KeepTheirPromisesOnMachinesWithLess) {
  struct Less {
    uint32_t registers, predicates, arguments, pc_bits;
    bool triples;
  };
  for (const Less& less : {Less{9, 2, 23, 9, false}, Less{8, 2, 4, 8, true}, Less{10, 3, 11, 10, true},
                           Less{12, 4, 32, 16, true}, Less{16, 5, 5, 12, false}}) {
    Configuration configuration = configuration_of(4, 4, 3);
    configuration.registers = less.registers;
    configuration.predicates = less.predicates;
    configuration.arguments = less.arguments;
    configuration.pc_bits = less.pc_bits;
    configuration.triples = configuration.fma = less.triples;
    std::set<FaultCode> beyond;
    bool loops = false, triples = false, far = false;
    for (uint64_t seed = 1; seed <= 250; ++seed) {
      const RandomProgram program = make_random_program(configuration, seed);
      EXPECT_EQ(check_program(configuration, program), "") << less.registers << " registers, seed " << seed;
      EXPECT_LT(told_length(program), 1u << less.pc_bits);
      loops = loops || contains(program, Opcode::Loop);
      triples = triples || contains(program, Opcode::Fmul3);
      for (const uint64_t encoding : program.program.code) {
        const Instruction one = unpack(encoding);
        far = far || (one.info == &instruction(Opcode::Jany) && (one.immediate & 0xffff) >> less.pc_bits != 0);
      }
    }
    EXPECT_TRUE(loops) << less.registers;
    EXPECT_TRUE(triples || !less.triples) << less.registers;
    EXPECT_EQ(far, less.pc_bits < 16) << "no jump beyond what a PC can be";
  }
}

TEST(RandomPrograms, AreTheSameForTheSameSeedAndHaveEveryProfileAndFault) {
  std::set<std::string> profiles;
  uint32_t faults = 0;
  int rewrites = 0;
  int restarts = 0, longer = 0, more_memory = 0;
  for (uint64_t seed = 1; seed <= 600; ++seed) {
    const RandomProgram a = make_random_program(configuration_of(2, 2), seed),
                        b = make_random_program(configuration_of(2, 2), seed);
    EXPECT_EQ(a.program.code, b.program.code);
    EXPECT_EQ(a.arguments, b.arguments);
    profiles.insert(a.profile);
    faults |= a.profile == kFaultMix ? 0 : a.faults;
    for (const RandomProgram::Kernel& kernel : a.kernels) rewrites += kernel.rewrite ? 1 : 0;
    restarts += a.restart != 0 ? 1 : 0;
    longer += told_length(a) > a.program.code.size() ? 1 : 0;
    more_memory += told_limit(a) > a.memory_bytes ? 1 : 0;
  }
  EXPECT_EQ(profiles.size(), std::size(kProgramProfiles));
  EXPECT_EQ(faults, 0xfeu);
  EXPECT_GT(rewrites, 100);
  EXPECT_GT(restarts, 20);
  EXPECT_GT(longer, 20);
  EXPECT_GT(more_memory, 20);
}

TEST(RandomPrograms, OfTheOperandMixMeetThousandsOfPairsThatAllTypesComputeWith) {
  const Configuration configuration = configuration_of(2, 2);
  // Several, as what a single one does changes with the table of instructions.
  uint64_t executed = 0, near = 0, pairs = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const RandomProgram program = make_random_program(configuration, seed, 1000, 1, "operands");
    EXPECT_EQ(program.profile, "operands");
    uint64_t steps = 0;
    EXPECT_EQ(check_program(configuration, program, 1'000'000, &steps), "");
    executed += steps;
    // The words of a pair are related: among any other words exponents are seldom so near.
    for (uint32_t a = program.data_begin; a + 8 <= program.memory_bytes; a += 8, ++pairs) {
      const auto first = static_cast<int>(program.memory.load(a) >> 23 & 255),
                 second = static_cast<int>(program.memory.load(a + 4) >> 23 & 255);
      near += std::abs(first - second) <= 2 ? 1 : 0;
    }
  }
  EXPECT_GT(executed, 10000u);
  EXPECT_GT(pairs, 1000u);
  EXPECT_GT(near * 6, pairs);
  EXPECT_THROW(make_random_program(configuration, 1, 120, 1, "none of these"), InputError);
}

/// Sees what programs do on the functional unit.
class Seen : public RunObserver {
 public:
  void cycle(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) override {
    static_cast<void>(outputs);
    static_cast<void>(inputs);
    for (const StoreEvent& store : trace.stores) stored |= store.address, not_stored |= ~store.address;
    for (const RetireEvent& event : trace.retired) {
      const Instruction instruction = unpack(event.instruction);
      if (instruction.info == nullptr || instruction.info->opcode != Opcode::Ld) continue;
      // r13 has the lane's address but for the offset; that of far lines has all its upper bits in the offset.
      loaded |= instruction.immediate, not_loaded |= ~instruction.immediate;
    }
  }
  uint32_t loaded = 0, not_loaded = 0, stored = 0, not_stored = 0;
};

TEST(RandomPrograms, ReachAddressesWithAnyBitSet) {
  const Configuration configuration = configuration_of(2, 2);
  Seen seen;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const RandomProgram program = make_random_program(configuration, seed);
    if (told_limit(program) < 0xfff00000u || program.faults != 0) continue;
    Memory memory = program.memory;
    const auto unit = make_functional_unit(configuration, memory);
    unit->trace_on();
    run_random_program(*unit, memory, program, seed, 5'000'000, &seen);
  }
  EXPECT_EQ(seen.stored >> 4, 0xffffffffu >> 4);
  EXPECT_EQ(seen.not_stored >> 4, 0xffffffffu >> 4);
  EXPECT_EQ(seen.loaded >> 17, 0xffffffffu >> 17);
  EXPECT_EQ(seen.not_loaded >> 17, 0xffffffffu >> 17);
}

TEST(RandomPrograms, HaveMemoryAtFarAddressesThatIsKept) {
  const RandomProgram program = make_random_program(configuration_of(2, 2), 1);
  Memory memory = program.memory;
  const uint32_t address = 0x12345640;
  for (int bit = 22; bit < 32; ++bit) EXPECT_NE(memory.load(address), memory.load(address ^ 1u << bit)) << bit;
  memory.store(address, 99);
  EXPECT_EQ(memory.load(address), 99u);
  EXPECT_NE(memory.load(address ^ 0x80000000u), 99u);
}

TEST(RandomPrograms, OfTheFaultMixEndEveryKernelInAFault) {
  const Configuration configuration = configuration_of(4, 2);
  const RandomProgram program = make_random_program(configuration, 3, 120, 1, "faults");
  EXPECT_EQ(check_program(configuration, program), "");
  EXPECT_GT(program.kernels.size(), 10u);
  for (const RandomProgram::Kernel& kernel : program.kernels) {
    RandomProgram one = program;
    one.kernels = {kernel};
    one.kernels.front().rewrite.reset();
    one.faults = fault_bit(FaultCode::None);
    EXPECT_NE(check_program(configuration, one).find("ends in fault"), std::string::npos)
        << "entry PC " << kernel.pc << ": " << check_program(configuration, one);
  }
}

TEST(ProgramCheck, NamesWhatBreaksTheRules) {
  const Configuration two = configuration_of(2, 1);
  const auto problem = [&](const std::vector<uint64_t>& code, uint32_t threads = 1) {
    return check_program(two, program_of(code, threads), 10000);
  };
  EXPECT_EQ(problem(assembled("mov r1, 1; exit")), "");
  EXPECT_NE(problem(assembled("iadd r1, r2, 1; exit")).find("r2 is read"), std::string::npos);
  EXPECT_NE(problem(assembled("jany 0; exit")).find("does not end"), std::string::npos);
  EXPECT_NE(problem(assembled("rld r1, 3; exit")).find("word 3"), std::string::npos);
  EXPECT_NE(problem(assembled("ret; exit")).find("fault 4"), std::string::npos);
  EXPECT_NE(problem(assembled("rin; exit")).find("never come"), std::string::npos);
  EXPECT_NE(problem(assembled("mov r1, 0; st [r1], r1; exit")).find("its code"), std::string::npos);
  RandomProgram far = program_of(assembled("mov r1, 0x1000000; ld r2, [r1]; exit"));
  EXPECT_NE(check_program(two, far).find("fault"), std::string::npos);
  far.memory_limit = 1u << 25;
  EXPECT_EQ(check_program(two, far), "");
  far.program.code[1] = assembled("st [r1], r1")[0];
  far.kernels.front().threads = 2;
  fill_memory(far);
  EXPECT_NE(check_program(two, far).find("race at address 16777216"), std::string::npos);
  const std::vector<uint64_t> race = assembled("mov r1, 2048; st [r1], r1; exit");
  EXPECT_EQ(problem(race), "");
  EXPECT_NE(problem(race, 2).find("race at address 2048"), std::string::npos);
}

TEST(ProgramCheck, RunsWhatIsRewritten) {
  RandomProgram program = program_of(assembled("mov r1, 1; mov r2, 1; exit"));
  program.kernels.push_back(program.kernels.front());
  Rewrite rewrite;
  rewrite.code[1] = assembled("iadd r2, r3, 1")[0];
  program.kernels[1].rewrite = rewrite;
  EXPECT_NE(check_program(configuration_of(1, 1), program).find("no argument is"), std::string::npos);
  program.kernels[1].rewrite->arguments[7] = 1;
  EXPECT_NE(check_program(configuration_of(1, 1), program).find("r3 is read"), std::string::npos);
  program.kernels[1].rewrite->code[1] = assembled("iadd r2, r1, 1")[0];
  EXPECT_EQ(check_program(configuration_of(1, 1), program), "");
  program.kernels[1].rewrite->arguments[32] = 1;
  EXPECT_NE(check_program(configuration_of(1, 1), program).find("argument 32"), std::string::npos);
  program.kernels[1].rewrite->arguments.erase(32);
  program.kernels[1].rewrite->code[3] = 0;
  EXPECT_NE(check_program(configuration_of(1, 1), program).find("PC 3 is rewritten"), std::string::npos);
}

TEST(ProgramCheck, KernelsOfSeveralUnitsMayNotShareStoredWords) {
  RandomProgram program = program_of(assembled("mov r1, 2048; st [r1], r1; exit"));
  program.kernels.push_back(program.kernels.front());
  EXPECT_EQ(check_program(configuration_of(1, 1), program), "");
  program.units = 2;
  EXPECT_NE(check_program(configuration_of(1, 1), program).find("race"), std::string::npos);
}

TEST(SavedPrograms, AreReadAsTheyWereWritten) {
  const Configuration configuration = configuration_of(2, 2);
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    SavedProgram saved;
    saved.configuration = configuration;
    saved.program = make_random_program(configuration, seed, 40);
    saved.note = "a note";
    const SavedProgram read = parse_saved_program(to_json(saved), "text");
    const RandomProgram &a = saved.program, &b = read.program;
    EXPECT_EQ(read.note, saved.note);
    EXPECT_EQ(to_json(read.configuration), to_json(saved.configuration));
    EXPECT_EQ(a.program.code, b.program.code);
    EXPECT_EQ(a.arguments, b.arguments);
    EXPECT_EQ(a.stalls.styles, b.stalls.styles);
    EXPECT_EQ(a.seed, b.seed);
    EXPECT_EQ(a.faults, b.faults);
    EXPECT_EQ(a.program_length, b.program_length);
    EXPECT_EQ(a.memory_limit, b.memory_limit);
    EXPECT_EQ(a.restart, b.restart);
    ASSERT_EQ(a.kernels.size(), b.kernels.size());
    for (size_t k = 0; k < a.kernels.size(); ++k) {
      EXPECT_EQ(a.kernels[k].threads, b.kernels[k].threads);
      EXPECT_EQ(a.kernels[k].block, b.kernels[k].block);
      EXPECT_EQ(a.kernels[k].blocks, b.kernels[k].blocks);
      EXPECT_EQ(a.kernels[k].import, b.kernels[k].import);
      EXPECT_EQ(a.kernels[k].pc, b.kernels[k].pc);
      ASSERT_EQ(a.kernels[k].rewrite.has_value(), b.kernels[k].rewrite.has_value());
      if (!a.kernels[k].rewrite) continue;
      EXPECT_EQ(a.kernels[k].rewrite->code, b.kernels[k].rewrite->code);
      EXPECT_EQ(a.kernels[k].rewrite->data_seed, b.kernels[k].rewrite->data_seed);
      EXPECT_EQ(a.kernels[k].rewrite->arguments, b.kernels[k].rewrite->arguments);
    }
    ASSERT_EQ(a.memory.size(), b.memory.size());
    for (uint32_t address = 0; address < a.memory.size(); address += 4)
      ASSERT_EQ(a.memory.load(address), b.memory.load(address));
  }
  EXPECT_THROW(parse_saved_program("{}", "text"), InputError);
  EXPECT_THROW(load_saved_program("no/such/file.json"), InputError);
}

TEST(Minimising, MovesTargetsWithTheirInstructions) {
  const RandomProgram program = program_of(assembled(R"(
          mov r1, 1
          jany 3
          mov r2, 2
          call 5, 7
          exit
          mov r3, 3
          ret)"));
  const RandomProgram shorter = without_instructions(program, 2, 1);
  ASSERT_EQ(shorter.program.code.size(), 6u);
  EXPECT_EQ(unpack(shorter.program.code[1]).immediate, 2u);
  EXPECT_EQ(unpack(shorter.program.code[2]).immediate, 4u | 6u << 16);
  EXPECT_EQ(check_program(configuration_of(1, 1), shorter), "");
}

TEST(Minimising, MovesWhatIsRewritten) {
  RandomProgram program = program_of(assembled("mov r1, 1; mov r2, 1; jany 3; exit"));
  Rewrite rewrite;
  rewrite.code[1] = assembled("mov r2, 5")[0];
  rewrite.code[2] = assembled("jnone 3")[0];
  rewrite.arguments[3] = 1;
  program.kernels.front().rewrite = rewrite;
  const RandomProgram shorter = without_instructions(program, 0, 1);
  const std::map<uint32_t, uint64_t> moved = {{0, rewrite.code[1]}, {1, assembled("jnone 2")[0]}};
  EXPECT_EQ(shorter.kernels.front().rewrite->code, moved);
  EXPECT_EQ(without_instructions(program, 1, 1).kernels.front().rewrite->code.size(), 1u);
}

TEST(Minimising, LeavesTheCulpritAndAValidProgram) {
  const Configuration configuration = configuration_of(4, 4);
  int minimised = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const RandomProgram program = make_random_program(configuration, seed);
    if (program.faults != 0 || !contains(program, Opcode::Fdiv)) continue;
    ++minimised;
    const RandomProgram shorter = minimise_program(
        configuration, program, [](const RandomProgram& each) { return contains(each, Opcode::Fdiv); });
    EXPECT_TRUE(contains(shorter, Opcode::Fdiv));
    EXPECT_EQ(check_program(configuration, shorter), "");
    EXPECT_LE(shorter.program.code.size(), 8u) << "seed " << seed;
    EXPECT_EQ(shorter.kernels.size(), 1u);
    for (const StallStyle style : shorter.stalls.styles) EXPECT_EQ(style, StallStyle::None);
  }
  EXPECT_GT(minimised, 3);
}

TEST(Stalls, OpenAndShutByTheirStyle) {
  for (int style = 0; style < kStallStyles; ++style) {
    for (int port = 0; port < kPorts; ++port) {
      StallPlan plan;
      plan.styles.fill(static_cast<StallStyle>(style));
      const Stalls stalls(plan, 7);
      int open = 0;
      for (uint64_t cycle = 0; cycle < 10000; ++cycle) {
        open += stalls.open(static_cast<Port>(port), cycle) ? 1 : 0;
        EXPECT_GE(stalls.latency(cycle), 1u);
      }
      if (plan.styles[0] == StallStyle::None) {
        EXPECT_EQ(open, 10000);
      } else {
        EXPECT_GT(open, 500);
        EXPECT_LT(open, 9500);
      }
    }
  }
}

TEST(Covering, AFewMachinesHaveEveryValue) {
  const std::vector<Machine> machines = covering_machines(kSmallThreads, 12);
  for (size_t i = 0; i < 12; ++i) EXPECT_LE(machines[i].configuration.contents() * machines[i].units, kSmallThreads);
  const Covered covered = count_covered(covering_factors(), machines, kSmallThreads);
  EXPECT_EQ(covered.values, covered.all_values);
}

TEST(Covering, SetsHaveEveryPairThatMachinesOfTheirSizeCanHave) {
  for (const int most_threads : {kSmallThreads, kMostThreads}) {
    const std::vector<Machine> machines = covering_machines(most_threads);
    const Covered covered = count_covered(covering_factors(), machines, most_threads);
    EXPECT_EQ(covered.values, covered.all_values);
    EXPECT_EQ(covered.pairs, covered.all_pairs);
  }
}

TEST(Covering, ChipsHaveEveryPairThatSmallOnesCanHave) {
  const auto expect_all = [](const std::vector<Factor>& factors, const std::vector<Machine>& machines) {
    const Covered covered = count_covered(factors, machines, kSmallThreads);
    EXPECT_EQ(covered.values, covered.all_values);
    EXPECT_EQ(covered.pairs, covered.all_pairs);
    EXPECT_LT(machines.size(), 30u);
  };
  expect_all(chip_factors(), covering_chips());
  expect_all(inside_factors(), covering_inside());
  for (const Machine& machine : covering_inside()) EXPECT_TRUE(has_traverser(machine.configuration.chip));
}

TEST(CoverageOfNothing, ListsEverythingAsNotCovered) {
  const Coverage coverage(configuration_of(2, 2));
  size_t items = 0;
  for (const Coverage::Group& group : coverage.groups()) {
    EXPECT_EQ(group.covered(), 0u) << group.name;
    items += group.items.size();
  }
  EXPECT_GT(items, 300u);
  EXPECT_NE(to_string(coverage).find("NOT covered: tid, lane"), std::string::npos);
}

uint64_t count(const Coverage& coverage, const std::string& name) {
  for (const Coverage::Group& group : coverage.groups())
    for (const Coverage::Item& item : group.items)
      if (item.name == name) return item.count;
  throw InputError("there is no item '" + name + "'");
}

/// What rewritten programs cover, each after `change`.
template <typename Change>
Coverage rewriting_after(Change change) {
  const Configuration configuration = configuration_of(2, 2);
  Coverage coverage(configuration);
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    RandomProgram program = make_random_program(configuration, seed, 120, 1, "launches");
    bool rewritten = false;
    for (RandomProgram::Kernel& kernel : program.kernels) {
      if (!kernel.rewrite) continue;
      rewritten = true;
      change(program, kernel.rewrite);
    }
    if (!rewritten) continue;
    Memory memory = program.memory;
    const auto unit = make_functional_unit(configuration, memory);
    unit->trace_on();
    coverage.begin();
    run_random_program(*unit, memory, program, seed, 5'000'000, &coverage);
  }
  return coverage;
}

TEST(CoverageOfRewriting, IsMissingWithoutWhatTheHostRewrites) {
  const std::string argument = "an argument is read that was another one before";
  const std::string code = "an instruction retires that was another one before";
  const std::string data = "a word is loaded that was another one before";
  const auto all = [&](const Coverage& coverage) {
    return std::array<bool, 3>{count(coverage, argument) > 0, count(coverage, code) > 0, count(coverage, data) > 0};
  };
  using Covered = std::array<bool, 3>;
  using Rewritten = std::optional<Rewrite>;
  EXPECT_EQ(all(rewriting_after([](const RandomProgram&, Rewritten&) {})), (Covered{true, true, true}));
  EXPECT_EQ(all(rewriting_after([](const RandomProgram&, Rewritten& rewrite) { rewrite.reset(); })),
            (Covered{false, false, false}));
  EXPECT_EQ(all(rewriting_after([](const RandomProgram& program, Rewritten& rewrite) {
              for (auto& [number, value] : rewrite->arguments) value = program.arguments[number];
            })),
            (Covered{false, true, true}));
  EXPECT_EQ(all(rewriting_after([](const RandomProgram&, Rewritten& rewrite) { rewrite->code.clear(); })),
            (Covered{true, false, true}));
  EXPECT_EQ(all(rewriting_after([](const RandomProgram&, Rewritten& rewrite) { rewrite->data_seed = 0; })),
            (Covered{true, true, false}));
}

TEST(CoverageOfPcs, TakesATwinOutsideForOneOnlyIfTheOtherBitsLieInside) {
  Coverage coverage(configuration_of(2, 2));
  coverage.begin();
  UnitTrace trace;
  RetireEvent event;
  event.pc = 7;
  event.instruction = assembled("exit")[0];
  event.mask = 1;
  trace.retired = {event};
  coverage.cycle(UnitOutputs{}, UnitInputs{}, trace);
  const std::string name = "a PC outside that lies inside but for the upper bit";
  for (const uint32_t pc : {0xffffu, 0x8008u, 8u}) coverage.faulted({{FaultCode::PcOutsideProgram, 0, pc}});
  coverage.faulted({{FaultCode::IllegalInstruction, 0, 0x8007}});
  EXPECT_EQ(count(coverage, name), 0u);
  coverage.faulted({{FaultCode::PcOutsideProgram, 0, 0x8007}});
  EXPECT_EQ(count(coverage, name), 1u);
}

TEST(RandomHost, RunsEveryProgramOnTheFunctionalUnit) {
  const Configuration configuration = configuration_of(4, 4);
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomProgram program = make_random_program(configuration, seed);
    Memory memory = program.memory;
    EXPECT_NO_THROW(run_random_program(*make_functional_unit(configuration, memory), memory, program, seed))
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace raypool
