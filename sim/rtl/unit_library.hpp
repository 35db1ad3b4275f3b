// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a shared library with a Verilated design exports, and how its loader knows that both were compiled from the same
// interface. Here of a multiprocessor, in chip_library.hpp of a chip.
#pragma once

#include <initializer_list>
#include <string>

#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// Raised when the meaning of compute_unit.hpp changes in a way that its sizes do not show.
inline constexpr int kUnitInterfaceVersion = 3;

inline std::string interface_text(int version, std::initializer_list<size_t> sizes) {
  std::string text = "version " + std::to_string(version) + ", sizes";
  for (const size_t size : sizes) text += ' ' + std::to_string(size);
  return text;
}
inline std::string unit_interface() {
  return interface_text(kUnitInterfaceVersion,
                        {sizeof(Configuration), sizeof(LaunchCommand), sizeof(UnitInputs), sizeof(UnitOutputs),
                         sizeof(UnitTrace), sizeof(RetireEvent), sizeof(StoreEvent), sizeof(RayWriteEvent)});
}

/// Makes the device; the caller deletes it.
template <typename Device>
using Create = Device*(const Configuration&);
using LibraryText = const char*();

/// The exported functions' names.
struct LibraryNames {
  const char* what;        ///< for messages
  const char* create;      ///< a Create
  const char* parameters;  ///< a LibraryText: "WARPS=8 LANES=8 ..."; without UNITS it has one unit
  const char* interface;   ///< another one: the interface that it was compiled from
};
inline constexpr LibraryNames kUnitLibrary = {"compute unit", "raypool_create_unit", "raypool_unit_parameters",
                                              "raypool_unit_interface"};

}  // namespace raypool
