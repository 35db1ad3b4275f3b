#include "cosim/random_program.hpp"

#include <algorithm>
#include <cstring>

#include "cosim/program_emitter.hpp"
#include "cosim/program_profile.hpp"

namespace raypool {
namespace {

// r0 .. r9 hold data. r10 .. r12 count loops, r13 is an address, r14 the base of what is only read, r15 of the warp's own words.
constexpr int kDataRegisters = 10;
constexpr int kLoopDepth = 3;
constexpr int kAddress = 13, kShared = 14, kOwn = 15;
// p1 .. p12 are free, p13 .. p15 keep loops going.
constexpr int kLoopPredicate = 13;
constexpr uint32_t kMostDataBytes = 384 * 1024;
constexpr uint32_t kMostInstructions = 60000;
constexpr uint32_t kFarLimit = 20000;
constexpr int kMostCalls = 40;

/// Where a warp's own words lie: word e of warp w at base + ((e << shift) + w * stride).
struct OwnWords {
  uint32_t entries = 64;  ///< power of two
  uint32_t shift = 2;
  uint32_t stride = 256;
  uint32_t way_entries = 64;  ///< words of that many entries apart lie in one set of the data cache
  uint32_t bytes = 0;         ///< of all warps
};

class Generator : public ProgramEmitter {
 public:
  Generator(const Configuration& configuration, uint64_t seed, int units)
      : ProgramEmitter(seed),
        configuration_(configuration),
        warps_(static_cast<uint32_t>(configuration.warps)),
        stack_depth_(configuration.stack_depth),
        profile_(kProgramProfiles[seed % std::size(kProgramProfiles)]) {
    result_.seed = seed;
    result_.profile = std::string(profile_.name);
    result_.units = units;
    // Kernels of different units run at the same time, so that each must have words of its own.
    kernels_ = 1 + below(profile_.most_kernels + (units > 1 ? 3 * static_cast<uint32_t>(units) : 0));
    if (units > 1)
      while (block_mask_ + 1 < kernels_) block_mask_ = block_mask_ * 2 + 1;
  }

  RandomProgram make(int length) {
    choose_layout();
    if (chance(16)) result_.fault = static_cast<FaultCode>(1 + below(7));
    const int body_length = std::max(4, length * static_cast<int>(profile_.length_percent) / 100);
    if (chance(6)) filler(1 + below(chance(3) ? kFarLimit : 300));  // the program need not begin at 0
    entry("main", body_length);
    if (profile_.most_kernels > 1 && result_.fault == FaultCode::None && chance(2)) entry("second", body_length / 2);
    result_.program.code = code_;
    choose_data();
    choose_kernels();
    choose_stalls();
    fill_memory(result_);
    return result_;
  }

 private:
  void choose_layout() {
    const uint32_t way = static_cast<uint32_t>(configuration_.data_cache_bytes) / 2;
    uint32_t warp_bits = 0;
    while ((1u << warp_bits) < warps_) ++warp_bits;
    if (chance(2)) {
      // Words of the warps in turn: lines, misses and quadwords are shared between warps.
      own_.shift = 2 + warp_bits;
      own_.stride = 4;
    } else {
      own_.shift = 2;
    }
    const uint32_t spread = own_.shift == 2 ? warps_ * 4 : 4 * warps_;  // bytes of memory an entry costs
    own_.entries = 64u << below(4);
    own_.way_entries = std::max(1u, way >> own_.shift);
    if (chance(2)) own_.entries = std::max(own_.entries, own_.way_entries * 4);  // lines of one set collide
    while (own_.entries > 64 && own_.entries * spread * (block_mask_ + 1) > 2 * kMostDataBytes) own_.entries /= 2;
    own_.bytes = own_.entries * spread;
    if (own_.shift == 2) own_.stride = own_.entries * 4;
    shared_bytes_ = 1024u << below(4);
  }

  void choose_data() {
    // A gap, so that addresses have other upper bits in every program.
    const uint32_t code_bytes = static_cast<uint32_t>(code_.size()) * 8;
    result_.data_begin = (code_bytes + 63) / 64 * 64 + (chance(4) ? below(1u << (6 + below(9))) * 64u : 0);
    result_.memory_bytes = result_.data_begin + shared_bytes_ + own_.bytes * (1 + block_mask_);
    for (auto& word : result_.arguments) word = value();
    result_.arguments[0] = result_.data_begin;
    result_.arguments[1] = result_.data_begin + shared_bytes_;
  }

