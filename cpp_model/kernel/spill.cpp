#include "kernel/spill.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "kernel/compiler.hpp"
#include "kernel/liveness.hpp"
#include "kernel/needed_places.hpp"
#include "kernel/passes.hpp"

namespace raypool::kernel {
namespace {

constexpr int kMostRounds = 400;
constexpr int kFewestPlaces = 8;   // when colouring fails although no more values are held than there are places
constexpr double kMemoryCost = 4;  // of an access, in instructions
constexpr double kLoopWeight = 8;  // how often a loop's body runs
constexpr int kDeepestLoop = 6;    // that is weighted
constexpr uint32_t kNoWords = 0;

size_t at(int number) { return static_cast<size_t>(number); }

/// Where a value lies while it is in no register.
struct Home {
  enum class Kind : uint8_t { None, Again, Word, Slot, Register };
  Kind kind = Kind::None;
  int number = kNothing;  ///< of the word, slot or register
};

/// What spilling one value or condition does to the code.
struct Plan {
  int number = kNothing;
  size_t first = 0;             ///< op from which on it is held
  std::vector<char> held;       ///< [op - first] whether its register still has it behind the op
  std::vector<size_t> reloads;  ///< ops before which it comes back
  std::vector<size_t> renamed;  ///< partial writes that go to a register of their own, and from there home
  double reload_cost = 0, store_cost = 0;
  int relieved = 0;  ///< places in the code that hold too many, and then one fewer
  Home home;
  double cost() const {
    const double access = home.kind == Home::Kind::Slot ? kMemoryCost : 1;
    return (reload_cost + store_cost) * access / relieved;
  }
};

/// Spills registers, or predicates.
class Spiller {
 public:
  Spiller(Function& function, bool predicates, SpillCounts& counts)
      : function_(function),
        predicates_(predicates),
        counts_(counts),
        limit_(predicates ? kPredicates - 1 : kRegisters) {}

  bool run() {
    for (int round = 0; round < kMostRounds; ++round) {
      prepare();
      if (std::none_of(pressure_.begin(), pressure_.end(), [&](int held) { return held > limit_; })) {
        if (has_places(function_, predicates_)) return true;
        if (--limit_ < kFewestPlaces) return false;
        continue;
      }
      const std::vector<Plan> plans = choose();
      if (plans.empty()) return false;
      for (const Plan& plan : plans) insert(plan);
      rebuild();
    }
    return false;
  }

 private:
  // What is known of the code, once a round.

  int numbers() const { return predicates_ ? function_.predicates : function_.registers; }
  const NumberSet& values_after(size_t op) const {
    return predicates_ ? values_.predicates_after[op] : values_.registers_after[op];
  }
  int defined(size_t op) const { return predicates_ ? effects_[op].predicate_defined : effects_[op].register_defined; }
  bool begins(size_t op, int number) const { return defined(op) == number && function_.ops[op].spill != Spill::Reload; }

  /// It follows what defines the number, and finds it in its register.
  bool is_store_of(size_t op, int number) const {
    const Op& store = function_.ops[op];
    return store.spill == Spill::Store && (predicates_ ? store.guard.predicate : store.rb) == number;
  }

