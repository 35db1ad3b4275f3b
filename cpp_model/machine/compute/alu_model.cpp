#include "machine/compute/alu_model.hpp"

#include "enum_array.hpp"

namespace raypool {

const AluModel* find_alu_model(AluType type) {
  static const EnumArray<AluType, const AluModel*, kAluTypes> kModels = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) nullptr,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) &alu_model<AluType::type>(),
      RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
  };
  return kModels[type];
}

}  // namespace raypool
