// The traverser in Verilog and its class, side by side, between pools that have room when they like and a memory that
// answers when it likes: all outputs in every cycle, and of every ray what becomes of it. Where the memory holds no
// tree, the fault that comes of it.
#pragma once

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "machine/traverser/traverser.hpp"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"
#include "unit/traverser/lane_trees.hpp"

namespace raypool::bench {

/// One in so many cycles (0: never): a beat of a ray is not there, a request is left, a line of those that are asked
/// for begins to come, a beat of it is late, a kind of package or contributions have no room.
struct TraverserTraffic {
  uint32_t no_ray = 0, leave_request = 0, line = 1, late_beat = 0, no_room = 0, no_contribution = 0;
};

/// What the memory does to blocks of stacks that are written: keeps them, loses them, or changes some of their bits.
enum class StackMemory : uint8_t { Keeps, Loses, Spoils };

struct TraverserSeen {
  uint64_t cycles = 0, rays = 0, normal = 0, shadow = 0, direct = 0, contributions = 0, dropped = 0;
  uint64_t reads = 0, spills = 0, stack_reads = 0, most_lines = 0, full = 0;
  uint64_t left = 0;  ///< cycles in which a lane has no room for a line of a leaf for which it has waited
  std::array<uint64_t, 7> faults{};  ///< [code]
  uint64_t spoilt = 0;               ///< blocks of stacks
  uint64_t exchanged = 0;            ///< rays that left when another one with the same package seemed to have
  std::array<uint64_t, 2> plain{};   ///< [met something] packages of rays that return, without a hit
};

/// A cache's sizes.
template <uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t banks>
struct Cache {
  static constexpr TreeBanks::Sizes kSizes{0, lines, ways, mshrs, banks};
};

/// Unit: the traverser with these parameters.
template <typename Unit, uint32_t lanes, uint32_t slots, uint32_t entries, uint32_t bits, uint32_t pipes,
          typename Nodes, typename Leaves, uint32_t pool, uint32_t words, bool shading, bool culling,
          bool miss_records = false>
struct TraverserParameters {
  using Verilated = Unit;
  static constexpr uint32_t kPool = pool, kWords = words, kBits = bits;
  static Traverser::Sizes sizes() {
    Traverser::Sizes sizes;
    sizes.lanes = lanes;
    sizes.slots = slots;
    sizes.stack_entries = entries;
    sizes.box_bits = int{bits};
    sizes.triangle_pipes = pipes;
    sizes.nodes = Nodes::kSizes;
    sizes.leaves = Leaves::kSizes;
    sizes.pool = pool;
    sizes.record_words = words;
    sizes.contributes = shading;
    sizes.culling = culling;
    sizes.miss_records = miss_records;
    return sizes;
  }
};

template <typename P>
class TraverserBench {
 public:
  struct Asked {
    Ray ray;
    Walk walk;
    int scale;             ///< of its hit's t
    TriangleRay set_up{};  ///< where it hits something
  };

  explicit TraverserBench(uint32_t seed) : bench_(seed) {}

