// The frame buffer's port: takes one contribution a cycle, always.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/interfaces.hpp"
#include "chip/ports.hpp"

namespace raypool::chip {

class FramePort : public sc_core::sc_module, public ContributionIf {
 public:
  /// `frame` must outlive the port.
  FramePort(const sc_core::sc_module_name& name, FrameSink& frame) : sc_module(name), frame_(frame) {
    device.bind(*this);
  }

  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_export<ContributionIf> device{"device"};

  /// Throws std::runtime_error when the contribution is of a pixel that the unit has nothing to do with.
  void take(uint32_t unit, const FrameContribution& contribution) override {
    ledger->contribution_exported(unit, contribution.pixel);
    frame_.add(contribution);
    ++taken_;
  }
  uint64_t taken() const { return taken_; }

 private:
  FrameSink& frame_;
  uint64_t taken_ = 0;
};

}  // namespace raypool::chip
