// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Engine `functional`: a compute unit that runs machine code without a notion of
// time, behind the same ports as the RTL.
#pragma once

#include <memory>

#include "config/configuration.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class SpecialCensus;

/// A functional compute unit. It reads and writes `memory` directly (which must outlive it), so its memory port stays
/// silent; launches, imports, exports and frame contributions obey the handshakes of compute_unit.hpp, one beat a
/// clock. One clock() runs every warp until it waits for a port, ends, or has executed some thousand instructions;
/// after trace_on() at most one instruction a warp. At most one kernel ends in a clock. The program must lie in memory
/// when the first kernel after reset() is launched. timed() is false; counters hold instructions, thread instructions
/// and tasks issued of each ALU type; kBusyCycles counts clocks, all others read 0.
std::unique_ptr<ComputeUnit> make_functional_unit(const Configuration& configuration, Memory& memory);
/// 1, 2 or 4 of them as one device.
std::unique_ptr<ComputeUnit> make_functional_units(const Configuration& configuration, Memory& memory, uint32_t units);
/// The same, but counts infinities and NaNs in `census`, which must outlive it, and takes longer.
std::unique_ptr<ComputeUnit> make_counting_functional_unit(const Configuration& configuration, Memory& memory,
                                                           SpecialCensus& census);

}  // namespace raypool
