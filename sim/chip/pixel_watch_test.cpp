#include "chip/pixel_watch.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

namespace raypool::chip {
namespace {

/// A chip with ports that show what a test sets, one event a cycle.
class Ports {
 public:
  explicit Ports(uint32_t units = 1, bool overlap = false, bool shaders = false)
      : watch(frame(units, overlap, shaders), ChipOutputs{}) {}

  PixelWatch watch;

  void ray(uint32_t unit, uint32_t pixel, uint32_t flags, bool kept = true) {
    cycle([&](ChipOutputs& outputs, TraverserPorts&) {
      const bool shadow = (flags & kShadowFlag) != 0;
      outputs.outcome = {true, kept, !kept, shadow, !shadow && flags == 1, static_cast<uint8_t>(unit), pixel};
    });
  }
  void contribution(uint32_t unit, uint32_t pixel) {
    cycle([&](ChipOutputs& outputs, TraverserPorts&) {
      outputs.exported_valid = true;
      outputs.exported_unit = static_cast<uint8_t>(unit);
      outputs.exported_pixel = pixel;
    });
  }
  void import(uint32_t unit, uint32_t pixel) {
    cycle([&](ChipOutputs& outputs, TraverserPorts&) {
      outputs.pixel_valid = true;
      outputs.pixel_unit = static_cast<uint8_t>(unit);
      outputs.to_device.import_beat[word::kPixel % kBeatWords] = pixel;
    });
  }
  /// Up to its end the unit has exported so many packages in all.
  void kernel_ends(uint32_t unit, uint16_t exports) {
    cycle([&](ChipOutputs& outputs, TraverserPorts&) {
      outputs.device.kernel_done = 1u << unit;
      outputs.device.exports[unit] = exports;
    });
  }
  void read(uint32_t place, uint32_t pixel) {
    for (uint32_t beat = 0; beat < kRayBeats; ++beat) {
      cycle([&](ChipOutputs& outputs, TraverserPorts& traverser) {
        outputs.ray_valid = traverser.ray_ready = true;
        outputs.ray_last = beat + 1 == kRayBeats;
        outputs.ray_place = place;
        if (beat == word::kPixel / kBeatWords) outputs.ray_data[word::kPixel % kBeatWords] = pixel;
      });
    }
  }
  void put(uint32_t pixel) {
    for (uint32_t beat = 0; beat < kIntersectionBeats; ++beat) {
      cycle([&](ChipOutputs& outputs, TraverserPorts& traverser) {
        outputs.put_ready = 1u << to_underlying(ImportKind::Normal);
        traverser.put_valid = true;
        traverser.put_kind = ImportKind::Normal;
        if (beat == word::kPixel / kBeatWords) traverser.put_data[word::kPixel % kBeatWords] = pixel;
      });
    }
  }
  void free(uint32_t place) {
    cycle([&](ChipOutputs&, TraverserPorts& traverser) {
      traverser.free_valid = true;
      traverser.free_place = place;
    });
  }
  /// A ray of the pixel becomes an intersection.
  void meets(uint32_t pixel) {
    read(0, pixel);
    put(pixel);
    free(0);
  }

