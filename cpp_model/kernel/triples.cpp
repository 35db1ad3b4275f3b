// Makes triples of what a kernel does to three components: instructions that differ by consecutive registers, words,
// arguments or addresses only become one, and their code is put in an order in which they can.
#include "kernel/triples.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "kernel/compiler.hpp"

namespace raypool::kernel {
namespace {

using Three = std::array<int, kElements>;

/// Reads of register `from` become reads of `to`.
void replace_uses(Op& op, int from, int to) {
  if (op.kind != Op::Kind::Instruction) return;
  for (int* number : {&op.ra, &op.rc})
    if (*number == from) *number = to;
  if ((has_operand(*op.info, Operand::B) || has_operand(*op.info, Operand::Rb)) && op.rb == from) op.rb = to;
}

/// An op's effects, and a bit for each number modulo 64 that it touches: two that share none do not depend on each
/// other. Most pairs do not.
struct Touched {
  explicit Touched(const Op& op) : effect(effects(op)) {
    for (const int number : effect.register_uses) reads |= bit(number);
    for (int e = 0; e < effect.registers_defined; ++e) writes |= bit(effect.register_defined + e);
    for (const int number : effect.predicate_uses) reads |= bit(number);
    writes |= bit(effect.predicate_defined);
    memory = op.info->alu() == AluType::Mem || op.info->alu() == AluType::Ray;
  }
  static uint64_t bit(int number) { return number == kNothing ? 0 : uint64_t{1} << (number & 63); }
  bool apart(const Touched& other) const {
    return (writes & (other.reads | other.writes)) == 0 && (reads & other.writes) == 0 && !(memory && other.memory);
  }

  Effects effect;
  uint64_t reads = 0, writes = 0;
  bool memory = false;
};

/// Straight code between two places where threads part or meet.
class Segment {
 public:
  Segment(Function& function, size_t begin, size_t end, const std::vector<bool>& written_once)
      : function_(function),
        ops_(function.ops.begin() + begin, function.ops.begin() + end),
        written_once_(written_once) {
    in_triple_.assign(ops_.size(), false);
    const std::vector<Touched> touched(ops_.begin(), ops_.end());
    for (size_t i = 0; i < ops_.size(); ++i)
      for (size_t j = i + 1; j < ops_.size(); ++j)
        if (depends(ops_[i], touched[i], ops_[j], touched[j])) stays_before_.emplace_back(i, j);
  }

  /// Up to `most` triples, the others stay as they are; takes from it what it has made.
  std::vector<Op> form(int& most) {
    // First leaves that are used alike, of which most triples can be made.
    for (const bool used_alike : {true, false}) {
      for (const Opcode opcode : {Opcode::Rld, Opcode::Arg, Opcode::Ld}) form_leaves(opcode, used_alike, most);
      while (form_arithmetic(most)) continue;
      form_stores(most);
    }
    return in_order();
  }

 private:
  struct Triple {
    Three members;  // places in ops_
    Op op;
  };

  bool may_join(int a, int b) const {
    const Op& first = ops_[a];
    const Op& other = ops_[b];
    return !in_triple_[b] && other.info == first.info && other.guard == first.guard &&
           other.b_is_immediate == first.b_is_immediate;
  }
  bool writes_own_register(int at) const { return written_once_[ops_[at].rd]; }

  // What is numbered: words, arguments, addresses.
  static uint32_t number_of(const Op& op) {
    return is(op, Opcode::Rld) || is(op, Opcode::Rst) ? op.word : op.immediate / (is(op, Opcode::Ld) ? 4 : 1);
  }

  std::optional<int> find_next(int first, uint32_t number) const {
    for (int i = 0; i < static_cast<int>(ops_.size()); ++i) {
      if (i != first && may_join(first, i) && number_of(ops_[i]) == number && ops_[i].ra == ops_[first].ra) return i;
    }
    return std::nullopt;
  }

