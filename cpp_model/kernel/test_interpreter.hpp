// For tests: runs machine code of one warp on one ray slice, written from docs/isa.md and docs/architecture.md alone.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "arith/arith.hpp"
#include "isa/encoding.hpp"
#include "isa/program.hpp"
#include "kernel/native.hpp"

namespace raypool::test {

class Interpreter {
 public:
  static constexpr uint32_t kLanes = 8;
  static constexpr uint32_t kAll = (1u << kLanes) - 1;

  uint32_t threads = kLanes, block = 0, blocks = 1;
  std::array<uint32_t, kArguments> arguments{};
  Memory memory;
  arith::Mode mode;
  std::array<Intersection, kLanes> input{};
  std::array<std::vector<Ray>, kLanes> rays;
  std::array<std::vector<FrameContribution>, kLanes> frame;
  uint64_t executed = 0;

  void run(const Program& program, uint32_t entry) {
    for (auto& lane : registers_) lane.fill(0xbad0bad0u);
    predicates_.fill(0);
    predicates_[0] = kAll;
    struct Entry {
      uint32_t pc, rpc;
    };
    std::vector<Entry> stack = {{entry, 0xffff}};
    for (executed = 0; executed < 1000000; ++executed) {
      while (stack.back().pc >= stack.back().rpc) stack.pop_back();
      const uint32_t pc = stack.back().pc;
      const Instruction op = unpack(program.code.at(pc));
      const std::string_view name = op.info->mnemonic;
      mask_ = predicates_[op.guard];
      if (op.guard_negated) mask_ = ~mask_ & kAll;
      mask_ &= threads >= kLanes ? kAll : (1u << threads) - 1;
      ++stack.back().pc;
      if (name == "exit") return;
      if (name == "jnone" || name == "jany") {
        if ((mask_ != 0) == (name == "jany")) stack.back().pc = op.immediate & 0xffff;
      } else if (name == "loop") {
        const uint32_t end = op.immediate & 0xffff;
        stack.back().pc = mask_ != 0 ? pc : end;
        if (mask_ != 0) stack.push_back({pc + 1, end});
        if (stack.size() > 8) throw std::runtime_error("PC stack overflow");
      } else if (name == "rout" || name == "rfb") {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
          if (active(lane)) send(lane, name == "rout");
          words_[lane].fill(kernel::kUndefinedWord);
        }
      } else if (name == "rin") {
        words_ = input;
      } else {
        uint32_t predicate = 0;
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
          if (active(lane) && data(op, lane)) predicate |= 1u << lane;
        }
        if (writes_predicate(*op.info) && op.rd != 0) predicates_[op.rd] = predicate;
      }
    }
    throw std::runtime_error("the program does not end");
  }

 private:
  bool active(uint32_t lane) const { return (mask_ >> lane & 1) != 0; }

  void send(uint32_t lane, bool to_pool) {
    const Intersection& words = words_[lane];
    Ray ray;
    std::copy_n(words.begin(), ray.size(), ray.begin());
    if (to_pool)
      rays[lane].push_back(ray);
    else
      frame[lane].push_back({words[7], {words[8], words[9], words[10]}});
  }

  /// One lane of an instruction; returns the bit for a predicate.
  bool data(const Instruction& op, uint32_t lane) {
    const std::string_view name = op.info->mnemonic;
    auto& reg = registers_[lane];
    const uint32_t a = reg[op.ra];
    const uint32_t b = op.b_is_immediate ? op.immediate : reg[op.rb];
    const auto sa = static_cast<int32_t>(a);
    const auto sb = static_cast<int32_t>(b);
    const auto predicate = [&](int number) { return (predicates_[static_cast<size_t>(number)] >> lane & 1) != 0; };
    const bool px = predicate(op.x & 15);
    if (name == "ieq") return a == b;
    if (name == "ine") return a != b;
    if (name == "ilt") return sa < sb;
    if (name == "ile") return sa <= sb;
    if (name == "igt") return sa > sb;
    if (name == "ige") return sa >= sb;
    if (name == "ult") return a < b;
    if (name == "ule") return a <= b;
    if (name == "ugt") return a > b;
    if (name == "uge") return a >= b;
    if (name == "feq") return arith::equal(a, b, mode);
    if (name == "fne") return arith::not_equal(a, b, mode);
    if (name == "flt") return arith::less(a, b, mode);
    if (name == "fle") return arith::less_equal(a, b, mode);
    if (name == "fgt") return arith::greater(a, b, mode);
    if (name == "fge") return arith::greater_equal(a, b, mode);
    if (name == "pand") return px && predicate(op.rb);
    if (name == "por") return px || predicate(op.rb);
    if (name == "pxor") return px != predicate(op.rb);
    if (name == "pandn") return px && !predicate(op.rb);
    if (name == "st") {
      memory.store(a + op.immediate, b);
      return false;
    }
    if (name == "rst") {
      words_[lane].at(op.x) = b;
      return false;
    }
    reg[op.rd] = value(name, op, lane, a, b, px);
    return false;
  }

  uint32_t value(std::string_view name, const Instruction& op, uint32_t lane, uint32_t a, uint32_t b, bool px) const {
    const auto sa = static_cast<int32_t>(a);
    const auto sb = static_cast<int32_t>(b);
    if (name == "tid" || name == "lane") return lane;
    if (name == "warp") return 0;
    if (name == "block") return block;
    if (name == "threads") return threads;
    if (name == "blocks") return blocks;
    if (name == "arg") return arguments.at(op.immediate);
    if (name == "ld") return memory.load(a + op.immediate);
    if (name == "rld") return words_[lane].at(op.x);
    if (name == "mov") return b;
    if (name == "iadd") return a + b;
    if (name == "isub") return a - b;
    if (name == "imul") return a * b;
    if (name == "and") return a & b;
    if (name == "or") return a | b;
    if (name == "xor") return a ^ b;
    if (name == "shl") return a << (b & 31);
    if (name == "shr") return a >> (b & 31);
    if (name == "sar") return static_cast<uint32_t>(sa >> (b & 31));
    if (name == "imin") return sa < sb ? a : b;
    if (name == "imax") return sa > sb ? a : b;
    if (name == "umin") return a < b ? a : b;
    if (name == "umax") return a > b ? a : b;
    if (name == "sel") return px ? a : b;
    if (name == "fadd") return arith::add(a, b, mode);
    if (name == "fsub") return arith::sub(a, b, mode);
    if (name == "fmul") return arith::mul(a, b, mode);
    if (name == "ffma") return arith::fma(a, b, registers_[lane][op.x], mode);
    if (name == "fmin") return arith::min(a, b, mode);
    if (name == "fmax") return arith::max(a, b, mode);
    if (name == "f2i") return arith::to_int(a, mode);
    if (name == "i2f") return arith::from_int(a, mode);
    if (name == "fdiv") return arith::div(a, b, mode);
    if (name == "fsqrt") return arith::sqrt(a, mode);
    if (name == "frsqrt") return arith::rsqrt(a, mode);
    if (name == "frcp") return arith::rcp(a, mode);
    throw std::runtime_error("instruction unknown to the test: " + std::string(name));
  }

  std::array<std::array<uint32_t, kRegisters>, kLanes> registers_{};
  std::array<uint32_t, kPredicates> predicates_{};
  std::array<Intersection, kLanes> words_{};
  uint32_t mask_ = 0;
};

}  // namespace raypool::test
