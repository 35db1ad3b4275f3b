// Drives a Verilated mem_alu and checks everything that is promised in every cycle: each result against the
// history of the stores, stores at the port against the store trace, reads against the rules of miss-status
// holding registers, stable payloads, bounded time; and all outputs but data against those of its class, so that a
// cycle too many is seen, too. MODEL is a struct with the Verilated class as Unit and the parameters kWarps, kLanes,
// kBytes, kMshrs, kSharing.
#pragma once

#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "bits.hpp"
#include "isa/encoding.hpp"
#include "machine/compute/mem_alu.hpp"
#include "unit/common/line_memory.hpp"

namespace raypool::bench {

template <typename T>
void put(T& port, int index, uint32_t value) {
  if constexpr (std::is_integral_v<T>) {
    const uint64_t all = (uint64_t{port} & ~(uint64_t{0xffffffffu} << (32 * index))) | uint64_t{value} << (32 * index);
    port = static_cast<T>(all);
  } else {
    port[index] = value;
  }
}
template <typename T>
uint32_t get(const T& port, int index) {
  if constexpr (std::is_integral_v<T>) {
    return static_cast<uint32_t>(uint64_t{port} >> (32 * index));
  } else {
    return port[index];
  }
}

struct MemTask {
  uint32_t warp = 0;
  bool store = false;
  bool inval = false;  ///< and no store
  uint32_t mask = 0;
  uint32_t immediate = 0;
  std::vector<uint32_t> address;  ///< a lane; what ra + immediate makes
  std::vector<uint32_t> data;     ///< a lane
};

template <typename Model>
class MemAluBench {
 public:
  static constexpr int kLanes = Model::kLanes;
  static constexpr int kWarps = Model::kWarps;
  static constexpr uint32_t kLaneMask = static_cast<uint32_t>((uint64_t{1} << kLanes) - 1);
  static constexpr uint32_t kWayBytes = Model::kBytes / 2;

  static constexpr uint64_t kPatience = 20000;

  struct Quad {
    std::array<uint32_t, 4> data{};
    uint32_t mask = 0;
  };
  struct Flight {
    MemTask task;
    uint64_t start = 0;
    std::map<uint32_t, Quad> stores;  ///< quadwords not seen yet
  };
  struct Result {
    uint64_t cycles = 0;  ///< from arrival to done
    std::vector<uint32_t> data = std::vector<uint32_t>(kLanes);
  };

  explicit MemAluBench(uint32_t seed = 1, uint32_t bytes = Model::kBytes * 8)
      : memory(bytes / 4, seed),
        random(seed),
        unit_(std::make_unique<typename Model::Unit>()),
        model_(std::make_unique<MemAlu>(configuration())) {
    set_limit(~uint32_t{0});
    unit_->rst_ni = 0;
    clock();
    clock();
    unit_->rst_ni = 1;
    clock();
  }
  ~MemAluBench() { unit_->final(); }

  LineMemory memory;
  std::mt19937 random;
  uint64_t cycle = 0;
  uint64_t hits = 0, misses = 0, stores = 0, faults = 0, longest = 0, writes_at_port = 0;
  uint64_t expected_loads = 0, expected_stores = 0;
  uint32_t fault_code = 0, fault_warp = 0;
  bool invalidate = false;
  std::vector<std::optional<Flight>> flights = std::vector<std::optional<Flight>>(kWarps);
  std::vector<Result> results = std::vector<Result>(kWarps);

  bool ready() const { return ready_; }  ///< a task given to step() now is taken
  bool idle() const { return unit_->idle_o; }
  bool busy() const {
    for (const auto& flight : flights)
      if (flight) return true;
    return false;
  }
  void set_limit(uint32_t bytes) { unit_->memory_limit_i = bytes; }
  /// Of an address: a bit that none of the words in use has.
  uint32_t any_upper_bit() {
    const uint32_t lowest_bit = lowest(memory.bytes());
    return 1u << (lowest_bit + random() % (32 - lowest_bit));
  }
  /// How often a register was freed in the cycle in which the privileged loser was chosen; and how often both ways of a
  /// set that the loser reads from were promised to other registers then, so that its try was wasted.
  uint64_t freed_while_chosen = 0, freed_wasted = 0;
  /// The memory as changed from outside, which is legal before an invalidate.
  void poke(uint32_t address, uint32_t value) {
    memory.word(address) = value;
    history_of(address).assign(1, {cycle, value});
  }

