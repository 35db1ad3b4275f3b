#include "cosim/program_check.hpp"

#include <fmt/format.h>

#include <array>
#include <unordered_map>
#include <vector>

#include "isa/encoding.hpp"
#include "machine/compute/functional_core.hpp"

namespace raypool {
namespace {

/// Which warps have touched a word in the current kernel; with several units, where kernels overlap, in which kernel.
struct Touched {
  static constexpr int kNone = -1, kSeveral = -2;
  uint32_t kernel = 0;
  int writer = kNone, reader = kNone;
};

class Checker {
 public:
  Checker(const Configuration& configuration, const RandomProgram& program)
      : program_(program),
        memory_(program.memory),
        core_(configuration, memory_),
        warps_(configuration.warps),
        lanes_(configuration.lanes),
        overlap_(configuration.kernel_overlap),
        intersection_words_(configuration.intersection_words),
        defined_(warps_ * kRegisters),
        slices_(warps_),
        arguments_(program.arguments) {}

  std::string run(uint64_t step_limit, uint64_t& executed) {
    reset();
    // Of a kernel that may end anywhere what has been executed has defined what it read.
    const bool defined_to_the_end = (program_.faults & ~fault_bit(FaultCode::SubnormalNumber)) == 0;
    for (const RandomProgram::Kernel& kernel : program_.kernels) {
      ++kernel_;
      if (kernel.rewrite) rewrite(*kernel.rewrite);
      launch(kernel);
      bool faulted = false;
      while (core_.running() && !faulted) {
        bool progress = false;
        for (uint32_t warp = 0; warp < warps_ && !faulted; ++warp) {
          if (!core_.warp_running(warp)) continue;
          if (++executed > step_limit) return fmt::format("it does not end within {} instructions", step_limit);
          const std::string problem = defined_to_the_end ? before(warp) : "";
          if (!problem.empty()) return fmt::format("warp {}, PC {}: {}", warp, core_.next_pc(warp), problem);
          const Step& step = core_.step(warp);
          if (step.status == Step::Status::Fault) {
            if ((program_.faults & fault_bit(step.fault.code)) == 0)
              return fmt::format("warp {} ends in fault {} at PC {}", warp, to_underlying(step.fault.code),
                                 step.fault.pc);
            faulted = true;
          }
          if (step.status == Step::Status::Executed) {
            progress = true;
            after(step);
            faulted = step.subnormal;
          }
        }
        if (!progress && !faulted) return "a rin waits for packages that never come";
      }
      if (faulted) {
        reset();
        continue;
      }
      for (uint32_t warp = 0; warp < warps_; ++warp)
        if (core_.slices().inputs_waiting(warp) != 0) return fmt::format("warp {} ends without a rin", warp);
    }
    return "";
  }

 private:
  void reset() {
    core_.reset(told_length(program_), told_limit(program_));
    for (int i = 0; i < kArguments; ++i) core_.set_argument(i, arguments_[i]);
  }

  // All units are idle then, so what they have touched is forgotten.
  void rewrite(const Rewrite& rewrite) {
    rewrite_memory(program_, rewrite, memory_);
    for (const auto& [number, value] : rewrite.arguments) {
      arguments_[number] = value;
      core_.set_argument(static_cast<int>(number), value);
    }
    touched_.clear();
  }

  void launch(const RandomProgram::Kernel& kernel) {
    LaunchCommand command;
    command.pc = kernel.pc;
    command.threads = kernel.threads;
    command.block = kernel.block;
    command.blocks = kernel.blocks;
    command.import = kernel.import;
    if (kernel.import != ImportKind::None) {
      core_.expect_import(kernel.threads);
      for (uint32_t n = 0; n < kernel.threads; ++n) core_.import_package(Intersection{});
    }
    core_.launch(command);
  }

