#include "chip/pixel_ledger.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "chip/simulation.hpp"

namespace raypool::chip {
namespace {

Ray ray_of(uint32_t pixel, uint32_t flags) {
  Ray ray{};
  ray[word::kPixel] = pixel;
  ray[word::kFlags] = flags;
  return ray;
}

TEST(PixelLedger, HoldsAPixelFromItsEyeKernelUntilItsLastRayIsGone) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8);
  ledger.eye_launched(0, {1, 2});
  EXPECT_EQ(ledger.held(), 2u);
  ledger.ray_exported(0, ray_of(1, 1), true);
  ledger.ray_exported(0, ray_of(2, 1), true);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 2u);
  ledger.ray_dropped(2);
  EXPECT_EQ(ledger.held(), 1u);
  EXPECT_EQ(ledger.finished(), 1u);

  // Pixel 1: a secondary kernel makes a shadow ray; its reflection is beyond the depth limit.
  ledger.launched(0, RayKernel::CastSecondary, 1);
  EXPECT_EQ(ledger.shadow_rays_to_come(), 1u);
  EXPECT_EQ(ledger.rays_to_come(), 2u);
  ledger.imported(0, 1);
  ledger.ray_exported(0, ray_of(1, 1 | kShadowFlag), true);
  EXPECT_EQ(ledger.shadow_rays_to_come(), 0u);
  ledger.ray_exported(0, ray_of(1, 2), false);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 1u);
  ledger.launched(0, RayKernel::Shade, 1);
  ledger.imported(0, 1);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 1u) << "the contribution has not been seen";
  ledger.contribution_exported(0, 1);
  EXPECT_EQ(ledger.held(), 0u);
  EXPECT_EQ(ledger.finished(), 2u);
}

TEST(PixelLedger, LetsAKernelGoWhenALaterOneExports) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8);
  ledger.eye_launched(0, {1, 2, 3, 4});
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) ledger.ray_exported(0, ray_of(pixel, 1), true);
  ledger.kernel_ended(0);
  // Two secondary kernels; the thread of pixel 2 makes nothing, which shows when pixel 3 exports.
  ledger.launched(0, RayKernel::CastSecondary, 2);
  ledger.launched(0, RayKernel::CastSecondary, 2);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) ledger.imported(0, pixel);
  ledger.kernel_ended(0);
  ledger.ray_exported(0, ray_of(1, 1 | kShadowFlag), true);
  EXPECT_EQ(ledger.held(), 4u);
  ledger.ray_exported(0, ray_of(3, 1 | kShadowFlag), true);
  EXPECT_EQ(ledger.held(), 3u);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 3u);
  ledger.unit_idle(0);
  EXPECT_EQ(ledger.held(), 2u);  // 1 and 3 have rays; 2 and 4 never made one
  EXPECT_EQ(ledger.rays_to_come(), 0u);
}

TEST(PixelLedger, KeepsARunningKernelOfAnIdleLookingUnit) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8);
  ledger.eye_launched(0, {1});
  ledger.unit_idle(0);
  EXPECT_EQ(ledger.held(), 1u);
  EXPECT_EQ(ledger.rays_to_come(), 1u);
}

TEST(PixelLedger, RefusesExportsOfAKernelThatWaitsBehindARunningOne) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8);
  ledger.eye_launched(0, {1});
  ledger.launched(0, RayKernel::CastSecondary, 1);
  ledger.imported(0, 1);
  EXPECT_THROW(ledger.ray_exported(0, ray_of(1, 1 | kShadowFlag), true), std::runtime_error);
}

