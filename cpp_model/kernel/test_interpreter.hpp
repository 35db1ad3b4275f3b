// For tests: runs machine code of one warp on one ray slice, written from docs/machine/isa.md,
// docs/machine/architecture.md and docs/machine/memory.md alone.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "arith/arith.hpp"
#include "isa/encoding.hpp"
#include "isa/program.hpp"
#include "kernel/native.hpp"

namespace raypool::test {

/// Data caches of several units, which do not see each other's stores; those of a unit reach the memory when it has to
/// read there, which is as late as can be.
class UnitCaches {
 public:
  explicit UnitCaches(uint32_t units) : units_(units) {}

  uint32_t load(Memory& memory, uint32_t unit, uint32_t address) {
    auto& lines = units_.at(unit).lines;
    const auto [found, is_new] = lines.try_emplace(address / kLineBytes);
    if (is_new) {
      drain(memory, unit);
      for (uint32_t i = 0; i < found->second.size(); ++i)
        found->second[i] = memory.load(found->first * kLineBytes + 4 * i);
    }
    return found->second[address % kLineBytes / 4];
  }
  void store(uint32_t unit, uint32_t address, uint32_t value) {
    const auto line = units_.at(unit).lines.find(address / kLineBytes);
    if (line != units_[unit].lines.end()) line->second[address % kLineBytes / 4] = value;
    units_[unit].stores.emplace_back(address, value);
  }
  void inval(uint32_t unit, uint32_t address) { units_.at(unit).lines.erase(address / kLineBytes); }
  void drain(Memory& memory, uint32_t unit) {
    for (const auto& [address, value] : units_.at(unit).stores) memory.store(address, value);
    units_[unit].stores.clear();
  }

 private:
  static constexpr uint32_t kLineBytes = 64;
  struct Unit {
    std::map<uint32_t, std::array<uint32_t, kLineBytes / 4>> lines;
    std::vector<std::pair<uint32_t, uint32_t>> stores;  // address, value
  };
  std::vector<Unit> units_;
};

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
  UnitCaches* caches = nullptr;  ///< null: there is one unit, whose cache shows in nothing
  uint32_t unit = 0;             ///< that runs the warp