  // Is what the warp's next instruction reads defined, and may it touch that memory?
  std::string before(uint32_t warp) {
    const DecodedInstruction* i = core_.next_instruction(warp);
    if (i == nullptr || !i->legal()) return "";  // the step will report it
    const uint32_t mask = core_.thread_mask(warp, *i);
    const InstructionInfo& info = *i->info;
    const auto undefined = [&](uint8_t number) { return (mask & ~defined_[warp * kRegisters + number]) != 0; };
    const bool reads_a = has_operand(info, Operand::Ra) || has_operand(info, Operand::Address);
    const bool reads_b = has_operand(info, Operand::Rb) || (has_operand(info, Operand::B) && !i->b_is_immediate);
    if (reads_a && undefined(i->ra)) return fmt::format("r{} is read and was not written", i->ra);
    if (reads_b && undefined(i->rb)) return fmt::format("r{} is read and was not written", i->rb);
    if (i->alu() == AluType::Mem) return touch(warp, *i, mask);
    if (i->opcode == Opcode::Rld) return read_words(warp, i->x, i->x + 1, mask);
    if (i->opcode == Opcode::Rout) return read_words(warp, 0, kRayWords, mask);
    if (i->opcode == Opcode::Rfb) return read_words(warp, word::kPixel, word::kColor + 3, mask);
    return "";
  }

  std::string read_words(uint32_t warp, int from, int to, uint32_t mask) const {
    for (int n = from; n < to && static_cast<uint32_t>(n) < intersection_words_; ++n)
      if ((mask & ~slices_[warp][n]) != 0) return fmt::format("word {} of the current slice is undefined", n);
    return "";
  }

  std::string touch(uint32_t warp, const DecodedInstruction& i, uint32_t mask) {
    const uint32_t* base = core_.register_row(warp, i.ra);
    const bool store = i.opcode == Opcode::St;
    const bool several = program_.units > 1 || overlap_;
    const int me = static_cast<int>(several ? kernel_ * warps_ + warp : warp);
    for (; mask != 0; mask &= mask - 1) {
      const uint32_t address = base[__builtin_ctz(mask)] + i.immediate;
      if (address >= told_limit(program_)) return "";  // the step will report it
      if (store && address < program_.program.code.size() * 8) return "it stores into its code";
      Touched& word = touched_[address];
      if (!several && word.kernel != kernel_) word = {kernel_, Touched::kNone, Touched::kNone};
      const bool read_by_others = word.reader != Touched::kNone && word.reader != me;
      const bool written_by_others = word.writer != Touched::kNone && word.writer != me;
      if (written_by_others || (store && read_by_others)) return fmt::format("a race at address {}", address);
      if (store)
        word.writer = me;
      else
        word.reader = read_by_others ? Touched::kSeveral : me;
    }
    return "";
  }

  void after(const Step& step) {
    const DecodedInstruction& i = *step.instruction;
    if (i.writes_register) defined_[step.warp * kRegisters + i.rd] |= step.mask;
    auto& words = slices_[step.warp];
    if (i.kind == Kind::Swap) words.fill(i.opcode == Opcode::Rin ? ~0u : 0);
    if (i.opcode == Opcode::Rst && i.x < intersection_words_) words[i.x] |= step.mask;
  }

  const RandomProgram& program_;
  Memory memory_;
  FunctionalCore core_;
  uint32_t warps_, lanes_;
  bool overlap_;
  uint32_t intersection_words_;
  std::vector<uint32_t> defined_;                                 ///< [warp][register], a bit a lane
  std::vector<std::array<uint32_t, kIntersectionWords>> slices_;  ///< [warp][word of the current slice], a bit a lane
  std::unordered_map<uint32_t, Touched> touched_;                 ///< [address]
  std::array<uint32_t, kArguments> arguments_;
  uint32_t kernel_ = 0;
};

}  // namespace

std::string check_program(const Configuration& configuration, const RandomProgram& program, uint64_t step_limit,
                          uint64_t* executed) {
  for (const RandomProgram::Kernel& kernel : program.kernels) {
    if (kernel.threads < 1 || kernel.threads > configuration.contents())
      return fmt::format("a kernel has {} threads", kernel.threads);
    if (!kernel.rewrite) continue;
    const auto& [code, data_seed, arguments] = *kernel.rewrite;
    static_cast<void>(data_seed);
    if (arguments.empty()) return "memory is rewritten and no argument is";
    if (arguments.rbegin()->first >= kArguments)
      return fmt::format("argument {} is rewritten", arguments.rbegin()->first);
    if (!code.empty() && code.rbegin()->first >= program.program.code.size())
      return fmt::format("the instruction at PC {} is rewritten, which is not there", code.rbegin()->first);
  }
  uint64_t steps = 0;
  std::string problem = Checker(configuration, program).run(step_limit, steps);
  if (executed != nullptr) *executed = steps;
  return problem;
}

}  // namespace raypool
