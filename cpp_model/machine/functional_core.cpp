#include "machine/functional_core.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "machine/alu_model.hpp"

namespace raypool {
namespace {

constexpr uint32_t kFirstRpc = 0xffff;

template <int kLanes>
constexpr uint32_t kAllLanes = kLanes == 32 ? 0xffffffffu : (1u << kLanes) - 1;

// rd = f(a, b) in the masked lanes. The full mask is the common case: through an array of its own, so that the compiler need not
// care whether rd is also a source.
template <int kLanes, typename Function>
inline void map_lanes(uint32_t mask, uint32_t* rd, const uint32_t* a, const uint32_t* b, Function function) {
  if (mask == kAllLanes<kLanes>) {
    uint32_t values[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) values[lane] = function(a[lane], b[lane]);
    std::memcpy(rd, values, sizeof(values));
  } else {
    for (; mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      rd[lane] = function(a[lane], b[lane]);
    }
  }
}

template <int kLanes, typename Function>
inline uint32_t test_lanes(const uint32_t* a, const uint32_t* b, Function function) {
  uint32_t result = 0;
  for (int lane = 0; lane < kLanes; ++lane) result |= static_cast<uint32_t>(function(a[lane], b[lane])) << lane;
  return result;
}

inline int32_t as_signed(uint32_t value) { return static_cast<int32_t>(value); }

constexpr uint16_t code(AluType type, int operation) { return instruction_code(type, operation); }

}  // namespace

FunctionalCore::FunctionalCore(const Configuration& configuration, Memory& memory)
    : memory_(&memory),
      lanes_(configuration.cores),
      stack_depth_(static_cast<uint32_t>(configuration.stack_depth)),
      configuration_(configuration),
      mode_(arith::mode_of(configuration)),
      registers_(static_cast<size_t>(configuration.contents() * kRegisters)),
      warps_(static_cast<size_t>(configuration.warps)),
      slices_(configuration.warps, configuration.cores) {
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
      throw InputError("cores is " + std::to_string(lanes_) + "; the functional model takes 1, 2, 4, 8, 16 or 32");
  }
}

void FunctionalCore::reset(uint32_t program_length, uint32_t memory_limit) {
  program_length_ = program_length;
  memory_limit_ = memory_limit;
  program_decoded_ = false;
  program_.clear();
  std::fill(registers_.begin(), registers_.end(), 0);
  std::fill(warps_.begin(), warps_.end(), Warp{});
  slices_.reset();
  running_warps_ = 0;
  result_ = Step{};
}

void FunctionalCore::launch(const LaunchCommand& command) {
  if (running()) throw std::logic_error("a kernel was launched in the functional model while another one runs");
  if (!program_decoded_) {
    program_.resize(program_length_);
    for (uint32_t i = 0; i < program_length_; ++i)
      program_[i] = decode(uint64_t{memory_->load(8 * i + 4)} << 32 | memory_->load(8 * i), configuration_);
    program_decoded_ = true;
  }
  launched_ = command;
  const uint32_t lanes = static_cast<uint32_t>(lanes_);
  for (uint32_t number = 0; number < warps_.size(); ++number) {
    Warp& warp = warps_[number];
    const uint32_t first = number * lanes;
    if (first >= command.threads) break;
    const uint32_t threads = std::min(lanes, command.threads - first);
    warp.running = true;
    warp.launched = threads == 32 ? 0xffffffffu : (1u << threads) - 1;
    warp.depth = 1;
    warp.stack[0] = {command.pc, kFirstRpc};
    warp.predicates.fill(0);
    warp.predicates[0] = 0xffffffffu;
    ++running_warps_;
  }
}

uint32_t FunctionalCore::next_pc(uint32_t number) const {
  const Warp& warp = warps_[number];
  uint32_t top = warp.depth == 0 ? 0 : warp.depth - 1;
  while (top > 0 && warp.stack[top].pc >= warp.stack[top].rpc) --top;
  return warp.stack[top].pc;
}

