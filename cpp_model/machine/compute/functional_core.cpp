#include "machine/compute/functional_core.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "bits.hpp"
#include "isa/encoding.hpp"
#include "machine/compute/alu_model.hpp"
#include "machine/compute/brh_alu.hpp"
#include "machine/compute/flt_alu.hpp"
#include "machine/compute/int_alu.hpp"
#include "machine/compute/slw_alu.hpp"
#include "machine/compute/special_census.hpp"
#include "machine/compute/subnormal_guard.hpp"

namespace raypool {

void not_modelled(Opcode opcode) {
  throw std::logic_error(
      "the golden model does not execute " + std::string(instruction(opcode).mnemonic) +
      ": cpp_model/machine/compute/functional_core.cpp, or the ALU's header beside it, needs a case for it");
}

FunctionalCore::FunctionalCore(const Configuration& configuration, Memory& memory, uint32_t unit)
    : memory_(&memory),
      lanes_(configuration.lanes),
      configuration_(configuration),
      mode_(arith::mode_of(configuration)),
      guarded_(configuration.subnormals == Subnormals::None),
      watched_(guarded_),
      registers_(configuration.contents() * kRegisters),
      warps_(configuration.warps, Warp(configuration)),
      tid_alu_(unit),
      slices_(configuration.warps, configuration.lanes, configuration.intersection_words) {
  switch (lanes_) {
    case 1:
      step_ = &FunctionalCore::step_lanes<1>;
      break;
    case 2:
      step_ = &FunctionalCore::step_lanes<2>;
      break;
    case 4:
      step_ = &FunctionalCore::step_lanes<4>;
      break;
    case 8:
      step_ = &FunctionalCore::step_lanes<8>;
      break;
    case 16:
      step_ = &FunctionalCore::step_lanes<16>;
      break;
    case 32:
      step_ = &FunctionalCore::step_lanes<32>;
      break;
    default:
      throw InputError("lanes is " + std::to_string(lanes_) + "; the functional model takes 1, 2, 4, 8, 16 or 32");
  }
}

void FunctionalCore::reset(uint32_t program_length, uint32_t memory_limit) {
  program_length_ = program_length;
  memory_limit_ = memory_limit;
  program_decoded_ = false;
  program_.clear();
  decoded_ = 0;
  std::fill(registers_.begin(), registers_.end(), 0);
  for (Warp& warp : warps_) warp.reset();
  slices_.reset();
  running_warps_ = 0;
  result_ = Step{};
}

void FunctionalCore::launch(const LaunchCommand& command) {
  if (running()) throw std::logic_error("a kernel was launched in the functional model while another one runs");
  prepare();
  for (uint32_t warp = 0; warp < warps_.size() && warp * lanes_ < command.threads; ++warp) start(warp, command);
}

void FunctionalCore::prepare() {
  if (!program_decoded_) {
    program_.resize(program_length_);
    decode_program();
    program_decoded_ = true;
    decoded_ = program_length_;
  }
}

void FunctionalCore::start(uint32_t number, const LaunchCommand& command) {
  Warp& warp = warps_[number];
  const uint32_t threads = std::min(lanes_, command.threads - number * lanes_);
  warp.running = true;
  warp.element = nullptr;
  warp.launch = command;
  warp.launched = threads == 32 ? 0xffffffffu : (1u << threads) - 1;
  warp.pc_stack.start(command.pc);
  warp.predicates.clear();
  ++running_warps_;
}

void FunctionalCore::decode_program() {
  elements_.clear();
  for (uint32_t i = 0; i < program_length_; ++i) {
    const uint64_t encoding = uint64_t{memory_->load(8 * i + 4)} << 32 | memory_->load(8 * i);
    program_[i] = decode(encoding, configuration_);
    DecodedInstruction* last = &program_[i];
    for (int e = 1; e < elements(encoding, configuration_); ++e) {
      last->next = &elements_.emplace_back(decode(encoding, configuration_, e));
      last = &elements_.back();
    }
  }
}

bool FunctionalCore::fault(FaultCode fault_code) {
  result_.status = Step::Status::Fault;
  result_.fault = {fault_code, result_.warp, result_.pc};
  return false;
}

// Finds the warp's next instruction and its mask. False if there is none: the result has the reason. Inlined into each
// step_lanes: the functional engine spends its time there.
[[gnu::always_inline]] inline bool FunctionalCore::begin(uint32_t number) {
  Step& result = result_;
  if (result.status == Step::Status::Fault) return false;
  Warp& warp = warps_[number];
  result.status = Step::Status::NotRunning;
  result.warp = number;
  result.instruction = nullptr;
  result.mask = 0;
  result.predicate = 0;
  result.data = nullptr;
  result.ray_words = nullptr;
  result.store_count = 0;
  result.ray_count = 0;
  result.frame_count = 0;
  result.warp_ended = false;
  result.subnormal = false;
  if (!warp.running) return false;

  warp.pc_stack.pop_finished();
  result.pc = warp.pc_stack.pc();
  if (result.pc >= program_length_) return fault(FaultCode::PcOutsideProgram);
  result.instruction = warp.element != nullptr ? warp.element : &program_[result.pc];
  if (!result.instruction->legal()) return fault(FaultCode::IllegalInstruction);
  result.mask = thread_mask(number, *result.instruction);
  return true;
}

template <int kLanes>
const Step& FunctionalCore::step_lanes(uint32_t number) {
  if (!begin(number)) return result_;
  Warp& warp = warps_[number];
  const DecodedInstruction& instruction = *result_.instruction;
  if (instruction.kind == Kind::Control) {
    if (execute_control(instruction, warp)) result_.status = Step::Status::Executed;
    return result_;
  }

  uint32_t* const bank = &registers_[number * kRegisters * kLanes];
  const auto row = [bank](uint32_t reg) { return bank + reg * kLanes; };
  Lanes<kLanes> lanes = {result_.mask, row(instruction.rd), row(instruction.ra), row(instruction.rb),
                         row(instruction.x & 15)};
  uint32_t immediate[kLanes];
  if (instruction.b_is_immediate) {
    for (int lane = 0; lane < kLanes; ++lane) immediate[lane] = instruction.immediate;
    lanes.b = immediate;
  }
  const AluType alu = instruction.alu();
  if (watched_ && (alu == AluType::Brh || alu == AluType::Flt || alu == AluType::Slw)) {
    execute_watched<kLanes>(instruction, warp, lanes);
  } else if (!execute<kLanes>(instruction, warp, lanes)) {
    return result_;
  }
  if (instruction.writes_register) result_.data = lanes.rd;
  warp.element = instruction.next;
  if (warp.element == nullptr) warp.pc_stack.advance();
  result_.status = Step::Status::Executed;
  return result_;
}

// Any but a control instruction. False if it faults or has to wait.
template <int kLanes>
bool FunctionalCore::execute(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes) {
  const uint32_t predicate_x = warp.predicates.read(instruction.x & 15);
  const uint32_t predicate_b = warp.predicates.read(instruction.rb);
  switch (instruction.alu()) {
    case AluType::Tid:
      tid_alu_.execute(instruction.opcode, lanes, result_.warp, instruction.immediate, warp.launch);
      return true;
    case AluType::Brh:
      result_.predicate = BrhAlu::compare(instruction.opcode, lanes, predicate_x, predicate_b, mode_) & result_.mask;
      warp.predicates.write(instruction.rd, result_.predicate);
      return true;
    case AluType::Mem:
      return execute_memory<kLanes>(instruction, lanes);
    case AluType::Int:
      IntAlu::execute(instruction.opcode, lanes, predicate_x);
      return true;
    case AluType::Flt:
      FltAlu::execute(instruction.opcode, lanes, mode_);
      return true;
    case AluType::Slw:
      SlwAlu::execute(instruction.opcode, lanes, mode_);
      return true;
    case AluType::Ray:
      return execute_ray<kLanes>(instruction, warp, lanes);
    default:
      execute_class(instruction, warp, lanes.rd, lanes.a, lanes.b);
      return true;
  }
}

// Of an ALU that never faults otherwise.
template <int kLanes>
void FunctionalCore::execute_watched(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes) {
  const SubnormalGuard<kLanes> guard(instruction.opcode, lanes, mode_);
  if (census_ != nullptr) census_->operands(result_.pc, instruction.opcode, lanes);
  execute<kLanes>(instruction, warp, lanes);
  if (census_ != nullptr && instruction.writes_register) census_->results(result_.pc, instruction.opcode, lanes);
  if (guarded_) result_.subnormal = guard.met(instruction.writes_register ? lanes.rd : nullptr);
}

bool FunctionalCore::execute_control(const DecodedInstruction& instruction, Warp& warp) {
  PcStack& stack = warp.pc_stack;
  const uint32_t next = stack.pc() + 1;
  const bool taken = BrhAlu::taken(instruction.opcode, result_.mask);
  switch (instruction.opcode) {
    case Opcode::Jany:
    case Opcode::Jnone:
      stack.jump(taken ? instruction.target() : next);
      return true;
    case Opcode::Call:
      return stack.push(instruction.target(), instruction.end(), next) || fault(FaultCode::StackOverflow);
    case Opcode::Loop:  // its end is alone in the immediate's low half
      if (taken) return stack.push(next, instruction.target(), stack.pc()) || fault(FaultCode::StackOverflow);
      stack.jump(instruction.target());
      return true;
    case Opcode::Ret:
      return stack.pop() || fault(FaultCode::StackUnderflow);
    case Opcode::Exit:
      warp.running = false;
      --running_warps_;
      result_.warp_ended = true;
      return true;
    default:
      not_modelled(instruction.opcode);
  }
}

// A type that the core does not know: lane by lane, so that rd may be a source.
void FunctionalCore::execute_class(const DecodedInstruction& instruction, Warp& warp, uint32_t* rd, const uint32_t* a,
                                   const uint32_t* b) {
  const AluModel& alu = *find_alu_model(instruction.alu());
  const uint32_t predicate_x = warp.predicates.read(instruction.x & 15);
  const uint32_t predicate_b = warp.predicates.read(instruction.rb);
  uint32_t predicate = 0;
  for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
    const uint32_t lane = lowest(mask);
    const LaneTask task = {a[lane],
                           b[lane],
                           instruction.immediate,
                           instruction.x,
                           (predicate_x >> lane & 1) != 0,
                           (predicate_b >> lane & 1) != 0};
    const uint32_t value = alu.lane(instruction.opcode, task, mode_);
    if (instruction.writes_register) rd[lane] = value;
    predicate |= (value & 1) << lane;
  }
  if (!instruction.writes_predicate) return;
  result_.predicate = predicate;
  warp.predicates.write(instruction.rd, predicate);
}

