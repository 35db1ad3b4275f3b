// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The order of a kernel's operations, so that few values are held at once.
#pragma once

#include "kernel/intermediate.hpp"

namespace raypool::kernel {

/// Puts operations between two labels, jumps or loops in an order in which few registers are held: what a store or an
/// export needs is computed right before it, the larger part first, and what ends more values than it begins as soon as
/// it can. A warp waits for each of its instructions, so that the order costs no time. Changes nothing that is
/// computed.
void schedule(Function& function);

/// Takes away jumps over so few operations that they cost more time than they save.
void remove_short_jumps(Function& function);

}  // namespace raypool::kernel
