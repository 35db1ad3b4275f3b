// rtl/chip.v, cycle by cycle: it joins the classes of the blocks around a device of compute units, of any engine.
#pragma once

#include <memory>

#include "machine/chip_device.hpp"

namespace raypool {

class Traverser;

/// `device` fits `configuration`; its units must be timed ones. A clock costs one of the device and some tests: of a
/// block in which nothing happens next to nothing.
std::unique_ptr<ChipDevice> make_chip_model(const Configuration& configuration, std::unique_ptr<ComputeUnit> device);

/// For reports of a lockstep: the traverser inside, of which a look inside is kept from now on. Null: `chip` is none of
/// make_chip_model(), or has none. It is another one after each start().
const Traverser* look_inside_traverser(ChipDevice& chip);

}  // namespace raypool
