// The tree as a file, read by code that knows of it only what docs/use/tree-file.md describes: places of bytes, and how
// a plane follows from them. Walked so, it gives the hits of the engines and the visits of compressed nodes.
#include "scene/tree_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "bits.hpp"
#include "files/output_files.hpp"
#include "scene/file_fixture.hpp"
#include "scene/simd4.hpp"
#include "scene/test_traversal.hpp"

namespace raypool {
namespace {

using namespace test;

#include "scene/triangle_test.hpp"

constexpr uint32_t kNone = 0xffffffff;

struct Walked {
  bool found = false;
  float t = 0, u = 0, v = 0;
  Vec3 normal;
  uint32_t triangle = 0, material = 0;
  VisitList visits;
};

class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}

  std::string text(size_t at, size_t size) const { return bytes_.substr(at, size); }
  uint32_t word(size_t at) const { return get<uint32_t>(at); }
  size_t size() const { return bytes_.size(); }

  uint32_t root() const { return word(12); }
  Bounds bounds() const { return {vector(16), vector(28)}; }
  uint32_t nodes() const { return word(40); }
  uint32_t triangles() const { return word(44); }
  size_t node(uint32_t number) const { return get<uint64_t>(48) + size_t{number} * 64; }
  size_t triangle(uint32_t place) const { return get<uint64_t>(56) + size_t{place} * 44; }

  uint32_t children(size_t node) const { return get<uint8_t>(node + 15); }
  uint8_t plane_number(size_t node, int side, int axis, uint32_t child) const {
    return get<uint8_t>(node + 16 + static_cast<size_t>(side) * 12 + static_cast<size_t>(axis) * 4 + child);
  }
  float plane(size_t node, int side, int axis, uint32_t child) const {
    const auto origin = get<float>(node + static_cast<size_t>(axis) * 4);
    const auto exponent = get<int8_t>(node + 12 + static_cast<size_t>(axis));
    return origin + std::ldexp(static_cast<float>(plane_number(node, side, axis, child)), exponent);
  }
  uint32_t child(size_t node, uint32_t child) const { return word(node + 40 + child * 4); }
  static bool is_leaf(uint32_t child) { return child >> 31 != 0; }
  static uint32_t count(uint32_t leaf) { return (leaf >> 29 & 3) + 1; }
  static uint32_t first(uint32_t leaf) { return leaf & 0x1fffffff; }

  Vec3 corner(uint32_t place, uint32_t corner) const { return vector(triangle(place) + corner * 12); }
  uint32_t number(uint32_t place) const { return word(triangle(place) + 36); }
  uint32_t material(uint32_t place) const { return word(triangle(place) + 40); }

  /// kAny: ends with the leaf of the first hit.
  template <bool kAny>
  Walked walk(const RayQuery& query) const {
    Walked result;
    const PreparedRay ray = prepare(query, bounds());
    if (!ray.valid || root() == kNone) return result;
    Candidate best;
    best.t = ray.internal_limit;
    uint32_t place = 0;
    std::vector<Waiting> stack{{root(), 0}};
    while (!stack.empty() && !(kAny && result.found)) {
      const Waiting top = stack.back();
      stack.pop_back();
      if (top.entry > best.t) {
        ++result.visits.back().discarded;
      } else if (is_leaf(top.child)) {
        result.visits.push_back({first(top.child), static_cast<uint8_t>(count(top.child)), 0, 0});
        for (uint32_t i = first(top.child); i < first(top.child) + count(top.child); ++i) {
          if (!meet_triangle(ray, i, best)) continue;
          result.found = true;
          place = i;
        }
      } else {
        std::vector<Waiting> met = meet_boxes(ray, node(top.child), best.t);
        result.visits.push_back({top.child, 0, static_cast<uint8_t>(met.size()), 0});
        stack.insert(stack.end(), met.begin(), met.end());
      }
    }
    if (!result.found) return result;
    result.t = static_cast<float>(static_cast<double>(best.t) * ray.t_scale);
    result.u = static_cast<float>(best.u);
    result.v = static_cast<float>(best.v);
    const Vec3d a = corner(place, 0).as<double>(), b = corner(place, 1).as<double>(), c = corner(place, 2).as<double>();
    result.normal = normalized(cross(b - a, c - a)).as<float>();
    result.triangle = number(place);
    result.material = material(place);
    return result;
  }

