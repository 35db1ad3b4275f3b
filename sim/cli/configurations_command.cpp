// `raypool configurations`: the sets of configurations that the tests walk.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "cli/commands.hpp"
#include "cosim/covering.hpp"
#include "isa/input_error.hpp"

namespace raypool {

int configurations_command(const ConfigurationsOptions& options) {
  const std::vector<Configuration> configurations = options.all_pairs ? all_pairs_configurations() : small_configurations();
  fmt::print("{:<16}", "configuration");
  for (const Factor& factor : covering_factors()) {
    if (factor.name.find('.') == std::string::npos || factor.name.find("cache") != std::string::npos)
      fmt::print(" {}", factor.name);
  }
  fmt::print("; tid brh int flt slw as count/latency/depth\n");
  for (const Configuration& c : configurations) {
    fmt::print("{:<16} {} {} {} {} {} {} {} {};", c.name, c.warps, c.cores, c.stack_depth, c.instruction_cache_bytes,
               c.data_cache_bytes, c.data_cache_mshrs, static_cast<int>(c.subnormals), static_cast<int>(c.slow_unit));
    for (const Unit unit : {Unit::Tid, Unit::Brh, Unit::Int, Unit::Flt, Unit::Slw})
      fmt::print(" {}/{}/{}", c.alu(unit).count, c.alu(unit).latency, c.alu(unit).depth);
    fmt::print("\n");
  }
  const Covered covered = count_covered(configurations);
  fmt::print("{} configurations: {} of {} values, {} of {} pairs of values ({:.1f}%)\n", configurations.size(), covered.values,
             covered.all_values, covered.pairs, covered.all_pairs,
             100.0 * static_cast<double>(covered.pairs) / static_cast<double>(covered.all_pairs));
  if (options.folder.empty()) return 0;
  std::filesystem::create_directories(options.folder);
  for (const Configuration& configuration : configurations) {
    const std::string path = options.folder + "/" + configuration.name + ".json";
    std::ofstream file(path);
    file << to_json(configuration) << "\n";
    if (!file) throw InputError(fmt::format("{}: the file cannot be written", path));
  }
  return 0;
}

}  // namespace raypool
