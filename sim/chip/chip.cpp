#include "chip/chip.hpp"

#include <fmt/format.h>

#include "bits.hpp"

namespace raypool {

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

}  // namespace raypool