 private:
  struct Waiting {
    uint32_t child;
    float entry;
  };

  template <typename Number>
  Number get(size_t at) const {
    if (at + sizeof(Number) > bytes_.size()) throw std::out_of_range("beyond the end of the file");
    Number number;
    std::memcpy(&number, bytes_.data() + at, sizeof number);
    return number;
  }
  Vec3 vector(size_t at) const { return {get<float>(at), get<float>(at + 4), get<float>(at + 8)}; }

  bool meet_triangle(const PreparedRay& ray, uint32_t place, Candidate& best) const {
    TriangleBlock alone{};
    alone.count = 1;
    for (uint32_t lane = 0; lane < kBvhWidth; ++lane) {
      alone.triangles[lane] = lane == 0 ? number(place) : kNone;
      for (uint32_t k = 0; k < 3; ++k) {
        const Vec3 at = corner(place, lane == 0 ? k : 0);
        for (int axis = 0; axis < 3; ++axis) alone.vertices[k][axis][lane] = at[axis];
      }
    }
    const bool found = intersect_block(ray, alone, best);
    best.block = nullptr;
    return found;
  }

  /// The furthest first; of equally far ones the one that comes first in the node.
  std::vector<Waiting> meet_boxes(const PreparedRay& ray, size_t node, float limit) const {
    std::vector<Waiting> met;
    for (uint32_t i = 0; i < children(node); ++i) {
      float near = 0, far = kInfinity;
      for (int axis = 0; axis < 3; ++axis) {
        const int first = ray.near_side[axis], second = 1 - first;
        near = std::max(near, (plane(node, first, axis, i) - ray.padded[first][axis]) * ray.inverse[axis]);
        far = std::min(far, (plane(node, second, axis, i) - ray.padded[second][axis]) * ray.inverse[axis]);
      }
      near *= kNearScale;
      if (near <= std::min(far * kFarScale, limit)) met.push_back({child(node, i), near});
    }
    std::stable_sort(met.begin(), met.end(), [](const Waiting& a, const Waiting& b) { return a.entry > b.entry; });
    return met;
  }

  std::string bytes_;
};

class TreeFileTest : public FileFixture {
 protected:
  /// The file, written and read back.
  Reader read_back(const Scene& scene) const {
    const std::string path = folder_ + "/tree.bvh";
    write_file(path, to_bytes(make_tree_file(scene)));
    std::ifstream file(path, std::ios::binary);
    return Reader(std::string(std::istreambuf_iterator<char>(file), {}));
  }
};

/// Materials that differ from triangle to triangle.
Scene with_materials(Scene scene, uint32_t count) {
  scene.materials.resize(count);
  for (uint32_t i = 0; i < scene.triangles.size(); ++i) scene.triangle_materials[i] = i * 5 % count;
  return scene;
}

constexpr std::array<Vec3, 3> kTriangle{Vec3{1, 0, 3}, Vec3{2, 0, 3}, Vec3{1, 2, 4}};

