// Computes equal values once: value numbering over the dominator tree, for code in which guards mask lanes.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "kernel/compiler.hpp"
#include "kernel/liveness.hpp"
#include "kernel/needed_places.hpp"
#include "kernel/passes.hpp"

namespace raypool::kernel {
namespace {

size_t at(int number) { return static_cast<size_t>(number); }

/// Which ops have run whenever another one runs, and what may run between two of them.
class Order {
 public:
  explicit Order(const Function& function) : ops_(function.ops), block_of_(ops_.size()) {
    for (size_t i = 0; i < ops_.size(); ++i) {
      const bool begins = i == 0 || ops_[i].kind == Op::Kind::Label || is(ops_[i], Opcode::Loop) ||
                          (ends_block(ops_[i - 1]) && ops_[i - 1].kind != Op::Kind::Label);
      if (begins) first_.push_back(i);
      block_of_[i] = first_.size() - 1;
    }
    const auto successors = find_successors(function);
    predecessors_.resize(first_.size());
    for (size_t i = 0; i < ops_.size(); ++i) {
      if (i != end_of(block_of_[i]) - 1) continue;
      for (const size_t next : successors[i]) predecessors_[block_of_[next]].push_back(block_of_[i]);
    }
    find_dominators();
  }

  bool begins_block(size_t op) const { return first_[block_of_[op]] == op; }
  /// Whether each path to `op` leads through `first`.
  bool dominates(size_t first, size_t op) const {
    const size_t block = block_of_[first];
    size_t other = block_of_[op];
    if (block == other) return first < op;
    if (dominator_[other] == kUnknown) return false;
    while (other != 0 && other != block) other = dominator_[other];
    return other == block;
  }
  /// Whether `visit` is true of an op that may run between them, after the last time that `first` ran, which dominates
  /// `op`.
  template <typename Visit>
  bool any_between(size_t first, size_t op, const Visit& visit) const {
    const auto any = [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        if (visit(ops_[i])) return true;
      return false;
    };
    const size_t block = block_of_[first], last = block_of_[op];
    if (block == last) return any(first + 1, op);
    if (any(first + 1, end_of(block)) || any(first_[last], op)) return true;
    std::vector<bool> seen(first_.size(), false);
    std::vector<size_t> open = {last};
    while (!open.empty()) {
      const size_t current = open.back();
      open.pop_back();
      for (const size_t before : predecessors_[current]) {
        if (before == block || seen[before]) continue;
        seen[before] = true;
        if (any(first_[before], end_of(before))) return true;
        open.push_back(before);
      }
    }
    return false;
  }

 private:
  static constexpr size_t kUnknown = SIZE_MAX;

  size_t end_of(size_t block) const { return block + 1 < first_.size() ? first_[block + 1] : ops_.size(); }
  // Blocks are in an order in which only loops lead back.
  void find_dominators() {
    dominator_.assign(first_.size(), kUnknown);
    dominator_[0] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t block = 1; block < first_.size(); ++block) {
        size_t common = kUnknown;
        for (size_t before : predecessors_[block]) {
          if (dominator_[before] == kUnknown) continue;
          if (common == kUnknown) common = before;
          while (common != before) (common > before ? common : before) = dominator_[std::max(common, before)];
        }
        changed |= common != dominator_[block];
        dominator_[block] = common;
      }
    }
  }

  const std::vector<Op>& ops_;
  std::vector<size_t> block_of_, first_, dominator_;
  std::vector<std::vector<size_t>> predecessors_;
};

