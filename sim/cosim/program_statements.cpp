#include "cosim/program_statements.hpp"

#include <algorithm>
#include <iterator>

namespace raypool {
namespace {

constexpr uint32_t kFarJump = 20000;
constexpr uint32_t kMostParts = 8;  ///< power of two
constexpr int kMostCalls = 40;
// Of a far address: a bit of it is set and one is clear from kFarBit on, so that it lies beyond any data and
// below the limit; from kFarUpperBit on it is random; below it are the block's and the warp's bits, a bit of
// lines that are stored to, and the word.
constexpr uint32_t kFarBit = 22, kFarUpperBit = 17, kFarWarpBits = 5;
// Of a loop of pairs, which stays in the smallest instruction cache.
constexpr int kLeastPairOperations = 24, kMostPairOperations = 44;

}  // namespace

void ProgramStatements::body(int length, int loops, int entries) {
  const size_t end = code_.size() + static_cast<size_t>(std::max(1, length));
  const ProgramProfile& p = profile_;
  const uint32_t total =
      p.plain + p.arithmetic + p.pairs + p.memory + p.ray + p.loop + p.jump + p.call + p.far + p.early_exit;
  while (code_.size() < end) {
    uint32_t kind = below(total);
    const auto is = [&kind](uint32_t weight) {
      if (kind < weight) return true;
      kind -= weight;
      return false;
    };
    if (is(p.arithmetic)) {
      arithmetic();
    } else if (is(p.pairs)) {
      if (loops < loop_depth_ && entries < stack_depth_) pairs(loops);
    } else if (is(p.memory)) {
      memory();
    } else if (is(p.ray)) {
      ray(loops == 0 && entries == 1 && !in_function_);
    } else if (is(p.loop)) {
      if (loops < loop_depth_ && entries < stack_depth_ && length > 8) loop(length / 3, loops, entries);
      if (loop_depth_ == 0 && entries < stack_depth_) short_loop();
    } else if (is(p.jump)) {
      jump(loops, entries);
    } else if (is(p.call)) {
      call(loops, entries);
    } else if (is(p.far)) {
      far_jump();
    } else if (is(p.early_exit)) {
      if (!import_pending_ && !in_function_) early_exit();
    } else {
      if (configuration_.slow_groups() > 1 && has_any(AluType::Slw) && chance(6)) some_groups();
      plain();
    }
  }
}

bool ProgramStatements::has(Opcode opcode) const { return configuration_.has(instruction(opcode)); }

void ProgramStatements::times(int rd, int ra, uint32_t factor) {
  if (has(Opcode::Imul)) {
    emit_immediate(Opcode::Imul, rd, ra, factor);
    return;
  }
  uint32_t places = 0;
  while (factor >> 1 >> places != 0) ++places;
  emit_immediate(Opcode::Shl, rd, ra, places);
}

bool ProgramStatements::has_any(AluType type) const {
  return std::any_of(std::begin(kInstructions), std::end(kInstructions),
                     [&](const InstructionInfo& info) { return info.alu() == type && configuration_.has(info); });
}

void ProgramStatements::tame(int number, const Instruction& guarded) {
  if (number >= data_registers_) return;
  Instruction i;
  i.guard = guarded.guard;
  i.guard_negated = guarded.guard_negated;
  i.rd = i.ra = static_cast<uint8_t>(number);
  i.b_is_immediate = true;
  i.info = &instruction(Opcode::And);
  i.immediate = kTameBits;
  emit(i);
  i.info = &instruction(Opcode::Iadd);
  i.immediate = kTameOffset;
  emit(i);
}

void ProgramStatements::tame(Instruction& i) {
  const bool compare = i.info->alu() == AluType::Brh && i.info->immediate == ImmediateType::Float;
  const bool floats = compare || i.info->alu() == AluType::Flt || i.info->alu() == AluType::Slw;
  if (!floats || !tames()) return;
  const bool three = i.info->needs == Feature::Triples || i.info->needs == Feature::FusedTriples;
  if (i.b_is_immediate) i.immediate = tamed(i.immediate);
  // Counters and addresses, which are small integers, stay what they are.
  for (uint8_t* number : {&i.ra, &i.rb, &i.x})
    if (*number >= data_registers_) *number = static_cast<uint8_t>(destination());
  for (int n = 0; n < (three ? kElements : 1); ++n) {
    if (has_operand(*i.info, Operand::Ra)) tame((i.ra + n) % kRegisters, i);
    if (has_operand(*i.info, Operand::B) && !i.b_is_immediate) tame((i.rb + n) % kRegisters, i);
    if (has_operand(*i.info, Operand::Rc)) tame((i.x + n) % kRegisters, i);
  }
}

size_t ProgramStatements::plain_type() {
  uint32_t total = 0;
  for (const uint32_t weight : weights_) total += weight;
  uint32_t pick = below(total);
  size_t type = 0;
  while (pick >= weights_[type]) pick -= weights_[type++];
  return type;
}

const InstructionInfo& ProgramStatements::plain_row(std::optional<size_t> type) {
  const size_t of = type ? *type : plain_type();
  if (of == to_underlying(AluType::Tid) && has(Opcode::Unit) && chance(8)) return instruction(Opcode::Unit);
  for (;;) {
    const InstructionInfo& info = kInstructions[below(kSingles)];
    if (info.alu() == static_cast<AluType>(of) && info.kind != Kind::Control && configuration_.has(info)) return info;
  }
}

void ProgramStatements::some_groups() {
  const int lane = destination();
  Instruction i;
  i.info = &instruction(chance(2) ? Opcode::Ult : Opcode::Uge);
  i.rd = free_predicate();
  i.ra = lane;
  i.b_is_immediate = true;
  i.immediate = 1 + below(configuration_.lanes - 1);
  emit(Opcode::Lane, lane);
  emit(i);
  Instruction slow;
  slow.rb = source();
  slow.ra = source();
  slow.rd = destination();
  slow.info = &plain_row(to_underlying(AluType::Slw));
  slow.guard = i.rd;
  tame(slow);
  emit(slow);
}

void ProgramStatements::triple(int a, int b) {
  static constexpr Opcode kTriples[] = {Opcode::Fadd3, Opcode::Fsub3, Opcode::Fmul3, Opcode::Fmul3s,
                                        Opcode::Arg3,  Opcode::Ffma3, Opcode::Ffma3s};
  const uint32_t count = configuration_.fma ? std::size(kTriples) : std::size(kTriples) - 2;
  Instruction i;
  i.info = &instruction(kTriples[below(count)]);
  if (percent(profile_.guarded_percent)) i.guard = any_predicate(), i.guard_negated = chance(2);
  i.rd = destination_of_three(a, b);
  if (i.info->opcode == Opcode::Arg3) {
    const uint32_t last = arguments_ < kArguments ? arguments_ - kElements : kArguments - 1;
    i.immediate = std::min(below(arguments_), last);
  } else {
    // Near the destination: in some an element reads what an earlier one has written.
    const auto near = [&](bool moves) {
      const uint32_t number = chance(2) ? below(registers_) : (i.rd + registers_ - 3 + below(7)) % registers_;
      return static_cast<uint8_t>(first_of(number, moves));
    };
    i.ra = near(!has_one_ra(*i.info));
    if (chance(3))
      i.b_is_immediate = true, i.immediate = value();
    else
      i.rb = near(true);
    if (has_operand(*i.info, Operand::Rc)) i.x = near(true);
  }
  tame(i);
  plain_at_.push_back(emit(i));
}

bool ProgramStatements::are_three(int first, int a, int b) {
  const auto among = [first](int number) { return number >= first && number < first + kElements; };
  return !among(a) && !among(b);
}

bool ProgramStatements::has_three(int a, int b) const {
  for (int first = 0; first + kElements <= data_registers_; ++first)
    if (are_three(first, a, b)) return true;
  return false;
}

int ProgramStatements::destination_of_three(int a, int b) {
  for (;;) {
    const int first = below(data_registers_ - kElements + 1);
    if (are_three(first, a, b)) return first;
  }
}

void ProgramStatements::plain(int a, int b, std::optional<size_t> type) {
  const bool float_or_any = !type || *type == static_cast<size_t>(AluType::Flt);
  if (configuration_.triples && float_or_any && chance(4) && has_three(a, b)) return triple(a, b);
  Instruction i;
  i.info = &plain_row(type);
  const InstructionInfo& info = *i.info;
  if (percent(profile_.guarded_percent)) i.guard = any_predicate(), i.guard_negated = chance(2);
  if (has_operand(info, Operand::Pd)) {
    i.rd = free_predicate();
  } else {
    do {
      i.rd = destination();
    } while (i.rd == a || i.rd == b);
  }
  if (has_operand(info, Operand::Ra)) i.ra = a >= 0 ? a : source();
  if (has_operand(info, Operand::B) && b < 0 && chance(2))
    i.b_is_immediate = true, i.immediate = value();
  else if (has_operand(info, Operand::B) || has_operand(info, Operand::Rb))
    i.rb = b >= 0 ? b : source();
  if (has_operand(info, Operand::Pb)) i.rb = any_predicate();
  // A third operand that meets the product of the two.
  if (has_operand(info, Operand::Rc)) i.x = a >= 0 && chance(2) ? (chance(2) ? a : std::max(b, 0)) : source();
  if (has_operand(info, Operand::Px)) i.x = any_predicate();
  if (has_operand(info, Operand::Argument)) i.immediate = below(arguments_);
  tame(i);
  plain_at_.push_back(emit(i));
}

void ProgramStatements::arithmetic() {
  const int a = destination(), b = destination();
  const auto [first, second] = operands_.next();
  emit_immediate(Opcode::Mov, a, 0, first);
  if (chance(2)) {
    emit(Opcode::Lane, b);
    emit_immediate(Opcode::Iadd, b, b, second);
  } else {
    emit_immediate(Opcode::Mov, b, 0, second);
  }
  const int operations = 2 + below(4);
  for (int n = 0; n < operations; ++n) {
    if (chance(2))
      plain(a, b);
    else
      plain(b, a);
  }
  if (!has(Opcode::Ffma)) return;
  // The product meets an addend that goes with it.
  Instruction i;
  i.info = &instruction(Opcode::Ffma);
  do i.x = destination();
  while (i.x == a || i.x == b);
  emit_immediate(Opcode::Mov, i.x, 0, operands_.third(first, second));
  i.rd = destination();
  i.ra = a;
  i.rb = b;
  tame(i);
  emit(i);
}

void ProgramStatements::pairs(int loops) {
  const int a = data_registers_ - 2, b = data_registers_ - 1;
  const int counter = data_registers_ + loops;
  const int going = loop_predicate_ + loops;
  emit_immediate(Opcode::Mov, counter, 0, pair_rounds_);
  emit_immediate(Opcode::Igt, going, counter, 0);
  const size_t start = emit(Opcode::Loop, 0, 0, 0, going);
  emit(Opcode::Tid, address_);
  times(a, counter, configuration_.contents());
  emit(Opcode::Iadd, address_, address_, a);
  emit_immediate(Opcode::Iadd, address_, address_, below(shared_bytes_));
  emit_immediate(Opcode::And, address_, address_, shared_bytes_ / 8 - 1);
  emit_immediate(Opcode::Shl, address_, address_, 3);
  emit(Opcode::Iadd, address_, address_, shared_);
  emit_immediate(Opcode::Ld, a, address_, 0);
  emit_immediate(Opcode::Ld, b, address_, 4);
  const int operations = kLeastPairOperations + below(kMostPairOperations - kLeastPairOperations + 1);
  // One type alone in half of the loops: all warps want it at once.
  const std::optional<size_t> type = chance(2) ? std::optional(plain_type()) : std::nullopt;
  for (int n = 0; n < operations; ++n) {
    if (chance(2))
      plain(a, b, type);
    else
      plain(b, chance(8) ? b : a, type);
  }
  emit_immediate(Opcode::Isub, counter, counter, 1);
  emit_immediate(Opcode::Igt, going, counter, 0);
  patch(start, here());
}

void ProgramStatements::address(bool own, uint32_t offset, uint32_t entries, bool of_four) {
  switch (below(6)) {
    case 0:
      emit_immediate(Opcode::Mov, address_, 0, below(entries));
      break;
    case 1:
      emit(Opcode::Lane, address_);
      emit_immediate(Opcode::Iadd, address_, address_, below(entries));
      break;
    case 2:
      emit(Opcode::Tid, address_);
      times(address_, address_, 1 + below(24));
      break;
    case 3:
    case 4:
      // A few lines that share a set.
      if (own && own_.entries >= 2 * own_.way_entries) {
        emit_immediate(chance(2) ? Opcode::And : Opcode::Shr, address_, source(), 3);
        times(address_, address_, own_.way_entries);
        emit_immediate(Opcode::Iadd, address_, address_, below(2) + own_.way_entries * below(4));
        break;
      }
      [[fallthrough]];
    default:
      emit(has(Opcode::Imul) ? Opcode::Imul : Opcode::Xor, address_, source(), source());
      break;
  }
  emit_immediate(Opcode::And, address_, address_, (entries - 1) & (of_four ? ~3u : ~0u));
  emit_immediate(Opcode::Shl, address_, address_, own ? own_.shift : 2);
  emit(Opcode::Iadd, address_, address_, own ? base_ : shared_);
  if (offset != 0) emit_immediate(Opcode::Isub, address_, address_, offset);
}

void ProgramStatements::access(bool store, uint32_t offset, bool of_four) {
  Instruction i;
  const bool three = of_four && !store && chance(2);
  const bool inval = has(Opcode::Inval) && chance(4);
  i.info = &instruction(inval ? Opcode::Inval : store ? Opcode::St : three ? Opcode::Ld3 : Opcode::Ld);
  if (chance(2)) i.guard = any_predicate(), i.guard_negated = chance(2);
  i.ra = address_;
  i.immediate = offset;
  if (store)
    i.rb = source();
  else if (!inval)
    i.rd = three ? destination_of_three(-1, -1) : destination();
  emit(i);
}

void ProgramStatements::far_address(bool own, uint32_t spread) {
  const int other = destination();
  if (own) {
    emit(Opcode::Block, address_);
    emit_immediate(Opcode::And, address_, address_, block_mask_);
    emit_immediate(Opcode::Shl, address_, address_, kFarWarpBits);
    emit(Opcode::Warp, other);
    emit(Opcode::Iadd, address_, address_, other);
    emit_immediate(Opcode::Shl, address_, address_, 7);
    emit_immediate(Opcode::Iadd, address_, address_, kLineBytes);
  } else {
    emit_immediate(Opcode::Mov, address_, 0, below(1u << kFarWarpBits) << 7);
  }
  const auto add = [&](Opcode number, uint32_t mask, uint32_t shift) {
    emit(number, other);
    emit_immediate(Opcode::And, other, other, mask);
    emit_immediate(Opcode::Shl, other, other, shift);
    emit(Opcode::Iadd, address_, address_, other);
  };
  add(Opcode::Lane, chance(2) ? 15 : 3, 2);
  if (spread < 32) add(chance(2) ? Opcode::Lane : Opcode::Warp, chance(2) ? 1 : 31, spread);
}

void ProgramStatements::far_memory() {
  const bool own = chance(2);
  const auto upper_bit = [this] { return chance(2) ? 31 : kFarUpperBit + below(32 - kFarUpperBit); };
  const uint32_t spread = chance(2) ? upper_bit() : 32;
  // What lanes or warps add must not carry, and one bit must be set and one clear so that the
  // address lies between data and limit.
  const uint32_t added = spread < 32 ? 31u << spread : 0;
  uint32_t bits = ~added & (~0u << kFarBit);
  const auto take = [&] {
    uint32_t bit = 0;
    do bit = 1u << (kFarBit + below(32 - kFarBit));
    while ((bits & bit) == 0);
    bits &= ~bit;
    return bit;
  };
  const uint32_t set = take(), clear = take();
  const uint32_t base = ((static_cast<uint32_t>(random()) & ~0u << kFarUpperBit & ~added) | set) & ~clear;
  uint32_t flip = 0;
  do flip = 1u << upper_bit();
  while ((flip & (added | set | clear)) != 0);
  far_address(own, spread);
  const int accesses = 1 + below(4);
  for (int n = 0; n < accesses; ++n) access(own && chance(2), base ^ (chance(2) ? flip : 0));
}

void ProgramStatements::memory() {
  if (far_memory_told_ && chance(3)) return far_memory();
  const bool own = !chance(3);
  const uint32_t offset = chance(3) ? value() : 0;
  const uint32_t entries = own ? own_.entries : shared_bytes_ / 4;
  // Either all accesses go to the same words, or each to others of the same set of the cache, so that lines push each
  // other out and wait for miss-status holding registers.
  const uint32_t lines = entries / (own ? own_.way_entries : way_bytes() / 4);
  const uint32_t parts = lines > 1 && chance(2) ? std::min(lines, kMostParts) : 1;
  const uint32_t part_bytes = (entries / parts) << (own ? own_.shift : 2);
  const bool of_four = configuration_.triples && (!own || own_.shift == 2) && entries / parts >= 4 && chance(2);
  address(own, offset, entries / parts, of_four);
  const int accesses = 1 + below(parts > 1 ? 2 * parts : 4);
  for (int n = 0; n < accesses; ++n) {
    // So that a load or store comes after every type.
    if (chance(parts > 1 ? 12 : 4)) plain();
    if (chance(8) && written_words_ > 0 && !in_function_)
      emit_word(Opcode::Rld, below(static_cast<uint32_t>(written_words_)), destination());
    access(own && chance(2), offset + below(parts) * part_bytes, of_four);
  }
}

void ProgramStatements::ray(bool top) {
  if (!top) {
    if (in_function_) return plain();
    const int words = chance(2) ? kRayWords : 1 + static_cast<int>(below(intersection_words_));
    for (int n = 0; n < words;) n += store_words(n, words - n);
    for (int n = 0; n < 2; ++n) emit_word(Opcode::Rld, below(static_cast<uint32_t>(words)), destination());
    if (words >= kRayWords) rotate();
    written_words_ = 0;
    return;
  }
  if (written_words_ > 0 && chance(3)) {
    load_word(chance(2) ? any_predicate() : 0);
  } else if (written_words_ >= kRayWords && chance(2)) {
    rotate();
  } else if (written_words_ > 0 && (written_words_ == static_cast<int>(intersection_words_) || chance(3))) {
    const auto words = static_cast<uint32_t>(written_words_);
    if (configuration_.triples && words >= kElements && chance(2))
      emit_word(Opcode::Rst3, below(words - kElements + 1), 0, any_predicate());
    else
      emit_word(Opcode::Rst, below(words), 0, any_predicate());
  } else {
    // Words are written from 0 up, unmasked the first time, so that nothing undefined is ever read or exported.
    const int count = std::min<int>(static_cast<int>(intersection_words_) - written_words_, 1 + below(14));
    for (const int end = written_words_ + count; written_words_ < end;)
      written_words_ += store_words(written_words_, end - written_words_);
  }
}

void ProgramStatements::load_word(int guard) {
  const auto words = static_cast<uint32_t>(written_words_);
  if (configuration_.triples && words >= kElements && chance(2))
    emit_word(Opcode::Rld3, below(words - kElements + 1), destination_of_three(-1, -1), guard);
  else
    emit_word(Opcode::Rld, below(words), destination(), guard);
}

int ProgramStatements::store_words(int word, int left) {
  const bool three = configuration_.triples && left >= kElements && chance(2);
  emit_word(three ? Opcode::Rst3 : Opcode::Rst, word);
  return three ? kElements : 1;
}

void ProgramStatements::rotate() {
  Instruction i;
  i.info = &instruction(chance(3) ? Opcode::Rfb : Opcode::Rout);
  if (chance(2)) i.guard = any_predicate(), i.guard_negated = chance(2);
  emit(i);
  written_words_ = 0;
  if (!chance(4)) return;
  // On to the set that is being exported, first to the words that are read last.
  i.guard = 0, i.guard_negated = true;
  for (uint32_t n = 1 + below(3); n > 0; --n) emit(i);
  for (int word = kRayWords; word > 0;) emit_word(Opcode::Rst, --word);
  written_words_ = kRayWords;
}

void ProgramStatements::begin_frame(int counter, int going, bool pad) {
  frames_.push_back({counter, going, std::nullopt, {}});
  if (!pad) return;
  // A loop's pad lies in the way.
  const size_t over = counter >= 0 ? emit(Opcode::Jany) : 0;
  frames_.back().pad = here();
  for (uint32_t n = 1 + below(3); n > 0; --n) plain();
  frames_.back().leaves.push_back(emit(Opcode::Jany));
  if (counter >= 0) patch(over, here());
}

void ProgramStatements::end_frame() {
  // Nothing is executed at these targets: an end reached is an end, however far beyond.
  for (const size_t at : frames_.back().leaves) {
    const uint32_t end = here(), most = 0xffff - end;
    patch(at, end + (chance(4) ? 0 : chance(2) ? std::min(most, 1 + below(8)) : chance(2) ? below(most + 1) : most));
  }
  frames_.pop_back();
}

void ProgramStatements::leave() {
  const Frame& frame = frames_.back();
  if (frame.counter >= 0) {
    emit_immediate(Opcode::Isub, frame.counter, frame.counter, 1, frame.going);
    emit_immediate(Opcode::Igt, frame.going, frame.counter, 0);
  }
  Instruction i;
  i.info = &instruction(chance(2) ? Opcode::Jany : Opcode::Jnone);
  i.guard = any_predicate();
  i.guard_negated = chance(2);
  if (frame.pad && chance(2)) i.immediate = *frame.pad;
  const size_t at = emit(i);
  if (i.immediate == 0) frames_.back().leaves.push_back(at);
}

void ProgramStatements::loop(int length, int loops, int entries) {
  const int counter = data_registers_ + loops;
  const int going = loop_predicate_ + loops;
  begin_frame(counter, going, chance(4));
  // Threads leave after different numbers of rounds.
  emit(Opcode::Lane, counter);
  emit_immediate(Opcode::And, counter, counter, below(4));
  emit_immediate(Opcode::Iadd, counter, counter, below(2));
  emit_immediate(Opcode::Igt, going, counter, 0);
  written_words_ = 0;
  const size_t start = emit(Opcode::Loop, 0, 0, 0, going);
  body(length, loops + 1, entries + 1);
  emit_immediate(Opcode::Isub, counter, counter, 1, going);
  emit_immediate(Opcode::Igt, going, counter, 0);
  patch(start, here());
  end_frame();
  written_words_ = 0;
}

void ProgramStatements::short_loop() {
  const int counter = destination(), going = free_predicate();
  emit(Opcode::Lane, counter);
  emit_immediate(Opcode::And, counter, counter, below(4));
  emit_immediate(Opcode::Iadd, counter, counter, below(2));
  emit_immediate(Opcode::Igt, going, counter, 0);
  const size_t start = emit(Opcode::Loop, 0, 0, 0, going);
  for (uint32_t n = below(4); n > 0; --n) {
    const int other = destination();
    if (other != counter) emit(Opcode::Iadd, other, source(), counter, going);
  }
  emit_immediate(Opcode::Isub, counter, counter, 1, going);
  emit_immediate(Opcode::Igt, going, counter, 0);
  patch(start, here());
}

void ProgramStatements::jump(int loops, int entries) {
  if (!frames_.empty() && chance(2)) return leave();
  Instruction i;
  i.info = &instruction(chance(2) ? Opcode::Jany : Opcode::Jnone);
  i.guard = any_predicate();
  i.guard_negated = chance(2);
  const size_t at = emit(i);
  const int skipped = 1 + below(4);
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

void ProgramStatements::far_jump() {
  const size_t at = emit(Opcode::Jany);
  const uint32_t way = instruction_cache_bytes_ / 16;
  // From a PC that was executed just now to one that differs in one upper bit alone: it lies as far from the end of
  // what has been executed as that from the twin.
  const uint32_t twin = here() - std::min(here(), 1 + below(12));
  const uint32_t distance = 1u << (9 + below(7));
  if (chance(4) && (twin & distance) == 0 && twin + distance >= here())
    filler(twin + distance - here());
  else
    filler(chance(8) ? below(kFarJump) : chance(2) ? way - here() % way : below(2 * way));
  patch(at, here());
}

void ProgramStatements::filler(uint32_t count) {
  if (code_.size() + count > most_instructions_) return;
  for (uint32_t n = 0; n < count; ++n) code_.push_back(random());
}

void ProgramStatements::early_exit() {
  emit(Opcode::Warp, address_);
  const int leaves = free_predicate();
  emit_immediate(chance(2) ? Opcode::Ieq : Opcode::Ult, leaves, address_, below(warps_));
  const size_t at = emit(Opcode::Jnone, 0, 0, 0, leaves);
  emit(Opcode::Exit);
  patch(at, here());
}

void ProgramStatements::call(int loops, int entries) {
  if (entries >= stack_depth_ || call_sites_ >= kMostCalls) return;
  ++call_sites_;
  calls_.push_back({emit(Opcode::Call, 0, 0, 0, control_guard()), loops, entries});
}

void ProgramStatements::functions() {
  in_function_ = true;
  const bool deep = chance(4);
  while (!calls_.empty()) {
    const Call call = calls_.back();
    calls_.pop_back();
    if (profile_.far > 0 && chance(2)) filler(below(instruction_cache_bytes_ / 8));
    begin_frame(-1, 0, chance(3));
    const uint32_t start = here();
    body(1 + below(8), call.loops, call.entries + 1);
    // Deep stacks come from calls in calls.
    if (!chance(deep ? 16 : 2)) this->call(call.loops, call.entries + 1);
    const bool returns = chance(2);
    if (returns) emit(Opcode::Ret, 0, 0, 0, control_guard());
    uint32_t end = here();
    // An end that is never reached, with lower bits that are a PC inside.
    const uint32_t bits = configuration_.pc_bits;
    if (returns && bits < 16 && frames_.back().leaves.empty() && chance(2))
      end = (start + 1 + below(end - start)) | 1u << (bits + below(16 - bits));
    patch(call.at, start | end << 16);
    end_frame();
  }
  in_function_ = false;
}

}  // namespace raypool