struct Case {
  const char* name;
  Scene scene;
  size_t with_area;  ///< triangles
};
std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const char* name, const Scene& scene) {
    size_t with_area = 0;
    for (size_t i = 0; i < scene.triangles.size(); ++i) with_area += is_degenerate(scene, i) ? 0 : 1;
    all.push_back({name, scene, with_area});
  };
  add("cornell", make_cornell());
  add("room", make_room(0.05));
  add("nothing", Scene{});
  add("no area", scene_of({{kTriangle[0], kTriangle[0], kTriangle[1]}}));
  add("one", scene_of({kTriangle}));
  add("coincident", with_materials(scene_of(std::vector<std::array<Vec3, 3>>(100, kTriangle)), 100));
  add("soup", with_materials(soup(3, 3000, 1, {0, 0, 0}), 7));
  add("small, far soup", with_materials(soup(4, 3000, 1e-3f, {1000, -2000, 500}), 7));
  add("tiny soup", with_materials(soup(5, 500, 1e-37f, {0, 0, 0}), 3));
  return all;
}

TEST_F(TreeFileTest, IsAsThePageDescribesIt) {
  for (const Case& made : cases()) {
    SCOPED_TRACE(made.name);
    const Scene& scene = made.scene;
    const Reader tree = read_back(scene);
    ASSERT_EQ(tree.text(0, 8), "rayp-bvh");
    ASSERT_EQ(tree.word(8), 1u);
    ASSERT_EQ(tree.root(), made.with_area == 0 ? kNone : 0);
    ASSERT_EQ(tree.triangles(), made.with_area);
    ASSERT_EQ(tree.nodes() == 0, made.with_area == 0);
    ASSERT_EQ(tree.node(0), 64u);
    ASSERT_EQ(tree.triangle(0), tree.node(tree.nodes()));
    ASSERT_EQ(tree.size(), tree.triangle(tree.triangles()));

    std::vector<int> parents(tree.nodes()), leaves(tree.triangles()), seen(scene.triangles.size());
    uint32_t next = 0;  // leaves come in the order of the nodes that have them, depth first
    const auto descend = [&](const auto& self, uint32_t number) -> void {
      const size_t node = tree.node(number);
      ASSERT_GE(tree.children(node), 1u);
      ASSERT_LE(tree.children(node), 4u);
      ASSERT_EQ(tree.word(node + 56), 0u);
      ASSERT_EQ(tree.word(node + 60), 0u);
      for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t child = tree.child(node, i);
        if (i >= tree.children(node)) {
          ASSERT_EQ(child, kNone);
          for (int side = 0; side < 2; ++side) {
            for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(tree.plane_number(node, side, axis, i), 0);
          }
        } else if (!Reader::is_leaf(child)) {
          ASSERT_GT(child, number) << "parents come before children";
          ++parents.at(child);
          self(self, child);
        } else {
          ASSERT_EQ(Reader::first(child), next);
          next += Reader::count(child);
          for (uint32_t place = Reader::first(child); place < next; ++place) {
            ++leaves.at(place);
            for (uint32_t corner = 0; corner < 3; ++corner) {
              for (int axis = 0; axis < 3; ++axis) {
                ASSERT_LE(tree.plane(node, 0, axis, i), tree.corner(place, corner)[axis]);
                ASSERT_GE(tree.plane(node, 1, axis, i), tree.corner(place, corner)[axis]);
              }
            }
          }
        }
      }
    };
    if (tree.root() != kNone) ++parents.at(tree.root()), descend(descend, tree.root());
    EXPECT_EQ(std::count(parents.begin(), parents.end(), 1), static_cast<std::ptrdiff_t>(parents.size()));
    EXPECT_EQ(std::count(leaves.begin(), leaves.end(), 1), static_cast<std::ptrdiff_t>(leaves.size()));

    Bounds bounds;
    for (uint32_t place = 0; place < tree.triangles(); ++place) {
      const uint32_t number = tree.number(place);
      ++seen.at(number);
      ASSERT_EQ(tree.material(place), scene.triangle_materials[number]);
      for (uint32_t k = 0; k < 3; ++k) {
        const Vec3 corner = tree.corner(place, k);
        ASSERT_EQ(corner, scene.corner(number, static_cast<int>(k)));
        if (place == 0 && k == 0) bounds = {corner, corner};
        for (int axis = 0; axis < 3; ++axis) {
          bounds.lower[axis] = std::min(bounds.lower[axis], corner[axis]);
          bounds.upper[axis] = std::max(bounds.upper[axis], corner[axis]);
        }
      }
    }
    for (size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], is_degenerate(scene, i) ? 0 : 1) << i;
    EXPECT_EQ(tree.bounds().lower, bounds.lower);
    EXPECT_EQ(tree.bounds().upper, bounds.upper);
  }
}

