// The shader set `path` beside the reference: it converges to the same picture, as fast as independent samples do, and
// seeded bugs in it are detected. Every picture has the same random numbers each time.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "config/data_folder.hpp"
#include "convergence/comparison.hpp"
#include "convergence/furnace.hpp"
#include "convergence/microfacets.hpp"
#include "convergence/reflection.hpp"

namespace raypool::convergence {
namespace {

namespace fs = std::filesystem;

constexpr double kSigmas = 4;         // nothing is off by so many standard errors by chance
constexpr double kMostScatter = 1.6;  // of blocks that differ by noise alone, whose variances are estimates too

Vec3d slanted(double cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }

Reflection::Surface surface(double metallic, double roughness) {
  return {{0, 0, 1}, {0, 0, 1}, {0.9, 0.6, 0.3}, metallic, roughness};
}

/// Of all light that comes evenly from everywhere, by quadrature over directions that are close at the mirrored one.
Vec3d reflected(const Reflection::Surface& surface, double cosine) {
  const Vec3d viewer = slanted(cosine);
  const Reflection reflection(surface, viewer);
  const Frame about(normalized(Vec3d{-viewer.x, 0, viewer.z}));
  constexpr int kSteps = 600;
  Vec3d sum;
  for (int i = 0; i < kSteps; ++i) {
    const double from = static_cast<double>(i) / kSteps, to = static_cast<double>(i + 1) / kSteps;
    const double height = 1 - (from * from * from + to * to * to),
                 solid = 4 * kPi * (to * to * to - from * from * from);
    const double radius = std::sqrt(std::max(1 - height * height, 0.0));
    for (int j = 0; j < kSteps; ++j) {
      const double angle = 2 * kPi * (j + 0.5) / kSteps;
      sum = sum + reflection.value(about.out_of(radius * std::cos(angle), radius * std::sin(angle), height)) *
                      (solid / kSteps);
    }
  }
  return sum;
}

TEST(Reflection, SamplesAsItsDensitySays) {
  Random random(1);
  for (const double metallic : {0.0, 0.5, 1.0}) {
    for (const double roughness : {0.3, 1.0}) {
      for (const double cosine : {0.3, 0.9}) {
        const Reflection reflection(surface(metallic, roughness), slanted(cosine));
        Spread estimate;
        for (int i = 0; i < 40000; ++i) {
          const Vec3d direction = reflection.sample(random);
          estimate.add(reflection.value(direction).x / reflection.density(direction));
        }
        EXPECT_NEAR(estimate.mean(), reflected(surface(metallic, roughness), cosine).x,
                    kSigmas * std::sqrt(estimate.variance_of_mean()))
            << metallic << ", " << roughness << ", " << cosine;
      }
    }
  }
}

TEST(Reflection, OfAWhiteSurfaceIsAllLight) {
  for (const double roughness : {0.3, 0.6, 1.0}) {
    for (const double cosine : {0.15, 0.5, 1.0}) {
      Reflection::Surface white = surface(0, roughness);
      white.color = {1, 1, 1};
      EXPECT_NEAR(reflected(white, cosine).x, 1, 0.002) << roughness << ", " << cosine;
    }
  }
}

Scene scene_of(const std::string& name, float fov = 0) {
  SceneOptions options;
  options.surfaces = true;
  if (fov > 0) options.changes.fov = fov;
  return load_scene(name, options);
}

/// A scene without what makes rare bright samples, glass and smooth metal: few have little noise then.
Scene roughened(Scene scene) {
  constexpr float kRough = 0.5f;
  Surfaces surfaces = *scene.surfaces;
  for (SurfaceMaterial& material : surfaces.materials) {
    material.transmission = 0;
    material.roughness = std::max(material.roughness, kRough);
  }
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

/// In this view the lamp, whose edges are noisy too, is outside.
Scene rough_box() {
  constexpr float kNarrow = 24;
  return roughened(scene_of("area-light", kNarrow));
}

/// The room with a lamp that is a point, which shines through the box and the ball in it: half of the light passes each
/// of their sides.
Scene sheer_room() {
  Scene scene = roughened(scene_of("cornell"));
  Surfaces surfaces = *scene.surfaces;
  for (uint32_t i = 0; i < surfaces.materials.size(); ++i) {
    if (scene.materials[i].name != "mirror" && scene.materials[i].name != "gold") continue;
    surfaces.materials[i].alpha_mode = AlphaMode::Blend;
    surfaces.materials[i].base_color[3] = 0.5f;
  }
  scene.surfaces = std::make_shared<const Surfaces>(std::move(surfaces));
  return scene;
}

std::string described(const Comparison& c) {
  return fmt::format("whole {:.2f}% +- {:.2f}%; blocks {:.2f}%, noise {:.2f}%, scatter {:.2f}", 100 * c.whole,
                     100 * c.whole_error, 100 * c.typical, 100 * c.noise, c.scatter);
}

bool agrees(const Comparison& c) { return std::fabs(c.whole) < kSigmas * c.whole_error && c.scatter < kMostScatter; }

class PathSet : public testing::Test {
 protected:
  PathSet() { fs::current_path(data_folder()); }
  ~PathSet() override { fs::current_path(before_); }

  static Task task(uint32_t depth, uint32_t samples) {
    Task task;
    task.size = {32, 32, depth, samples};
    task.block = 8;
    task.reference_samples = 2 * samples;
    return task;
  }
  static Comparison compared(const Task& task, const Scene& scene) {
    return compare(draw_with_shaders(task, scene), draw_reference(task, scene));
  }

 private:
  const fs::path before_ = fs::current_path();
};

TEST_F(PathSet, ConvergesToTheReference) {
  struct Case {
    const Scene scene;
    uint32_t depth, samples;
    double error;  // more were too noisy to tell
  };
  const std::vector<Case> cases = {{rough_box(), 1, 512, 0.003},
                                   {rough_box(), 5, 96, 0.01},
                                   {sheer_room(), 4, 96, 0.02},
                                   {roughened(scene_of("features")), 1, 96, 0.03}};
  for (const Case& each : cases) {
    const Comparison found = compared(task(each.depth, each.samples), each.scene);
    fmt::print("{} at depth {}: {}\n", each.scene.name, each.depth, described(found));
    EXPECT_TRUE(agrees(found)) << each.scene.name << " at depth " << each.depth;
    EXPECT_LT(found.whole_error, each.error);
  }
}

TEST_F(PathSet, ConvergesToTheReferenceInEveryScene) {
  // Points that shine onto smooth metal make rare bright samples: errors are those of the noise, not of the picture.
  for (const char* name : {"cornell", "area-light", "courtyard", "features"}) {
    const Comparison found = compared(task(8, 384), scene_of(name));
    fmt::print("{}: {}\n", name, described(found));
    EXPECT_TRUE(agrees(found)) << name;
  }
}

TEST_F(PathSet, VarianceFallsAsSamplesAreAdded) {
  constexpr uint32_t kFew = 4, kMany = 32;
  VarianceOfPictures few(kFew), many(kMany);
  const PictureSpread all = draw_with_shaders(task(3, 768), rough_box(), [&](const BlockMeans& sample) {
    few.add(sample);
    many.add(sample);
  });
  EXPECT_NEAR(few.relative(all) * kFew / (many.relative(all) * kMany), 1, 0.15);
}

/// Of the brightness of blocks that are to be 1.
double most_off(const PictureSpread& picture) {
  double most = 0;
  for (const Spread& block : picture.blocks()) most = std::max(most, std::fabs(block.mean() - 1));
  return most;
}

TEST_F(PathSet, AWhiteBallVanishesInAFurnace) {
  for (const float roughness : {0.3f, 1.0f}) {
    SurfaceMaterial white;
    white.roughness = roughness;
    const Scene scene = furnace(white, Finds::ByChance);
    EXPECT_LT(most_off(draw_with_shaders(task(2, 512), scene)), 0.005) << roughness;
    EXPECT_LT(most_off(draw_reference(task(2, 256), scene)), 0.005) << roughness;
  }
}

TEST_F(PathSet, AGlassBallVanishesInAFurnace) {
  SurfaceMaterial glass;
  glass.roughness = 0;
  glass.transmission = 1;
  // Between flat faces some light is mirrored many times.
  EXPECT_LT(most_off(draw_with_shaders(task(120, 16), furnace(glass, Finds::ByChance))), 0.005);
}

TEST_F(PathSet, ShadowRaysFindTheWholeFurnace) {
  const PictureSpread picture = draw_with_shaders(task(1, 128), furnace(SurfaceMaterial{}, Finds::ByShadowRays));
  EXPECT_NEAR(picture.whole().mean(), 1, std::min(0.01, kSigmas * std::sqrt(picture.whole().variance_of_mean())));
}

/// A copy of the set, to change.
class SeededBug : public PathSet {
 protected:
  SeededBug() : folder_(fs::path(testing::TempDir()) / fmt::format("raypool-seeded-{}", ::getpid())) {
    fs::copy("shaders/path", folder_, fs::copy_options::recursive);
    for (const char* file : {"raypool.glsl", "sampling.glsl"}) fs::copy(fs::path("shaders") / file, folder_ / file);
  }
  ~SeededBug() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  /// What the set draws when one place of the file is another.
  PictureSpread with(const std::string& file, const std::string& right, const std::string& wrong, Task seeded,
                     const Scene& scene) const {
    std::stringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    const std::string original = text.str();
    const size_t place = original.find(right);
    EXPECT_NE(place, std::string::npos) << file << " has no '" << right << "'";
    std::string changed = original;
    if (place != std::string::npos) changed.replace(place, right.size(), wrong);
    std::ofstream(folder_ / file) << changed;
    seeded.set = folder_.string();
    PictureSpread drawn = draw_with_shaders(seeded, scene);
    std::ofstream(folder_ / file) << original;
    return drawn;
  }

 private:
  const fs::path folder_;
};

TEST_F(SeededBug, IsDetected) {
  struct Bug {
    const char *name, *file, *right, *wrong;
  };
  const std::vector<Bug> bugs = {
      {"a cosine too many", "path.rchit", "passed = matt / (1.0 - shine);",
       "passed = matt * max(dot(bounce, normal), 0.0) / (1.0 - shine);"},
      {"no 1/pi", "path.rchit", "matt * (cosine / pi)", "matt * cosine"},
      {"a wrong density of light", "raypool.glsl", "0.5 * abs(dot(twice", "abs(dot(twice"},
      {"shares that do not add up", "path.rchit", "if (density > 0.0) {", "if (false) {"},
      {"paths that end for nothing", "path.rchit", "path.weight /= keep;", ""},
  };
  const Scene box = rough_box();
  const PictureSpread reference = draw_reference(task(5, 96), box);
  for (const Bug& bug : bugs) {
    const Comparison found = compare(with(bug.file, bug.right, bug.wrong, task(5, 96), box), reference);
    fmt::print("{}: {}\n", bug.name, described(found));
    EXPECT_FALSE(agrees(found)) << bug.name;
  }
}

TEST_F(SeededBug, IsDetectedBehindHoles) {
  struct Bug {
    const char *name, *right, *wrong;
  };
  const std::vector<Bug> bugs = {
      {"shadow rays that end at holes", "holes && lit.likelihood == 0.0", "false"},
      {"paths that count for nothing else", "path.weight *= 2.0;", ""},
      {"lamps that count once", "contribution / chance", "contribution"},
      {"lamps that count at every hole", "passed = vec3(1.0 - coverage);", "passed = vec3(1.0);"},
  };
  const PictureSpread reference = draw_reference(task(4, 96), sheer_room());
  for (const Bug& bug : bugs) {
    const Comparison found = compare(with("path.rchit", bug.right, bug.wrong, task(4, 96), sheer_room()), reference);
    fmt::print("{}: {}\n", bug.name, described(found));
    EXPECT_FALSE(agrees(found)) << bug.name;
  }
}

TEST_F(SeededBug, IsDetectedAtTheLastSurface) {
  const Scene scene = furnace(SurfaceMaterial{}, Finds::ByShadowRays);
  const PictureSpread picture = with("path.rchit", " && hit.depth < raypool_frame.depth", "", task(1, 32), scene);
  EXPECT_LT(picture.whole().mean(), 0.97);
}

}  // namespace
}  // namespace raypool::convergence
