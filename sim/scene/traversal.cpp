// Ray preparation, the box test, the triangle test, and the loop around them.
#include "scene/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "bits.hpp"
#include "scene/compressed_node.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

constexpr int kMaxDepth = 80;
constexpr float kUlp = 1.1920929e-7f;  // 2^-23
constexpr float kPadding =
    8 * kUlp;  // of the largest distance; the triangle test and the slabs err by less than half of it
constexpr float kNearScale = 1 - 4 * kUlp;  // t of a slab carries three roundings
constexpr float kFarScale = 1 + 4 * kUlp;
constexpr double kCancelled = 0x1p-10;     // what is left of a sum is a smaller share of its terms than this
constexpr float kLargestDistance = 1e18f;  // products of two distances stay finite

/// A ray with all that boxes and triangles ask of it. Its direction is scaled by a power of two so that the largest
/// component lies in 1 .. 2; times t_scale, internal t is the ray's.
struct PreparedRay {
  bool valid = false;
  float origin[3];
  float padded[2][3];  // subtracted from lower and upper bounds
  float inverse[3];
  int near_side[3];  // 0: the lower bound is met first
  int kx, ky, kz;
  float shear_x, shear_y;
  double direction[3];
  double inverse_z;
  double t_scale;
  float limit;           // the ray's
  float internal_limit;  // rounded up
};

PreparedRay prepare(const RayQuery& query, const Bounds& bounds) {
  PreparedRay ray;
  float distance = 0, largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float o = query.origin[axis], d = query.direction[axis];
    if (!std::isfinite(o) || !std::isfinite(d)) return ray;
    distance = std::max({distance, std::fabs(bounds.lower[axis] - o), std::fabs(bounds.upper[axis] - o)});
    largest = std::max(largest, std::fabs(d));
  }
  if (!(largest > 0) || !(distance <= kLargestDistance) || !(query.limit > 0)) return ray;
  ray.valid = true;

  int exponent = 0;
  std::frexp(largest, &exponent);
  ray.t_scale = std::ldexp(1.0, 1 - exponent);
  ray.limit = query.limit;
  const double internal_limit = static_cast<double>(query.limit) / ray.t_scale;
  ray.internal_limit = static_cast<float>(internal_limit);
  if (static_cast<double>(ray.internal_limit) < internal_limit)
    ray.internal_limit = std::nextafter(ray.internal_limit, INFINITY);

  const double padding = static_cast<double>(kPadding) * distance;
  double* const direction = ray.direction;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = query.origin[axis];
    ray.origin[axis] = query.origin[axis];
    ray.padded[0][axis] = std::nextafter(static_cast<float>(o + padding), INFINITY);
    ray.padded[1][axis] = std::nextafter(static_cast<float>(o - padding), -INFINITY);
    direction[axis] = static_cast<double>(query.direction[axis]) * ray.t_scale;
    // Along such an axis the ray does not move at all, compared with the padding; a finite inverse keeps NaN out.
    const double smallest = 0x1p-100;
    const double d = std::fabs(direction[axis]) < smallest ? std::copysign(smallest, direction[axis]) : direction[axis];
    ray.inverse[axis] = static_cast<float>(1.0 / d);
    ray.near_side[axis] = ray.inverse[axis] < 0 ? 1 : 0;
  }

  ray.kz = 0;
  if (std::fabs(direction[1]) > std::fabs(direction[ray.kz])) ray.kz = 1;
  if (std::fabs(direction[2]) > std::fabs(direction[ray.kz])) ray.kz = 2;
  ray.kx = (ray.kz + 1) % 3;
  ray.ky = (ray.kz + 2) % 3;
  ray.inverse_z = 1.0 / direction[ray.kz];
  ray.shear_x = static_cast<float>(direction[ray.kx] * ray.inverse_z);
  ray.shear_y = static_cast<float>(direction[ray.ky] * ray.inverse_z);
  return ray;
}

/// The parts of a prepared ray that the box test wants in all four lanes.
struct BoxRay {
  Float4 padded[2][3];
  Float4 inverse[3];