bool FunctionalCore::fault(FaultCode fault_code) {
  result_.status = Step::Status::Fault;
  result_.fault = {fault_code, result_.warp, result_.pc};
  return false;
}

template <int kLanes>
const Step& FunctionalCore::step_lanes(uint32_t number) {
  Step& result = result_;
  if (result.status == Step::Status::Fault) return result;
  Warp& warp = warps_[number];
  result.status = Step::Status::NotRunning;
  result.warp = number;
  result.instruction = nullptr;
  result.mask = 0;
  result.data = nullptr;
  result.predicate = 0;
  result.store_count = 0;
  result.ray_words = nullptr;
  result.ray_count = 0;
  result.frame_count = 0;
  result.warp_ended = false;
  if (!warp.running) return result;

  // PC stack: finished entries are popped, then the top PC is taken. The first entry is never finished.
  while (warp.depth > 1 && warp.stack[warp.depth - 1].pc >= warp.stack[warp.depth - 1].rpc) --warp.depth;
  StackEntry& top = warp.stack[warp.depth - 1];
  result.pc = top.pc;
  if (top.pc >= program_length_) return fault(FaultCode::PcOutsideProgram), result;
  const DecodedInstruction& instruction = program_[top.pc];
  result.instruction = &instruction;
  if (!instruction.legal()) return fault(FaultCode::IllegalInstruction), result;
  result.mask = thread_mask(number, instruction);

  // Operands
  uint32_t* const bank = &registers_[number * kRegisters * kLanes];
  uint32_t* const rd = bank + instruction.rd * kLanes;
  const uint32_t* const a = bank + instruction.ra * kLanes;
  const uint32_t* b = bank + instruction.rb * kLanes;
  uint32_t immediate[kLanes];
  if (instruction.b_is_immediate) {
    for (int lane = 0; lane < kLanes; ++lane) immediate[lane] = instruction.immediate;
    b = immediate;
  }

  switch (static_cast<AluType>(instruction.code >> 5)) {
    case AluType::Brh:
      if (instruction.info->control) {
        if (!execute_control(instruction, warp)) return result;
        result.status = Step::Status::Executed;
        return result;
      }
      result.predicate = compare<kLanes>(instruction, warp, a, b) & result.mask;
      if (instruction.rd != 0) warp.predicates[instruction.rd] = result.predicate;
      break;
    case AluType::Mem:
      if (!execute_memory<kLanes>(instruction, rd, a, b)) return result;
      break;
    case AluType::Ray:
      if (!execute_ray<kLanes>(instruction, warp, rd, b)) return result;
      break;
    default:
      execute_data<kLanes>(instruction, warp, rd, a, b, bank + (instruction.x & 15) * kLanes);
      break;
  }
  if (instruction.writes_register) result.data = rd;
  ++top.pc;
  result.status = Step::Status::Executed;
  return result;
}

bool FunctionalCore::execute_control(const DecodedInstruction& instruction, Warp& warp) {
  StackEntry& top = warp.stack[warp.depth - 1];
  const uint32_t next = top.pc + 1;
  const bool any = result_.mask != 0;
  switch (instruction.code) {
    case code(AluType::Brh, 24):
      top.pc = any ? instruction.target() : next;
      return true;  // jany
    case code(AluType::Brh, 25):
      top.pc = !any ? instruction.target() : next;
      return true;                // jnone
    case code(AluType::Brh, 26):  // call
      if (warp.depth == stack_depth_) return fault(FaultCode::StackOverflow);
      top.pc = next;
      warp.stack[warp.depth++] = {instruction.target(), instruction.end()};
      return true;
    case code(AluType::Brh, 27):  // loop; its end is alone in the immediate's low half
      if (!any) {
        top.pc = instruction.target();
        return true;
      }
      if (warp.depth == stack_depth_) return fault(FaultCode::StackOverflow);
      warp.stack[warp.depth++] = {next, instruction.target()};
      return true;
    case code(AluType::Brh, 28):  // ret
      if (warp.depth == 1) return fault(FaultCode::StackUnderflow);
      --warp.depth;
      return true;
    default:  // exit
      warp.running = false;
      --running_warps_;
      result_.warp_ended = true;
      return true;
  }
}

