// rtl/chip.v, cycle by cycle: it joins the classes of the blocks around a device of compute units, of any engine.
#pragma once

#include <memory>

#include "machine/chip_device.hpp"

namespace raypool {

/// `device` fits `configuration`; its units must be timed ones. A clock costs one of the device and some tests: of a
/// block in which nothing happens next to nothing.
std::unique_ptr<ChipDevice> make_chip_model(const Configuration& configuration, std::unique_ptr<ComputeUnit> device);

}  // namespace raypool
