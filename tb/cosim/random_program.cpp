#include "cosim/random_program.hpp"

#include <algorithm>
#include <cstring>
#include <random>

#include "isa/encoding.hpp"

namespace raypool {
namespace {

constexpr uint32_t kRegionBytes = 2048;  ///< of a warp; several of them exceed the data cache
constexpr int kCounterRegisters = 10;    ///< r10, r11, r12 count loops; r13 is an address; r14 the shared, r15 the warp's region
constexpr int kLoopDepth = 3;
constexpr int kLoopPredicate = 13;  ///< p13, p14, p15 keep loops going

class Generator {
 public:
  Generator(const Configuration& configuration, uint64_t seed) : configuration_(configuration), random_(seed) {}

  RandomProgram make(int length) {
    RandomProgram result;
    with_import_ = chance(2);
    prologue();
    body(length, 0);
    emit("exit");
    for (const size_t caller : calls_) function(caller);

    result.program.code = code_;
    result.program.entries["main"] = 0;
    const uint32_t data = static_cast<uint32_t>((code_.size() * 8 + 63) / 64 * 64);
    const uint32_t regions = kRegionBytes * (static_cast<uint32_t>(configuration_.warps) + 1);
    result.memory.grow(data + regions);
    for (size_t i = 0; i < code_.size(); ++i) {
      result.memory.store(static_cast<uint32_t>(i * 8), static_cast<uint32_t>(code_[i]));
      result.memory.store(static_cast<uint32_t>(i * 8 + 4), static_cast<uint32_t>(code_[i] >> 32));
    }
    for (uint32_t a = data; a < data + regions; a += 4) result.memory.store(a, value());
    for (auto& word : result.arguments) word = value();
    result.arguments[0] = data;                 // read by every warp, written by none
    result.arguments[1] = data + kRegionBytes;  // regions of the warps
    const int kernels = 1 + below(3);
    for (int k = 0; k < kernels; ++k) {
      const uint32_t threads = chance(3) ? 1 + below(static_cast<uint32_t>(configuration_.contents()))
                                         : static_cast<uint32_t>(configuration_.contents());
      const ImportKind kind = with_import_ ? (chance(2) ? ImportKind::Normal : ImportKind::Shadow) : ImportKind::None;
      result.kernels.push_back({threads, value(), kind});
    }
    return result;
  }

 private:
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(random_() % n); }
  bool chance(uint32_t n) { return below(n) == 0; }

  /// A word: small, random, or a float at one of the edges.
  uint32_t value() {
    static constexpr uint32_t kSpecial[] = {0x00000000, 0x80000000, 0x3f800000, 0xbf800000, 0x7f800000, 0xff800000, 0x7fc00000,
                                            0x7f800001, 0x00000001, 0x807fffff, 0x00800000, 0x7f7fffff, 0x4f000000, 0xcf000000,
                                            0x3effffff, 0x4b7fffff, 0x7fffffff, 0xffffffff, 0x3f7fffff, 0x00ffffff};
    switch (below(5)) {
      case 0:
        return kSpecial[below(sizeof kSpecial / sizeof kSpecial[0])];
      case 1:
        return below(64);
      case 2:
        return static_cast<uint32_t>(random_());
      default: {
        const float f = (static_cast<float>(below(20001)) - 10000.0F) / static_cast<float>(1U << below(16));
        uint32_t bits = 0;
        std::memcpy(&bits, &f, 4);
        return bits;
      }
    }
  }

  size_t emit(const Instruction& i) {
    code_.push_back(encode(i));
    return code_.size() - 1;
  }
  size_t emit(std::string_view mnemonic, uint8_t rd = 0, uint8_t ra = 0, uint8_t rb = 0, uint8_t guard = 0) {
    Instruction i;
    i.info = &instruction(mnemonic);
    i.rd = rd, i.ra = ra, i.rb = rb, i.guard = guard;
    return emit(i);
  }
  size_t emit_immediate(std::string_view mnemonic, uint8_t rd, uint8_t ra, uint32_t immediate, uint8_t guard = 0) {
    Instruction i;
    i.info = &instruction(mnemonic);
    i.rd = rd, i.ra = ra, i.immediate = immediate, i.guard = guard;
    i.b_is_immediate = has_operand(*i.info, Operand::B);
    return emit(i);
  }
  void patch(size_t at, uint32_t immediate) {
    Instruction i = unpack(code_[at]);
    i.immediate = immediate;
    code_[at] = encode(i);
  }
  uint32_t here() const { return static_cast<uint32_t>(code_.size()); }

  uint8_t source() { return static_cast<uint8_t>(below(16)); }
  uint8_t destination() { return static_cast<uint8_t>(below(kCounterRegisters)); }
  uint8_t any_predicate() { return static_cast<uint8_t>(below(16)); }
  uint8_t destination_predicate() { return static_cast<uint8_t>(1 + below(kLoopPredicate - 1)); }

  void prologue() {
    for (uint8_t r = 0; r < kCounterRegisters; ++r)
      if (chance(3))
        emit("tid", r);
      else
        emit_immediate("mov", r, 0, value());
    for (uint8_t r = kCounterRegisters; r < kCounterRegisters + kLoopDepth; ++r) emit_immediate("mov", r, 0, 0);
    emit("warp", 13);
    emit_immediate("imul", 13, 13, kRegionBytes);
    emit_immediate("arg", 15, 0, 1);
    emit("iadd", 15, 15, 13);
    emit_immediate("arg", 14, 0, 0);
    if (with_import_) {
      emit("rin");
      written_words_ = 21;
    }
  }

