#include "cosim/random_program.hpp"

#include <algorithm>

#include "arith/test_operands.hpp"
#include "bits.hpp"
#include "cosim/program_statements.hpp"

namespace raypool {
namespace {

constexpr uint32_t kMostDataBytes = 384 * 1024;
constexpr uint32_t kFarLimit = 20000;
constexpr uint32_t kLastRestart = 3000;  ///< cycle
constexpr uint32_t kLengthOfPairRound = 16;
constexpr uint32_t kFarLimits = 1u << 19;  ///< from the end of the address space
constexpr uint32_t kLongestProgram = 0xfff0, kLastPc = 0xffff;
constexpr uint32_t kLeastRaces = 32, kMostRaces = 96;
constexpr uint32_t kLeastWalk = 8;                     ///< lines
constexpr uint32_t kMostDelays = 24, kMostShifts = 5;  ///< instructions
constexpr uint32_t kEveryFault = 0xfe;                 // but of subnormal numbers
constexpr uint32_t kLineInstructions = kLineBytes / 8;

class Generator : public ProgramStatements {
 public:
  /// `attempt`: the next one makes another program.
  Generator(const Configuration& configuration, const ProgramProfile& profile, uint64_t seed, int units,
            uint32_t attempt)
      : ProgramStatements(configuration, profile, attempt == 0 ? seed : mix(seed, 500, attempt)) {
    result_.seed = seed;
    result_.profile = std::string(profile_.name);
    result_.units = units;
    result_.intersection_words = intersection_words_;
    // Kernels that run at the same time must have words of their own each.
    together_ = units > 1 || configuration.kernel_overlap;
    kernels_ = 1 + below(profile_.most_kernels + (together_ ? 3 * static_cast<uint32_t>(units) : 0));
    if (profile_.name == kFaultMix) kernels_ = kLeastRaces + below(kMostRaces - kLeastRaces);
    if (rewrites_) kernels_ = std::max(kernels_, 2u);
    if (together_)
      while (block_mask_ + 1 < kernels_) block_mask_ = block_mask_ * 2 + 1;
  }

  RandomProgram make(int length) {
    choose_layout();
    pair_rounds_ = 1 + static_cast<uint32_t>(length) / kLengthOfPairRound;
    const int body_length = std::max(4, length * static_cast<int>(profile_.length_percent) / 100);
    if (chance(4)) filler(1 + below(chance(3) ? kFarLimit : 300));  // the program need not begin at 0
    if (profile_.name == kFaultMix) {
      result_.program.entries["main"] = here();
      for (uint32_t k = 0; k < kernels_ && (k == 0 || here() < most_instructions_); ++k) race();
      result_.faults = kEveryFault;
    } else {
      if (chance(8)) fault_ = any_fault();
      if (fault_ != FaultCode::None) result_.faults = fault_bit(fault_);
      const bool second = profile_.most_kernels > 1 && fault_ == FaultCode::None && chance(2);
      entry("main", body_length, !second);
      if (second) entry("second", body_length / 2, true);
    }
    if (guarded_) result_.faults |= fault_bit(FaultCode::SubnormalNumber);
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
    const uint32_t way = way_bytes();
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
    const uint32_t code_bytes = size32(code_) * 8;
    result_.data_begin = (code_bytes + 63) / 64 * 64 + (chance(4) ? below(1u << (6 + below(9))) * 64u : 0);
    result_.memory_bytes = result_.data_begin + shared_bytes_ + own_.bytes * (1 + block_mask_);
    for (auto& word : result_.arguments) word = value();
    result_.arguments[0] = result_.data_begin;
    result_.arguments[1] = result_.data_begin + shared_bytes_;
  }