  void choose_kernels() {
    const auto contents = static_cast<uint32_t>(configuration_.contents());
    const auto lanes = static_cast<uint32_t>(configuration_.cores);
    for (uint32_t k = 0; k < kernels_; ++k) {
      uint32_t threads = contents;
      switch (below(6)) {
        case 0:
          threads = 1 + below(contents);
          break;
        case 1:
          threads = std::min(contents, lanes + 1);
          break;
        case 2:
          threads = chance(2) ? 1 : lanes;
          break;
        default:
          break;
      }
      const Entry& entry = entries_[below(static_cast<uint32_t>(entries_.size()))];
      const ImportKind import = !entry.import ? ImportKind::None : chance(2) ? ImportKind::Normal : ImportKind::Shadow;
      const uint32_t block = result_.units > 1 ? (value() & ~block_mask_) | k : value();
      result_.kernels.push_back({threads, block, import, entry.pc});
    }
  }

  void choose_stalls() {
    const bool calm = chance(4);
    for (auto& style : result_.stalls.styles) style = calm ? StallStyle::None : static_cast<StallStyle>(below(kStallStyles));
  }

  // ---- A kernel

  struct Entry {
    uint32_t pc;
    bool import;
  };
  struct Call {
    size_t at;
    int loops, entries;
  };

  void entry(const char* name, int length) {
    const bool import = chance(2);
    result_.program.entries[name] = here();
    entries_.push_back({here(), import});
    import_pending_ = import;
    written_words_ = 0;
    prologue();
    if (import && !chance(3)) take_import();
    body(length / 2, 0, 1);
    if (import_pending_) take_import();
    if (result_.fault != FaultCode::None) fault();
    if (runs_out_) return;
    body(length - length / 2, 0, 1);
    emit("exit", 0, 0, 0, control_guard());
    functions();
  }

  void prologue() {
    for (int r = 0; r < kDataRegisters; ++r) {
      if (chance(3))
        emit("tid", r);
      else
        emit_immediate("mov", r, 0, value());
    }
    for (int r = kDataRegisters; r < kDataRegisters + kLoopDepth; ++r) emit_immediate("mov", r, 0, 0);
    // Another kernel's warp may have written the words that this one's warp gets.
    emit("warp", kAddress);
    if (chance(2)) emit_immediate("xor", kAddress, kAddress, below(warps_));
    emit_immediate("imul", kAddress, kAddress, own_.stride);
    emit_immediate("arg", kOwn, 0, 1);
    emit("iadd", kOwn, kOwn, kAddress);
    emit("block", kAddress);
    emit_immediate("and", kAddress, kAddress, block_mask_);
    emit_immediate("imul", kAddress, kAddress, own_.bytes);
    emit("iadd", kOwn, kOwn, kAddress);
    emit_immediate("arg", kShared, 0, 0);
  }

  void take_import() {
    emit("rin", 0, 0, 0, control_guard());
    import_pending_ = false;
    written_words_ = kIntersectionWords;
  }

  // ---- Statements

  /// `entries`: entries of the PC stack in use.
  void body(int length, int loops, int entries) {
    const size_t end = code_.size() + static_cast<size_t>(std::max(1, length));
    const ProgramProfile& p = profile_;
    const uint32_t total = p.plain + p.memory + p.ray + p.loop + p.jump + p.call + p.far + p.early_exit;
    while (code_.size() < end) {
      uint32_t kind = below(total);
      const auto is = [&kind](uint32_t weight) {
        if (kind < weight) return true;
        kind -= weight;
        return false;
      };
      if (is(p.memory)) {
        memory();
      } else if (is(p.ray)) {
        ray(loops == 0 && entries == 1 && !in_function_);
      } else if (is(p.loop)) {
        if (loops < kLoopDepth && entries < stack_depth_ && length > 8) loop(length / 3, loops, entries);
      } else if (is(p.jump)) {
        jump(loops, entries);
      } else if (is(p.call)) {
        call(loops, entries);
      } else if (is(p.far)) {
        far_jump();
      } else if (is(p.early_exit)) {
        if (!import_pending_ && !in_function_) early_exit();
      } else {
        plain();
      }
    }
  }

