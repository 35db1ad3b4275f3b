#include "chip/tree_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "isa/input_error.hpp"
#include "scene/tree_file.hpp"

namespace raypool {

namespace {

constexpr uint64_t kLine = 64;
constexpr uint64_t kStack = 4096;  // of a slot

uint64_t round_up(uint64_t bytes, uint64_t to) { return (bytes + to - 1) / to * to; }
uint64_t power_of_two_from(uint64_t least) {
  uint64_t power = 1;
  while (power < least) power *= 2;
  return power;
}

template <typename Item>
void store(Memory& memory, uint64_t address, const Item& item) {
  static_assert(sizeof item % 4 == 0);
  uint32_t words[sizeof item / 4];
  std::memcpy(words, &item, sizeof item);
  for (const uint32_t word : words) {
    memory.store(static_cast<uint32_t>(address), word);
    address += 4;
  }
}

}  // namespace

TreeImage make_tree_image(const Scene& scene, const Bvh& bvh, const ChipConfiguration& chip, uint32_t material_base) {
  const TreeFile tree = make_tree_file(scene, bvh);
  const uint64_t triangles = tree.nodes.size() * sizeof(TreeNode);
  const uint64_t stacks = round_up(triangles + tree.triangles.size() * sizeof(TreeTriangle), kStack);
  const uint32_t lanes = chip.hardware_traverser_lanes, slots = chip.hardware_traverser_rays / lanes;
  // A lane with one slot has a bit for its number all the same.
  const uint64_t bytes = stacks + power_of_two_from(lanes) * power_of_two_from(std::max(2u, slots)) * kStack;
  if (bytes > UINT32_MAX) {
    throw InputError(fmt::format("{}: the tree of {} triangles does not fit in the traverser's memory of 4 GB",
                                 scene.name, scene.triangles.size()));
  }
  TreeImage image{Memory(static_cast<uint32_t>(bytes)), {}};
  for (size_t i = 0; i < tree.nodes.size(); ++i) store(image.memory, i * sizeof(TreeNode), tree.nodes[i]);
  for (size_t i = 0; i < tree.triangles.size(); ++i) {
    TreeTriangle triangle = tree.triangles[i];
    if (scene.materials[triangle.material].reflects()) triangle.material |= kReflectingMaterial;
    store(image.memory, triangles + i * sizeof triangle, triangle);
  }
  TreeSetup& setup = image.setup;
  setup.root = tree.header.root;
  std::copy_n(tree.header.lower, 3, setup.bounds.lower);
  std::copy_n(tree.header.upper, 3, setup.bounds.upper);
  setup.triangles_line = static_cast<uint32_t>(triangles / kLine);
  setup.triangle_lines = static_cast<uint32_t>(round_up(tree.triangles.size() * sizeof(TreeTriangle), kLine) / kLine);
  setup.stacks_line = static_cast<uint32_t>(stacks / kLine);
  setup.material_base = material_base;
  return image;
}

TreeLines lines_of(const VisitList& places) {
  TreeLines lines;
  for (const Visit& place : places) {
    if (place.triangles == 0) {
      lines.nodes.push_back(place.place);
      continue;
    }
    const uint64_t first = place.place * sizeof(TreeTriangle), end = first + place.triangles * sizeof(TreeTriangle);
    for (uint64_t line = first / kLine; line * kLine < end; ++line)
      lines.triangles.push_back(static_cast<uint32_t>(line));
  }
  return lines;
}

}  // namespace raypool