  // Three leaves become one, with registers that follow each other.
  void form_leaves(Opcode opcode, bool used_alike, int& most) {
    std::vector<int> places;
    for (int i = 0; i < static_cast<int>(ops_.size()); ++i)
      if (is(ops_[i], opcode) && writes_own_register(i)) places.push_back(i);
    std::stable_sort(places.begin(), places.end(),
                     [&](int a, int b) { return number_of(ops_[a]) < number_of(ops_[b]); });
    for (const int first : places) {
      if (in_triple_[first] || (opcode == Opcode::Ld && ops_[first].immediate % 16 != 0)) continue;
      const std::optional<int> second = find_next(first, number_of(ops_[first]) + 1);
      const std::optional<int> third = find_next(first, number_of(ops_[first]) + 2);
      if (!second || !third || !writes_own_register(*second) || !writes_own_register(*third)) continue;
      if (used_alike && !(users_of(first) == users_of(*second) && users_of(first) == users_of(*third))) continue;
      add({first, *second, *third}, ops_[first], most);
    }
  }

  /// What the op's result is used by.
  std::vector<const InstructionInfo*> users_of(int at) const {
    std::vector<const InstructionInfo*> users;
    for (const Op& op : ops_) {
      const Effects effect = effects(op);
      if (std::find(effect.register_uses.begin(), effect.register_uses.end(), ops_[at].rd) !=
          effect.register_uses.end())
        users.push_back(op.info);
    }
    std::sort(users.begin(), users.end());
    return users;
  }

  /// Makes a triple of the op and of two others that do the same to the next registers of groups. True if there are.
  bool form_arithmetic(int& most) {
    for (int first = 0; first < static_cast<int>(ops_.size()); ++first) {
      if (in_triple_[first] || !triple_of(ops_[first], false) || ops_[first].info->alu() != AluType::Flt) continue;
      if (!writes_own_register(first)) continue;
      for (const bool exchanged : {false, true}) {
        if (exchanged && !may_exchange(ops_[first])) continue;
        const Op op = exchanged ? exchange(ops_[first]) : ops_[first];
        const bool one_ra = position(op.ra) != 0;
        if (one_ra && !triple_of(op, true)) continue;
        Three members = {first, kNothing, kNothing};
        for (int e = 1; e < kElements; ++e) members[e] = find_element(first, op, e, one_ra);
        if (members[1] == kNothing || members[2] == kNothing) continue;
        if (add(members, op, most)) return true;
      }
    }
    return false;
  }

  /// The op that does to the e-th registers what `op` does to the first ones.
  int find_element(int first, const Op& op, int e, bool one_ra) const {
    const auto follows = [&](int a, int b, bool same) {
      return a == kNothing || same ? a == b : position(a) == 0 && b == a + e;
    };
    bool any = false;
    for (const int operand : {one_ra ? kNothing : op.ra, op.b_is_immediate ? kNothing : op.rb, op.rc})
      any |= operand != kNothing;
    if (!any) return kNothing;
    for (int i = 0; i < static_cast<int>(ops_.size()); ++i) {
      if (i == first || !may_join(first, i) || !writes_own_register(i)) continue;
      for (const bool exchanged : {false, true}) {
        if (exchanged && !may_exchange(ops_[i])) continue;
        const Op other = exchanged ? exchange(ops_[i]) : ops_[i];
        const bool fits_b = op.b_is_immediate ? other.immediate == op.immediate : follows(op.rb, other.rb, false);
        if (follows(op.ra, other.ra, one_ra) && fits_b && follows(op.rc, other.rc, false)) return i;
      }
    }
    return kNothing;
  }

  // Stores of one immediate, or of registers that follow each other.
  void form_stores(int& most) {
    for (int first = 0; first < static_cast<int>(ops_.size()); ++first) {
      const Op& op = ops_[first];
      if (in_triple_[first] || !is(op, Opcode::Rst) || (!op.b_is_immediate && position(op.rb) != 0)) continue;
      Three members = {first, kNothing, kNothing};
      for (int e = 1; e < kElements; ++e) {
        for (int i = 0; i < static_cast<int>(ops_.size()); ++i) {
          if (!may_join(first, i) || ops_[i].word != op.word + e) continue;
          if (op.b_is_immediate ? ops_[i].immediate == op.immediate : ops_[i].rb == op.rb + e) members[e] = i;
        }
      }
      if (members[1] != kNothing && members[2] != kNothing) add(members, op, most);
    }
  }