  void prepare() {
    const std::vector<Op>& ops = function_.ops;
    const size_t size = ops.size();
    Liveness live = find_liveness(function_);
    live_ = std::move(predicates_ ? live.predicates_after : live.registers_after);
    values_ = find_liveness(function_, true);
    effects_.clear();
    for (const Op& op : ops) effects_.push_back(effects(op));
    find_predecessors();
    find_readers();
    next_of_source_.assign(size, size);
    for (size_t i = size - 1; i-- > 0;)
      next_of_source_[i] = ops[i + 1].spill == Spill::None ? i + 1 : next_of_source_[i + 1];
    homes_.resize(at(numbers()));
    counted_.resize(at(numbers()), false);
    excluded_.assign(at(numbers()), false);
    if (predicates_) excluded_[0] = true;
    ranges_.assign(at(numbers()), {size, 0});
    definitions_.assign(at(numbers()), {});
    weight_.assign(size, 1);
    pressure_.assign(size, 0);
    before_.assign(size, {});
    behind_.assign(size, {});
    double weight = 1;
    int depth = 0;
    for (size_t i = 0; i < size; ++i) {
      if (ops[i].kind == Op::Kind::LoopEnd && --depth < kDeepestLoop) weight /= kLoopWeight;
      weight_[i] = weight;
      if (is(ops[i], Opcode::Loop)) {
        if (++depth <= kDeepestLoop) weight *= kLoopWeight;
        // Its guard is read again at the end of the body, where nothing could be put before it.
        if (predicates_) excluded_[at(ops[i].guard.predicate)] = true;
      }
      note(i);
    }
    find_busy_places();
  }
  void find_predecessors() {
    const size_t size = function_.ops.size();
    predecessors_.assign(size, {});
    const auto successors = find_successors(function_);
    for (size_t i = 0; i < size; ++i)
      for (const size_t next : successors[i]) predecessors_[next].push_back(i);
    follows_.assign(size, 0);
    for (size_t i = 1; i < size; ++i)
      follows_[i] = predecessors_[i].size() == 1 && predecessors_[i][0] + 1 == i ? 1 : 0;
  }
  void find_readers() {
    readers_.assign(at(numbers()), {});
    for (size_t i = 0; i < effects_.size(); ++i) {
      const auto note = [&](int number) {
        if (number == kNothing) return;
        std::vector<size_t>& its = readers_[at(number)];
        if (its.empty() || its.back() != i) its.push_back(i);
      };
      if (predicates_)
        std::for_each(std::begin(effects_[i].predicate_uses), std::end(effects_[i].predicate_uses), note);
      else
        std::for_each_n(effects_[i].register_uses.begin(), effects_[i].operands, note);
    }
  }
  void note(size_t op) {
    NumberSet held = live_[op];
    const auto touch = [&](int number) {
      if (number == kNothing) return;
      auto& [first, last] = ranges_[at(number)];
      first = std::min(first, op), last = std::max(last, op);
    };
    values_after(op).for_each(touch);
    if (predicates_)
      std::for_each(std::begin(effects_[op].predicate_uses), std::end(effects_[op].predicate_uses), touch);
    else
      std::for_each(effects_[op].register_uses.begin(), effects_[op].register_uses.end(), touch);
    const int number = defined(op);
    if (number != kNothing && !(predicates_ && number == 0)) {
      touch(number);
      held.insert(number);
      // Nothing has to be kept of a register in which nothing is held yet.
      if (begins(op, number) && function_.ops[op].kind == Op::Kind::Instruction) definitions_[at(number)].push_back(op);
    }
    pressure_[op] = held.count();
  }

  void find_busy_places() {
    const size_t size = function_.ops.size();
    busy_.assign(size, kNoWords);
    word_uses_.fill(0);
    written_.assign(size, kNoWords);
    busy_slots_.clear();
    if (predicates_) return;
    const std::vector<NumberSet> needed = find_needed_places(function_);
    for (size_t i = 0; i < size; ++i) {
      needed[i].for_each([&](int place) {
        if (place < kPackageWords) take_word(i, place);
      });
    }
    for (int number = 0; number < numbers(); ++number) reserve(number, homes_[at(number)]);
  }

  /// Visits the ops behind which the value exists, in a register or elsewhere.
  template <typename Visit>
  void for_range(int number, const Visit& visit) const {
    const auto [first, last] = ranges_[at(number)];
    for (size_t i = first; i <= last && i < function_.ops.size(); ++i)
      if (values_after(i).has(number) || begins(i, number)) visit(i);
  }
  void take_word(size_t op, int word) {
    if ((busy_[op] >> word & 1) != 0) return;
    busy_[op] |= 1u << word;
    ++word_uses_[at(word)];
  }
  void reserve(int number, const Home& home) {
    if (home.kind == Home::Kind::Word) {
      for_range(number, [&](size_t i) {
        take_word(i, home.number);
        written_[i] |= 1u << home.number;
      });
    } else if (home.kind == Home::Kind::Slot) {
      while (busy_slots_.size() <= at(home.number)) busy_slots_.emplace_back(static_cast<int>(function_.ops.size()));
      for_range(number, [&](size_t i) { busy_slots_[at(home.number)].insert(static_cast<int>(i)); });
    } else if (home.kind == Home::Kind::Again) {
      const Op& op = function_.ops[definitions_[at(number)].front()];
      if (is(op, Opcode::Rld)) for_range(number, [&](size_t i) { take_word(i, op.word); });
    }
  }

