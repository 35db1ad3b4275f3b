#include "config/limits.hpp"

#include <fmt/format.h>

namespace raypool {

void check_program_length(const Configuration& configuration, uint32_t instructions) {
  if (instructions <= longest_program(configuration)) return;
  throw InputError(fmt::format(
      "the program has {} instructions, and the PCs of {} have {} bits, for {} at most (pc_bits): --set pc_bits=16",
      instructions, configuration.name, configuration.pc_bits, longest_program(configuration)));
}

}  // namespace raypool
