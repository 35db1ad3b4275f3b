// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_traverser.v: the whole traverser, at the ports that the chip has for it.
//
// Use, once a cycle: read outputs(), which depend on no input of the cycle, then call clock(inputs).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "machine/common/packages.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/ray_exit.hpp"
#include "machine/traverser/ray_setup.hpp"
#include "machine/traverser/traverser_lane.hpp"
#include "machine/traverser/traverser_work.hpp"
#include "machine/traverser/tree_banks.hpp"
#include "machine/traverser/tree_lines.hpp"
#include "machine/traverser/tree_port.hpp"
#include "machine/traverser/triangle_group.hpp"

namespace raypool {

/// What stays for a frame: a host writes it before the first ray.
struct TraverserSetup {
  uint32_t root = TraverserLane::kNoReference;
  RootBox bounds{};
  TreePort::Places places;  ///< in the traverser's memory; of the stacks Traverser::stack_bytes()
  RayExit::Frame frame;
};

class Traverser {
 public:
  struct Sizes {
    uint32_t lanes = 8;           ///< 1 .. 31
    uint32_t slots = 24;          ///< of each
    uint32_t stack_entries = 16;  ///< of a slot
    int box_bits = 12;
    uint32_t triangle_pipes = 4;     ///< 1 .. lanes; lane l uses pipe l % triangle_pipes
    TreeBanks::Sizes nodes, leaves;  ///< of the caches; their lanes are not looked at
    uint32_t pool = 512;             ///< places of the ray pool
    uint32_t record_words = kIntersectionWords;
    bool contributes = false, culling = false, miss_records = false;
  };
  struct Inputs {
    bool ray_valid = false, ray_last = false;
    uint32_t ray_place = 0;
    Beat ray_data{};
    uint32_t put_ready = 0;  ///< mask: bit of ImportKind
    bool contribution_ready = false;
    bool request_ready = false;
    bool response_valid = false;
    uint8_t response_beat = 0;  ///< 0 .. 3 within the line
    Beat response_data{};
  };
  /// What goes with a valid means something only while it is set.
  struct Outputs {
    bool ray_ready = false;
    bool free_valid = false, free_shadow = false;
    uint32_t free_place = 0;
    bool put_valid = false;
    ImportKind put_kind = ImportKind::None;
    Beat put_data{};
    bool contribution_valid = false;
    FrameContribution contribution;
    bool request_valid = false;
    TreeRequest request;
    uint32_t nodes_given = 0, leaves_given = 0;  ///< masks: lanes that a cache gives a line; above them the exit
    TreeFault fault;                             ///< the first one, sticky
  };

  explicit Traverser(const Sizes& sizes)
      : sizes_(sizes),
        nodes_(of(sizes.nodes, sizes.lanes)),
        leaves_(of(sizes.leaves, sizes.lanes + 1)),
        port_(sizes.nodes.mshrs + sizes.leaves.mshrs + sizes.lanes, slot_bits(sizes.slots)),
        exit_({sizes.lanes, sizes.slots, sizes.pool, sizes.record_words, sizes.contributes, sizes.culling,
               sizes.miss_records}) {
    for (uint32_t lane = 0; lane < sizes.lanes; ++lane) {
      lanes_.push_back(std::make_unique<TraverserLane>(
          TraverserLane::Sizes{sizes.slots, sizes.stack_entries, sizes.box_bits}, &with_, lane));
      nodes_.wants[lane] = &lanes_[lane]->node_wants();
      leaves_.wants[lane] = &lanes_[lane]->leaf_wants();
    }
    leaves_.wants[sizes.lanes] = &exit_.wants();
    for (uint32_t pipe = 0; pipe < sizes.triangle_pipes; ++pipe) {
      uint32_t members = 0;
      for (uint32_t lane = pipe; lane < sizes.lanes; lane += sizes.triangle_pipes) members |= 1u << lane;
      groups_.emplace_back(lanes_, members, slot_bits(sizes.slots));
    }
    present();
  }