  /// Traces the rays; all are done in time. `tree` must outlive the call.
  void trace(const LaneTree& tree, const std::vector<Asked>& rays, const TraverserTraffic& traffic) {
    more_lines_ = 1u << (25 - traces_++ % 26);
    ASSERT_NO_FATAL_FAILURE(run(tree, rays, traffic, StackMemory::Keeps));
    more_lines_ = 0;
    ASSERT_FALSE(model_->outputs().fault.valid);
  }
  /// The same of a tree that may be malformed: all are done, or there is a fault that one of them comes to. It stays,
  /// nothing is requested any more, and a ray does not leave.
  void trace_or_fault(const LaneTree& tree, const std::vector<Asked>& rays, const TraverserTraffic& traffic) {
    ASSERT_NO_FATAL_FAILURE(run(tree, rays, traffic, StackMemory::Keeps));
    const TreeFault& fault = model_->outputs().fault;
    const auto faults = [](const Asked& asked) { return !asked.walk.faults.empty(); };
    if (!fault.valid) {
      ASSERT_TRUE(std::none_of(rays.begin(), rays.end(), faults))
          << "a ray comes to a malformed part of the tree, and is done";
      return;
    }
    const auto is_it = [&](const TreeFault& may) {
      const uint64_t base = fault.code == TreeFaultCode::TriangleBeyond ? places_of_.triangles : 0;
      const bool stack = fault.code == TreeFaultCode::StackFull && fault.line >= places_of_.stacks;
      return may.code == fault.code &&
             (stack || fault.line == std::min<uint64_t>(base + may.line, LeafReader::kLastLine));
    };
    ASSERT_TRUE(std::any_of(
        rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(begun_),
        [&](const Asked& asked) { return std::any_of(asked.walk.faults.begin(), asked.walk.faults.end(), is_it); }))
        << "code " << int{to_underlying(fault.code)} << ", line " << fault.line << ": no ray comes to that";
  }
  /// The same with a memory that does so with stacks: rays may become anything.
  void trace_or_fault(const LaneTree& tree, const std::vector<Asked>& rays, const TraverserTraffic& traffic,
                      StackMemory stacks) {
    ASSERT_NO_FATAL_FAILURE(run(tree, rays, traffic, stacks));
  }
  /// The same where packages have no room for long: then all others are done, and places alone are what is missing.
  void trace_without_room(const LaneTree& tree, const std::vector<Asked>& rays) {
    begin(tree);
    rays_ = &rays;
    for (uint32_t kinds = 0; done_ < rays.size(); kinds = ~0u) {
      uint64_t moved = 0, done = done_ + begun_;
      for (uint32_t still = 0; still < 3000; ++still) {
        ASSERT_NO_FATAL_FAILURE(cycle({}, kinds));
        if (done_ + begun_ != done) still = 0;
        moved += done_ + begun_ - done;
        done = done_ + begun_;
      }
      ASSERT_TRUE(moved != 0 || kinds == 0) << "rays wait for ever";
      if (kinds != 0) continue;
      for (const std::optional<size_t>& in : in_) {
        if (in) {
          EXPECT_TRUE(needs_room((*rays_)[*in])) << "a ray that needs no room waits for one that does";
        }
      }
      if (begun_ < rays.size()) {
        EXPECT_TRUE(places_.empty());
      }
      seen.full += places_.empty() ? 1 : 0;
    }
  }

  /// To test the bench: where this word is in a line of the memory, the Verilog alone gets it with a bit turned. 0: no
  /// word.
  void turn(uint32_t word) { turned_ = word; }

  TraverserSeen seen;

