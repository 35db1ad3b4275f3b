#include "kernel/kernel_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numeric>

#include "bits.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/encoding.hpp"

namespace raypool {
namespace {

// M.-L. Hsieh, "Ray-Pool Based Configurable Multiprocessor Design for Ray Tracing", National Taiwan
// University, 2015; one compute unit.
constexpr std::array<InstructionCounts, kRayKernels> kThesisCounts = {
    {{2, 2, 2, 33, 24, 1, 13}, {1, 7, 4, 54, 75, 5, 45}, {1, 5, 4, 38, 33, 3, 26}, {1, 6, 3, 23, 10, 1, 10}}};

/// Throws InputError when the instruction names what the machine has not.
void check_numbers(const Instruction& instruction, const std::string& kernel, size_t pc,
                   const Configuration& configuration) {
  const Numbers needs = numbers_of(instruction);
  const auto check = [&](const char* parameter, char letter, uint32_t needed, uint32_t there) {
    if (needed <= there) return;
    throw InputError(fmt::format(
        "kernel {} has {} with {}{} (instruction {}), and {} has {} {}: give that configuration {}, or more", kernel,
        instruction.info->mnemonic, letter == 'a' ? "argument " : std::string(1, letter), needed - 1, pc,
        configuration.name, there, parameter, needed));
  };
  check("registers", 'r', needs.registers, configuration.registers);
  check("predicates", 'p', needs.predicates, configuration.predicates);
  check("arguments", 'a', needs.arguments, configuration.arguments);
}

int total(const InstructionCounts& counts) { return std::accumulate(counts.begin(), counts.end(), 0); }

}  // namespace

Program extract_kernel(const Program& program, const std::string& name) {
  const auto found = program.entries.find(name);
  if (found == program.entries.end()) {
    std::vector<std::string> names;
    for (const auto& entry : program.entries) names.push_back(entry.first);
    throw InputError(fmt::format("there is no kernel '{}'{}", name,
                                 did_you_mean(name, names, fmt::format("there are {}", fmt::join(names, ", ")))));
  }
  const uint32_t begin = found->second;
  auto end = size32(program.code);
  for (const auto& [other, entry] : program.entries) {
    if (entry > begin) end = std::min(end, entry);
  }
  Program result;
  result.entries[name] = 0;
  for (uint32_t pc = begin; pc < end; ++pc) {
    Instruction parts = unpack(program.code[pc]);
    // Targets move with the kernel.
    if (parts.info != nullptr && has_operand(*parts.info, Operand::Target)) parts.immediate -= begin;
    if (parts.info != nullptr && has_operand(*parts.info, Operand::End)) {
      parts.immediate -= has_operand(*parts.info, Operand::Target) ? begin << 16 : begin;
    }
    result.code.push_back(parts.info == nullptr ? program.code[pc] : encode(parts));
  }
  return result;
}

void check_instructions(const Program& program, const std::string& kernel, const Configuration& configuration) {
  const std::vector<uint64_t> code = extract_kernel(program, kernel).code;
  for (size_t pc = 0; pc < code.size(); ++pc) {
    const Instruction instruction = unpack(code[pc]);
    const InstructionInfo* info = instruction.info;
    if (info == nullptr) continue;
    check_numbers(instruction, kernel, pc, configuration);
    if (configuration.has(*info)) continue;
    throw InputError(fmt::format(
        "kernel {} has {} (instruction {}), which {} is without: take it off alus.{}.without of that configuration",
        kernel, info->mnemonic, pc, configuration.name, kAluNames[info->alu()]));
  }
}

InstructionCounts count_instructions(const Program& program, const std::string& name) {
  InstructionCounts counts{};
  for (const uint64_t encoding : extract_kernel(program, name).code) {
    const Instruction parts = unpack(encoding);
    if (parts.info != nullptr) ++counts[parts.info->alu()];
  }
  return counts;
}

std::string kernel_table(const KernelTarget& target) {
  std::string text = fmt::format("{:<22}", "instructions");
  for (const std::string_view name : kAluNames) text += fmt::format("{:>9}", name);
  text += fmt::format("{:>10}\n", "total");
  for (size_t kernel = 0; kernel < kRayKernels; ++kernel) {
    const InstructionCounts counts =
        count_instructions(ray_kernel_program(target), std::string(kRayKernelNames[kernel]));
    const InstructionCounts& thesis = kThesisCounts[kernel];
    text += fmt::format("{:<22}", kRayKernelNames[kernel]);
    for (size_t type = 0; type < kAluTypes; ++type)
      text += fmt::format("{:>9}", fmt::format("{} ({})", counts[type], thesis[type]));
    text += fmt::format("{:>10}\n", fmt::format("{} ({})", total(counts), total(thesis)));
  }
  text += "in brackets: the thesis' kernels\n";
  return text;
}

}  // namespace raypool
