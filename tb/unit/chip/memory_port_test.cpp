// The memory port in Verilog against its class, all outputs in every cycle: device and traverser ask when they like,
// the memory takes requests and answers when it likes. And against what the port predicts for a memory with a fixed
// latency, in the few lines that need no more than the time at which requests come.
#include "machine/chip/memory_port.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>

#include "Vmemory_port_1_1_1_6.h"
#include "Vmemory_port_2_5_3_40_2.h"
#include "Vmemory_port_2_64_2_1000.h"
#include "Vmemory_port_3_2_3_12.h"
#include "Vmemory_port_4_4_1_120_1.h"
#include "Vmemory_port_5_3_64_195.h"
#include "Vmemory_port_64_3_2_120_5.h"
#include "Vmemory_port_8_32_2_120.h"
#include "Vmemory_port_8_8_1_50.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

constexpr uint32_t kUnits = 4;

/// Its numbers are those of the Verilog: QUEUE, TRAVERSER_QUEUE, CYCLES_PER_BEAT, LATENCY, LINES; without LINES they
/// are enough for the latency.
template <typename Unit_, uint32_t kQueue, uint32_t kTraverserQueue, uint32_t kCyclesPerBeat, uint32_t kLatency_,
          uint32_t kLines = 0>
struct Port {
  using Unit = Unit_;
  static constexpr uint32_t kBeat = kCyclesPerBeat, kLine = 4 * kCyclesPerBeat, kLatency = kLatency_;
  static constexpr bool kEnoughLines = kLines == 0;
  static ChipConfiguration chip() {
    ChipConfiguration chip;
    chip.memory_queue = kQueue;
    chip.memory_cycles_per_beat = kCyclesPerBeat;
    chip.memory_latency = kLatency;
    chip.hardware_traverser_node_cache_mshrs = kTraverserQueue;  // all of the traverser's
    chip.hardware_traverser_triangle_cache_mshrs = 0;
    return chip;
  }
  static MemoryPort::Limits limits() {
    return kEnoughLines ? MemoryPort::Limits::of(chip()) : MemoryPort::Limits{kLines, kTraverserQueue};
  }
};

/// What a run has shown: that it was there.
struct Seen {
  uint64_t device_refused = 0, traverser_refused = 0, both_came = 0, offer_stayed = 0, lines_out = 0, beat_refused = 0;
  uint64_t seconds = 0, writes = 0, late_beats = 0, traverser_first = 0, quiet_again = 0;
};

/// When requests are served, and beats handed on, with a memory that takes a request at once and has a line's last beat
/// so much later.
class FixedLatency {
 public:
  explicit FixedLatency(const ChipConfiguration& chip)
      : beat_(chip.memory_cycles_per_beat), latency_(chip.memory_latency) {}

  void request(uint64_t cycle, bool write) {
    const uint64_t start = std::max(free_from_, cycle);
    starts.push_back(start);
    free_from_ = start + (write ? 1 : 4) * beat_;
    if (write) return;
    last_beat_ = std::max(start + latency_, std::max(last_beat_, start) + 4 * beat_);
    for (uint64_t i = 0; i < 4; ++i) beats.push_back(last_beat_ - (3 - i) * beat_);
  }

  std::deque<uint64_t> starts, beats;

 private:
  uint64_t beat_, latency_, free_from_ = 0, last_beat_ = 0;
};

/// One in so many cycles: the device asks, the traverser asks, the memory does not take what it is offered; of requests
/// one in so many is a write (0: never). The memory gives its beats as long after one another as it likes, up to `lag`
/// cycles, the first of a line up to `latency` later; 0: as one of fixed latency.
struct Traffic {
  uint32_t device = 1, traverser = 1, stall = 0, write = 3, lag = 0, latency = 0;
};

template <typename P>
class Bench {
 public:
  explicit Bench(uint32_t seed, bool fixed) : bench_(seed), fixed_(fixed), port_(P::chip(), P::limits()) {}

