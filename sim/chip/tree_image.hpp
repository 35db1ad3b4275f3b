// The memory of a traverser in hardware: the tree's nodes from address 0 on, its triangles, and the stacks of the rays.
#pragma once

#include <cstdint>

#include "config/configuration.hpp"
#include "machine/common/memory.hpp"
#include "machine/traverser/tree_lines.hpp"
#include "machine/traverser/tree_setup.hpp"
#include "scene/bvh.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

struct TreeImage {
  Memory memory;
  TreeSetup setup;  ///< all but the layout
};

/// Of a triangle's word of its material: it reflects.
inline constexpr uint32_t kReflectingMaterial = 1u << 31;

/// `bvh` is over this scene's triangles (scene/tree_file.hpp); the stacks are those of the traverser of `chip`.
/// `material_base`: of the records in the kernels' memory. Throws InputError if it does not fit in 4 GB.
TreeImage make_tree_image(const Scene& scene, const Bvh& bvh, const ChipConfiguration& chip, uint32_t material_base);

/// Lines of that memory that hold these places of the tree, in their order; some are named several times.
TreeLines lines_of(const VisitList& places);

}  // namespace raypool
