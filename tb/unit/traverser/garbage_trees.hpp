// Malformed trees, for the benches of the traverser: something in them is changed so that rays may come to what lies
// nowhere, to what means nothing, or to the same nodes for ever.
#pragma once

#include <cstring>
#include <random>

#include "machine/traverser/tree_fault.hpp"
#include "unit/traverser/lane_trees.hpp"

namespace raypool::bench {

inline void set_node(LaneTree& tree, uint32_t number, const TreeNode& node) {
  std::memcpy(static_cast<void*>(&tree.nodes[number]), &node, sizeof node);
}

/// Changes a node.
template <typename Change>
void change_node(LaneTree& tree, uint32_t number, const Change& change) {
  TreeNode node = tree.node(number);
  change(node);
  set_node(tree, number, node);
}

/// All boxes of a node are as large as can be, so that every ray comes to all children.
inline void widen(TreeNode& node) {
  for (int axis = 0; axis < 3; ++axis) {
    node.boxes.origin[axis] = -0x1p100f;
    node.boxes.exponent[axis] = 94;
    for (int box = 0; box < kBoxes; ++box) {
      node.boxes.planes[0][axis][box] = 0;
      node.boxes.planes[1][axis][box] = 255;
    }
  }
}

/// Of nodes each the last child of the one before, with three leaves beside it.
inline void make_chain(LaneTree& tree, uint32_t nodes) {
  tree.root = 0;
  tree.nodes.assign(nodes, {});
  for (uint32_t number = 0; number < nodes; ++number) {
    change_node(tree, number, [&](TreeNode& node) {
      widen(node);
      node.boxes.children = kBvhWidth;
      for (uint32_t i = 0; i + 1 < kBvhWidth; ++i) node.children[i] = leaf_word(i, 1);
      node.children[kBvhWidth - 1] = number + 1 < nodes ? number + 1 : leaf_word(3, 1);
    });
  }
}

/// Of nodes each of which has the next one for all its children: in which a ray comes to the last one very often.
inline void make_ladder(LaneTree& tree, uint32_t nodes) {
  make_chain(tree, nodes);
  for (uint32_t number = 0; number + 1 < nodes; ++number)
    change_node(tree, number, [&](TreeNode& node) { std::fill_n(node.children, kBvhWidth, number + 1); });
}

/// A fault, and what leads to it.
struct GarbageCase {
  const char* name;
  TreeFaultCode code;
  void (*make)(LaneTree&);
};
inline uint32_t places_of(const LaneTree& tree) {
  return static_cast<uint32_t>(tree.triangles.size() * 16 / LeafReader::kTriangleWords);
}
inline const GarbageCase kGarbageCases[] = {
    {"root beyond", TreeFaultCode::NodeBeyond,
     [](LaneTree& tree) { tree.root = static_cast<uint32_t>(tree.nodes.size()); }},
    {"child beyond", TreeFaultCode::NodeBeyond,
     [](LaneTree& tree) {
       make_chain(tree, 5);
       change_node(tree, 4, [](TreeNode& node) { node.children[3] = 5; });
     }},
    {"leaf beyond", TreeFaultCode::TriangleBeyond,
     [](LaneTree& tree) { tree.root = leaf_word(places_of(tree) + 2, 1); }},
    {"end of a leaf beyond", TreeFaultCode::TriangleBeyond,
     [](LaneTree& tree) { tree.root = leaf_word(places_of(tree) - 1, 4); }},
    {"leaf that no line has", TreeFaultCode::TriangleBeyond,
     [](LaneTree& tree) { tree.root = leaf_word((1u << 29) - 1, 3); }},
    {"leaf with a line that would be the first again", TreeFaultCode::TriangleBeyond,
     [](LaneTree& tree) { tree.root = leaf_word(97612894, 1); }},
    {"no child", TreeFaultCode::Children,
     [](LaneTree& tree) { change_node(tree, 0, [](TreeNode& node) { node.boxes.children = 0; }); }},
    {"five children", TreeFaultCode::Children,
     [](LaneTree& tree) { change_node(tree, 0, [](TreeNode& node) { node.boxes.children = 5; }); }},
    {"children of more bits", TreeFaultCode::Children,
     [](LaneTree& tree) { change_node(tree, 0, [](TreeNode& node) { node.boxes.children |= 0x80; }); }},
    {"itself", TreeFaultCode::Order,
     [](LaneTree& tree) {
       make_chain(tree, 7);
       change_node(tree, 3, [](TreeNode& node) { node.children[3] = 3; });
     }},
    {"back to the root", TreeFaultCode::Order,
     [](LaneTree& tree) {
       make_chain(tree, 7);
       change_node(tree, 6, [](TreeNode& node) { node.children[0] = 0; });
     }},
    {"node that no line has", TreeFaultCode::Order,
     [](LaneTree& tree) {
       make_chain(tree, 3);
       change_node(tree, 1, [](TreeNode& node) { node.children[2] = 1u << 26 | 2; });
     }},
    {"ways that meet", TreeFaultCode::Visits, [](LaneTree& tree) { make_ladder(tree, 20); }},
};

/// Of a root with two children around the origin, on either side of x = 0: one is no node, that of the other one lies
/// beyond.
inline void make_both(LaneTree& tree) {
  make_chain(tree, 3);
  change_node(tree, 0, [](TreeNode& node) {
    for (float& origin : node.boxes.origin) origin = -2;
    for (int8_t& exponent : node.boxes.exponent) exponent = -6;
    node.boxes.children = 2;
    node.boxes.planes[1][0][0] = 127;
    node.boxes.planes[0][0][1] = 128;
    node.children[0] = 1;
    node.children[1] = 2;
  });
  change_node(tree, 1, [](TreeNode& node) { node.boxes.children = 0; });
  change_node(tree, 2, [](TreeNode& node) { node.children[3] = 7; });
}

/// The same where either child is the first node of a ladder of its own: rays come too often to other nodes.
inline void make_two_ladders(LaneTree& tree) {
  make_both(tree);
  constexpr uint32_t kNodes = 21;
  const TreeNode root = tree.node(0);
  make_chain(tree, kNodes);
  set_node(tree, 0, root);
  for (uint32_t number = 1; number + 2 < kNodes; ++number)
    change_node(tree, number, [&](TreeNode& node) { std::fill_n(node.children, kBvhWidth, number + 2); });
  for (const uint32_t last : {kNodes - 2, kNodes - 1})
    change_node(tree, last, [](TreeNode& node) { node.children[kBvhWidth - 1] = leaf_word(0, 1); });
}

/// Changes something of the tree, or all of it.
inline void make_garbage(LaneTree& tree, std::mt19937& random) {
  const auto below = [&](size_t count) { return static_cast<uint32_t>(random() % count); };
  const auto any_node = [&] { return below(tree.nodes.size()); };
  const auto child_becomes = [&](uint32_t number, uint32_t reference) {
    change_node(tree, number, [&](TreeNode& node) { node.children[below(kBvhWidth)] = reference; });
  };
  const auto turn_bits = [&](std::vector<TreeLine>& lines, uint32_t first, uint32_t words) {
    for (uint32_t bits = 1 + below(8); bits != 0; --bits)
      lines[below(lines.size())][first + below(words)] ^= 1u << below(32);
  };
  const auto any_bytes = [&](TreeLine& line) {
    for (uint32_t& word : line) word = static_cast<uint32_t>(random());
  };
  if (tree.nodes.empty()) tree.nodes.emplace_back();
  if (tree.triangles.empty()) tree.triangles.emplace_back();
  const auto nodes = static_cast<uint32_t>(tree.nodes.size());
  switch (random() % 12) {
    case 0:
      return turn_bits(tree.nodes, 0, 16);
    case 1:  // children
      return turn_bits(tree.nodes, 10, 4);
    case 2:
      return turn_bits(tree.nodes, 3, 1);
    case 3: {
      const uint32_t from = any_node();
      return child_becomes(from, below(from + 1));
    }
    case 4:
      return child_becomes(any_node(), nodes + below(3));
    case 5:
      return child_becomes(any_node(), static_cast<uint32_t>(random()));
    case 6:
      return child_becomes(any_node(), leaf_word(places_of(tree) - below(4) % (places_of(tree) + 1), 1 + below(4)));
    case 7:
      return any_bytes(tree.nodes[any_node()]);
    case 8:
      for (TreeLine& line : tree.nodes) any_bytes(line);
      return;
    case 9:
      return make_ladder(tree, 2 + below(12));
    case 10:  // ways that meet
      for (uint32_t number = 0; number + 1 < nodes; ++number)
        if (random() % 2 == 0) child_becomes(number, number + 1 + below(nodes - number - 1));
      return;
    default:
      tree.root = random() % 2 == 0 ? static_cast<uint32_t>(random()) : nodes + below(2);
  }
}

}  // namespace raypool::bench
