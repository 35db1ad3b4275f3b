// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the RTL of the chip and its model show in a cycle, port by port, each port under the block that drives it.
#pragma once

#include "lockstep/mismatch.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool::lockstep {

/// Of a chip with so many kinds of intersections. Throws Mismatch: its title names the first block and port that
/// differ, with both values; its details have all of them. What goes with a valid counts only while it is set.
void compare_chip(const ChipOutputs& rtl, const ChipOutputs& model, uint32_t kinds);

/// At the end of a frame.
void compare_counts(const ChipCounts& rtl, const ChipCounts& model);

}  // namespace raypool::lockstep
