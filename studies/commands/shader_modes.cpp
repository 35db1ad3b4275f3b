#include "commands/shader_modes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "chip/board.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/folders.hpp"
#include "cli/frame.hpp"
#include "cli/image_size.hpp"
#include "cli/output_folder.hpp"
#include "cli/progress.hpp"
#include "cli/shaders.hpp"
#include "files/json_text.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/picture_file.hpp"
#include "scene/threads.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using numerics::ArithmeticMode;

constexpr int kTimedSize = 32;  // of the frame whose cycles are counted

struct ModeRow {
  std::string mode;
  uint32_t instructions = 0;
  PictureDifference difference;
  double light = 0;  // of the picture, as a share of the reference's
  double cycles_a_ray = 0, mrays_per_s = 0;
};

Picture picture_of(const FrameBuffer& frame) {
  return {static_cast<int>(frame.width()), static_cast<int>(frame.height()), to_rgb8(frame)};
}

/// Mean of all linear values.
double light_of(const FrameBuffer& frame) {
  double sum = 0;
  for (uint32_t y = 0; y < frame.height(); ++y)
    for (uint32_t x = 0; x < frame.width(); ++x)
      for (uint32_t channel = 0; channel < 3; ++channel) sum += frame.linear(x, y, channel);
  return sum / 3 / frame.width() / frame.height();
}

/// A frame of a shader set on machines with different arithmetic.
class ShaderModes {
 public:
  explicit ShaderModes(const NumericsOptions& options)
      : options_(options), set_(source_.load(options.shaders)), scene_(load(options)) {
    const ImageSize size = parse_image_size(options.size);
    std::vector<std::string> settings = options.set;
    add_settings_for(*set_, 1, settings);
    base_ = load_configuration(options.config, settings);
    record_.shaders = options.shaders;
    record_.waits = set_->waits();
    record_.width = size.width;
    record_.height = size.height;
    record_.depth = options.depth;
    record_.units = 1;
    record_.samples = options.samples;
    record_.scene = scene_.name;
    record_.reflections = record_.chip_depth() > 1;
  }

  const RunRecord& record() const { return record_; }
  const Configuration& base() const { return base_; }

  FrameBuffer draw(const ArithmeticMode& mode) {
    const MemoryImage image = prepare(mode, record_);
    const Tracer tracer = tracer_of(record_, scene_, image);
    NativeOptions native = native_options(record_);
    native.threads = threads_or_all();
    return render_samples(scene_, image, tracer, native, record_.samples);
  }

  /// The instructions and cycles of a small frame.
  void time(const ArithmeticMode& mode, ModeRow& row) {
    RunRecord record = record_;
    record.width = record.height = kTimedSize;
    record.samples = 1;
    MemoryImage image = prepare(mode, record);
    // Its cycles are those of the unit.
    record.configuration.chip.traverser = TraverserName::Static;
    Surroundings around(scene_, image, record);
    ChipOptions frame = chip_options(record, scene_, image, around);
    EngineOptions engine;
    engine.engine = Engine::Model;
    engine.configuration = record.configuration;
    const std::unique_ptr<ChipDevice> chip = make_chip_around(frame, make_unit(engine, image.memory));
    const ChipResult result = run_board(frame, *chip);
    row.instructions = static_cast<uint32_t>(ray_program(record).program.code.size());
    row.cycles_a_ray = static_cast<double>(result.cycles) / static_cast<double>(result.rays());
    row.mrays_per_s = result.mrays_per_s;
  }

 private:
  static Scene load(const NumericsOptions& options) {
    return load_scene_and_warn(options.scene, options.detail, options.view, options.look, true);
  }
  MemoryImage prepare(const ArithmeticMode& mode, RunRecord& record) const {
    record.configuration = mode.applied_to(base_);
    check_shaders(record);
    MemoryImage image = build_shader_image(source_, *set_, scene_, record);
    check_fits(record, scene_);
    return image;
  }

  const NumericsOptions& options_;
  ShaderSource source_ = SimOptions().shader_source;
  std::shared_ptr<const shader::ShaderSet> set_;
  Scene scene_;
  Configuration base_;
  RunRecord record_;
};

std::string decibels(double value) { return std::isfinite(value) ? fmt::format("{:.1f}", value) : "equal"; }

