#include "chip/pixel_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bits.hpp"
#include "enum_array.hpp"
#include "machine/chip/intersection_pool.hpp"

namespace raypool::chip {

PixelWatch::PixelWatch(const Frame& frame, const ChipOutputs& begin)
    : frame_(frame),
      beats_(raypool::IntersectionPool::beats(frame.layout.words)),
      together_(frame.kernel_overlap ? 2 : 1),
      live_(size_t{frame.width} * frame.height),
      units_(frame.units),
      pixels_(frame.places, kNowhere) {
  // Nothing is under way: what kernels have exported has left.
  for (uint32_t unit = 0; unit < frame.units; ++unit) units_[unit].left = begin.device.exports[unit];
}

void PixelWatch::eye_launched(uint32_t unit, const std::vector<uint32_t>& pixels) {
  Kernel kernel;
  kernel.may_export = kNormalRay;
  for (const uint32_t pixel : pixels) {
    ++live(pixel);
    kernel.add(pixel);
  }
  held_ += size32(pixels);
  units_[unit].kernels.push_back(std::move(kernel));
}

void PixelWatch::launched(uint32_t unit, RayKernel kind, uint32_t threads) {
  Kernel kernel;
  kernel.kind = kind;
  kernel.may_export = kind == RayKernel::Shade           ? kContribution
                      : kind == RayKernel::CastSecondary ? kNormalRay | kShadowRay
                                                         : kShadowRay;
  kernel.imports_left = threads;
  kernel.pixels.reserve(threads);
  kernel.exports_left.reserve(threads);
  units_[unit].kernels.push_back(std::move(kernel));
}

// What the chip shows of exports has happened in the cycle before.
void PixelWatch::clock(const ChipOutputs& outputs, const TraverserPorts& traverser) {
  finished_.clear();
  const ChipOutputs::Outcome& outcome = outputs.outcome;
  if (outcome.valid) {
    // Before exported(), which may let the thread go that has made the ray.
    if (outcome.kept) more(outcome.pixel);
    exported(outcome.unit,
             outcome.shadow ? Export::ShadowRay
             : outcome.eye  ? Export::EyeRay
                            : Export::SecondaryRay,
             outcome.pixel);
  }
  if (outputs.exported_valid) exported(outputs.exported_unit, Export::Contribution, outputs.exported_pixel);
  if (outputs.pixel_valid) imported(outputs.pixel_unit, outputs.to_device.import_beat[word::kPixel % kBeatWords]);
  for (uint32_t done = outputs.device.kernel_done; done != 0; done &= done - 1)
    kernel_ended(lowest(done), outputs.device.exports[lowest(done)]);
  if (outputs.ray_valid && traverser.ray_ready) read(outputs);
  if (traverser.put_valid && (outputs.put_ready >> to_underlying(traverser.put_kind) & 1) != 0) put(traverser);
  if (traverser.free_valid) freed(traverser.free_place);
}

// Exports come nearly in the order of the threads: the search goes on where the last one ended.
bool PixelWatch::Kernel::exports(uint32_t pixel, uint8_t what) {
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

// Of two kernels that run and could have made it the older one is held to have: together they can make no more.
void PixelWatch::exported(uint32_t number, Export kind, uint32_t pixel) {
  const auto made = [&](Kernel& kernel) {
    if (frame_.shaders) return kind == Export::Contribution || kernel.has(pixel);
    const bool eye = kernel.kind == RayKernel::CastEye, shade = kernel.kind == RayKernel::Shade;
    if (eye != (kind == Export::EyeRay) || shade != (kind == Export::Contribution)) return false;
    return kernel.exports(pixel, shade ? kContribution : kind == Export::ShadowRay ? kShadowRay : kNormalRay);
  };
  Unit& unit = units_[number];
  uint32_t running = 0;
  for (Kernel& kernel : unit.kernels) {
    if (made(kernel)) {
      ++unit.left;
      release(unit);
      return;
    }
    if (!kernel.ended && ++running == together_) break;
  }
  const EnumArray<Export, const char*, 4> names = {"an eye ray", "a secondary ray", "a shadow ray", "a contribution"};
  throw std::runtime_error(
      fmt::format("compute unit {} exported {} of pixel ({}, {}) that none of its kernels can have made", number,
                  names[kind], pixel & 0xffff, pixel >> 16));
}

void PixelWatch::imported(uint32_t number, uint32_t pixel) {
  for (Kernel& kernel : units_[number].kernels) {
    if (kernel.imports_left == 0) continue;
    --kernel.imports_left;
    kernel.add(pixel);  // it holds the pixel in place of the intersection
    return;
  }
  throw std::runtime_error(fmt::format("compute unit {} imports a package that no kernel of it has asked for", number));
}

void PixelWatch::kernel_ended(uint32_t number, uint16_t exports) {
  Unit& unit = units_[number];
  for (Kernel& kernel : unit.kernels) {
    if (kernel.ended) continue;
    kernel.ended = true;
    kernel.mark = exports;
    release(unit);
    return;
  }
  throw std::runtime_error(
      fmt::format("compute unit {} reports that a kernel has ended, but none was launched", number));
}

void PixelWatch::release(Unit& unit) {
  const auto drained = [&](const Kernel& kernel) { return kernel.ended && ((unit.left - kernel.mark) & 0x8000) == 0; };
  for (; !unit.kernels.empty() && drained(unit.kernels.front()); unit.kernels.pop_front())
    for (const uint32_t pixel : unit.kernels.front().pixels) gone(pixel);
}

void PixelWatch::read(const ChipOutputs& outputs) {
  if (ray_beat_++ == word::kPixel / kBeatWords) coming_ = outputs.ray_data[word::kPixel % kBeatWords];
  if (!outputs.ray_last) return;
  ray_beat_ = 0;
  pixels_[outputs.ray_place] = coming_;
}

void PixelWatch::put(const TraverserPorts& traverser) {
  const uint32_t place = frame_.layout.place[word::kPixel];
  if (record_beat_ == place / kBeatWords) leaving_ = traverser.put_data[place % kBeatWords];
  if (++record_beat_ < beats_) return;
  record_beat_ = 0;
  more(leaving_);
}

void PixelWatch::freed(uint32_t place) {
  if (pixels_[place] == kNowhere)
    throw std::runtime_error(
        fmt::format("the traverser frees place {} of the ray pool, of which it has no ray", place));
  gone(std::exchange(pixels_[place], kNowhere));
}

void PixelWatch::more(uint32_t pixel) {
  if (!inside(pixel) || live(pixel) == 0) {
    throw std::runtime_error(fmt::format("a ray or an intersection is of pixel ({}, {}), on which nothing works",
                                         pixel & 0xffff, pixel >> 16));
  }
  ++live(pixel);
}

void PixelWatch::gone(uint32_t pixel) {
  if (--live(pixel) > 0) return;
  --held_;
  finished_.push_back(pixel);
}

}  // namespace raypool::chip
