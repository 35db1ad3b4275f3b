// How a ray walks the wide tree. Included, after triangle_test.hpp and what that wants, in a namespace of each set of
// instructions it is compiled for, and so without a guard. RAYPOOL_WALK_AVX: whether that has vectors of eight.

#if RAYPOOL_WALK_AVX
using Float8 = __m256;
inline Float8 load8(const float* p) { return _mm256_load_ps(p); }
inline Float8 splat8(float x) { return _mm256_set1_ps(x); }
inline Float8 slab8(Float8 bounds, Float8 padded, Float8 inverse) {
  return _mm256_mul_ps(_mm256_sub_ps(bounds, padded), inverse);
}
inline Float8 scale8(Float8 a, float scale) { return _mm256_mul_ps(a, _mm256_set1_ps(scale)); }
/// No argument may be a NaN, here and in the next.
inline Float8 min8(Float8 a, Float8 b) { return _mm256_min_ps(a, b); }
inline Float8 max8(Float8 a, Float8 b) { return _mm256_max_ps(a, b); }
/// Bit i: of lane i it is true that a <= b.
inline unsigned less_equal8(Float8 a, Float8 b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}
inline void store8(float* p, Float8 a) { _mm256_store_ps(p, a); }
#else
struct Float8 {
  Float4 low, high;
};
inline Float8 load8(const float* p) { return {load4(p), load4(p + 4)}; }
inline Float8 splat8(float x) { return {splat4(x), splat4(x)}; }
inline Float8 slab8(Float8 bounds, Float8 padded, Float8 inverse) {
  return {(bounds.low - padded.low) * inverse.low, (bounds.high - padded.high) * inverse.high};
}
inline Float8 scale8(Float8 a, float scale) { return {a.low * splat4(scale), a.high * splat4(scale)}; }
/// No argument may be a NaN, here and in the next.
inline Float8 min8(Float8 a, Float8 b) { return {min4(a.low, b.low), min4(a.high, b.high)}; }
inline Float8 max8(Float8 a, Float8 b) { return {max4(a.low, b.low), max4(a.high, b.high)}; }
/// Bit i: of lane i it is true that a <= b.
inline unsigned less_equal8(Float8 a, Float8 b) { return mask4(a.low <= b.low) | mask4(a.high <= b.high) << 4; }
inline void store8(float* p, Float8 a) {
  std::memcpy(p, &a.low, sizeof a.low);
  std::memcpy(p + 4, &a.high, sizeof a.high);
}
#endif

/// What waits: where the ray enters, as bits, above the child. Entries are not negative, so that the order of these
/// numbers is that of the entries.
inline uint64_t waiting(float entry, uint32_t child) { return static_cast<uint64_t>(as_bits(entry)) << 32 | child; }

/// Begins to load what the ray will come to later.
inline void prefetch(const WideBvh& bvh, uint32_t child) {
  const bool leaf = (child & kLeafBit) != 0;
  const auto* place = leaf ? reinterpret_cast<const char*>(bvh.blocks.data() + (child & ~kLeafBit))
                           : reinterpret_cast<const char*>(bvh.nodes.data() + child);
  __builtin_prefetch(place);
  __builtin_prefetch(place + 64);
  __builtin_prefetch(place + 128);
  if (!leaf) __builtin_prefetch(place + 192);
}

/// Puts the children that the ray meets, at least two, on the stack, and returns the nearest instead. kSorted: so that
/// the next nearest is the next on the stack.
template <bool kSorted>
uint32_t go_on(const WideBvh& bvh, const WideBvhNode& node, unsigned lanes, const float* entry, uint64_t*& top) {
  uint64_t* const base = top;
  uint64_t nearest = waiting(entry[lowest(lanes)], node.children[lowest(lanes)]);
  prefetch(bvh, node.children[lowest(lanes)]);
  for (lanes &= lanes - 1; lanes != 0; lanes &= lanes - 1) {
    const uint64_t next = waiting(entry[lowest(lanes)], node.children[lowest(lanes)]);
    prefetch(bvh, node.children[lowest(lanes)]);
    const uint64_t further = next < nearest ? nearest : next;
    nearest = next < nearest ? next : nearest;
    uint64_t* place = top++;
    if (kSorted) {
      // Insertion sort, furthest first.
      for (; place > base && place[-1] < further; --place) *place = place[-1];
    }
    *place = further;
  }
  return static_cast<uint32_t>(nearest);
}

/// `ray` is valid and the tree not empty. kAny: ends with the first hit. kVisits: `visits` records them.
template <bool kAny, bool kVisits>
bool walk_tree(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, TreeVisits* visits) {
  Float8 padded_near[3], padded_far[3], inverse[3];
  for (int axis = 0; axis < 3; ++axis) {
    padded_near[axis] = splat8(ray.padded[ray.near_side[axis]][axis]);
    padded_far[axis] = splat8(ray.padded[1 - ray.near_side[axis]][axis]);
    inverse[axis] = splat8(ray.inverse[axis]);
  }
  const int x = ray.near_side[0], y = ray.near_side[1], z = ray.near_side[2];
  const WideBvhNode* const nodes = bvh.nodes.data();
  const TriangleBlock* const blocks = bvh.blocks.data();
  best.t = ray.internal_limit;
  bool found = false;
  uint64_t stack[(kWideBvhWidth - 1) * kMaxDepth];
  uint64_t* top = stack;
  uint32_t child = 0;
  for (;;) {
    while ((child & kLeafBit) == 0) {
      const WideBvhNode& node = nodes[child];
      if (kVisits) visits->node(child);
      Float8 near = max8(splat8(0), slab8(load8(node.bounds[x][0]), padded_near[0], inverse[0]));
      Float8 far = slab8(load8(node.bounds[1 - x][0]), padded_far[0], inverse[0]);
      near = max8(near, slab8(load8(node.bounds[y][1]), padded_near[1], inverse[1]));
      far = min8(far, slab8(load8(node.bounds[1 - y][1]), padded_far[1], inverse[1]));
      near = scale8(max8(near, slab8(load8(node.bounds[z][2]), padded_near[2], inverse[2])), kNearScale);
      far = scale8(min8(far, slab8(load8(node.bounds[1 - z][2]), padded_far[2], inverse[2])), kFarScale);
      const unsigned lanes = less_equal8(near, min8(far, splat8(best.t)));
      if (lanes == 0) break;
      if ((lanes & (lanes - 1)) == 0) {
        child = node.children[lowest(lanes)];
        continue;
      }
      alignas(32) float entry[kWideBvhWidth];
      store8(entry, near);
      child = go_on<!kAny>(bvh, node, lanes, entry, top);
    }
    if ((child & kLeafBit) != 0) {
      const TriangleBlock& block = blocks[child & ~kLeafBit];
      if (kVisits) visits->block(child & ~kLeafBit, block.count);
      found |= intersect_block(ray, block, best);
      if (kAny && found) return true;
    }
    do {
      if (top == stack) return found;
      --top;
    } while (as_float(static_cast<uint32_t>(*top >> 32)) > best.t);
    child = static_cast<uint32_t>(*top);
  }
}

inline bool walk_nearest(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, TreeVisits* visits) {
  return visits == nullptr ? walk_tree<false, false>(bvh, ray, best, visits)
                           : walk_tree<false, true>(bvh, ray, best, visits);
}
inline bool walk_any(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, TreeVisits* visits) {
  return visits == nullptr ? walk_tree<true, false>(bvh, ray, best, visits)
                           : walk_tree<true, true>(bvh, ray, best, visits);
}
