#include "lockstep/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "lockstep/rtl_files.hpp"

namespace raypool::lockstep {

std::string word_text(uint32_t word) { return fmt::format("{:08x} ({:.7g})", word, as_float(word)); }

std::string mask_text(uint32_t mask, int lanes) { return fmt::format("{:0{}b}", mask, lanes); }

std::string instruction_text(uint64_t encoding) { return disassemble(encoding); }

std::string result_files(const DecodedInstruction& instruction, const Configuration& configuration) {
  switch (instruction.alu()) {
    case AluType::Flt: {
      const Opcode opcode = instruction.opcode;
      const bool product = opcode == Opcode::Fmul;
      const bool arithmetic = product || opcode == Opcode::Fadd || opcode == Opcode::Fsub || opcode == Opcode::Ffma;
      const char* block = !arithmetic         ? "float_convert"
                          : configuration.fma ? "float_fma"
                          : product           ? "float_multiplier"
                                              : "float_adder";
      // A difference is a sum with another sign, for which the lane sees.
      return opcode == Opcode::Fsub ? rtl_files({block, "float_lane", "flt_alu"})
                                    : rtl_files({block, "flt_alu", "float_lane"});
    }
    case AluType::Slw:
      // Of fewer lanes than a task has, the ALU itself decides which take what, and when.
      return rtl_files({configuration.slow_unit == SlowUnit::Exact ? "slow_exact" : "slow_newton",
                        configuration.slow_groups() > 1 ? "slw_alu" : "slow_lane", "slow_prepare"});
    case AluType::Mem:
      return "rtl/compute/rp_mem_alu.v, rtl/compute/rp_data_cache.v";
    case AluType::Ray:
      return "rtl/compute/rp_ray_memory.v, rtl/compute/rp_ray_alu.v";
    case AluType::Tid:
      // What it is given of the launch.
      return "rtl/compute/rp_tid_alu.v, rtl/compute/rp_compute_unit.v";
    default:
      return rtl_files({std::string(alu_info(instruction.alu()).name) + "_alu"});
  }
}

std::string first_files(const std::string& files, size_t most) {
  std::vector<std::string> kept;
  for (size_t begin = 0; begin <= files.size() && kept.size() < most;) {
    const size_t end = std::min(files.find(", ", begin), files.size());
    const std::string file = files.substr(begin, end - begin);
    if (std::find(kept.begin(), kept.end(), file) == kept.end()) kept.push_back(file);
    begin = end + 2;
  }
  return fmt::format("{}", fmt::join(kept, ", "));
}

std::string fault_text(const Fault& fault) {
  static constexpr std::array<const char*, 9> kNames = {
      "no fault",           "illegal instruction", "PC outside the program", "PC stack overflow",
      "PC stack underflow", "misaligned address",  "address outside memory", "ray word that an intersection has not",
      "subnormal number"};
  const size_t code = to_underlying(fault.code);
  if (fault.code == FaultCode::None) return kNames[0];
  return fmt::format("{} (code {}) at warp {}, PC {}", code < kNames.size() ? kNames[code] : "unknown fault", code,
                     fault.warp, fault.pc);
}

std::string lane_table(const CycleUnit::Issue& issue, int lanes, const uint32_t* rtl, const uint32_t* model) {
  const DecodedInstruction& instruction = *issue.instruction;
  bool uses_a = false, uses_c = false, uses_px = false, uses_pb = false;
  for (const Operand operand : instruction.info->operands) {
    uses_a |= operand == Operand::Ra || operand == Operand::Address;
    uses_c |= operand == Operand::Rc;
    uses_px |= operand == Operand::Px;
    uses_pb |= operand == Operand::Pb;
  }
  std::string text = "  lane";
  const auto column = [&text](const std::string& cell) { text += fmt::format("  {:<24}", cell); };
  if (uses_a) column(fmt::format("r{}", instruction.ra));
  if (instruction.uses_b) column(instruction.b_is_immediate ? "immediate" : fmt::format("r{}", instruction.rb));
  if (uses_c) column(fmt::format("r{}", instruction.x & 15));
  if (uses_px) column(fmt::format("p{}", instruction.x & 15));
  if (uses_pb) column(fmt::format("p{}", instruction.rb));
  if (rtl != nullptr) column("RTL"), column("model");
  const auto end_line = [&text] {
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  };
  end_line();
  for (int lane = 0; lane < lanes; ++lane) {
    const size_t i = lane;
    const bool masked = issue.mask >> lane & 1;
    text += fmt::format("  {:>4}", lane);
    if (uses_a) column(word_text(issue.operand_a[i]));
    if (instruction.uses_b) column(word_text(issue.operand_b[i]));
    if (uses_c) column(word_text(issue.operand_c[i]));
    if (uses_px) column(std::to_string(issue.predicate_x >> lane & 1));
    if (uses_pb) column(std::to_string(issue.predicate_b >> lane & 1));
    if (!masked) {
      text += "  not in the thread mask";
    } else if (rtl != nullptr) {
      column(word_text(rtl[lane])), column(word_text(model[lane]));
      if (rtl[lane] != model[lane]) text += "  <-- differs";
    }
    end_line();
  }
  return text;
}

}  // namespace raypool::lockstep
