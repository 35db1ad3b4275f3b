// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_chip.v, cycle by cycle: it joins the classes of the blocks around a device of compute units, of any
// engine.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "machine/chip/chip_device.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/traverser/tree_lines.hpp"

namespace raypool {

class Traverser;

/// `device` fits `configuration`; its units must be timed ones. A clock costs one of the device and some tests: of a
/// block in which nothing happens next to nothing. `own_policy`: makes one of the caller's own for each frame, in place
/// of the one that the configuration names; may be empty.
std::unique_ptr<ChipDevice> make_chip_model(const Configuration& configuration, std::unique_ptr<ComputeUnit> device,
                                            PolicyMaker own_policy = {});

/// For reports of a lockstep: the traverser inside, of which a look inside is kept from now on. Null: `chip` is none of
/// make_chip_model(), or has none. It is another one after each start().
const Traverser* look_inside_traverser(ChipDevice& chip);

/// For measurements, while a frame is drawn: Traverser::remember(). Throws std::logic_error unless `chip` is one of
/// make_chip_model() with a traverser inside.
void remember_lines(ChipDevice& chip, const TreeLines& lines, const std::function<TreeLine(uint32_t line)>& read);

}  // namespace raypool
