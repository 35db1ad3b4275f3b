#include "cosim/covering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "config/parameter_table.hpp"
#include "random.hpp"

namespace raypool {
namespace {

constexpr int kCandidates = 60;

std::vector<int> values_of(const Tried& tried) { return {tried.values.begin(), tried.values.begin() + tried.count}; }

Factor factor_of(const Parameter& parameter) {
  std::vector<int> values = values_of(parameter.tried);
  if (values.empty()) values = values_of(parameter.range);
  return {path_of(parameter), std::move(values), [&parameter](Machine& m, int v) { parameter.set(m.configuration, v); },
          [&parameter](const Machine& m) { return parameter.get(m.configuration); }};
}

Factor factor_of(const AluParameter& parameter, size_t type) {
  const auto member = parameter.value;
  Factor factor{fmt::format("{}.{}", kAluNames[type], parameter.key), values_of(parameter.tried),
                [type, member](Machine& m, int value) { m.configuration.alus[type].*member = value; },
                [type, member](const Machine& m) { return m.configuration.alus[type].*member; }};
  factor.of_alu = true;
  if (parameter.range.form == Range::Form::Instructions) {
    // All, none, and every other one: of two that share hardware each is there alone in some machine.
    const int every = range_of(parameter, static_cast<AluType>(type)).greatest;
    factor.values = {0, every, every & 0x55555555, every & 0x2aaaaaaa};
  }
  if (member != &AluConfiguration::depth) return factor;
  // The greatest is the depth; a smaller value counts stages beyond the least, which other parameters decide.
  const int deepest = parameter.range.greatest;
  const auto least = [type](const Machine& m) { return least_depth(m.configuration, static_cast<AluType>(type)); };
  factor.set = [type, deepest, least](Machine& m, int value) {
    m.configuration.alus[type].depth = value == deepest ? value : least(m) + value;
  };
  factor.get = [type, deepest, least](const Machine& m) {
    const int depth = m.configuration.alus[type].depth;
    return depth == deepest ? depth : depth - least(m);
  };
  return factor;
}

Factor units_factor() {
  return {"units", {1, 2, 4}, [](Machine& m, int v) { m.units = v; }, [](const Machine& m) { return m.units; }};
}

// In the order in which they are set: a depth behind the modes that decide its least.
std::vector<Factor> make_factors() {
  std::vector<Factor> factors;
  const auto put = [&factors](bool in_section) {
    for (const Parameter& parameter : parameter::kAll)
      if (parameter.section.empty() != in_section) factors.push_back(factor_of(parameter));
  };
  put(false);
  put(true);
  factors.insert(factors.begin() + 2, units_factor());
  for (Factor& factor : factors)
    factor.multiplies = factor.name == "warps" || factor.name == "lanes" || factor.name == "units";
  for (size_t type = 0; type < kAluTypes; ++type) {
    for (const AluParameter& parameter : parameter::kOfAlu)
      if (!kAluTable[type].timed_by_events() && applies(parameter, static_cast<AluType>(type)))
        factors.push_back(factor_of(parameter, type));
  }
  return factors;
}

/// Of the parameter of this path, with values of our own.
Factor factor_of(std::string_view path, std::vector<int> values) {
  const auto find = [path](const auto& rows) {
    const auto found =
        std::find_if(std::begin(rows), std::end(rows), [path](const Parameter& row) { return path_of(row) == path; });
    return found == std::end(rows) ? nullptr : &*found;
  };
  const Parameter* const of_chip = find(parameter::kOfChip);
  Factor factor = factor_of(of_chip != nullptr ? *of_chip : *find(parameter::kAll));
  factor.values = std::move(values);
  return factor;
}

/// Four sets of a way: the least there may be where a bank has two.
constexpr int kSetBytes = 4 * 64;

// A size of the intersection pool counts what it holds beyond a tile's row, and what may be held is this row or as much
// as the pool holds: so any two values go together.
std::vector<Factor> make_chip_factors() {
  const auto row = [](const Machine& m) { return 1 << tile_width_log2(m.configuration.contents()); };
  std::vector<Factor> factors = {factor_of("warps", {1, 2}), factor_of("lanes", {1, 2}), units_factor()};
  for (Factor& factor : factors) factor.multiplies = true;
  for (const auto& [path, values] : std::initializer_list<std::pair<std::string_view, std::vector<int>>>{
           {"kernel_overlap", {0, 1}},
           {"intersection_words", {18, 21}},
           {"data_cache.mshrs", {1, 2}},
           {"chip.policy", {0, 1}},
           {"chip.window_remedy", {0, 1}},
           {"chip.launch_ahead", {0, 1}},
           {"chip.shading", {0, 1}},
           {"chip.culling", {0, 1}},
           {"chip.thresholds.rays", {0, 48}},
           {"chip.thresholds.intersections", {0, 64}},
           {"chip.static_traverser.batch", {1, 3, 64}},
           {"chip.ray_pool.size", {1, 2, 7}},
           {"chip.ray_pool.overhead", {1, 2, 5}},
           {"chip.ray_pool.cycles_per_beat", {1, 2}},
           {"chip.ray_pool.pipelined", {0, 1}},
           {"chip.intersection_pool.size", {1, 4, 9}},
           {"chip.intersection_pool.overhead", {1, 2, 5}},
           {"chip.intersection_pool.cycles_per_beat", {1, 2}},
           {"chip.intersection_pool.pipelined", {0, 1}},
           {"chip.memory.latency", {1, 10, 50}},
           {"chip.memory.cycles_per_beat", {1, 2, 3}},
           {"chip.memory.queue", {1, 2, 8}},
           {"chip.hardware_traverser.node_cache_mshrs", {1, 2}},
           {"chip.tile_order", {0, 1}},
           {"chip.held_limit", {0, 1}}})
    factors.push_back(factor_of(path, values));
  for (Factor& factor : factors) {
    const auto set = factor.set;
    const auto get = factor.get;
    if (factor.name == "chip.intersection_pool.size") {
      factor.set = [set, row](Machine& m, int value) { set(m, row(m) + value); };
      factor.get = [get, row](const Machine& m) { return get(m) - row(m); };
    } else if (factor.name == "chip.held_limit") {
      factor.set = [set, row](Machine& m, int value) {
        set(m, value == 0 ? row(m) : static_cast<int>(m.configuration.chip.intersection_pool_size));
      };
      factor.get = [get, row](const Machine& m) { return get(m) == row(m) ? 0 : 1; };
    }
  }
  return factors;
}

/// Those of a chip that has its traverser inside, and the traverser's. Lanes count beyond triangle pipes, slots are of
/// a lane, registers of a bank, and sets of a bank beyond two: so any two values go together.
std::vector<Factor> make_inside_factors() {
  std::vector<Factor> factors;
  for (Factor& factor : make_chip_factors()) {
    // The first is of a traverser at the ports, the second below counted otherwise.
    if (factor.name != "chip.static_traverser.batch" && factor.name != "chip.hardware_traverser.node_cache_mshrs")
      factors.push_back(std::move(factor));
  }
  using Scale = std::function<int(const ChipConfiguration&)>;
  const auto put = [&factors](std::string_view name, std::vector<int> values, const Scale& scale = nullptr) {
    Factor factor = factor_of("chip.hardware_traverser." + std::string(name), std::move(values));
    if (scale != nullptr) {
      factor.set = [set = factor.set, scale](Machine& m, int value) { set(m, value * scale(m.configuration.chip)); };
      factor.get = [get = factor.get, scale](const Machine& m) { return get(m) / scale(m.configuration.chip); };
    }
    factors.push_back(std::move(factor));
  };
  const auto values_of = [&factors](std::string_view name) -> std::vector<int>& {
    return std::find_if(factors.begin(), factors.end(), [name](const Factor& f) { return f.name == name; })->values;
  };
  // The least that BoardMemory has with three cycles a beat.
  values_of("chip.memory.latency") = {12, 13, 50};
  // A lane's slots must have rays: so many are in the pool, too, until they leave.
  values_of("chip.ray_pool.size") = {1, 2, 7, 40};
  put("triangle_pipes", {1, 2});
  put("lanes", {0, 1, 2});
  Factor& lanes = factors.back();
  const auto pipes = [](const Machine& m) {
    return static_cast<int>(m.configuration.chip.hardware_traverser_triangle_pipes);
  };
  lanes.set = [set = lanes.set, pipes](Machine& m, int value) { set(m, pipes(m) + value); };
  lanes.get = [get = lanes.get, pipes](const Machine& m) { return get(m) - pipes(m); };
  put("rays", {1, 2, 5, 24},
      [](const ChipConfiguration& chip) { return static_cast<int>(chip.hardware_traverser_lanes); });
  put("stack_entries", {8, 9, 16});
  put("box_bits", {6, 12, 16});
  put("cache_banks", {1, 2, 4});
  const auto banks = [](const ChipConfiguration& chip) {
    return static_cast<int>(chip.hardware_traverser_cache_banks);
  };
  put("node_cache_ways", {2, 4});
  put("node_cache_bytes", {1, 2}, [banks](const ChipConfiguration& chip) {
    return kSetBytes * banks(chip) * static_cast<int>(chip.hardware_traverser_node_cache_ways);
  });
  put("node_cache_mshrs", {1, 2, 3}, banks);
  put("triangle_cache_ways", {2, 4});
  put("triangle_cache_bytes", {1, 2}, [banks](const ChipConfiguration& chip) {
    return kSetBytes * banks(chip) * static_cast<int>(chip.hardware_traverser_triangle_cache_ways);
  });
  put("triangle_cache_mshrs", {1, 2, 3}, banks);
  return factors;
}

/// What a value multiplies the number of threads by.
int threads_of(const Factor& factor, int value) { return factor.multiplies ? value : 1; }

/// Both values fit into a machine of so many threads.
bool possible(const Factor& a, int i, const Factor& b, int j, int most_threads) {
  return threads_of(a, i) * threads_of(b, j) <= most_threads;
}

/// Two factors and an index into the values of each; the first factor is the lower one.
using Pair = std::tuple<size_t, size_t, size_t, size_t>;

/// A configuration as an index into each factor's values; -1: not chosen yet.
using Row = std::vector<int>;

class Search {
 public:
  Search(const std::vector<Factor>& factors, int most_threads) : factors_(factors), most_threads_(most_threads) {
    for (size_t a = 0; a < factors.size(); ++a)
      for (size_t b = a + 1; b < factors.size(); ++b)
        for (size_t i = 0; i < factors[a].values.size(); ++i)
          for (size_t j = 0; j < factors[b].values.size(); ++j)
            if (possible(factors[a], factors[a].values[i], factors[b], factors[b].values[j], most_threads))
              open_.insert({a, b, i, j});
  }

