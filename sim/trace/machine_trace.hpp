// What a device did in a window of cycles, to be looked at: when each instruction of each warp was fetched, waited and
// was executed, and what passed its ports. Cycles are the device's, which stands still while it is idle.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "enum_array.hpp"
#include "isa/isa.hpp"

namespace raypool::trace {

inline constexpr uint64_t kMostCycles = 1'000'000;  ///< of a window: some 300 bytes an instruction

struct Window {
  uint64_t from = 0;
  uint64_t cycles = 20'000;
  /// x in bits 15:0, y in bits 31:16: the window is then around the cycle in which the first ray of this pixel leaves
  /// the device, and `from` means nothing.
  std::optional<uint32_t> pixel;
};

/// "FROM:CYCLES" or "pixel:X,Y" or "pixel:X,Y:CYCLES"; of the first either may be left out. Throws InputError with the
/// reason.
Window parse_window(const std::string& text);

/// An instruction that a warp has executed; of a triple, all three.
struct InstructionSpan {
  uint32_t unit = 0, warp = 0;
  uint32_t pc = 0;
  uint64_t encoding = 0;
  uint32_t threads = 0;
  uint64_t wanted = 0;   ///< cycle from which the warp wanted it from the instruction cache
  uint64_t issued = 0;   ///< it left the instruction buffer, and its operands were read
  uint64_t granted = 0;  ///< an ALU was given to it, which has it from the next cycle on
  uint64_t retired = 0;
};

/// Row of its instruction in the table.
const InstructionInfo& info_of(const InstructionSpan& span);

enum class Port : uint8_t { Launch, Memory, Response, Request, Import, Export, Frame };
inline constexpr size_t kPorts = 7;

/// Something that passed a port, or waited at it, in cycles `from` to `to`, which is not included.
struct Transfer {
  Port port = Port::Launch;
  uint32_t unit = 0;
  bool waits = false;
  uint64_t from = 0, to = 0;
  std::string what;
};

struct MachineTrace {
  std::string configuration;
  uint32_t units = 1, warps = 0, lanes = 0;
  std::map<uint32_t, std::string> kernels;    ///< by entry PC
  uint64_t from = 0, to = 0;                  ///< cycles; `to` is not included
  std::vector<InstructionSpan> instructions;  ///< by cycle of retirement, then unit and warp
  std::vector<Transfer> transfers;            ///< by their first cycle

  /// The kernel that has the instruction at this PC, if one has.
  std::string kernel_of(uint32_t pc) const;
};

/// Trace Event JSON, as Perfetto and chrome://tracing open it: a track a warp and a port, a microsecond a cycle.
std::string to_trace_events(const MachineTrace& trace);
/// A Kanata log, version 4, for the pipeline viewer Konata.
std::string to_kanata(const MachineTrace& trace);

}  // namespace raypool::trace
