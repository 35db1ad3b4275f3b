// `raypool significands`: what floats of fewer bits do to a scene's picture, held against double precision.
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
  NativeOptions frame;
  frame.width = static_cast<uint32_t>(size.width);
  frame.height = static_cast<uint32_t>(size.height);
  frame.depth = static_cast<uint32_t>(options.depth);
  const Scene scene = load_scene_and_warn(options.scene, options.detail, options.view, options.look);
  Progress progress(options.quiet);
  const auto rows = numerics::try_significands(scene, configuration, frame, [&](size_t done) {
    if (progress.due()) progress.show(fmt::format("  {} significands drawn", done));
  });
  fmt::print("{}, {}x{}, depth {}, {} against double precision\n{}", options.scene, size.width, size.height,
             options.depth, configuration.name, numerics::significand_table(rows));
  return kDone;
}

}  // namespace raypool
