#include "faulty/trial.hpp"

#include "cosim/cosim.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"

namespace raypool::faulty {
namespace {

// A fault that hangs must be found soon: stalls of the host are some hundred cycles long.
constexpr uint64_t kWatchdogCycles = 4000;
constexpr uint64_t kCycleLimit = 2'000'000;

}  // namespace

void run_program(const Machine& machine, const RandomProgram& program, Outcome& outcome) {
  const auto run = [&](uint64_t inspect_until) {
    Memory memory = program.memory;
    LockstepOptions lockstep;
    lockstep.watchdog_cycles = kWatchdogCycles;
    lockstep.inspect_until = inspect_until;
    const auto unit = make_lockstep_unit(
        machine.configuration, load_rtl_unit(machine.library, machine.configuration, machine.units), memory, lockstep);
    run_random_program(*unit, memory, program, program.seed, kCycleLimit);
  };
  try {
    inspect_differences(run);
  } catch (const LockstepDifference& difference) {
    outcome.text = difference.what();
    outcome.kind = outcome.text.find("hang: ") != std::string::npos ? Outcome::Kind::Hang : Outcome::Kind::Difference;
  } catch (const std::exception& error) {
    outcome.text = error.what();
    outcome.kind = Outcome::Kind::Stopped;
  }
}

}  // namespace raypool::faulty
