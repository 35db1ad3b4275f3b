#include "machine/function_unit.hpp"

#include <array>

namespace raypool {

const FunctionUnit* function_unit(Unit unit) {
  static const std::array<const FunctionUnit*, kUnits> kModels = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) nullptr,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) &unit_model<Unit::type>(),
      RAYPOOL_UNITS(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
  };
  return kModels[static_cast<size_t>(unit)];
}

}  // namespace raypool
