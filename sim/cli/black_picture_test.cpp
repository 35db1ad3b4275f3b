#include "cli/black_picture.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace raypool {
namespace {

FrameContribution contribution(float red) {
  FrameContribution result{};
  std::memcpy(result.rgb.data(), &red, sizeof red);
  return result;
}

RayCounts counts(uint64_t eye, uint64_t missed, uint64_t shadow, uint64_t in_vain) {
  RayCounts rays;
  rays.eye.traced = eye;
  rays.eye.ended = rays.eye.futile = missed;
  rays.shadow.traced = shadow;
  rays.shadow.futile = in_vain;
  return rays;
}

TEST(BlackPicture, SaysWhatToMove) {
  const FrameBuffer black(4, 4);
  EXPECT_NE(why_black(black, counts(16, 16, 0, 0)).find("--eye"), std::string::npos);
  EXPECT_NE(why_black(black, counts(16, 3, 13, 13)).find("--light"), std::string::npos);
  EXPECT_NE(why_black(black, counts(16, 3, 13, 12)).find("Kd"), std::string::npos);
}

TEST(BlackPicture, OnePixelThatShowsIsEnough) {
  FrameBuffer frame(4, 4);
  frame.add(contribution(1e-6f));  // rounds to 0 of 255
  EXPECT_NE(why_black(frame, counts(16, 0, 16, 15)), "");
  frame.add(contribution(1e-2f));
  EXPECT_EQ(why_black(frame, counts(16, 0, 16, 14)), "");
}

}  // namespace
}  // namespace raypool
