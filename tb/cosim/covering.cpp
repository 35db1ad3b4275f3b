#include "cosim/covering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <tuple>
#include <utility>

namespace raypool {
namespace {

constexpr int kCandidates = 60;

void add_alu(std::vector<Factor>& factors, size_t unit) {
  const auto add = [&](const char* what, int AluConfiguration::*member, std::vector<int> values) {
    factors.push_back({fmt::format("{}.{}", kUnitNames[unit], what), std::move(values),
                       [unit, member](Configuration& c, int value) { c.alus[unit].*member = value; },
                       [unit, member](const Configuration& c) { return c.alus[unit].*member; }});
  };
  const int depth = kUnitTable[unit].depth;
  add("count", &AluConfiguration::count, {1, 2, 3, 4});
  add("latency", &AluConfiguration::latency, {1, 2, 3, 16});
  add("depth", &AluConfiguration::depth, {depth, depth + 1, 32});
}

std::vector<Factor> make_factors() {
  std::vector<Factor> factors = {
      {"warps",
       {1, 2, 4, 8, 16, 32},
       [](Configuration& c, int v) { c.warps = v; },
       [](const Configuration& c) { return c.warps; }},
      {"cores",
       {1, 2, 4, 8, 16, 32},
       [](Configuration& c, int v) { c.cores = v; },
       [](const Configuration& c) { return c.cores; }},
      {"stack_depth",
       {2, 3, 8, 32},
       [](Configuration& c, int v) { c.stack_depth = v; },
       [](const Configuration& c) { return c.stack_depth; }},
      {"instruction_cache.bytes",
       {512, 1024, 4096, 65536},
       [](Configuration& c, int v) { c.instruction_cache_bytes = v; },
       [](const Configuration& c) { return c.instruction_cache_bytes; }},
      {"data_cache.bytes",
       {512, 1024, 8192, 65536},
       [](Configuration& c, int v) { c.data_cache_bytes = v; },
       [](const Configuration& c) { return c.data_cache_bytes; }},
      {"data_cache.mshrs",
       {1, 2, 3, 4, 16},
       [](Configuration& c, int v) { c.data_cache_mshrs = v; },
       [](const Configuration& c) { return c.data_cache_mshrs; }},
      {"subnormals",
       {0, 1},
       [](Configuration& c, int v) { c.subnormals = static_cast<Subnormals>(v); },
       [](const Configuration& c) { return static_cast<int>(c.subnormals); }},
      {"slow_unit",
       {0, 1, 2, 3},
       [](Configuration& c, int v) { c.slow_unit = static_cast<SlowUnit>(v); },
       [](const Configuration& c) { return static_cast<int>(c.slow_unit); }},
  };
  for (size_t unit = 0; unit < kUnits; ++unit)
    if (!kUnitTable[unit].timed_by_events()) add_alu(factors, unit);
  return factors;
}

/// Two factors and an index into the values of each; the first factor is the lower one.
using Pair = std::tuple<size_t, size_t, size_t, size_t>;

/// A configuration as an index into each factor's values; -1: not chosen yet.
using Row = std::vector<int>;

class Search {
 public:
  Search() {
    const auto& factors = covering_factors();
    for (size_t a = 0; a < factors.size(); ++a)
      for (size_t b = a + 1; b < factors.size(); ++b)
        for (size_t i = 0; i < factors[a].values.size(); ++i)
          for (size_t j = 0; j < factors[b].values.size(); ++j) open_.insert({a, b, i, j});
    for (size_t a = 0; a < factors.size(); ++a)
      for (size_t i = 0; i < factors[a].values.size(); ++i) unused_.insert({a, i});
  }

  bool done() const { return open_.empty(); }