  // Where a value can lie.

  /// Words that something changes, or that are needed otherwise, while the value exists; all of them across a swap.
  uint32_t words_taken(int number, bool needed_too) const {
    uint32_t taken = 0;
    for_range(number, [&](size_t i) {
      taken |= needed_too ? busy_[i] : written_[i];
      if (!begins(i, number)) taken |= words_changed(function_.ops[i]);
    });
    return taken;
  }
  bool can_be_recomputed(int number) const {
    if (definitions_[at(number)].size() != 1) return false;
    const Op& op = function_.ops[definitions_[at(number)].front()];
    if (predicates_)
      return op.guard.all() && (is(op, Opcode::Pand) || is(op, Opcode::Pxor)) && op.px == 0 && op.rb == 0;
    if (op.kind != Op::Kind::Instruction || !op.fresh || op.spill != Spill::None) return false;
    if (is(op, Opcode::Rld)) return (words_taken(number, false) >> op.word & 1) == 0;
    return op.info->alu() == AluType::Tid || (is(op, Opcode::Mov) && op.b_is_immediate);
  }
  bool is_offset(int number) const {
    return !predicates_ && function_.spill_memory && number == function_.spill_memory->offset;
  }
  Home find_home(int number) const {
    // What has a home keeps it: partial writes may go there and nowhere else.
    if (has_home(number)) return homes_[at(number)];
    if (can_be_recomputed(number)) return {Home::Kind::Again, kNothing};
    // More and more code reads it.
    if (is_offset(number)) return {};
    if (predicates_) return {Home::Kind::Register, kNothing};
    const int word = find_word(number);
    if (word != kNothing) return {Home::Kind::Word, word};
    const int slot = find_slot(number);
    if (slot != kNothing) return {Home::Kind::Slot, slot};
    return {};
  }
  int find_word(int number) const {
    const uint32_t free = ~words_taken(number, true) & ((1u << function_.slice_words) - 1);
    // Best the word that the value ends in, else the one with the least room for others.
    const auto [first, last] = ranges_[at(number)];
    for (size_t i = first; i <= last; ++i) {
      const Op& op = function_.ops[i];
      if (is(op, Opcode::Rst) && op.spill == Spill::None && !op.b_is_immediate && op.rb == number &&
          (free >> op.word & 1) != 0)
        return op.word;
    }
    int best = kNothing;
    int most = -1;
    for (int word = 0; word < function_.slice_words; ++word) {
      if ((free >> word & 1) == 0) continue;
      const int used = word_uses_[at(word)];
      if (used > most) most = used, best = word;
    }
    return best;
  }
  int find_slot(int number) const {
    if (!function_.spill_memory) return kNothing;
    const std::vector<size_t>& offset = definitions_[at(function_.spill_memory->offset)];
    if (offset.empty()) return kNothing;
    // What begins before the offset is there is stored behind it.
    if (ranges_[at(number)].first < offset.front() && definitions_[at(number)].size() != 1) return kNothing;
    for (int slot = 0; slot < function_.spill_memory->slots; ++slot) {
      if (at(slot) >= busy_slots_.size()) return slot;
      bool free = true;
      for_range(number, [&](size_t i) { free = free && !busy_slots_[at(slot)].has(static_cast<int>(i)); });
      if (free) return slot;
    }
    return kNothing;
  }

  // Which value is spilled.

  bool holds_too_many(size_t op) const { return pressure_[op] > limit_; }
  /// Nothing is gained between here and the next op of the source if that reads the number.
  bool read_next(size_t op, int number) const {
    const std::vector<size_t>& readers = readers_[at(number)];
    const auto next = std::upper_bound(readers.begin(), readers.end(), op);
    return next != readers.end() && *next <= next_of_source_[op];
  }

