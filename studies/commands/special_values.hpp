// Where infinities and NaNs arise while a frame is drawn: by kernel and instruction.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "isa/program.hpp"
#include "machine/compute/special_census.hpp"

namespace raypool {

struct SpecialValues {
  struct Place {
    std::string kernel, instruction;
    uint32_t pc = 0;
    SpecialCounts counts;
  };
  uint64_t operations = 0;    ///< of float instructions, of a thread each
  uint32_t instructions = 0;  ///< float instructions that were executed
  std::vector<Place> places;  ///< those of them that met one, by PC
};

SpecialValues special_values(const SpecialCensus& census, const Program& program);

/// Lines of a table; one if there is none.
std::string text_of(const SpecialValues& specials);
nlohmann::ordered_json json_of(const SpecialValues& specials);

}  // namespace raypool