  // Limits beyond what there is: their upper bits count too. Faulty addresses and targets begin at them.
  void choose_limits() {
    const auto length = size32(code_);
    const uint32_t longest = std::max(length + 1, std::min({kLongestProgram, last_pc_ + 1, result_.memory_bytes / 8}));
    result_.program_length = length + (runs_out_ || !chance(3) ? 0 : below(longest - length));
    result_.memory_limit = result_.memory_bytes + (more_memory_told_ ? (below(1u << 30) >> below(24)) * 4 : 0);
    if (far_memory_told_) result_.memory_limit = 0u - 4 * (64 + below(kFarLimits / 4));
    // Between two elements of a triple.
    if (!across_limit_.empty()) result_.memory_limit = (result_.memory_limit & ~15u) + 4 * (1 + below(kElements - 1));
    std::vector<uint64_t>& code = result_.program.code;
    const auto fix = [&code](const std::vector<size_t>& places, uint32_t limit) {
      for (const size_t at : places)
        code[at] = (code[at] & ~uint64_t{0xffffffff}) | static_cast<uint32_t>(code[at] + limit);
    };
    // Outside, though the bits below the upper one are those of a PC inside.
    for (const size_t at : twins_) {
      const uint32_t upper = narrow_pc() && chance(2) ? last_pc_ + 1 : upper_pc_bit_;
      const uint32_t twin = static_cast<uint32_t>(code[at]) | upper;
      code[at] = (code[at] & ~uint64_t{0xffffffff}) | (twin >= result_.program_length ? twin : kLastPc);
    }
    fix(from_length_, result_.program_length);
    fix(from_limit_, result_.memory_limit);
    fix(across_limit_, result_.memory_limit & ~15u);
    if (chance(8)) result_.restart = 1 + below(kLastRestart);
  }

