// Embree's hits of a scene's rays: the oracle of our hits, and an engine of its own.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

enum class EmbreeMode : uint8_t {
  Robust,  ///< no ray passes between triangles that share an edge, as Embree promises
  Fast,    ///< its default
};

/// An Embree scene with the triangles of ours. Safe to ask from several threads.
class EmbreeScene {
 public:
  /// Throws std::runtime_error when Embree cannot be started. Keeps nothing of `scene`.
  explicit EmbreeScene(const Scene& scene, EmbreeMode mode = EmbreeMode::Robust);
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene();

  /// All but the hit's normal.
  bool nearest(const RayQuery& query, Hit& hit) const;
  bool occluded(const RayQuery& query) const;

 private:
  RTCScene scene_;
};

/// Packages in, packages out, as Tracer does, but Embree decides what is hit.
class EmbreeTracer {
 public:
  /// Both must outlive it; `tracer` has been made from `scene`.
  EmbreeTracer(const Scene& scene, const Tracer& tracer) : scene_(scene), tracer_(tracer), embree_(scene) {}
  bool trace(const Ray& ray, Intersection& intersection) const;

 private:
  const Scene& scene_;
  const Tracer& tracer_;
  EmbreeScene embree_;
};

}  // namespace raypool
