// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The compute-unit interface: one set of ports, behind which stand the functional model, the Verilated RTL and the
// lockstep of both; and several units as one device (machine/compute/multiprocessor.hpp), with the same ports. A device
// of n units numbers them from 0; a single unit is number 0 of its own.
//
// Use, once a cycle: read outputs() (what the unit's output ports show in this cycle; they never depend on
// this cycle's inputs), decide the inputs, call clock(inputs). A handshake transfers when both its valid and
// its ready are set in the same cycle.
// docs/machine/architecture.md and docs/machine/multiprocessor.md give the protocols; names are those of
// rtl/compute/rp_multiprocessor.v without _i and _o.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "isa/counters.hpp"
#include "machine/common/memory.hpp"
#include "machine/common/packages.hpp"

namespace raypool {

inline constexpr uint32_t kMostUnits = 4;  ///< compute units of a device: 1, 2 or 4

enum class ImportKind : uint8_t { None = 0, Normal = 1, Shadow = 2, Direct = 3 };
inline constexpr size_t kImportKinds = 4;

struct LaunchCommand {
  uint32_t pc = 0;       ///< entry, in instructions
  uint32_t threads = 0;  ///< 1 .. warps x lanes
  uint32_t block = 0;    ///< word that `block` reads
  uint32_t blocks = 1;   ///< word that `blocks` reads
  ImportKind import = ImportKind::None;
};

struct MemoryRequest {
  bool write = false;
  uint32_t address = 0;  ///< read: multiple of 64, a line; write: multiple of 16, a quadword
  Beat data{};           ///< write only
  uint8_t mask = 0;      ///< write only: bit i = word i is written
  uint8_t id = 0;        ///< read only: comes back with the response; bits 6:5 are the unit's number, of a write too
};

/// The unit of a memory request or response.
inline uint32_t unit_of_id(uint8_t id) { return id >> 5; }

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
  SubnormalNumber = 8,  ///< of machines with arithmetic.subnormals none
};

struct Fault {
  FaultCode code = FaultCode::None;
  uint32_t warp = 0;
  uint32_t pc = 0;
  uint32_t unit = 0;
};

/// The outputs that a host acts on, as one word: the single ones by their bit, the masks by their lowest one.
namespace signal {
inline constexpr uint32_t kLaunchReady = 1u << 0, kIdle = 1u << 1;
inline constexpr uint32_t kMemoryRequest = 1u << 2, kImportRequest = 1u << 3, kExport = 1u << 4, kFrame = 1u << 5;
inline constexpr uint32_t kFault = 1u << 6;
inline constexpr uint32_t kKernelDone = 1u << 8, kBusy = 1u << 12, kUnitIdle = 1u << 16;
}  // namespace signal

struct UnitInputs {
  bool launch_valid = false;
  LaunchCommand launch;
  bool memory_request_ready = false;
  bool memory_response_valid = false;
  MemoryResponse memory_response;
  bool import_request_ready = false;
  bool import_beat_valid = false;  ///< of packages in the order of their requests, from the cycle after the request on
  Beat import_beat{};
  bool export_ready = false;
  bool frame_ready = false;

  /// The valids of the transfers that the host takes in this cycle.
  uint32_t ready_signals() const {
    return memory_request_ready * signal::kMemoryRequest | import_request_ready * signal::kImportRequest |
           export_ready * signal::kExport | frame_ready * signal::kFrame;
  }
};

/// What goes with a valid means something only while it is set; masks have one bit a unit.
struct UnitOutputs {
  bool launch_ready = false;
  bool idle = true;  ///< every unit: nothing runs, waits, is being exported or stored
  bool memory_request_valid = false;
  bool import_request_valid = false;  ///< wants one package
  bool export_valid = false;
  bool export_last = false;  ///< third beat of a ray
  bool frame_valid = false;
  uint8_t launch_unit = 0;  ///< takes the launch in this cycle; means something while launch_ready
  uint8_t import_request_unit = 0;
  uint8_t export_unit = 0;
  uint8_t frame_unit = 0;
  ImportKind import_request_kind = ImportKind::None;
  uint32_t kernel_done = 0;  ///< mask: one cycle for each kernel that ends
  uint32_t busy = 0;         ///< mask: a kernel is running
  uint32_t unit_idle = 1;    ///< mask: as `idle`, of each unit
  /// [unit] Rays and contributions that its kernels have asked to export since the reset, modulo 2^16. A kernel's are
  /// in it when its kernel_done comes: they have left once as many packages have. No part of signals().
  std::array<uint16_t, kMostUnits> exports{};
  MemoryRequest memory_request;
  Beat export_data{};
  FrameContribution frame;
  Fault fault;  ///< sticky

