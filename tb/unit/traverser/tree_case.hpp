// All that a run of the traverser's bench depends on, as a file too; and what makes one that fails small.
#pragma once

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cosim/minimise_blocks.hpp"
#include "unit/traverser/traverser_bench.hpp"

namespace raypool::bench {

struct TreeCase {
  uint32_t seed = 1;  ///< of the bench
  LaneTree tree;
  std::vector<Ray> rays;  ///< the first colour is the ray's number
  TraverserTraffic traffic;
  StackMemory stacks = StackMemory::Keeps;
  bool is_tree = true;  ///< false: there may be a fault
};

inline RayQuery query_of(const Ray& ray) {
  const auto vector = [&ray](uint32_t first) {
    return Vec3{as_float(ray[first]), as_float(ray[first + 1]), as_float(ray[first + 2])};
  };
  return {vector(word::kOrigin), vector(word::kDirection), as_float(ray[word::kLimit])};
}

template <typename P>
std::vector<typename TraverserBench<P>::Asked> asked_of(const TreeCase& what) {
  const NarrowFloat narrow(TriangleGroup::kBits);
  std::vector<typename TraverserBench<P>::Asked> asked;
  for (const Ray& ray : what.rays) {
    const bool any = is_shadow(ray) || (P::sizes().miss_records && returns_first(ray));
    const LaneRay lane = lane_ray(query_of(ray), what.tree.bounds, P::kBits, any);
    asked.push_back({ray, Walk(what.tree, lane, narrow, P::sizes().stack_entries), lane.limit.scale, lane.triangle});
  }
  return asked;
}

template <typename P>
void run_case(TraverserBench<P>& bench, const TreeCase& what) {
  const auto asked = asked_of<P>(what);
  if (what.is_tree)
    bench.trace(what.tree, asked, what.traffic);
  else if (what.stacks == StackMemory::Keeps)
    bench.trace_or_fault(what.tree, asked, what.traffic);
  else
    bench.trace_or_fault(what.tree, asked, what.traffic, what.stacks);
}

/// The first thing that is wrong with a run, which is then no failure of the test; none.
struct Wrong {
  std::string where, what;
};
template <typename P>
std::optional<Wrong> wrong_with(const TreeCase& what, uint32_t turned = 0) {
  const auto asked = asked_of<P>(what);
  if (what.is_tree)  // a cut may have made none of it
    for (const auto& ray : asked)
      if (!ray.walk.faults.empty()) return {};
  testing::TestPartResultArray results;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    TraverserBench<P> bench(what.seed);
    bench.turn(turned);
    run_case(bench, what);
  }
  for (int i = 0; i < results.size(); ++i) {
    const testing::TestPartResult& result = results.GetTestPartResult(i);
    if (result.failed())
      return Wrong{std::string(result.file_name()) + ":" + std::to_string(result.line_number()), result.summary()};
  }
  return {};
}

/// References that lead from the root, in the order of a walk.
struct Reached {
  std::vector<uint32_t> nodes, leaves;

  explicit Reached(const LaneTree& tree) {
    std::set<uint32_t> seen;
    const std::function<void(uint32_t)> visit = [&](uint32_t reference) {
      if (reference == kNoChild || !seen.insert(reference).second) return;
      if ((reference & kLeafBit) != 0) {
        leaves.push_back(reference);
      } else if (reference < tree.nodes.size()) {
        nodes.push_back(reference);
        const TreeNode node = tree.node(reference);
        for (uint32_t i = 0; i < std::min<uint32_t>(node.boxes.children, kBvhWidth); ++i) visit(node.children[i]);
      }
    };
    visit(tree.root);
  }
  uint32_t triangles() const {
    uint32_t count = 0;
    for (const uint32_t leaf : leaves) count += (leaf >> kLeafPlaceBits & 3) + 1;
    return count;
  }
};

inline std::string size_of(const TreeCase& what) {
  const Reached reached(what.tree);
  return std::to_string(what.rays.size()) + " rays, " + std::to_string(reached.nodes.size()) + " nodes, " +
         std::to_string(reached.triangles()) + " triangles";
}

