// `raypool boxes`: what a scene's rays visit when boxes are tested in integers of few bits.
#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.hpp"
#include "cli/exit_code.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/scene_loading.hpp"
#include "scene/box_widths.hpp"

namespace raypool {

int boxes_command(const BoxesOptions& options) {
  const ImageSize size = parse_image_size(options.size);
  const Scene scene = load_scene_and_warn(options.scene, options.detail, options.view, options.look);
  Progress progress(options.quiet);
  const std::vector<BenchRays> rays = rays_of_frame(scene, Tracer(scene), static_cast<uint32_t>(size.width),
                                                    static_cast<uint32_t>(size.height), options.depth);
  const BoxWidths tried = try_box_widths(scene, rays, options.bits, [&](double share) {
    if (progress.due()) progress.show(fmt::format("  {:.0f}% of the rays", 100 * share));
  });
  fmt::print("{}, {}x{}, depth {}: {} rays\n{}", scene.name, size.width, size.height, options.depth, tried.rays,
             box_width_table(tried));
  const bool same =
      std::all_of(tried.rows.begin(), tried.rows.end(), [](const BoxWidthRow& row) { return row.different == 0; });
  return same ? kDone : kOtherFailure;
}

}  // namespace raypool