TEST(PixelLedger, WithOverlapExportsOfTwoRunningKernelsMix) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8, true);
  ledger.eye_launched(0, {1, 2, 3, 4});
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) ledger.ray_exported(0, ray_of(pixel, 1), true);
  ledger.kernel_ended(0);
  ledger.unit_idle(0);
  // Of the first kernel pixel 1's thread makes nothing, and pixel 2's exports after the second kernel's.
  for (const uint32_t threads : {2, 1, 1}) ledger.launched(0, RayKernel::CastSecondaryDirect, threads);
  for (uint32_t pixel = 1; pixel <= 4; ++pixel) ledger.imported(0, pixel);
  EXPECT_EQ(ledger.held(), 4u);
  ledger.ray_exported(0, ray_of(3, 1 | kShadowFlag), false);
  ledger.ray_exported(0, ray_of(2, 1 | kShadowFlag), false);
  EXPECT_THROW(ledger.ray_exported(0, ray_of(4, 1 | kShadowFlag), false), std::runtime_error)
      << "two kernels run: the third one waits";
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 4u) << "the first kernel may still have an export on its way, of pixel 1";
  // The third kernel exports, so the first one has no export left; the second one may have.
  ledger.ray_exported(0, ray_of(4, 1 | kShadowFlag), false);
  EXPECT_EQ(ledger.held(), 2u);
  EXPECT_EQ(ledger.finished(), 2u);
}

TEST(PixelLedger, WithOverlapAPixelInBothKernelsIsHeldUntilBothThreadsAreSeen) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 1, 8, 8, true);
  ledger.eye_launched(0, {1});
  ledger.ray_exported(0, ray_of(1, 1), true);
  ledger.kernel_ended(0);
  // Two shadow rays of pixel 1, from one depth and the next
  for (const bool reflects : {true, false}) {
    ledger.launched(0, RayKernel::CastSecondary, 1);
    ledger.imported(0, 1);
    ledger.ray_exported(0, ray_of(1, 1 | kShadowFlag), true);
    ledger.ray_exported(0, ray_of(1, 2), reflects);
    ledger.kernel_ended(0);
  }
  for (int i = 0; i < 2; ++i) {
    ledger.launched(0, RayKernel::Shade, 1);
    ledger.imported(0, 1);
  }
  ledger.contribution_exported(0, 1);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 1u) << "one of the two threads has made nothing yet";
  ledger.contribution_exported(0, 1);
  EXPECT_EQ(ledger.held(), 1u) << "its kernel runs";
  EXPECT_THROW(ledger.contribution_exported(0, 1), std::runtime_error);
  ledger.kernel_ended(0);
  EXPECT_EQ(ledger.held(), 0u);
  EXPECT_EQ(ledger.finished(), 1u);
}

TEST(PixelLedger, RefusesExportsThatNoKernelCanHaveMade) {
  const Simulation simulation;
  PixelLedger ledger("pixel_ledger", 2, 8, 8);
  ledger.eye_launched(0, {1, 2});
  EXPECT_THROW(ledger.ray_exported(0, ray_of(3, 1), true), std::runtime_error) << "pixel of no thread";
  EXPECT_THROW(ledger.ray_exported(0, ray_of(0xffffffff, 1), true), std::runtime_error) << "pixel outside";
  EXPECT_THROW(ledger.ray_exported(1, ray_of(1, 1), true), std::runtime_error) << "another unit's";
  EXPECT_THROW(ledger.ray_exported(0, ray_of(1, 1 | kShadowFlag), true), std::runtime_error)
      << "shadow ray of an eye kernel";
  EXPECT_THROW(ledger.contribution_exported(0, 1), std::runtime_error);
  ledger.ray_exported(0, ray_of(1, 1), true);
  ledger.ray_exported(0, ray_of(2, 1), true);
  EXPECT_THROW(ledger.ray_exported(0, ray_of(2, 1), true), std::runtime_error) << "one too many";
  EXPECT_THROW(ledger.imported(0, 1), std::runtime_error);
  ledger.kernel_ended(0);
  EXPECT_THROW(ledger.kernel_ended(0), std::runtime_error);
}

}  // namespace
}  // namespace raypool::chip
