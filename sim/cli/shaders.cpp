#include "cli/shaders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "cli/folders.hpp"
#include "config/settings.hpp"
#include "files/input_file.hpp"
#include "isa/input_error.hpp"
#include "kernel/ray_program.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

// Memory is laid out before the kernels are compiled, as they hold addresses: the longest program has room.
constexpr size_t kProgramRoom = 65536;

std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error)) files.push_back(at->path());
  if (error) throw InputError(fmt::format("cannot read folder '{}': {}", folder, error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

/// Room for what kernels keep of their threads, and for records of paths.
void grow_for_paths(MemoryImage& image, const shader::ShaderSet& set, const shader::Resources& resources,
                    const RunRecord& record) {
  constexpr uint64_t kMost = uint64_t{1} << 30;
  const uint64_t spilled = resources.saved_stride() * static_cast<uint64_t>(record.kernels->slots);
  const uint64_t bytes = resources.paths_bytes() + spilled;
  if (bytes > kMost) {
    throw InputError(
        fmt::format("shaders {}: {} values that find no register and {} words of each path need {} bytes of memory for "
                    "{}x{} pixels and depth {}, and may have {}: draw a smaller picture, or less deep",
                    set.folder(), record.kernels->slots, resources.path_words, bytes, record.width, record.height,
                    record.depth, kMost));
  }
  image.memory.grow(resources.saved + static_cast<uint32_t>((bytes + 63) / 64 * 64));
}

}  // namespace

void check_shaders(const SimOptions& options, Engine engine) {
  if (options.shaders.empty()) {
    if (options.samples != 1)
      throw InputError(
          "--samples is for shader sets: the built-in kernels draw every sample alike; leave it out, or "
          "give --shaders too");
    return;
  }
  if (!options.shader_source.load || !options.shader_source.memory)
    throw InputError("this program draws with the built-in kernels alone: leave --shaders out");
  if (engine == Engine::Estimate) {
    throw InputError(
        "engine estimate knows the built-in kernels alone: draw shaders with native, functional, sampled, model, rtl "
        "or lockstep");
  }
  if (engine == Engine::Sampled && options.samples > 1) {
    throw InputError(
        "engine sampled draws one frame, and samples of a pixel are frames that take about as long: leave --samples "
        "out");
  }
  if (options.precision == "double")
    throw InputError("--precision double draws with the built-in kernels alone: leave it or --shaders out");
  if (options.unstable != 0)
    throw InputError("--unstable moves what the built-in kernels know of the camera: leave it or --shaders out");
  if (options.samples > 1 && (options.waves || !options.trace.empty()))
    throw InputError("a waveform or trace is of one frame: leave --samples out, or --waves and --trace");
}

void check_shaders(const RunRecord& record) {
  const ChipConfiguration& chip = record.configuration.chip;
  if (chip.culling) {
    throw InputError(
        "chip.culling drops rays whose first payload words are zero, which are no weights in shaders: draw with --set "
        "chip.culling=false");
  }
  if (chip.shading == Shading::Traverser) {
    throw InputError(
        "chip.shading is traverser, which adds to the picture without a miss shader: draw with --set "
        "chip.shading=kernel");
  }
  if (record.waits && !chip.miss_records) {
    throw InputError(
        "the shaders wait for rays, which must come back even if they meet nothing: draw with --set "
        "chip.miss_records=true");
  }
  if (record.units > 1 && !record.configuration.sharing) {
    throw InputError(
        fmt::format("shaders keep values in a memory that {} units share, for which these need the instructions unit "
                    "and inval: draw with --set sharing=true, or --units 1",
                    record.units));
  }
  if (record.reflections && !chip.reflections) {
    throw InputError(fmt::format(
        "depth {} traces rays from closest-hit shaders, but {} has no kernel for them (chip.reflections): draw with "
        "--depth 1 or --set chip.reflections=true",
        record.depth, record.configuration.name));
  }
}

void add_settings_for(const shader::ShaderSet& set, int units, std::vector<std::string>& settings) {
  const std::vector<std::string> chosen = paths_set(settings);
  const auto add = [&](const std::string& field) {
    if (std::find(chosen.begin(), chosen.end(), field) == chosen.end()) settings.push_back(field + "=true");
  };
  if (set.waits()) add("chip.miss_records");
  if (units > 1) add("sharing");
}

MemoryImage build_shader_image(const ShaderSource& source, const shader::ShaderSet& set, const Scene& scene,
                               RunRecord& record) {
  Program room;
  room.code.assign(kProgramRoom, 0);
  MemoryImage image = build_memory(room, scene);
  ShaderFrame frame;
  frame.width = static_cast<uint32_t>(record.width);
  frame.height = static_cast<uint32_t>(record.height);
  frame.depth = static_cast<uint32_t>(record.depth);
  frame.samples = static_cast<uint32_t>(record.samples);
  frame.camera = camera_numbers(scene, frame.width, frame.height);
  frame.offset = static_cast<float>(
      offset_share(longest_direction(frame.camera, frame.width, frame.height), record.configuration.significand));
  shader::Resources resources = source.memory(image, scene, set, frame);
  resources.units = record.units;
  resources.threads = record.configuration.contents();
  if (record.waits) {
    resources.levels = static_cast<uint32_t>(record.depth);
    resources.path_words = set.path_words(resources.specialization, resources.levels);
  }
  const KernelTarget target(record.configuration);
  record.kernels = std::make_shared<const RayProgram>(make_ray_program(set.record(resources, target), target));
  grow_for_paths(image, set, resources, record);
  store_program(record.kernels->program, image.memory);
  return image;
}

std::string name_of_shaders(const std::string& folder) {
  uint32_t hash = hash_of("");
  for (const fs::path& file : files_in(folder)) {
    hash = hash_of(fs::relative(file, folder).string(), hash);
    hash = hash_of(read_file(file, "shader file"), hash);
  }
  fs::path path = fs::path(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return fmt::format("{}-{:08x}", path.filename().string(), hash);
}

}  // namespace raypool
