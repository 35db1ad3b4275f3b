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

RayCounts counts(uint64_t eye, uint64_t missed, uint64_t shadow, uint64_t wasted) {
  RayCounts rays;
  rays.eye.traced = eye;
  rays.eye.ended = rays.eye.futile = missed;
  rays.shadow.traced = shadow;
  rays.shadow.futile = wasted;
  return rays;
}

/// One triangle, of this size.
Scene triangle(float size) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
  scene.triangles = {{0, 1, 2}};
  return scene;
}

TEST(BlackPicture, SuggestsWhatToMove) {
  const FrameBuffer black(4, 4);
  const Scene scene = triangle(1);
  EXPECT_NE(why_black(black, counts(16, 16, 0, 0), scene, EyeOf::User).find("--eye"), std::string::npos);
  EXPECT_NE(why_black(black, counts(16, 3, 13, 13), scene, EyeOf::User).find("--light"), std::string::npos);
  EXPECT_NE(why_black(black, counts(16, 3, 13, 12), scene, EyeOf::User).find("Kd"), std::string::npos);
}

TEST(BlackPicture, DoesNotSuggestToLeaveOutAViewThatIsLeftOut) {
  const FrameBuffer black(4, 4);
  const RayCounts nothing = counts(16, 16, 0, 0);
  const auto suggests = [&](const Scene& scene, EyeOf eye, const char* what) {
    return why_black(black, nothing, scene, eye).find(what) != std::string::npos;
  };
  const Scene scene = triangle(1), flat = triangle(0);
  EXPECT_TRUE(suggests(scene, EyeOf::User, "leave the view out"));
  EXPECT_FALSE(suggests(scene, EyeOf::File, "leave the view out"));
  EXPECT_FALSE(suggests(scene, EyeOf::Automatic, "leave the view out"));
  EXPECT_TRUE(suggests(scene, EyeOf::Automatic, "scale the scene"));
  EXPECT_TRUE(suggests(scene, EyeOf::File, "the one in the file"));
  for (const EyeOf eye : {EyeOf::User, EyeOf::File, EyeOf::Automatic})
    EXPECT_TRUE(suggests(flat, eye, "no triangle of the scene has an area"));
}

TEST(BlackPicture, OnePixelThatShowsIsEnough) {
  FrameBuffer frame(4, 4);
  frame.add(contribution(1e-6f));  // rounds to 0 of 255
  EXPECT_NE(why_black(frame, counts(16, 0, 16, 15), triangle(1), EyeOf::User), "");
  frame.add(contribution(1e-2f));
  EXPECT_EQ(why_black(frame, counts(16, 0, 16, 14), triangle(1), EyeOf::User), "");
}

}  // namespace
}  // namespace raypool