 private:
  // Until all rays are done, or there is a fault; and then for long enough that all that still moves has moved.
  void run(const LaneTree& tree, const std::vector<Asked>& rays, const TraverserTraffic& traffic, StackMemory stacks) {
    begin(tree);
    stack_memory_ = stacks;
    rays_ = &rays;
    uint64_t lines = 100;
    for (const Asked& asked : rays)
      lines += 3 + (stacks == StackMemory::Keeps ? asked.walk.lines.size() : 1 + 8 * tree.nodes.size());
    const uint64_t end = seen.cycles + 600 * lines;
    const TreeFault& fault = model_->outputs().fault;
    while (done_ < rays.size() && !fault.valid) {
      ASSERT_LT(seen.cycles, end) << "a ray waits for ever";
      ASSERT_NO_FATAL_FAILURE(cycle(traffic, ~0u));
    }
    // A place that is freed twice would be seen now.
    const TreeFault first = fault;
    for (uint32_t i = 0; i < (first.valid ? 600 : 100); ++i) ASSERT_NO_FATAL_FAILURE(cycle(traffic, ~0u));
    seen.left += model_->triangle_cache().work().left;
    if (!first.valid) return;
    ++seen.faults[to_underlying(first.code)];
    ASSERT_TRUE(fault.valid && fault.code == first.code && fault.line == first.line) << "it does not stay";
    ASSERT_LE(requests_since_fault_, 1u) << "more is requested than what was offered before";
    ASSERT_LT(done_, begun_) << "no ray is left";
    ASSERT_FALSE(model_->outputs().ray_ready && beat_in_ == 0) << "rays come in";
  }
  void begin(const LaneTree& tree) {
    model_ = std::make_unique<Traverser>(P::sizes());
    const Traverser::Sizes sizes = P::sizes();
    memory_.clear();
    const auto put = [&](uint32_t first, const std::vector<TreeLine>& lines) {
      for (const TreeLine& line : lines) memory_[first++] = line;
    };
    TraverserSetup setup;
    const auto nodes = static_cast<uint32_t>(tree.nodes.size());
    setup.places.triangles = nodes;
    setup.places.triangle_lines = static_cast<uint32_t>(tree.triangles.size());
    setup.places.stacks = nodes + setup.places.triangle_lines + static_cast<uint32_t>(bench_.random()) % 1000;
    setup.places.triangle_lines = std::max(setup.places.triangle_lines, more_lines_);
    put(0, tree.nodes);
    put(setup.places.triangles, tree.triangles);
    last_line_ = setup.places.stacks + static_cast<uint32_t>(Traverser::stack_bytes(sizes) / 64);
    places_of_ = setup.places;
    // Materials that reflect have a bit in the triangle's word.
    for (uint32_t place = 0; (place + 1) * LeafReader::kTriangleWords <= tree.triangles.size() * 16; ++place) {
      const uint32_t at = place * LeafReader::kTriangleWords + LeafReader::kTriangleWords - 1;
      uint32_t& material = memory_[setup.places.triangles + at / 16][at % 16];
      material = static_cast<uint32_t>(bench_.random()) & 0x87ffffff;
    }
    setup.root = tree.root;
    for (int axis = 0; axis < 3; ++axis) {
      setup.bounds.lower[axis] = tree.bounds.lower[axis];
      setup.bounds.upper[axis] = tree.bounds.upper[axis];
    }
    frame_.material_base = static_cast<uint32_t>(bench_.random()) & ~3u;
    frame_.depth = static_cast<uint32_t>(bench_.random()) % 256;
    frame_.reflections = bench_.random() % 4 != 0;
    frame_.layout = any_layout();
    setup.frame = frame_;
    model_->set_up(setup);
    drive_frame(setup);
    tree_ = &tree;

    u_.rst_ni = 0;
    bench_.clock();
    bench_.clock();
    u_.rst_ni = 1;
    places_.clear();
    for (uint32_t place = 0; place < P::kPool; ++place) places_.push_back(place);
    std::shuffle(places_.begin(), places_.end(), bench_.random);
    in_.assign(P::kPool, {});
    left_.assign(P::kPool, false);
    begun_ = done_ = 0;
    stack_memory_ = StackMemory::Keeps;
    requests_since_fault_ = 0;
    beat_in_ = beat_out_ = line_beat_ = 0;
    on_way_.clear();
  }
  RecordLayout any_layout() {
    std::vector<uint32_t> words;
    for (uint32_t word = 0; word < kIntersectionWords; ++word) words.push_back(word);
    std::shuffle(words.begin(), words.end(), bench_.random);
    RecordLayout layout;
    layout.words = P::kWords;
    layout.place.fill(RecordLayout::kAbsent);
    for (uint32_t place = 0; place < P::kWords; ++place)
      if (bench_.random() % 16 != 0) layout.place[words[place]] = static_cast<uint8_t>(place);
    return layout;
  }
  void drive_frame(const TraverserSetup& setup) {
    u_.root_i = setup.root;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      u_.lower_i[axis] = as_bits(setup.bounds.lower[axis]);
      u_.upper_i[axis] = as_bits(setup.bounds.upper[axis]);
    }
    u_.triangles_line_i = setup.places.triangles;
    u_.triangle_lines_i = setup.places.triangle_lines;
    u_.stacks_line_i = setup.places.stacks;
    u_.material_base_i = setup.frame.material_base;
    u_.depth_limit_i = static_cast<uint8_t>(setup.frame.depth);
    u_.reflections_i = setup.frame.reflections;
    const std::array<uint8_t, kIntersectionWords> words = words_of(setup.frame.layout);
    for (uint32_t place = 0; place < words.size(); ++place) set_bits(u_.record_i, 5 * place, 5, words[place]);
  }

