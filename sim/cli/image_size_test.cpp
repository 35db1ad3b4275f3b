#include "cli/image_size.hpp"

#include <gtest/gtest.h>

#include "config/configuration.hpp"

namespace raypool {
namespace {

TEST(ImageSize, WidthComesFirst) {
  const ImageSize size = parse_image_size("640x16384");
  EXPECT_EQ(size.width, 640);
  EXPECT_EQ(size.height, 16384);
}

TEST(ImageSize, MalformedSizesAndThoseOutOfRangeAreRefusedWithTheRange) {
  for (const char* text : {"0x0", "0x5", "5x0", "16385x1", "1x16385", "-4x4", "4x-4", "4", "4x", "x4", "4x4x4", "4 x4",
                           "", "99999999999x1"}) {
    try {
      parse_image_size(text);
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("from 1 to 16384"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace raypool