  void run(const Program& program, uint32_t entry) {
    // Both above zero and below, as integers.
    for (size_t lane = 0; lane < registers_.size(); ++lane)
      registers_[lane].fill(lane % 2 == 0 ? 0xbad0bad0u : 0x0bad0badu);
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
      const Opcode opcode = op.info->opcode;
      mask_ = predicates_[op.guard];
      if (op.guard_negated) mask_ = ~mask_ & kAll;
      mask_ &= threads >= kLanes ? kAll : (1u << threads) - 1;
      ++stack.back().pc;
      if (opcode == Opcode::Exit) return;
      if (opcode == Opcode::Jnone || opcode == Opcode::Jany) {
        if ((mask_ != 0) == (opcode == Opcode::Jany)) stack.back().pc = op.immediate & 0xffff;
      } else if (opcode == Opcode::Loop) {
        const uint32_t end = op.immediate & 0xffff;
        stack.back().pc = mask_ != 0 ? pc : end;
        if (mask_ != 0) stack.push_back({pc + 1, end});
        if (stack.size() > 8) throw std::runtime_error("PC stack overflow");
      } else if (opcode == Opcode::Rout || opcode == Opcode::Rfb) {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
          if (active(lane)) send(lane, opcode == Opcode::Rout);
          words_[lane].fill(kernel::kUndefinedWord);
        }
      } else if (opcode == Opcode::Rin) {
        words_ = input;
      } else {
        uint32_t predicate = 0;
        for (int e = 0; e < (is_triple(*op.info) ? 3 : 1); ++e) {
          const Instruction element = is_triple(*op.info) ? element_of(op, e) : op;
          for (uint32_t lane = 0; lane < kLanes; ++lane) {
            if (active(lane) && data(element, lane)) predicate |= 1u << lane;
          }
        }
        if (writes_predicate(*op.info) && op.rd != 0) predicates_[op.rd] = predicate;
      }
    }
    throw std::runtime_error("the program does not end");
  }

 private:
  static Instruction element_of(const Instruction& triple, int e) {
    const std::string_view name = triple.info->mnemonic;
    const bool one_ra = name.back() == 's';
    const AluType type = triple.info->alu();
    const auto next = [e](uint8_t number) { return static_cast<uint8_t>((number + e) % 16); };
    Instruction op = triple;
    op.info = find_instruction(name.substr(0, name.size() - (one_ra ? 2 : 1)));
    op.rd = next(triple.rd);
    if (!one_ra && type != AluType::Mem) op.ra = next(triple.ra);
    op.rb = next(triple.rb);
    op.x = type == AluType::Ray ? static_cast<uint8_t>(triple.x + e) : next(triple.x);
    if (type == AluType::Tid) op.immediate += e;
    if (type == AluType::Mem) op.immediate += 4 * e;
    return op;
  }

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
    const Opcode opcode = op.info->opcode;
    auto& reg = registers_[lane];
    const uint32_t a = reg[op.ra];
    const uint32_t b = op.b_is_immediate ? op.immediate : reg[op.rb];
    const auto sa = static_cast<int32_t>(a);
    const auto sb = static_cast<int32_t>(b);
    const auto predicate = [&](int number) { return (predicates_[number] >> lane & 1) != 0; };
    const bool px = predicate(op.x & 15);
    if (opcode == Opcode::Ieq) return a == b;
    if (opcode == Opcode::Ine) return a != b;
    if (opcode == Opcode::Ilt) return sa < sb;
    if (opcode == Opcode::Ile) return sa <= sb;
    if (opcode == Opcode::Igt) return sa > sb;
    if (opcode == Opcode::Ige) return sa >= sb;
    if (opcode == Opcode::Ult) return a < b;
    if (opcode == Opcode::Ule) return a <= b;
    if (opcode == Opcode::Ugt) return a > b;
    if (opcode == Opcode::Uge) return a >= b;
    if (opcode == Opcode::Feq) return arith::equal(a, b, mode);
    if (opcode == Opcode::Fne) return arith::not_equal(a, b, mode);
    if (opcode == Opcode::Flt) return arith::less(a, b, mode);
    if (opcode == Opcode::Fle) return arith::less_equal(a, b, mode);
    if (opcode == Opcode::Fgt) return arith::greater(a, b, mode);
    if (opcode == Opcode::Fge) return arith::greater_equal(a, b, mode);
    if (opcode == Opcode::Pand) return px && predicate(op.rb);
    if (opcode == Opcode::Por) return px || predicate(op.rb);
    if (opcode == Opcode::Pxor) return px != predicate(op.rb);
    if (opcode == Opcode::Pandn) return px && !predicate(op.rb);
    if (opcode == Opcode::St) {
      if (caches == nullptr)
        memory.store(a + op.immediate, b);
      else
        caches->store(unit, a + op.immediate, b);
      return false;
    }
    if (opcode == Opcode::Inval) {
      if (caches != nullptr) caches->inval(unit, a + op.immediate);
      return false;
    }
    if (opcode == Opcode::Ld) {
      const uint32_t address = a + op.immediate;
      reg[op.rd] = caches == nullptr ? memory.load(address) : caches->load(memory, unit, address);
      return false;
    }
    if (opcode == Opcode::Rst) {
      words_[lane].at(op.x) = b;
      return false;
    }
    reg[op.rd] = value(opcode, op, lane, a, b, px);
    return false;
  }

  uint32_t value(Opcode opcode, const Instruction& op, uint32_t lane, uint32_t a, uint32_t b, bool px) const {
    const auto sa = static_cast<int32_t>(a);
    const auto sb = static_cast<int32_t>(b);
    if (opcode == Opcode::Tid || opcode == Opcode::Lane) return lane;
    if (opcode == Opcode::Warp) return 0;
    if (opcode == Opcode::Block) return block;
    if (opcode == Opcode::Threads) return threads;
    if (opcode == Opcode::Blocks) return blocks;
    if (opcode == Opcode::Unit) return unit;
    if (opcode == Opcode::Arg) return arguments.at(op.immediate);
    if (opcode == Opcode::Rld) return words_[lane].at(op.x);
    if (opcode == Opcode::Mov) return b;
    if (opcode == Opcode::Iadd) return a + b;
    if (opcode == Opcode::Isub) return a - b;
    if (opcode == Opcode::Imul) return a * b;
    if (opcode == Opcode::And) return a & b;
    if (opcode == Opcode::Or) return a | b;
    if (opcode == Opcode::Xor) return a ^ b;
    if (opcode == Opcode::Shl) return a << (b & 31);
    if (opcode == Opcode::Shr) return a >> (b & 31);
    if (opcode == Opcode::Sar) return static_cast<uint32_t>(sa >> (b & 31));
    if (opcode == Opcode::Imin) return sa < sb ? a : b;
    if (opcode == Opcode::Imax) return sa > sb ? a : b;
    if (opcode == Opcode::Umin) return a < b ? a : b;
    if (opcode == Opcode::Umax) return a > b ? a : b;
    if (opcode == Opcode::Sel) return px ? a : b;
    if (opcode == Opcode::Fadd) return arith::add(a, b, mode);
    if (opcode == Opcode::Fsub) return arith::sub(a, b, mode);
    if (opcode == Opcode::Fmul) return arith::mul(a, b, mode);
    if (opcode == Opcode::Ffma) return arith::fma(a, b, registers_[lane][op.x], mode);
    if (opcode == Opcode::Fmin) return arith::min(a, b, mode);
    if (opcode == Opcode::Fmax) return arith::max(a, b, mode);
    if (opcode == Opcode::F2i) return arith::to_int(a, mode);
    if (opcode == Opcode::I2f) return arith::from_int(a, mode);
    if (opcode == Opcode::Fdiv) return arith::div(a, b, mode);
    if (opcode == Opcode::Fsqrt) return arith::sqrt(a, mode);
    if (opcode == Opcode::Frsqrt) return arith::rsqrt(a, mode);
    if (opcode == Opcode::Frcp) return arith::rcp(a, mode);
    throw std::runtime_error("instruction unknown to the test: " + std::string(op.info->mnemonic));
  }

  std::array<std::array<uint32_t, kRegisters>, kLanes> registers_{};
  std::array<uint32_t, kPredicates> predicates_{};
  std::array<Intersection, kLanes> words_{};
  uint32_t mask_ = 0;
};

}  // namespace raypool::test
