// The tables of docs/studies/convergence.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raypool::convergence {

struct CommandOptions {
  std::vector<std::string> scenes{"cornell", "area-light", "courtyard", "features"};
  std::string shaders = "path", size = "256x256";
  uint32_t depth = 8, samples = 4096, block = 16;
  double reference = 1;  ///< its samples, as a share of `samples`
};

int convergence_command(const CommandOptions& options);

}  // namespace raypool::convergence
