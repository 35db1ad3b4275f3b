// Callable shaders: each is recorded where it is called, once for every shader that the number may be.
#include <fmt/format.h>

#include <algorithm>

#include "shader/lowering.hpp"

namespace raypool::shader {

void Lowering::execute_callable(const Line& line) {
  static const Callables kNone;
  const Callables& all = recording_.callables != nullptr ? *recording_.callables : kNone;
  const Scalar index = get_scalar(line.operands.at(0));
  if (all.empty()) fail("executeCallableEXT calls a shader, and the set has none: add a file with the ending .rcall");
  if (index.is_constant() && index.bits >= all.size())
    fail(fmt::format("executeCallableEXT names callable shader {}, and the set has {}", index.bits, all.size()));
  const Pointer data = pointer_of(line.operands.at(1));
  const kernel::Location place = where_;
  for (uint32_t i = 0; i < all.size(); ++i) {
    const Scalar chosen = compare(Opcode::Ieq, index, Scalar::constant(i));
    if (chosen == Scalar::constant(0)) continue;
    std::vector<const Module*>& called = recording_.called;
    if (std::find(called.begin(), called.end(), all[i]) != called.end())
      fail("a callable shader calls itself, and there is no stack for it: write it as a loop");
    called.push_back(all[i]);
    under(chosen, [&] {
      Lowering callable(*all[i], resources_, kernel_, recording_);
      Value result = callable.run_callable(load_from(data));
      result.resize(module_.scalars(data.type));
      recorder_.set_place(place);
      store_to(data, result);
    });
    // Other lanes have what they had.
    for (size_t scalar = 0; scalar < variable(data.variable).size(); ++scalar)
      way_.known.erase({data.variable, scalar});
    called.pop_back();
  }
}

Value Lowering::run_callable(const Value& data) {
  const Waits none;
  waits_ = &none;
  callable_data_ = data;
  constants();
  begin_variables();
  region(module_.blocks().front().label, kEnd);
  waits_ = nullptr;
  Value result;
  for (const auto& [id, variable] : module_.variables()) {
    if (variable.storage == spv::StorageClass::IncomingCallableDataKHR) result = this->variable(id);
  }
  return result;
}

}  // namespace raypool::shader
