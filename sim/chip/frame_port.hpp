// The frame buffer's port: takes one contribution a cycle, always.
#pragma once

#include <cstdint>

#include "chip/pixel_ledger.hpp"
#include "chip/ports.hpp"

namespace raypool::chip {

class FramePort {
 public:
  /// `ledger` and `frame` must outlive the port.
  FramePort(PixelLedger& ledger, FrameSink& frame) : ledger_(ledger), frame_(frame) {}

  /// Throws std::runtime_error when the contribution is of a pixel that the unit has nothing to do with.
  void take(uint32_t unit, const FrameContribution& contribution) {
    ledger_.contribution_exported(static_cast<int>(unit), contribution.pixel);
    frame_.add(contribution);
    ++taken_;
  }
  uint64_t taken() const { return taken_; }

 private:
  PixelLedger& ledger_;
  FrameSink& frame_;
  uint64_t taken_ = 0;
};

}  // namespace raypool::chip