  int source() { return static_cast<int>(below(16)); }
  int destination() { return static_cast<int>(below(kDataRegisters)); }
  int any_predicate() { return static_cast<int>(below(16)); }
  /// These instructions do what they do whatever their mask is.
  int control_guard() { return chance(3) ? any_predicate() : 0; }
  int free_predicate() { return 1 + static_cast<int>(below(kLoopPredicate - 1)); }

  const InstructionInfo& plain_row() {
    uint32_t total = 0;
    for (const uint32_t weight : profile_.units) total += weight;
    uint32_t pick = below(total);
    size_t unit = 0;
    while (pick >= profile_.units[unit]) pick -= profile_.units[unit++];
    for (;;) {
      const InstructionInfo& info = kInstructions[below(std::size(kInstructions))];
      if (static_cast<size_t>(info.unit) == unit && !info.control && configuration_.has(info.needs)) return info;
    }
  }

  /// One instruction that touches neither memory, rays nor control, with random operands.
  void plain() {
    Instruction i;
    i.info = &plain_row();
    const InstructionInfo& info = *i.info;
    if (percent(profile_.guarded_percent)) i.guard = static_cast<uint8_t>(any_predicate()), i.guard_negated = chance(2);
    i.rd = static_cast<uint8_t>(has_operand(info, Operand::Pd) ? free_predicate() : destination());
    if (has_operand(info, Operand::Ra)) i.ra = static_cast<uint8_t>(source());
    if (has_operand(info, Operand::B) && chance(2))
      i.b_is_immediate = true, i.immediate = value();
    else if (has_operand(info, Operand::B) || has_operand(info, Operand::Rb))
      i.rb = static_cast<uint8_t>(source());
    if (has_operand(info, Operand::Pb)) i.rb = static_cast<uint8_t>(any_predicate());
    if (has_operand(info, Operand::Rc)) i.x = static_cast<uint8_t>(source());
    if (has_operand(info, Operand::Px)) i.x = static_cast<uint8_t>(any_predicate());
    if (has_operand(info, Operand::Argument)) i.immediate = below(kArguments);
    emit(i);
  }

  /// r13 = an aligned address: one for all lanes, neighbours, a stride, lines of one set, or anywhere; off by -offset.
  void address(bool own, uint32_t offset) {
    const uint32_t entries = own ? own_.entries : shared_bytes_ / 4;
    switch (below(6)) {
      case 0:
        emit_immediate("mov", kAddress, 0, below(entries));
        break;
      case 1:
        emit("lane", kAddress);
        emit_immediate("iadd", kAddress, kAddress, below(entries));
        break;
      case 2:
        emit("tid", kAddress);
        emit_immediate("imul", kAddress, kAddress, 1 + below(24));
        break;
      case 3:
      case 4:
        // A few lines that share a set.
        if (own && own_.entries >= 2 * own_.way_entries) {
          emit_immediate(chance(2) ? "and" : "shr", kAddress, source(), 3);
          emit_immediate("imul", kAddress, kAddress, own_.way_entries);
          emit_immediate("iadd", kAddress, kAddress, below(2) + own_.way_entries * below(4));
          break;
        }
        [[fallthrough]];
      default:
        emit("imul", kAddress, source(), source());
        break;
    }
    emit_immediate("and", kAddress, kAddress, entries - 1);
    emit_immediate("shl", kAddress, kAddress, own ? own_.shift : 2);
    emit("iadd", kAddress, kAddress, own ? kOwn : kShared);
    if (offset != 0) emit_immediate("isub", kAddress, kAddress, offset);
  }

  void memory() {
    const bool own = !chance(3);
    const uint32_t offset = chance(3) ? value() : 0;
    address(own, offset);
    const int accesses = 1 + static_cast<int>(below(4));
    for (int n = 0; n < accesses; ++n) {
      if (chance(4)) plain();  // so that a load or store comes after every type
      Instruction i;
      const bool store = own && chance(2);
      i.info = &instruction(store ? "st" : "ld");
      if (chance(2)) i.guard = static_cast<uint8_t>(any_predicate()), i.guard_negated = chance(2);
      i.ra = kAddress;
      i.immediate = offset;
      if (store)
        i.rb = static_cast<uint8_t>(source());
      else
        i.rd = static_cast<uint8_t>(destination());
      emit(i);
    }
  }