  /// The register keeps the value until the code holds too many; then it comes back before the next op that reads it.
  Plan plan_for(int number) const {
    Plan plan;
    plan.number = number;
    const size_t first = ranges_[at(number)].first, last = ranges_[at(number)].second;
    plan.first = first;
    plan.held.assign(last - first + 1, 1);
    std::vector<char> reads(last - first + 1, 0);  // as an operand, not only because a guard leaves lanes as they are
    for (const size_t op : readers_[at(number)]) reads[op - first] = 1;
    const auto held_before = [&](size_t op) {
      if (follows_[op] != 0) return op > first && plan.held[op - 1 - first] != 0;
      const std::vector<size_t>& predecessors = predecessors_[op];
      return !predecessors.empty() && std::all_of(predecessors.begin(), predecessors.end(), [&](size_t before) {
        return before >= first && before <= last && plan.held[before - first] != 0;
      });
    };
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t i = first; i <= last; ++i) {
        bool held = held_before(i) || (reads[i - first] != 0 && !is_store_of(i, number));
        if (defined(i) == number && !effects_[i].partial) held = true;
        if (held && holds_too_many(i) && live_[i].has(number) && !read_next(i, number)) held = false;
        changed |= (plan.held[i - first] != 0) != held;
        plan.held[i - first] = held ? 1 : 0;
      }
    }
    for (size_t i = first; i <= last; ++i) {
      const bool held = held_before(i);
      if (reads[i - first] != 0 && !held && !is_store_of(i, number)) {
        plan.reloads.push_back(i);
        plan.reload_cost += weight_[i];
      }
      const bool defines = defined(i) == number;
      if (defines && effects_[i].partial && !held && reads[i - first] == 0) plan.renamed.push_back(i);
      if (live_[i].has(number) && plan.held[i - first] == 0 && !defines && holds_too_many(i)) ++plan.relieved;
    }
    return plan;
  }

  std::vector<Plan> choose() {
    std::vector<Plan> plans;
    std::vector<bool> done = excluded_;
    for (;;) {
      NumberSet candidates(numbers());
      for (size_t i = 0; i < pressure_.size(); ++i)
        if (holds_too_many(i)) candidates.merge(live_[i]);
      Plan best;
      candidates.for_each([&](int number) {
        if (done[at(number)]) return;
        Plan plan = plan_for(number);
        if (plan.relieved == 0) return;
        plan.home = find_home(number);
        if (plan.home.kind == Home::Kind::None) return;
        const bool stored = plan.home.kind == Home::Kind::Again || has_home(number);
        for (const size_t op : definitions_[at(number)])
          plan.store_cost += stored ? 0 : weight_[op] * (predicates_ ? 2 : 1);
        if (best.number == kNothing || plan.cost() < best.cost()) best = std::move(plan);
      });
      if (best.number == kNothing) return plans;
      done[at(best.number)] = true;
      reserve(best.number, best.home);
      for (size_t i = best.first; i - best.first < best.held.size(); ++i) {
        if (best.held[i - best.first] != 0 || !live_[i].has(best.number)) continue;
        live_[i].erase(best.number);
        if (defined(i) != best.number) --pressure_[i];
      }
      plans.push_back(std::move(best));
    }
  }
  bool has_home(int number) const {
    const Home::Kind kind = homes_[at(number)].kind;
    return kind != Home::Kind::None && kind != Home::Kind::Again;
  }

  // The code that keeps it elsewhere.

  void insert(const Plan& plan) {
    const int number = plan.number;
    Home home = plan.home;
    if (home.kind == Home::Kind::Register && home.number == kNothing) home.number = function_.registers++;
    count(number, home);
    const bool stored = home.kind == Home::Kind::Again || has_home(number);
    for (const size_t i : definitions_[at(number)]) {
      Op& op = function_.ops[i];
      if (std::find(plan.renamed.begin(), plan.renamed.end(), i) == plan.renamed.end()) {
        size_t place = i;
        if (home.kind == Home::Kind::Slot)
          place = std::max(i, definitions_[at(function_.spill_memory->offset)].front());
        if (!stored) store(op, number, home, behind_[place]);
        continue;
      }
      const int own = function_.registers++;
      // A store of the round before follows it.
      if (stored) {
        for (size_t next = i + 1; function_.ops[next].spill != Spill::None; ++next)
          if (function_.ops[next].spill == Spill::Store && function_.ops[next].rb == number)
            function_.ops[next].rb = own;
      } else {
        store(op, own, home, behind_[i]);
      }
      op.rd = own;
      op.fresh = true;
    }
    for (const size_t i : plan.reloads) before_[i].push_back(reload(number, home, i));
    homes_[at(number)] = home;
  }
  void count(int number, const Home& home) {
    if (counted_[at(number)]) return;
    counted_[at(number)] = true;
    if (predicates_)
      ++counts_.predicates;
    else if (home.kind == Home::Kind::Again)
      ++counts_.recomputed;
    else
      ++(home.kind == Home::Kind::Word ? counts_.to_words : counts_.to_memory);
  }

