#include "loops.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "chip/board.hpp"
#include "chip/board_modules.hpp"
#include "config/configuration.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::bench {

namespace {

constexpr uint32_t kSize = 128, kDepth = 5;

/// The Cornell box on a chip with the traverser inside.
struct Frame {
  explicit Frame(const std::string& config) : configuration(chip_of(config)) {
    options.configuration = configuration;
    options.layout = ray_record_layout(configuration);
    options.memory = &image.memory;
    options.program_length = size32(program.code);
    for (size_t i = 0; i < kRayKernels; ++i) options.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
    options.arguments = camera_arguments(scene, kSize, kSize, configuration.contents(), configuration.significand);
    options.width = options.height = kSize;
    options.depth = kDepth;
    options.tree = &tree;
    options.frame = &sink;
  }
  static Configuration chip_of(const std::string& config) {
    Configuration configuration = load_configuration(config);
    configuration.chip.traverser = TraverserName::Hardware;
    return configuration;
  }

  const Configuration configuration;
  const Scene scene = make_cornell();
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  MemoryImage image = build_memory(program, scene);
  const Tracer tracer{scene, image.material_base, configuration.chip};
  TreeImage tree = make_tree_image(scene, tracer.traversal().bvh(), configuration.chip, image.material_base);
  FrameBuffer frame{kSize, kSize};
  FrameBufferSink sink{frame};
  ChipOptions options;
};

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

using Loop = ChipResult (*)(const ChipOptions&, ChipDevice&, FrameBegin);

/// Seconds of user time; the chip is made before.
double draw(const std::string& config, Loop loop, uint64_t& cycles) {
  Frame frame(config);
  const std::unique_ptr<ChipDevice> chip =
      make_chip_model(frame.configuration, make_model(frame.configuration, frame.image.memory, 1).device);
  const double begin = user_seconds();
  const uint64_t taken = loop(frame.options, *chip, FrameBegin::Reset).cycles;
  const double seconds = user_seconds() - begin;
  if (cycles != 0 && cycles != taken)
    throw std::runtime_error(fmt::format("{} takes {} cycles in one loop and {} in the other", config, cycles, taken));
  cycles = taken;
  return seconds;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 != 0 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace

void compare_loops(const std::string& config, int repetitions) {
  std::vector<double> bare, systemc;
  uint64_t cycles = 0;
  for (int i = 0; i < repetitions; ++i) {
    bare.push_back(draw(config, run_board, cycles));
    systemc.push_back(draw(config, run_chip, cycles));
  }
  const double bare_rate = static_cast<double>(cycles) / median(bare) / 1e3,
               systemc_rate = static_cast<double>(cycles) / median(systemc) / 1e3;
  fmt::print(
      "{}: {} cycles; {:.1f} kcycles/s in the bare loop, {:.1f} in SystemC: {:.1f}% of the speed (medians of {})\n",
      config, cycles, bare_rate, systemc_rate, 100 * systemc_rate / bare_rate, repetitions);
}

}  // namespace raypool::bench