  Traverser(const Traverser&) = delete;
  Traverser& operator=(const Traverser&) = delete;

  /// While no ray is in it.
  void set_up(const TraverserSetup& setup) {
    setup_ = setup;
    for (const auto& lane : lanes_) lane->set_tree(setup.root, setup.places.triangles);
    port_.set_places(setup.places);
    exit_.set_frame(setup.frame);
  }
  /// Room for the stacks in the traverser's memory.
  static uint64_t stack_bytes(const Sizes& sizes) {
    uint64_t slots = uint64_t{1} << slot_bits(sizes.slots);
    for (uint32_t lane = 1; lane < sizes.lanes; lane *= 2) slots *= 2;
    return slots << TreePort::kBlockBits << 5;
  }

  const Outputs& outputs() const { return out_; }

  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    exit_inputs_ = {};
    work_.ray_cycles += in_flight_;
    const bool request_taken = out_.request_valid && inputs.request_ready;
    const bool line_taken = fill();
    look_up_nodes();
    look_up_leaves();
    std::optional<TreePort::Asked> asked = ask(request_taken);
    test_triangles();
    end_rays();
    enter(inputs);
    exit_inputs_.put_ready = inputs.put_ready;
    exit_inputs_.contribution_ready = inputs.contribution_ready;
    const TreeFault fault = first_fault();
    if (looks_inside_) note_handed();

    clock_lanes();
    exit_.clock(exit_inputs_);
    nodes_.clock(port_.line());
    leaves_.clock(port_.line());
    port_.clock(request_taken, asked ? &*asked : nullptr, line_taken,
                inputs.response_valid ? &inputs.response_data : nullptr);
    if (!out_.fault.valid) out_.fault = fault;
    present();
  }

  // ---- For reports of a lockstep

  /// What was handed from block to block in the cycle that has ended.
  struct Handed {
    struct ToLane {
      bool slot_taken = false, request_taken = false, test_taken = false, done_taken = false, leaf_waited = false;
      uint32_t node_taken = 0, leaf_taken = 0;
      std::optional<uint32_t> freed;
      std::optional<LaneStacks::Block> filled;
      std::optional<uint32_t> node_slot, leaf_slot;  ///< of lines that are given
      TreeLine node{}, leaf{};
      std::optional<LaneHits::Result> result;
    };
    std::vector<ToLane> lanes;  ///< the last one is ray_exit
    struct RaySet {
      RayExit::Slot slot{0, 0};
      RayExit::Set set;
      TraverserLane::Entered entered;
    };
    std::optional<RaySet> set;
    std::optional<uint32_t> entered_lane;  ///< of a ray that has come
  };
  void look_inside() { looks_inside_ = true; }
  const Handed& handed() const { return handed_; }  ///< after look_inside() only
  const TreePort& port() const { return port_; }
  const RayExit& exit() const { return exit_; }
  uint32_t lanes() const { return sizes_.lanes; }
  uint32_t slot_bits() const { return slot_bits(sizes_.slots); }
  int box_bits() const { return sizes_.box_bits; }

  // ---- For measurements

  /// Lines that the caches hold from now on as if they had just been looked up, the last one last; of triangles,
  /// counted from the first one. Takes no time. `read`: what a line of the traverser's memory holds.
  void remember(const TreeLines& lines, const std::function<TreeLine(uint32_t line)>& read) {
    for (const uint32_t line : lines.nodes) nodes_.remember(line, 0, read);
    for (const uint32_t line : lines.triangles) leaves_.remember(line, setup_.places.triangles, read);
  }
  const TreeBanks& node_cache() const { return nodes_.banks; }
  const TreeBanks& triangle_cache() const { return leaves_.banks; }
  const TraverserLane& lane(uint32_t number) const { return *lanes_[number]; }
  /// A ray is in flight while it has its slot. A leaf is visited when the last of its triangles has been tested.
  TraverserWork work() const {
    TraverserWork work = work_;
    for (const auto& lane : lanes_) {
      const LaneStacks::Work& stacks = lane->stack_work();
      work.boxes.tests += lane->node_tests();  // each lane has a pipe of its own, so none waits
      work.leaves += stacks.popped[1];
      work.deepest_stack = std::max(work.deepest_stack, stacks.deepest);
      work.stack_spills += stacks.spilled;
      work.stack_fills += stacks.fetched;
    }
    for (const TriangleGroup& group : groups_) {
      work.triangles.tests += group.work().tests;
      work.triangles.waiting += group.work().waiting;
    }
    work.node_cache = nodes_.banks.cache_work();
    work.triangle_cache = leaves_.banks.cache_work();
    work.memory_lines = port_.lines_read();
    work.memory_quadwords = port_.blocks_written() * (TreePort::kBlockWords / kBeatWords);
    return work;
  }

