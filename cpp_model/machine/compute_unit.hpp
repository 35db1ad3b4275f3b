// The compute-unit interface: one set of ports, behind which stand the functional model, the Verilated RTL and the lockstep of
// both.
//
// Use, once a cycle: read outputs() (what the unit's output ports show in this cycle; they never depend on this cycle's inputs),
// decide the inputs, call clock(inputs). A handshake transfers when both its valid and its ready are set in the same cycle.
// docs/architecture.md gives the protocols; names are those of rtl/compute_unit.v without _i and _o.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "machine/memory.hpp"
#include "machine/packages.hpp"

namespace raypool {

enum class ImportKind : uint8_t { None = 0, Normal = 1, Shadow = 2 };

struct LaunchCommand {
  uint32_t pc = 0;       ///< entry, in instructions
  uint32_t threads = 0;  ///< 1 .. warps x cores
  uint32_t block = 0;    ///< word that `block` reads
  uint32_t blocks = 1;   ///< word that `blocks` reads
  ImportKind import = ImportKind::None;
};

struct MemoryRequest {
  bool write = false;
  uint32_t address = 0;  ///< read: multiple of 64, a line; write: multiple of 16, a quadword
  Beat data{};           ///< write only
  uint8_t mask = 0;      ///< write only: bit i = word i is written
  uint8_t id = 0;        ///< read only: comes back with the response
};

struct MemoryResponse {
  uint8_t id = 0;
  uint8_t beat = 0;  ///< 0 .. 3 within the line
  Beat data{};
};

struct FrameContribution {
  uint32_t pixel = 0;             ///< x in bits 15:0, y in bits 31:16
  std::array<uint32_t, 3> rgb{};  ///< floats
};

enum class FaultCode : uint8_t {
  None = 0,
  IllegalInstruction = 1,
  PcOutsideProgram = 2,
  StackOverflow = 3,
  StackUnderflow = 4,
  Misaligned = 5,
  AddressOutsideMemory = 6,
  RayWordOutside = 7,
};

struct Fault {
  FaultCode code = FaultCode::None;
  uint32_t warp = 0;
  uint32_t pc = 0;
};

struct UnitInputs {
  bool launch_valid = false;
  LaunchCommand launch;
  bool memory_request_ready = false;
  bool memory_response_valid = false;
  MemoryResponse memory_response;
  bool import_request_ready = false;
  bool import_beat_valid = false;
  Beat import_beat{};
  bool export_ready = false;
  bool frame_ready = false;
};

struct UnitOutputs {
  bool launch_ready = false;
  bool kernel_done = false;  ///< one cycle for each kernel that ends
  bool busy = false;         ///< a kernel is running
  bool idle = true;          ///< nothing runs, waits, is being exported or stored
  bool memory_request_valid = false;
  MemoryRequest memory_request;
  bool import_request_valid = false;  ///< wants one package
  ImportKind import_request_kind = ImportKind::None;
  bool export_valid = false;
  Beat export_data{};
  bool export_last = false;  ///< third beat of a ray
  bool frame_valid = false;
  FrameContribution frame;
  Fault fault;  ///< sticky
};

/// What the trace ports show in this cycle (RTL: retire_*, store_trace_*, ray_trace_*).
struct RetireEvent {
  uint32_t warp = 0;
  uint32_t pc = 0;
  uint64_t instruction = 0;
  uint32_t mask = 0;           ///< thread mask
  std::vector<uint32_t> data;  ///< one word a lane; meaningful in masked lanes when the instruction writes a register
  uint32_t predicate = 0;      ///< value written when the instruction writes a predicate
};
struct StoreEvent {
  uint32_t warp = 0;
  uint32_t address = 0;  ///< multiple of 16
  Beat data{};
  uint8_t mask = 0;
};
struct RayWriteEvent {
  uint32_t warp = 0;
  uint32_t word = 0;
  uint32_t mask = 0;
  std::vector<uint32_t> data;  ///< one word a lane
};
struct UnitTrace {
  std::vector<RetireEvent> retired;  ///< rising warp number
  std::vector<StoreEvent> stores;
  std::vector<RayWriteEvent> ray_writes;
};

/// Performance counters; the number is the RTL's counter_select_i. For those of an ALU type add the Unit's value.
namespace counter {
inline constexpr int kBusyCycles = 0;          ///< cycles in which a kernel ran
inline constexpr int kInstructions = 1;        ///< warp instructions retired
inline constexpr int kThreadInstructions = 2;  ///< sum of their thread masks' sizes
inline constexpr int kInstructionCacheHits = 3;
inline constexpr int kInstructionCacheMisses = 4;  ///< lookups that did not hit
inline constexpr int kDataCacheHits = 5;           ///< quadword loads served by the cache at first try
inline constexpr int kDataCacheMisses = 6;         ///< quadword loads that were parked
inline constexpr int kDataCacheStores = 7;         ///< quadword stores
inline constexpr int kUnused = 16;                 ///< + Unit: busy cycles x instances that were free for a task and got none
inline constexpr int kWaiting = 24;  ///< + Unit: sum over busy cycles of the warps that wanted this type and were not granted
inline constexpr int kIssued = 32;   ///< + Unit: tasks issued
inline constexpr int kCount = 40;
}  // namespace counter

class ComputeUnit {
 public:
  virtual ~ComputeUnit() = default;

  /// Reset, then set what stays for a program: its length (instructions), the memory's size (bytes).
  virtual void reset(uint32_t program_length, uint32_t memory_limit) = 0;
  /// Writes argument word `index` (0 .. 31). Only while idle.
  virtual void set_argument(int index, uint32_t value) = 0;

  virtual const UnitOutputs& outputs() const = 0;
  virtual void clock(const UnitInputs& inputs) = 0;

  /// Trace of the current cycle. Filled only after trace_on(); costs time.
  virtual void trace_on() {}
  virtual const UnitTrace& trace() const = 0;

  virtual uint64_t counter(int number) = 0;  ///< see namespace counter
  /// False for an engine that has no notion of time; its cycles and counters of time mean nothing.
  virtual bool timed() const = 0;

  /// Writes a waveform from now on; throws std::runtime_error where an engine has none.
  virtual void open_waveform(const std::string& path);
};

}  // namespace raypool
