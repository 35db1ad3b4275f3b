// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a kernel asks of a machine, from its machine code alone: how long a warp takes when nothing is in its way, and
// what it occupies.
#pragma once

#include <vector>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/assembler.hpp"
#include "machine/chip/ray_kernel.hpp"

namespace raypool::estimate {

/// Instructions of a warp between two places where it exchanges packages, or waits to.
struct Segment {
  double serial = 0;                             ///< cycles of a warp that is alone, from its first to its last one
  double instructions = 0;                       ///< issued: a lookup in the instruction cache each
  EnumArray<AluType, double, kAluTypes> busy{};  ///< cycles in which an instance of the type takes no other task
  EnumArray<AluType, double, kAluTypes> tasks{};
};

/// What ends a segment.
enum class Exchange : uint8_t { Import, ExportRays, Contribute, End };

struct KernelCosts {
  std::vector<Segment> segments;
  std::vector<Exchange> exchanges;  ///< behind each segment; the last one is End
};

/// `name` must be a kernel of the program. Every conditional jump is taken to fall through, as it does where at least
/// one thread takes part. Timing is that of docs/machine/architecture.md, section 3, with loads that hit.
KernelCosts costs_of(const Program& program, std::string_view name, const Configuration& configuration);

}  // namespace raypool::estimate