  void clock(const Traffic& traffic) {
    offer(traffic);
    u_.memory_request_ready_i = traffic.stall == 0 || !bench_.one_of(traffic.stall);
    const bool beat = !answers_.empty() && answers_.front().from <= cycle_;
    u_.memory_beat_valid_i = beat;
    if (beat) put(u_.memory_beat_data_i, answers_.front().data);
    u_.eval();
    ASSERT_NO_FATAL_FAILURE(check_readies()) << "cycle " << cycle_;
    ASSERT_NO_FATAL_FAILURE(check_offer()) << "cycle " << cycle_;
    ASSERT_NO_FATAL_FAILURE(check_responses()) << "cycle " << cycle_;
    const bool device_takes = port_.response_due() == cycle_;
    const bool traverser_takes = port_.traverser_response_due() == cycle_;
    const bool beat_ready = port_.beat_ready();
    if (port_.offers()) take_offer(traffic);
    take_requests();
    seen.lines_out += port_.waits() && !port_.offers() && port_.start() == kNever;
    if (port_.start() <= cycle_) port_.serve(cycle_);
    if (device_takes) port_.response();
    if (traverser_takes) port_.traverser_response();
    seen.beat_refused += beat && !beat_ready;
    if (beat && beat_ready) {
      seen.late_beats += port_.beat(cycle_, answers_.front().data) > cycle_ + 1;
      answers_.pop_front();
    }
    bench_.clock();
    for (uint32_t unit = 0; unit < kUnits; ++unit) {
      seen.quiet_again += !quiet_[unit] && port_.quiet(cycle_, unit);
      quiet_[unit] = port_.quiet(cycle_, unit);
    }
    ++cycle_;
  }
  /// Nothing more comes, and everything leaves.
  void drain() {
    const Traffic nothing{0, 0, 0, 3, 0, 0};
    for (uint32_t i = 0; i < 100000 && (device_waits_ || traverser_waits_ || !empty()); ++i)
      ASSERT_NO_FATAL_FAILURE(clock(nothing));
    ASSERT_TRUE(empty());
    for (uint32_t i = 0; i < 2 + P::kLine; ++i) ASSERT_NO_FATAL_FAILURE(clock(nothing));
    EXPECT_EQ(u_.quiet_o, 15);
    EXPECT_EQ(u_.reads_o, reads_);
    EXPECT_EQ(u_.writes_o, writes_);
    EXPECT_EQ(u_.busy_cycles_o, busy_cycles_);
    EXPECT_EQ(port_.reads(), reads_);
    EXPECT_EQ(port_.writes(), writes_);
    EXPECT_EQ(port_.busy_cycles(), busy_cycles_);
  }
  uint64_t lines() const { return lines_; }

  Seen seen;

 private:
  struct Answer {
    uint64_t from;  // cycle in which the memory has it
    Beat data;
  };
  struct Expected {
    uint8_t id, beat;
    Beat data;
  };

  static void put(WData* to, const Beat& data) {
    for (uint32_t i = 0; i < 4; ++i) to[i] = data[i];
  }
  static Beat beat_of(const WData* from) { return {from[0], from[1], from[2], from[3]}; }
  Beat random_beat() {
    Beat beat;
    for (uint32_t& word : beat) word = static_cast<uint32_t>(bench_.random());
    return beat;
  }
  bool empty() const { return accesses_.empty() && device_expects_.empty() && traverser_expects_.empty(); }

