// What random programs have exercised, read from a unit's ports, trace and counters alone:
// nothing inside the RTL is looked at.
// docs/develop/coverage.md defines each group.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "cosim/cosim.hpp"
#include "cosim/coverage_events.hpp"
#include "enum_array.hpp"
#include "isa/encoding.hpp"

namespace raypool {

class Coverage : public RunObserver {
 public:
  explicit Coverage(const Configuration& configuration, int units = 1);

  /// To be called before a program's run, which must use this observer, and after it.
  void begin();
  void restart() override { begin(); }
  void faulted(const std::vector<Fault>& faults) override;
  void cycle(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) override;
  void end(ComputeUnit& unit);

  struct Item {
    std::string name;
    uint64_t count;  ///< times seen; 0: not covered
  };
  struct Group {
    std::string name;
    std::vector<Item> items;
    size_t covered() const;
  };
  /// All groups, with the items that the configuration can have.
  std::vector<Group> groups() const;

 private:
  static constexpr size_t kFaultCodes = 9;
  static constexpr uint32_t kFirstUpperBit = 16, kFirstUpperPcBit = 9;
  struct Entry {
    uint32_t pc, rpc;
    uint32_t begin = 0;
    bool loop = false;
  };
  struct Warp {
    std::vector<Entry> stack;
    std::vector<uint32_t> registers;  ///< [register][lane]
    int last_type = -1;               ///< of the instruction before
    uint64_t last_retired = 0;        ///< cycle
    std::array<uint8_t, 3> roles{};   ///< sets that are input, current, output
    uint64_t last_export = 0;         ///< rays and contributions that had been made when it last exported
    uint32_t set = 0, written = 0;    ///< predicates that have a lane set; that this kernel has written
    uint32_t left = 0;                ///< ... that the kernel before has left set
    uint32_t last_pc = 0;
    int element = 0;      ///< of a triple that retires next
    uint64_t kernel = 0;  ///< launches before the one that it is in, of those since the unit's reset
    bool inside = false;  ///< that kernel
  };
  struct Line {
    uint64_t fetches = 0;
    uint64_t first_beat = 0, last_beat = 0;  ///< cycles of the last fetch
    bool stored = false;                     ///< since it was fetched
  };
  struct Read {
    bool valid = false;
    uint32_t address = 0;
    uint64_t order = 0;
  };
  struct Recent {
    uint64_t cycle;
    uint32_t warp;
    size_t type;
  };

  bool possible(Event one) const;
  size_t last_fault() const;  ///< greatest code that the configuration can have
  void fault_pairs(Group& group) const;
  void hit(Event event, uint64_t times = 1) { events_[event] += times; }
  void retired(const RetireEvent& event);
  void together(const RetireEvent& event, size_t type);
  void control(Warp& warp, const RetireEvent& event, const Instruction& instruction);
  void loaded(const Warp& warp, const RetireEvent& event, const Instruction& instruction);
  void code(const RetireEvent& event);
  void argument(const RetireEvent& event, const Instruction& instruction);
  void predicates(Warp& warp, const RetireEvent& event, const Instruction& instruction);
  void last_of_all(const RetireEvent& event, const Instruction& instruction);
  void triple(Warp& warp, const RetireEvent& event, const Instruction& instruction);
  void slow(const RetireEvent& event);
  void enter_kernel(Warp& warp, uint32_t number);
  void overlap(const UnitTrace& trace);
  void after_fault(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace);
  void swapped(Warp& warp, const RetireEvent& event, Opcode opcode);
  void stored(const StoreEvent& event);
  void memory_request(const UnitOutputs& outputs, const UnitInputs& inputs);
  void memory_response(const UnitInputs& inputs);
  void pools(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace);
  void launches(const UnitOutputs& outputs, const UnitInputs& inputs);
  uint32_t set_of(uint32_t address) const;
  Warp& warp_of(uint32_t unit, uint32_t warp) { return warps_[unit * configuration_.warps + warp]; }

