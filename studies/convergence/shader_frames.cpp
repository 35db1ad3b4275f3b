#include "convergence/shader_frames.hpp"

#include <memory>

#include "cli/commands.hpp"
#include "cli/frame.hpp"
#include "cli/shaders.hpp"
#include "config/configuration.hpp"
#include "kernel/kernels.hpp"
#include "scene/threads.hpp"

namespace raypool::convergence {
namespace {

RunRecord record_of(const std::string& set, const Scene& scene, const PictureSize& size) {
  RunRecord record;
  record.engine = "native";
  record.configuration = load_configuration(SimOptions().config);
  record.shaders = set;
  record.scene = scene.name;
  record.width = static_cast<int>(size.width);
  record.height = static_cast<int>(size.height);
  record.depth = static_cast<int>(size.depth);
  record.samples = static_cast<int>(size.samples);
  record.reflections = size.depth > 1;
  return record;
}

/// Memory of the frame; the record gets the set's kernels.
MemoryImage image_of(const std::string& set, const Scene& scene, RunRecord& record) {
  const ShaderSource source = SimOptions().shader_source;
  MemoryImage image = build_shader_image(source, *source.load(set), scene, record);
  check_fits(record, scene);
  return image;
}

}  // namespace

ShaderFrames::ShaderFrames(const std::string& set, const Scene& scene, const PictureSize& size)
    : scene_(scene),
      record_(record_of(set, scene, size)),
      image_(image_of(set, scene, record_)),
      tracer_(tracer_of(record_, scene, image_)) {}

FrameBuffer ShaderFrames::draw(uint32_t number) const {
  NativeOptions native = native_options(record_);
  native.change_arguments = [number](std::array<uint32_t, kArguments>& arguments) {
    arguments[argument::kSample] = number;
  };
  return render_native(scene_, image_, tracer_, native);
}

}  // namespace raypool::convergence