/// "+0.12%", and no "-0.00%".
std::string percent_more(double share) { return fmt::format("{:+.2f}%", std::round(1e4 * (share - 1)) / 100 + 0.0); }

std::string table_of(const ShaderModes& modes, const std::string& reference, const std::vector<ModeRow>& rows) {
  const RunRecord& record = modes.record();
  std::string text = fmt::format(
      "{} on {}, {}x{}, depth {}, {} a pixel, beside the picture of {}; cycles at {}x{} on {}\n"
      "  {:<20} {:>8} {:>7} {:>7} {:>6} {:>8} {:>12} {:>10} {:>8}\n",
      record.shaders, record.scene, record.width, record.height, record.depth,
      record.samples == 1 ? "1 sample" : fmt::format("{} samples", record.samples), reference, kTimedSize, kTimedSize,
      modes.base().name, "mode", "off by 1", "by 2+", "largest", "dB", "light", "instructions", "cycles/ray",
      "Mrays/s");
  for (const ModeRow& row : rows) {
    const PictureDifference& difference = row.difference;
    const auto share = [&](uint64_t pixels) {
      return fmt::format("{:.2f}%", 100 * static_cast<double>(pixels) / static_cast<double>(difference.pixels));
    };
    text += fmt::format("  {:<20} {:>8} {:>7} {:>7} {:>6} {:>8} {:>12} {:>10.2f} {:>8.2f}\n", row.mode,
                        share(difference.differ - difference.off_by_more), share(difference.off_by_more),
                        difference.largest, decibels(difference.psnr), percent_more(row.light), row.instructions,
                        row.cycles_a_ray, row.mrays_per_s);
  }
  return text;
}

std::string json_of(const ShaderModes& modes, const std::string& reference, const std::vector<ModeRow>& rows) {
  const RunRecord& record = modes.record();
  Json json = {{"configuration", modes.base().name},
               {"shaders", record.shaders},
               {"scene", record.scene},
               {"size", {{"width", record.width}, {"height", record.height}}},
               {"depth", record.depth},
               {"samples", record.samples},
               {"reference", reference},
               {"modes", Json::array()}};
  for (const ModeRow& row : rows) {
    const PictureDifference& difference = row.difference;
    json["modes"].push_back({{"mode", row.mode},
                             {"pixels", difference.pixels},
                             {"off_by_one", difference.differ - difference.off_by_more},
                             {"off_by_more", difference.off_by_more},
                             {"largest_difference", difference.largest},
                             {"psnr_db", difference.psnr},
                             {"light", row.light},
                             {"instructions", row.instructions},
                             {"cycles_per_ray", row.cycles_a_ray},
                             {"mrays_per_second", row.mrays_per_s}});
  }
  return json.dump(2) + "\n";
}

}  // namespace

int shader_modes_command(const NumericsOptions& options, const std::vector<ArithmeticMode>& modes) {
  ShaderModes frame(options);
  OutputFolder out(options.out.empty() ? results_folder() / ("numerics-" + name_of_shaders(options.shaders))
                                       : fs::path(options.out));
  Progress progress(options.quiet);
  const ArithmeticMode& full = numerics::arithmetic_modes().front();
  progress.show(fmt::format("  {}: the picture to compare with", full.name));
  const FrameBuffer reference = frame.draw(full);
  const Picture picture = picture_of(reference);
  const double light = light_of(reference);
  std::vector<ModeRow> rows;
  for (const ArithmeticMode& mode : modes) {
    if (progress.due()) progress.show(fmt::format("  {}, {} of {}", mode.name, rows.size() + 1, modes.size()));
    ModeRow& row = rows.emplace_back();
    row.mode = mode.name;
    const FrameBuffer drawn = frame.draw(mode);
    row.difference = difference_of(picture_of(drawn), picture);
    row.light = light == 0 ? 1 : light_of(drawn) / light;
    frame.time(mode, row);
  }
  out.write("numerics.json", json_of(frame, full.name, rows));
  out.publish();
  fmt::print("{}results in {}: numerics.json\n", table_of(frame, full.name, rows),
             fs::proximate(out.path(".")).lexically_normal().string());
  return kDone;
}

}  // namespace raypool