  /// At the top level the words of the current slice are known from statement to statement; elsewhere a statement writes all that it reads.
  void ray(bool top) {
    if (!top) {
      if (in_function_) return plain();
      const int words = chance(2) ? kRayWords : 1 + static_cast<int>(below(kIntersectionWords));
      for (int n = 0; n < words; ++n) emit_word("rst", n);
      for (int n = 0; n < 2; ++n) emit_word("rld", static_cast<int>(below(static_cast<uint32_t>(words))), destination());
      if (words >= kRayWords) rotate();
      written_words_ = 0;
      return;
    }
    if (written_words_ > 0 && chance(3)) {
      emit_word("rld", static_cast<int>(below(static_cast<uint32_t>(written_words_))), destination(), chance(2) ? any_predicate() : 0);
    } else if (written_words_ >= kRayWords && chance(2)) {
      rotate();
    } else if (written_words_ > 0 && (written_words_ == kIntersectionWords || chance(3))) {
      emit_word("rst", static_cast<int>(below(static_cast<uint32_t>(written_words_))), 0, any_predicate());
    } else {
      // Words are written from 0 up, unmasked the first time, so that nothing undefined is ever read or exported.
      const int count = std::min(kIntersectionWords - written_words_, 1 + static_cast<int>(below(14)));
      for (int n = 0; n < count; ++n) emit_word("rst", written_words_++);
    }
  }

  void rotate() {
    Instruction i;
    i.info = &instruction(chance(3) ? "rfb" : "rout");
    if (chance(2)) i.guard = static_cast<uint8_t>(any_predicate()), i.guard_negated = chance(2);
    emit(i);
    written_words_ = 0;
  }

  void loop(int length, int loops, int entries) {
    const int counter = kDataRegisters + loops;
    const int going = kLoopPredicate + loops;
    // Threads leave after different numbers of rounds.
    emit("lane", counter);
    emit_immediate("and", counter, counter, below(4));
    emit_immediate("iadd", counter, counter, below(2));
    emit_immediate("igt", going, counter, 0);
    written_words_ = 0;
    const size_t start = emit("loop", 0, 0, 0, going);
    body(length, loops + 1, entries + 1);
    emit_immediate("isub", counter, counter, 1, going);
    emit_immediate("igt", going, counter, 0);
    patch(start, here());
    written_words_ = 0;
  }

  void jump(int loops, int entries) {
    Instruction i;
    i.info = &instruction(chance(2) ? "jany" : "jnone");
    i.guard = static_cast<uint8_t>(any_predicate());
    i.guard_negated = chance(2);
    const size_t at = emit(i);
    const int skipped = 1 + static_cast<int>(below(4));
    for (int n = 0; n < skipped; ++n) {
      if (chance(4))
        memory();
      else if (chance(6))
        call(loops, entries);
      else
        plain();
    }
    patch(at, here());
  }

  /// Over instructions that are never executed, so that what follows lies in another line of the cache, or in the same set.
  void far_jump() {
    const size_t at = emit("jany");
    const uint32_t way = static_cast<uint32_t>(configuration_.instruction_cache_bytes) / 16;
    filler(chance(8) ? below(kFarLimit) : chance(2) ? way - here() % way : below(2 * way));
    patch(at, here());
  }

  void filler(uint32_t count) {
    if (code_.size() + count > kMostInstructions) return;
    for (uint32_t n = 0; n < count; ++n) code_.push_back(random());
  }

  void early_exit() {
    emit("warp", kAddress);
    const int leaves = free_predicate();
    emit_immediate(chance(2) ? "ieq" : "ult", leaves, kAddress, below(warps_));
    const size_t at = emit("jnone", 0, 0, 0, leaves);
    emit("exit");
    patch(at, here());
  }

  /// Each call has a function of its own, so that the number of instructions executed stays bounded.
  void call(int loops, int entries) {
    if (entries >= stack_depth_ || call_sites_ >= kMostCalls) return;
    ++call_sites_;
    calls_.push_back({emit("call", 0, 0, 0, control_guard()), loops, entries});
  }

  void functions() {
    in_function_ = true;
    const bool deep = chance(4);
    while (!calls_.empty()) {
      const Call call = calls_.back();
      calls_.pop_back();
      if (profile_.far > 0 && chance(2)) filler(below(static_cast<uint32_t>(configuration_.instruction_cache_bytes) / 8));
      const uint32_t start = here();
      body(1 + static_cast<int>(below(8)), call.loops, call.entries + 1);
      // Deep stacks come from calls in calls.
      if (!chance(deep ? 16 : 2)) this->call(call.loops, call.entries + 1);
      if (chance(2)) emit("ret", 0, 0, 0, control_guard());
      patch(call.at, start | here() << 16);
    }
    in_function_ = false;
  }

