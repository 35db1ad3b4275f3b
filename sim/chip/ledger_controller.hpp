// The controller that asks the ledger of pixels, and decides without delay: a kernel that it chooses in cycle c is
// offered in c+1. A pixel is held until nothing of it is left, its last shadow ray included.
#pragma once

#include <cstdint>
#include <memory>
#include <systemc>

#include "chip/controller.hpp"
#include "machine/launch_rules.hpp"

namespace raypool::chip {

class LedgerController : public Controller {
 public:
  SC_HAS_PROCESS(LedgerController);
  LedgerController(const sc_core::sc_module_name& name, const ChipOptions& options);

  void changed() override { clock->notify(decide_, Phase::Controller); }

 private:
  uint32_t held() const override { return ledger->held(); }
  uint32_t rays_to_come() const override { return ledger->rays_to_come(); }
  void decide();
  PolicyView view(bool ahead) const;
  bool eye_possible() const;
  void launch(const Choice& choice, const PolicyView& seen);

  std::unique_ptr<KernelPolicy> policy_;
  LaunchRules rules_;
  sc_core::sc_event decide_;
};

}  // namespace raypool::chip