  explicit BoxRay(const PreparedRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      padded[0][axis] = splat4(ray.padded[0][axis]);
      padded[1][axis] = splat4(ray.padded[1][axis]);
      inverse[axis] = splat4(ray.inverse[axis]);
    }
  }
};

/// Where the ray enters each of the four boxes; bit i of the result: box i is met at or before `best`.
unsigned intersect_boxes(const PreparedRay& ray, const BoxRay& box_ray, const BvhNode& node, float best, float* entry) {
  Float4 near = splat4(0), far = splat4(INFINITY);
  for (int axis = 0; axis < 3; ++axis) {
    const int first = ray.near_side[axis], second = 1 - first;
    near = max4(near, (load4(node.bounds[first][axis]) - box_ray.padded[first][axis]) * box_ray.inverse[axis]);
    far = min4(far, (load4(node.bounds[second][axis]) - box_ray.padded[second][axis]) * box_ray.inverse[axis]);
  }
  near = near * splat4(kNearScale);
  far = far * splat4(kFarScale);
  std::memcpy(entry, &near, sizeof near);
  return mask4(near <= min4(far, splat4(best)));
}

/// The same arithmetic for one triangle's box. False when the ray misses it.
bool own_box_interval(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, float& near, float& far) {
  near = 0;
  far = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = block.vertices[0][axis][lane], b = block.vertices[1][axis][lane], c = block.vertices[2][axis][lane];
    const float bounds[2] = {std::min({a, b, c}), std::max({a, b, c})};
    const int first = ray.near_side[axis], second = 1 - first;
    near = std::max(near, (bounds[first] - ray.padded[first][axis]) * ray.inverse[axis]);
    far = std::min(far, (bounds[second] - ray.padded[second][axis]) * ray.inverse[axis]);
  }
  near *= kNearScale;
  far *= kFarScale;
  return near <= far;
}

/// Best hit so far, in internal t.
struct Candidate {
  float t = INFINITY;
  uint32_t triangle = kNoChild;
  double u = 0, v = 0;
  const TriangleBlock* block = nullptr;
  unsigned lane = 0;
};

/// t of the triangle's plane.
double plane_t(const PreparedRay& ray, const TriangleBlock& block, unsigned lane) {
  Vec3d corners[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][axis] = static_cast<double>(block.vertices[corner][axis][lane]) - ray.origin[axis];
    }
  }
  const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return dot(normal, corners[0]) / dot(normal, Vec3d{ray.direction[0], ray.direction[1], ray.direction[2]});
}

/// Finishes a triangle whose edge functions agree in sign; true when it becomes the candidate.
bool accept(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, double u, double v, double w,
            Candidate& best) {
  const double determinant = u + v + w;
  if (determinant == 0) return false;
  double z[3];
  for (int corner = 0; corner < 3; ++corner) {
    z[corner] = static_cast<double>(block.vertices[corner][ray.kz][lane]) - ray.origin[ray.kz];
  }
  const double sum = u * z[0] + v * z[1] + w * z[2];
  double exact_t = sum / determinant * ray.inverse_z;
  // Near the plane, compared with the triangle's size, the edge functions' roundings would decide on which side of it
  // the ray begins: a triangle of 1e9 would be met or not met at random, and a surface could shadow itself.
  if (std::fabs(sum) < kCancelled * (std::fabs(u * z[0]) + std::fabs(v * z[1]) + std::fabs(w * z[2]))) {
    exact_t = plane_t(ray, block, lane);
  }
  float t = static_cast<float>(exact_t), near = 0, far = 0;
  if (!(t > 0) || !own_box_interval(ray, block, lane, near, far)) return false;
  t = std::min(std::max(t, near), far);
  const auto ray_t = static_cast<float>(static_cast<double>(t) * ray.t_scale);
  if (!(ray_t > 0 && ray_t < ray.limit)) return false;
  const uint32_t triangle = block.triangles[lane];
  if (!(t < best.t || (t == best.t && triangle < best.triangle))) return false;
  best = {t, triangle, v / determinant, w / determinant, &block, lane};
  return true;
}

