// `raypool kernels`
#include <algorithm>
#include <cstdio>

#include "cli/commands.hpp"
#include "config/configuration.hpp"
#include "isa/assembler.hpp"
#include "kernel/compute_kernels.hpp"
#include "kernel/kernel_report.hpp"

namespace raypool {

int kernels_command(const std::string& name, const std::string& config, const std::vector<std::string>& set) {
  const bool fused = load_configuration(config, set).fma;
  const bool compute =
      std::find(kComputeKernelNames.begin(), kComputeKernelNames.end(), name) != kComputeKernelNames.end();
  const Program& program = compute ? compute_kernel_program(fused) : ray_kernel_program(fused);
  const std::string text = name.empty() ? kernel_table(fused) : listing(extract_kernel(program, name));
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace raypool
