// The instruction cache, in several sizes: a small core of warps looks up, waits for refills as in the contract, and
// compares. In every cycle its answers, its requests and its refills are those of its class, too.
#include "machine/compute/instruction_cache.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "Vinstruction_cache_1w.h"
#include "Vinstruction_cache_32w.h"
#include "Vinstruction_cache_8w.h"
#include "bits.hpp"
#include "unit/common/line_memory.hpp"

namespace raypool::bench {
namespace {

struct Model1w {
  using Unit = Vinstruction_cache_1w;
  static constexpr uint32_t kWarps = 1, kBytes = 512;
};
struct Model8w {
  using Unit = Vinstruction_cache_8w;
  static constexpr uint32_t kWarps = 8, kBytes = 4096;
};
struct Model32w {
  using Unit = Vinstruction_cache_32w;
  static constexpr uint32_t kWarps = 32, kBytes = 512;
};

struct Answer {
  bool valid = false, hit = false, miss = false, refill_done = false;
  uint32_t warp = 0;
  uint64_t instruction = 0;
};

template <typename Model>
class Bench {
 public:
  static constexpr uint32_t kWayLines = Model::kBytes / 128;  ///< lines between those of one set
  static constexpr uint32_t kUpper = 4 * kWayLines * 8;       ///< programs of which no line has a bit from this on

  explicit Bench(uint32_t seed = 1)
      : memory(8 * Model::kBytes / 4, seed),
        random(seed),
        unit_(std::make_unique<typename Model::Unit>()),
        model_(configuration()) {
    unit_->rst_ni = 0;
    tick();
    tick();
    unit_->rst_ni = 1;
  }
  ~Bench() { unit_->final(); }

  LineMemory memory;
  std::mt19937 random;
  uint64_t cycle = 0;
  bool invalidate = false;
  std::optional<LineMemory::Beat> beat;  ///< the one of the last step

  uint32_t any_upper_bit() {
    std::vector<uint32_t> bits;
    for (uint32_t bit = kUpper; bit < 1u << 16; bit *= 2) bits.push_back(bit);
    return bits[random() % bits.size()];
  }
  uint64_t stored(uint32_t pc) { return uint64_t{memory.word(8 * pc + 4)} << 32 | memory.word(8 * pc); }

  /// One cycle, with a lookup in it; what the cache answers in this cycle to the lookup of the one before.
  Answer step(const std::optional<std::pair<uint32_t, uint32_t>>& warp_and_pc = std::nullopt) {
    auto& u = *unit_;
    Answer answer;
    answer.hit = u.hit_o;
    answer.miss = u.miss_o;
    answer.valid = answer.hit || answer.miss;
    answer.warp = u.result_warp_o;
    answer.instruction = u.instruction_o;
    answer.refill_done = u.refill_done_o;
    EXPECT_FALSE(answer.hit && answer.miss);
    EXPECT_EQ(answer.valid, looked_up_) << "each lookup gets one answer";
    compare(answer);
    EXPECT_EQ(u.first_o, refilled_ ? 1u << fetch_warp_ : 0u) << "the warp that began the fetch looks up first";
    refilled_ = answer.refill_done;
    if (refilled_) fetch_warp_ = next_fetch_warp_;
    fetching_ = fetching_ && !refilled_;
    if (answer.miss && !fetching_) {
      next_fetch_warp_ = answer.warp;
      fetching_ = true;
    }
    looked_up_ = warp_and_pc.has_value();
    u.lookup_valid_i = looked_up_;
    if (looked_up_) {
      u.lookup_warp_i = warp_and_pc->first;
      u.lookup_pc_i = warp_and_pc->second;
    }
    u.invalidate_i = invalidate;
    u.request_ready_i = memory.decide_ready();
    beat = memory.respond(cycle);
    u.response_valid_i = beat.has_value();
    if (beat) {
      u.response_beat_i = beat->beat;
      for (int i = 0; i < 4; ++i) u.response_data_i[i] = beat->data[i];
    }
    u.clk_i = 0;
    u.eval();
    if (u.request_valid_o && u.request_ready_i) {
      EXPECT_EQ(u.request_address_o % 64, 0u);
      EXPECT_EQ(memory.pending(), 0u) << "one fetch at a time";
      memory.read(u.request_address_o, 16, cycle);
    }
    EXPECT_TRUE(!held_ || u.request_valid_o) << "a request was withdrawn";
    held_ = u.request_valid_o && !u.request_ready_i;
    clock_model(warp_and_pc);
    invalidate = false;
    tick();
    return answer;
  }

  /// Looks up one instruction until it hits; number of misses.
  int fetch(uint32_t warp, uint32_t pc, uint64_t* instruction = nullptr) {
    for (int misses = 0;; ++misses) {
      step({{warp, pc}});
      Answer answer = step();
      if (answer.hit) {
        if (instruction) *instruction = answer.instruction;
        return misses;
      }
      for (int i = 0; i < 1000 && !step().refill_done; ++i) {
      }
      EXPECT_LT(misses, 10);
      if (misses >= 10) return misses;
    }
  }