  Configuration configuration_;
  uint32_t units_, lanes_, full_;
  // Counts over all programs.
  std::vector<uint64_t> rows_, empty_, partial_;  ///< [row of the table]: retired; with no lane; with some lanes
  std::array<std::array<uint64_t, kAluTypes>, kAluTypes> after_{};  ///< [type][type of the warp's next instruction]
  std::array<std::array<uint64_t, kAluTypes>, kAluTypes>
      together_{};                ///< [lower type][higher type] in flight in one cycle
  std::vector<uint64_t> depths_;  ///< [entries on the PC stack]
  EnumArray<FaultCode, uint64_t, kFaultCodes> faults_{};
  /// [code that wins][code that does not][the winner's is the lower warp] in one cycle
  EnumArray<FaultCode, EnumArray<FaultCode, std::array<uint64_t, 2>, kFaultCodes>, kFaultCodes> fault_pairs_{};
  std::array<uint64_t, kPredicates> left_set_{};         ///< [predicate] read, and the kernel before has left it set
  std::array<uint64_t, 32> load_bits_{}, store_bits_{};  ///< [address bit] of loads, of stores: set
  std::array<uint64_t, 16> pc_bits_{}, pc_twins_{};  ///< [bit] set; of a PC that differs from another one in it alone
  EnumArray<Event, uint64_t, kEvents> events_{};

  // The program that runs.
  uint64_t now_ = 0;
  std::vector<Warp> warps_;                    ///< of all units
  std::deque<Recent> recent_;                  ///< what retired in the last cycles
  std::unordered_map<uint32_t, Line> lines_;   ///< [line_key()]
  std::array<Read, 32 * kMostUnits> reads_{};  ///< [id]; 16 of each unit is its instruction cache
  uint64_t reads_asked_ = 0, data_fetches_ = 0;
  uint64_t last_line_end_ = 0, last_beat_ = 0, last_import_beat_ = 0;
  uint32_t import_beat_ = 0;
  uint32_t import_thread_ = 0;             ///< the thread that gets the package that comes; of one unit
  std::array<uint64_t, 3> set_written_{};  ///< last beat of a package for the set
  std::array<uint64_t, kMostUnits> made_{},
      left_{};                              ///< rays and contributions: by rout and rfb, and those that have left
  std::array<uint64_t, 3> moved_{};         ///< last cycle in which memory request, export, frame moved
  std::array<int, kMostUnits> accepted_{};  ///< kernels that have not ended
  std::vector<uint32_t> launched_;          ///< threads of each launch; of one unit
  uint64_t ended_ = 0;                      ///< of these
  std::optional<Recent> last_slow_;         ///< the last one that retired
  uint32_t last_pc_ = ~0u;
  uint64_t open_cycles_ = 0;                                     ///< since the fault, in a row
  std::array<std::optional<uint32_t>, kArguments> arguments_{};  ///< as they have been read
  std::unordered_map<uint32_t, uint32_t> words_;                 ///< [address] as loaded, and not stored since
  std::vector<bool> pcs_;                                        ///< that have retired
  std::vector<uint64_t> code_;                                   ///< [PC] as it has retired
};

/// Several lines: how much of each group is covered, then what is not.
std::string to_string(const Coverage& coverage);
/// The coverage of one of several machines.
struct NamedCoverage {
  std::string name;
  uint64_t programs;
  const Coverage* coverage;
};
/// A row for each group: seen of what it can show, for each machine and of all together, where an item counts once.
/// Then what none has seen.
std::string to_string(const std::vector<NamedCoverage>& machines);

/// A JSON object: groups, items, counts.
std::string to_json(const NamedCoverage& machine);
/// The same of each, in an array "machines".
std::string to_json(const std::vector<NamedCoverage>& machines);

}  // namespace raypool
