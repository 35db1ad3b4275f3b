#include "chip/host_registers.hpp"

#include "bits.hpp"

namespace raypool::chip {

void HostRegisters::set(const FrameSetup& setup) {
  using namespace host_register;
  store(kProgramLength, setup.program_length);
  store(kMemoryLimit, setup.memory_limit);
  store(kWidth, setup.width);
  store(kHeight, setup.height);
  store(kDepth, setup.depth);
  store(kReflections, setup.reflections ? 1 : 0);
  for (uint32_t i = 0; i < kRayKernels; ++i) store(kEntries + 4 * i, setup.entries[i]);
  store(kTreeRoot, setup.tree.root);
  for (uint32_t i = 0; i < 3; ++i) {
    store(kTreeLower + 4 * i, as_bits(setup.tree.bounds.lower[i]));
    store(kTreeUpper + 4 * i, as_bits(setup.tree.bounds.upper[i]));
  }
  store(kTrianglesLine, setup.tree.triangles_line);
  store(kTriangleLines, setup.tree.triangle_lines);
  store(kStacksLine, setup.tree.stacks_line);
  store(kMaterialBase, setup.tree.material_base);
  const std::array<uint8_t, kIntersectionWords> record = words_of(setup.tree.layout);
  for (uint32_t i = 0; i < record.size(); ++i) store(kRecord + 4 * i, record[i]);
  for (uint32_t i = 0; i < setup.arguments.size(); ++i) store(host_register::kArguments + 4 * i, setup.arguments[i]);
}

FrameSetup HostRegisters::setup(uint32_t record_words) const {
  using namespace host_register;
  FrameSetup setup;
  setup.program_length = load(kProgramLength);
  setup.memory_limit = load(kMemoryLimit);
  setup.width = load(kWidth);
  setup.height = load(kHeight);
  setup.depth = load(kDepth);
  setup.reflections = (load(kReflections) & 1) != 0;
  for (uint32_t i = 0; i < kRayKernels; ++i) setup.entries[i] = load(kEntries + 4 * i);
  setup.tree.root = load(kTreeRoot);
  for (uint32_t i = 0; i < 3; ++i) {
    setup.tree.bounds.lower[i] = as_float(load(kTreeLower + 4 * i));
    setup.tree.bounds.upper[i] = as_float(load(kTreeUpper + 4 * i));
  }
  setup.tree.triangles_line = load(kTrianglesLine);
  setup.tree.triangle_lines = load(kTriangleLines);
  setup.tree.stacks_line = load(kStacksLine);
  setup.tree.material_base = load(kMaterialBase);
  setup.tree.layout.words = record_words;
  setup.tree.layout.place.fill(RecordLayout::kAbsent);
  for (uint32_t i = 0; i < kIntersectionWords; ++i)
    if (const uint32_t word = load(kRecord + 4 * i); word < kIntersectionWords)
      setup.tree.layout.place[word] = static_cast<uint8_t>(i);
  for (uint32_t i = 0; i < setup.arguments.size(); ++i) setup.arguments[i] = load(host_register::kArguments + 4 * i);
  return setup;
}

}  // namespace raypool::chip
