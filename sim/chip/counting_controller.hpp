// The controller as rtl/controller.v has it (cpp_model/machine/controller.hpp): it counts what is under way from the
// pools' levels and what leaves the units, knows of no pixels, and what it decides is offered four cycles later.
#pragma once

#include <cstdint>
#include <systemc>

#include "chip/controller.hpp"
#include "machine/controller.hpp"
#include "machine/timed_tiles.hpp"

namespace raypool::chip {

class CountingController : public Controller {
 public:
  SC_HAS_PROCESS(CountingController);
  CountingController(const sc_core::sc_module_name& name, const ChipOptions& options);

  void changed() override { look_soon(); }
  void level_changed() override { look_soon(); }
  void ray_left(uint32_t unit, bool shadow) override;
  void contribution_left(uint32_t unit) override;
  void kernel_ended(uint32_t unit) override;

 private:
  uint32_t held() const override { return counts_.held(levels()); }
  uint32_t rays_to_come() const override { return counts_.rays_to_come(); }
  raypool::Controller::Tiles tiles();
  void look_soon();
  void look();
  void act();

  raypool::Controller counts_;
  TimedTiles walk_;  // says when a tile is there; which one it is, next_tile_
  raypool::Controller::Launch launch_;
  bool ending_ = false;
  uint64_t look_from_ = 0;  // what comes before is not decided on
  sc_core::sc_event look_, act_;
};

}  // namespace raypool::chip