 private:
  /// A cache, its lines, and its requests and answers in a cycle.
  struct Cache {
    explicit Cache(const TreeBanks::Sizes& sizes) : banks(sizes), lines(sizes.lines) {}

    /// The line that comes is taken.
    bool fills() const { return fill != TreeBanks::kNone && banks.fill_ready(fill); }
    LeafReader::Given given(uint32_t lane) const { return {banks.given(lane).slot, &lines[banks.given(lane).row]}; }
    /// `first`: where in the memory its lines begin.
    void remember(uint32_t line, uint32_t first, const std::function<TreeLine(uint32_t line)>& read) {
      const uint32_t row = banks.remember(line);
      if (row != TreeBanks::kNone) lines[row] = read(first + line);
    }
    void clock(const std::optional<TreePort::Line>& line) {
      if (fills()) lines[banks.fill_row(fill)] = line->data;
      banks.clock(request_taken);
      request_taken = false;
      fill = TreeBanks::kNone;
    }

    TreeBanks banks;
    std::vector<TreeLine> lines;  // [row]
    TreeBanks::AllWants wants{};
    uint32_t fill = TreeBanks::kNone;  // request that gets its line
    bool request_taken = false;
  };
  /// A ray that is set up.
  struct Coming {
    uint32_t place = 0, depth = 0;
    bool shadow = false, returns = false, first = false;
    RayExit::Slot slot{0, 0};
  };

  static TreeBanks::Sizes of(TreeBanks::Sizes sizes, uint32_t lanes) {
    sizes.lanes = lanes;
    return sizes;
  }
  static uint32_t slot_bits(uint32_t slots) {
    uint32_t bits = 1;
    while ((1u << bits) < slots) ++bits;
    return bits;
  }
  uint32_t all_lanes() const { return (1u << sizes_.lanes) - 1; }

  static bool has(uint32_t lanes, uint32_t lane) { return (lanes >> lane & 1) != 0; }

  void note_handed() {
    handed_ = {};
    for (uint32_t number = 0; number < sizes_.lanes; ++number) {
      Handed::ToLane& lane = handed_.lanes.emplace_back();
      lane.slot_taken = entered_lane_ == number;
      lane.request_taken = requesting_lane_ == number;
      lane.test_taken = has(tests_taken_, number);
      lane.done_taken = done_lane_ == number;
      lane.node_taken = nodes_.banks.taken(number);
      lane.leaf_taken = leaves_.banks.taken(number);
      lane.leaf_waited = has(leaves_waited_, number);
      if (freed_ && freed_->lane == number) lane.freed = freed_->slot;
      if (filled_lane_ == number) lane.filled = block_;
      if (has(nodes_.banks.given_lanes(), number))
        lane.node_slot = nodes_.given(number).slot, lane.node = *nodes_.given(number).line;
      if (has(leaves_.banks.given_lanes(), number))
        lane.leaf_slot = leaves_.given(number).slot, lane.leaf = *leaves_.given(number).line;
      if (has(with_results_, number)) lane.result = *results_[number];
      if (lane.slot_taken) handed_.entered_lane = number;
    }
    Handed::ToLane& exit = handed_.lanes.emplace_back();
    exit.leaf_taken = exit_inputs_.taken;
    exit.leaf_waited = exit_inputs_.waited;
    if (exit_inputs_.given != nullptr) exit.leaf_slot = exit_inputs_.given->slot, exit.leaf = *exit_inputs_.given->line;
    if (exit_inputs_.set != nullptr) handed_.set = {exit_inputs_.set_slot, set_, entered_};
  }

