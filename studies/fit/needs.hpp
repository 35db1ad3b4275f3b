// What a frame needs of its machine, and so what there may be less of.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "chip/chip.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "fit/fit.hpp"
#include "kernel/kernels.hpp"
#include "kernel/ray_program.hpp"

namespace raypool::fit {

/// The kernels that draw a frame, as they are compiled for a machine. Throws InputError when it lacks what they need.
using ProgramOf = std::function<const RayProgram&(const Configuration&)>;
inline const RayProgram& built_in_program(const Configuration& machine) {
  return built_in_ray_program(KernelTarget(machine));
}

/// What is known of a frame when it has been drawn once.
struct Frame {
  int depth = 1;                 ///< rays beyond it are not traced
  bool reflections = false;      ///< are cast
  size_t materials = 0;          ///< that the built-in kernels load; 0: shaders draw, which load what they want
  bool subnormal_words = false;  ///< in what it is drawn from (scene/subnormal_words.hpp)
  ChipResult drawn;              ///< on the machine that is to be fitted
  ProgramOf program = built_in_program;
};

/// Bit `operation` of each ALU type: these kernels of the program have the instruction.
EnumArray<AluType, uint32_t, kAluTypes> operations_of(const Program& program, const std::vector<RayKernel>& kernels);

/// Instructions of these kernels in the program, bytes.
uint32_t code_bytes(const Program& program, const std::vector<RayKernel>& kernels);

/// The fewest words of an intersection that the kernels make do with: 12 .. 21.
uint32_t least_intersection_words(const Configuration& configuration, const ProgramOf& program = built_in_program);

/// What there may be less of, in the order in which it is to be tried: first what takes no time, then what saves most.
std::vector<Part> parts_of(const Frame& frame);

}  // namespace raypool::fit