  /// The best of some rows that agree with `fixed`, or, if nothing is fixed, with a pair that is open.
  Row next(const Row& fixed) {
    Row best;
    size_t most = 0;
    for (int n = 0; n < kCandidates; ++n) {
      Row row = fixed;
      if (std::all_of(row.begin(), row.end(), [](int v) { return v < 0; })) {
        auto pair = open_.begin();
        std::advance(pair, static_cast<std::ptrdiff_t>(random_() % open_.size()));
        row[std::get<0>(*pair)] = static_cast<int>(std::get<2>(*pair));
        row[std::get<1>(*pair)] = static_cast<int>(std::get<3>(*pair));
      }
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
  // A value that no row has had counts for much, so that few rows are enough for all.
  static constexpr size_t kNewValue = 1000;

  size_t gain(const Row& row, size_t factor, size_t value) const {
    size_t pairs = unused_.count({factor, value}) * kNewValue;
    for (size_t other = 0; other < row.size(); ++other) {
      if (row[other] < 0 || other == factor) continue;
      const auto o = static_cast<size_t>(row[other]);
      pairs += other < factor ? open_.count({other, factor, o, value}) : open_.count({factor, other, value, o});
    }
    return pairs;
  }

  size_t fill(Row& row) {
    std::vector<size_t> order(row.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random_);
    size_t total = 0;
    for (const size_t factor : order) {
      if (row[factor] >= 0) continue;
      const size_t values = covering_factors()[factor].values.size();
      const size_t first = random_() % values;
      size_t chosen = first, most = 0;
      for (size_t n = 0; n < values; ++n) {
        const size_t value = (first + n) % values;
        const size_t pairs = gain(row, factor, value);
        if (pairs > most) chosen = value, most = pairs;
      }
      row[factor] = static_cast<int>(chosen);
      total += most;
    }
    return total;
  }

  void take(const Row& row) {
    for (size_t a = 0; a < row.size(); ++a) {
      unused_.erase({a, static_cast<size_t>(row[a])});
      for (size_t b = a + 1; b < row.size(); ++b) open_.erase({a, b, static_cast<size_t>(row[a]), static_cast<size_t>(row[b])});
    }
  }

  std::set<Pair> open_;
  std::set<std::pair<size_t, size_t>> unused_;
  std::mt19937 random_{1};
};

Configuration configuration_of(const Row& row, const std::string& prefix, size_t number) {
  Configuration configuration;
  for (size_t factor = 0; factor < row.size(); ++factor) {
    const Factor& f = covering_factors()[factor];
    f.set(configuration, f.values[static_cast<size_t>(row[factor])]);
  }
  configuration.name = fmt::format("{}{:02}-{}w{}c", prefix, number, configuration.warps, configuration.cores);
  check_configuration(configuration, configuration.name);
  return configuration;
}

}  // namespace

const std::vector<Factor>& covering_factors() {
  static const std::vector<Factor> kFactors = make_factors();
  return kFactors;
}

Covered count_covered(const std::vector<Configuration>& configurations) {
  const std::vector<Factor>& factors = covering_factors();
  std::set<std::pair<size_t, int>> values;
  std::set<std::tuple<size_t, size_t, int, int>> pairs;
  Covered covered;
  for (size_t a = 0; a < factors.size(); ++a) {
    covered.all_values += factors[a].values.size();
    for (size_t b = a + 1; b < factors.size(); ++b) covered.all_pairs += factors[a].values.size() * factors[b].values.size();
  }
  for (const Configuration& configuration : configurations) {
    for (size_t a = 0; a < factors.size(); ++a) {
      values.insert({a, factors[a].get(configuration)});
      for (size_t b = a + 1; b < factors.size(); ++b)
        pairs.insert({a, b, factors[a].get(configuration), factors[b].get(configuration)});
    }
  }
  covered.values = values.size();
  covered.pairs = pairs.size();
  return covered;
}

std::vector<Configuration> all_pairs_configurations() {
  Search search;
  std::vector<Configuration> configurations;
  while (!search.done())
    configurations.push_back(
        configuration_of(search.next(Row(covering_factors().size(), -1)), "pairs", configurations.size() + 1));
  return configurations;
}

std::vector<Configuration> small_configurations() {
  const std::vector<Factor>& factors = covering_factors();
  Search search;
  std::vector<Configuration> configurations;
  for (int warps = 0; warps < 6; ++warps) {
    Row fixed(factors.size(), -1);
    fixed[0] = warps;
    fixed[1] = 5 - warps;
    // Several large ALUs of many lanes take minutes to compile; the narrow ones show as well whether instances keep apart.
    for (size_t factor = 0; warps < 2 && factor < factors.size(); ++factor) {
      const std::string& name = factors[factor].name;
      if (name == "int.count" || name == "flt.count" || name == "slw.count") fixed[factor] = 0;
    }
    configurations.push_back(configuration_of(search.next(fixed), "small", configurations.size() + 1));
  }
  return configurations;
}

}  // namespace raypool
