// Records as the Verilog has them (isa/records.hpp) beside what the model holds.
#include "isa/records.hpp"

#include <gtest/gtest.h>

#include <cstddef>

#include "machine/common/packages.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool {
namespace {

TEST(Records, RayLiesWordByWordAsItsPackage) {
  EXPECT_EQ(record::kRay.bits(), 32 * kRayWords);
  EXPECT_EQ(record::kRay.low("origin"), 32 * word::kOrigin);
  EXPECT_EQ(record::kRay.low("direction"), 32 * word::kDirection);
  EXPECT_EQ(record::kRay.low("limit"), 32 * word::kLimit);
  EXPECT_EQ(record::kRay.low("pixel"), 32 * word::kPixel);
  EXPECT_EQ(record::kRay.low("color"), 32 * word::kColor);
  EXPECT_EQ(record::kRay.low("depth"), 32 * word::kFlags);
  EXPECT_EQ(1u << (record::kRay.low("unused") - 32 * word::kFlags), kDepthMask + 1);
  EXPECT_EQ(1u << (record::kRay.low("shadow") - 32 * word::kFlags), kShadowFlag);
}

TEST(Records, TriangleAndItsTestBeginAsTheModelsTriangle) {
  EXPECT_EQ(record::kTriangle.bits(), static_cast<int>(32 * LeafReader::kTriangleWords));
  for (const Record& each : {record::kTriangle, record::kTest}) {
    EXPECT_EQ(each.low("corners"), static_cast<int>(8 * offsetof(Triangle, corners)));
    EXPECT_EQ(each.low("number"), static_cast<int>(8 * offsetof(Triangle, number)));
  }
  EXPECT_EQ(record::kTest.low("origin"), static_cast<int>(8 * sizeof(Triangle)));
}

TEST(Records, RefuseAFieldThatTheyDoNotHave) { EXPECT_THROW(record::kTest.low("material"), std::logic_error); }

}  // namespace
}  // namespace raypool
