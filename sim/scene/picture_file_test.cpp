#include "scene/picture_file.hpp"

#include <gtest/gtest.h>

namespace raypool {
namespace {

/// A hundred pixels of a middle grey, and the first of them of other colours.
Picture grey_but(const std::vector<std::vector<uint8_t>>& first) {
  Picture picture = {10, 10, std::vector<uint8_t>(300, 100)};
  size_t place = 0;
  for (const std::vector<uint8_t>& pixel : first) {
    for (const uint8_t channel : pixel) picture.rgb[place++] = channel;
  }
  return picture;
}

TEST(PictureDifference, CountsPixelsThatAreOffByTwoOrMoreInAnyChannel) {
  const Picture grey = grey_but({});
  const PictureDifference rounded = difference_of(grey, grey_but({{101, 99, 101}}));
  EXPECT_EQ(rounded.differ, 1u);
  EXPECT_EQ(rounded.off_by_more, 0u);
  const std::vector<std::vector<uint8_t>> one_each = {{102, 100, 100}, {100, 98, 100}, {100, 100, 102}};
  EXPECT_EQ(difference_of(grey, grey_but(one_each)).off_by_more, 3u);
  EXPECT_EQ(difference_of(grey_but(one_each), grey).off_by_more, 3u) << "whichever is the brighter";
  EXPECT_EQ(difference_of(grey, grey_but({{0, 0, 255}})).off_by_more, 1u) << "a pixel, not its channels";
}

TEST(PictureDifference, PassesWithAtMostOnePercentOfThePixelsOff) {
  const Picture grey = grey_but({});
  const PictureDifference at_the_edge = difference_of(grey, grey_but({{0, 0, 0}}));
  EXPECT_EQ(at_the_edge.share_off(), 0.01);
  EXPECT_TRUE(at_the_edge.passes());
  const PictureDifference beyond = difference_of(grey, grey_but({{0, 0, 0}, {98, 100, 100}}));
  EXPECT_EQ(beyond.share_off(), 0.02);
  EXPECT_FALSE(beyond.passes());
  EXPECT_TRUE(difference_of(grey, grey_but({{0, 0, 0}, {99, 100, 101}})).passes()) << "a step of 1 is none";
}

}  // namespace
}  // namespace raypool
