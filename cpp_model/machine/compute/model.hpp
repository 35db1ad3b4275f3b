// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The golden model as a device: cycle-accurate compute units behind the arbiters of the multiprocessor.
#pragma once

#include <memory>
#include <vector>

#include "machine/compute/cycle_unit.hpp"

namespace raypool {

struct Model {
  std::unique_ptr<ComputeUnit> device;
  std::vector<CycleUnit*> units;  ///< of the device
};

/// `memory` as for ModelMemory, which all units share. Throws InputError unless `units` is 1, 2 or 4.
Model make_model(const Configuration& configuration, const Memory& memory, uint32_t units);

}  // namespace raypool