  bool done() const { return open_.empty(); }

  /// The best of some rows that each have a pair that is open.
  Row next() {
    Row best;
    size_t most = 0;
    for (int n = 0; n < kCandidates; ++n) {
      Row row(factors_.size(), -1);
      auto pair = open_.begin();
      std::advance(pair, static_cast<std::ptrdiff_t>(random_() % open_.size()));
      row[std::get<0>(*pair)] = static_cast<int>(std::get<2>(*pair));
      row[std::get<1>(*pair)] = static_cast<int>(std::get<3>(*pair));
      const size_t score = fill(row);
      if (best.empty() || score > most) {
        best = row;
        most = score;
      }
    }
    take(best);
    return best;
  }

 private:
  size_t gain(const Row& row, size_t factor, size_t value) const {
    size_t pairs = 0;
    for (size_t other = 0; other < row.size(); ++other) {
      if (row[other] < 0 || other == factor) continue;
      const size_t o = row[other];
      pairs += other < factor ? open_.count({other, factor, o, value}) : open_.count({factor, other, value, o});
    }
    return pairs;
  }

  /// Threads that the row has with another value of a factor, so far.
  int threads(const Row& row, size_t factor, size_t value) const {
    int product = 1;
    for (size_t other = 0; other < row.size(); ++other) {
      const size_t index = other == factor ? value : static_cast<size_t>(row[other]);
      const Factor& f = factors_[other];
      if (other == factor || row[other] >= 0) product *= threads_of(f, f.values[index]);
    }
    return product;
  }