template <int kLanes>
uint32_t FunctionalCore::compare(const DecodedInstruction& instruction, const Warp& warp, const uint32_t* a,
                                 const uint32_t* b) const {
  const arith::Mode mode = mode_;
  const uint32_t px = warp.predicates[instruction.x & 15], pb = warp.predicates[instruction.rb];
  const auto test = [a, b](auto function) { return test_lanes<kLanes>(a, b, function); };
  switch (instruction.code) {
    case code(AluType::Brh, 0):
      return test([](uint32_t x, uint32_t y) { return x == y; });
    case code(AluType::Brh, 1):
      return test([](uint32_t x, uint32_t y) { return x != y; });
    case code(AluType::Brh, 2):
      return test([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y); });
    case code(AluType::Brh, 3):
      return test([](uint32_t x, uint32_t y) { return as_signed(x) <= as_signed(y); });
    case code(AluType::Brh, 4):
      return test([](uint32_t x, uint32_t y) { return as_signed(x) > as_signed(y); });
    case code(AluType::Brh, 5):
      return test([](uint32_t x, uint32_t y) { return as_signed(x) >= as_signed(y); });
    case code(AluType::Brh, 6):
      return test([](uint32_t x, uint32_t y) { return x < y; });
    case code(AluType::Brh, 7):
      return test([](uint32_t x, uint32_t y) { return x <= y; });
    case code(AluType::Brh, 8):
      return test([](uint32_t x, uint32_t y) { return x > y; });
    case code(AluType::Brh, 9):
      return test([](uint32_t x, uint32_t y) { return x >= y; });
    case code(AluType::Brh, 10):
      return test([mode](uint32_t x, uint32_t y) { return arith::equal(x, y, mode); });
    case code(AluType::Brh, 11):
      return test([mode](uint32_t x, uint32_t y) { return arith::not_equal(x, y, mode); });
    case code(AluType::Brh, 12):
      return test([mode](uint32_t x, uint32_t y) { return arith::less(x, y, mode); });
    case code(AluType::Brh, 13):
      return test([mode](uint32_t x, uint32_t y) { return arith::less_equal(x, y, mode); });
    case code(AluType::Brh, 14):
      return test([mode](uint32_t x, uint32_t y) { return arith::greater(x, y, mode); });
    case code(AluType::Brh, 15):
      return test([mode](uint32_t x, uint32_t y) { return arith::greater_equal(x, y, mode); });
    case code(AluType::Brh, 16):
      return px & pb;
    case code(AluType::Brh, 17):
      return px | pb;
    case code(AluType::Brh, 18):
      return px ^ pb;
    default:
      return px & ~pb;  // pandn
  }
}

