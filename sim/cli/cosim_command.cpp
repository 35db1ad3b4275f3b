// `raypool cosim`: random programs on the Verilated unit in lockstep with the golden model.
#include <fmt/format.h>

#include <chrono>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "cosim/cosim.hpp"
#include "lockstep/lockstep_unit.hpp"

namespace raypool {

int cosim_command(const CosimOptions& options) {
  EngineOptions engine;
  engine.engine = parse_engine(options.engine);
  engine.configuration = load_configuration(options.config);
  engine.unit_library = options.unit_library;
  LockstepCounts total;
  uint64_t cycles = 0;
  auto shown = std::chrono::steady_clock::now();
  for (uint64_t n = 0; n < options.programs; ++n) {
    const uint64_t seed = options.seed + n;
    const RandomProgram program = make_random_program(engine.configuration, seed, options.length);
    Memory memory = program.memory;
    const std::unique_ptr<ComputeUnit> unit = make_unit(engine, memory, fmt::format("seed {}", seed));
    const std::string again =
        fmt::format("raypool cosim --config {} --programs 1 --seed {} --length {}", options.config, seed, options.length);
    try {
      cycles += run_random_program(*unit, memory, program, seed);
    } catch (const LockstepDifference& difference) {
      throw LockstepDifference(fmt::format("{}\nthe program that shows it: {}", difference.what(), again));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}; the program that shows it: {}", error.what(), again));
    }
    if (const auto counts = lockstep_counts(*unit)) total += *counts;
    const auto now = std::chrono::steady_clock::now();
    if (now - shown > std::chrono::seconds(5)) {
      shown = now;
      fmt::print("  {} of {} programs\n", n + 1, options.programs);
      std::fflush(stdout);
    }
  }
  fmt::print("cosim {}: {} programs from seed {}, {} cycles\n", engine.configuration.name, options.programs, options.seed,
             cycles);
  if (engine.engine == Engine::Lockstep) fmt::print("{}\n", to_string(total));
  return 0;
}

}  // namespace raypool
