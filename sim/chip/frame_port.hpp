// The frame buffer's port: takes one contribution a cycle, a unit's first.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/ports.hpp"

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
    if (clock->cycle() < free_from_) return false;
    add(contribution);
    return true;
  }
  uint64_t taken() const { return taken_; }

 private:
  void add(const FrameContribution& contribution) {
    frame_.add(contribution);
    ++taken_;
    free_from_ = clock->cycle() + 1;
  }

  FrameSink& frame_;
  uint64_t taken_ = 0, free_from_ = 0;
};

}  // namespace raypool::chip