/// Tests the triangles of a leaf; true when one became the candidate.
bool intersect_block(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) {
  const Float4 ox = splat4(ray.origin[ray.kx]), oy = splat4(ray.origin[ray.ky]), oz = splat4(ray.origin[ray.kz]);
  const Float4 sx = splat4(ray.shear_x), sy = splat4(ray.shear_y);
  Float4 x[3], y[3];
  for (int corner = 0; corner < 3; ++corner) {
    const Float4 z = load4(block.vertices[corner][ray.kz]) - oz;
    x[corner] = (load4(block.vertices[corner][ray.kx]) - ox) - sx * z;
    y[corner] = (load4(block.vertices[corner][ray.ky]) - oy) - sy * z;
  }
  const Float4 u = x[2] * y[1] - y[2] * x[1];
  const Float4 v = x[0] * y[2] - y[0] * x[2];
  const Float4 w = x[1] * y[0] - y[1] * x[0];
  const Float4 zero = splat4(0);
  const unsigned used = (1u << block.count) - 1;
  const unsigned negative = mask4((u < zero) | (v < zero) | (w < zero)),
                 positive = mask4((u > zero) | (v > zero) | (w > zero));
  const unsigned zeros = mask4((u == zero) | (v == zero) | (w == zero));
  bool found = false;
  for (unsigned lanes = ~(negative & positive) & used; lanes != 0; lanes &= lanes - 1) {
    const auto lane = lowest(lanes);
    double du = u[lane], dv = v[lane], dw = w[lane];
    if ((zeros >> lane & 1u) != 0) {
      // Products of floats are exact in double: the sign is that of the exact edge function.
      auto edge = [&](int a, int b) {
        return static_cast<double>(x[a][lane]) * y[b][lane] - static_cast<double>(y[a][lane]) * x[b][lane];
      };
      du = edge(2, 1), dv = edge(0, 2), dw = edge(1, 0);
      if ((du < 0 || dv < 0 || dw < 0) && (du > 0 || dv > 0 || dw > 0)) continue;
    }
    found |= accept(ray, block, lane, du, dv, dw, best);
  }
  return found;
}

Hit finish(const PreparedRay& ray, const Candidate& best) {
  Vec3d corners[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) corners[corner][axis] = best.block->vertices[corner][axis][best.lane];
  }
  Hit hit;
  hit.t = static_cast<float>(static_cast<double>(best.t) * ray.t_scale);
  hit.u = static_cast<float>(best.u);
  hit.v = static_cast<float>(best.v);
  hit.normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0])).as<float>();
  hit.triangle = best.triangle;
  return hit;
}

template <bool kAny>
bool traverse(const Bvh& bvh, const PreparedRay& ray, Candidate& best, TraversalCounts* counts, VisitList* visits) {
  struct Entry {
    uint32_t child;
    float t;
  };
  if (!ray.valid || bvh.nodes.empty()) return false;
  const BoxRay box_ray(ray);
  best.t = ray.internal_limit;
  bool found = false;
  uint64_t nodes = 0, blocks = 0, triangles = 0;
  Entry stack[(kBvhWidth - 1) * kMaxDepth + 1];
  int depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const Entry top = stack[--depth];
    if (top.t > best.t) {
      if (visits != nullptr) ++visits->back().discarded;
      continue;
    }
    if ((top.child & kLeafBit) != 0) {
      const TriangleBlock& block = bvh.blocks[top.child & ~kLeafBit];
      if (visits != nullptr) visits->push_back({block.first, static_cast<uint8_t>(block.count), 0, 0});
      ++blocks;
      triangles += block.count;
      found |= intersect_block(ray, block, best);
      if (kAny && found) break;
      continue;
    }
    const BvhNode& node = bvh.nodes[top.child];
    ++nodes;
    float entry[kBvhWidth];
    unsigned lanes = intersect_boxes(ray, box_ray, node, best.t, entry);
    if (visits != nullptr) visits->push_back({top.child, 0, static_cast<uint8_t>(popcount(lanes)), 0});
    // The nearest child must end on top: insertion sort, furthest first.
    const int base = depth;
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = lowest(lanes);
      int place = depth++;
      for (; place > base && stack[place - 1].t < entry[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.children[lane], entry[lane]};
    }
  }
  if (counts != nullptr) {
    counts->nodes += nodes;
    counts->blocks += blocks;
    counts->triangles += triangles;
  }
  return found;
}

