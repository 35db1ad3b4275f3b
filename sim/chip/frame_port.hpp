// The frame buffer's port (cpp_model/machine/frame_port.hpp): takes one contribution a cycle, a unit's first.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/ports.hpp"
#include "machine/frame_port.hpp"

namespace raypool::chip {

class FramePort : public sc_core::sc_module, public ContributionIf, public DirectContributionIf {
 public:
  /// `frame` must outlive the port.
  FramePort(const sc_core::sc_module_name& name, FrameSink& frame) : sc_module(name), frame_(frame) {
    device.bind(*this);
    traverser.bind(*this);
  }

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_export<ContributionIf> device{"device"};
  sc_core::sc_export<DirectContributionIf> traverser{"traverser"};

  /// Throws std::runtime_error when the contribution is of a pixel that the unit has nothing to do with.
  void take(uint32_t unit, const FrameContribution& contribution) override {
    ledger->contribution_exported(unit, contribution.pixel);
    add(contribution);
  }
  bool offer(const FrameContribution& contribution) override {
    if (!port_.ready(clock->cycle())) return false;
    add(contribution);
    return true;
  }
  uint64_t taken() const { return port_.taken(); }

 private:
  // The frame buffer takes it in the next cycle; nobody looks at a sum before the end, so it has it at once.
  void add(const FrameContribution& contribution) {
    port_.take(clock->cycle(), contribution);
    frame_.add(port_.data());
    port_.leave();
  }

  FrameSink& frame_;
  raypool::FramePort port_;
};

}  // namespace raypool::chip
