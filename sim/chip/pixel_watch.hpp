// What still works on each pixel, as the ports of a chip show it. A pixel is held from the launch of its eye kernel
// until the last of its rays, intersections and kernel threads is gone.
//
// A kernel's threads hold their pixels until everything that it has exported has left the unit: how many packages those
// are, the unit reports when the kernel ends (UnitOutputs::exports). A ray holds its pixel until it frees its place in
// the ray pool, an intersection until a thread has imported it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "machine/chip/chip_device.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/packages.hpp"

namespace raypool::chip {

class PixelWatch {
 public:
  /// A machine, and what of a frame it takes to know.
  struct Frame {
    uint32_t width = 0, height = 0;  ///< pixels
    uint32_t units = 1;
    uint32_t places = 512;        ///< of the ray pool
    bool kernel_overlap = false;  ///< two kernels of a unit may run
    RecordLayout layout;          ///< of intersections
    bool shaders = false;         ///< threads export as many packages as they like, and contribute to any pixel
  };

  /// `begin`: what the chip shows in the frame's first cycle.
  PixelWatch(const Frame& frame, const ChipOutputs& begin);

  // Once in a cycle, in this order. They throw std::runtime_error where kernels, units or traverser do what they
  // cannot.
  /// A unit takes an eye kernel of these pixels.
  void eye_launched(uint32_t unit, const std::vector<uint32_t>& pixels);
  /// A unit takes a kernel that imports.
  void launched(uint32_t unit, RayKernel kernel, uint32_t threads);
  /// `traverser`: what it shows, inside or at the ports.
  void clock(const ChipOutputs& outputs, const TraverserPorts& traverser);

  uint32_t held() const { return held_; }
  /// Pixels that have been finished in the last clock().
  const std::vector<uint32_t>& finished() const { return finished_; }

 private:
  static constexpr uint8_t kNormalRay = 1, kShadowRay = 2, kContribution = 4;
  static constexpr uint32_t kNowhere = UINT32_MAX;
  enum class Export : uint8_t { EyeRay, SecondaryRay, ShadowRay, Contribution };

  struct Kernel {
    void add(uint32_t pixel) {
      pixels.push_back(pixel);
      exports_left.push_back(may_export);
    }
    /// One of the pixel's threads could still export this, and has now.
    bool exports(uint32_t pixel, uint8_t what);
    bool has(uint32_t pixel) const { return std::find(pixels.begin(), pixels.end(), pixel) != pixels.end(); }

    RayKernel kind = RayKernel::CastEye;
    uint8_t may_export = 0;  // a thread; bits as above
    uint32_t imports_left = 0;
    std::vector<uint32_t> pixels;       // of its threads, as they are known
    std::vector<uint8_t> exports_left;  // of each thread
    size_t found = 0;                   // in `pixels`, the last one
    bool ended = false;
    uint16_t mark = 0;  // packages of the unit up to its last one, modulo 2^16
  };
  struct Unit {
    std::deque<Kernel> kernels;  // the oldest first
    uint16_t left = 0;           // packages that have left it, modulo 2^16
  };

  bool inside(uint32_t pixel) const { return (pixel & 0xffff) < frame_.width && (pixel >> 16) < frame_.height; }
  uint16_t& live(uint32_t pixel) { return live_[size_t{pixel >> 16} * frame_.width + (pixel & 0xffff)]; }
  /// Something more works on a pixel that is held.
  void more(uint32_t pixel);
  void gone(uint32_t pixel);
  void exported(uint32_t unit, Export kind, uint32_t pixel);
  void imported(uint32_t unit, uint32_t pixel);
  void kernel_ended(uint32_t unit, uint16_t exports);
  /// Kernels of which nothing is left in the unit go.
  void release(Unit& unit);
  void read(const ChipOutputs& outputs);
  void put(const TraverserPorts& traverser);
  void freed(uint32_t place);

  Frame frame_;
  uint32_t beats_;              // of an intersection
  uint32_t together_;           // kernels of a unit that may run
  std::vector<uint16_t> live_;  // [pixel] rays, intersections and threads
  std::vector<Unit> units_;
  std::vector<uint32_t> pixels_;             // [place] of the ray that the traverser has read, or kNowhere
  uint32_t coming_ = 0, leaving_ = 0;        // pixels of the ray that is read, and of the package that is put
  uint32_t ray_beat_ = 0, record_beat_ = 0;  // that come next
  uint32_t held_ = 0;
  std::vector<uint32_t> finished_;
};

}  // namespace raypool::chip
