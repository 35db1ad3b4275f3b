// The gates of a mapped netlist, simulated without being compiled: a Verilog shell in place of the compute unit, or of
// the chip, calls these functions. Two-valued, registers begin with 0, no delays. A gate is a truth table; only gates
// with a changed input are looked at, level by level, so that each changes at most once while the netlist settles.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "svdpi.h"

namespace {

constexpr uint32_t kNoGate = 0xffffffffu;
constexpr uint32_t kFlop = 0xffffffffu;  // in place of a level
constexpr uint32_t kLargestCell = 6;     // inputs: a table has 64 entries

struct Gate {
  uint64_t table;
  uint32_t index = 0;  // the inputs' values: where in the table
  uint32_t level = kFlop;
  uint32_t first_sink = 0, last_sink = 0;
  uint64_t toggles = 0;
  bool value = false;
  bool queued = false;
};

struct Sink {
  uint32_t gate;
  uint32_t pin;  // as a bit of its index
};

// A block of the hierarchy, for the activity report.
struct Block {
  std::string path;
  uint32_t first, last;  // its gates
};

class Netlist {
 public:
  // The file is what scripts/synth/replay.py writes: a header of counts, cells with their
  // tables, gates, and the nets at the border.
  explicit Netlist(const char* path) {
    std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path, "rb"), std::fclose);
    if (!file) fail(path, "cannot be read");
    file_ = file.get();
    path_ = path;
    const uint32_t nets = number(), cells = number(), gates = number(), inputs = number(), outputs = number(),
                   blocks = number();
    std::vector<Cell> kinds(cells);
    for (Cell& kind : kinds) {
      kind = {number(), number() != 0, 0};
      kind.table = number();
      kind.table |= static_cast<uint64_t>(number()) << 32;
      if (kind.inputs > kLargestCell) fail(path, "has a cell with too many inputs");
    }
    // A source is a gate, or beyond the gates an input of the unit; nets 0 and 1 are the constants.
    gates_.resize(gates);
    std::vector<uint32_t> driver(nets, kNoGate), kind_of(gates), pins;
    uint32_t flops = 0;
    std::vector<std::vector<Sink>> sinks(gates + inputs);
    for (uint32_t gate = 0; gate < gates; ++gate) {
      kind_of[gate] = number();
      const Cell& kind = kinds.at(kind_of[gate]);
      gates_[gate].table = kind.table;
      gates_[gate].level = kind.flop ? kFlop : 0;
      flops += kind.flop ? 1 : 0;
      for (uint32_t pin = 0; pin < kind.inputs; ++pin) pins.push_back(number());
      driver.at(number()) = gate;
    }
    for (uint32_t i = 0; i < inputs; ++i) driver.at(number()) = gates + i;
    size_t next = 0;
    for (uint32_t gate = 0; gate < gates; ++gate) {
      for (uint32_t pin = 0; pin < kinds[kind_of[gate]].inputs; ++pin) {
        const uint32_t net = pins[next++];
        if (net == 1) gates_[gate].index |= 1u << pin;
        if (net <= 1) continue;
        if (driver.at(net) == kNoGate) fail(path, "has a net without a driver");
        sinks[driver[net]].push_back({gate, 1u << pin});
      }
    }
    for (uint32_t i = 0; i < outputs; ++i) {
      const uint32_t net = number();
      outputs_.push_back(net <= 1 ? kNoGate - net : driver.at(net));
      if (net > 1 && driver[net] == kNoGate) fail(path, "has an output without a driver");
    }
    for (uint32_t i = 0; i < blocks; ++i) {
      Block block{"", number(), number()};
      for (uint32_t length = number(); length > 0; --length) block.path += static_cast<char>(number());
      blocks_.push_back(block);
    }
    join(sinks);
    input_values_.assign((inputs + 31) / 32, 0);
    find_levels(flops);
    for (uint32_t gate = 0; gate < gates; ++gate) queue(gate);
  }

  void settle(const svBitVecVal* inputs, svBitVecVal* outputs) {
    for (size_t word = 0; word < input_values_.size(); ++word) {
      for (uint32_t changed = inputs[word] ^ input_values_[word]; changed != 0; changed &= changed - 1) {
        const size_t source = gates_.size() + word * 32 + static_cast<uint32_t>(__builtin_ctz(changed));
        update(first_sink_[source], first_sink_[source + 1]);
      }
      input_values_[word] = inputs[word];
    }
    for (std::vector<uint32_t>& level : levels_) {
      for (size_t i = 0; i < level.size(); ++i) {
        Gate& gate = gates_[level[i]];
        gate.queued = false;
        if ((gate.table >> gate.index & 1) != gate.value) change(gate);
      }
      level.clear();
    }
    std::fill(outputs, outputs + (outputs_.size() + 31) / 32, 0);
    for (size_t i = 0; i < outputs_.size(); ++i) {
      const uint32_t source = outputs_[i];
      bool value = source == kNoGate - 1;
      if (source < gates_.size()) {
        value = gates_[source].value;
      } else if (source < gates_.size() + input_values_.size() * 32) {
        const size_t input = source - gates_.size();
        value = (input_values_[input / 32] >> input % 32 & 1) != 0;
      }
      outputs[i / 32] |= static_cast<uint32_t>(value) << i % 32;
    }
  }

  // The registers take what their inputs settled to; only those with an input that has changed since are looked at.
  void clock() {
    changed_.clear();
    for (const uint32_t flop : waiting_) {
      Gate& gate = gates_[flop];
      gate.queued = false;
      if ((gate.table >> gate.index & 1) != gate.value) changed_.push_back(flop);
    }
    waiting_.clear();
    for (const uint32_t flop : changed_) change(gates_[flop]);
    ++cycles_;
  }

  void report() const {
    for (const Block& block : blocks_) {
      uint64_t toggles = 0;
      for (uint32_t gate = block.first; gate < block.last; ++gate) toggles += gates_[gate].toggles;
      std::printf("TOGGLES %llu %llu %u %s\n", static_cast<unsigned long long>(toggles),
                  static_cast<unsigned long long>(cycles_), block.last - block.first, block.path.c_str());
    }
  }

 private:
  struct Cell {
    uint32_t inputs;
    bool flop;
    uint64_t table;
  };

  [[noreturn]] static void fail(const std::string& path, const char* what) {
    std::fprintf(stderr, "%s %s\n", path.c_str(), what);
    std::exit(1);
  }

  uint32_t number() {
    uint32_t value = 0;
    if (std::fread(&value, sizeof value, 1, file_) != 1) fail(path_, "ends too early");
    return value;
  }

  /// The sinks of every source in one list; first_sink_ has where those of a source begin.
  void join(const std::vector<std::vector<Sink>>& sinks) {
    for (const auto& list : sinks) {
      first_sink_.push_back(static_cast<uint32_t>(sinks_.size()));
      sinks_.insert(sinks_.end(), list.begin(), list.end());
    }
    first_sink_.push_back(static_cast<uint32_t>(sinks_.size()));
    for (size_t gate = 0; gate < gates_.size(); ++gate) {
      gates_[gate].first_sink = first_sink_[gate];
      gates_[gate].last_sink = first_sink_[gate + 1];
    }
  }

  // A gate's level is one more than the highest of the gates that drive it.
  void find_levels(uint32_t flops) {
    std::vector<uint32_t> waiting(gates_.size(), 0), ready;
    for (const Gate& gate : gates_) {
      if (gate.level == kFlop) continue;
      for (uint32_t i = gate.first_sink; i < gate.last_sink; ++i) ++waiting[sinks_[i].gate];
    }
    for (uint32_t gate = 0; gate < gates_.size(); ++gate) {
      if (gates_[gate].level != kFlop && waiting[gate] == 0) ready.push_back(gate);
    }
    size_t done = 0;
    uint32_t highest = 0;
    for (; done < ready.size(); ++done) {
      const Gate& gate = gates_[ready[done]];
      highest = std::max(highest, gate.level);
      for (uint32_t i = gate.first_sink; i < gate.last_sink; ++i) {
        Gate& sink = gates_[sinks_[i].gate];
        if (sink.level == kFlop) continue;
        sink.level = std::max(sink.level, gate.level + 1);
        if (--waiting[sinks_[i].gate] == 0) ready.push_back(sinks_[i].gate);
      }
    }
    if (done + flops != gates_.size()) fail(path_, "has a combinational loop");
    levels_.resize(highest + 1);
  }

  void queue(uint32_t gate) {
    gates_[gate].queued = true;
    (gates_[gate].level == kFlop ? waiting_ : levels_[gates_[gate].level]).push_back(gate);
  }

  void update(uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) {
      Gate& gate = gates_[sinks_[i].gate];
      gate.index ^= sinks_[i].pin;
      if (!gate.queued) queue(sinks_[i].gate);
    }
  }

  void change(Gate& gate) {
    gate.value = !gate.value;
    ++gate.toggles;
    update(gate.first_sink, gate.last_sink);
  }

  FILE* file_ = nullptr;
  std::string path_;
  std::vector<Gate> gates_;
  std::vector<uint32_t> waiting_, changed_, outputs_, first_sink_, input_values_;
  std::vector<Sink> sinks_;
  std::vector<std::vector<uint32_t>> levels_;
  std::vector<Block> blocks_;
  uint64_t cycles_ = 0;
};

}  // namespace

extern "C" {
void* netlist_open(const char* path) { return new Netlist(path); }
void netlist_settle(void* netlist, const svBitVecVal* inputs, svBitVecVal* outputs) {
  static_cast<Netlist*>(netlist)->settle(inputs, outputs);
}
void netlist_clock(void* netlist) { static_cast<Netlist*>(netlist)->clock(); }
void netlist_close(void* netlist, svBit report) {
  if (report) static_cast<Netlist*>(netlist)->report();
  delete static_cast<Netlist*>(netlist);
}
}
