// `raypool config`
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "config/configuration.hpp"

namespace raypool {
namespace {

constexpr const char* kSubnormalsNames[] = {"ieee", "flush"};
constexpr const char* kSlowUnitNames[] = {"exact", "newton2", "newton1", "newton0"};

void print_table(const Configuration& configuration) {
  fmt::print("configuration {}\n", configuration.name);
  fmt::print("  warps {}, lanes {}: {} threads at once\n", configuration.warps, configuration.lanes,
             configuration.contents());
  fmt::print("  PC stack       {} entries a warp\n", configuration.stack_depth);
  fmt::print("  caches         instructions {} bytes, data {} bytes with {} miss-status holding registers\n",
             configuration.instruction_cache_bytes, configuration.data_cache_bytes, configuration.data_cache_mshrs);
  fmt::print("  arithmetic     subnormals {}, slow unit {}, fused multiply-add {}\n",
             kSubnormalsNames[static_cast<size_t>(configuration.subnormals)],
             kSlowUnitNames[static_cast<size_t>(configuration.slow_unit)], configuration.fma ? "on" : "off");
  fmt::print("  ALU   instances  latency  depth\n");
  for (size_t i = 0; i < kAluTypes; ++i) {
    const AluConfiguration& alu = configuration.alus[i];
    const bool timed_by_events = static_cast<AluType>(i) == AluType::Mem || static_cast<AluType>(i) == AluType::Ray;
    fmt::print("  {}   {:>9}", kAluNames[i], alu.count);
    timed_by_events ? fmt::print("  by event\n") : fmt::print("  {:>7}  {:>5}\n", alu.latency, alu.depth);
  }
}

}  // namespace

int config_command(const ConfigOptions& options) {
  const Configuration configuration = load_configuration(options.config);
  if (options.json) {
    fmt::print("{}\n", to_json(configuration));
  } else if (options.verilog_parameters) {
    for (const auto& [name, value] : verilog_parameters(configuration)) fmt::print("{}={}\n", name, value);
  } else if (options.unit_library) {
    fmt::print("{}\n", unit_library_path(configuration, false, options.units));
  } else {
    print_table(configuration);
  }
  return 0;
}

}  // namespace raypool
