// Drives a Verilated ray_alu between pools of random speed and checks in every cycle what docs/machine/ray-alu.md
// promises: every word read, every ray and frame contribution (order, lanes, content), which package goes to which
// thread, the rules of requests, stable payloads, the trace, exporting_o, exports_o and import_active_o to the cycle,
// bounded time. What the unit breaks is thrown, with cycle and seed. MODEL is a struct with the Verilated class as Unit
// and kWarps, kLanes, kWide, kWords.
#pragma once

#include <verilated.h>

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace raypool::bench {

enum class RayOp : uint8_t { Rin = 0, Rout = 1, Rfb = 2, Rld = 3, Rst = 4 };

struct RayTask {
  uint32_t warp = 0;
  RayOp op = RayOp::Rin;
  uint32_t word = 0;           ///< rld, rst
  uint32_t mask = 0;           ///< thread mask
  std::vector<uint32_t> data;  ///< rst: a word a lane
};

/// Chance, in percent, that a port is ready or has a beat in a cycle.
struct PoolOdds {
  uint32_t request = 100, beat = 100, rays = 100, frame = 100;
};

/// How often something happened: a test that checked nothing must not pass.
struct RayCounts {
  uint64_t reads = 0, words_checked = 0, writes = 0, packages = 0, rays = 0, contributions = 0;
  uint64_t waited_in = 0, waited_out = 0;  ///< tasks that were parked for longer than they need
};

template <typename Model>
class RayAluBench {
 public:
  static constexpr uint32_t kLanes = Model::kLanes;
  static constexpr uint32_t kWarps = Model::kWarps;
  static constexpr uint32_t kContents = kLanes * kWarps;
  static constexpr uint32_t kAllLanes = static_cast<uint32_t>((uint64_t{1} << kLanes) - 1);
  static constexpr uint32_t kWords = Model::kWords;  ///< of an intersection
  static constexpr uint32_t kBeats = (kWords + 3) / 4;
  static constexpr uint64_t kSteps = kLanes > 4 && !Model::kWide ? kLanes / 4 : 1;  ///< port cycles of an access
  static constexpr uint64_t kAccessCycles = kSteps + 1;  ///< from arrival to done, without a conflict
  static constexpr uint64_t kSwapCycles = 2;
  static constexpr uint64_t kPatience = 20000;  ///< cycles without an event after which the unit counts as hanging

  explicit RayAluBench(uint32_t seed) : random(seed), seed_(seed) {
    Verilated::randReset(2);
    Verilated::randSeed(static_cast<int>(seed + 1));
    unit_ = std::make_unique<typename Model::Unit>();
    for (Slices& warp : slices_) {
      for (auto& set : warp.sets) set.assign(kWords * kLanes, std::nullopt);
    }
    unit_->rst_ni = 0;
    unit_->task_valid_i = 0;
    unit_->import_start_i = 0;
    unit_->import_beat_valid_i = 0;
    for (int i = 0; i < 3; ++i) {
      unit_->clk_i = 0;
      unit_->eval();
      edge();
    }
    unit_->rst_ni = 1;
  }
  ~RayAluBench() { unit_->final(); }

  std::mt19937 random;
  PoolOdds odds;
  RayCounts counts;
  uint64_t cycle = 0;
  uint64_t request_limit = ~uint64_t{0};  ///< requests that the pool still takes
  uint64_t faults = 0;
  uint32_t fault_warp = 0;
  std::vector<uint64_t> beat_cycles;               ///< cycles in which a beat of a ray or a contribution left
  std::array<uint64_t, Model::kWarps> duration{};  ///< of the warp's last task, from arrival to done
  std::array<std::vector<uint32_t>, Model::kWarps> read_data;  ///< of the warp's last rld, a lane

  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random() % bound); }
  bool roll(uint32_t percent) { return below(100) < percent; }
  bool ready() const { return ready_; }  ///< a task given to the next step() is taken
  bool in_flight(uint32_t warp) const { return flights_[warp].has_value(); }
  bool import_active() const { return active_; }
  bool exporting() const { return !expected_.empty(); }
  bool busy() const {
    for (const auto& flight : flights_)
      if (flight) return true;
    return active_ || exporting();
  }
  /// Word of a package that was or will be imported: launches count from 0.
  static uint32_t package_word(uint32_t launch, uint32_t thread, uint32_t word) {
    uint32_t value = (launch * kContents + thread) * 32 + word + 1;
    value *= 0x9e3779b1u;
    return value ^ value >> 15;
  }

  /// In the next step() a launch's import starts.
  void start_import(uint32_t kind, uint32_t threads) { start_ = Launch{kind, threads}; }
  /// A task that faulted never ends; its warp may be used again.
  void forget(uint32_t warp) { flights_[warp].reset(); }

  /// One cycle; the task arrives in it. Returns true if a task ended.
  bool step(const RayTask* task = nullptr) {
    drive(task);
    unit_->clk_i = 0;
    unit_->eval();
    if (task != nullptr) {
      if (!ready_) throw std::logic_error("the bench gave a task to an ALU that was not ready");
      if (flights_[task->warp]) throw std::logic_error("the bench gave a second task to a warp");
      flights_[task->warp] = Flight{*task, cycle};
    }
    check(unit_->import_active_o == active_, active_ ? "import_active_o is low" : "import_active_o is high");
    check_fault();
    const bool ended = check_done();
    check_request();
    check_exports();
    check(unit_->exports_o == static_cast<uint16_t>(asked_), "exports_o is not what has been asked for");
    if (task != nullptr && (task->op == RayOp::Rout || task->op == RayOp::Rfb))
      asked_ += static_cast<uint64_t>(__builtin_popcount(task->mask));
    take_beat();
    if (start_ && start_->kind != 0) {
      check(!active_, "the bench started an import during another");
      launches_.push_back(*start_);
      requested_ = received_ = beat_ = 0;
      active_ = true;
    }
    start_.reset();
    ready_ = unit_->ready_o;
    edge();
    ++cycle;
    if (busy() && cycle - last_event_ > kPatience)
      fail("nothing has happened for " + std::to_string(kPatience) + " cycles: it hangs");
    return ended;
  }
  /// Gives a task as soon as it is taken; returns when it is done.
  void run(const RayTask& task) {
    while (!ready_) step();
    step(&task);
    while (flights_[task.warp]) step();
  }
  void drain() {
    while (busy()) step();
    for (int i = 0; i < 20; ++i) step();
    check(unit_->exports_o == static_cast<uint16_t>(counts.rays + counts.contributions),
          "exports_o is not what has left, and nothing else is to come");
  }
  uint16_t exports() const { return unit_->exports_o; }

 private:
  struct Flight {
    RayTask task;
    uint64_t start = 0;
  };
  struct Launch {
    uint32_t kind = 0, threads = 0;
  };
  using Set = std::vector<std::optional<uint32_t>>;  ///< [word][lane]; a word never written is not known
  struct Slices {
    std::array<Set, 3> sets;
    uint32_t input = 0, current = 1, output = 2;
    uint64_t filled = 0, taken = 0;  ///< inputs that were completed and those that became current
    uint64_t filled_at = 0;
  };
  struct Export {
    bool frame = false;
    uint32_t warp = 0, lane = 0;
    std::array<std::optional<uint32_t>, 12> words;  ///< a contribution has four
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("cycle " + std::to_string(cycle) + ", seed " + std::to_string(seed_) + ": " + what);
  }
  void check(bool good, const char* what) const {
    if (!good) fail(what);
  }
  void compare(const std::optional<uint32_t>& expected, uint32_t value, const char* what, uint32_t warp, uint32_t lane,
               uint32_t word) {
    if (!expected) return;
    ++counts.words_checked;
    if (*expected != value) {
      fail(std::string(what) + ": warp " + std::to_string(warp) + ", lane " + std::to_string(lane) + ", word " +
           std::to_string(word) + " is " + std::to_string(value) + ", expected " + std::to_string(*expected));
    }
  }

  void edge() {
    unit_->clk_i = 1;
    unit_->eval();
  }

  template <typename T>
  static void put(T& port, uint32_t index, uint32_t value) {
    if constexpr (std::is_integral_v<T>) {
      port =
          static_cast<T>((uint64_t{port} & ~(uint64_t{0xffffffffu} << (32 * index))) | uint64_t{value} << (32 * index));
    } else {
      port[index] = value;
    }
  }
  template <typename T>
  static uint32_t get(const T& port, uint32_t index) {
    if constexpr (std::is_integral_v<T>) {
      return static_cast<uint32_t>(uint64_t{port} >> (32 * index));
    } else {
      return port[index];
    }
  }

  // Inputs that are not valid are noise.
  void drive(const RayTask* task) {
    unit_->task_valid_i = task != nullptr;
    unit_->task_warp_i = task != nullptr ? task->warp : below(kWarps);
    unit_->task_operation_i = task != nullptr ? static_cast<uint32_t>(task->op) : below(5);
    unit_->task_word_i = task != nullptr ? task->word : below(32);
    unit_->task_mask_i = task != nullptr ? task->mask : static_cast<uint32_t>(random()) & kAllLanes;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      put(unit_->task_operand_b_i, lane,
          task != nullptr && lane < task->data.size() ? task->data[lane] : static_cast<uint32_t>(random()));
    }
    unit_->import_start_i = start_.has_value();
    unit_->import_start_kind_i = start_ ? start_->kind : below(4);
    unit_->import_start_threads_i = start_ ? start_->threads : below(2048);
    unit_->import_request_ready_i = request_limit > 0 && roll(odds.request);
    unit_->import_beat_valid_i = outstanding_ > 0 && roll(odds.beat);
    for (uint32_t i = 0; i < 4; ++i) {
      uint32_t value = random();
      if (unit_->import_beat_valid_i) {
        const uint32_t word = beat_ * 4 + i;
        value = word < kWords ? package_word(launch(), received_, word) : 0;
      }
      unit_->import_beat_data_i[i] = value;
    }
    unit_->export_ready_i = roll(odds.rays);
    unit_->frame_ready_i = roll(odds.frame);
  }

  uint32_t launch() const { return static_cast<uint32_t>(launches_.size()) - 1; }

  void check_fault() {
    if (!unit_->fault_valid_o) return;
    fault_warp = unit_->fault_warp_o;
    check(unit_->fault_code_o == 7, "the fault's code is not 7");
    const auto& flight = flights_[fault_warp];
    check(flight && (flight->task.op == RayOp::Rld || flight->task.op == RayOp::Rst) && flight->task.word >= kWords,
          "a fault at a word that an intersection has");
    check(flight->start + 1 == cycle, "the fault is not in the cycle after arrival");
    ++faults;
  }

  bool check_done() {
    const bool traced = unit_->ray_trace_valid_o;
    if (!unit_->done_valid_o) {
      check(!traced, "a ray trace without a task that ends");
      return false;
    }
    last_event_ = cycle;
    const uint32_t warp = unit_->done_warp_o;
    check(warp < kWarps && flights_[warp], "done of a warp that has no task");
    const RayTask task = flights_[warp]->task;
    duration[warp] = cycle - flights_[warp]->start;
    flights_[warp].reset();
    Slices& slices = slices_[warp];
    check(traced == (task.op == RayOp::Rst), "the ray trace does not come with the rst's end, and it alone");
    check(duration[warp] >= (task.op == RayOp::Rld || task.op == RayOp::Rst ? kAccessCycles : kSwapCycles),
          "done too early");
    if (task.op == RayOp::Rld || task.op == RayOp::Rst)
      check(task.word < kWords, "a word that an intersection has not was accessed");
    Set& current = slices.sets[slices.current];
    switch (task.op) {
      case RayOp::Rin:
        check(slices.filled > slices.taken, "rin ended before its packages were there");
        if (duration[warp] > kSwapCycles) ++counts.waited_in;
        ++slices.taken;
        std::swap(slices.input, slices.current);
        break;
      case RayOp::Rout:
      case RayOp::Rfb:
        if (duration[warp] > kSwapCycles + 1) ++counts.waited_out;
        std::swap(slices.output, slices.current);
        expect_exports(task, slices.sets[slices.output]);
        break;
      case RayOp::Rld:
        ++counts.reads;
        read_data[warp].resize(kLanes);
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
          read_data[warp][lane] = get(unit_->done_data_o, lane);
          compare(current[task.word * kLanes + lane], read_data[warp][lane], "rld", warp, lane, task.word);
        }
        break;
      case RayOp::Rst:
        ++counts.writes;
        check(unit_->ray_trace_warp_o == warp && unit_->ray_trace_word_o == task.word &&
                  unit_->ray_trace_mask_o == task.mask,
              "the ray trace names another warp, word or mask");
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
          if (!(task.mask >> lane & 1)) continue;
          compare(task.data[lane], get(unit_->ray_trace_data_o, lane), "ray trace", warp, lane, task.word);
          current[task.word * kLanes + lane] = task.data[lane];
        }
        break;
    }
    return true;
  }

  void expect_exports(const RayTask& task, const Set& slice) {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      if (!(task.mask >> lane & 1)) continue;
      Export record;
      record.frame = task.op == RayOp::Rfb;
      record.warp = task.warp;
      record.lane = lane;
      const uint32_t first = record.frame ? 7 : 0, words = record.frame ? 4 : 12;
      for (uint32_t i = 0; i < words; ++i) record.words[i] = slice[(first + i) * kLanes + lane];
      expected_.push_back(record);
    }
  }

  void check_request() {
    const bool valid = unit_->import_request_valid_o;
    check(valid || !request_waits_, "a request was withdrawn");
    request_waits_ = valid;
    if (!valid) return;
    check(active_ && requested_ < launches_.back().threads, "a request that no launch asks for");
    check(unit_->import_request_kind_o == launches_.back().kind, "a request of the wrong kind");
    check(outstanding_ < 2, "a third request while two packages are outstanding");
    const Slices& slices = slices_[requested_ / kLanes];
    check(slices.filled == slices.taken, "a package was requested for an input slice that is full");
    if (!unit_->import_request_ready_i) return;
    request_waits_ = false;
    ++requested_;
    ++accepted_;
    --request_limit;
    last_event_ = cycle;
  }

  // The package that gets its last beat in this cycle is in the input slice from now on. Requests taken now have beats
  // from the next cycle.
  void take_beat() {
    if (unit_->import_beat_valid_i) {
      last_event_ = cycle;
      if (++beat_ == kBeats) {
        beat_ = 0;
        Slices& slices = slices_[received_ / kLanes];
        for (uint32_t word = 0; word < kWords; ++word) {
          slices.sets[slices.input][word * kLanes + received_ % kLanes] = package_word(launch(), received_, word);
        }
        ++received_;
        ++counts.packages;
        --outstanding_;
        if (received_ % kLanes == 0 || received_ == launches_.back().threads) ++slices.filled;
        if (received_ == launches_.back().threads) active_ = false;
      }
    }
    outstanding_ += accepted_;
    accepted_ = 0;
  }

  void check_exports() {
    check(unit_->exporting_o == !expected_.empty(), expected_.empty() ? "exporting_o is high" : "exporting_o is low");
    const bool ray = unit_->export_valid_o, frame = unit_->frame_valid_o;
    check(!(ray && frame), "both export ports are valid: one of them is out of order");
    check(ray || frame || !offer_waits_, "an export was withdrawn");
    std::array<uint32_t, 4> beat{};
    for (uint32_t i = 0; i < 4; ++i) {
      beat[i] = ray ? get(unit_->export_data_o, i) : i == 0 ? unit_->frame_pixel_o : get(unit_->frame_color_o, i - 1);
    }
    if (offer_waits_) check(beat == offered_, "a payload changed while it waited");
    offer_waits_ = false;
    if (!ray && !frame) return;
    check(!expected_.empty(), "an export that was not asked for");
    const Export& record = expected_.front();
    check(record.frame == frame, "a ray and a frame contribution changed places");
    offered_ = beat;
    if (ray) check(unit_->export_last_o == (export_beat_ == 2), "export_last_o is not that of the third beat");
    offer_waits_ = ray ? !unit_->export_ready_i : !unit_->frame_ready_i;
    if (offer_waits_) return;
    last_event_ = cycle;
    beat_cycles.push_back(cycle);
    for (uint32_t i = 0; i < 4; ++i) {
      compare(record.words[export_beat_ * 4 + i], beat[i], frame ? "frame" : "ray", record.warp, record.lane,
              frame ? 7 + i : export_beat_ * 4 + i);
    }
    if (frame || ++export_beat_ == 3) {
      export_beat_ = 0;
      ++(frame ? counts.contributions : counts.rays);
      expected_.pop_front();
    }
  }

  uint32_t seed_;
  std::unique_ptr<typename Model::Unit> unit_;
  bool ready_ = false;
  std::array<std::optional<Flight>, Model::kWarps> flights_;
  std::array<Slices, Model::kWarps> slices_;
  std::optional<Launch> start_;
  std::vector<Launch> launches_;
  bool active_ = false, request_waits_ = false, offer_waits_ = false;
  uint32_t requested_ = 0, received_ = 0, beat_ = 0, outstanding_ = 0, accepted_ = 0;
  uint64_t asked_ = 0;  ///< lanes of the rout and rfb that have arrived
  std::deque<Export> expected_;
  uint32_t export_beat_ = 0;
  std::array<uint32_t, 4> offered_{};
  uint64_t last_event_ = 0;
};

}  // namespace raypool::bench
