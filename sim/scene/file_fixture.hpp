// For tests of scene files: a folder that is gone afterwards, and what a file is refused with.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"

namespace raypool {

class FileFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = ::testing::TempDir() + "raypool_" + test->test_suite_name() + "_" + test->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << bytes;
    return folder_ + "/" + name;
  }
  /// The message without the folder's name; empty when nothing is refused.
  std::string refusal(const std::function<void()>& load) const {
    try {
      load();
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.rfind(folder_ + "/", 0) == 0 ? message.substr(folder_.size() + 1) : message;
    }
    return "";
  }
  /// The folder's name left out.
  std::vector<std::string> warnings(const Scene& scene) const {
    std::vector<std::string> texts;
    for (std::string text : scene.warnings) {
      for (size_t at = text.find(folder_ + "/"); at != std::string::npos; at = text.find(folder_ + "/"))
        text.erase(at, folder_.size() + 1);
      texts.push_back(text);
    }
    return texts;
  }

  std::string folder_;
};

template <typename Number>
void append(std::string& bytes, Number value, bool big_endian = false) {
  std::string part(sizeof value, '\0');
  std::memcpy(part.data(), &value, sizeof value);
  bytes += big_endian ? std::string(part.rbegin(), part.rend()) : part;
}

/// The corners of all triangles, one after the other.
inline std::vector<Vec3> corners_of(const Scene& scene) {
  std::vector<Vec3> corners;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) corners.push_back(scene.corner(i, k));
  }
  return corners;
}

/// What the native engine draws, as PNG.
inline std::vector<uint8_t> picture_of(const Scene& scene) {
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  const Tracer tracer(scene, image.material_base);
  NativeOptions options;
  options.width = 48;
  options.height = 36;
  options.depth = 3;
  options.reflections = scene.reflects();
  return encode_png(render_native(scene, image, tracer, options));
}

}  // namespace raypool
