// What the data ALUs compute of the lanes of a warp, all lanes at once.
#pragma once

#include <cstdint>
#include <cstring>

#include "arith/arith.hpp"
#include "isa/isa.hpp"

namespace raypool {

/// The operands of an instruction of one warp: a word a lane of each register.
template <int kLanes>
struct Lanes {
  static constexpr uint32_t kAll = kLanes == 32 ? 0xffffffffu : (1u << kLanes) - 1;

  uint32_t mask;
  uint32_t* rd;
  const uint32_t *a, *b, *c;

  /// rd = f(a, b) in the masked lanes. The full mask is the common case: through an array of its own, so that the compiler need
  /// not care whether rd is also a source.
  template <typename Function>
  void map(Function function) const {
    if (mask == kAll) {
      uint32_t values[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) values[lane] = function(a[lane], b[lane]);
      std::memcpy(rd, values, sizeof(values));
    } else {
      for (uint32_t left = mask; left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        rd[lane] = function(a[lane], b[lane]);
      }
    }
  }

  /// The same of each lane by itself. It sees its own operands only, so rd may be one of them.
  template <typename Function>
  void each(Function function) const {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      if (mask >> lane & 1) rd[lane] = function(lane);
    }
  }

  /// rd = first, first + 1, ...
  void number(uint32_t first) const {
    each([first](uint32_t lane) { return first + lane; });
  }

  /// The lanes, masked or not, in which f(a, b) is true.
  template <typename Function>
  uint32_t test(Function function) const {
    uint32_t result = 0;
    for (int lane = 0; lane < kLanes; ++lane) result |= static_cast<uint32_t>(function(a[lane], b[lane])) << lane;
    return result;
  }
};

/// A row of the table without a case: names it and says where the case belongs.
[[noreturn]] void not_modelled(Opcode opcode);

inline int32_t as_signed(uint32_t value) { return static_cast<int32_t>(value); }

/// Brh: compares, and logic of the predicates px and pb.
template <int kLanes>
uint32_t compare(Opcode opcode, const Lanes<kLanes>& lanes, uint32_t px, uint32_t pb, arith::Mode mode) {
  switch (opcode) {
    case Opcode::Ieq:
      return lanes.test([](uint32_t x, uint32_t y) { return x == y; });
    case Opcode::Ine:
      return lanes.test([](uint32_t x, uint32_t y) { return x != y; });
    case Opcode::Ilt:
      return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y); });
    case Opcode::Ile:
      return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) <= as_signed(y); });
    case Opcode::Igt:
      return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) > as_signed(y); });
    case Opcode::Ige:
      return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) >= as_signed(y); });
    case Opcode::Ult:
      return lanes.test([](uint32_t x, uint32_t y) { return x < y; });
    case Opcode::Ule:
      return lanes.test([](uint32_t x, uint32_t y) { return x <= y; });
    case Opcode::Ugt:
      return lanes.test([](uint32_t x, uint32_t y) { return x > y; });
    case Opcode::Uge:
      return lanes.test([](uint32_t x, uint32_t y) { return x >= y; });
    case Opcode::Feq:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::equal(x, y, mode); });
    case Opcode::Fne:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::not_equal(x, y, mode); });
    case Opcode::Flt:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::less(x, y, mode); });
    case Opcode::Fle:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::less_equal(x, y, mode); });
    case Opcode::Fgt:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::greater(x, y, mode); });
    case Opcode::Fge:
      return lanes.test([mode](uint32_t x, uint32_t y) { return arith::greater_equal(x, y, mode); });
    case Opcode::Pand:
      return px & pb;
    case Opcode::Por:
      return px | pb;
    case Opcode::Pxor:
      return px ^ pb;
    case Opcode::Pandn:
      return px & ~pb;
    default:
      not_modelled(opcode);
  }
}

template <int kLanes>
void integer(Opcode opcode, const Lanes<kLanes>& lanes, uint32_t px) {
  switch (opcode) {
    case Opcode::Mov:
      return lanes.map([](uint32_t, uint32_t y) { return y; });
    case Opcode::Iadd:
      return lanes.map([](uint32_t x, uint32_t y) { return x + y; });
    case Opcode::Isub:
      return lanes.map([](uint32_t x, uint32_t y) { return x - y; });
    case Opcode::Imul:
      return lanes.map([](uint32_t x, uint32_t y) { return x * y; });
    case Opcode::And:
      return lanes.map([](uint32_t x, uint32_t y) { return x & y; });
    case Opcode::Or:
      return lanes.map([](uint32_t x, uint32_t y) { return x | y; });
    case Opcode::Xor:
      return lanes.map([](uint32_t x, uint32_t y) { return x ^ y; });
    case Opcode::Shl:
      return lanes.map([](uint32_t x, uint32_t y) { return x << (y & 31); });
    case Opcode::Shr:
      return lanes.map([](uint32_t x, uint32_t y) { return x >> (y & 31); });
    case Opcode::Sar:
      return lanes.map([](uint32_t x, uint32_t y) { return static_cast<uint32_t>(as_signed(x) >> (y & 31)); });
    case Opcode::Imin:
      return lanes.map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? x : y; });
    case Opcode::Imax:
      return lanes.map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? y : x; });
    case Opcode::Umin:
      return lanes.map([](uint32_t x, uint32_t y) { return x < y ? x : y; });
    case Opcode::Umax:
      return lanes.map([](uint32_t x, uint32_t y) { return x < y ? y : x; });
    case Opcode::Sel:
      return lanes.each([&](uint32_t lane) { return px >> lane & 1 ? lanes.a[lane] : lanes.b[lane]; });
    default:
      not_modelled(opcode);
  }
}

template <int kLanes>
void floating(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode) {
  switch (opcode) {
    case Opcode::Fadd:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::add(x, y, mode); });
    case Opcode::Fsub:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::sub(x, y, mode); });
    case Opcode::Fmul:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::mul(x, y, mode); });
    case Opcode::Fmin:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::min(x, y, mode); });
    case Opcode::Fmax:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::max(x, y, mode); });
    case Opcode::F2i:
      return lanes.map([mode](uint32_t x, uint32_t) { return arith::to_int(x, mode); });
    case Opcode::I2f:
      return lanes.map([mode](uint32_t x, uint32_t) { return arith::from_int(x, mode); });
    case Opcode::Ffma:
      return lanes.each([&](uint32_t lane) { return arith::fma(lanes.a[lane], lanes.b[lane], lanes.c[lane], mode); });
    default:
      not_modelled(opcode);
  }
}

template <int kLanes>
void slow(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode) {
  switch (opcode) {
    case Opcode::Fdiv:
      return lanes.map([mode](uint32_t x, uint32_t y) { return arith::div(x, y, mode); });
    case Opcode::Fsqrt:
      return lanes.map([mode](uint32_t x, uint32_t) { return arith::sqrt(x, mode); });
    case Opcode::Frsqrt:
      return lanes.map([mode](uint32_t x, uint32_t) { return arith::rsqrt(x, mode); });
    case Opcode::Frcp:
      return lanes.map([mode](uint32_t x, uint32_t) { return arith::rcp(x, mode); });
    default:
      not_modelled(opcode);
  }
}

}  // namespace raypool