  static Op new_op(Opcode opcode, const Location& where) {
    Op op;
    op.info = &instruction(opcode);
    op.where = where;
    return op;
  }
  Op with_home(Op op, const Home& home) const {
    if (home.kind == Home::Kind::Slot) {
      const SpillMemory& memory = *function_.spill_memory;
      op.ra = memory.offset;
      op.immediate = memory.base + static_cast<uint32_t>(home.number) * memory.stride;
      op.slot = home.number;
    } else {
      op.word = static_cast<uint8_t>(home.number);
    }
    return op;
  }

  void store(const Op& definition, int source, const Home& home, std::vector<Op>& code) const {
    if (home.kind == Home::Kind::Register) {
      // 1 where the condition holds, else 0.
      for (const bool value : {false, true}) {
        Op op = new_op(Opcode::Mov, definition.where);
        if (value) op.guard = {source, false};
        op.rd = home.number;
        op.b_is_immediate = true;
        op.immediate = value ? 1 : 0;
        op.fresh = !value;
        op.spill = Spill::Store;
        code.push_back(op);
      }
      return;
    }
    Op op = with_home(new_op(home.kind == Home::Kind::Word ? Opcode::Rst : Opcode::St, definition.where), home);
    op.guard = definition.guard;
    op.rb = source;
    op.fresh = definition.fresh || definition.guard.all();
    op.spill = Spill::Store;
    code.push_back(op);
  }

  /// In all lanes: more lanes than the reading op's may have the value, and it is the same that their register had.
  Op reload(int number, const Home& home, size_t place) const {
    const Location& where = function_.ops[place].where;
    Op op;
    if (home.kind == Home::Kind::Again) {
      op = function_.ops[definitions_[at(number)].front()];
      op.guard = {};
    } else if (home.kind == Home::Kind::Register) {
      op = new_op(Opcode::Igt, where);
      op.ra = home.number;
      op.b_is_immediate = true;
    } else {
      op = with_home(new_op(home.kind == Home::Kind::Word ? Opcode::Rld : Opcode::Ld, where), home);
    }
    op.rd = number;
    op.fresh = true;
    op.spill = Spill::Reload;
    op.where = where;
    return op;
  }

  void rebuild() {
    std::vector<Op> ops;
    for (size_t i = 0; i < function_.ops.size(); ++i) {
      ops.insert(ops.end(), before_[i].begin(), before_[i].end());
      ops.push_back(function_.ops[i]);
      ops.insert(ops.end(), behind_[i].begin(), behind_[i].end());
    }
    function_.ops = std::move(ops);
    // What has been recomputed keeps its first definition, as long as others may follow.
    const Liveness live = find_liveness(function_);
    std::vector<Op> kept;
    for (size_t i = 0; i < function_.ops.size(); ++i) {
      const Op& op = function_.ops[i];
      const NumberSet& needed = predicates_ ? live.predicates_after[i] : live.registers_after[i];
      if (op.spill != Spill::Reload || needed.has(op.rd)) kept.push_back(op);
    }
    function_.ops = std::move(kept);
  }

  Function& function_;
  bool predicates_;
  SpillCounts& counts_;
  int limit_;
  std::vector<NumberSet> live_;  // in registers, behind each op
  Liveness values_;              // wherever they are
  std::vector<Effects> effects_;
  std::vector<std::vector<size_t>> predecessors_;
  std::vector<char> follows_;                 // [op] only the op in front of it leads to it
  std::vector<std::vector<size_t>> readers_;  // [number] ops that have it as an operand
  std::vector<size_t> next_of_source_;        // [op] the next op that no spilling has put there
  std::vector<Home> homes_;                   // [number]
  std::vector<bool> counted_;                 // [number]
  std::vector<bool> excluded_;
  std::vector<std::pair<size_t, size_t>> ranges_;  // [number] first and last op
  std::vector<std::vector<size_t>> definitions_;   // [number] without reloads
  std::vector<double> weight_;                     // [op]
  std::vector<int> pressure_;                      // [op] how many are held
  std::array<int, kPackageWords> word_uses_{};     // [word] ops where it is busy
  std::vector<uint32_t> busy_;                     // [op] words, a bit each
  std::vector<uint32_t> written_;                  // [op] words that other values lie in
  std::vector<NumberSet> busy_slots_;              // [slot] ops
  std::vector<std::vector<Op>> before_, behind_;   // [op] what is put there
};

