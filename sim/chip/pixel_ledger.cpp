#include "chip/pixel_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bits.hpp"

namespace raypool::chip {

PixelLedger::PixelLedger(const sc_core::sc_module_name& name, uint32_t units, uint32_t width, uint32_t height,
                         bool overlap)
    : sc_module(name), width_(width), height_(height), together_(overlap ? 2 : 1), live_(pixels()), kernels_(units) {
  records.bind(*this);
  kernel_events.bind(*this);
}

void PixelLedger::eye_launched(uint32_t unit, std::vector<uint32_t> pixels) {
  for (const uint32_t pixel : pixels) ++live_[index(pixel)];
  held_ += size32(pixels);
  Kernel kernel;
  kernel.normal_left = size32(pixels);
  kernel.may_export = kNormalRay;
  for (const uint32_t pixel : pixels) kernel.add(pixel);
  add(unit, std::move(kernel));
}

void PixelLedger::launched(uint32_t unit, RayKernel kind, uint32_t threads) {
  Kernel kernel;
  kernel.kind = kind;
  kernel.imports_left = threads;
  kernel.pixels.reserve(threads);
  if (kind == RayKernel::Shade) {
    kernel.contributions_left = threads;
    kernel.may_export = kContribution;
  } else {
    kernel.shadow_left = threads;
    kernel.may_export = kShadowRay;
    if (kind == RayKernel::CastSecondary) {
      kernel.normal_left = threads;
      kernel.may_export |= kNormalRay;
    }
  }
  add(unit, std::move(kernel));
}

// Exports come nearly in the order of the threads: the search goes on where the last one ended.
bool PixelLedger::Kernel::exports(uint32_t pixel, uint8_t what) {
  const auto find = [&](size_t from, size_t to) {
    for (size_t i = from; i < to; ++i) {
      if (pixels[i] != pixel || (exports_left[i] & what) == 0) continue;
      exports_left[i] = static_cast<uint8_t>(exports_left[i] & ~what);
      found = i;
      return true;
    }
    return false;
  };
  const size_t last = found;
  return find(last, pixels.size()) || find(0, std::min(last, pixels.size()));
}

void PixelLedger::Kernel::add(uint32_t pixel) {
  pixels.push_back(pixel);
  exports_left.push_back(may_export);
}

void PixelLedger::add(uint32_t unit, Kernel kernel) {
  rays_to_come_ += kernel.normal_left + kernel.shadow_left;
  shadow_to_come_ += kernel.shadow_left;
  kernels_[unit].push_back(std::move(kernel));
}

void PixelLedger::imported(uint32_t unit, uint32_t pixel) {
  for (Kernel& kernel : kernels_[unit]) {
    if (kernel.imports_left == 0) continue;
    --kernel.imports_left;
    kernel.add(pixel);
    for (int i = 0; i < controller.size(); ++i) controller[i]->level_changed();
    return;
  }
  throw std::runtime_error(fmt::format("compute unit {} imports a package that no kernel of it has asked for", unit));
}

void PixelLedger::kernel_ended(uint32_t unit) {
  for (Kernel& kernel : kernels_[unit]) {
    if (kernel.ended) continue;
    kernel.ended = true;
    release_complete(unit);
    return;
  }
  throw std::runtime_error(fmt::format("compute unit {} says that a kernel has ended, but none was launched", unit));
}

void PixelLedger::unit_idle(uint32_t unit) {
  const std::deque<Kernel>& kernels = kernels_[unit];
  while (!kernels.empty() && kernels.front().ended) release_front(unit);
}

void PixelLedger::ray_exported(uint32_t unit, const Ray& ray, bool kept) {
  const uint32_t pixel = ray[word::kPixel];
  // Before attribute(), which may let the thread that made the ray go.
  if (kept && inside(pixel)) ++live_[index(pixel)];
  const uint32_t flags = ray[word::kFlags];
  const Export kind = (flags & kShadowFlag) != 0  ? Export::ShadowRay
                      : (flags & kDepthMask) == 1 ? Export::EyeRay
                                                  : Export::SecondaryRay;
  attribute(unit, kind, pixel);
  for (int i = 0; i < controller.size(); ++i) controller[i]->ray_left(unit, kind == Export::ShadowRay);
}

void PixelLedger::contribution_exported(uint32_t unit, uint32_t pixel) {
  attribute(unit, Export::Contribution, pixel);
  for (int i = 0; i < controller.size(); ++i) controller[i]->contribution_left(unit);
}

void PixelLedger::attribute(uint32_t unit, Export kind, uint32_t pixel) {
  std::deque<Kernel>& kernels = kernels_[unit];
  const auto made = [&](Kernel& kernel) {
    const bool eye = kernel.kind == RayKernel::CastEye, shade = kernel.kind == RayKernel::Shade;
    if (eye != (kind == Export::EyeRay) || shade != (kind == Export::Contribution)) return false;
    const uint8_t what = shade ? kContribution : kind == Export::ShadowRay ? kShadowRay : kNormalRay;
    if (!kernel.exports(pixel, what)) return false;
    --(what == kContribution ? kernel.contributions_left
       : what == kShadowRay  ? kernel.shadow_left
                             : kernel.normal_left);
    return true;
  };
  // If an older kernel could have made it too, it is held to have: that can only keep pixels held for longer, never let
  // them go early.
  uint32_t running = 0;
  for (size_t i = 0; i < kernels.size(); ++i) {
    if (made(kernels[i])) {
      if (kind != Export::Contribution) --rays_to_come_;
      if (kind == Export::ShadowRay) --shadow_to_come_;
      for (; i >= together_; --i) release_front(unit);
      release_complete(unit);
      return;
    }
    if (!kernels[i].ended && ++running == together_) break;
  }
  const EnumArray<Export, const char*, 4> names = {"an eye ray", "a secondary ray", "a shadow ray", "a contribution"};
  throw std::runtime_error(
      fmt::format("compute unit {} exported {} of pixel ({}, {}) that none of its kernels can have made", unit,
                  names[kind], pixel & 0xffff, pixel >> 16));
}

void PixelLedger::release_complete(uint32_t unit) {
  const std::deque<Kernel>& kernels = kernels_[unit];
  while (!kernels.empty() && kernels.front().ended && kernels.front().normal_left == 0 &&
         kernels.front().shadow_left == 0 && kernels.front().contributions_left == 0) {
    release_front(unit);
  }
}

void PixelLedger::release_front(uint32_t unit) {
  std::deque<Kernel>& kernels = kernels_[unit];
  const Kernel kernel = std::move(kernels.front());
  kernels.pop_front();
  rays_to_come_ -= kernel.normal_left + kernel.shadow_left;
  shadow_to_come_ -= kernel.shadow_left;
  for (const uint32_t pixel : kernel.pixels) gone(pixel);
  for (int i = 0; i < controller.size(); ++i) controller[i]->changed();
}

void PixelLedger::gone(uint32_t pixel) {
  if (--live_[index(pixel)] > 0) return;
  --held_;
  ++finished_;
  if (on_finished) on_finished(pixel);
}

}  // namespace raypool::chip