/// Cuts a case down as long as it `fails`.
class TreeMinimiser {
 public:
  using Fails = std::function<bool(const TreeCase&)>;
  static constexpr uint64_t kRuns = 1000;
  static constexpr double kSeconds = 60;

  TreeMinimiser(TreeCase what, Fails fails) : best_(std::move(what)), fails_(std::move(fails)) {}

  TreeCase run() {
    for (bool again = true; again && !ends();) {
      again = rays();
      again |= tree();
      again |= traffic();
    }
    return best_;
  }
  uint64_t runs() const { return runs_; }

 private:
  using Edit = std::function<void(LaneTree&)>;

  bool ends() const {
    return runs_ >= kRuns ||
           std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() > kSeconds;
  }
  bool attempt(TreeCase what) {
    if (ends()) return false;
    ++runs_;
    const bool fails = fails_(what);
    if (fails) best_ = std::move(what);
    return fails;
  }

  bool rays() {
    const auto without = [&](size_t from, size_t count) {
      TreeCase what = best_;
      const auto first = what.rays.begin() + static_cast<std::ptrdiff_t>(from);
      what.rays.erase(first, first + static_cast<std::ptrdiff_t>(std::min(count, what.rays.size() - from)));
      for (size_t i = 0; i < what.rays.size(); ++i) what.rays[i][word::kColor] = static_cast<uint32_t>(i);
      return !what.rays.empty() && attempt(std::move(what));
    };
    return minimise_blocks([this] { return best_.rays.size(); }, without, [this] { return ends(); });
  }

  static void put(LaneTree& tree, uint32_t number, const TreeNode& node) {
    std::memcpy(static_cast<void*>(&tree.nodes[number]), &node, sizeof node);
  }
  // What a reference may be instead: of a node, one of its children; of a leaf, one with a triangle less.
  static std::vector<uint32_t> instead(const LaneTree& tree, uint32_t reference) {
    if (reference == kNoChild) return {};
    if ((reference & kLeafBit) != 0) {
      constexpr uint32_t kOne = 1u << kLeafPlaceBits;
      if ((reference & 3 * kOne) == 0) return {};
      return {reference - kOne, reference - kOne + 1};
    }
    if (reference >= tree.nodes.size()) return {};
    const TreeNode node = tree.node(reference);
    return {node.children, node.children + std::min<uint32_t>(node.boxes.children, kBvhWidth)};
  }
  static std::vector<Edit> edits(const LaneTree& tree) {
    std::vector<Edit> edits;
    for (const uint32_t other : instead(tree, tree.root))
      edits.push_back([other](LaneTree& changed) { changed.root = other; });
    for (const uint32_t number : Reached(tree).nodes) {
      const TreeNode node = tree.node(number);
      const uint32_t count = node.boxes.children;
      for (uint32_t i = 0; i < count && count <= kBvhWidth; ++i) {
        if (count > 1) {
          edits.push_back([number, i](LaneTree& changed) {
            TreeNode without = changed.node(number);
            const uint32_t last = --without.boxes.children;
            without.children[i] = std::exchange(without.children[last], kNoChild);
            for (auto& planes : without.boxes.planes)
              for (auto& axis : planes) axis[i] = axis[last];
            put(changed, number, without);
          });
        }
        for (const uint32_t other : instead(tree, node.children[i])) {
          edits.push_back([number, i, other](LaneTree& changed) {
            TreeNode with = changed.node(number);
            with.children[i] = other;
            put(changed, number, with);
          });
        }
      }
    }
    return edits;
  }
  bool tree() {
    bool any = false;
    for (size_t i = 0; !ends();) {
      const std::vector<Edit> all = edits(best_.tree);
      if (i >= all.size()) break;
      TreeCase what = best_;
      all[i](what.tree);
      if (attempt(std::move(what)))
        any = true;
      else
        ++i;
    }
    return any;
  }

  bool traffic() {
    bool any = false;
    const auto set = [&](auto& present, auto value, auto change) {
      if (present == value) return;
      TreeCase what = best_;
      change(what, value);
      any |= attempt(std::move(what));
    };
    using T = TraverserTraffic;
    for (uint32_t T::*const field :
         {&T::no_ray, &T::leave_request, &T::line, &T::late_beat, &T::no_room, &T::no_contribution})
      set(best_.traffic.*field, field == &T::line ? 1u : 0u,
          [field](TreeCase& what, uint32_t value) { what.traffic.*field = value; });
    set(best_.stacks, StackMemory::Keeps, [](TreeCase& what, StackMemory value) { what.stacks = value; });
    return any;
  }

