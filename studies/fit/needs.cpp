#include "fit/needs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "bits.hpp"
#include "config/limits.hpp"
#include "config/parameter_table.hpp"
#include "isa/encoding.hpp"
#include "kernel/kernel_report.hpp"
#include "machine/common/packages.hpp"

namespace raypool::fit {
namespace {

constexpr uint32_t kInstructionBytes = 8;
// A small picture is fitted, and then a large one drawn: so many times as many cycles the counters hold.
constexpr uint64_t kLongerFrames = 64;

std::string name_of(RayKernel kernel) { return std::string(kRayKernelNames[kernel]); }

/// All instructions of these kernels in turn.
template <typename Visit>
void for_each_instruction(const Program& program, const std::vector<RayKernel>& kernels, const Visit& visit) {
  for (const RayKernel kernel : kernels)
    for (const uint64_t encoding : extract_kernel(program, name_of(kernel)).code) visit(unpack(encoding));
}

const Parameter& parameter(const std::string& path) {
  return *std::find_if(std::begin(parameter::kAll), std::end(parameter::kAll),
                       [&](const Parameter& each) { return path_of(each) == path; });
}

/// All values of a parameter from `least` on that are below `most`, the least first.
std::vector<Cut> smaller(const std::string& path, uint32_t least, uint32_t most, const std::string& why) {
  std::vector<Cut> cuts;
  for (const int value : values_of(parameter(path).range))
    if (static_cast<uint32_t>(value) >= least && static_cast<uint32_t>(value) < most)
      cuts.push_back({path, value, why});
  return cuts;
}

std::vector<Cut> fewer_words(const Configuration& machine, const ProgramOf& program) {
  const uint32_t words = least_intersection_words(machine, program);
  return smaller("intersection_words", words, std::min(words + 1, machine.intersection_words),
                 fmt::format("kernels read or pass on {} words of an intersection", words));
}

std::vector<Cut> smaller_numbers(const Program& program, const std::vector<RayKernel>& kernels, const std::string& path,
                                 uint32_t Numbers::*number, uint32_t there) {
  uint32_t least = 0;
  for_each_instruction(program, kernels, [&](const Instruction& instruction) {
    least = std::max(least, numbers_of(instruction).*number);
  });
  return smaller(path, least, there, fmt::format("the kernels name {} {}", least, path));
}

std::vector<Cut> shorter_pcs(const Configuration& machine, const Program& program) {
  const uint32_t length = size32(program.code);
  uint32_t bits = 1;
  while (length >= 1u << bits) ++bits;
  return smaller("pc_bits", bits, machine.pc_bits, fmt::format("the program has {} instructions", length));
}

std::vector<Cut> shorter_counters(const Configuration& machine, const ChipResult& drawn) {
  Configuration narrow = machine;
  narrow.counter_bits = 1;
  while (counted_cycles(narrow) < kLongerFrames * drawn.cycles) ++narrow.counter_bits;
  return smaller("counter_bits", narrow.counter_bits, machine.counter_bits,
                 fmt::format("enough for a frame of {} times the cycles", kLongerFrames));
}

std::vector<Cut> fewer_stack_entries(const Configuration& machine) {
  return smaller("stack_depth", 0, machine.stack_depth, "calls and loops of the kernels nest no deeper");
}

std::vector<Cut> fewer_slow_lanes(const Configuration& machine, const ChipResult& drawn) {
  uint64_t tasks = 0;
  for (const AluType type : kEveryAluType) tasks += drawn.alus[type].issued;
  const double share = tasks == 0 ? 0 : 100.0 * static_cast<double>(drawn.alus[AluType::Slw].issued) / tasks;
  return smaller("slow_lanes", 0, std::min(machine.slow_lanes, machine.lanes),
                 fmt::format("{:.1f}% of the instructions are divisions and roots", share));
}

std::string text_of_misses(const ChipResult& drawn) {
  return fmt::format("{} of {} loads miss", drawn.data_cache_misses, drawn.data_cache_hits + drawn.data_cache_misses);
}

std::vector<Cut> smaller_data_cache(const Configuration& machine, const Frame& frame) {
  const size_t materials = frame.materials;
  return smaller("data_cache.bytes", 0, machine.data_cache_bytes,
                 materials == 0 ? text_of_misses(frame.drawn)
                                : fmt::format("{} material{} take{} {} bytes", materials, materials == 1 ? "" : "s",
                                              materials == 1 ? "s" : "", materials * kMaterialBytes));
}

std::vector<Cut> fewer_mshrs(const Configuration& machine, const ChipResult& drawn) {
  return smaller("data_cache.mshrs", 0, machine.data_cache_mshrs, text_of_misses(drawn));
}

std::vector<Cut> fewer_instructions(const Configuration& machine, AluType type, const Program& program,
                                    const std::vector<RayKernel>& kernels) {
  const uint32_t unused = optional_operations(type) & ~operations_of(program, kernels)[type];
  if ((unused & ~machine.alus[type].without) == 0) return {};
  const AluParameter& without =
      *std::find_if(std::begin(parameter::kOfAlu), std::end(parameter::kOfAlu),
                    [](const AluParameter& each) { return each.value == &AluConfiguration::without; });
  const nlohmann::ordered_json names = json_of(range_of(without, type), static_cast<int>(unused));
  return {{fmt::format("alus.{}.{}", kAluNames[type], without.key), names,
           fmt::format("no kernel has {}", fmt::join(names.get<std::vector<std::string>>(), " "))}};
}

std::vector<Cut> no_reflections(const Configuration& machine, const Frame& frame) {
  if (frame.reflections || !machine.chip.reflections) return {};
  return {{"chip.reflections", false, frame.depth > 1 ? "no material reflects" : "depth 1 casts none"}};
}

std::vector<Cut> no_subnormals(const Configuration& machine, const Frame& frame) {
  if (frame.subnormal_words || machine.subnormals == Subnormals::None) return {};
  return {{"arithmetic.subnormals", "none", "none arises in this frame; where one does the unit stops"}};
}

std::vector<Cut> smaller_instruction_cache(const Configuration& machine, const Program& program,
                                           const std::vector<RayKernel>& kernels) {
  const uint32_t bytes = code_bytes(program, kernels);
  return smaller("instruction_cache.bytes", bytes, machine.instruction_cache_bytes,
                 fmt::format("the kernels' instructions take {} bytes", bytes));
}

}  // namespace

EnumArray<AluType, uint32_t, kAluTypes> operations_of(const Program& program, const std::vector<RayKernel>& kernels) {
  EnumArray<AluType, uint32_t, kAluTypes> operations{};
  for_each_instruction(program, kernels, [&](const Instruction& instruction) {
    if (instruction.info != nullptr) operations[instruction.info->alu()] |= 1u << instruction.info->operation();
  });
  return operations;
}

uint32_t code_bytes(const Program& program, const std::vector<RayKernel>& kernels) {
  uint32_t bytes = 0;
  for_each_instruction(program, kernels, [&](const Instruction&) { bytes += kInstructionBytes; });
  return bytes;
}

uint32_t least_intersection_words(const Configuration& configuration, const ProgramOf& program) {
  Configuration fewer = configuration;
  for (const int words : values_of(parameter("intersection_words").range)) {
    fewer.intersection_words = static_cast<uint32_t>(words);
    try {
      record_layout(program(fewer), fewer);
      return fewer.intersection_words;
    } catch (const InputError&) {
      continue;  // too few
    }
  }
  return kIntersectionWords;
}

std::vector<Part> parts_of(const Frame& frame) {
  const auto kernels = [frame](const Configuration& machine) {
    return kernels_of(machine.chip, frame.depth, frame.reflections);
  };
  const auto program = [frame](const Configuration& machine) -> const Program& {
    return frame.program(machine).program;
  };
  std::vector<Part> parts = {
      [frame](const Configuration& machine) { return no_reflections(machine, frame); },
      [frame](const Configuration& machine) { return fewer_words(machine, frame.program); },  // its kernels are others
      fewer_stack_entries,
  };
  const auto numbers = [&](const std::string& path, uint32_t Numbers::*number, uint32_t Configuration::*there) {
    parts.emplace_back([=](const Configuration& machine) {
      return smaller_numbers(program(machine), kernels(machine), path, number, machine.*there);
    });
  };
  numbers("registers", &Numbers::registers, &Configuration::registers);
  numbers("predicates", &Numbers::predicates, &Configuration::predicates);
  numbers("arguments", &Numbers::arguments, &Configuration::arguments);
  parts.emplace_back([=](const Configuration& machine) { return shorter_pcs(machine, program(machine)); });
  parts.emplace_back([frame](const Configuration& machine) { return shorter_counters(machine, frame.drawn); });
  for (const AluType type : kEveryAluType)
    parts.emplace_back([=](const Configuration& machine) {
      return fewer_instructions(machine, type, program(machine), kernels(machine));
    });
  parts.emplace_back([frame](const Configuration& machine) { return no_subnormals(machine, frame); });
  const std::vector<Part> timed = {
      [frame](const Configuration& machine) { return fewer_slow_lanes(machine, frame.drawn); },
      [frame](const Configuration& machine) { return smaller_data_cache(machine, frame); },
      [=](const Configuration& machine) {
        return smaller_instruction_cache(machine, program(machine), kernels(machine));
      },
      [frame](const Configuration& machine) { return fewer_mshrs(machine, frame.drawn); },
  };
  parts.insert(parts.end(), timed.begin(), timed.end());
  return parts;
}

}  // namespace raypool::fit