  static std::map<uint32_t, Quad> quads_of(const MemTask& task) {
    std::map<uint32_t, Quad> quads;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!(task.mask >> lane & 1)) continue;
      Quad& quad = quads[task.address[lane] & ~15u];
      const uint32_t word = task.address[lane] / 4 % 4;
      quad.mask |= 1u << word;
      quad.data[word] = task.data[lane];
    }
    return quads;
  }

  /// The task is at the inputs in this cycle, and expected from then on.
  void begin(const MemTask& task) {
    ASSERT_TRUE(ready_) << "bench: task without ready";
    auto& u = *unit_;
    u.task_warp_i = task.warp;
    u.task_operation_i = static_cast<uint8_t>(instruction(opcode_of(task)).operation());
    u.task_mask_i = task.mask;
    u.task_immediate_i = task.immediate;
    for (int lane = 0; lane < kLanes; ++lane) {
      put(u.task_operand_a_i, lane, task.address[lane] - task.immediate);
      put(u.task_operand_b_i, lane, task.data[lane]);
    }
    ASSERT_FALSE(flights[task.warp]) << "bench: warp has a task";
    if (!busy()) last_done_ = cycle;
    begin_in_class(task);
    Flight& flight = flights[task.warp].emplace();
    flight.task = task;
    flight.start = cycle;
    auto quads = quads_of(task);
    if (task.inval) return;
    (task.store ? expected_stores : expected_loads) += quads.size();
    if (task.store) flight.stores = std::move(quads);
  }

  /// One cycle; the task arrives in it. Throws in the cycle after a fatal failure, so that
  /// no test goes on with a broken unit.
  void step(const MemTask* task = nullptr) {
    if (::testing::Test::HasFatalFailure()) throw std::runtime_error("the bench stops at its first fatal failure");
    ASSERT_LT(cycle - last_done_, kPatience) << "hang: no task has been done for a long time";
    auto& u = *unit_;
    const uint64_t before = outputs();
    u.task_valid_i = task != nullptr;
    if (task) {
      ASSERT_NO_FATAL_FAILURE(begin(*task));
    }
    u.request_ready_i = memory.decide_ready();
    const auto beat = memory.respond(cycle);
    u.response_valid_i = beat.has_value();
    if (beat) {
      u.response_id_i = beat->id;
      u.response_beat_i = beat->beat;
      for (int i = 0; i < 4; ++i) put(u.response_data_i, i, beat->data[i]);
    }
    u.invalidate_i = invalidate;
    u.clk_i = 0;
    u.eval();
    ASSERT_EQ(before, outputs()) << "an output depends on an input of the same cycle, cycle " << cycle;
    ready_ = u.ready_o;
    ASSERT_NO_FATAL_FAILURE(compare_with_class());
    check_store_trace();
    check_done();
    check_request();
    hits += u.hit_o;
    misses += u.miss_o;
    stores += u.store_o;
    if (u.fault_valid_o) {
      ++faults;
      fault_code = u.fault_code_o;
      fault_warp = u.fault_warp_o;
      flights[fault_warp].reset();
    }
    ASSERT_FALSE(busy() && u.idle_o && !task) << "idle_o with a task under way, cycle " << cycle;
    count_collisions();
    events_ = model_->clock({task ? static_cast<int>(task->warp) : -1, beat.has_value(), beat ? beat->id : 0,
                             beat ? beat->beat : 0, u.request_ready_i != 0});
    if (invalidate) model_->invalidate();
    invalidate = false;
    u.clk_i = 1;
    u.eval();
    ++cycle;
  }

  void clock() {
    unit_->clk_i = 0;
    unit_->eval();
    ready_ = unit_->ready_o;
    unit_->clk_i = 1;
    unit_->eval();
    ++cycle;
  }

  /// Until all tasks are done and no request waits.
  void drain() {
    while (busy() || !idle()) step();
    ASSERT_TRUE(port_writes_.empty()) << "a traced store did not leave";
  }

  /// Gives one task, waits for all, and returns its result.
  Result run(const MemTask& task) {
    give(task);
    drain();
    return results[task.warp];
  }
  void give(const MemTask& task) {
    for (int i = 0; !ready_ && i < 1000; ++i) step();
    step(&task);
  }

  /// A task with lane addresses base + lane * stride, all lanes active.
  MemTask strided(uint32_t warp, bool store, uint32_t base, uint32_t stride) {
    MemTask task;
    task.warp = warp;
    task.store = store;
    task.mask = kLaneMask;
    for (int lane = 0; lane < kLanes; ++lane) {
      task.address.push_back(base + static_cast<uint32_t>(lane) * stride);
      task.data.push_back(0x60000000u + next_value_++);
    }
    return task;
  }

  /// Any task. Addresses crowd in the first `lines` lines of `sets` neighbouring sets, so that warps meet there. With
  /// `upper` half of the tasks set one of the address bits above, some in each lane another one.
  MemTask any_task(uint32_t warp, uint32_t sets, uint32_t lines, int store_percent, bool upper = false) {
    const auto below = [&](uint32_t n) { return static_cast<uint32_t>(random() % n); };
    const auto crowded = [&] { return below(lines) * kWayBytes + below(sets * 16) * 4; };
    static constexpr uint32_t kStrides[] = {0, 4, 4, 8, 16, 20, 64, kWayBytes, kWayBytes + 64};
    MemTask task = strided(warp, static_cast<int>(below(100)) < store_percent, crowded(), kStrides[below(9)]);
    task.immediate = below(2) ? 0 : static_cast<uint32_t>(random());
    if (Model::kSharing && !task.store && below(4) == 0) task.inval = true;
    if (below(8) != 0) task.mask = static_cast<uint32_t>(random()) & kLaneMask;
    const bool scattered = below(3) == 0, above = upper && below(2) == 0;
    uint32_t bit = above ? any_upper_bit() : 0;
    for (auto& address : task.address) {
      if (scattered) address = crowded();
      if (scattered && above) bit = below(2) * any_upper_bit();
      address = address % memory.bytes() | bit;
    }
    return task;
  }

 private:
  struct Version {
    uint64_t since;
    uint32_t value;
  };

  static Configuration configuration() {
    Configuration configuration;
    configuration.warps = kWarps;
    configuration.lanes = kLanes;
    configuration.data_cache_bytes = Model::kBytes;
    configuration.data_cache_mshrs = Model::kMshrs;
    configuration.sharing = Model::kSharing;
    return configuration;
  }
  std::vector<Version>& history_of(uint32_t address) {
    auto& versions = history_[address / 4];
    if (versions.empty()) versions.push_back({0, memory.word(address)});
    return versions;
  }

  static Opcode opcode_of(const MemTask& task) {
    return task.inval ? Opcode::Inval : task.store ? Opcode::St : Opcode::Ld;
  }

  // As the functional core would have set the step.
  void begin_in_class(const MemTask& task) {
    DecodedInstruction decoded;
    decoded.opcode = opcode_of(task);
    step_ = {};
    step_.status = Step::Status::Executed;
    step_.warp = task.warp;
    step_.mask = task.mask;
    step_.instruction = &decoded;
    bool misaligned = false, outside = false;
    for (uint32_t lanes = task.mask; lanes != 0; lanes &= lanes - 1) {
      const uint32_t lane = lowest(lanes), address = task.address[lane];
      misaligned |= address % 4 != 0;
      outside |= address >= unit_->memory_limit_i;
      step_.addresses[lane] = address;
      if (task.store) step_.stores[step_.store_count++] = {lane, address, task.data[lane]};
    }
    if (misaligned || outside) {
      step_.status = Step::Status::Fault;
      step_.fault.code = misaligned ? FaultCode::Misaligned : FaultCode::AddressOutsideMemory;
      step_.store_count = 0;
    }
    model_->begin(step_);
  }

  void compare_with_class() {
    const auto& u = *unit_;
    const MemAlu& model = *model_;
    ASSERT_EQ(u.ready_o, model.ready()) << "cycle " << cycle;
    ASSERT_EQ(u.idle_o, model.idle()) << "cycle " << cycle;
    ASSERT_EQ(u.done_valid_o ? 1u << u.done_warp_o : 0u, model.done()) << "cycle " << cycle;
    ASSERT_EQ(u.fault_valid_o, model.fault() != FaultCode::None) << "cycle " << cycle;
    if (u.fault_valid_o) {
      ASSERT_EQ(u.fault_code_o, to_underlying(model.fault())) << "cycle " << cycle;
      ASSERT_EQ(u.fault_warp_o, model.fault_warp()) << "cycle " << cycle;
    }
    StoreEvent stored;
    ASSERT_EQ(u.store_trace_valid_o, model.storing(stored)) << "cycle " << cycle;
    ASSERT_EQ(u.store_o, u.store_trace_valid_o) << "cycle " << cycle;
    if (u.store_trace_valid_o) {
      ASSERT_EQ(u.store_trace_address_o, stored.address) << "cycle " << cycle;
      ASSERT_EQ(u.store_trace_warp_o, stored.warp) << "cycle " << cycle;
    }
    ASSERT_EQ(u.hit_o, events_.hit) << "cycle " << cycle;
    ASSERT_EQ(u.miss_o, events_.miss) << "cycle " << cycle;
    ASSERT_EQ(u.request_valid_o, model.request_valid()) << "cycle " << cycle;
    if (!u.request_valid_o) return;
    ASSERT_EQ(u.request_write_o, model.request().write) << "cycle " << cycle;
    ASSERT_EQ(u.request_address_o, model.request().address) << "cycle " << cycle;
    if (!u.request_write_o) {
      ASSERT_EQ(u.request_id_o, model.request().id) << "cycle " << cycle;
    }
  }

  void count_collisions() {
    const MissStatus& status = model_->cache().miss_status();
    const MissStatus::Registers& miss = status.registers();
    const MemorySequencer::Select select = model_->sequencer().select(miss);
    if (!select.valid || select.kind != MemorySequencer::Kind::Loser || !status.freed()) return;
    ++freed_while_chosen;
    const auto set_of = [](uint32_t line) { return line % (kWayBytes / 64); };
    const MemTask& task = flights[select.warp]->task;
    for (uint32_t lanes = task.mask; lanes != 0; lanes &= lanes - 1) {
      const uint32_t line = task.address[lowest(lanes)] / 64;
      uint32_t promised = 0;
      bool comes = false;
      for (uint32_t stay = miss.busy & ~status.finished(); stay != 0; stay &= stay - 1) {
        const uint32_t id = lowest(stay);
        comes |= miss.line[id] == line;
        if (set_of(miss.line[id]) == set_of(line)) promised |= 1u << miss.way[id];
      }
      if (promised != 3 || comes) continue;
      ++freed_wasted;
      return;
    }
  }

  uint64_t outputs() {
    const auto& u = *unit_;
    uint64_t sum = 0;
    for (uint64_t value : {uint64_t{u.ready_o}, uint64_t{u.done_valid_o}, uint64_t{u.done_warp_o},
                           uint64_t{u.fault_valid_o}, uint64_t{u.request_valid_o}, uint64_t{u.request_write_o},
                           uint64_t{u.request_address_o}, uint64_t{u.request_mask_o}, uint64_t{u.request_id_o},
                           uint64_t{u.store_trace_valid_o}, uint64_t{u.store_trace_address_o}, uint64_t{u.hit_o},
                           uint64_t{u.miss_o}, uint64_t{u.store_o}, uint64_t{u.idle_o}})
      sum = sum * 0x9e3779b97f4a7c15u + value;
    for (int lane = 0; lane < kLanes; ++lane) sum = sum * 31 + get(u.done_data_o, lane);
    return sum;
  }

  void check_store_trace() {
    const auto& u = *unit_;
    if (!u.store_trace_valid_o) return;
    auto& flight = flights[u.store_trace_warp_o];
    ASSERT_TRUE(flight && flight->task.store) << "store trace of a warp that stores nothing, cycle " << cycle;
    const auto quad = flight->stores.find(u.store_trace_address_o);
    ASSERT_NE(quad, flight->stores.end()) << "quadword stored twice or never asked for, cycle " << cycle;
    ASSERT_EQ(quad->second.mask, u.store_trace_mask_o);
    Quad seen;
    seen.mask = u.store_trace_mask_o;
    for (uint32_t i = 0; i < 4; ++i) {
      seen.data[i] = u.store_trace_data_o[i];
      if (!(seen.mask >> i & 1)) continue;
      ASSERT_EQ(quad->second.data[i], seen.data[i]) << "stored word " << i << ", cycle " << cycle;
      history_of(quad->first + 4 * i).push_back({cycle, seen.data[i]});
    }
    port_writes_.push_back({quad->first, seen});
    flight->stores.erase(quad);
  }

  void check_done() {
    const auto& u = *unit_;
    if (!u.done_valid_o) return;
    const uint32_t warp = u.done_warp_o;
    auto& flight = flights[warp];
    ASSERT_TRUE(flight) << "warp " << warp << " is done without a task, cycle " << cycle;
    Result& result = results[warp];
    result.cycles = cycle - flight->start;
    longest = std::max(longest, result.cycles);
    for (int lane = 0; lane < kLanes; ++lane) {
      result.data[lane] = get(u.done_data_o, lane);
      if (flight->task.store || flight->task.inval || !(flight->task.mask >> lane & 1)) continue;
      ASSERT_TRUE(may_load(flight->task.address[lane], result.data[lane], flight->start))
          << "warp " << warp << " lane " << lane << " loaded " << std::hex << result.data[lane] << " from "
          << flight->task.address[lane] << ", which held " << history_of(flight->task.address[lane]).back().value
          << std::dec << ", cycle " << cycle;
    }
    ASSERT_TRUE(flight->stores.empty()) << "a store is done before all its quadwords are, cycle " << cycle;
    flight.reset();
    last_done_ = cycle;
  }

  /// The word held this value at some time from `start` to now.
  bool may_load(uint32_t address, uint32_t value, uint64_t start) {
    const auto& versions = history_of(address);
    for (size_t i = versions.size(); i-- > 0;) {
      if (versions[i].value == value) return true;
      if (versions[i].since <= start) return false;
    }
    return false;
  }

  void check_request() {
    auto& u = *unit_;
    if (held_) {
      ASSERT_TRUE(u.request_valid_o) << "a request was withdrawn, cycle " << cycle;
      ASSERT_EQ(held_address_, u.request_address_o);
      ASSERT_EQ(held_write_, u.request_write_o);
    }
    held_ = u.request_valid_o && !u.request_ready_i;
    held_address_ = u.request_address_o;
    held_write_ = u.request_write_o;
    if (!u.request_valid_o || !u.request_ready_i) return;
    const uint32_t address = u.request_address_o;
    if (u.request_write_o) {
      ++writes_at_port;
      ASSERT_FALSE(port_writes_.empty()) << "a write leaves that was not traced, cycle " << cycle;
      const auto expected = port_writes_.front();
      port_writes_.pop_front();
      ASSERT_EQ(expected.first, address);
      ASSERT_EQ(expected.second.mask, u.request_mask_o);
      for (uint32_t i = 0; i < 4; ++i) {
        const bool written = expected.second.mask >> i & 1;
        ASSERT_TRUE(!written || expected.second.data[i] == u.request_data_o[i]) << "word " << i << ", cycle " << cycle;
      }
      ASSERT_FALSE(memory.fetching_line(address)) << "a store did not wait for the fetch of its line, cycle " << cycle;
      memory.write(address, expected.second.data, expected.second.mask);
    } else {
      ASSERT_EQ(address % 64, 0u);
      ASSERT_LT(u.request_id_o, Model::kMshrs);
      ASSERT_FALSE(memory.fetching_id(u.request_id_o)) << "id in use, cycle " << cycle;
      ASSERT_FALSE(memory.fetching_line(address)) << "a line is fetched twice at a time, cycle " << cycle;
      memory.read(address, u.request_id_o, cycle);
    }
  }

  std::unordered_map<uint32_t, std::vector<Version>> history_;  ///< a word
  std::deque<std::pair<uint32_t, Quad>> port_writes_;
  std::unique_ptr<typename Model::Unit> unit_;
  std::unique_ptr<MemAlu> model_;
  MemAlu::Events events_;  ///< of the cycle before
  Step step_;
  uint64_t last_done_ = 0;
  uint32_t next_value_ = 0;
  bool ready_ = false, held_ = false, held_write_ = false;
  uint32_t held_address_ = 0;
};

}  // namespace raypool::bench
