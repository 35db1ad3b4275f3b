// `raypool configurations`: the sets of configurations that the tests walk.
#include <fmt/format.h>

#include "cli/output_folder.hpp"
#include "cosim/covering.hpp"
#include "tools/commands.hpp"

namespace raypool {

int configurations_command(const ConfigurationsOptions& options) {
  const int most_threads = options.all_pairs ? kMostThreads : kSmallThreads;
  const std::vector<Machine> machines = covering_machines(most_threads, options.most > 0 ? options.most : ~size_t{0});
  fmt::print("{:<16}", "configuration");
  for (const Factor& factor : covering_factors()) {
    if (!factor.of_alu) fmt::print(" {}", factor.name);
  }
  fmt::print(";");
  for (size_t type = 0; type < kAluTypes; ++type)
    if (!kAluTable[type].timed_by_events()) fmt::print(" {}", kAluNames[type]);
  fmt::print(" as count/latency/depth, and /without as bits\n");
  for (const Machine& machine : machines) {
    const Configuration& c = machine.configuration;
    fmt::print("{:<16}", c.name);
    for (const Factor& factor : covering_factors()) {
      if (!factor.of_alu) fmt::print(" {}", factor.get(machine));
    }
    fmt::print(";");
    for (size_t type = 0; type < kAluTypes; ++type) {
      const AluConfiguration& alu = c.alus[type];
      if (kAluTable[type].timed_by_events()) continue;
      fmt::print(" {}/{}/{}", alu.count, alu.latency, alu.depth);
      if (optional_operations(static_cast<AluType>(type)) != 0) fmt::print("/{:x}", alu.without);
    }
    fmt::print("\n");
  }
  const Covered covered = count_covered(covering_factors(), machines, most_threads);
  fmt::print("{} machines of at most {} threads: {} of {} values, {} of {} pairs of values\n", machines.size(),
             most_threads, covered.values, covered.all_values, covered.pairs, covered.all_pairs);
  if (options.folder.empty()) return 0;
  OutputFolder folder(options.folder);
  std::string list;
  for (const Machine& machine : machines) {
    const std::string name = machine.configuration.name + ".json";
    folder.write(name, to_json(machine.configuration) + "\n");
    list += fmt::format("{} {}\n", name, machine.units);
  }
  folder.write("list", list);
  folder.publish();
  return 0;
}

}  // namespace raypool