  static bool may_exchange(const Op& op) {
    return !op.b_is_immediate && (is(op, Opcode::Fadd) || is(op, Opcode::Fmul) || is(op, Opcode::Ffma));
  }
  static Op exchange(Op op) {
    std::swap(op.ra, op.rb);
    return op;
  }
  /// Place of a register in its group, kNothing: it is in none.
  int position(int number) const {
    for (const int base : function_.groups)
      if (number >= base && number < base + kElements) return number - base;
    return kNothing;
  }
  void rename(int from, int to) {
    const auto change = [&](Op& op) {
      replace_uses(op, from, to);
      if (op.kind == Op::Kind::Instruction && writes_register(*op.info) && op.rd == from) op.rd = to;
    };
    for (Op& op : ops_) change(op);
    for (Op& op : function_.ops) change(op);
    for (Triple& triple : triples_) change(triple.op);
  }

  /// False if there have been enough, or the code cannot be put in such an order.
  bool add(const Three& members, Op op, int& most) {
    if (most == 0) return false;
    op.info = triple_of(op, op.info->alu() == AluType::Flt && position(op.ra) != 0);
    for (const int member : members) in_triple_[member] = true;
    triples_.push_back({members, op});
    if (in_order().empty()) {
      for (const int member : members) in_triple_[member] = false;
      triples_.pop_back();
      return false;
    }
    if (writes_register(*op.info)) {
      const int base = function_.registers;
      function_.registers += kElements;
      function_.groups.push_back(base);
      std::array<int, kElements> registers;
      for (int e = 0; e < kElements; ++e) registers[e] = ops_[members[e]].rd;
      for (int e = 0; e < kElements; ++e) rename(registers[e], base + e);
    }
    --most;
    return true;
  }

  /// Whether b must stay behind a.
  static bool depends(const Op& a, const Touched& touched_by_a, const Op& b, const Touched& touched_by_b) {
    if (touched_by_a.apart(touched_by_b)) return false;
    const Effects &first = touched_by_a.effect, &second = touched_by_b.effect;
    const auto uses = [](const auto& list, int number) {
      return number != kNothing && std::find(std::begin(list), std::end(list), number) != std::end(list);
    };
    for (int e = 0; e < first.registers_defined; ++e)
      if (uses(second.register_uses, first.register_defined + e)) return true;
    for (int e = 0; e < second.registers_defined; ++e)
      if (uses(first.register_uses, second.register_defined + e)) return true;
    if (first.register_defined != kNothing && first.register_defined == second.register_defined) return true;
    if (uses(second.predicate_uses, first.predicate_defined) || uses(first.predicate_uses, second.predicate_defined))
      return true;
    if (first.predicate_defined != kNothing && first.predicate_defined == second.predicate_defined) return true;
    if (a.info->alu() == AluType::Mem && b.info->alu() == AluType::Mem) return changes_memory(a) || changes_memory(b);
    if (a.info->alu() != AluType::Ray || b.info->alu() != AluType::Ray) return false;
    if (a.info->kind == Kind::Swap || b.info->kind == Kind::Swap) return true;
    const bool reads = !is(a, Opcode::Rst) && !is(a, Opcode::Rst3) && !is(b, Opcode::Rst) && !is(b, Opcode::Rst3);
    return !reads && a.word < b.word + elements(b) && b.word < a.word + elements(a);
  }

  /// The code with its triples, empty if they wait for each other. From the end: what needs no register comes as late
  /// as it can, of the rest what stood last.
  std::vector<Op> in_order() const {
    std::vector<std::pair<Op, int>> nodes;  // and the place of its last instruction
    std::vector<int> node_of(ops_.size());
    for (const Triple& triple : triples_) {
      for (const int member : triple.members) node_of[member] = static_cast<int>(nodes.size());
      nodes.emplace_back(triple.op, *std::max_element(triple.members.begin(), triple.members.end()));
    }
    for (size_t i = 0; i < ops_.size(); ++i) {
      if (in_triple_[i]) continue;
      node_of[i] = static_cast<int>(nodes.size());
      nodes.emplace_back(ops_[i], static_cast<int>(i));
    }
    std::vector<std::vector<int>> before(nodes.size());
    std::vector<int> behind(nodes.size(), 0);
    for (const auto& [first, second] : stays_before_) {
      if (node_of[first] == node_of[second]) continue;
      before[node_of[second]].push_back(node_of[first]);
      ++behind[node_of[first]];
    }
    return from_the_end(nodes, before, behind);
  }