template <int kLanes>
void FunctionalCore::execute_data(const DecodedInstruction& instruction, Warp& warp, uint32_t* rd, const uint32_t* a,
                                  const uint32_t* b, const uint32_t* c) {
  const arith::Mode mode = mode_;
  const uint32_t mask = result_.mask;
  const auto map = [=](auto function) { map_lanes<kLanes>(mask, rd, a, b, function); };
  const auto fill = [=](uint32_t value) { map_lanes<kLanes>(mask, rd, a, b, [value](uint32_t, uint32_t) { return value; }); };
  const auto number_lanes = [=](uint32_t first) {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      if (mask >> lane & 1) rd[lane] = first + lane;
    }
  };
  switch (instruction.code) {
    case code(AluType::Tid, 0):
      number_lanes(result_.warp * kLanes);
      break;
    case code(AluType::Tid, 1):
      number_lanes(0);
      break;
    case code(AluType::Tid, 2):
      fill(result_.warp);
      break;
    case code(AluType::Tid, 3):
      fill(launched_.block);
      break;
    case code(AluType::Tid, 4):
      fill(launched_.threads);
      break;
    case code(AluType::Tid, 5):
      fill(launched_.blocks);
      break;
    case code(AluType::Tid, 6):
      fill(arguments_[instruction.immediate % kArguments]);
      break;

    case code(AluType::Int, 0):
      map([](uint32_t, uint32_t y) { return y; });
      break;
    case code(AluType::Int, 1):
      map([](uint32_t x, uint32_t y) { return x + y; });
      break;
    case code(AluType::Int, 2):
      map([](uint32_t x, uint32_t y) { return x - y; });
      break;
    case code(AluType::Int, 3):
      map([](uint32_t x, uint32_t y) { return x * y; });
      break;
    case code(AluType::Int, 4):
      map([](uint32_t x, uint32_t y) { return x & y; });
      break;
    case code(AluType::Int, 5):
      map([](uint32_t x, uint32_t y) { return x | y; });
      break;
    case code(AluType::Int, 6):
      map([](uint32_t x, uint32_t y) { return x ^ y; });
      break;
    case code(AluType::Int, 7):
      map([](uint32_t x, uint32_t y) { return x << (y & 31); });
      break;
    case code(AluType::Int, 8):
      map([](uint32_t x, uint32_t y) { return x >> (y & 31); });
      break;
    case code(AluType::Int, 9):
      map([](uint32_t x, uint32_t y) { return static_cast<uint32_t>(as_signed(x) >> (y & 31)); });
      break;
    case code(AluType::Int, 10):
      map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? x : y; });
      break;
    case code(AluType::Int, 11):
      map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? y : x; });
      break;
    case code(AluType::Int, 12):
      map([](uint32_t x, uint32_t y) { return x < y ? x : y; });
      break;
    case code(AluType::Int, 13):
      map([](uint32_t x, uint32_t y) { return x < y ? y : x; });
      break;
    case code(AluType::Int, 14): {
      const uint32_t px = warp.predicates[instruction.x & 15];
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        if (mask >> lane & 1) rd[lane] = px >> lane & 1 ? a[lane] : b[lane];
      }
      break;
    }

    case code(AluType::Flt, 0):
      map([mode](uint32_t x, uint32_t y) { return arith::add(x, y, mode); });
      break;
    case code(AluType::Flt, 1):
      map([mode](uint32_t x, uint32_t y) { return arith::sub(x, y, mode); });
      break;
    case code(AluType::Flt, 2):
      map([mode](uint32_t x, uint32_t y) { return arith::mul(x, y, mode); });
      break;
    case code(AluType::Flt, 3):
      map([mode](uint32_t x, uint32_t y) { return arith::min(x, y, mode); });
      break;
    case code(AluType::Flt, 4):
      map([mode](uint32_t x, uint32_t y) { return arith::max(x, y, mode); });
      break;
    case code(AluType::Flt, 5):
      map([mode](uint32_t x, uint32_t) { return arith::to_int(x, mode); });
      break;
    case code(AluType::Flt, 6):
      map([mode](uint32_t x, uint32_t) { return arith::from_int(x, mode); });
      break;
    case code(AluType::Flt, 7):
      // A masked lane sees its own operands only, so rd may be one of them.
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        if (mask >> lane & 1) rd[lane] = arith::fma(a[lane], b[lane], c[lane], mode);
      }
      break;

    case code(AluType::Slw, 0):
      map([mode](uint32_t x, uint32_t y) { return arith::div(x, y, mode); });
      break;
    case code(AluType::Slw, 1):
      map([mode](uint32_t x, uint32_t) { return arith::sqrt(x, mode); });
      break;
    case code(AluType::Slw, 2):
      map([mode](uint32_t x, uint32_t) { return arith::rsqrt(x, mode); });
      break;
    case code(AluType::Slw, 3):
      map([mode](uint32_t x, uint32_t) { return arith::rcp(x, mode); });
      break;

    default:
      execute_class(instruction, warp, rd, a, b);
      break;
  }
}

