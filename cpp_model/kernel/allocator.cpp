// Gives machine registers and predicates to virtual ones: graph colouring with coalescing of copies.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "isa/input_error.hpp"
#include "kernel/compiler.hpp"
#include "kernel/liveness.hpp"

namespace raypool::kernel {
namespace {

/// Which copies are made disappear by giving both sides one register.
enum class Coalescing { All, Safe, None };

/// Registers or predicates of a function, and which of them may not share a place.
class InterferenceGraph {
 public:
  InterferenceGraph(const Function& function, const Liveness& liveness, bool predicates)
      : size_(predicates ? function.predicates : function.registers),
        neighbours_(static_cast<size_t>(size_), NumberSet(size_)),
        representative_(static_cast<size_t>(size_)),
        used_(static_cast<size_t>(size_), false) {
    std::iota(representative_.begin(), representative_.end(), 0);
    for (size_t i = 0; i < function.ops.size(); ++i) {
      const Op& op = function.ops[i];
      const Effects effect = effects(op);
      const int defined = predicates ? effect.predicate_defined : effect.register_defined;
      const auto mark = [&](int number) {
        if (number != kNothing) used_[number] = true;
      };
      if (predicates)
        std::for_each(std::begin(effect.predicate_uses), std::end(effect.predicate_uses), mark);
      else
        std::for_each(std::begin(effect.register_uses), std::end(effect.register_uses), mark);
      mark(defined);
      if (defined == kNothing) continue;
      const int copied = is_copy(op) ? op.rb : kNothing;
      const NumberSet& live = predicates ? liveness.predicates_after[i] : liveness.registers_after[i];
      const int count = predicates ? 1 : effect.registers_defined;
      for (int e = 0; e < count; ++e) {
        mark(defined + e);
        live.for_each([&](int other) {
          if (other != defined + e && other != copied) connect(defined + e, other);
        });
      }
      if (count > 1) keep_elements_apart(op);
      if (copied != kNothing && copied != defined) copies_.emplace_back(defined, copied);
    }
    if (predicates) used_[0] = false;  // p0 has its place
  }

  void coalesce(Coalescing mode, int places) {
    if (mode == Coalescing::None) return;
    bool changed = true;
    while (changed) {
      changed = false;
      for (const auto& [a, b] : copies_) {
        const int first = find(a);
        const int second = find(b);
        if (first == second || neighbours_[at(first)].has(second)) continue;
        if (in_group(first) || in_group(second)) continue;
        if (!used_[at(first)] || !used_[at(second)]) continue;
        if (mode == Coalescing::Safe && !is_safe(first, second, places)) continue;
        merge(first, second);
        changed = true;
      }
    }
  }

  /// These and the two behind each get places in a row.
  void group(const std::vector<int>& firsts) {
    for (const int first : firsts)
      if (used_[at(first)] || used_[at(first + 1)] || used_[at(first + 2)]) groups_.push_back(first);
  }

  /// A place 0 .. places-1 for each number; false, with the number that found none, if they do not suffice. Groups come
  /// first, as they are hard to place; of their places many are tried until the others find some too.
  bool colour(int places, std::vector<int>& colours, int& failed) {
    std::vector<int> by_degree = groups_, from_the_end(groups_.rbegin(), groups_.rend());
    const auto degree = [&](int first) {
      int sum = 0;
      for (int e = 0; e < kElements; ++e) sum += neighbours_[at(first + e)].count();
      return sum;
    };
    std::stable_sort(by_degree.begin(), by_degree.end(), [&](int a, int b) { return degree(a) > degree(b); });
    singles_ = order_of_singles(places);
    for (const std::vector<int>& order : {by_degree, groups_, from_the_end}) {
      std::vector<int> places_of(size_, kNothing);
      int attempts = kMostAttempts;
      if (place_groups(order, 0, places, places_of, attempts, colours, failed)) return true;
    }
    return false;
  }

 private:
  static constexpr int kMostAttempts = 400;

