// `raypool significands`: what floats of fewer bits do to a scene's picture.
#include <fmt/format.h>

#include "cli/exit_code.hpp"
#include "cli/image_size.hpp"
#include "cli/progress.hpp"
#include "cli/scene_loading.hpp"
#include "commands/commands.hpp"
#include "config/settings.hpp"
#include "numerics/significands.hpp"

namespace raypool {

int significands_command(const SignificandsOptions& options) {
  const Configuration configuration = load_configuration(options.config, options.set);
  const ImageSize size = parse_image_size(options.size);
  Progress progress(options.quiet);
  numerics::TradeScene scene(options.scene,
                             load_scene_and_warn(options.scene, options.detail, options.view, options.look), size.width,
                             size.height, options.depth);
  scene.draw_reference([&](double share) {
    if (progress.due()) progress.show(fmt::format("  the reference picture, {:.0f}%", 100 * share));
  });
  const auto rows = numerics::try_significands(scene, arith::mode_of(configuration), [&](size_t done) {
    if (progress.due()) progress.show(fmt::format("  {} significands drawn", done));
  });
  fmt::print("{}, {}x{}, depth {}, arithmetic of {}\n{}", options.scene, size.width, size.height, options.depth,
             configuration.name, numerics::significand_table(rows));
  return kDone;
}

}  // namespace raypool
