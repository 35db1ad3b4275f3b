// The machines of `make cosim`: few and tiny, and together they have whatever a unit may have. And what one machine
// lacks, so that its random programs cannot try it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cosim/covering.hpp"

namespace raypool {

/// Something that a machine has or has not, and without which part of the Verilog is not there or never at work.
struct MachineFeature {
  std::string_view name;
  bool (*has)(const Machine& machine);
};
const std::vector<MachineFeature>& machine_features();

/// Names of the features that none of the machines has, in the order of machine_features().
std::vector<std::string> features_lacking(const std::vector<Machine>& machines);

/// Values that covering_factors() would try and none of the machines has, "warps 1, 8, 32"; ALUs left out: their
/// features stand in machine_features().
std::vector<std::string> values_lacking(const std::vector<Machine>& machines);

/// What `raypool cosim` runs when no machine is named: configurations of configs/cosim/ in the data folder, which
/// together have every machine_features(). Throws InputError when a file is missing or wrong.
std::vector<Machine> cosim_machines();

/// "4 x 2w1c_units", or the configuration's name alone of one unit.
std::string name_of(const Machine& machine);

}  // namespace raypool