  bool place_groups(const std::vector<int>& order, size_t index, int places, std::vector<int>& places_of, int& attempts,
                    std::vector<int>& colours, int& failed) {
    if (index == order.size()) {
      --attempts;
      return colour_singles(places, places_of, colours, failed);
    }
    const int first = order[index];
    for (int n = 0; n < places && attempts > 0; ++n) {
      const int place = n * kElements % places;  // 0, 3, .. 15, 2, 5, ..: every place once, with few gaps
      bool fits = true;
      for (int e = 0; e < kElements && fits; ++e)
        fits = (taken_for(first + e, places_of) >> (place + e) % places & 1) == 0;
      if (!fits) continue;
      for (int e = 0; e < kElements; ++e) places_of[at(first + e)] = (place + e) % places;
      if (place_groups(order, index + 1, places, places_of, attempts, colours, failed)) return true;
      for (int e = 0; e < kElements; ++e) places_of[at(first + e)] = kNothing;
    }
    failed = first;
    --attempts;
    return false;
  }

  /// In which order what is in no group gets its place: the same wherever the groups are.
  std::vector<int> order_of_singles(int places) {
    std::vector<int> nodes;
    for (int i = 0; i < size_; ++i) {
      if (used_[at(i)] && find(i) == i && !in_group(i)) nodes.push_back(i);
    }
    // Take away nodes that are sure to find a place; if there is none, the one with the most neighbours, and hope.
    std::vector<int> order;
    std::vector<int> degree(size_, 0);
    for (const int node : nodes) degree[at(node)] = neighbours_[at(node)].count();
    std::vector<bool> removed(size_, false);
    while (order.size() < nodes.size()) {
      int best = kNothing;
      // Smaller is better: sure ones first, of these those with few neighbours; else those with many.
      const auto rank = [&](int node) {
        return degree[at(node)] < places ? degree[at(node)] : 2 * size_ + places - degree[at(node)];
      };
      for (const int node : nodes) {
        if (!removed[at(node)] && (best == kNothing || rank(node) < rank(best))) best = node;
      }
      removed[at(best)] = true;
      order.push_back(best);
      neighbours_[at(best)].for_each([&](int other) { --degree[at(other)]; });
    }
    std::reverse(order.begin(), order.end());
    return order;
  }

  bool colour_singles(int places, std::vector<int> places_of, std::vector<int>& colours, int& failed) {
    for (const int node : singles_) {
      const uint32_t taken = taken_for(node, places_of);
      int place = 0;
      while (place < places && (taken >> place & 1) != 0) ++place;
      if (place == places) {
        failed = node;
        return false;
      }
      places_of[at(node)] = place;
    }
    colours.assign(size_, kNothing);
    for (int i = 0; i < size_; ++i) {
      if (used_[at(i)]) colours[at(i)] = places_of[at(find(i))];
    }
    return true;
  }

  bool in_group(int number) const {
    return std::any_of(groups_.begin(), groups_.end(),
                       [&](int first) { return number >= first && number < first + kElements; });
  }
  uint32_t taken_for(int node, const std::vector<int>& places_of) const {
    uint32_t taken = 0;
    neighbours_[at(node)].for_each([&](int other) {
      if (places_of[at(other)] != kNothing) taken |= 1u << places_of[at(other)];
    });
    return taken;
  }
  // An element must not write what a later one reads.
  void keep_elements_apart(const Op& op) {
    for (int earlier = 0; earlier < kElements; ++earlier) {
      for (int later = earlier + 1; later < kElements; ++later) {
        const auto apart = [&](int number) {
          if (number != kNothing && number != op.rd + earlier) connect(op.rd + earlier, number);
        };
        if (has_operand(*op.info, Operand::Ra)) apart(has_one_ra(*op.info) ? op.ra : op.ra + later);
        if (has_operand(*op.info, Operand::Address)) apart(op.ra);
        if (has_operand(*op.info, Operand::B) && !op.b_is_immediate) apart(op.rb + later);
        if (has_operand(*op.info, Operand::Rc)) apart(op.rc + later);
      }
    }
  }
  static size_t at(int number) { return static_cast<size_t>(number); }
  int find(int number) {
    while (representative_[at(number)] != number) number = representative_[at(number)];
    return number;
  }
  void connect(int a, int b) {
    neighbours_[at(a)].insert(b);
    neighbours_[at(b)].insert(a);
  }
  void merge(int kept, int gone) {
    representative_[at(gone)] = kept;
    neighbours_[at(gone)].for_each([&](int other) {
      neighbours_[at(other)].erase(gone);
      connect(kept, other);
    });
    neighbours_[at(gone)] = NumberSet(size_);
  }
  /// Briggs: fewer than `places` neighbours of the merged node have as many neighbours
  /// themselves, so colouring cannot get harder.
  bool is_safe(int a, int b, int places) const {
    NumberSet all = neighbours_[at(a)];
    all.merge(neighbours_[at(b)]);
    int significant = 0;
    all.for_each([&](int other) {
      const bool both = neighbours_[at(a)].has(other) && neighbours_[at(b)].has(other);
      if (neighbours_[at(other)].count() - (both ? 1 : 0) >= places) ++significant;
    });
    return significant < places;
  }

