// `raypool config`
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "config/parameter_table.hpp"
#include "config/unused_fields.hpp"

namespace raypool {
namespace {

void print_row(const Parameter& parameter, const Configuration& configuration, int width) {
  fmt::print("  {:<{}} {:>7}  {}\n", path_of(parameter), width, text_of(parameter, parameter.get(configuration)),
             parameter.meaning);
}

void print_table(const Configuration& configuration) {
  fmt::print("configuration {}, {} threads at once\n", configuration.name, configuration.contents());
  for (const Parameter& parameter : parameter::kAll) print_row(parameter, configuration, 23);
  fmt::print("  ALU   instances  latency  depth\n");
  for (size_t i = 0; i < kAluTypes; ++i) {
    const AluConfiguration& alu = configuration.alus[i];
    const bool timed_by_events = kAluTable[i].timed_by_events();
    fmt::print("  {}   {:>9}", kAluNames[i], alu.count);
    timed_by_events ? fmt::print("  by event\n") : fmt::print("  {:>7}  {:>5}\n", alu.latency, alu.depth);
  }
  for (const AluType type : kEveryAluType) {
    if (configuration.alus[type].without == 0) continue;
    fmt::print("  {} is without", kAluNames[type]);
    for (const InstructionInfo& info : kInstructions)
      if (info.alu() == type && info.needs == Feature::Optional && !configuration.has(info))
        fmt::print(" {}", info.mnemonic);
    fmt::print("\n");
  }
  for (const Parameter& parameter : parameter::kOfChip) print_row(parameter, configuration, 38);
}

}  // namespace

int config_command(const ConfigOptions& options) {
  const Configuration configuration = load_configuration(options.config, options.set);
  if (options.in_use) refuse_unused_settings(configuration);
  if (options.json) {
    fmt::print("{}\n", to_json(configuration));
  } else if (options.verilog_parameters) {
    for (const auto& [name, value] :
         options.chip ? chip_verilog_parameters(configuration, options.units) : verilog_parameters(configuration))
      fmt::print("{}={}\n", name, value);
  } else if (options.unit_library) {
    fmt::print("{}\n", unit_library_path(configuration, false, options.units));
  } else {
    print_table(configuration);
  }
  return 0;
}

}  // namespace raypool