  /// The end of a cycle of the lanes, kind by kind: which lanes have something to do cannot be predicted, but of each
  /// kind few have.
  void clock_lanes() {
    const auto each = [this](uint32_t lanes, const auto& happens) {
      for (; lanes != 0; lanes &= lanes - 1) happens(*lanes_[lowest(lanes)], lowest(lanes));
    };
    const uint32_t nodes_given = out_.fault.valid ? 0 : nodes_.banks.given_lanes();
    const uint32_t leaves_taken = leaves_.banks.taken_lanes() & all_lanes();
    const uint32_t leaves_given = leaves_.banks.given_lanes() & all_lanes();
    const auto bit = [](uint32_t lane) { return lane != kNone ? 1u << lane : 0; };

    each(with_.to_offer() | nodes_.banks.taken_lanes(),
         [&](TraverserLane& lane, uint32_t number) { lane.offer(nodes_.banks.taken(number)); });
    each(with_.ends | bit(done_lane_), [&](TraverserLane& lane, uint32_t number) { lane.end(number == done_lane_); });
    with_.stacked = with_.not_ready = 0;
    each(with_.to_stack() | bit(requesting_lane_) | bit(filled_lane_), [&](TraverserLane& lane, uint32_t number) {
      lane.stack(number == requesting_lane_, number == filled_lane_ ? &block_ : nullptr);
    });
    each(with_.begins & ~with_.not_ready, [](TraverserLane& lane, uint32_t) { lane.begin(); });
    each(with_.to_read() | leaves_taken | leaves_given | leaves_waited_ | tests_taken_, [&](TraverserLane& lane,
                                                                                            uint32_t number) {
      const LeafReader::Given given = has(leaves_given, number) ? leaves_.given(number) : LeafReader::Given{0, nullptr};
      lane.read({leaves_.banks.taken(number), has(leaves_waited_, number), given.line != nullptr ? &given : nullptr,
                 has(tests_taken_, number)});
    });
    each(with_.leaf_ends | with_results_, [&](TraverserLane& lane, uint32_t number) {
      lane.take_result(has(with_results_, number) ? results_[number] : nullptr);
    });
    TraverserLane::end_tests(with_, nodes_given);
    each(with_.faulty, [](TraverserLane& lane, uint32_t) { lane.show_fault(); });
    each(nodes_given, [&](TraverserLane& lane, uint32_t number) { lane.test(nodes_.given(number)); });
    if (exit_inputs_.set != nullptr) lanes_[exit_inputs_.set_slot.lane]->enter(entered_);
    if (entered_lane_ != kNone) lanes_[entered_lane_]->take_slot();
    if (freed_) lanes_[freed_->lane]->free_slot(freed_->slot);
    ++with_.cycle;
  }

  // The line that has come is offered to its requester. True: it is taken.
  bool fill() {
    filled_lane_ = kNone;
    const std::optional<TreePort::Line>& line = port_.line();
    if (!line) return false;
    if (line->source == TreePort::Source::Stacks) {
      block_ = line->block(sizes_.box_bits + 9);
      filled_lane_ = line->id;
      return true;
    }
    Cache& cache = line->source == TreePort::Source::Nodes ? nodes_ : leaves_;
    cache.fill = line->id;
    return cache.fills();
  }

