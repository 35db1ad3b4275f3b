#include "chip/chip_device_module.hpp"

#include <chrono>
#include <stdexcept>

namespace raypool::chip {

ChipDeviceModule::ChipDeviceModule(const sc_core::sc_module_name& name, const ChipOptions& options, ChipDevice& chip)
    : sc_module(name), options_(options), board_(options_, chip, *this) {
  memory.bind(nobody_);
  tree.bind(nobody_);
  SC_METHOD(run);
  sensitive << next_cycle_;
  dont_initialize();
}

void ChipDeviceModule::start_of_simulation() { clock_.notify(next_cycle_, Phase::Units, 1); }

void ChipDeviceModule::run() {
  clock_.guard([this] {
    board_.clock();
    if (board_.ended())
      clock_.stop();
    else
      clock_.notify(next_cycle_, Phase::Units, 1);
  });
}

tlm::tlm_blocking_transport_if<>& ChipDeviceModule::of(bool traverser) {
  if (!traverser) return *memory[0];
  if (tree.size() == 0) throw std::logic_error("the traverser asks for memory, and nothing is bound to its socket");
  return *tree[0];
}

uint64_t ChipDeviceModule::read(bool traverser, uint32_t address, Line& line) {
  return transport_.read(of(traverser), clock_, address, line, clock_.cycle()) - clock_.cycle();
}

void ChipDeviceModule::write(bool traverser, const MemoryRequest& request) {
  transport_.write(of(traverser), clock_, request, clock_.cycle());
}

ChipResult ChipDeviceModule::draw() {
  const auto begin = std::chrono::steady_clock::now();
  sc_core::sc_start();
  clock_.rethrow();
  ChipResult result = board_.result();
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace raypool::chip
