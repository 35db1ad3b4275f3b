#include "chip/chip.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "chip/chip_module.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/module_tree.hpp"
#include "chip/simulation.hpp"

namespace raypool {

namespace {

/// The chip with its own memory.
struct System {
  explicit System(const ChipOptions& options)
      : chip("chip", options), memory("memory", *options.memory, options.configuration.chip.memory_latency) {
    chip.memory.bind(memory.socket);
  }

  chip::Simulation simulation;
  chip::Chip chip;
  chip::FixedLatencyMemory memory;
};

}  // namespace

std::string fault_sentence(uint32_t unit, const Fault& fault) {
  const char* meaning = "of an unknown kind";
  switch (fault.code) {
    case FaultCode::None:
      meaning = "of no kind";
      break;
    case FaultCode::IllegalInstruction:
      meaning = "illegal instruction";
      break;
    case FaultCode::PcOutsideProgram:
      meaning = "PC outside the program";
      break;
    case FaultCode::StackOverflow:
      meaning = "PC stack overflow: calls and loops are nested too deep";
      break;
    case FaultCode::StackUnderflow:
      meaning = "PC stack underflow: ret without call";
      break;
    case FaultCode::Misaligned:
      meaning = "address that is not a multiple of 4";
      break;
    case FaultCode::AddressOutsideMemory:
      meaning = "address outside the memory";
      break;
    case FaultCode::RayWordOutside:
      meaning = "ray word that an intersection has not";
      break;
    case FaultCode::SubnormalNumber:
      meaning = "subnormal number, of which the machine has none";
      break;
  }
  return fmt::format("compute unit {} stopped with fault {} ({}) in warp {} at PC {}", unit, to_underlying(fault.code),
                     meaning, fault.warp, fault.pc);
}

ChipResult run_chip(const ChipOptions& options) { return System(options).chip.draw(); }

std::string chip_modules(const ChipOptions& options) {
  const System system(options);
  return chip::module_tree();
}

}  // namespace raypool
