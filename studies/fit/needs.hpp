// What a frame needs of its machine, and so what there may be less of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chip/chip.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "fit/fit.hpp"
#include "kernel/kernels.hpp"

namespace raypool::fit {

/// What is known of a frame when it has been drawn once.
struct Frame {
  int depth = 1;             ///< rays beyond it are not traced
  bool reflections = false;  ///< are cast
  size_t materials = 0;
  bool subnormal_words = false;  ///< in what it is drawn from (scene/subnormal_words.hpp)
  ChipResult drawn;              ///< on the machine that is to be fitted
};

/// Bit `operation` of each ALU type: these kernels of the configuration's program have the instruction.
EnumArray<AluType, uint32_t, kAluTypes> operations_of(const Configuration& configuration,
                                                      const std::vector<RayKernel>& kernels);

/// Instructions of these kernels in the configuration's program, bytes.
uint32_t code_bytes(const Configuration& configuration, const std::vector<RayKernel>& kernels);

/// The fewest words of an intersection that the ray kernels make do with: 12 .. 21.
uint32_t least_intersection_words(const Configuration& configuration);

/// What there may be less of, in the order in which it is to be tried: first what takes no time, then what saves most.
std::vector<Part> parts_of(const Frame& frame);

}  // namespace raypool::fit