  void fault() {
    switch (result_.fault) {
      case FaultCode::IllegalInstruction:
        for (;;) {
          const uint64_t word = random();
          if (find_instruction(static_cast<int>(word >> 60), static_cast<int>(word >> 55 & 31)) != nullptr) continue;
          code_.push_back(word);
          return;
        }
      case FaultCode::PcOutsideProgram:
        runs_out_ = calls_.empty() && chance(2);
        if (!runs_out_) emit_immediate("jany", 0, 0, 0xffffu - below(1000));
        return;
      case FaultCode::StackOverflow:
        emit_immediate("call", 0, 0, here() | 0xffff0000u);
        return;
      case FaultCode::StackUnderflow:
        emit("ret");
        return;
      case FaultCode::Misaligned:
      case FaultCode::AddressOutsideMemory: {
        emit_immediate("mov", kAddress, 0, 0);
        const bool misaligned = result_.fault == FaultCode::Misaligned;
        // The memory is smaller than any address with one of the bits 22 .. 31.
        const uint32_t bad = misaligned ? 1 + below(3) + 4 * below(16) : 1u << (22 + below(10));
        emit_immediate(chance(2) ? "ld" : "st", 0, kAddress, bad);
        return;
      }
      default:
        emit_word(chance(2) ? "rld" : "rst", kIntersectionWords + static_cast<int>(below(32 - kIntersectionWords)));
        return;
    }
  }

  Configuration configuration_;
  uint32_t warps_;
  int stack_depth_;
  ProgramProfile profile_;
  RandomProgram result_;
  OwnWords own_;
  uint32_t shared_bytes_ = 1024;
  uint32_t kernels_ = 1;     ///< launches
  uint32_t block_mask_ = 1;  ///< bits of the block word that choose the kernel's words
  std::vector<Entry> entries_;
  std::vector<Call> calls_;
  int call_sites_ = 0;
  bool in_function_ = false;
  bool import_pending_ = false;
  bool runs_out_ = false;   ///< the program ends without `exit`
  int written_words_ = 0;  ///< words 0 .. n-1 of the current slice are defined
};

}  // namespace

uint32_t random_word(uint64_t random) {
  static constexpr uint32_t kSpecial[] = {
      0x00000000, 0x80000000, 0x3f800000, 0xbf800000, 0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001, 0x00000001, 0x807fffff,
      0x00800000, 0x80800001, 0x7f7fffff, 0xff7fffff, 0x4f000000, 0xcf000000, 0x4effffff, 0x5f000000, 0x3effffff, 0x3f000000,
      0x4b7fffff, 0x4b800001, 0x7fffffff, 0xffffffff, 0x3f7fffff, 0x00ffffff, 0x1f800000, 0x20000000, 0x60000000, 0x34000000};
  const auto bits = static_cast<uint32_t>(random >> 32);
  switch (random % 6) {
    case 0:
      return kSpecial[bits % std::size(kSpecial)];
    case 1:
      return bits % 64;
    case 2:
      return bits;
    case 3:
      // Near a power of two or at the ends of the range, where roundings carry and numbers become subnormal.
      return (bits & 0x80000000u) | (bits >> 8 & 0xff) << 23 | ((bits & 1) != 0 ? 0x7fffffu - (bits >> 1 & 3) : (bits >> 1 & 3));
    default: {
      const float f = (static_cast<float>(bits % 20001) - 10000.0F) / static_cast<float>(1U << (random >> 8 & 15));
      uint32_t word = 0;
      std::memcpy(&word, &f, 4);
      return word;
    }
  }
}

void fill_memory(RandomProgram& program) {
  program.memory = Memory(program.memory_bytes);
  const std::vector<uint64_t>& code = program.program.code;
  for (size_t i = 0; i < code.size(); ++i) {
    program.memory.store(static_cast<uint32_t>(i * 8), static_cast<uint32_t>(code[i]));
    program.memory.store(static_cast<uint32_t>(i * 8 + 4), static_cast<uint32_t>(code[i] >> 32));
  }
  for (uint32_t a = program.data_begin; a < program.memory_bytes; a += 4)
    program.memory.store(a, random_word(mix(program.seed, 400, a)));
}

RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length, int units) {
  return Generator(configuration, seed, units).make(length);
}

}  // namespace raypool