Ray to_ray(const RayQuery& query, uint32_t flags) {
  Ray ray{};
  for (int axis = 0; axis < 3; ++axis) {
    ray[word::kOrigin + axis] = as_bits(query.origin[axis]);
    ray[word::kDirection + axis] = as_bits(query.direction[axis]);
  }
  ray[word::kLimit] = as_bits(query.limit);
  ray[word::kFlags] = flags;
  return ray;
}

TEST_F(TreeFileTest, GivesTheHitsOfTheEnginesAndTheVisitsOfCompressedNodes) {
  constexpr uint32_t kBase = 0x4000;
  for (const Case& made : cases()) {
    SCOPED_TRACE(made.name);
    const Reader tree = read_back(made.scene);
    const Tracer engine(made.scene, kBase);
    Traversal compressed(made.scene);
    compressed.compress_nodes();
    // Nothing can be aimed at in an empty scene.
    const Scene& aim = made.scene.triangles.empty() ? scene_of({kTriangle}) : made.scene;
    int hits = 0, blocked = 0;
    for (const RayQuery& query : hard_rays(aim, 3000, 11)) {
      Intersection expected{};
      Hit visited;
      VisitList visits;
      const Ray ray = to_ray(query, 0);
      const bool hit = engine.trace(ray, expected);
      ASSERT_EQ(compressed.nearest(query, visited, nullptr, &visits), hit);
      const Walked nearest = tree.walk<false>(query);
      ASSERT_EQ(nearest.found, hit);
      ASSERT_TRUE(nearest.visits == visits);
      hits += hit;
      if (hit) {
        ASSERT_EQ(nearest.triangle, expected[word::kTriangle]);
        ASSERT_EQ(kBase + 32 * nearest.material, expected[word::kMaterial]);
        ASSERT_EQ(as_bits(nearest.t), expected[word::kDistance]);
        ASSERT_EQ(as_bits(nearest.u), expected[word::kBarycentric]);
        ASSERT_EQ(as_bits(nearest.v), expected[word::kBarycentric + 1]);
        for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(as_bits(nearest.normal[axis]), expected[word::kNormal + axis]);
      }
      visits.clear();
      const Ray shadow = to_ray(query, kShadowFlag);
      const bool free = engine.trace(shadow, expected);
      ASSERT_EQ(compressed.occluded(query, nullptr, &visits), !free);
      const Walked any = tree.walk<true>(query);
      ASSERT_EQ(any.found, !free);
      ASSERT_TRUE(any.visits == visits);
      blocked += !free;
    }
    EXPECT_EQ(hits > 200, made.with_area > 0) << hits;
    EXPECT_EQ(blocked, hits);
  }
}

TEST(TreeFile, LeavesNameAsManyTrianglesAsTheirPlacesCan) {
  EXPECT_EQ(leaf_word(0, 1), 0x80000000u);
  EXPECT_EQ(leaf_word(5, 4), 0xe0000005u);
  Bvh bvh;
  bvh.blocks.emplace_back();
  bvh.blocks.back().count = 1;
  bvh.blocks.back().first = (1u << 29) - 2;
  const Scene scene = scene_of({kTriangle});
  EXPECT_EQ(leaf_word(bvh.blocks.back().first, 1), 0x9ffffffeu);
  EXPECT_EQ(make_tree_file(scene, bvh).triangles.size(), 1u);
  bvh.blocks.back().first += 1;
  try {
    make_tree_file(scene, bvh);
    FAIL() << "one too many";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a scene of 536870912 triangles"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raypool
