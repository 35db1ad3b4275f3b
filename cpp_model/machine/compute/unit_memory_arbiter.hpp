// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_unit_memory_arbiter.v: joins the memory ports of several units. present() and clock() as those of
// PortArbiter.
#pragma once

#include "machine/compute/compute_unit.hpp"
#include "machine/compute/port_arbiter.hpp"

namespace raypool {

class UnitMemoryArbiter {
 public:
  void present(uint32_t valids) { port_.present(valids); }
  bool valid() const { return port_.valid(); }
  uint32_t choice() const { return port_.choice(); }  ///< means something while valid()
  void clock(bool ready) { port_.clock(ready); }

  /// A request's id grows by the unit's number, and a response goes to the unit that its id names.
  static uint8_t id_of_unit(uint8_t id, uint32_t unit) { return static_cast<uint8_t>(id | unit << 5); }
  static uint32_t response_unit(uint8_t id) { return unit_of_id(id); }
  static uint8_t response_id(uint8_t id) { return id & 31; }

 private:
  PortArbiter port_;
};

}  // namespace raypool