  /// One instruction of the table with random operands, for all that touch neither memory, rays nor control.
  void plain() {
    const InstructionInfo* info = nullptr;
    do info = &kInstructions[below(std::size(kInstructions))];
    while (info->control || info->unit == Unit::Mem || info->unit == Unit::Ray);
    Instruction i;
    i.info = info;
    if (chance(3)) i.guard = any_predicate(), i.guard_negated = chance(2);
    i.rd = has_operand(*info, Operand::Pd) ? destination_predicate() : destination();
    i.ra = has_operand(*info, Operand::Ra) ? source() : 0;
    if (has_operand(*info, Operand::B) && chance(2))
      i.b_is_immediate = true, i.immediate = value();
    else if (has_operand(*info, Operand::B) || has_operand(*info, Operand::Rb))
      i.rb = source();
    if (has_operand(*info, Operand::Pb)) i.rb = any_predicate();
    if (has_operand(*info, Operand::Px)) i.x = any_predicate();
    if (has_operand(*info, Operand::Argument)) i.immediate = below(kArguments);
    emit(i);
  }

  /// r13 = an aligned address in the region at `base`: one for all lanes, neighbours, a stride, or anywhere.
  void address(uint8_t base) {
    switch (below(4)) {
      case 0:
        emit_immediate("mov", 13, 0, below(kRegionBytes / 4) * 4);
        break;
      case 1:
        emit("lane", 13);
        emit_immediate("shl", 13, 13, 2 + below(2) * below(5));
        break;
      default:
        emit("imul", 13, source(), source());
        break;
    }
    emit_immediate("and", 13, 13, (kRegionBytes - 1) & ~3U);
    emit("iadd", 13, 13, base);
  }

  void memory() {
    const bool own = chance(2);
    address(own ? 15 : 14);
    const int accesses = 1 + static_cast<int>(below(3));
    for (int n = 0; n < accesses; ++n) {
      const uint8_t guard = chance(2) ? any_predicate() : 0;
      if (own && chance(2))
        emit("st", 0, 13, source(), guard);
      else
        emit("ld", destination(), 13, 0, guard);
    }
  }

  void ray() {
    Instruction i;
    if (written_words_ > 0 && chance(2)) {
      i.info = &instruction("rld");
      i.rd = destination();
      i.x = static_cast<uint8_t>(below(static_cast<uint32_t>(written_words_)));
    } else if (written_words_ >= kRayWords && chance(3)) {
      i.info = &instruction(chance(3) ? "rfb" : "rout");
      if (chance(2)) i.guard = any_predicate(), i.guard_negated = chance(2);
      written_words_ = 0;
    } else {
      // Words are written from 0 up, unmasked the first time, so that nothing undefined is ever read or exported.
      const bool again = written_words_ > 0 && chance(3);
      const int count = again || written_words_ == 21 ? 1 : std::min(21 - written_words_, 1 + static_cast<int>(below(12)));
      for (int n = 0; n < count; ++n) {
        Instruction w;
        w.info = &instruction("rst");
        if (again || written_words_ == 21) {
          w.x = static_cast<uint8_t>(below(static_cast<uint32_t>(written_words_)));
          w.guard = any_predicate();
        } else {
          w.x = static_cast<uint8_t>(written_words_++);
        }
        if (chance(2))
          w.b_is_immediate = true, w.immediate = value();
        else
          w.rb = source();
        emit(w);
      }
      return;
    }
    emit(i);
  }

  void loop(int length, int depth) {
    const auto counter = static_cast<uint8_t>(kCounterRegisters + depth);
    const auto going = static_cast<uint8_t>(kLoopPredicate + depth);
    // Threads leave after different numbers of rounds.
    emit("lane", counter);
    emit_immediate("and", counter, counter, below(4));
    emit_immediate("iadd", counter, counter, below(2));
    emit_immediate("igt", going, counter, 0);
    const size_t start = emit("loop", 0, 0, 0, going);
    body(length, depth + 1);
    emit_immediate("isub", counter, counter, 1, going);
    emit_immediate("igt", going, counter, 0);
    patch(start, here());
  }

  void jump() {
    Instruction i;
    i.info = &instruction(chance(2) ? "jany" : "jnone");
    i.guard = any_predicate(), i.guard_negated = chance(2);
    const size_t at = emit(i);
    const int skipped = 1 + static_cast<int>(below(4));
    for (int n = 0; n < skipped; ++n) plain();
    patch(at, here());
  }

  void body(int length, int depth) {
    const size_t end = code_.size() + static_cast<size_t>(length);
    while (code_.size() < end) {
      const uint32_t kind = below(20);
      // Ray rotation inside a loop body could run an unknown number of times; it stays at the top level.
      if (kind == 0 && depth < kLoopDepth && length > 12)
        loop(length / 3, depth);
      else if (kind == 1)
        jump();
      else if (kind == 2)
        calls_.push_back(emit("call"));
      else if (kind < 6)
        memory();
      else if (kind < 9 && depth == 0)
        ray();
      else
        plain();
    }
  }

  void function(size_t caller) {
    const uint32_t start = here();
    const int length = 1 + static_cast<int>(below(6));
    for (int n = 0; n < length; ++n) plain();
    if (chance(2)) emit("ret");
    patch(caller, start | here() << 16);
  }

  Configuration configuration_;
  std::mt19937_64 random_;
  std::vector<uint64_t> code_;
  std::vector<size_t> calls_;
  bool with_import_ = false;
  int written_words_ = 0;  ///< words 0 .. n-1 of the current slice are defined
};

}  // namespace

RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length) {
  return Generator(configuration, seed).make(length);
}

}  // namespace raypool