/// Numbers for the contents of registers or predicates: equal numbers are equal values.
class Contents {
 public:
  Contents(const Function& function, const Order& order, bool predicates)
      : order_(order),
        predicates_(predicates),
        definitions_(find_single_definitions(function, predicates)),
        numbers_(definitions_.size(), kNothing) {
    for (size_t number = 0; number < definitions_.size(); ++number) {
      // A register of which lanes stay undefined is like one with several definitions.
      if (definitions_[number] != kNothing && !predicates && !function.ops[at(definitions_[number])].fresh)
        definitions_[number] = kNothing;
    }
    replaceable_.assign(definitions_.size(), true);
    for (size_t i = 0; i < function.ops.size(); ++i) {
      const Effects effect = effects(function.ops[i]);
      const auto note = [&](int used) {
        if (used != kNothing && !defined_before(used, i)) replaceable_[at(used)] = false;
      };
      if (predicates)
        std::for_each(std::begin(effect.predicate_uses), std::end(effect.predicate_uses), note);
      else
        std::for_each(effect.register_uses.begin(), effect.register_uses.end(), note);
    }
  }

  int definition(int number) const { return definitions_[at(number)]; }
  bool has_one_definition(int number) const { return definitions_[at(number)] != kNothing; }
  bool defined_before(int number, size_t op) const {
    return has_one_definition(number) && order_.dominates(at(definitions_[at(number)]), op);
  }
  /// Every read finds what its only definition has left.
  bool is_replaceable(int number) const { return has_one_definition(number) && replaceable_[at(number)]; }

  void begin_block(int& fresh) {
    for (size_t number = 0; number < numbers_.size(); ++number)
      if (definitions_[number] == kNothing) numbers_[number] = fresh++;
  }
  /// Of what the op reads.
  int content(int number, size_t op, int& fresh) const {
    if (number == kNothing || (predicates_ && number == 0)) return kNothing;
    if (has_one_definition(number) && !defined_before(number, op)) return fresh++;
    return numbers_[at(number)];
  }
  void define(int number, int content) { numbers_[at(number)] = content; }

 private:
  const Order& order_;
  bool predicates_;
  std::vector<int> definitions_;
  std::vector<int> numbers_;
  std::vector<bool> replaceable_;
};

class Reuse {
 public:
  explicit Reuse(Function& function)
      : function_(function),
        order_(function),
        registers_(function, order_, false),
        predicates_(function, order_, true),
        for_register_(at(function.registers)),
        for_predicate_(at(function.predicates)) {
    std::iota(for_register_.begin(), for_register_.end(), 0);
    std::iota(for_predicate_.begin(), for_predicate_.end(), 0);
  }

  void run() {
    std::vector<bool> removed(function_.ops.size(), false);
    for (size_t i = 0; i < function_.ops.size(); ++i) {
      if (order_.begins_block(i)) registers_.begin_block(fresh_), predicates_.begin_block(fresh_);
      const Op& op = function_.ops[i];
      if (is_pure(op))
        removed[i] =
            writes_register(*op.info) ? visit(i, registers_, for_register_) : visit(i, predicates_, for_predicate_);
    }
    std::vector<Op> kept;
    for (size_t i = 0; i < function_.ops.size(); ++i) {
      if (removed[i]) continue;
      kept.push_back(function_.ops[i]);
      rename(kept.back());
    }
    function_.ops = std::move(kept);
  }

 private:
  // Opcode; guard, where the result depends on it; immediate and word; contents of ra, rb, rc, px.
  using Key = std::array<int64_t, 9>;
  struct Entry {
    size_t op;
    int content;
  };

  Key key_of(size_t place) {
    const Op& op = function_.ops[place];
    const bool by_guard = writes_predicate(*op.info);
    const auto in_register = [&](int number) { return registers_.content(number, place, fresh_); };
    const bool pb = has_operand(*op.info, Operand::Pb);
    int64_t ra = in_register(op.ra);
    int64_t rb = pb ? predicates_.content(op.rb, place, fresh_) : op.b_is_immediate ? kNothing : in_register(op.rb);
    int64_t opcode = static_cast<int64_t>(op.info->opcode);
    const auto other = exchanged(op.info->opcode);
    if (!pb && !op.b_is_immediate && op.rb != kNothing && other && rb < ra) {
      std::swap(ra, rb);
      opcode = static_cast<int64_t>(*other);
    }
    return {opcode,
            by_guard ? predicates_.content(op.guard.predicate, place, fresh_) : 0,
            by_guard && op.guard.negated ? 1 : 0,
            op.b_is_immediate ? 1 : 0,
            int64_t{op.immediate} << 8 | op.word,
            ra,
            rb,
            in_register(op.rc),
            predicates_.content(op.px, place, fresh_)};
  }

