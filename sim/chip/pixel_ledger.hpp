// Who still works on a pixel. A pixel is held from the launch of its eye kernel until the last of its rays, intersections and
// kernel threads is gone; the ledger counts them exactly, and so knows how many pixels are held and how many are finished.
//
// What a thread has exported shows only at the unit's ports, some time after its kernel has ended. So every kernel of a unit
// stays on record until all its exports have provably been seen: as many as it can make, or the first export of a later kernel
// (exports leave in order), or the unit idle. Until then its threads hold their pixels. The count is never too low, and right
// whenever the units are idle.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "kernel/kernels.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

class PixelLedger {
 public:
  PixelLedger(int units, int width, int height);

  bool inside(uint32_t pixel) const { return (pixel & 0xffff) < width_ && (pixel >> 16) < height_; }

  /// A kernel is going to be launched. CastEye: `pixels` are those of its tile that lie in the image, and are held from now on.
  void eye_launched(int unit, std::vector<uint32_t> pixels);
  /// Another kernel: its threads' pixels come with their packages.
  void launched(int unit, RayKernel kernel, uint32_t threads);
  /// A package goes to the unit: to its oldest kernel that still misses some.
  void imported(int unit, uint32_t pixel);
  /// All warps of the unit's oldest unfinished kernel have ended.
  void kernel_ended(int unit);
  /// The unit is idle: whatever its ended kernels exported has been seen.
  void unit_idle(int unit);

  /// A ray left the unit, and holds its pixel from now on if it is `kept`. Throws std::runtime_error when no kernel of the unit
  /// can have made it.
  void ray_exported(int unit, const Ray& ray, bool kept);
  void contribution_exported(int unit, uint32_t pixel);
  /// A ray that was kept is gone without leaving an intersection.
  void ray_dropped(uint32_t pixel) { gone(pixel); }

  uint32_t held() const { return held_; }
  uint64_t finished() const { return finished_; }
  uint64_t pixels() const { return uint64_t{width_} * height_; }

  /// Kernels that have gone off record so far: a change tells that held() or the rays to come may have fallen.
  uint64_t releases() const { return releases_; }

  /// Most rays that kernels on record may still export.
  uint32_t rays_to_come() const { return rays_to_come_; }
  uint32_t shadow_rays_to_come() const { return shadow_to_come_; }

 private:
  struct Kernel {
    RayKernel kind = RayKernel::CastEye;
    uint32_t imports_left = 0;
    bool ended = false;
    std::vector<uint32_t> pixels;               // of its threads, as they are known
    uint32_t normal_left = 0, shadow_left = 0;  // rays it may still export
    uint32_t contributions_left = 0;
  };
  enum class Export : uint8_t { EyeRay, SecondaryRay, ShadowRay, Contribution };

  size_t index(uint32_t pixel) const { return static_cast<size_t>(pixel >> 16) * width_ + (pixel & 0xffff); }
  void gone(uint32_t pixel);
  void attribute(int unit, Export kind, uint32_t pixel);
  void add(int unit, Kernel kernel);
  void release_front(int unit);
  void release_complete(int unit);

  uint32_t width_, height_;
  std::vector<uint16_t> live_;               // [pixel] rays, intersections and threads
  std::vector<std::deque<Kernel>> kernels_;  // [unit], oldest first
  uint32_t held_ = 0;
  uint64_t finished_ = 0, releases_ = 0;
  uint32_t rays_to_come_ = 0, shadow_to_come_ = 0;
};

}  // namespace raypool::chip
