// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a shared library with a Verilated chip exports.
#pragma once

#include "machine/chip/chip_device.hpp"
#include "rtl/unit_library.hpp"

namespace raypool {

/// Raised when the meaning of chip_device.hpp changes in a way that its sizes do not show.
inline constexpr int kChipInterfaceVersion = 4;

inline std::string chip_interface() {
  return interface_text(kChipInterfaceVersion, {sizeof(Configuration), sizeof(FrameSetup), sizeof(ChipInputs),
                                                sizeof(ChipOutputs), sizeof(UnitOutputs), sizeof(ChipCounts)});
}

inline constexpr LibraryNames kChipLibrary = {"chip", "raypool_create_chip", "raypool_chip_parameters",
                                              "raypool_chip_interface"};

}  // namespace raypool
