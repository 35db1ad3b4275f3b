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
      live.for_each([&](int other) {
        if (other != defined && other != copied) connect(defined, other);
      });
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
        if (!used_[at(first)] || !used_[at(second)]) continue;
        if (mode == Coalescing::Safe && !is_safe(first, second, places)) continue;
        merge(first, second);
        changed = true;
      }
    }
  }

  /// A place 0 .. places-1 for each number; false, with the number that found none, if they do not suffice.
  bool colour(int places, std::vector<int>& colours, int& failed) {
    std::vector<int> nodes;
    for (int i = 0; i < size_; ++i) {
      if (used_[at(i)] && find(i) == i) nodes.push_back(i);
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
    std::vector<int> places_of(size_, kNothing);
    for (auto node = order.rbegin(); node != order.rend(); ++node) {
      uint32_t taken = 0;
      neighbours_[at(*node)].for_each([&](int other) {
        if (places_of[at(other)] != kNothing) taken |= 1u << places_of[at(other)];
      });
      int place = 0;
      while (place < places && (taken >> place & 1) != 0) ++place;
      if (place == places) {
        failed = *node;
        return false;
      }
      places_of[at(*node)] = place;
    }
    colours.assign(size_, kNothing);
    for (int i = 0; i < size_; ++i) {
      if (used_[at(i)]) colours[at(i)] = places_of[at(find(i))];
    }
    return true;
  }

 private:
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
};

[[noreturn]] void fail(const Function& function, const Liveness& liveness, bool predicates, int failed) {
  const char* what = predicates ? "conditions" : "values";
  const std::string available = predicates ? "a warp has 15 predicates for them" : "a thread has 16 registers";
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

std::vector<int> allocate_kind(const Function& function, const Liveness& liveness, bool predicates) {
  const int places = predicates ? kPredicates - 1 : kRegisters;
  std::vector<int> colours;
  int failed = kNothing;
  for (const Coalescing mode : {Coalescing::All, Coalescing::Safe, Coalescing::None}) {
    InterferenceGraph graph(function, liveness, predicates);
    graph.coalesce(mode, places);
    if (!graph.colour(places, colours, failed)) continue;
    if (predicates) {
      for (int& place : colours) place = place == kNothing ? kNothing : place + 1;
      colours[0] = 0;
    }
    return colours;
  }
  fail(function, liveness, predicates, failed);
}

}  // namespace

Allocation allocate(const Function& function) {
  const Liveness liveness = find_liveness(function);
  return {allocate_kind(function, liveness, false), allocate_kind(function, liveness, true)};
}

}  // namespace raypool::kernel
