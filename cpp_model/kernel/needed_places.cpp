#include "kernel/needed_places.hpp"

#include <algorithm>
#include <array>

#include "machine/common/packages.hpp"

namespace raypool::kernel {
namespace {

/// A place is needed in the lanes of a guard. Only guards of reads and exports count, and those that the conditions in
/// them are computed from.
class Needs {
 public:
  explicit Needs(const Function& function) : function_(function) {
    for (const Op& op : function.ops) places_ = std::max(places_, kPackageWords + op.slot + 1);
    number_of({});
    for (const Op& op : function.ops)
      if (op.kind == Op::Kind::Instruction && (reads(op) || op.info->kind == Kind::Swap)) number_of(op.guard);
    for (bool changed = true; changed;) {
      const size_t before = guards_.size();
      for (const Op& op : function.ops) {
        if (op.kind != Op::Kind::Instruction || !writes_predicate(*op.info)) continue;
        for (const bool negated : {false, true})
          if (find({op.rd, negated}) != kNothing) number_of(origin(op, negated));
      }
      changed = guards_.size() != before;
    }
  }

  std::vector<NumberSet> run() {
    const size_t size = function_.ops.size();
    const int bits = places_ * guards();
    std::vector<NumberSet> before(size, NumberSet(bits)), after(size, NumberSet(bits));
    const auto successors = find_successors(function_);
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t i = size; i-- > 0;) {
        for (const size_t next : successors[i]) after[i].merge(before[next]);
        NumberSet needed = after[i];
        pass(function_.ops[i], needed);
        changed |= before[i].merge(needed);
      }
    }
    std::vector<NumberSet> result(size, NumberSet(places_));
    for (size_t i = 0; i < size; ++i) after[i].for_each([&](int bit) { result[i].insert(bit / guards()); });
    return result;
  }

 private:
  int guards() const { return static_cast<int>(guards_.size()); }
  static bool reads(const Op& op) { return is(op, Opcode::Rld) || (is(op, Opcode::Ld) && op.slot != kNothing); }
  static int place_of(const Op& op) { return op.slot == kNothing ? op.word : kPackageWords + op.slot; }

  int find(const Guard& guard) const {
    const auto found = std::find(guards_.begin(), guards_.end(), guard);
    return found == guards_.end() ? kNothing : static_cast<int>(found - guards_.begin());
  }
  int number_of(const Guard& guard) {
    const int found = find(guard);
    if (found != kNothing) return found;
    guards_.push_back(guard);
    return guards() - 1;
  }

  /// Lanes, before the op, among which are those that have its result, or have it not.
  static Guard origin(const Op& op, bool negated) {
    if (negated) {
      if (is_copy(op)) return {op.px, true};
      if (is(op, Opcode::Pandn) && op.px == 0 && op.guard.all()) return {op.rb, false};
      return {};
    }
    if (!op.guard.all()) return op.guard;
    if (is(op, Opcode::Pand)) return {op.px == 0 ? op.rb : op.px, false};
    if (is(op, Opcode::Pandn)) return {op.px == 0 ? op.rb : op.px, op.px == 0};
    return {};
  }

  /// From what is needed behind the op to what is needed before it.
  void pass(const Op& op, NumberSet& needed) const {
    if (op.kind != Op::Kind::Instruction) return;
    const int count = guards();
    if (is(op, Opcode::Rst) || (is(op, Opcode::St) && op.slot != kNothing)) {
      const bool everywhere = op.guard.all() || (op.spill == Spill::Store && op.fresh);
      const int own = find(op.guard);
      for (int g = 0; g < count; ++g)
        if (everywhere || g == own) needed.erase(place_of(op) * count + g);
    } else if (reads(op)) {
      needed.insert(place_of(op) * count + find(op.guard));
    } else if (op.info->kind == Kind::Swap) {
      for (int bit = 0; bit < kPackageWords * count; ++bit) needed.erase(bit);
      if (is(op, Opcode::Rin)) return;
      const bool to_pool = is(op, Opcode::Rout);
      const int first = to_pool ? 0 : word::kPixel, end = to_pool ? kRayWords : word::kColor + 3;
      for (int word = first; word < end; ++word) needed.insert(word * count + find(op.guard));
    } else if (writes_predicate(*op.info) && op.rd != 0) {
      replace_result(op, needed);
    }
  }
  /// Needs in the lanes that have the op's result, or have it not, in terms of what there is before it.
  void replace_result(const Op& op, NumberSet& needed) const {
    const std::array from = {find({op.rd, false}), find({op.rd, true})};
    const std::array to = {find(origin(op, false)), find(origin(op, true))};
    for (int place = 0; place < places_; ++place) {
      std::array<bool, 2> moves = {false, false};
      for (size_t n = 0; n < from.size(); ++n) {
        if (from[n] == kNothing) continue;
        moves[n] = needed.has(place * guards() + from[n]);
        needed.erase(place * guards() + from[n]);
      }
      for (size_t n = 0; n < from.size(); ++n)
        if (moves[n]) needed.insert(place * guards() + to[n]);
    }
  }

  const Function& function_;
  int places_ = kPackageWords;
  std::vector<Guard> guards_;
};

}  // namespace

std::vector<NumberSet> find_needed_places(const Function& function) { return Needs(function).run(); }

uint32_t words_changed(const Op& op) {
  if (op.kind != Op::Kind::Instruction) return 0;
  if (op.info->kind == Kind::Swap) return ~0u;
  return is(op, Opcode::Rst) ? 1u << op.word : 0;
}

}  // namespace raypool::kernel
