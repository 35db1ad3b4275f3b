// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// From intermediate code to machine code.
#pragma once

#include <string>

#include "isa/program.hpp"
#include "kernel/intermediate.hpp"
#include "kernel/recorded.hpp"
#include "kernel/target.hpp"

namespace raypool::kernel {

/// What the passes do one by one; for tests.
void fold_constants(Function& function);
void fold_addresses(Function& function);
void join_conditions(Function& function);
void sink_leaves(Function& function);
void remove_dead(Function& function);

/// Machine registers and predicates of a function's virtual ones.
struct Allocation {
  std::vector<int> registers;
  std::vector<int> predicates;
};
/// Throws InputError with kernel and source line when 16 registers or 15 predicates do not suffice.
Allocation allocate(const Function& function);

/// Whether 16 registers suffice.
bool has_places(const Function& function);

/// Appends the kernel to the program, under its name.
void compile(Function function, Program& program, const KernelTarget& target = {});

/// Records a kernel: `body` is called with a RecordedKernel. `layout`: of what the kernel imports.
template <typename Body>
Function record_kernel(const std::string& name, const Body& body, const KernelTarget& target = {},
                       const RecordLayout& layout = {}) {
  Recorder recorder(name, target.fma);
  RecordedKernel kernel(recorder, target.culling, layout);
  body(kernel);
  return recorder.finish();
}

/// Records and compiles it.
template <typename Body>
void add_kernel(Program& program, const std::string& name, const Body& body, const KernelTarget& target = {},
                const RecordLayout& layout = {}) {
  compile(record_kernel(name, body, target, layout), program, target);
}

}  // namespace raypool::kernel