  void look_up_nodes() { nodes_.banks.choose(nodes_.wants, with_.nodes, all_lanes(), nodes_.fill); }
  // For the lanes, and behind them for the exit.
  void look_up_leaves() {
    const uint32_t exit = 1u << sizes_.lanes;
    const uint32_t room = with_.leaf_room | (exit_.room() ? exit : 0);
    const uint32_t waited = leaves_.banks.waited() & room;
    leaves_.banks.choose(leaves_.wants, with_.leaves | (exit_.wants_any() ? exit : 0), room, leaves_.fill);
    leaves_waited_ = waited & ~exit;
    exit_inputs_.waited = (waited & exit) != 0;
    exit_inputs_.taken = leaves_.banks.taken(sizes_.lanes);
    if ((leaves_.banks.given_lanes() & exit) != 0) {
      exit_given_ = leaves_.given(sizes_.lanes);
      exit_inputs_.given = &exit_given_;
    }
  }

  std::optional<TreePort::Asked> ask(bool request_taken) {
    requesting_lane_ = kNone;
    const std::optional<TreePort::Source> source = port_.choose(
        request_taken, nodes_.banks.request_valid(), leaves_.banks.request_valid(), with_.request, out_.fault.valid);
    if (!source) return {};
    TreePort::Asked asked;
    asked.source = *source;
    if (*source == TreePort::Source::Stacks) {
      asked.lane = port_.lane();
      stack_request_ = lanes_[asked.lane]->request();
      asked.stack = &stack_request_;
      requesting_lane_ = asked.lane;
      return asked;
    }
    Cache& cache = *source == TreePort::Source::Nodes ? nodes_ : leaves_;
    asked.line = cache.banks.request_line();
    asked.id = cache.banks.request_id();
    cache.request_taken = true;
    return asked;
  }

  void test_triangles() {
    tests_taken_ = with_results_ = 0;
    for (uint32_t ends = std::exchange(tests_end_[with_.cycle % tests_end_.size()], 0); ends != 0; ends &= ends - 1) {
      TriangleGroup& group = groups_[lowest(ends)];
      const uint32_t lane = group.end(with_.cycle);
      with_results_ |= 1u << lane;
      results_[lane] = &group.result();
    }
    if (with_.test == 0) return;
    uint32_t& ends = tests_end_[(with_.cycle + TriangleGroup::kStages) % tests_end_.size()];
    for (uint32_t asking = with_.test; asking != 0;) {
      const uint32_t number = lowest(asking) % size32(groups_);
      TriangleGroup& group = groups_[number];
      asking &= ~group.members();
      const uint32_t lane = group.choose(with_.test);
      group.begin(with_.cycle, lane);
      tests_taken_ |= 1u << lane;
      ends |= 1u << number;
    }
  }

  void end_rays() {
    freed_ = exit_.freed_slot();
    in_flight_ -= freed_ ? 1 : 0;
    done_lane_ = kNone;
    const std::optional<uint32_t> lane = exit_.choose(out_.fault.valid ? 0 : with_.done);
    if (!lane) return;
    const uint32_t slot = lanes_[*lane]->done_slot();
    done_ = {*lane, slot, lanes_[*lane]->hits().best(slot)};
    exit_inputs_.done = &done_;
    done_lane_ = *lane;
  }