  uint32_t signals() const {
    return launch_ready * signal::kLaunchReady | idle * signal::kIdle | memory_request_valid * signal::kMemoryRequest |
           import_request_valid * signal::kImportRequest | export_valid * signal::kExport |
           frame_valid * signal::kFrame | (fault.code != FaultCode::None) * signal::kFault |
           kernel_done * signal::kKernelDone | busy * signal::kBusy | unit_idle * signal::kUnitIdle;
  }
};

/// What the trace ports show in this cycle (RTL: retire_*, store_trace_*, ray_trace_*).
struct RetireEvent {
  uint32_t warp = 0;
  uint32_t pc = 0;
  uint64_t instruction = 0;
  uint32_t mask = 0;           ///< thread mask
  std::vector<uint32_t> data;  ///< one word a lane; meaningful in masked lanes when the instruction writes a register
  uint32_t predicate = 0;      ///< value written when the instruction writes a predicate
  uint32_t unit = 0;
  /// Engine `model` only: cycles before this one in which the warp began to want the instruction from the cache, in
  /// which it left the buffer, and in which an ALU was given to it; of a triple, those of this element.
  uint64_t wanted = 0, issued = 0, granted = 0;
  bool last = true;  ///< no element of the same triple is to come; engine `model` only
};
struct StoreEvent {
  uint32_t warp = 0;
  uint32_t address = 0;  ///< multiple of 16
  Beat data{};
  uint8_t mask = 0;
  uint32_t unit = 0;
};
struct RayWriteEvent {
  uint32_t warp = 0;
  uint32_t word = 0;
  uint32_t mask = 0;
  std::vector<uint32_t> data;  ///< one word a lane
  uint32_t unit = 0;
};
struct UnitTrace {
  std::vector<RetireEvent> retired;       ///< rising unit, then warp number
  std::vector<StoreEvent> stores;         ///< rising unit
  std::vector<RayWriteEvent> ray_writes;  ///< rising unit
};

/// A signal inside Verilated RTL: where its value stands, as Verilator keeps it. No
/// data: the engine has no such signal.
struct Signal {
  const void* data = nullptr;
  uint32_t bits = 0;
};

class ComputeUnit {
 public:
  virtual ~ComputeUnit() = default;

  /// Compute units behind these ports: 1, 2 or 4.
  virtual uint32_t units() const { return 1; }

  /// Reset, then set what stays for a program: its length (instructions), the memory's size (bytes).
  virtual void reset(uint32_t program_length, uint32_t memory_limit) = 0;
  /// Writes argument word `index` (0 .. 31). Only while idle.
  virtual void set_argument(uint32_t index, uint32_t value) = 0;

  virtual const UnitOutputs& outputs() const = 0;
  virtual void clock(const UnitInputs& inputs) = 0;
  /// Clocks at least once and at most `cycles` times, and returns how often. Launch, response and beat are of the first
  /// cycle only, the readies of all. It ends early when outputs().signals() is no longer what it was, or when the last
  /// cycle had a transfer. An engine that cannot do it faster than clock() clocks once.
  virtual uint64_t run(const UnitInputs& inputs, uint64_t cycles) {
    static_cast<void>(cycles);
    clock(inputs);
    return 1;
  }

  /// All faults of the cycle that had the first one; of several outputs().fault is the one that wins. A device of which
  /// only its ports are seen knows no other.
  virtual std::vector<Fault> faults() const;

  /// Trace of the current cycle. Filled only after trace_on(); costs time.
  virtual void trace_on() {}
  /// No more of it is wanted until a reset.
  virtual void trace_off() {}
  virtual const UnitTrace& trace() const = 0;

  /// A signal of the instance `scope` (such as "gen_unit[0].compute_unit"); the list probes.vlt has those there are.
  /// Its data is that of the present cycle and stays where it is.
  virtual Signal signal(const std::string& scope, const std::string& name) const;

  virtual uint64_t counter(int number) = 0;  ///< see namespace counter; summed over the units
  /// False for an engine that has no notion of time; its cycles and counters of time mean nothing.
  virtual bool timed() const = 0;

  /// Writes a waveform from now on; throws std::runtime_error where an engine has none.
  virtual void open_waveform(const std::string& path);
};

}  // namespace raypool