// Loads, stores, and inval, which does nothing in a memory without caches. All masked lanes are checked before any of
// them is served; misalignment is the first thing looked for.
template <int kLanes>
bool FunctionalCore::execute_memory(const DecodedInstruction& instruction, const Lanes<kLanes>& lanes) {
  uint32_t* const addresses = result_.addresses.data();
  uint32_t low_bits = 0, highest = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    addresses[lane] = lanes.a[lane] + instruction.immediate;
    const uint32_t used = result_.mask >> lane & 1 ? addresses[lane] : 0;
    low_bits |= used & 3;
    highest = std::max(highest, used);
  }
  if (low_bits != 0) return fault(FaultCode::Misaligned);
  if (highest >= memory_limit_ && result_.mask != 0) return fault(FaultCode::AddressOutsideMemory);
  if (instruction.opcode == Opcode::Inval) return true;
  const bool store = instruction.opcode == Opcode::St;
  for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
    const uint32_t lane = lowest(mask);
    if (store) {
      memory_->store(addresses[lane], lanes.b[lane]);
      result_.stores[result_.store_count++] = {lane, addresses[lane], lanes.b[lane]};
    } else {
      lanes.rd[lane] = memory_->load(addresses[lane]);
    }
  }
  return true;
}

template <int kLanes>
bool FunctionalCore::execute_ray(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes) {
  const auto copy = [mask = result_.mask](uint32_t* to, const uint32_t* from) {
    Lanes<kLanes>{mask, to, from, from, from}.map([](uint32_t x, uint32_t) { return x; });
  };
  const uint32_t number = result_.warp;
  switch (instruction.opcode) {
    case Opcode::Rin:
      if (!slices_.input_complete(number)) {
        result_.status = Step::Status::WaitsForImport;
        return false;
      }
      slices_.swap_input(number);
      return true;
    case Opcode::Rout:
    case Opcode::Rfb:
      if (warp.output_busy) {
        result_.status = Step::Status::WaitsForExport;
        return false;
      }
      slices_.swap_output(number);
      for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
        const uint32_t lane = lowest(mask);
        if (instruction.opcode == Opcode::Rout) {
          Ray& ray = result_.rays[result_.ray_count++];
          for (uint32_t word = 0; word < kRayWords; ++word) ray[word] = slices_.output(number, word)[lane];
        } else {
          FrameContribution& frame = result_.frame[result_.frame_count++];
          frame.pixel = slices_.output(number, word::kPixel)[lane];
          for (uint32_t i = 0; i < 3; ++i) frame.rgb[i] = slices_.output(number, word::kColor + i)[lane];
        }
      }
      return true;
    case Opcode::Rld:
      if (instruction.x >= configuration_.intersection_words) return fault(FaultCode::RayWordOutside);
      copy(lanes.rd, slices_.current(number, instruction.x));
      return true;
    case Opcode::Rst:
      if (instruction.x >= configuration_.intersection_words) return fault(FaultCode::RayWordOutside);
      result_.ray_words = slices_.current(number, instruction.x);
      copy(slices_.current(number, instruction.x), lanes.b);
      return true;
    default:
      not_modelled(instruction.opcode);
  }
}

}  // namespace raypool
