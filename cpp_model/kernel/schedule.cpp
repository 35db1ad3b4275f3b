#include "kernel/schedule.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "kernel/liveness.hpp"

namespace raypool::kernel {
namespace {

bool ends_piece(const Op& op) {
  if (op.kind == Op::Kind::Undefined) return false;
  return op.kind != Op::Kind::Instruction || op.info->kind == raypool::Kind::Control;
}

/// Ops between two places where threads part or meet.
class Piece {
 public:
  /// `live`: registers that are needed behind it.
  Piece(std::vector<Op> ops, const NumberSet& live) : ops_(std::move(ops)), before_(ops_.size()), behind_(ops_.size()) {
    find_order();
    count_uses(live);
  }

  std::vector<Op> in_order() {
    weights_.assign(ops_.size(), -1);
    placed_.assign(ops_.size(), false);
    for (size_t i = 0; i < ops_.size(); ++i)
      if (is_wanted(i)) place_with_needs(i);
    for (size_t i = 0; i < ops_.size(); ++i)
      if (!placed_[i]) place_with_needs(i);
    std::vector<Op> ordered;
    ordered.reserve(ops_.size());
    for (const size_t i : order_) ordered.push_back(ops_[i]);
    return ordered;
  }

 private:
  void stays_behind(size_t later, size_t earlier) {
    if (later == earlier) return;
    before_[later].push_back(earlier);
    behind_[earlier].push_back(later);
  }

  /// Which ops must come before each.
  void find_order() {
    std::map<int, size_t> register_written, predicate_written, word_written;
    std::map<int, std::vector<size_t>> register_read, predicate_read, word_read;
    std::vector<size_t> words_since_swap, loads;
    int last_store = kNothing, last_swap = kNothing, last_fence = kNothing;
    const auto behind = [&](size_t op, int earlier) {
      if (earlier != kNothing) stays_behind(op, static_cast<size_t>(earlier));
    };
    for (size_t i = 0; i < ops_.size(); ++i) {
      const Op& op = ops_[i];
      const Effects effect = effects(op);
      const auto reads = [&](auto& written, auto& read, int number) {
        if (number == kNothing) return;
        const auto found = written.find(number);
        if (found != written.end()) stays_behind(i, found->second);
        read[number].push_back(i);
      };
      const auto writes = [&](auto& written, auto& read, int number) {
        const auto found = written.find(number);
        if (found != written.end()) stays_behind(i, found->second);
        for (const size_t reader : read[number]) stays_behind(i, reader);
        read[number].clear();
        written[number] = i;
      };
      for (const int used : effect.register_uses) reads(register_written, register_read, used);
      for (const int used : effect.predicate_uses) reads(predicate_written, predicate_read, used);
      for (int e = 0; e < effect.registers_defined; ++e)
        writes(register_written, register_read, effect.register_defined + e);
      if (effect.predicate_defined != kNothing) writes(predicate_written, predicate_read, effect.predicate_defined);
      if (op.kind == Op::Kind::Undefined) continue;
      if (op.info->alu() == AluType::Mem) {
        behind(i, last_store);
        if (changes_memory(op)) {
          for (const size_t load : loads) stays_behind(i, load);
          loads.clear();
          last_store = static_cast<int>(i);
        } else {
          loads.push_back(i);
        }
        if (op.fence) last_fence = static_cast<int>(i);
      }
      if (op.info->alu() != AluType::Ray) continue;
      behind(i, last_swap);
      if (op.info->kind == raypool::Kind::Swap) {
        behind(i, last_fence);
        for (const size_t word : words_since_swap) stays_behind(i, word);
        words_since_swap.clear();
        word_written.clear();
        word_read.clear();
        last_swap = static_cast<int>(i);
        continue;
      }
      words_since_swap.push_back(i);
      for (int e = 0; e < elements(op); ++e) {
        if (writes_register(*op.info))
          reads(word_written, word_read, op.word + e);
        else
          writes(word_written, word_read, op.word + e);
      }
    }
  }

  /// How often each register is used, and whether a use can be its last one.
  void count_uses(const NumberSet& live) {
    for (const Op& op : ops_) {
      const Effects effect = effects(op);
      for (const int used : effect.register_uses)
        if (used != kNothing) ++uses_left_[used];
      for (int e = 0; e < effect.registers_defined; ++e) ++definitions_[effect.register_defined + e];
    }
    live.for_each([&](int number) { kept_.insert({number, true}); });
  }

  /// What ops are there for: effects beyond registers, and registers that are needed behind the piece.
  bool is_wanted(size_t i) const {
    const Op& op = ops_[i];
    if (op.kind == Op::Kind::Undefined) return false;
    if (!is_pure(op)) return true;
    const Effects effect = effects(op);
    for (int e = 0; e < effect.registers_defined; ++e)
      if (kept_.count(effect.register_defined + e) != 0) return true;
    return false;
  }

  /// Ops that an op needs, itself included, as far as they are not shared with others.
  int weight(size_t i) {
    if (weights_[i] >= 0) return weights_[i];
    weights_[i] = 1;
    int sum = 1;
    for (const size_t needed : before_[i]) sum += weight(needed);
    constexpr int kMost = 1 << 20;
    return weights_[i] = std::min(sum, kMost);
  }