 private:
  static PixelWatch::Frame frame(uint32_t units, bool overlap, bool shaders) {
    PixelWatch::Frame frame;
    frame.width = frame.height = 8;
    frame.units = units;
    frame.places = 4;
    frame.kernel_overlap = overlap;
    frame.shaders = shaders;
    return frame;
  }
  void cycle(const std::function<void(ChipOutputs&, TraverserPorts&)>& show) {
    ChipOutputs outputs;
    TraverserPorts traverser;
    show(outputs, traverser);
    watch.clock(outputs, traverser);
  }
};

TEST(PixelWatch, HoldsAPixelFromItsEyeKernelUntilItsLastRayIsGone) {
  Ports chip;
  chip.watch.eye_launched(0, {1, 2});
  EXPECT_EQ(chip.watch.held(), 2u);
  chip.ray(0, 1, 1);
  chip.ray(0, 2, 1);
  chip.kernel_ends(0, 2);
  EXPECT_EQ(chip.watch.held(), 2u);
  chip.read(3, 2);
  EXPECT_EQ(chip.watch.held(), 2u);
  chip.free(3);  // it hits nothing
  EXPECT_EQ(chip.watch.held(), 1u);
  EXPECT_EQ(chip.watch.finished(), std::vector<uint32_t>{2});

  // Pixel 1: a secondary kernel makes a shadow ray; its reflection is beyond the depth limit.
  chip.meets(1);
  EXPECT_EQ(chip.watch.held(), 1u);
  EXPECT_TRUE(chip.watch.finished().empty());
  chip.watch.launched(0, RayKernel::CastSecondary, 1);
  chip.import(0, 1);
  chip.ray(0, 1, 1 | kShadowFlag);
  chip.ray(0, 1, 2, false);
  chip.kernel_ends(0, 4);
  chip.meets(1);
  chip.watch.launched(0, RayKernel::Shade, 1);
  chip.import(0, 1);
  chip.kernel_ends(0, 5);
  EXPECT_EQ(chip.watch.held(), 1u) << "the contribution has not been seen";
  chip.contribution(0, 1);
  EXPECT_EQ(chip.watch.held(), 0u);
  EXPECT_EQ(chip.watch.finished(), std::vector<uint32_t>{1});
}

TEST(PixelWatch, LetsAKernelGoWhenAllThatItHasExportedIsSeen) {
  Ports chip;
  chip.watch.eye_launched(0, {1, 2, 3, 4});
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.ray(0, pixel, 1);
  chip.kernel_ends(0, 4);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.meets(pixel);
  // Of two secondary kernels the threads of pixels 2 and 4 make nothing.
  chip.watch.launched(0, RayKernel::CastSecondary, 2);
  chip.watch.launched(0, RayKernel::CastSecondary, 2);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.import(0, pixel);
  chip.kernel_ends(0, 5);
  EXPECT_EQ(chip.watch.held(), 4u);
  chip.ray(0, 1, 1 | kShadowFlag);
  EXPECT_EQ(chip.watch.held(), 3u);
  chip.ray(0, 3, 1 | kShadowFlag);
  EXPECT_EQ(chip.watch.held(), 3u) << "its kernel runs";
  chip.kernel_ends(0, 6);
  EXPECT_EQ(chip.watch.held(), 2u);
}

TEST(PixelWatch, BeginsWithWhatEarlierFramesHaveExported) {
  ChipOutputs begin;
  begin.device.exports[0] = 0xffff;
  PixelWatch watch({8, 8, 1, 4, false, {}}, begin);
  watch.eye_launched(0, {1});
  ChipOutputs outputs;
  outputs.outcome = {true, false, true, false, true, 0, 1};
  watch.clock(outputs, {});
  EXPECT_EQ(watch.held(), 1u);
  ChipOutputs end;
  end.device.kernel_done = 1;
  watch.clock(end, {});
  EXPECT_EQ(watch.held(), 0u) << "0xffff packages and one are 0 modulo 2^16";
}

TEST(PixelWatch, WithOverlapExportsOfTwoRunningKernelsMix) {
  Ports chip(1, true);
  chip.watch.eye_launched(0, {1, 2, 3, 4});
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.ray(0, pixel, 1);
  chip.kernel_ends(0, 4);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.meets(pixel);
  // Of the first kernel pixel 1's thread makes nothing, and pixel 2's exports after the second kernel's.
  for (const uint32_t threads : {2, 1, 1}) chip.watch.launched(0, RayKernel::CastSecondaryDirect, threads);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) chip.import(0, pixel);
  chip.ray(0, 3, 1 | kShadowFlag, false);
  EXPECT_THROW(chip.ray(0, 4, 1 | kShadowFlag, false), std::runtime_error) << "two kernels run: the third one waits";
  chip.kernel_ends(0, 6);
  EXPECT_EQ(chip.watch.held(), 4u) << "an export of the first kernel is on its way";
  chip.ray(0, 2, 1 | kShadowFlag, false);
  EXPECT_EQ(chip.watch.held(), 2u);
  chip.ray(0, 4, 1 | kShadowFlag, false);
  EXPECT_EQ(chip.watch.held(), 2u);
}

TEST(PixelWatch, WithOverlapAPixelInBothKernelsIsHeldUntilBothThreadsAreSeen) {
  Ports chip(1, true);
  chip.watch.eye_launched(0, {1});
  chip.ray(0, 1, 1);
  chip.kernel_ends(0, 1);
  // Two shadow rays of pixel 1, from one depth and the next
  for (const uint16_t exports : {3, 5}) {
    chip.meets(1);
    chip.watch.launched(0, RayKernel::CastSecondary, 1);
    chip.import(0, 1);
    chip.ray(0, 1, 1 | kShadowFlag);
    chip.ray(0, 1, 2, exports == 3);
    chip.kernel_ends(0, exports);
  }
  for (int i = 0; i < 2; ++i) chip.meets(1);
  for (int i = 0; i < 2; ++i) {
    chip.watch.launched(0, RayKernel::Shade, 1);
    chip.import(0, 1);
  }
  chip.contribution(0, 1);
  chip.kernel_ends(0, 6);
  EXPECT_EQ(chip.watch.held(), 1u) << "one of the two threads has made nothing yet";
  chip.contribution(0, 1);
  EXPECT_EQ(chip.watch.held(), 1u) << "its kernel runs";
  EXPECT_THROW(chip.contribution(0, 1), std::runtime_error);
  chip.kernel_ends(0, 7);
  EXPECT_EQ(chip.watch.held(), 0u);
}

TEST(PixelWatch, ShadersExportWhatTheyLikeFromThePixelsOfTheirThreads) {
  Ports chip(1, false, true);
  chip.watch.eye_launched(0, {1, 2});
  chip.ray(0, 1, 1);
  chip.contribution(0, 1);
  chip.contribution(0, 7);
  EXPECT_THROW(chip.ray(0, 3, 1, false), std::runtime_error) << "pixel of no thread";
  chip.kernel_ends(0, 3);
  EXPECT_EQ(chip.watch.held(), 1u);
  // The ray comes back, and its thread sends another one, which comes back too.
  for (int bounce = 0; bounce < 2; ++bounce) {
    chip.meets(1);
    chip.watch.launched(0, RayKernel::CastSecondary, 1);
    chip.import(0, 1);
    if (bounce == 0) chip.ray(0, 1, 1);
    chip.contribution(0, 1);
    chip.kernel_ends(0, static_cast<uint16_t>(5 + bounce));
  }
  EXPECT_EQ(chip.watch.held(), 0u);
}

TEST(PixelWatch, RefusesWhatNoKernelCanHaveMade) {
  Ports chip(2);
  chip.watch.eye_launched(0, {1, 2});
  EXPECT_THROW(chip.ray(0, 3, 1), std::runtime_error) << "pixel of no thread";
  EXPECT_THROW(chip.ray(0, 0xffffffff, 1), std::runtime_error) << "pixel outside";
  EXPECT_THROW(chip.ray(1, 1, 1, false), std::runtime_error) << "another unit's";
  EXPECT_THROW(chip.ray(0, 1, 1 | kShadowFlag, false), std::runtime_error) << "shadow ray of an eye kernel";
  EXPECT_THROW(chip.contribution(0, 1), std::runtime_error);
  chip.ray(0, 1, 1);
  chip.ray(0, 2, 1);
  EXPECT_THROW(chip.ray(0, 2, 1, false), std::runtime_error) << "one too many";
  EXPECT_THROW(chip.import(0, 1), std::runtime_error);
  EXPECT_THROW(chip.put(3), std::runtime_error) << "an intersection of a pixel that is not held";
  EXPECT_THROW(chip.free(2), std::runtime_error) << "no ray has been read there";
  chip.kernel_ends(0, 2);
  EXPECT_THROW(chip.kernel_ends(0, 2), std::runtime_error);
}

TEST(PixelWatch, RefusesExportsOfAKernelThatWaitsBehindARunningOne) {
  Ports chip;
  chip.watch.eye_launched(0, {1});
  chip.watch.launched(0, RayKernel::CastSecondary, 1);
  chip.import(0, 1);
  EXPECT_THROW(chip.ray(0, 1, 1 | kShadowFlag), std::runtime_error);
}

}  // namespace
}  // namespace raypool::chip