  /// True if the op is not needed any more.
  bool visit(size_t place, Contents& contents, std::vector<int>& replacements) {
    const Op& op = function_.ops[place];
    const int result = op.rd;
    const bool is_predicate = writes_predicate(*op.info);
    if (is_predicate && result == 0) return false;
    const bool keeps = function_.spill_memory && !is_predicate && function_.spill_memory->offset == result;
    const bool replaceable = !keeps && contents.is_replaceable(result);
    if (is_copy(op) && (is_predicate || op.fresh)) {
      const int source = contents.content(op.rb, place, fresh_);
      const bool same = (is_predicate && op.rb == 0) || contents.defined_before(op.rb, place);
      contents.define(result, source == kNothing ? fresh_++ : source);
      if (!replaceable || !same) return false;
      replacements[at(result)] = replacements[at(op.rb)];
      return true;
    }
    if (!contents.has_one_definition(result)) {
      contents.define(result, fresh_++);
      return false;
    }
    std::vector<Entry>& entries = known_[key_of(place)];
    for (const Entry& entry : entries) {
      if (!replaceable || !can_stand_for(entry.op, place)) continue;
      contents.define(result, entry.content);
      replacements[at(result)] = replacements[at(function_.ops[entry.op].rd)];
      return true;
    }
    contents.define(result, fresh_);
    entries.push_back({place, fresh_++});
    return false;
  }

  /// Whether an earlier op's result serves where the later one, which computes the same, is asked for its own.
  bool can_stand_for(size_t earlier, size_t later) {
    Op& first = function_.ops[earlier];
    const Op& op = function_.ops[later];
    if (!order_.dominates(earlier, later)) return false;
    const bool covered = writes_predicate(*op.info) || covers(first, earlier, op.guard, later);
    const bool reads_memory = is(op, Opcode::Ld);
    // In more lanes an access may fault, division takes longer, and an operand that is a copy may be undefined.
    if (!covered && (reads_memory || op.info->alu() == AluType::Slw || !same_operands(first, op))) return false;
    if (reads_memory || is(op, Opcode::Rld)) {
      const auto changes = [&](const Op& between) {
        return reads_memory ? changes_memory(between) : (words_changed(between) >> op.word & 1) != 0;
      };
      if (order_.any_between(earlier, later, changes)) return false;
    }
    if (!covered) first.guard = {};
    return true;
  }

  /// Whether the lanes of a guard are among those in which the op has run.
  bool covers(const Op& op, size_t place, const Guard& guard, size_t later) const {
    if (op.guard.all()) return true;
    if (op.guard.predicate != 0 && !predicates_.defined_before(op.guard.predicate, place)) return false;
    return is_within(guard, {for_predicate_[at(op.guard.predicate)], op.guard.negated}, later, 8);
  }
  bool is_within(Guard inner, const Guard& outer, size_t place, int depth) const {
    inner.predicate = for_predicate_[at(inner.predicate)];
    if (inner == outer) return true;
    if (inner.negated || inner.predicate == 0 || depth == 0) return false;
    if (!predicates_.defined_before(inner.predicate, place)) return false;
    const size_t definition = at(predicates_.definition(inner.predicate));
    const Op& op = function_.ops[definition];
    const auto within = [&](const Guard& part) { return is_within(part, outer, definition, depth - 1); };
    // What the result is made of holds the same at the definition of both: they have one definition before it.
    if (outer.predicate != 0 && !predicates_.defined_before(outer.predicate, definition)) return false;
    if (!op.guard.all() && within(op.guard)) return true;
    if (is(op, Opcode::Pand)) return within({op.px, false}) || within({op.rb, false});
    return is(op, Opcode::Pandn) && (within({op.px, false}) || within({op.rb, true}));
  }

