#include "machine/compute/model.hpp"

#include <memory>
#include <utility>

#include "machine/compute/multiprocessor.hpp"

namespace raypool {

Model make_model(const Configuration& configuration, const Memory& memory, uint32_t units) {
  Model model;
  std::vector<std::unique_ptr<ComputeUnit>> parts;
  const auto shared = std::make_shared<ModelMemory>(memory);
  for (uint32_t unit = 0; unit < units; ++unit) {
    auto part = std::make_unique<CycleUnit>(configuration, shared, unit);
    model.units.push_back(part.get());
    parts.push_back(std::move(part));
  }
  model.device = make_multiprocessor(std::move(parts), static_cast<int>(configuration.intersection_beats()));
  return model;
}

}  // namespace raypool