 private:
  static Configuration configuration() {
    Configuration configuration;
    configuration.warps = Model::kWarps;
    configuration.instruction_cache_bytes = Model::kBytes;
    return configuration;
  }
  void compare(const Answer& answer) {
    if (!has_class_) return;
    EXPECT_EQ(answer.miss, looked_up_ && model_.missed()) << "cycle " << cycle;
    EXPECT_TRUE(!answer.valid || answer.warp == model_.result_warp()) << "cycle " << cycle;
    EXPECT_EQ(answer.refill_done, model_.refill_done()) << "cycle " << cycle;
    EXPECT_EQ(unit_->first_o, model_.first(cycle)) << "cycle " << cycle;
    EXPECT_EQ(unit_->request_valid_o, model_.request_valid()) << "cycle " << cycle;
    EXPECT_TRUE(!model_.request_valid() || unit_->request_address_o == model_.request_address()) << "cycle " << cycle;
  }
  void clock_model(const std::optional<std::pair<uint32_t, uint32_t>>& warp_and_pc) {
    model_.clock(cycle, model_.missed(), unit_->request_ready_i != 0, beat && beat->beat == 3);
    if (warp_and_pc) model_.lookup(warp_and_pc->first, warp_and_pc->second);
    model_.end_cycle();
    if (!invalidate) return;
    // The class knows no invalidation under way: the unit has none.
    has_class_ = has_class_ && !model_.busy();
    model_.invalidate();
  }
  void tick() {
    unit_->clk_i = 0;
    unit_->eval();
    unit_->clk_i = 1;
    unit_->eval();
    ++cycle;
  }
  std::unique_ptr<typename Model::Unit> unit_;
  InstructionCache model_;
  bool has_class_ = true;
  bool looked_up_ = false, held_ = false;
  bool fetching_ = false, refilled_ = false;
  uint32_t next_fetch_warp_ = 0, fetch_warp_ = 0;
};

template <typename Model>
class InstructionCacheTest : public ::testing::Test {};
using Models = ::testing::Types<Model1w, Model8w, Model32w>;
TYPED_TEST_SUITE(InstructionCacheTest, Models);

TYPED_TEST(InstructionCacheTest, ReplacesTheLeastRecentlyUsedLine) {
  Bench<TypeParam> bench(5);
  std::map<uint32_t, std::deque<uint32_t>> sets;
  for (int i = 0; i < 800; ++i) {
    const auto set = static_cast<uint32_t>(bench.random() % 4);
    const uint32_t line = set + static_cast<uint32_t>(bench.random() % 4) * bench.kWayLines;
    const uint32_t pc = line * 8 + static_cast<uint32_t>(bench.random() % 8);
    auto& lines = sets[set];
    const auto place = std::find(lines.begin(), lines.end(), line);
    const bool cached = place != lines.end();
    if (cached) lines.erase(place);
    lines.push_front(line);
    if (lines.size() > 2) lines.pop_back();
    uint64_t instruction = 0;
    ASSERT_EQ(bench.fetch(0, pc, &instruction), cached ? 0 : 1) << "lookup " << i;
    ASSERT_EQ(instruction, bench.stored(pc)) << "lookup " << i;
  }
}

// Two lines that differ in one upper bit, whichever it is, in both ways of their set and in either order.
TYPED_TEST(InstructionCacheTest, DistinguishesLinesByEveryBitOfTheirPc) {
  for (uint32_t bit = lowest(8 * Bench<TypeParam>::kWayLines); bit < 16; ++bit) {
    for (const uint32_t before : {0u, 1u}) {  // other lines of the set, so that the pair goes into either way
      Bench<TypeParam> bench;
      for (uint32_t i = 0; i < before; ++i) bench.fetch(0, 5 ^ 1u << (bit == 15 ? 14 : 15));
      for (const uint32_t pc : {5u, 5u | 1u << bit, 5u, 5u | 1u << bit}) {
        uint64_t instruction = 0;
        bench.fetch(0, pc, &instruction);
        ASSERT_EQ(instruction, bench.stored(pc)) << "bit " << bit << " of the PC, after " << before << " other lines";
      }
    }
  }
}

TYPED_TEST(InstructionCacheTest, OtherLinesHitDuringAFetch) {
  Bench<TypeParam> bench;
  for (uint32_t pc = 0; pc < 8; ++pc) bench.fetch(0, pc);
  bench.memory.behaviour.silent = true;
  bench.step({{0, 8}});
  EXPECT_TRUE(bench.step({{0, 0}}).miss);
  for (uint32_t pc = 1; pc < 8; ++pc) {
    const Answer answer = bench.step({{0, pc}});
    EXPECT_TRUE(answer.hit);
    EXPECT_EQ(answer.instruction, bench.stored(pc - 1));
  }
}

// Every time between a lookup and the beats of the same line: the answer is right, and the line is fetched once.
TYPED_TEST(InstructionCacheTest, LookupMeetsRefillBeatsOfItsLine) {
  for (int start = 0; start < 24; ++start) {
    Bench<TypeParam> bench;
    bench.memory.behaviour.latency = 8;
    bench.step({{0, 13}});
    bool missed = false;
    for (int i = 0; i < 60; ++i) {
      const bool look = i >= start;
      const Answer answer =
          bench.step(look ? std::make_optional(std::make_pair(0u, 8u + static_cast<uint32_t>(i) % 8)) : std::nullopt);
      const uint32_t answered = 8 + static_cast<uint32_t>(i + 7) % 8;  // the pc of the cycle before
      ASSERT_TRUE(!answer.hit || answer.instruction == bench.stored(answered)) << "start " << start << " cycle " << i;
      if (answer.refill_done) missed = false;
      if (answer.miss) missed = true;
    }
    EXPECT_FALSE(missed) << "a miss without a later refill_done, start " << start;
    EXPECT_EQ(bench.memory.reads(), 1u) << "start " << start;
  }
}

TYPED_TEST(InstructionCacheTest, InvalidateForgetsAlsoTheLineBeingFetched) {
  for (int when = 0; when < 30; ++when) {
    Bench<TypeParam> bench;
    bench.memory.behaviour.latency = 12;
    bench.fetch(0, 0);
    bench.step({{0, 8}});
    for (int i = 0; i < when; ++i) bench.step();
    bench.memory.word(64) = 0x5a5a5a5a;
    bench.memory.word(0) = 0xa5a5a5a5;
    bench.invalidate = true;
    bench.step();
    for (int i = 0; i < 40; ++i) bench.step();
    uint64_t instruction = 0;
    bench.fetch(0, 8, &instruction);
    EXPECT_EQ(instruction, bench.stored(8)) << "invalidated after " << when;
    bench.fetch(0, 0, &instruction);
    EXPECT_EQ(instruction, bench.stored(0)) << "invalidated after " << when;
  }
}

TYPED_TEST(InstructionCacheTest, RandomWarpsGetTheirInstructions) {
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Bench<TypeParam> bench(seed);
    bench.memory.behaviour.latency = seed % 3 ? 1 : 20;
    bench.memory.behaviour.jitter = seed % 4 == 0 ? 15 : 0;
    bench.memory.behaviour.ready_percent = seed % 2 ? 100 : 30;
    bench.memory.behaviour.beat_percent = seed % 5 ? 100 : 40;
    struct Warp {
      uint32_t pc = 0;
      bool waits = false;  // for refill_done
      bool looking = false;
      uint64_t since = 0;
    };
    std::vector<Warp> warps(TypeParam::kWarps);
    const uint32_t lines = seed % 2 ? 3 * bench.kWayLines : bench.kWayLines;
    uint32_t next = 0, hits = 0, looking_pc = 0;
    for (int i = 0; i < 6000; ++i) {
      std::optional<std::pair<uint32_t, uint32_t>> lookup;
      for (uint32_t k = 0; k < TypeParam::kWarps && !lookup && bench.random() % 8 != 0; ++k) {
        const uint32_t warp = (next + k) % TypeParam::kWarps;
        if (warps[warp].waits || warps[warp].looking) continue;
        lookup = {warp, warps[warp].pc};
        warps[warp].looking = true;
        next = warp + 1;
      }
      const Answer answer = bench.step(lookup);
      if (answer.refill_done)
        for (Warp& warp : warps) warp.waits = false;
      if (answer.valid) {
        Warp& warp = warps[answer.warp];
        warp.looking = false;
        warp.waits = answer.miss;
        if (answer.hit) {
          ++hits;
          ASSERT_EQ(warp.pc, looking_pc);
          ASSERT_EQ(answer.instruction, bench.stored(warp.pc)) << "pc " << warp.pc << " cycle " << bench.cycle;
          warp.since = bench.cycle;
          if (bench.random() % 4 != 0) {
            warp.pc = (warp.pc & ~(bench.kUpper - 1)) | (warp.pc + 1) % (lines * 8);
          } else {
            warp.pc = static_cast<uint32_t>(bench.random() % (lines * 8));
            if (bench.random() % 3 == 0) warp.pc |= bench.any_upper_bit();
          }
        }
      }
      if (lookup) looking_pc = lookup->second;
      for (const Warp& warp : warps) ASSERT_LT(bench.cycle - warp.since, 200u * TypeParam::kWarps + 2000u) << "hang";
    }
    EXPECT_GT(hits, 100u);
  }
}

}  // namespace
}  // namespace raypool::bench
