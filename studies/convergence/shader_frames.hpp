// Pictures that a shader set draws natively, a sample at a time and in linear light.
#pragma once

#include <cstdint>
#include <string>

#include "cli/report.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::convergence {

struct PictureSize {
  uint32_t width = 64, height = 64;
  uint32_t depth = 8;     ///< of the deepest rays
  uint32_t samples = 64;  ///< by which the set divides what each of them adds
};

class ShaderFrames {
 public:
  /// `set` as `--shaders` has it; `scene` has surfaces and must outlive it. Throws InputError.
  ShaderFrames(const std::string& set, const Scene& scene, const PictureSize& size);

  /// What sample `number` adds, also of one beyond the last: any `samples` of them are a picture.
  FrameBuffer draw(uint32_t number) const;

 private:
  const Scene& scene_;
  RunRecord record_;
  MemoryImage image_;
  Tracer tracer_;
};

}  // namespace raypool::convergence