  void choose_kernels() {
    constexpr uint32_t kAllThreads = 5;
    const auto contents = configuration_.contents();
    const auto lanes = configuration_.lanes;
    for (uint32_t k = 0; k < kernels_; ++k) {
      uint32_t threads = contents;
      switch (profile_.name == kFaultMix ? kAllThreads : below(6)) {
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
      const auto entries = size32(entries_);
      const Entry& entry = entries_[profile_.name == kFaultMix ? k % entries : below(entries)];
      const ImportKind import = !entry.import ? ImportKind::None : static_cast<ImportKind>(1 + below(kImportKinds - 1));
      const uint32_t block = together_ ? (value() & ~block_mask_) | k : value();
      result_.kernels.push_back({threads, block, import, entry.pc, value()});
      if (rewrites_ && k > 0 && !chance(3)) result_.kernels.back().rewrite = rewrite();
    }
  }

  // Data instructions become others. Where data and arguments lie stays.
  Rewrite rewrite() {
    Rewrite rewrite;
    if (!chance(3)) {
      const std::vector<size_t> places = plain_at_;
      for (const size_t at : places) {
        if (!chance(4)) continue;
        plain();
        rewrite.code[at] = code_.back();
        code_.pop_back();
        plain_at_.pop_back();
      }
    }
    if (!chance(3)) rewrite.data_seed = random() | 1;
    for (uint32_t n = chance(2) ? 1 : 1 + below(arguments_); n > 0; --n) {
      const uint32_t number = 2 + below(arguments_ - 2);
      rewrite.arguments[number] = value();
    }
    return rewrite;
  }

  void choose_stalls() {
    // Arithmetic need not wait for memory.
    const bool calm = profile_.pairs > 0 || profile_.name == kFaultMix ? !chance(4) : chance(4);
    for (auto& style : result_.stalls.styles)
      style = calm ? StallStyle::None : static_cast<StallStyle>(below(kStallStyles));
  }

  // ---- A kernel

  struct Entry {
    uint32_t pc;
    bool import;
  };

  void entry(const char* name, int length, bool last) {
    const bool import = chance(2);
    result_.program.entries[name] = here();
    entries_.push_back({here(), import});
    import_pending_ = import;
    written_words_ = 0;
    prologue();
    if (import && !chance(3)) take_import();
    body(length / 2, 0, 1);
    if (import_pending_) take_import();
    if (fault_ != FaultCode::None) {
      if (written_words_ >= kRayWords) rotate();  // what leaves may be under way when the fault comes
      fault(fault_);
    }
    if (runs_out_) return;
    body(length - length / 2, 0, 1);
    for (uint32_t n = below(4); n > 0; --n) leave_predicate();
    if (configuration_.triples && chance(2)) last_triple();
    if (last && profile_.far > 0 && chance(6)) return far_end();
    emit(Opcode::Exit, 0, 0, 0, control_guard());
    functions();
  }

  // At the last instructions that there can be.
  void far_end() {
    const size_t at = emit(Opcode::Jany);
    functions();
    const uint32_t place = kLongestProgram - 8 - below(8);
    while (here() < place) code_.push_back(random());
    patch(at, here());
    // There is no room to tame operands.
    const auto type = guarded_ ? std::optional<size_t>(to_underlying(AluType::Int)) : std::nullopt;
    for (uint32_t n = 1 + below(6); n > 0; --n) plain(-1, -1, type);
    emit(Opcode::Exit);
  }

  int last_or_any_predicate() { return static_cast<int>(chance(3) ? predicates_ - 1 : 1 + below(predicates_ - 1)); }

  // Set in every lane when the kernel ends, which the next one must not see.
  void leave_predicate() {
    const int r = source();
    Instruction i;
    i.info = &instruction(Opcode::Ieq);
    i.rd = last_or_any_predicate();
    i.ra = i.rb = r;
    emit(i);
  }

  // Its last register is followed by the first of 16, which is not needed any more.
  void last_triple() {
    Instruction i;
    i.info = &instruction(chance(2) ? Opcode::Fmul3 : Opcode::Arg3);
    i.rd = first_of(registers_ - 2 + below(2), true);
    if (i.info->opcode == Opcode::Fmul3) i.ra = first_of(source(), true), i.rb = first_of(source(), true);
    emit(i);
    emit(Opcode::Iadd, 2, 0, 1);
  }

  // Before the kernel has written any.
  void read_predicate() {
    Instruction i;
    i.info = &instruction(chance(2) ? Opcode::Por : Opcode::Pxor);
    i.rd = free_predicate();
    i.x = last_or_any_predicate();
    i.rb = last_or_any_predicate();
    if (chance(2)) i.guard = last_or_any_predicate(), i.guard_negated = true;
    emit(i);
  }

  void prologue() {
    for (uint32_t n = below(4); n > 0; --n) read_predicate();
    for (int r = 0; r < data_registers_; ++r) {
      if (chance(3))
        emit(Opcode::Tid, r);
      else
        emit_immediate(Opcode::Mov, r, 0, value());
    }
    for (int r = data_registers_; r < data_registers_ + loop_depth_; ++r) emit_immediate(Opcode::Mov, r, 0, 0);
    // Another kernel's warp may have written the words that this one's warp gets.
    emit(Opcode::Warp, address_);
    if (chance(2)) emit_immediate(Opcode::Xor, address_, address_, below(warps_));
    times(address_, address_, own_.stride);
    emit_immediate(Opcode::Arg, base_, 0, 1);
    emit(Opcode::Iadd, base_, base_, address_);
    emit(Opcode::Block, address_);
    emit_immediate(Opcode::And, address_, address_, block_mask_);
    times(address_, address_, own_.bytes);
    emit(Opcode::Iadd, base_, base_, address_);
    emit_immediate(Opcode::Arg, shared_, 0, 0);
  }

  void take_import() {
    emit(Opcode::Rin, 0, 0, 0, control_guard());
    import_pending_ = false;
    written_words_ = static_cast<int>(intersection_words_);
    // Packages of other warps are still coming, into a set that this one uses.
    if (configuration_.wide_ray_memory && chance(2)) {
      for (uint32_t n = 4 + below(12); n > 0; --n) {
        if (chance(2))
          load_word(0);
        else
          emit_word(Opcode::Rst, below(intersection_words_), 0, any_predicate());
      }
    }
  }

  void fault(FaultCode code) {
    switch (code) {
      case FaultCode::IllegalInstruction:
        if (chance(4) && missing_instruction()) return;
        if (names_too_few() && chance(2)) return missing_number();
        if (configuration_.triples && chance(4)) {
          const uint32_t outside = last_triple_word(intersection_words_) + 1;
          emit_word(chance(2) ? Opcode::Rld3 : Opcode::Rst3, outside + below(chance(2) ? 1 : 32 - outside));
          return;
        }
        for (;;) {
          const uint64_t word = random();
          if (find_instruction(static_cast<int>(word >> 60), static_cast<int>(word >> 55 & 31)) != nullptr) continue;
          code_.push_back(word);
          return;
        }
      case FaultCode::PcOutsideProgram:
        runs_out_ = calls_.empty() && chance(2);
        if (runs_out_) return;
        return jump_outside();
      case FaultCode::StackOverflow:
        emit_immediate(Opcode::Call, 0, 0, here() | 0xffff0000u);
        return;
      case FaultCode::StackUnderflow:
        emit(Opcode::Ret);
        return;
      case FaultCode::Misaligned:
      case FaultCode::AddressOutsideMemory: {
        // One lane is enough; a warp goes on if its faulty lane is left out.
        const bool some = chance(2);
        const bool three = configuration_.triples && chance(2);
        const bool inval = configuration_.sharing && chance(3);
        const Opcode access = inval ? Opcode::Inval : three ? Opcode::Ld3 : chance(2) ? Opcode::Ld : Opcode::St;
        const bool last_word = some && !more_memory_told_;  // lane 0 reads it
        if (code == FaultCode::Misaligned) {
          emit(Opcode::Mov, address_, 0, base_);
          if (some)
            emit(Opcode::Lane, address_), times(address_, address_, 1 + below(3)),
                emit(Opcode::Iadd, address_, address_, base_);
          emit_immediate(access, 0, address_, some ? 0 : 1 + below(3));
          return;
        }
        if (three && far_memory_told_ && chance(2)) return across_limit();
        emit_immediate(Opcode::Mov, address_, 0, 0);
        if (some) emit(Opcode::Lane, address_), emit_immediate(Opcode::Shl, address_, address_, 2);
        from_limit_.push_back(
            emit_immediate(last_word ? Opcode::Ld : access, 0, address_, last_word ? 0u - 4 : 4 * below(4)));
        return;
      }
      case FaultCode::SubnormalNumber:
        subnormal();
        return;
      default:
        emit_word(chance(2) ? Opcode::Rld : Opcode::Rst, intersection_words_ + below(32 - intersection_words_));
        return;
    }
  }

  // As operand a, as operand b, or as a result.
  void subnormal() {
    constexpr uint32_t kOne = 0x3f800000, kHalf = 0x3f000000, kLeastNormal = 0x00800000;
    const uint32_t number = 1 + below(kLeastNormal - 1);
    const uint32_t kind = below(3);
    emit_immediate(Opcode::Mov, 1, 0, kind == 0 ? number : kind == 1 ? kOne : kLeastNormal);
    emit_immediate(Opcode::Fmul, 1, 1, kind == 0 ? kOne : kind == 1 ? number : kHalf);
  }

  // The first element of the triple is loaded.
  void across_limit() {
    emit_immediate(Opcode::Mov, address_, 0, 0);
    across_limit_.push_back(emit_immediate(Opcode::Ld3, 0, address_, 0));
  }

  // One that other machines have; false if this one has all.
  bool missing_instruction() {
    std::vector<Opcode> missing;
    for (const InstructionInfo& info : kInstructions)
      if (!configuration_.has(info)) missing.push_back(info.opcode);
    if (missing.empty()) return false;
    emit(missing[below(size32(missing))], destination(), source(), source());
    return true;
  }

  bool narrow_pc() const { return last_pc_ < kLastPc; }
  bool names_too_few() const { return registers_ < kRegisters || predicates_ < kPredicates || arguments_ < kArguments; }

  // An instruction that names a register, predicate or argument that this machine has not.
  void missing_number() {
    for (;;) {
      Instruction i;
      i.info = &kInstructions[below(std::size(kInstructions))];
      if (!configuration_.has(*i.info)) continue;
      i.guard = chance(2) ? any_predicate() : below(kPredicates);
      i.rd = below(kRegisters), i.ra = below(kRegisters), i.rb = below(kRegisters);
      i.b_is_immediate = chance(2);
      i.x = below(32);
      i.immediate = chance(2) ? below(kArguments) : value();
      const Numbers numbers = numbers_of(i);
      if (numbers.registers <= registers_ && numbers.predicates <= predicates_ && numbers.arguments <= arguments_)
        continue;
      emit(i);
      return;
    }
  }

  void jump_outside() {
    switch (below(3)) {
      case 0:
        emit_immediate(Opcode::Jany, 0, 0, kLastPc - below(16));
        break;
      case 1:
        twins_.push_back(emit_immediate(Opcode::Jany, 0, 0, below(std::min(here() + 1, upper_pc_bit_))));
        break;
      default:
        from_length_.push_back(emit_immediate(Opcode::Jany, 0, 0, below(2)));
        break;
    }
  }

  // ---- Faults of several warps at about the same time

  // Two groups of warps, each with an arm of the program that ends in a fault of its own. Both arms lie in one line of
  // the instruction cache, for which all warps wait, so that they begin at nearly the same time.
  void race() {
    entries_.push_back({here(), false});
    const uint32_t mask = chance(2) ? warps_ - 1 : std::min(warps_ - 1, 1u);
    // The second group may be fetching from one line after the other when the first one's fault comes.
    const bool walks = chance(4);
    const std::array<FaultCode, 2> codes = {any_fault(), walks ? FaultCode::None : any_fault()};
    const int second = free_predicate();
    emit_immediate(Opcode::Mov, 0, 0, value());
    if (chance(2))
      emit(Opcode::Lane, base_);
    else
      emit_immediate(Opcode::Mov, base_, 0, 0);
    emit(Opcode::Warp, address_);
    emit_immediate(Opcode::And, address_, address_, mask);
    emit_immediate(Opcode::Ieq, second, address_, below(warps_) & mask);
    fill_stacks(codes, second);
    while (here() % kLineInstructions != kLineInstructions - 1) emit(Opcode::Lane, 4);
    const size_t branch = emit(Opcode::Jany, 0, 0, 0, second);
    arm(codes[0], walks ? 1 + below(kMostDelays) : below(kMostShifts));
    while (here() % kLineInstructions < kLineInstructions / 2) code_.push_back(random());
    patch(branch, here());
    if (walks)
      walk();
    else
      arm(codes[1], below(kMostShifts));
  }

  void walk() {
    for (uint32_t n = kLeastWalk + below(kLeastWalk); n > 0; --n) {
      const size_t jump = emit(Opcode::Jany);
      while (here() % kLineInstructions != 0) code_.push_back(random());
      patch(jump, here());
    }
    emit(Opcode::Exit);
  }

  FaultCode any_fault() {
    return static_cast<FaultCode>(
        1 + below(to_underlying(guarded_ ? FaultCode::SubnormalNumber : FaultCode::RayWordOutside)));
  }

  // The stacks of a group that is to overflow; the other one's takes as long and stays empty.
  void fill_stacks(const std::array<FaultCode, 2>& codes, int second) {
    const auto control = [this](bool call) {
      for (int n = 1; n < stack_depth_; ++n)
        emit_immediate(call ? Opcode::Call : Opcode::Jany, 0, 0, (here() + 1) | (call ? 0xffff0000u : 0));
    };
    const bool first_overflows = codes[0] == FaultCode::StackOverflow,
               second_overflows = codes[1] == FaultCode::StackOverflow;
    if (first_overflows && second_overflows) return control(true);
    if (!first_overflows && !second_overflows) return;
    const size_t others = emit(first_overflows ? Opcode::Jany : Opcode::Jnone, 0, 0, 0, second);
    control(true);
    const size_t join = emit(Opcode::Jany);
    patch(others, here());
    control(false);
    patch(join, here());
  }

  void arm(FaultCode code, uint32_t delays) {
    for (uint32_t n = delays; n > 0; --n) {
      static constexpr std::array<Opcode, 5> kDelays = {Opcode::Lane, Opcode::Por, Opcode::Iadd, Opcode::Fadd,
                                                        Opcode::Frcp};  // of different depths
      const Opcode delay = kDelays[below(kDelays.size())];
      emit(has(delay) ? delay : Opcode::Lane, 1);
    }
    race_fault(code);
    emit(Opcode::Exit);
  }

  // r15 has the lane or 0.
  void race_fault(FaultCode code) {
    const Opcode access = chance(2) ? Opcode::Ld : Opcode::St;
    if (code == FaultCode::AddressOutsideMemory && configuration_.triples && far_memory_told_ && chance(2))
      across_limit();
    else if (code == FaultCode::Misaligned && chance(2))
      emit_immediate(access, 0, base_, 1 + below(3));
    else if (code == FaultCode::Misaligned || code == FaultCode::AddressOutsideMemory)
      from_limit_.push_back(
          emit_immediate(access, 0, base_, 4 * below(4) + (code == FaultCode::Misaligned ? 1 + below(3) : 0)));
    else if (code == FaultCode::PcOutsideProgram)
      jump_outside();
    else
      fault(code);
  }

  const uint32_t last_pc_ = (1u << configuration_.pc_bits) - 1;  ///< which is outside of every program
  const uint32_t upper_pc_bit_ = 1u << (configuration_.pc_bits - 1);
  RandomProgram result_;
  FaultCode fault_ = FaultCode::None;  ///< in which kernels of one end end
  bool rewrites_ = chance(4);          ///< between kernels
  bool together_ = false;              ///< kernels may run at the same time
  uint32_t kernels_ = 1;               ///< launches
  std::vector<Entry> entries_;
  bool more_memory_told_ = chance(3) || far_memory_told_;
  bool runs_out_ = false;                         ///< the program ends without `exit`
  std::vector<size_t> across_limit_;              ///< ld3 of which a later element lies beyond the memory
  std::vector<size_t> from_length_, from_limit_;  ///< instructions with an immediate relative to the unit's inputs
  std::vector<size_t> twins_;                     ///< jumps to a PC inside the program, which get its twin outside
};

void store_instruction(Memory& memory, uint32_t pc, uint64_t instruction) {
  memory.store(pc * 8, static_cast<uint32_t>(instruction));
  memory.store(pc * 8 + 4, static_cast<uint32_t>(instruction >> 32));
}

void fill_data(const RandomProgram& program, uint64_t seed, Memory& memory) {
  // A saved program may be of a mix that is no more.
  if (program.profile == kOperandMix) {
    arith::OperandSource operands(seed);
    for (uint32_t a = program.data_begin; a < program.memory_bytes; a += 8) {
      const auto [first, second] = operands.next();
      memory.store(a, first);
      memory.store(a + 4, second);
    }
    return;
  }
  for (uint32_t a = program.data_begin; a < program.memory_bytes; a += 4)
    memory.store(a, random_word(mix(seed, 400, a)));
}

}  // namespace

uint32_t random_word(uint64_t random) {
  static constexpr uint32_t kSpecial[] = {0x00000000, 0x80000000, 0x3f800000, 0xbf800000, 0x7f800000, 0xff800000,
                                          0x7fc00000, 0x7f800001, 0x00000001, 0x807fffff, 0x00800000, 0x80800001,
                                          0x7f7fffff, 0xff7fffff, 0x4f000000, 0xcf000000, 0x4effffff, 0x5f000000,
                                          0x3effffff, 0x3f000000, 0x4b7fffff, 0x4b800001, 0x7fffffff, 0xffffffff,
                                          0x3f7fffff, 0x00ffffff, 0x1f800000, 0x20000000, 0x60000000, 0x34000000};
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
      return (bits & 0x80000000u) | (bits >> 8 & 0xff) << 23 |
             ((bits & 1) != 0 ? 0x7fffffu - (bits >> 1 & 3) : (bits >> 1 & 3));
    default:
      return as_bits((static_cast<float>(bits % 20001) - 10000.0F) / static_cast<float>(1U << (random >> 8 & 15)));
  }
}

uint32_t told_length(const RandomProgram& program) {
  return std::max(program.program_length, size32(program.program.code));
}

uint32_t told_limit(const RandomProgram& program) { return std::max(program.memory_limit, program.memory_bytes); }

void fill_memory(RandomProgram& program) {
  program.memory = Memory(program.memory_bytes);
  program.memory.begin_far(program.seed);
  const std::vector<uint64_t>& code = program.program.code;
  for (size_t i = 0; i < code.size(); ++i) store_instruction(program.memory, static_cast<uint32_t>(i), code[i]);
  fill_data(program, program.seed, program.memory);
}

void rewrite_memory(const RandomProgram& program, const Rewrite& rewrite, Memory& memory) {
  for (const auto& [pc, instruction] : rewrite.code) store_instruction(memory, pc, instruction);
  if (rewrite.data_seed != 0) fill_data(program, rewrite.data_seed, memory);
}

RandomProgram make_random_program(const Configuration& configuration, uint64_t seed, int length, int units,
                                  const std::string& mix) {
  const ProgramProfile& profile =
      mix.empty() ? kProgramProfiles[seed % std::size(kProgramProfiles)] : profile_named(mix);
  for (uint32_t attempt = 0;; ++attempt) {
    // The longest ones of a machine with short PCs are drawn again, shorter.
    const int shorter = std::max(4, length >> std::min(attempt, 8u));
    RandomProgram program = Generator(configuration, profile, seed, units, attempt).make(shorter);
    if (told_length(program) < 1u << configuration.pc_bits) return program;
  }
}

}  // namespace raypool
