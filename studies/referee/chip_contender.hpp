// The answers of a whole chip, each case a frame: its ray goes from a kernel through the pools to the traverser and
// what it hits comes back to a kernel.
#pragma once

#include <memory>
#include <string>

#include "chip/board.hpp"
#include "config/configuration.hpp"
#include "referee/contender.hpp"

namespace raypool::referee {

/// `configuration`: of a chip with its traverser inside and whole records of intersections.
std::unique_ptr<Contender> chip_answers(std::string name, const Configuration& configuration, const ChipMaker& make);

}  // namespace raypool::referee