int tree_depth(const Bvh& bvh) {
  std::vector<int> depth(bvh.nodes.size(), 1);
  int deepest = 1;
  for (size_t i = 0; i < bvh.nodes.size(); ++i) {
    for (uint32_t child : bvh.nodes[i].children) {
      if ((child & kLeafBit) == 0) depth[child] = depth[i] + 1;  // kNoChild has the bit too
    }
    deepest = std::max(deepest, depth[i]);
  }
  return deepest;
}

}  // namespace

Traversal::Traversal(const Scene& scene) { set_bvh(build_bvh(scene)); }

void Traversal::compress_nodes() {
  for (BvhNode& node : bvh_.nodes) node = decompress(compress(node));
}

void Traversal::set_bvh(Bvh bvh) {
  if (tree_depth(bvh) > kMaxDepth)
    throw std::runtime_error("the bounding volume hierarchy is deeper than the traversal's stack");
  bvh_ = std::move(bvh);
}

bool Traversal::nearest(const RayQuery& query, Hit& hit, TraversalCounts* counts, VisitList* visits) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  Candidate best;
  if (!traverse<false>(bvh_, ray, best, counts, visits)) return false;
  hit = finish(ray, best);
  return true;
}

bool Traversal::occluded(const RayQuery& query, TraversalCounts* counts, VisitList* visits) const {
  Candidate best;
  return traverse<true>(bvh_, prepare(query, bvh_.bounds), best, counts, visits);
}

bool Traversal::nearest_of_all(const RayQuery& query, Hit& hit) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  if (!ray.valid || bvh_.nodes.empty()) return false;
  Candidate best;
  bool found = false;
  for (const TriangleBlock& block : bvh_.blocks) found |= intersect_block(ray, block, best);
  if (found) hit = finish(ray, best);
  return found;
}

RayQuery to_query(const Ray& ray) {
  auto vector = [&](int first) {
    return Vec3{as_float(ray[first]), as_float(ray[first + 1]), as_float(ray[first + 2])};
  };
  return {vector(word::kOrigin), vector(word::kDirection), as_float(ray[word::kLimit])};
}

Tracer::Tracer(const Scene& scene, uint32_t material_base, NodeFormat nodes)
    : traversal_(scene), material_base_(material_base) {
  if (nodes == NodeFormat::Compressed) traversal_.compress_nodes();
  material_words_.reserve(scene.triangles.size());
  for (uint32_t material : scene.triangle_materials) {
    material_words_.push_back(material_base + material * static_cast<uint32_t>(kMaterialBytes));
  }
  for (const Material& material : scene.materials) reflecting_.push_back(material.reflects());
}

void Tracer::pass_on(const Ray& ray, Intersection& intersection) {
  intersection.fill(0);
  std::copy(ray.begin(), ray.end(), intersection.begin());
}

void Tracer::meet(const Ray& ray, const Hit& hit, Intersection& intersection) const {
  pass_on(ray, intersection);
  intersection[word::kDistance] = as_bits(hit.t);
  intersection[word::kBarycentric] = as_bits(hit.u);
  intersection[word::kBarycentric + 1] = as_bits(hit.v);
  for (int axis = 0; axis < 3; ++axis) intersection[word::kNormal + axis] = as_bits(hit.normal[axis]);
  intersection[word::kMaterial] = material_words_[hit.triangle];
  intersection[word::kTriangle] = hit.triangle;
}

bool Tracer::trace(const Ray& ray, Intersection& intersection, TraversalCounts* counts, VisitList* visits) const {
  const RayQuery query = to_query(ray);
  if ((ray[word::kFlags] & kShadowFlag) != 0) {
    pass_on(ray, intersection);
    return !traversal_.occluded(query, counts, visits);
  }
  Hit hit;
  if (!traversal_.nearest(query, hit, counts, visits)) return false;
  meet(ray, hit, intersection);
  return true;
}

}  // namespace raypool