  void offer(const Traffic& traffic) {
    const auto writes = [&] { return traffic.write != 0 && bench_.one_of(traffic.write); };
    if (!device_waits_ && traffic.device != 0 && bench_.one_of(traffic.device)) {
      device_waits_ = true;
      const bool write = writes();
      const uint32_t address = static_cast<uint32_t>(bench_.random()) & (write ? ~15u : ~63u);
      device_ = {write, address, random_beat(), static_cast<uint8_t>(bench_.random() % 16),
                 static_cast<uint8_t>(bench_.random() % 128)};
    }
    if (!traverser_waits_ && traffic.traverser != 0 && bench_.one_of(traffic.traverser)) {
      traverser_waits_ = true;
      const bool write = writes(), second = bench_.one_of(3);
      const uint32_t bytes = (write ? 16u : 64u) << second;
      traverser_ = {
          write, second, static_cast<uint32_t>(bench_.random()) & ~(bytes - 1), {random_beat(), random_beat()}};
    }
    u_.device_request_valid_i = device_waits_;
    u_.device_request_write_i = device_.write;
    u_.device_request_address_i = device_.address;
    put(u_.device_request_data_i, device_.data);
    u_.device_request_mask_i = device_.mask;
    u_.device_request_id_i = device_.id;
    u_.traverser_request_valid_i = traverser_waits_;
    u_.traverser_request_write_i = traverser_.write;
    u_.traverser_request_second_i = traverser_.second;
    u_.traverser_request_address_i = traverser_.address;
    put(u_.traverser_request_data_i, traverser_.data[0]);
    put(u_.traverser_request_data_i + 4, traverser_.data[1]);
  }
  void check_readies() {
    ASSERT_EQ(u_.device_request_ready_o, port_.room_from() <= cycle_);
    ASSERT_EQ(u_.traverser_request_ready_o, port_.traverser_room());
    ASSERT_EQ(u_.memory_beat_ready_o, port_.beat_ready());
    for (uint32_t unit = 0; unit < kUnits; ++unit) ASSERT_EQ(u_.quiet_o >> unit & 1, quiet_[unit]) << unit;
    ASSERT_EQ(u_.idle_o, port_.idle());
  }
  void check_offer() {
    ASSERT_EQ(u_.memory_request_valid_o, port_.offers());
    if (!port_.offers()) return;
    const MemoryPort::Access& access = port_.access();
    ASSERT_EQ(u_.memory_request_traverser_o, access.traverser);
    ASSERT_EQ(u_.memory_request_write_o, access.request.write);
    ASSERT_EQ(u_.memory_request_address_o, access.request.address);
    if (access.request.write) {
      ASSERT_EQ(beat_of(u_.memory_request_data_o), access.request.data);
      ASSERT_EQ(u_.memory_request_mask_o, access.request.mask);
    }
  }
  void check_responses() {
    ASSERT_EQ(u_.device_response_valid_o, port_.response_due() == cycle_);
    ASSERT_EQ(u_.traverser_response_valid_o, port_.traverser_response_due() == cycle_);
    if (u_.device_response_valid_o) {
      const Expected& expected = device_expects_.front();
      ASSERT_EQ(u_.device_response_id_o, expected.id) << "not in the order of the requests";
      ASSERT_EQ(u_.device_response_beat_o, expected.beat);
      ASSERT_EQ(beat_of(u_.device_response_data_o), expected.data);
      device_expects_.pop_front();
    }
    if (u_.traverser_response_valid_o) {
      const Expected& expected = traverser_expects_.front();
      ASSERT_EQ(u_.traverser_response_beat_o, expected.beat);
      ASSERT_EQ(beat_of(u_.traverser_response_data_o), expected.data);
      traverser_expects_.pop_front();
    }
    if (!u_.device_response_valid_o && !u_.traverser_response_valid_o) return;
    if (handed_on_ != 0) {
      ASSERT_GE(cycle_, handed_on_ + P::kBeat);
    }
    handed_on_ = cycle_;
    if (!fixed_) return;
    ASSERT_EQ(cycle_, latency_.beats.front());
    latency_.beats.pop_front();
  }
  // The memory takes what it is offered, which is the oldest that has been asked for.
  void take_offer(const Traffic& traffic) {
    if (fixed_ && !stays_) {
      ASSERT_EQ(cycle_ - 1, latency_.starts.front());
      latency_.starts.pop_front();
    }
    stays_ = !u_.memory_request_ready_i;
    seen.offer_stayed += stays_;
    if (stays_) return;
    const MemoryPort::Access expected = accesses_.front();
    accesses_.pop_front();
    ASSERT_EQ(u_.memory_request_traverser_o, expected.traverser) << "out of order";
    ASSERT_EQ(u_.memory_request_write_o, expected.request.write);
    ASSERT_EQ(u_.memory_request_address_o, expected.request.address);
    if (expected.request.write) {
      ASSERT_EQ(beat_of(u_.memory_request_data_o), expected.request.data);
      ASSERT_EQ(u_.memory_request_mask_o, expected.request.mask);
    } else {
      answer(expected, traffic);
    }
    port_.taken(cycle_);
  }
  // Served in the cycle before, so the last beat is there `latency` cycles after that, one cycle after the memory's.
  void answer(const MemoryPort::Access& access, const Traffic& traffic) {
    uint64_t from = cycle_ + 1;
    if (fixed_) {
      from = cycle_ + P::kLatency - 2 - 3 * P::kBeat;
    } else if (traffic.latency != 0) {
      from += bench_.random() % traffic.latency;
    }
    for (uint8_t i = 0; i < 4; ++i) {
      answers_.push_back({from, random_beat()});
      (access.traverser ? traverser_expects_ : device_expects_).push_back({access.request.id, i, answers_.back().data});
      from += fixed_ ? P::kBeat : traffic.lag == 0 ? 0 : bench_.random() % traffic.lag;
    }
  }
  void take_requests() {
    const bool device = device_waits_ && port_.room_from() <= cycle_;
    const bool traverser = traverser_waits_ && port_.traverser_room();
    seen.device_refused += device_waits_ && !device;
    seen.traverser_refused += traverser_waits_ && !traverser;
    seen.both_came += device && traverser;
    if (device) {
      seen.traverser_first += !accesses_.empty() && accesses_.back().traverser;
      port_.request(cycle_, device_);
      expect({false, device_});
      ++(device_.write ? writes_ : reads_);
      device_waits_ = false;
    }
    if (!traverser) return;
    port_.request(cycle_, traverser_);
    MemoryRequest part{traverser_.write, traverser_.address, traverser_.data[0], 15, 0};
    expect({true, part});
    traverser_waits_ = false;
    if (!traverser_.second) return;
    ++seen.seconds;
    part.address += part.write ? 16 : 64;
    part.data = traverser_.data[1];
    expect({true, part});
  }
  void expect(const MemoryPort::Access& access) {
    accesses_.push_back(access);
    busy_cycles_ += access.request.write ? P::kBeat : P::kLine;
    lines_ += !access.request.write;
    seen.writes += access.request.write;
    if (fixed_) latency_.request(cycle_, access.request.write);
  }

