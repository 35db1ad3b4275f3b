// What the chip needs from a scene: something that finds hits, and something that collects
// contributions; and both made from the real ones.
#pragma once

#include "machine/common/packages.hpp"
#include "machine/compute/compute_unit.hpp"
#include "scene/image.hpp"
#include "scene/traversal.hpp"

namespace raypool {

class RayTracer {
 public:
  virtual ~RayTracer() = default;
  /// Normal ray: true and the intersection when it hits. Shadow ray: true and an intersection with words 12-20 zero
  /// when it is free. False: the ray leaves nothing. Words 0-11 of the intersection are the ray's.
  virtual bool trace(const Ray& ray, Intersection& intersection) = 0;
  /// False if what a normal ray hit reflects nothing. One that knows no materials returns true.
  virtual bool reflects(const Intersection& /*intersection*/) const { return true; }
};

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// Whether it takes a contribution in the present cycle.
  virtual bool ready() { return true; }
  /// The pixel is inside the image.
  virtual void add(const FrameContribution& contribution) = 0;
};

class SceneTracer : public RayTracer {
 public:
  /// `tracer` must outlive this.
  explicit SceneTracer(const Tracer& tracer) : tracer_(tracer) {}
  bool trace(const Ray& ray, Intersection& intersection) override { return tracer_.trace(ray, intersection); }
  bool reflects(const Intersection& intersection) const override {
    return tracer_.reflects(intersection[word::kMaterial]);
  }

 private:
  const Tracer& tracer_;
};

class FrameBufferSink : public FrameSink {
 public:
  /// `frame` must outlive this.
  explicit FrameBufferSink(FrameBuffer& frame) : frame_(frame) {}
  void add(const FrameContribution& contribution) override { frame_.add(contribution); }

 private:
  FrameBuffer& frame_;
};

}  // namespace raypool
