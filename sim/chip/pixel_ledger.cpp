#include "chip/pixel_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bits.hpp"

namespace raypool::chip {

PixelLedger::PixelLedger(const sc_core::sc_module_name& name, uint32_t units, uint32_t width, uint32_t height)
    : sc_module(name), width_(width), height_(height), live_(pixels()), kernels_(units) {
  records.bind(*this);
  kernel_events.bind(*this);
}

void PixelLedger::eye_launched(uint32_t unit, std::vector<uint32_t> pixels) {
  for (const uint32_t pixel : pixels) ++live_[index(pixel)];
  held_ += size32(pixels);
  Kernel kernel;
  kernel.normal_left = size32(pixels);
  kernel.pixels = std::move(pixels);
  add(unit, std::move(kernel));
}

void PixelLedger::launched(uint32_t unit, RayKernel kind, uint32_t threads) {
  Kernel kernel;
  kernel.kind = kind;
  kernel.imports_left = threads;
  kernel.pixels.reserve(threads);
  if (kind == RayKernel::Shade) {
    kernel.contributions_left = threads;
  } else {
    kernel.shadow_left = threads;
    if (kind == RayKernel::CastSecondary) kernel.normal_left = threads;
  }
  add(unit, std::move(kernel));
}

// Exports come nearly in the order of the threads: the search goes on where the last one ended.
bool PixelLedger::Kernel::has(uint32_t pixel) {
  const auto begin = pixels.begin(), end = pixels.end(), last = begin + found;
  auto place = std::find(last, end, pixel);
  if (place == end) {
    place = std::find(begin, last, pixel);
    if (place == last) return false;
  }
  found = place - begin;
  return true;
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
    kernel.pixels.push_back(pixel);
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
}

void PixelLedger::contribution_exported(uint32_t unit, uint32_t pixel) { attribute(unit, Export::Contribution, pixel); }

void PixelLedger::attribute(uint32_t unit, Export kind, uint32_t pixel) {
  std::deque<Kernel>& kernels = kernels_[unit];
  const auto made = [&](Kernel& kernel) {
    const bool eye = kernel.kind == RayKernel::CastEye, shade = kernel.kind == RayKernel::Shade;
    if (eye != (kind == Export::EyeRay) || shade != (kind == Export::Contribution)) return false;
    uint32_t& left = shade                       ? kernel.contributions_left
                     : kind == Export::ShadowRay ? kernel.shadow_left
                                                 : kernel.normal_left;
    if (left == 0 || !kernel.has(pixel)) return false;
    --left;
    return true;
  };
  // If an older kernel could have made it too, it is held to have: that can only keep pixels held for longer, never let
  // them go early.
  for (size_t i = 0; i < kernels.size(); ++i) {
    if (made(kernels[i])) {
      if (kind != Export::Contribution) --rays_to_come_;
      if (kind == Export::ShadowRay) --shadow_to_come_;
      for (; i > 0; --i) release_front(unit);
      release_complete(unit);
      return;
    }
    if (!kernels[i].ended) break;
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
}

}  // namespace raypool::chip