  void place_with_needs(size_t wanted) {
    // Without recursion, as a piece may have thousands of ops.
    std::vector<size_t> stack = {wanted};
    while (!stack.empty()) {
      const size_t i = stack.back();
      if (placed_[i]) {
        stack.pop_back();
        continue;
      }
      std::vector<size_t> needs;
      for (const size_t needed : before_[i])
        if (!placed_[needed]) needs.push_back(needed);
      if (needs.empty()) {
        stack.pop_back();
        if (ops_[i].kind == Op::Kind::Instruction && ops_[i].info->kind == raypool::Kind::Swap)
          place_what_ends_values(false);
        if (!placed_[i]) place(i);
        place_what_ends_values(true);
        continue;
      }
      // The heaviest is on top of the stack.
      std::stable_sort(needs.begin(), needs.end(),
                       [&](size_t a, size_t b) { return weight(a) != weight(b) ? weight(a) < weight(b) : a > b; });
      stack.insert(stack.end(), needs.begin(), needs.end());
    }
  }

  void place(size_t i) {
    placed_[i] = true;
    order_.push_back(i);
    const Effects effect = effects(ops_[i]);
    for (const int used : effect.register_uses) {
      if (used != kNothing) --uses_left_[used];
    }
    for (const size_t later : behind_[i]) near_.push_back(later);
  }

  /// Values that end with the op, less those that begin.
  int ended(size_t i) const {
    const Effects effect = effects(ops_[i]);
    int count = 0;
    std::vector<int> seen;
    for (const int used : effect.register_uses) {
      if (used == kNothing || std::find(seen.begin(), seen.end(), used) != seen.end()) continue;
      seen.push_back(used);
      const auto times = std::count(effect.register_uses.begin(), effect.register_uses.end(), used);
      if (kept_.count(used) == 0 && uses_left_.at(used) == times) ++count;
    }
    if (effect.partial) --count;
    return count - effect.registers_defined;
  }

  /// `near`: only of those that need what has been placed last.
  void place_what_ends_values(bool near) {
    bool changed = true;
    while (changed) {
      changed = false;
      std::vector<size_t> candidates;
      if (near) {
        candidates.swap(near_);
      } else {
        for (size_t i = 0; i < ops_.size(); ++i) candidates.push_back(i);
      }
      for (const size_t i : candidates) {
        if (placed_[i] || ops_[i].kind == Op::Kind::Undefined) continue;
        if (ops_[i].info->kind == raypool::Kind::Swap) continue;
        const bool ready =
            std::all_of(before_[i].begin(), before_[i].end(), [&](size_t needed) { return placed_[needed]; });
        if (!ready || ended(i) <= 0) continue;
        place(i);
        changed = true;
      }
    }
    near_.clear();
  }

  std::vector<Op> ops_;
  std::vector<std::vector<size_t>> before_, behind_;
  std::map<int, int> uses_left_, definitions_;
  std::map<int, bool> kept_;
  std::vector<int> weights_;
  std::vector<bool> placed_;
  std::vector<size_t> order_, near_;
};

}  // namespace

void remove_short_jumps(Function& function) {
  constexpr size_t kShortestJump = 6;
  std::vector<Op> kept;
  for (size_t i = 0; i < function.ops.size(); ++i) {
    const Op& jump = function.ops[i];
    if (!is(jump, Opcode::Jnone)) {
      kept.push_back(jump);
      continue;
    }
    size_t end = i + 1, length = 0;
    while (end < function.ops.size() && !ends_piece(function.ops[end]))
      length += function.ops[end++].kind == Op::Kind::Instruction ? 1 : 0;
    const bool over =
        end < function.ops.size() && function.ops[end].kind == Op::Kind::Label && function.ops[end].label == jump.label;
    if (!over || length >= kShortestJump) {
      kept.push_back(jump);
      continue;
    }
    kept.insert(kept.end(), function.ops.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                function.ops.begin() + static_cast<std::ptrdiff_t>(end));
    i = end;
  }
  function.ops = std::move(kept);
}

void schedule(Function& function) {
  const Liveness liveness = find_liveness(function);
  std::vector<Op> ordered;
  ordered.reserve(function.ops.size());
  for (size_t begin = 0; begin < function.ops.size();) {
    size_t end = begin;
    while (end < function.ops.size() && !ends_piece(function.ops[end])) ++end;
    if (end > begin) {
      NumberSet live = liveness.registers_after[end - 1];
      // What is spilled needs it from its definition on.
      if (function.spill_memory) live.insert(function.spill_memory->offset);
      Piece piece({function.ops.begin() + static_cast<std::ptrdiff_t>(begin),
                   function.ops.begin() + static_cast<std::ptrdiff_t>(end)},
                  live);
      const std::vector<Op> ops = piece.in_order();
      ordered.insert(ordered.end(), ops.begin(), ops.end());
    }
    if (end < function.ops.size()) ordered.push_back(function.ops[end]);
    begin = end + 1;
  }
  function.ops = std::move(ordered);
}

}  // namespace raypool::kernel