  TreeCase best_;
  Fails fails_;
  uint64_t runs_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// ---- As a file: words as they lie in the memory

template <typename P>
nlohmann::json to_json(const TreeCase& what) {
  const TraverserTraffic& t = what.traffic;
  nlohmann::json json{{"lanes", P::sizes().lanes},
                      {"slots", P::sizes().slots},
                      {"seed", what.seed},
                      {"is_tree", what.is_tree},
                      {"stacks", int{to_underlying(what.stacks)}},
                      {"traffic", {t.no_ray, t.leave_request, t.line, t.late_beat, t.no_room, t.no_contribution}},
                      {"root", what.tree.root},
                      {"nodes", what.tree.nodes},
                      {"triangles", what.tree.triangles},
                      {"rays", what.rays}};
  for (int axis = 0; axis < 3; ++axis) {
    json["lower"].push_back(as_bits(static_cast<float>(what.tree.bounds.lower[axis])));
    json["upper"].push_back(as_bits(static_cast<float>(what.tree.bounds.upper[axis])));
  }
  return json;
}
inline TreeCase case_of(const nlohmann::json& json) {
  TreeCase what;
  what.seed = json.at("seed");
  what.is_tree = json.at("is_tree");
  what.stacks = static_cast<StackMemory>(json.at("stacks").get<int>());
  const auto traffic = json.at("traffic").get<std::array<uint32_t, 6>>();
  what.traffic = {traffic[0], traffic[1], traffic[2], traffic[3], traffic[4], traffic[5]};
  what.tree.root = json.at("root");
  what.tree.nodes = json.at("nodes").get<std::vector<TreeLine>>();
  what.tree.triangles = json.at("triangles").get<std::vector<TreeLine>>();
  what.rays = json.at("rays").get<std::vector<Ray>>();
  for (int axis = 0; axis < 3; ++axis) {
    what.tree.bounds.lower[axis] = as_float(json.at("lower").at(axis).get<uint32_t>());
    what.tree.bounds.upper[axis] = as_float(json.at("upper").at(axis).get<uint32_t>());
  }
  return what;
}

/// Minimises a failing case and writes it to a file that RAYPOOL_CASE runs again.
template <typename P>
void minimise_and_report(const TreeCase& what, const std::string& filter) {
  const std::optional<Wrong> wrong = wrong_with<P>(what);
  if (!wrong) return;
  TreeMinimiser minimiser(what, [&](const TreeCase& cut) {
    const std::optional<Wrong> now = wrong_with<P>(cut);
    return now && now->where == wrong->where;
  });
  const TreeCase small = minimiser.run();
  const std::string path = testing::TempDir() + "traverser_case_" + std::to_string(P::sizes().lanes) + "_lanes.json";
  std::ofstream(path) << to_json<P>(small).dump(1) << "\n";
  std::cout << "minimised in " << minimiser.runs() << " runs from " << size_of(what) << " to " << size_of(small)
            << "; run it again: RAYPOOL_CASE=" << path << " traverser_test --gtest_filter=" << filter << "\n"
            << wrong_with<P>(small)->what << "\n";
}

/// True if RAYPOOL_CASE names a case: of this machine, it has been run.
template <typename P>
bool runs_case_of_file() {
  const char* const path = std::getenv("RAYPOOL_CASE");
  if (path == nullptr) return false;
  std::ifstream file(path);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded()) {
    ADD_FAILURE() << path << ": is not a case: a failing test writes one and prints its path";
    return true;
  }
  if (json.at("lanes") != P::sizes().lanes || json.at("slots") != P::sizes().slots) return true;
  const TreeCase what = case_of(json);
  std::cout << path << ": " << size_of(what) << "\n";
  TraverserBench<P> bench(what.seed);
  run_case(bench, what);
  return true;
}

}  // namespace raypool::bench