  bool one_of(uint32_t n) { return n != 0 && bench_.one_of(n); }

  /// `kinds`: with room at all.
  void cycle(const TraverserTraffic& traffic, uint32_t kinds) {
    ASSERT_NO_FATAL_FAILURE(compare());
    const Traverser::Outputs& out = model_->outputs();
    Traverser::Inputs inputs;
    const bool ray_there = begun_ < rays_->size() && (beat_in_ != 0 || !places_.empty()) && !one_of(traffic.no_ray);
    inputs.ray_valid = ray_there;
    if (ray_there) {
      inputs.ray_place = places_.empty() ? place_in_ : places_.front();
      if (beat_in_ != 0) inputs.ray_place = place_in_;
      inputs.ray_last = beat_in_ == kRayBeats - 1;
      const Ray& ray = (*rays_)[begun_].ray;
      std::copy_n(ray.begin() + beat_in_ * kBeatWords, kBeatWords, inputs.ray_data.begin());
    }
    for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct})
      inputs.put_ready |= (one_of(traffic.no_room) ? 0u : 1u) << to_underlying(kind);
    inputs.put_ready &= kinds;
    if (!P::sizes().culling) inputs.put_ready &= 7;
    inputs.contribution_ready = !one_of(traffic.no_contribution);
    inputs.request_ready = !one_of(traffic.leave_request);
    serve(traffic, inputs);
    drive(inputs);

    if (ray_there && out.ray_ready) take_beat(inputs);
    if (out.request_valid && inputs.request_ready) {
      ASSERT_NO_FATAL_FAILURE(take_request(out.request));
    }
    if (out.contribution_valid && inputs.contribution_ready) {
      ASSERT_NO_FATAL_FAILURE(take_contribution());
    }
    if (out.put_valid && (inputs.put_ready >> to_underlying(out.put_kind) & 1) != 0) {
      ASSERT_NO_FATAL_FAILURE(take_package_beat(out));
    }
    if (out.free_valid) {
      ASSERT_NO_FATAL_FAILURE(take_place(out));
    }
    model_->clock(inputs);
    bench_.clock();
    ++seen.cycles;
  }

  void take_beat(const Traverser::Inputs& inputs) {
    if (beat_in_ == 0) {
      place_in_ = inputs.ray_place;
      places_.pop_front();
    }
    if (++beat_in_ < kRayBeats) return;
    beat_in_ = 0;
    in_[place_in_] = begun_++;
    left_[place_in_] = false;
  }

  // ---- The memory: lines come in the order of the requests, beat by beat
  void serve(const TraverserTraffic& traffic, Traverser::Inputs& inputs) {
    if (on_way_.empty()) return;
    if (line_beat_ == 0 ? !one_of(traffic.line) : one_of(traffic.late_beat)) return;
    inputs.response_valid = true;
    inputs.response_beat = static_cast<uint8_t>(line_beat_);
    std::copy_n(on_way_.front().begin() + line_beat_ * kBeatWords, kBeatWords, inputs.response_data.begin());
    line_beat_ = (line_beat_ + 1) % 4;
    if (line_beat_ == 0) on_way_.pop_front();
  }
  void take_request(const TreeRequest& request) {
    const uint32_t line = request.address / 64;
    ASSERT_LT(line, last_line_) << "cycle " << seen.cycles;
    requests_since_fault_ += model_->outputs().fault.valid ? 1 : 0;
    const bool stack = line >= places_of_.stacks;
    if (request.write) {
      ASSERT_TRUE(stack && request.second && request.address % 32 == 0) << "cycle " << seen.cycles;
      ++seen.spills;
      TreeLine& stored = memory_[line];
      for (uint32_t i = 0; i < 8 && stack_memory_ != StackMemory::Loses; ++i)
        stored[request.address % 64 / 4 + i] = request.data[i / 4][i % 4];
      seen.spoilt += stack_memory_ == StackMemory::Keeps ? 0 : 1;
      if (stack_memory_ == StackMemory::Spoils && bench_.one_of(4))
        stored[request.address % 64 / 4 + bench_.random() % 8] ^= 1u << bench_.random() % 32;
      return;
    }
    ASSERT_TRUE(!request.second && request.address % 64 == 0) << "cycle " << seen.cycles;
    ASSERT_EQ(memory_.count(line), 1u) << "cycle " << seen.cycles << ": nothing lies there";
    on_way_.push_back(memory_[line]);
    ++(stack ? seen.stack_reads : seen.reads);
    seen.most_lines = std::max<uint64_t>(seen.most_lines, on_way_.size());
  }

  // ---- What becomes of rays, if that is known
  bool knows() const { return stack_memory_ == StackMemory::Keeps; }
  bool is_shadow(const Asked& asked) const { return raypool::is_shadow(asked.ray); }
  bool returns(const Asked& asked) const { return P::sizes().miss_records && raypool::returns(asked.ray); }
  bool drops(const Asked& asked) const { return !returns(asked) && is_shadow(asked) == asked.walk.hit.hit; }
  /// Its package has the words of a hit.
  bool shows_hit(const Asked& asked) const {
    if (!asked.walk.hit.hit || is_shadow(asked)) return false;
    return !returns(asked) || !returns_first(asked.ray);
  }
  bool contributes(const Asked& asked) const { return P::sizes().contributes && is_shadow(asked) && !drops(asked); }
  bool needs_room(const Asked& asked) const { return !drops(asked) && !contributes(asked); }
  /// Of the ray in this place that is what it must be, and has not left.
  template <typename Is>
  void leaves(uint32_t place, const Is& is) {
    ASSERT_TRUE(in_[place] && !left_[place]) << "cycle " << seen.cycles;
    ASSERT_TRUE(!knows() || is((*rays_)[*in_[place]])) << "cycle " << seen.cycles;
    left_[place] = true;
  }

  void take_contribution() {
    const FrameContribution& contribution = model_->outputs().contribution;
    // Each ray has a colour of its own.
    const uint32_t number = contribution.rgb[0];
    ASSERT_LT(number, begun_);
    const Asked& asked = (*rays_)[number];
    ASSERT_TRUE(!knows() || contributes(asked)) << "cycle " << seen.cycles;
    EXPECT_EQ(contribution.pixel, asked.ray[word::kPixel]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(contribution.rgb[i], asked.ray[word::kColor + i]);
    ASSERT_NO_FATAL_FAILURE(leaves(place_of(number), [](const Asked&) { return true; }));
    ++seen.contributions;
  }
  uint32_t place_of(size_t number) const {
    return static_cast<uint32_t>(std::find(in_.begin(), in_.end(), std::optional<size_t>(number)) - in_.begin());
  }

  void take_package_beat(const Traverser::Outputs& out) {
    if (beat_out_ == 0) record_.fill(0);
    for (uint32_t i = 0; i < kBeatWords; ++i) {
      const uint32_t place = beat_out_ * kBeatWords + i;
      if (place < record_.size()) record_[place] = out.put_data[i];
    }
    kind_out_ = out.put_kind;
    if (++beat_out_ < (P::kWords + 3) / 4) return;
    beat_out_ = 0;
    ASSERT_NO_FATAL_FAILURE(take_package());
  }
  // Which ray's it is: records may lack any word, so those of several rays may be alike.
  void take_package() {
    if (!knows()) return;
    for (uint32_t place = 0; place < P::kPool; ++place) {
      if (!in_[place] || left_[place]) continue;
      const Asked& asked = (*rays_)[*in_[place]];
      if (!needs_room(asked) || kind_of(asked) != kind_out_) continue;
      if (record_ != packed(package_of(asked), frame_.layout)) continue;
      left_[place] = true;
      if (returns(asked) && !shows_hit(asked)) ++seen.plain[asked.walk.hit.hit ? 1 : 0];
      ++(kind_out_ == ImportKind::Shadow ? seen.shadow : kind_out_ == ImportKind::Direct ? seen.direct : seen.normal);
      return;
    }
    FAIL() << "cycle " << seen.cycles << ": a package of no ray";
  }
  uint32_t material_of(const Asked& asked) const {
    const uint32_t at = asked.walk.hit.place * LeafReader::kTriangleWords + LeafReader::kTriangleWords - 1;
    return memory_.at(places_of_.triangles + at / 16)[at % 16];
  }
  ImportKind kind_of(const Asked& asked) const {
    if (is_shadow(asked)) return ImportKind::Shadow;
    if (!shows_hit(asked)) return ImportKind::Normal;
    const bool reflects = (asked.ray[word::kFlags] & kDepthMask) < frame_.depth && material_of(asked) >> 31 != 0;
    return P::sizes().culling && frame_.reflections && !reflects ? ImportKind::Direct : ImportKind::Normal;
  }
  Intersection package_of(const Asked& asked) const {
    Intersection package{};
    std::copy(asked.ray.begin(), asked.ray.end(), package.begin());
    if (returns(asked)) set_met(package, asked.walk.hit.hit);
    if (!shows_hit(asked)) return package;
    const LaneHits::Hit& hit = asked.walk.hit;
    const RayFinish finish(asked.set_up, tree_->triangle(hit.place), hit.t, asked.scale);
    package[word::kDistance] = as_bits(finish.t);
    package[word::kBarycentric] = as_bits(finish.u);
    package[word::kBarycentric + 1] = as_bits(finish.v);
    for (int axis = 0; axis < 3; ++axis) package[word::kNormal + axis] = as_bits(finish.normal[axis]);
    package[word::kMaterial] = frame_.material_base + (material_of(asked) & 0x7ffffff) * 32;
    package[word::kTriangle] = hit.number;
    return package;
  }

  // What has left may have been this place's, and not that of another one with the same package.
  void exchange_with_alike(uint32_t place) {
    const auto package = [this](uint32_t of) {
      const Asked& asked = (*rays_)[*in_[of]];
      return std::make_pair(kind_of(asked), packed(package_of(asked), frame_.layout));
    };
    if (left_[place] || !needs_room((*rays_)[*in_[place]])) return;
    for (uint32_t other = 0; other < P::kPool; ++other) {
      if (!in_[other] || !left_[other] || !needs_room((*rays_)[*in_[other]])) continue;
      if (package(other) != package(place)) continue;
      left_[place] = true;
      left_[other] = false;
      ++seen.exchanged;
      return;
    }
  }
  void take_place(const Traverser::Outputs& out) {
    const uint32_t place = out.free_place;
    ASSERT_TRUE(in_[place]) << "cycle " << seen.cycles << ": a place is freed that is free";
    const Asked& asked = (*rays_)[*in_[place]];
    if (knows()) {
      exchange_with_alike(place);
      ASSERT_EQ(left_[place], !drops(asked)) << "cycle " << seen.cycles;
      ASSERT_TRUE(asked.walk.faults.empty()) << "cycle " << seen.cycles << ": a ray leaves that comes to a fault";
    }
    ASSERT_EQ(out.free_shadow, is_shadow(asked)) << "cycle " << seen.cycles;
    seen.dropped += drops(asked);
    in_[place].reset();
    places_.push_back(place);
    ++done_;
    ++seen.rays;
  }

  // ---- Both sides
  // What means nothing is noise.
  void drive(const Traverser::Inputs& inputs) {
    const auto noise = [this] { return static_cast<uint32_t>(bench_.random()); };
    u_.ray_valid_i = inputs.ray_valid;
    u_.ray_last_i = inputs.ray_valid ? inputs.ray_last : noise() & 1;
    u_.ray_place_i = inputs.ray_valid ? inputs.ray_place : noise() % P::kPool;
    for (uint32_t i = 0; i < kBeatWords; ++i) {
      u_.ray_data_i[i] = inputs.ray_valid ? inputs.ray_data[i] : noise();
      const uint32_t word = inputs.response_data[i];
      u_.response_data_i[i] = !inputs.response_valid            ? noise()
                              : turned_ != 0 && word == turned_ ? word ^ 1u << 22
                                                                : word;
    }
    u_.put_ready_i = static_cast<uint8_t>(inputs.put_ready >> 1 & (P::sizes().culling ? 7 : 3));
    u_.contribution_ready_i = inputs.contribution_ready;
    u_.request_ready_i = inputs.request_ready;
    u_.response_valid_i = inputs.response_valid;
    u_.response_beat_i = inputs.response_valid ? inputs.response_beat : noise() & 3;
  }

  void compare() {
    const Traverser::Outputs& out = model_->outputs();
    ASSERT_EQ(u_.ray_ready_o, out.ray_ready) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.free_valid_o, out.free_valid) << "cycle " << seen.cycles;
    if (out.free_valid) {
      ASSERT_EQ(u_.free_place_o, out.free_place) << "cycle " << seen.cycles;
      ASSERT_EQ(u_.free_shadow_o, out.free_shadow) << "cycle " << seen.cycles;
    }
    ASSERT_EQ(u_.put_valid_o, out.put_valid) << "cycle " << seen.cycles;
    if (out.put_valid) {
      ASSERT_EQ(u_.put_kind_o, to_underlying(out.put_kind)) << "cycle " << seen.cycles;
      for (uint32_t i = 0; i < kBeatWords; ++i)
        ASSERT_EQ(u_.put_data_o[i], out.put_data[i]) << "cycle " << seen.cycles << ", word " << i;
    }
    ASSERT_EQ(u_.contribution_valid_o, out.contribution_valid) << "cycle " << seen.cycles;
    if (out.contribution_valid) {
      ASSERT_EQ(u_.contribution_pixel_o, out.contribution.pixel) << "cycle " << seen.cycles;
      for (uint32_t i = 0; i < 3; ++i)
        ASSERT_EQ(u_.contribution_color_o[i], out.contribution.rgb[i]) << "cycle " << seen.cycles;
    }
    ASSERT_EQ(u_.fault_valid_o, out.fault.valid) << "cycle " << seen.cycles;
    if (out.fault.valid) {
      ASSERT_EQ(u_.fault_code_o, to_underlying(out.fault.code)) << "cycle " << seen.cycles;
      ASSERT_EQ(u_.fault_line_o, out.fault.line) << "cycle " << seen.cycles;
    }
    ASSERT_EQ(u_.request_valid_o, out.request_valid) << "cycle " << seen.cycles;
    if (!out.request_valid) return;
    ASSERT_EQ(u_.request_write_o, out.request.write) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.request_second_o, out.request.second) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.request_address_o, out.request.address) << "cycle " << seen.cycles;
    for (uint32_t i = 0; out.request.write && i < 8; ++i)
      ASSERT_EQ(u_.request_data_o[i], out.request.data[i / 4][i % 4]) << "cycle " << seen.cycles;
  }

  Clocked<typename P::Verilated> bench_;
  typename P::Verilated& u_ = *bench_.u;
  std::unique_ptr<Traverser> model_;
  const LaneTree* tree_ = nullptr;
  const std::vector<Asked>* rays_ = nullptr;
  RayExit::Frame frame_;
  TreePort::Places places_of_;

  size_t begun_ = 0, done_ = 0;
  std::deque<uint32_t> places_;            // that are free
  std::vector<std::optional<size_t>> in_;  // [place] number of the ray
  std::vector<bool> left_;                 // [place] it has become what it must
  uint32_t beat_in_ = 0, place_in_ = 0, beat_out_ = 0;
  Intersection record_{};
  ImportKind kind_out_ = ImportKind::None;

  std::map<uint32_t, TreeLine> memory_;
  StackMemory stack_memory_ = StackMemory::Keeps;
  uint32_t turned_ = 0;
  uint64_t requests_since_fault_ = 0;
  uint32_t last_line_ = 0;
  uint32_t more_lines_ = 0;  // that triangles are declared to take, though they take fewer
  uint32_t traces_ = 0;
  std::deque<TreeLine> on_way_;
  uint32_t line_beat_ = 0;
};

}  // namespace raypool::bench
