// Who still works on a pixel. A pixel is held from the launch of its eye kernel until the last of its rays,
// intersections and kernel threads is gone; the ledger counts them exactly, and so knows how many pixels are held and
// how many are finished.
//
// What a thread has exported shows only at the unit's ports, some time after its kernel has ended. So every kernel of a
// unit stays on record until all its exports have provably been seen: as many as it can make, or the first export of a
// later kernel (exports leave in order; with kernel_overlap, of the kernel after the next, which begins when this one
// has ended), or the unit idle. Until then its threads hold their pixels. The count is never too low, and right
// whenever the units are idle.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <systemc>
#include <vector>

#include "chip/interfaces.hpp"
#include "enum_array.hpp"
#include "kernel/kernels.hpp"
#include "machine/packages.hpp"

namespace raypool::chip {

class PixelLedger : public sc_core::sc_module, public LedgerIf, public KernelEventsIf {
 public:
  /// `overlap`: two kernels of a unit may run.
  PixelLedger(const sc_core::sc_module_name& name, uint32_t units, uint32_t width, uint32_t height,
              bool overlap = false);

  /// Is told when a kernel goes off record, so that held() or the rays to come may have fallen, and of what is imported
  /// and exported.
  sc_core::sc_port<DecisionIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> controller{"controller"};
  /// Is told when a pixel is finished; may be empty.
  std::function<void(uint32_t pixel)> on_finished;
  sc_core::sc_export<LedgerIf> records{"records"};
  sc_core::sc_export<KernelEventsIf> kernel_events{"kernel_events"};

  void eye_launched(uint32_t unit, std::vector<uint32_t> pixels) override;
  void launched(uint32_t unit, RayKernel kernel, uint32_t threads) override;
  void imported(uint32_t unit, uint32_t pixel) override;
  /// All warps of the unit's oldest unfinished kernel have ended.
  void kernel_ended(uint32_t unit) override;
  void unit_idle(uint32_t unit) override;

  void ray_exported(uint32_t unit, const Ray& ray, bool kept) override;
  void contribution_exported(uint32_t unit, uint32_t pixel) override;
  void ray_dropped(uint32_t pixel) override { gone(pixel); }

  uint32_t held() const override { return held_; }
  uint64_t finished() const override { return finished_; }
  uint64_t pixels() const override { return uint64_t{width_} * height_; }
  uint32_t rays_to_come() const override { return rays_to_come_; }
  uint32_t shadow_rays_to_come() const override { return shadow_to_come_; }

 private:
  struct Kernel {
    void add(uint32_t pixel);
    /// One of the pixel's threads may still export this, and has now.
    bool exports(uint32_t pixel, uint8_t what);

    RayKernel kind = RayKernel::CastEye;
    uint32_t imports_left = 0;
    bool ended = false;
    uint8_t may_export = 0;                     // a thread; bits as below
    std::vector<uint32_t> pixels;               // of its threads, as they are known
    std::vector<uint8_t> exports_left;          // of each thread
    uint32_t normal_left = 0, shadow_left = 0;  // rays it may still export
    uint32_t contributions_left = 0;
    size_t found = 0;  // in `pixels`, the latest
  };
  static constexpr uint8_t kNormalRay = 1, kShadowRay = 2, kContribution = 4;
  enum class Export : uint8_t { EyeRay, SecondaryRay, ShadowRay, Contribution };

  bool inside(uint32_t pixel) const { return (pixel & 0xffff) < width_ && (pixel >> 16) < height_; }
  size_t index(uint32_t pixel) const { return size_t{pixel >> 16} * width_ + (pixel & 0xffff); }
  void gone(uint32_t pixel);
  void attribute(uint32_t unit, Export kind, uint32_t pixel);
  void add(uint32_t unit, Kernel kernel);
  void release_front(uint32_t unit);
  void release_complete(uint32_t unit);

  uint32_t width_, height_;
  uint32_t together_;                        // kernels of a unit that may run
  std::vector<uint16_t> live_;               // [pixel] rays, intersections and threads
  std::vector<std::deque<Kernel>> kernels_;  // [unit], oldest first
  uint32_t held_ = 0;
  uint64_t finished_ = 0;
  uint32_t rays_to_come_ = 0, shadow_to_come_ = 0;
};

}  // namespace raypool::chip