  static std::vector<Op> from_the_end(const std::vector<std::pair<Op, int>>& nodes,
                                      const std::vector<std::vector<int>>& before, std::vector<int> behind) {
    const auto is_leaf = [](const Op& op) {
      const Effects effect = effects(op);
      return effect.register_defined != kNothing && effect.register_uses[0] == kNothing;
    };
    using Rank = std::pair<bool, int>;
    std::vector<Rank> ranks;
    for (const auto& [op, place] : nodes) ranks.emplace_back(is_leaf(op), place);
    std::vector<Op> order;
    std::vector<bool> placed(nodes.size(), false);
    while (order.size() < nodes.size()) {
      int best = kNothing;
      for (int n = 0; n < static_cast<int>(nodes.size()); ++n) {
        if (placed[n] || behind[n] != 0) continue;
        if (best == kNothing || ranks[n] > ranks[best]) best = n;
      }
      if (best == kNothing) return {};
      placed[best] = true;
      order.push_back(nodes[best].first);
      for (const int n : before[best]) --behind[n];
    }
    std::reverse(order.begin(), order.end());
    return order;
  }

  static const InstructionInfo* triple_of(const Op& op, bool one_ra) {
    if (op.kind != Op::Kind::Instruction) return nullptr;
    return find_triple(*op.info, one_ra);
  }

  Function& function_;
  std::vector<Op> ops_;
  const std::vector<bool>& written_once_;
  std::vector<bool> in_triple_;
  std::vector<Triple> triples_;
  /// Places of ops of which the second must stay behind the first. New names of registers change none of that.
  std::vector<std::pair<int, int>> stays_before_;
};

bool parts_threads(const Op& op) { return op.kind != Op::Kind::Instruction || op.info->kind == Kind::Control; }

/// For each virtual register whether one op writes it, in all lanes that matter.
std::vector<bool> find_written_once(const Function& function) {
  std::vector<bool> once(function.registers, false), written(function.registers, false);
  for (const Op& op : function.ops) {
    const Effects effect = effects(op);
    if (effect.register_defined == kNothing) continue;
    once[effect.register_defined] = op.fresh && !written[effect.register_defined];
    written[effect.register_defined] = true;
  }
  return once;
}

/// Uses of copies become uses of what was copied, so that they do not part it from its group. Not where code runs
/// again: there a register that is written by one op has several values.
void look_through_copies(Function& function, const std::vector<bool>& written_once) {
  for (const Op& op : function.ops)
    if (op.kind == Op::Kind::LoopEnd) return;
  for (const Op& copy : function.ops) {
    if (!is(copy, Opcode::Mov) || !is_copy(copy) || !written_once[copy.rd] || !written_once[copy.rb]) continue;
    const int from = copy.rd, to = copy.rb;
    for (Op& op : function.ops) replace_uses(op, from, to);
  }
}

}  // namespace

int form_triples(Function& function, int most) {
  std::vector<bool> written_once = find_written_once(function);
  look_through_copies(function, written_once);
  remove_dead(function);
  const int wanted = most;
  for (size_t begin = 0; begin < function.ops.size();) {
    size_t end = begin;
    while (end < function.ops.size() && !parts_threads(function.ops[end])) ++end;
    Segment segment(function, begin, end, written_once);
    const std::vector<Op> ops = segment.form(most);
    written_once.resize(function.registers, false);
    function.ops.erase(function.ops.begin() + begin, function.ops.begin() + end);
    function.ops.insert(function.ops.begin() + begin, ops.begin(), ops.end());
    begin += ops.size() + 1;
  }
  return wanted - most;
}

}  // namespace raypool::kernel