// A type that the core does not know: lane by lane, so that rd may be a source.
void FunctionalCore::execute_class(const DecodedInstruction& instruction, Warp& warp, uint32_t* rd, const uint32_t* a,
                                   const uint32_t* b) {
  const AluModel& alu = *find_alu_model(instruction.info->unit);
  const uint32_t px = warp.predicates[instruction.x & 15], pb = warp.predicates[instruction.rb];
  uint32_t predicate = 0;
  for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
    const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(mask));
    const LaneTask task = {a[lane], b[lane], instruction.immediate, instruction.x, (px >> lane & 1) != 0, (pb >> lane & 1) != 0};
    const uint32_t value = alu.lane(instruction.info->operation, task, mode_);
    if (instruction.writes_register) rd[lane] = value;
    predicate |= (value & 1) << lane;
  }
  if (!instruction.writes_predicate) return;
  result_.predicate = predicate;
  if (instruction.rd != 0) warp.predicates[instruction.rd] = predicate;
}

// Loads and stores. All masked lanes are checked before any of them is served; misalignment is the first thing looked for.
template <int kLanes>
bool FunctionalCore::execute_memory(const DecodedInstruction& instruction, uint32_t* rd, const uint32_t* a, const uint32_t* b) {
  uint32_t* const addresses = result_.addresses.data();
  uint32_t low_bits = 0, highest = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    addresses[lane] = a[lane] + instruction.immediate;
    const uint32_t used = result_.mask >> lane & 1 ? addresses[lane] : 0;
    low_bits |= used & 3;
    highest = std::max(highest, used);
  }
  if (low_bits != 0) return fault(FaultCode::Misaligned);
  if (highest >= memory_limit_ && result_.mask != 0) return fault(FaultCode::AddressOutsideMemory);
  const bool store = instruction.code == code(AluType::Mem, 1);
  for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
    const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(mask));
    if (store) {
      memory_->store(addresses[lane], b[lane]);
      result_.stores[result_.store_count++] = {lane, addresses[lane], b[lane]};
    } else {
      rd[lane] = memory_->load(addresses[lane]);
    }
  }
  return true;
}

template <int kLanes>
bool FunctionalCore::execute_ray(const DecodedInstruction& instruction, Warp& warp, uint32_t* rd, const uint32_t* b) {
  const uint32_t number = result_.warp;
  switch (instruction.code) {
    case code(AluType::Ray, 0):  // rin
      if (!slices_.input_complete(number)) {
        result_.status = Step::Status::WaitsForImport;
        return false;
      }
      slices_.swap_input(number);
      return true;
    case code(AluType::Ray, 1):  // rout
    case code(AluType::Ray, 2):  // rfb
      if (warp.output_busy) {
        result_.status = Step::Status::WaitsForExport;
        return false;
      }
      slices_.swap_output(number);
      for (uint32_t mask = result_.mask; mask != 0; mask &= mask - 1) {
        const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(mask));
        if (instruction.code == code(AluType::Ray, 1)) {
          Ray& ray = result_.rays[result_.ray_count++];
          for (uint32_t word = 0; word < kRayWords; ++word) ray[word] = slices_.output(number, word)[lane];
        } else {
          FrameContribution& frame = result_.frame[result_.frame_count++];
          frame.pixel = slices_.output(number, word::kPixel)[lane];
          for (uint32_t i = 0; i < 3; ++i) frame.rgb[i] = slices_.output(number, word::kColor + i)[lane];
        }
      }
      return true;
    case code(AluType::Ray, 3):  // rld
      if (instruction.x >= kIntersectionWords) return fault(FaultCode::RayWordOutside);
      map_lanes<kLanes>(result_.mask, rd, slices_.current(number, instruction.x), b, [](uint32_t x, uint32_t) { return x; });
      return true;
    default:  // rst
      if (instruction.x >= kIntersectionWords) return fault(FaultCode::RayWordOutside);
      result_.ray_words = slices_.current(number, instruction.x);
      map_lanes<kLanes>(result_.mask, slices_.current(number, instruction.x), b, b, [](uint32_t x, uint32_t) { return x; });
      return true;
  }
}

}  // namespace raypool
