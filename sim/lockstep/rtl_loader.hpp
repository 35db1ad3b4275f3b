// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Loads the Verilated compute unit, or chip, that scripts/verilate.sh has built.
#pragma once

#include <memory>
#include <string>

#include "config/configuration.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// The multiprocessor of `units` compute units in shared library `library_path` (OUTPUT_DIR/libraypool_unit.so of
/// scripts/verilate.sh). Several units may come from one library, and libraries of several configurations may be
/// loaded side by side; a library is unloaded with its last unit. Throws InputError when the library is missing, was
/// built for other Verilog parameters than those of `configuration`, or against another version of the compute-unit
/// interface; the message has the command that builds it.
std::unique_ptr<ComputeUnit> load_rtl_unit(const std::string& library_path, const Configuration& configuration,
                                           int units = 1);
/// Likewise of rtl/chip/rp_chip.v: OUTPUT_DIR/libraypool_chip.so of scripts/verilate.sh --top chip.
std::unique_ptr<ChipDevice> load_rtl_chip(const std::string& library_path, const Configuration& configuration,
                                          int units = 1);

}  // namespace raypool