/// Where code jumps over what writes a register, lanes hold nothing in it before: states that in front of the outermost
/// jump or loop around its first write, for registers that would be held from the kernel's first op on.
void declare_late(Function& function) {
  const std::vector<Op>& ops = function.ops;
  std::vector<size_t> outermost(ops.size());
  size_t end = 0, begin = 0;
  for (size_t i = 0; i < ops.size(); ++i) {
    if (i >= end && (is(ops[i], Opcode::Jnone) || is(ops[i], Opcode::Loop))) {
      begin = i;
      for (end = i + 1; end < ops.size() && !(ops[end].kind != Op::Kind::Instruction &&
                                              ops[end].kind != Op::Kind::Undefined && ops[end].label == ops[i].label);)
        ++end;
    }
    outermost[i] = i < end ? begin : i;
  }
  // Behind the first op: what it defines has a place of its own.
  NumberSet held = find_liveness(function).registers_after.front();
  if (const int first = effects(ops.front()).register_defined; first != kNothing) held.erase(first);
  std::vector<std::vector<Op>> declared(ops.size());
  for (size_t i = 0; i < ops.size(); ++i) {
    const Effects effect = effects(ops[i]);
    for (int e = 0; e < effect.registers_defined; ++e) {
      const int number = effect.register_defined + e;
      if (!held.has(number)) continue;
      held.erase(number);
      Op op;
      op.kind = Op::Kind::Undefined;
      op.rd = number;
      op.fresh = true;
      op.where = ops[i].where;
      declared[outermost[i]].push_back(op);
    }
  }
  std::vector<Op> whole;
  for (size_t i = 0; i < ops.size(); ++i) {
    whole.insert(whole.end(), declared[i].begin(), declared[i].end());
    whole.push_back(ops[i]);
  }
  function.ops = std::move(whole);
}

/// Stores of values that never come back from there.
void remove_unneeded_stores(Function& function) {
  for (bool changed = true; changed;) {
    const std::vector<NumberSet> needed = find_needed_places(function);
    std::vector<Op> kept;
    for (size_t i = 0; i < function.ops.size(); ++i) {
      const Op& op = function.ops[i];
      const int place = op.slot == kNothing ? op.word : kPackageWords + op.slot;
      if (op.spill != Spill::Store || needed[i].has(place)) kept.push_back(op);
    }
    changed = kept.size() != function.ops.size();
    function.ops = std::move(kept);
    remove_dead(function);
  }
}

/// A warp starts with all predicates 0. A register that takes the place of one that is read before it is written, or
/// where its writes are jumped over, would hold what an older kernel has left.
void define_at_start(Function& function) {
  const Effects first = effects(function.ops.front());
  NumberSet read = find_liveness(function).predicates_after.front();
  if (first.predicate_defined != kNothing) read.erase(first.predicate_defined);
  for (const int used : first.predicate_uses)
    if (used != kNothing) read.insert(used);
  std::vector<Op> cleared;
  read.for_each([&](int number) {
    if (number != 0) cleared.push_back(clearing(number, function.ops.front().where));
  });
  // What begins before the offset is there finds no place in memory.
  auto place = function.ops.begin();
  if (function.spill_memory) {
    const auto is_offset = [&](const Op& op) { return effects(op).register_defined == function.spill_memory->offset; };
    place = std::next(std::find_if(place, function.ops.end(), is_offset));
  }
  function.ops.insert(place, cleared.begin(), cleared.end());
}

}  // namespace

bool spill(Function& function, SpillCounts& counts) {
  if (!has_places(function, true)) define_at_start(function);
  if (!Spiller(function, true, counts).run()) return false;
  remove_dead(function);
  // What has become of conditions are values like others.
  for (Op& op : function.ops) op.spill = Spill::None;
  declare_late(function);
  if (!Spiller(function, false, counts).run()) return false;
  function.spill_memory.reset();
  apply_where_places_suffice(function, remove_dead);
  apply_where_places_suffice(function, remove_unneeded_stores);
  return has_places(function, false) && has_places(function, true);
}

}  // namespace raypool::kernel