  size_t fill(Row& row) {
    std::vector<size_t> order(row.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random_);
    size_t total = 0;
    for (const size_t factor : order) {
      if (row[factor] >= 0) continue;
      const size_t values = factors_[factor].values.size();
      const size_t first = random_() % values;
      size_t chosen = 0, most = 0;  // a size's first value is 1, which always fits
      for (size_t n = 0; n < values; ++n) {
        const size_t value = (first + n) % values;
        if (threads(row, factor, value) > most_threads_) continue;
        const size_t pairs = gain(row, factor, value);
        if (pairs > most || (most == 0 && n == 0)) chosen = value, most = pairs;
      }
      row[factor] = static_cast<int>(chosen);
      total += most;
    }
    return total;
  }

  void take(const Row& row) {
    for (size_t a = 0; a < row.size(); ++a) {
      for (size_t b = a + 1; b < row.size(); ++b)
        open_.erase({a, b, static_cast<size_t>(row[a]), static_cast<size_t>(row[b])});
    }
  }

  const std::vector<Factor>& factors_;
  int most_threads_;
  std::set<Pair> open_;
  Random random_{1};
};

Machine named(Machine machine, std::string_view set, size_t number) {
  Configuration& configuration = machine.configuration;
  configuration.name = fmt::format("{}{:02}-{}w{}c", set, number, configuration.warps, configuration.lanes);
  check_configuration(configuration, configuration.name);
  return machine;
}

Machine machine_of(const std::vector<Factor>& factors, const Row& row, Machine machine = {}) {
  for (size_t factor = 0; factor < row.size(); ++factor) {
    const Factor& f = factors[factor];
    f.set(machine, f.values[row[factor]]);
  }
  return machine;
}

/// Around units with caches as small as can be.
std::vector<Machine> chips_of(const std::vector<Factor>& factors, TraverserName traverser, std::string_view set) {
  Machine smallest;
  Configuration& configuration = smallest.configuration;
  configuration.instruction_cache_bytes = configuration.data_cache_bytes = 512;
  configuration.chip.traverser = traverser;
  configuration.chip.hardware_traverser_triangle_cache_mshrs = 1;
  Search search(factors, kSmallThreads);
  std::vector<Machine> machines;
  while (!search.done())
    machines.push_back(named(machine_of(factors, search.next(), smallest), set, machines.size() + 1));
  return machines;
}

}  // namespace

const std::vector<Factor>& covering_factors() {
  static const std::vector<Factor> kFactors = make_factors();
  return kFactors;
}

const std::vector<Factor>& chip_factors() {
  static const std::vector<Factor> kFactors = make_chip_factors();
  return kFactors;
}

const std::vector<Factor>& inside_factors() {
  static const std::vector<Factor> kFactors = make_inside_factors();
  return kFactors;
}

Covered count_covered(const std::vector<Factor>& factors, const std::vector<Machine>& machines, int most_threads) {
  std::set<std::pair<size_t, int>> values;
  std::set<std::tuple<size_t, size_t, int, int>> pairs;
  Covered covered;
  for (size_t a = 0; a < factors.size(); ++a) {
    covered.all_values += factors[a].values.size();
    for (size_t b = a + 1; b < factors.size(); ++b)
      for (const int i : factors[a].values)
        for (const int j : factors[b].values)
          covered.all_pairs += possible(factors[a], i, factors[b], j, most_threads) ? 1 : 0;
  }
  for (const Machine& machine : machines) {
    for (size_t a = 0; a < factors.size(); ++a) {
      values.insert({a, factors[a].get(machine)});
      for (size_t b = a + 1; b < factors.size(); ++b) {
        const int i = factors[a].get(machine), j = factors[b].get(machine);
        if (possible(factors[a], i, factors[b], j, most_threads)) pairs.insert({a, b, i, j});
      }
    }
  }
  covered.values = values.size();
  covered.pairs = pairs.size();
  return covered;
}

std::vector<Machine> covering_machines(int most_threads, size_t most_pairings) {
  Search search(covering_factors(), most_threads);
  std::vector<Machine> machines;
  while (!search.done() && machines.size() < most_pairings)
    machines.push_back(named(machine_of(covering_factors(), search.next()), "set", machines.size() + 1));
  for (const Factor& factor : covering_factors()) {
    for (const int value : factor.values) {
      if (threads_of(factor, value) <= most_threads) continue;
      Machine machine;
      machine.configuration.warps = machine.configuration.lanes = 1;
      factor.set(machine, value);
      machines.push_back(named(std::move(machine), "set", machines.size() + 1));
    }
  }
  return machines;
}

std::vector<Machine> covering_chips() { return chips_of(chip_factors(), TraverserName::Static, "chip"); }

std::vector<Machine> covering_inside() {
  std::vector<Machine> machines = chips_of(inside_factors(), TraverserName::Hardware, "inside");
  // No factor, as no machine has them with culling: rays return in every other one without.
  bool returned = false;
  for (Machine& machine : machines) {
    ChipConfiguration& chip = machine.configuration.chip;
    if (!chip.culling) chip.miss_records = returned = !returned;
  }
  return machines;
}

}  // namespace raypool
