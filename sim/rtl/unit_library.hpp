// What a shared library with a Verilated multiprocessor exports, and how its loader knows that both
// were compiled from the same interface.
#pragma once

#include <string>

#include "machine/compute_unit.hpp"

namespace raypool {

/// Raised when the meaning of compute_unit.hpp changes in a way that its sizes do not show.
inline constexpr int kUnitInterfaceVersion = 3;

inline std::string unit_interface() {
  std::string text = "version " + std::to_string(kUnitInterfaceVersion) + ", sizes";
  for (const size_t size : {sizeof(Configuration), sizeof(LaunchCommand), sizeof(UnitInputs), sizeof(UnitOutputs),
                            sizeof(UnitTrace), sizeof(RetireEvent), sizeof(StoreEvent), sizeof(RayWriteEvent)}) {
    text += ' ' + std::to_string(size);
  }
  return text;
}

// Types of the exported functions; the names follow.
using CreateUnit = ComputeUnit*(const Configuration&);  ///< the caller deletes the unit
using UnitText = const char*();
inline constexpr const char* kCreateUnitName = "raypool_create_unit";
inline constexpr const char* kUnitParametersName =
    "raypool_unit_parameters";  ///< "WARPS=8 LANES=8 ..."; without UNITS it has one unit
inline constexpr const char* kUnitInterfaceName = "raypool_unit_interface";  ///< unit_interface() of the library

}  // namespace raypool