  // A ray comes, in beats; with the last one it gets a slot. One that is set up enters its lane.
  void enter(const Inputs& inputs) {
    entered_lane_ = kNone;
    if (const RaySetupPipe::Result* const result = setup_pipe_.result()) {
      const Coming coming = coming_.front();
      coming_.pop_front();
      const RaySetup& setup = result->setup;
      entered_ = {coming.slot.slot,
                  {setup.valid, coming.shadow || coming.first, setup.box, setup.triangle, {setup.limit, setup.scale}}};
      set_ = {coming.place, coming.depth, coming.shadow, coming.returns, coming.first, setup.triangle, setup.scale};
      exit_inputs_.set = &set_;
      exit_inputs_.set_slot = coming.slot;
    }
    if (!inputs.ray_valid || !out_.ray_ready) {
      setup_pipe_.clock(nullptr);
      return;
    }
    std::copy(inputs.ray_data.begin(), inputs.ray_data.end(), ray_.begin() + beat_ * kBeatWords);
    ++beat_;
    if (!inputs.ray_last) {
      setup_pipe_.clock(nullptr);
      return;
    }
    beat_ = 0;
    const uint32_t lane = enter_turn_.choose(with_.slot);
    enter_turn_.advance(lane);
    entered_lane_ = lane;
    ++work_.rays;
    work_.most_rays = std::max(work_.most_rays, ++in_flight_);
    coming_.push_back({inputs.ray_place,
                       ray_[word::kFlags] & kDepthMask,
                       is_shadow(ray_),
                       sizes_.miss_records && returns(ray_),
                       sizes_.miss_records && returns_first(ray_),
                       {lane, lanes_[lane]->slot()}});
    RayWords words;
    for (int axis = 0; axis < 3; ++axis) {
      words.origin[axis] = as_float(ray_[word::kOrigin + axis]);
      words.direction[axis] = as_float(ray_[word::kDirection + axis]);
    }
    words.limit = as_float(ray_[word::kLimit]);
    const RaySetupPipe::Result start{0, RaySetup(words, setup_.bounds, sizes_.box_bits)};
    setup_pipe_.clock(&start);
    exit_inputs_.ray = &ray_;
    exit_inputs_.ray_place = inputs.ray_place;
  }
  // Of this cycle: the port's, then that of the lowest lane.
  TreeFault first_fault() const {
    if (port_.fault().valid) return port_.fault();
    return with_.fault != 0 ? lanes_[lowest(with_.fault)]->fault() : TreeFault{};
  }

  void present() {
    out_.ray_ready = beat_ != 0 || (!out_.fault.valid && with_.slot != 0);
    out_.free_valid = exit_.free_valid();
    if (out_.free_valid) {
      out_.free_place = exit_.free_place();
      out_.free_shadow = exit_.free_shadow();
    }
    out_.put_valid = exit_.put_valid();
    if (out_.put_valid) {
      out_.put_kind = exit_.put_kind();
      out_.put_data = exit_.put_data();
    }
    out_.contribution_valid = exit_.contribution_valid();
    if (out_.contribution_valid) out_.contribution = exit_.contribution();
    out_.request_valid = port_.request_valid();
    if (out_.request_valid) out_.request = port_.request();
    out_.nodes_given = nodes_.banks.given_lanes();
    out_.leaves_given = leaves_.banks.given_lanes();
  }

  Sizes sizes_;
  TraverserSetup setup_;
  TraverserLane::Sets with_;
  std::vector<std::unique_ptr<TraverserLane>> lanes_;
  std::vector<TriangleGroup> groups_;
  std::array<uint32_t, 64> tests_end_{};  // [cycle] in turn: groups with a test that has its result in it
  static_assert(TriangleGroup::kStages < 64);
  Cache nodes_, leaves_;
  TreePort port_;
  RayExit exit_;
  RoundRobin enter_turn_;
  Ray ray_{};          // that comes
  uint32_t beat_ = 0;  // that comes next
  RaySetupPipe setup_pipe_;
  std::deque<Coming> coming_;  // rays in it

  // What a cycle's inputs refer to, and what happens in it: sets of lanes, and lanes, or kNone.
  static constexpr uint32_t kNone = UINT32_MAX;
  uint32_t tests_taken_ = 0, with_results_ = 0, leaves_waited_ = 0;
  uint32_t entered_lane_ = kNone, requesting_lane_ = kNone, done_lane_ = kNone, filled_lane_ = kNone;
  std::optional<RayExit::Slot> freed_;
  std::array<const LaneHits::Result*, TreeCache::kMostLanes> results_{};  // [lane]
  LeafReader::Given exit_given_{};
  RayExit::Inputs exit_inputs_;
  LaneStacks::Block block_;
  LaneStacks::Request stack_request_;
  RayExit::Done done_;
  RayExit::Set set_;
  TraverserLane::Entered entered_{0, {false, false, BoxRay({0, 0, 0}, {0, 0, 0}, 0, 12), {}, {}}};
  Outputs out_;
  uint32_t in_flight_ = 0;  // rays
  TraverserWork work_;      // what no block counts
  bool looks_inside_ = false;
  Handed handed_;
};

}  // namespace raypool