  bool same_operands(Op first, Op op) const {
    rename(first), rename(op);
    const bool crossed = first.ra == op.rb && first.rb == op.ra;
    return ((first.ra == op.ra && first.rb == op.rb) || crossed) && first.rc == op.rc && first.px == op.px;
  }

  void rename(Op& op) const {
    if (op.kind != Op::Kind::Instruction) return;
    const auto in = [](const std::vector<int>& names, int& number) {
      if (number != kNothing) number = names[at(number)];
    };
    in(for_register_, op.ra);
    in(for_register_, op.rc);
    in(for_predicate_, op.px);
    in(for_predicate_, op.guard.predicate);
    in(has_operand(*op.info, Operand::Pb) ? for_predicate_ : for_register_, op.rb);
  }

  Function& function_;
  const Order order_;
  Contents registers_, predicates_;
  std::vector<int> for_register_, for_predicate_;  // [number] what is read in its place
  std::map<Key, std::vector<Entry>> known_;
  int fresh_ = 0;
};

/// The writes of one word with what it holds, in straight code and where one read dominates the write.
std::vector<bool> find_idle_writes(const Function& function) {
  const Order order(function);
  const Contents registers(function, order, false);
  int fresh = 0;
  std::vector<int> held(at(function.registers));
  std::array<int, kPackageWords> words{};
  std::vector<bool> idle(function.ops.size(), false);
  for (size_t i = 0; i < function.ops.size(); ++i) {
    if (order.begins_block(i)) {
      for (int& number : held) number = fresh++;
      for (int& number : words) number = fresh++;
    }
    const Op& op = function.ops[i];
    if (op.kind != Op::Kind::Instruction) continue;
    if (op.info->kind == Kind::Swap) {
      for (int& number : words) number = fresh++;
    } else if (is(op, Opcode::Rst)) {
      const int value = op.b_is_immediate ? kNothing : held[at(op.rb)];
      idle[i] = value == words[op.word];
      if (!idle[i] && value != kNothing && registers.defined_before(op.rb, i)) {
        const size_t definition = at(registers.definition(op.rb));
        const Op& read = function.ops[definition];
        idle[i] = is(read, Opcode::Rld) && read.word == op.word &&
                  !order.any_between(definition, i,
                                     [&](const Op& between) { return (words_changed(between) >> op.word & 1) != 0; });
      }
      if (idle[i]) continue;
      const bool whole = op.guard.all() || (op.spill == Spill::Store && op.fresh);
      words[op.word] = whole && value != kNothing ? value : fresh++;
    } else if (writes_register(*op.info)) {
      const bool known = op.fresh && (is(op, Opcode::Rld) || is_copy(op));
      held[at(op.rd)] = !known ? fresh++ : is_copy(op) ? held[at(op.rb)] : words[op.word];
    }
  }
  return idle;
}

}  // namespace

void reuse_values(Function& function) { Reuse(function).run(); }

void remove_idle_writes(Function& function) {
  std::vector<bool> removed = find_idle_writes(function);
  const auto keep_others = [&] {
    std::vector<Op> kept;
    for (size_t i = 0; i < function.ops.size(); ++i)
      if (!removed[i]) kept.push_back(function.ops[i]);
    function.ops = std::move(kept);
  };
  keep_others();
  remove_dead(function);
  const std::vector<NumberSet> needed = find_needed_places(function);
  removed.assign(function.ops.size(), false);
  for (size_t i = 0; i < function.ops.size(); ++i)
    removed[i] = is(function.ops[i], Opcode::Rst) && !needed[i].has(function.ops[i].word);
  keep_others();
  remove_dead(function);
}

}  // namespace raypool::kernel