  Clocked<typename P::Unit> bench_;
  typename P::Unit& u_ = *bench_.u;
  bool fixed_;
  MemoryPort port_;
  FixedLatency latency_{P::chip()};
  uint64_t cycle_ = 1, handed_on_ = 0;
  bool device_waits_ = false, traverser_waits_ = false;
  MemoryRequest device_;
  TreeRequest traverser_;
  bool stays_ = false;                       // the memory has not taken what it is offered
  std::deque<MemoryPort::Access> accesses_;  // in the order of their requests
  std::deque<Answer> answers_;               // of the memory
  std::deque<Expected> device_expects_, traverser_expects_;
  bool quiet_[kUnits] = {true, true, true, true};  // at the end of the cycle before
  uint64_t reads_ = 0, writes_ = 0, lines_ = 0, busy_cycles_ = 0;
};

template <typename P>
class MemoryPortOfFixedLatency : public testing::Test {};
using LongEnough =
    testing::Types<Port<Vmemory_port_8_32_2_120, 8, 32, 2, 120>, Port<Vmemory_port_1_1_1_6, 1, 1, 1, 6>,
                   Port<Vmemory_port_3_2_3_12, 3, 2, 3, 12>, Port<Vmemory_port_5_3_64_195, 5, 3, 64, 195>,
                   Port<Vmemory_port_2_64_2_1000, 2, 64, 2, 1000>, Port<Vmemory_port_8_8_1_50, 8, 8, 1, 50>>;
TYPED_TEST_SUITE(MemoryPortOfFixedLatency, LongEnough);

template <typename P>
class MemoryPortInVerilog : public testing::Test {};
using Ports =
    testing::Types<Port<Vmemory_port_8_32_2_120, 8, 32, 2, 120>, Port<Vmemory_port_1_1_1_6, 1, 1, 1, 6>,
                   Port<Vmemory_port_3_2_3_12, 3, 2, 3, 12>, Port<Vmemory_port_5_3_64_195, 5, 3, 64, 195>,
                   Port<Vmemory_port_2_64_2_1000, 2, 64, 2, 1000>, Port<Vmemory_port_8_8_1_50, 8, 8, 1, 50>,
                   Port<Vmemory_port_4_4_1_120_1, 4, 4, 1, 120, 1>, Port<Vmemory_port_2_5_3_40_2, 2, 5, 3, 40, 2>,
                   Port<Vmemory_port_64_3_2_120_5, 64, 3, 2, 120, 5>>;
TYPED_TEST_SUITE(MemoryPortInVerilog, Ports);

