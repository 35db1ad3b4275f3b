// `raypool boxes` and `raypool triangles`: what fewer bits in a traverser's tests do to the rays of a frame.
#include <fmt/format.h>

#include <algorithm>

#include "cli/exit_code.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/scene_loading.hpp"
#include "commands/commands.hpp"
#include "widths/box_widths.hpp"
#include "widths/triangle_widths.hpp"

namespace raypool {
namespace {

struct Frame {
  explicit Frame(const WidthsOptions& options)
      : size(parse_image_size(options.size)),
        scene(load_scene_and_warn(options.scene, options.detail, options.view, options.look)),
        width(static_cast<uint32_t>(size.width)),
        height(static_cast<uint32_t>(size.height)),
        depth(options.depth) {}

  std::vector<BenchRays> rays() const { return rays_of_frame(scene, Tracer(scene), width, height, depth); }
  std::string title(uint64_t count) const {
    return fmt::format("{}, {}x{}, depth {}: {} rays", scene.name, width, height, depth, count);
  }

  ImageSize size;
  Scene scene;
  uint32_t width, height, depth;
};

}  // namespace

int boxes_command(const BoxesOptions& options) {
  const Frame frame(options);
  Progress progress(options.quiet);
  const BoxWidths tried = try_box_widths(frame.scene, frame.rays(), options.bits, [&](double share) {
    if (progress.due()) progress.show(fmt::format("  {:.0f}% of the rays", 100 * share));
  });
  fmt::print("{}\n{}", frame.title(tried.rays), box_width_table(tried));
  const bool same =
      std::all_of(tried.rows.begin(), tried.rows.end(), [](const BoxWidthRow& row) { return row.different == 0; });
  return same ? kDone : kOtherFailure;
}

int triangles_command(const TrianglesOptions& options) {
  const Frame frame(options);
  Progress progress(options.quiet);
  numerics::TriangleWidthOptions tried_with;
  tried_with.width = frame.width;
  tried_with.height = frame.height;
  tried_with.depth = frame.depth;
  tried_with.bits = options.bits;
  tried_with.progress = [&](const std::string& what) {
    if (progress.due()) progress.show("  " + what);
  };
  const numerics::TriangleWidths tried = try_triangle_widths(frame.scene, tried_with);
  fmt::print("{}\n{}", frame.title(tried.rows.front().frame.rays), triangle_width_table(tried));
  return kDone;
}

}  // namespace raypool
