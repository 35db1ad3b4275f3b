// Writes down what a unit gets and shows in every cycle, so that another simulator can
// replay it: tb/icarus/unit_replay.v.
#pragma once

#include <memory>
#include <ostream>

#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// Wraps `unit`; its trace must be on whenever it is clocked. A line a cycle in `out`, which must outlive the unit:
/// inputs, expected outputs and, bit by bit, which of them count, as hexadecimal numbers. The fields are those of
/// unit_replay.v, in its order, the first one in the highest bits. Valids always count; a payload counts while it is
/// valid, of a retirement the lanes that it writes.
std::unique_ptr<ComputeUnit> make_vector_recorder(const Configuration& configuration, std::unique_ptr<ComputeUnit> unit,
                                                  std::ostream& out);

}  // namespace raypool
