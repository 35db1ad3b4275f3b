// `raypool kernels`
#include <algorithm>
#include <cstdio>

#include "config/configuration.hpp"
#include "isa/assembler.hpp"
#include "kernel/compute_kernels.hpp"
#include "kernel/kernel_report.hpp"
#include "tools/commands.hpp"

namespace raypool {

int kernels_command(const std::string& name, const std::string& config, const std::vector<std::string>& set) {
  const KernelTarget target(load_configuration(config, set));
  const bool compute =
      std::find(kComputeKernelNames.begin(), kComputeKernelNames.end(), name) != kComputeKernelNames.end();
  const Program& program = compute ? compute_kernel_program(target) : ray_kernel_program(target);
  const std::string text = name.empty() ? kernel_table(target) : listing(extract_kernel(program, name));
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace raypool
