#include "cosim/random_program.hpp"

#include <algorithm>
#include <cstring>

#include "arith/test_operands.hpp"
#include "cosim/program_statements.hpp"

namespace raypool {
namespace {

constexpr uint32_t kMostDataBytes = 384 * 1024;
constexpr uint32_t kFarLimit = 20000;
constexpr uint32_t kLastRestart = 3000;  ///< cycle
constexpr uint32_t kLengthOfPairRound = 16;
constexpr uint32_t kFarLimits = 1u << 20;  ///< from the end of the address space

class Generator : public ProgramStatements {
 public:
  Generator(const Configuration& configuration, const ProgramProfile& profile, uint64_t seed, int units)
      : ProgramStatements(configuration, profile, seed) {
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
    pair_rounds_ = 1 + static_cast<uint32_t>(length) / kLengthOfPairRound;
    if (chance(8)) result_.fault = static_cast<FaultCode>(1 + below(7));
    const int body_length = std::max(4, length * static_cast<int>(profile_.length_percent) / 100);
    if (chance(4)) filler(1 + below(chance(3) ? kFarLimit : 300));  // the program need not begin at 0
    entry("main", body_length);
    if (profile_.most_kernels > 1 && result_.fault == FaultCode::None && chance(2)) entry("second", body_length / 2);
    result_.program.code = code_;
    choose_data();
    choose_limits();
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
    shared_bytes_ = (profile_.pairs > 0 ? 8192u : 1024u) << below(4);
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

  // Limits beyond what there is: their upper bits count too. Faulty addresses and targets begin at them.
  void choose_limits() {
    const auto length = static_cast<uint32_t>(code_.size());
    const uint32_t longest = std::min(0xfff0u, result_.memory_bytes / 8);
    result_.program_length = length + (runs_out_ || !chance(3) ? 0 : below(longest - length));
    result_.memory_limit = result_.memory_bytes + (more_memory_told_ ? (below(1u << 30) >> below(24)) * 4 : 0);
    if (far_memory_told_) result_.memory_limit = 0u - 4 * (64 + below(kFarLimits / 4));
    std::vector<uint64_t>& code = result_.program.code;
    const auto fix = [&code](const std::vector<size_t>& places, uint32_t limit) {
      for (const size_t at : places) code[at] = (code[at] & ~uint64_t{0xffffffff}) | static_cast<uint32_t>(code[at] + limit);
    };
    fix(from_length_, result_.program_length);
    fix(from_limit_, result_.memory_limit);
    if (chance(8)) result_.restart = 1 + below(kLastRestart);
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
      result_.kernels.push_back({threads, block, import, entry.pc, value()});
    }
  }

  void choose_stalls() {
    // Arithmetic need not wait for memory.
    const bool calm = profile_.pairs > 0 ? !chance(4) : chance(4);
    for (auto& style : result_.stalls.styles) style = calm ? StallStyle::None : static_cast<StallStyle>(below(kStallStyles));
  }

  // ---- A kernel

  struct Entry {
    uint32_t pc;
    bool import;
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
        if (runs_out_) return;
        if (chance(2))
          emit_immediate("jany", 0, 0, 0xffffu - below(16));
        else
          from_length_.push_back(emit_immediate("jany", 0, 0, below(2)));
        return;
      case FaultCode::StackOverflow:
        emit_immediate("call", 0, 0, here() | 0xffff0000u);
        return;
      case FaultCode::StackUnderflow:
        emit("ret");
        return;
      case FaultCode::Misaligned:
      case FaultCode::AddressOutsideMemory: {
        // One lane is enough; a warp whose faulty lane is left out goes on.
        const bool some = chance(2);
        const char* access = chance(2) ? "ld" : "st";
        const bool last_word = some && !more_memory_told_;  // lane 0 reads it
        if (result_.fault == FaultCode::Misaligned) {
          emit("mov", kAddress, 0, kOwn);
          if (some)
            emit("lane", kAddress), emit_immediate("imul", kAddress, kAddress, 1 + below(3)),
                emit("iadd", kAddress, kAddress, kOwn);
          emit_immediate(access, 0, kAddress, some ? 0 : 1 + below(3));
          return;
        }
        emit_immediate("mov", kAddress, 0, 0);
        if (some) emit("lane", kAddress), emit_immediate("shl", kAddress, kAddress, 2);
        from_limit_.push_back(emit_immediate(last_word ? "ld" : access, 0, kAddress, last_word ? 0u - 4 : 4 * below(4)));
        return;
      }
      default:
        emit_word(chance(2) ? "rld" : "rst", kIntersectionWords + static_cast<int>(below(32 - kIntersectionWords)));
        return;
    }
  }

  RandomProgram result_;
  uint32_t kernels_ = 1;     ///< launches
  uint32_t block_mask_ = 1;  ///< bits of the block word that choose the kernel's words
  std::vector<Entry> entries_;
  bool more_memory_told_ = chance(3) || far_memory_told_;
  bool runs_out_ = false;                         ///< the program ends without `exit`
  std::vector<size_t> from_length_, from_limit_;  ///< instructions whose immediate is relative to what the unit is told
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

uint32_t told_length(const RandomProgram& program) {
  return std::max(program.program_length, static_cast<uint32_t>(program.program.code.size()));
}

uint32_t told_limit(const RandomProgram& program) { return std::max(program.memory_limit, program.memory_bytes); }

void fill_memory(RandomProgram& program) {
  program.memory = Memory(program.memory_bytes);
  const std::vector<uint64_t>& code = program.program.code;
  for (size_t i = 0; i < code.size(); ++i) {
    program.memory.store(static_cast<uint32_t>(i * 8), static_cast<uint32_t>(code[i]));
    program.memory.store(static_cast<uint32_t>(i * 8 + 4), static_cast<uint32_t>(code[i] >> 32));
  }
  // A saved program may be of a mix that is no more.
  if (program.profile == kOperandMix) {
    arith::OperandSource operands(program.seed);
    for (uint32_t a = program.data_begin; a < program.memory_bytes; a += 8) {
      const auto [first, second] = operands.next();
      program.memory.store(a, first);
      program.memory.store(a + 4, second);
    }
    return;
  }
  for (uint32_t a = program.data_begin; a < program.memory_bytes; a += 4)
    program.memory.store(a, random_word(mix(program.seed, 400, a)));
}

RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length, int units,
                                  const std::string& mix) {
  const ProgramProfile& profile = mix.empty() ? kProgramProfiles[seed % std::size(kProgramProfiles)] : profile_named(mix);
  return Generator(configuration, profile, seed, units).make(length);
}

}  // namespace raypool