void add(Seen& to, const Seen& seen) {
  to.device_refused += seen.device_refused;
  to.traverser_refused += seen.traverser_refused;
  to.both_came += seen.both_came;
  to.offer_stayed += seen.offer_stayed;
  to.lines_out += seen.lines_out;
  to.beat_refused += seen.beat_refused;
  to.seconds += seen.seconds;
  to.writes += seen.writes;
  to.late_beats += seen.late_beats;
  to.traverser_first += seen.traverser_first;
  to.quiet_again += seen.quiet_again;
}

/// With a memory that answers after a fixed time it is what docs/machine/memory-port.md describes, to the cycle.
TYPED_TEST(MemoryPortOfFixedLatency, HasTheCyclesOfTheChip) {
  using P = TypeParam;
  constexpr uint32_t kCycles = std::max(3000u, 60 * P::kLine);
  Seen seen;
  uint64_t lines = 0;
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<P> bench(seed, true);
    for (const Traffic& traffic :
         {Traffic{1, 0, 0, 0, 0, 0}, Traffic{1, 1, 0, 3, 0, 0}, Traffic{0, 1, 0, 3, 0, 0}, Traffic{1, 0, 0, 1, 0, 0},
          Traffic{P::kLine, 2 * P::kLine, 0, 3, 0, 0}, Traffic{2 * P::kLine, 0, 0, 0, 0, 0},
          Traffic{20 * P::kLine, 9 * P::kLine, 0, 2, 0, 0}, Traffic{2, 3, 0, 8, 0, 0}}) {
      for (uint32_t i = 0; i < kCycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
    }
    ASSERT_NO_FATAL_FAILURE(bench.drain());
    add(seen, bench.seen);
    lines += bench.lines();
  }
  EXPECT_GT(lines, 3 * 4 * kCycles / P::kLine);
  EXPECT_GT(seen.device_refused, 100u);
  EXPECT_GT(seen.traverser_refused, 100u);
  EXPECT_GT(seen.both_came, 5u);
  EXPECT_GT(seen.traverser_first, 50u);
  EXPECT_GT(seen.seconds, 50u);
  EXPECT_GT(seen.writes, 100u);
  EXPECT_GT(seen.quiet_again, 20u);
  EXPECT_EQ(seen.beat_refused, 0u) << "such a memory need not wait";
  EXPECT_EQ(seen.late_beats > 0, P::kLatency < P::kLine) << "the port itself is slower than the memory";
}

TYPED_TEST(MemoryPortInVerilog, AgreesWithItsClassInEveryCycle) {
  using P = TypeParam;
  constexpr uint32_t kCycles = std::max(3000u, 60 * P::kLine), kLong = 2 * P::kLatency;
  Seen seen;
  uint64_t lines = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<P> bench(seed, false);
    for (const Traffic& traffic : {Traffic{1, 1, 0, 3, 0, 0}, Traffic{1, 1, 2, 3, 3, 9}, Traffic{1, 1, 0, 9, 1, kLong},
                                   Traffic{1, 0, 3, 2, 3 * P::kBeat, 0}, Traffic{0, 1, 3, 2, P::kBeat, 5},
                                   Traffic{P::kLine, P::kLine, 2, 3, 2 * P::kBeat, kLong}, Traffic{1, 1, 1, 3, 0, 0},
                                   Traffic{9 * P::kLine, 9 * P::kLine, 4, 2, 5, P::kLine}, Traffic{2, 2, 9, 1, 0, 0}}) {
      for (uint32_t i = 0; i < kCycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
    }
    ASSERT_NO_FATAL_FAILURE(bench.drain());
    add(seen, bench.seen);
    lines += bench.lines();
  }
  EXPECT_GT(lines, kCycles / P::kLine);
  EXPECT_GT(seen.device_refused, 100u);
  EXPECT_GT(seen.traverser_refused, 100u);
  EXPECT_GT(seen.both_came, 5u);
  EXPECT_GT(seen.traverser_first, 50u);
  EXPECT_GT(seen.offer_stayed, kCycles);
  EXPECT_GT(seen.lines_out, 10u);
  EXPECT_GT(seen.seconds, 50u);
  EXPECT_GT(seen.writes, 100u);
  EXPECT_GT(seen.quiet_again, 50u);
  // Beats that come one a cycle wait, and find the two places full, where they leave more slowly.
  EXPECT_EQ(seen.late_beats > 50, P::kBeat > 1);
  EXPECT_EQ(seen.beat_refused > 50, P::kBeat > 1);
}

}  // namespace
}  // namespace raypool::bench
