// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// From intermediate code to machine code.
#pragma once

#include <string>

#include "isa/program.hpp"
#include "kernel/intermediate.hpp"
#include "kernel/recorded.hpp"
#include "kernel/spill.hpp"
#include "kernel/target.hpp"

namespace raypool::kernel {

/// What the passes do one by one; for tests.
void reuse_values(Function& function);
void remove_idle_writes(Function& function);
void fold_constants(Function& function);
void fold_addresses(Function& function);
void join_conditions(Function& function);
void sink_leaves(Function& function);
void remove_dead(Function& function);
/// Of code under masks that no lane ever has; those must be known before others are joined.
void remove_unreached(Function& function);

/// Machine registers and predicates of a function's virtual ones.
struct Allocation {
  std::vector<int> registers;
  std::vector<int> predicates;
};
/// Throws InputError with kernel and source line when 16 registers or 15 predicates do not suffice.
Allocation allocate(const Function& function);

/// Whether 16 registers, or 15 predicates, suffice.
bool has_places(const Function& function, bool predicates = false);

/// What became of a kernel.
struct CompileCounts {
  int instructions = 0;
  SpillCounts spilled;
  int slots = 0;              ///< of spill memory
  int stores = 0, loads = 0;  ///< instructions that spill values, and that get them back or compute them again
};

/// Appends the kernel to the program, under its name. Values and conditions that find no register or predicate are
/// spilled.
CompileCounts compile(Function function, Program& program, const KernelTarget& target = {});

/// Records a kernel: `body` is called with a RecordedKernel. `layout`: of what the kernel imports.
template <typename Body>
Function record_kernel(const std::string& name, const Body& body, const KernelTarget& target = {},
                       const RecordLayout& layout = {}) {
  Recorder recorder(name, target.fma);
  RecordedKernel kernel(recorder, target.culling, layout);
  body(kernel);
  Function function = recorder.finish();
  // A machine with compact records has as many words as the layout, or as a ray.
  const bool whole = layout.words == static_cast<uint32_t>(kIntersectionWords);
  if (target.compact) function.slice_words = whole ? kRayWords : static_cast<int>(layout.words);
  return function;
}

/// Records and compiles it.
template <typename Body>
CompileCounts add_kernel(Program& program, const std::string& name, const Body& body, const KernelTarget& target = {},
                         const RecordLayout& layout = {}) {
  return compile(record_kernel(name, body, target, layout), program, target);
}

}  // namespace raypool::kernel
