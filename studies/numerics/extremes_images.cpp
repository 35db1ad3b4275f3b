// Extremes of image sizes.
#include <fmt/format.h>

#include <set>

#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::numerics {
namespace {

ExtremeCase image_case(const char* name, const char* expected, std::vector<std::pair<int, int>> sizes) {
  return {"images", name, expected, [sizes = std::move(sizes)](const ExtremeMachine& machine) {
            for (const auto& [width, height] : sizes) {
              ExtremeFrame frame;
              frame.scene = scene_of_triangles(cube(-2, 2));
              frame.width = width;
              frame.height = height;
              const Drawing drawing = machine.draw(frame);
              require_no_nan(drawing);
              std::set<uint32_t> pixels;
              for (const TracedRay& eye : drawing.rays(false, 1)) pixels.insert(eye.ray[word::kPixel]);
              const auto wanted = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
              require(pixels.size() == wanted && drawing.rays(false, 1).size() == wanted,
                      fmt::format("{} x {}: {} eye rays for {} pixels", width, height, drawing.rays(false, 1).size(),
                                  pixels.size()));
              require(lit_pixels(drawing.frame) == wanted, fmt::format("{} x {}: a pixel is dark", width, height));
            }
          }};
}

}  // namespace

std::vector<ExtremeCase> image_extremes() {
  return {
      image_case("1 x 1", "its one pixel", {{1, 1}}),
      image_case("one row and one column", "each pixel once", {{1, 7}, {7, 1}, {97, 1}, {1, 53}}),
      image_case("prime sizes", "each pixel once", {{2, 3}, {7, 13}, {13, 7}, {31, 2}, {17, 19}}),
      {"images", "no pixels, or too many", "refused",
       [](const ExtremeMachine&) {
         const Scene scene = scene_of_triangles(cube(-2, 2));
         for (const auto& [width, height] : {std::pair{0, 1}, std::pair{1, 0}, std::pair{-3, 5}, std::pair{65536, 1}}) {
           bool refused = false;
           try {
             camera_arguments(scene, width, height, 64);
           } catch (const InputError&) {
             refused = true;
           }
           require(refused, fmt::format("{} x {} is not refused", width, height));
         }
       }},
  };
}

}  // namespace raypool::numerics