  int size_;
  std::vector<NumberSet> neighbours_;
  std::vector<int> representative_;
  std::vector<bool> used_;
  std::vector<std::pair<int, int>> copies_;
  std::vector<int> groups_;   // first numbers
  std::vector<int> singles_;  // what is in no group, in the order in which it gets its place
};

[[noreturn]] void fail(const Function& function, const Liveness& liveness, bool predicates, int failed) {
  const char* what = predicates ? "conditions" : "values";
  std::string available = predicates ? "a warp has 15 predicates for them" : "a thread has 16 registers";
  // Conditions that find no predicate become values.
  available += function.spill_memory ? ", and neither ray words nor spill memory have room for the others"
                                     : ", and no ray words are free for the others";
  // Where most are held at once; if that is not too many, where the one begins that found no place.
  int most = 0;
  Location where;
  Location begin;
  for (size_t i = 0; i < function.ops.size(); ++i) {
    const Effects effect = effects(function.ops[i]);
    const int defined = predicates ? effect.predicate_defined : effect.register_defined;
    if (defined == kNothing) continue;
    NumberSet live = predicates ? liveness.predicates_after[i] : liveness.registers_after[i];
    live.insert(defined);
    if (live.count() > most) {
      most = live.count();
      where = function.ops[i].where;
    }
    if (defined == failed && begin.line == 0) begin = function.ops[i].where;
  }
  if (most > (predicates ? kPredicates - 1 : kRegisters)) {
    throw InputError(
        fmt::format("{}: kernel '{}' holds {} {} at once here, but {}; compute some of them later, or again",
                    to_string(where), function.name, most, what, available));
  }
  throw InputError(fmt::format("{}: kernel '{}' finds no place for what begins here, and {}; let some {} end sooner",
                               to_string(begin), function.name, available, what));
}

/// False, with the number that found no place.
bool allocate_kind(const Function& function, const Liveness& liveness, bool predicates, std::vector<int>& colours,
                   int& failed) {
  const int places = predicates ? kPredicates - 1 : kRegisters;
  for (const Coalescing mode : {Coalescing::All, Coalescing::Safe, Coalescing::None}) {
    InterferenceGraph graph(function, liveness, predicates);
    if (!predicates) graph.group(function.groups);
    graph.coalesce(mode, places);
    if (!graph.colour(places, colours, failed)) continue;
    if (predicates) {
      for (int& place : colours) place = place == kNothing ? kNothing : place + 1;
      colours[0] = 0;
    }
    return true;
  }
  return false;
}

}  // namespace

Allocation allocate(const Function& function) {
  const Liveness liveness = find_liveness(function);
  Allocation found;
  for (const bool predicates : {false, true}) {
    int failed = kNothing;
    if (!allocate_kind(function, liveness, predicates, predicates ? found.predicates : found.registers, failed))
      fail(function, liveness, predicates, failed);
  }
  return found;
}

bool has_places(const Function& function, bool predicates) {
  const Liveness liveness = find_liveness(function);
  std::vector<int> places;
  int failed = kNothing;
  return allocate_kind(function, liveness, predicates, places, failed);
}

}  // namespace raypool::kernel
