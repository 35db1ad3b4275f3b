// `raypool sim`: one frame, from the scene to the files it leaves.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "chip/board_modules.hpp"
#include "chip/chip.hpp"
#include "chip/several_frames.hpp"
#include "cli/black_picture.hpp"
#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "cli/engine_choice.hpp"
#include "cli/folders.hpp"
#include "cli/frame.hpp"
#include "cli/image_size.hpp"
#include "cli/limit_sentence.hpp"
#include "cli/output_folder.hpp"
#include "cli/progress.hpp"
#include "cli/report.hpp"
#include "cli/shaders.hpp"
#include "cli/sim_checks.hpp"
#include "config/settings.hpp"
#include "config/unused_fields.hpp"
#include "files/unfinished.hpp"
#include "isa/did_you_mean.hpp"
#include "scene/double_renderer.hpp"
#include "scene/embree_scene.hpp"
#include "scene/image.hpp"
#include "scene/lost_shadows.hpp"
#include "scene/native_renderer.hpp"
#include "scene/pixel_decisions.hpp"
#include "scene/scene.hpp"
#include "scene/threads.hpp"
#include "scene/traversal.hpp"
#include "trace/trace_recorder.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastDetail = 0.01;
constexpr const char* kWaveform = "waves.fst";

/// Settings without effect are refused; those of a file, which may be written for other runs as well, are reported.
void check_fields_in_use(const Configuration& configuration) {
  refuse_unused_settings(configuration);
  const std::string told = unused_in_file(configuration);
  if (!told.empty()) fmt::print(stderr, "raypool: warning: {}\n", told);
}

template <typename Item>
uint32_t hash_bytes(const std::vector<Item>& items, uint32_t seed) {
  return hash_of({reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item)}, seed);
}

/// Of what the names of scene, view and configuration may leave open: everything that is drawn, and the hardware.
uint32_t content_hash(const Scene& scene, const Configuration& configuration) {
  uint32_t hash = hash_bytes(scene.triangles, hash_bytes(scene.vertices, hash_of("")));
  hash = hash_bytes(scene.triangle_materials, hash);
  std::vector<Vec3> vectors = {scene.camera.eye, scene.camera.direction, scene.camera.up, scene.light.position,
                               scene.light.color};
  for (const Material& material : scene.materials) vectors.insert(vectors.end(), {material.kd, material.ks});
  hash = hash_of(fmt::format("{}", scene.camera.fov), hash_bytes(vectors, hash));
  if (scene.recentred()) hash = hash_bytes(std::vector<Vec3d>{scene.centre}, hash);
  Configuration nameless = configuration;
  nameless.name.clear();
  return hash_of(to_json(nameless), hash);
}

/// A user's files may have any content: names of built-in things alone define what is drawn.
bool names_say_all(const SimOptions& options, const Scene& scene, const Configuration& configuration) {
  if (options.scene != "cornell" && options.scene != "room") return false;
  const Scene own = load_scene(options.scene, {kLeastDetail, "", {}, ""});  // its view is that of any detail
  const bool own_view = scene.camera.eye == own.camera.eye && scene.camera.direction == own.camera.direction &&
                        scene.camera.up == own.camera.up && scene.camera.fov == own.camera.fov &&
                        scene.light.position == own.light.position && scene.light.color == own.light.color;
  return own_view && is_built_in(configuration);
}

/// `shaders`: folder of the shader set; empty: none.
fs::path default_folder(const SimOptions& options, const Scene& scene, const RunRecord& record, const ImageSize& size,
                        const std::string& shaders) {
  const Configuration& configuration = record.configuration;
  std::string name = fs::path(options.scene).stem().string();
  if (options.detail != 1) name += fmt::format("-detail{:g}", options.detail);
  if (!options.view.empty()) name += "-" + fs::path(options.view).stem().string();
  const std::string engine = !options.choose_engine  ? options.engine
                             : options.error.empty() ? fmt::format("within{:g}", seconds_of(options))
                                                     : fmt::format("error{:g}", 100 * error_of(options));
  name += fmt::format("-{}-{}cu-{}x{}-depth{}-{}", configuration.name, options.units, size.width, size.height,
                      options.depth, engine);
  if (options.boundary == "chip") name += "-chip";
  if (options.hits == "embree") name += "-embree";
  if (options.precision == "double") name += "-double";
  if (!shaders.empty()) name += "-" + name_of_shaders(shaders);
  if (options.samples > 1) name += fmt::format("-samples{}", options.samples);
  if (!names_say_all(options, scene, configuration)) name += fmt::format("-{:08x}", content_hash(scene, configuration));
  return results_folder() / name;
}

/// "62% of the pixels, ..."; an engine without time has no cycles to show.
std::string progress_text(const ChipProgress& done, bool timed, double seconds) {
  std::string text = fmt::format("  {:3.0f}% of the pixels, {} rays, ", 100 * done.pixels_done, done.rays);
  if (timed) text += fmt::format("{} cycles, ", done.cycles);
  text += fmt::format("{:.0f} s", seconds);
  if (done.pixels_done > 0.02) text += fmt::format(", about {:.0f} s to go", seconds * (1 / done.pixels_done - 1));
  return text;
}

/// `decisions`, unless null, record what rays come to.
FrameBuffer draw_natively(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image,
                          const Tracer& tracer, std::vector<NativeWork>* work = nullptr,
                          PixelDecisions* decisions = nullptr) {
  std::optional<EmbreeTracer> embree;
  NativeOptions native = native_options(record);
  native.threads = threads_or_all(options.threads);
  if (record.hits == "embree") {
    embree.emplace(scene, tracer);
    native.trace = [&](const Ray& ray, Intersection& hit) { return embree->trace(ray, hit); };
  }
  if (decisions != nullptr) {
    if (!native.trace) native.trace = [&](const Ray& ray, Intersection& hit) { return tracer.trace(ray, hit); };
    native.trace = told(native.trace, *decisions);
  }
  if (work != nullptr) {
    native.parts = options.estimating->sampled.blocks_of(record.configuration, native.width, native.height);
    native.work = work;
  }
  record.native.emplace();
  const Progress drawing(true);
  FrameBuffer frame = record.precision == "double"
                          ? render_in_double(scene, image, tracer, native, *record.native, decisions)
                          : render_samples(scene, image, tracer, native, record.samples, &*record.native);
  record.simulation_seconds = drawing.seconds();
  return frame;
}

void warn_of_lost_shadows(const RunRecord& record, const Scene& scene, const Tracer& tracer) {
  if (record.precision == "double" || record.kernels) return;
  const std::string lost = lost_shadows(scene, tracer.traversal(), arguments_of(record, scene));
  if (!lost.empty()) fmt::print(stderr, "raypool: warning: {}\n", lost);
}

/// The picture, and what is asked of it beside.
FrameBuffer draw_with_precision(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image,
                                OutputFolder& out) {
  const Tracer tracer = tracer_of(record, scene, image);
  warn_of_lost_shadows(record, scene, tracer);
  std::optional<PixelDecisions> decisions;
  if (!options.precision.empty())
    decisions.emplace(static_cast<uint32_t>(record.width), static_cast<uint32_t>(record.height));
  FrameBuffer frame = draw_natively(options, record, scene, image, tracer, nullptr, decisions ? &*decisions : nullptr);
  if (decisions) out.write("decisions.bin", decisions->to_bytes());
  if (options.unstable == 0) return frame;
  Progress progress(options.quiet || options.json);
  UnstablePixels unstable(frame);
  for (int number = 1; number <= options.unstable; ++number) {
    NativeOptions native = native_options(record);
    native.threads = threads_or_all(options.threads);
    native.change_arguments = [number](std::array<uint32_t, kArguments>& arguments) {
      move_last_bits(arguments, number);
    };
    unstable.add(render_native(scene, image, tracer, native));
    if (progress.due()) progress.show(fmt::format("  {} of {} frames with last bits moved", number, options.unstable));
  }
  const std::vector<uint8_t> map = unstable.png();
  out.write("unstable.png", std::string(map.begin(), map.end()));
  record.unstable = unstable;
  return frame;
}

EngineOptions engine_options(const SimOptions& options, Engine engine, const RunRecord& record) {
  return {engine == Engine::Sampled ? Engine::Model : engine,
          record.configuration,
          options.unit_library,
          options.waves,
          options.units,
          options.inspect_until,
          record.boundary == "chip" ? Boundary::Chip : Boundary::Unit};
}

std::unique_ptr<ComputeUnit> make_device(const SimOptions& options, Engine engine, const RunRecord& record,
                                         MemoryImage& image) {
  std::unique_ptr<ComputeUnit> device = make_unit(engine_options(options, engine, record), image.memory, "unit",
                                                  kernel_names(ray_program(record).program));
  return options.wrap ? options.wrap(std::move(device), image.memory) : std::move(device);
}

/// The window that is asked for, in a picture of this size.
trace::Window trace_window(const SimOptions& options, const RunRecord& record) {
  const trace::Window window = trace::parse_window(options.trace);
  const uint32_t pixel = window.pixel.value_or(0);
  if (static_cast<int>(pixel & 0xffff) >= record.width || static_cast<int>(pixel >> 16) >= record.height) {
    throw InputError(fmt::format("--trace {}: the picture has {}x{} pixels, numbered from 0", options.trace,
                                 record.width, record.height));
  }
  return window;
}

void write_trace(const SimOptions& options, const trace::MachineTrace& trace, OutputFolder& out) {
  if (trace.instructions.empty()) {
    std::fprintf(stderr, "raypool: warning: no instruction was executed in the window --trace %s\n",
                 options.trace.c_str());
  }
  out.write("trace.json", trace::to_trace_events(trace));
  out.write("trace.kanata", trace::to_kanata(trace));
}

/// What earlier runs have left that were killed.
void clear_unfinished(OutputFolder& out) {
  for (const char* name :
       {kWaveform, "image.png", "report.json", "trace.json", "trace.kanata", "decisions.bin", "unstable.png"})
    out.clear_unfinished(name);
}

/// The waveform, of a run that went wrong or was stopped.
void keep(OutputFolder& out) {
  out.publish();
  std::fprintf(stderr, "raypool: the waveform until then is %s\n", out.path(kWaveform).c_str());
}

/// The chip of an engine that has one, and what is to be asked of it when the frame is drawn.
struct DrawingChip {
  std::unique_ptr<ChipDevice> chip;
  ComputeUnit* device = nullptr;  ///< in it; null: the chip is Verilog
  trace::MachineTrace trace;
};

/// `frame`: of which it adjusts what the chip needs.
void make_drawing_chip(const SimOptions& options, Engine engine, const RunRecord& record, MemoryImage& image,
                       ChipOptions& frame, DrawingChip& made) {
  if (record.boundary == "chip") {
    made.chip = make_verilog_chip(engine_options(options, engine, record), image.memory);
    return;
  }
  std::unique_ptr<ComputeUnit> device = make_device(options, engine, record, image);
  made.device = device.get();
  if (!options.trace.empty()) {
    made.trace.kernels = kernel_names(ray_program(record).program);
    device = std::make_unique<trace::TraceRecorder>(std::move(device), record.configuration,
                                                    trace_window(options, record), made.trace);
  }
  made.chip = make_chip_around(frame, std::move(device));
}

/// Of several frames, which one.
std::string sample_text(const RunRecord& record, uint32_t sample) {
  return record.samples == 1 ? "" : fmt::format("  sample {} of {}:", sample + 1, record.samples);
}

template <typename Counts>
void add_counts(std::optional<Counts>& sum, const std::optional<Counts>& counts) {
  if (sum && counts)
    *sum += *counts;
  else if (counts)
    sum = counts;
}

/// A frame of the picture, on a chip of its own; the record gets what it comes to.
void draw_frame(const SimOptions& options, Engine engine, RunRecord& record, MemoryImage& image, ChipOptions frame,
                OutputFolder& out) {
  frame.limits.cycles = options.cycle_limit.value_or(0);
  DrawingChip drawing;
  make_drawing_chip(options, engine, record, image, frame, drawing);
  if (options.waves) drawing.chip->open_waveform(out.temporary(kWaveform));
  Progress progress(options.quiet || options.json);
  const std::string sample = sample_text(record, frame.arguments[argument::kSample]);
  frame.progress = [&](const ChipProgress& done) {
    if (progress.due()) progress.show(sample + progress_text(done, frame.timed, progress.seconds()));
  };
  // When something goes wrong the waveform up to there is what one wants to see.
  const auto keep_waveform = [&] {
    drawing.chip.reset();
    if (options.waves) keep(out);
  };
  try {
    add_frame(*record.chip, run_chip(frame, *drawing.chip));
  } catch (const ChipFault& fault) {
    keep_waveform();
    throw InputError(describe(fault, record));
  } catch (const LimitPassed& passed) {
    keep_waveform();
    throw InputError(limit_sentence(passed, options.cycle_limit.has_value()));
  } catch (const std::exception&) {
    keep_waveform();
    throw;
  }
  if (drawing.device != nullptr)
    add_counts(record.lockstep, lockstep_counts(*drawing.device));
  else
    add_counts(record.chip_lockstep, lockstep_counts(*drawing.chip));
  drawing.chip.reset();
  if (!options.trace.empty()) write_trace(options, drawing.trace, out);
}

FrameBuffer draw_on_chip(const SimOptions& options, Engine engine, RunRecord& record, const Scene& scene,
                         MemoryImage& image, OutputFolder& out) {
  Surroundings around(scene, image, record);
  warn_of_lost_shadows(record, scene, around.tracer);
  ChipOptions frame = chip_options(record, scene, image, around);
  record.chip.emplace();
  // Shaders may have written to it.
  const Memory at_first = record.samples > 1 ? image.memory : Memory();
  for (int sample = 0; sample < record.samples; ++sample) {
    if (sample > 0) image.memory = at_first;
    frame.arguments[argument::kSample] = static_cast<uint32_t>(sample);
    draw_frame(options, engine, record, image, frame, out);
  }
  record.simulation_seconds = record.chip->wall_seconds;
  return std::move(around.frame);
}

/// The figures of a sample, of a frame that is drawn natively and takes so much work. `whole`: since when the command
/// runs.
void add_sample(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image,
                Surroundings& around, const std::vector<NativeWork>& work, const Progress& whole) {
  sampled::Wanted wanted;
  if (!options.error.empty()) wanted.error = error_of(options);
  // What is over already gets the smallest sample.
  if (!options.within.empty()) wanted.seconds = std::max(1e-3, seconds_of(options) - whole.seconds());
  wanted.seed = record.seed = std::max<uint64_t>(1, options.seed);
  wanted.processes = threads_or_all(options.threads);
  ChipOptions chip = chip_options(record, scene, image, around);
  Progress progress(options.quiet || options.json);
  chip.progress = [&](const ChipProgress& done) {
    if (progress.due()) progress.show(progress_text(done, true, progress.seconds()));
  };
  record.sampled = options.estimating->sampled.draw(chip, static_cast<uint32_t>(options.units), work, wanted);
}

/// The figures that follow from what native has counted.
void add_estimate(const SimOptions& options, RunRecord& record, const Scene& scene, const MemoryImage& image,
                  const Tracer& tracer) {
  record.estimated = options.estimating->estimate(record.configuration, static_cast<uint32_t>(options.units), scene,
                                                  image, tracer, native_options(record), *record.native);
}

/// The picture natively, the figures from a sample.
FrameBuffer draw_sampled_frame(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image,
                               const Progress& whole) {
  Surroundings around(scene, image, record);
  warn_of_lost_shadows(record, scene, around.tracer);
  const Progress drawing(true);
  std::vector<NativeWork> work;
  FrameBuffer frame = draw_natively(options, record, scene, image, around.tracer, &work);
  add_sample(options, record, scene, image, around, work, whole);
  record.simulation_seconds = drawing.seconds();
  return frame;
}

/// The picture natively, the figures from what that counts.
FrameBuffer draw_estimated_frame(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image) {
  const Tracer tracer = tracer_of(record, scene, image);
  warn_of_lost_shadows(record, scene, tracer);
  const Progress drawing(true);
  FrameBuffer frame = draw_natively(options, record, scene, image, tracer);
  add_estimate(options, record, scene, image, tracer);
  record.simulation_seconds = drawing.seconds();
  return frame;
}

/// What is known before anything is drawn.
EngineCosts engine_costs(const SimOptions& options, const RunRecord& record) {
  EngineCosts costs;
  costs.cores = threads_or_all(options.threads);
  if (options.shaders.empty()) costs.estimate_error = options.estimating->estimate_error(record.configuration);
  if (record.samples == 1) {
    costs.sample_share = options.estimating->sampled.least_share(
        record.configuration, static_cast<uint32_t>(record.width), static_cast<uint32_t>(record.height));
  }
  return costs;
}

/// Reports the choice at once: the user may want another.
Engine take(const SimOptions& options, RunRecord& record, const EngineChoice& choice) {
  record.engine = engine_name(choice.engine);
  record.engine_choice = choice.why;
  if (!options.quiet && !options.json) {
    fmt::print("engine {}: {}\n", record.engine, choice.why);
    std::fflush(stdout);
  }
  return choice.engine;
}

/// The picture natively, and the figures of the engine that ends in time; model draws its own.
FrameBuffer draw_within(const SimOptions& options, RunRecord& record, const Scene& scene, MemoryImage& image,
                        OutputFolder& out, const Progress& whole) {
  EngineCosts costs = engine_costs(options, record);
  if (!costs.sample_share)
    return draw_on_chip(options, take(options, record, engine_for_time(costs)), record, scene, image, out);
  Surroundings around(scene, image, record);
  const Progress drawing(true);
  std::vector<NativeWork> work;
  FrameBuffer frame = draw_natively(options, record, scene, image, around.tracer, &work);
  costs.model_seconds = options.estimating->sampled.seconds(chip_options(record, scene, image, around),
                                                            static_cast<uint32_t>(options.units), work);
  costs.seconds_left = seconds_of(options) - whole.seconds();
  const Engine engine = take(options, record, engine_for_time(costs));
  if (engine == Engine::Model) {
    record.native.reset();
    return draw_on_chip(options, engine, record, scene, image, out);
  }
  warn_of_lost_shadows(record, scene, around.tracer);
  if (engine == Engine::Sampled)
    add_sample(options, record, scene, image, around, work, whole);
  else
    add_estimate(options, record, scene, image, around.tracer);
  record.simulation_seconds = drawing.seconds();
  return frame;
}

EyeOf eye_of(const SimOptions& options, const Scene& scene) {
  if (!options.view.empty() || !options.look.eye.empty() || !options.look.look_at.empty()) return EyeOf::User;
  return scene.cameras.empty() ? EyeOf::Automatic : EyeOf::File;
}

FrameBuffer draw(const SimOptions& options, Engine engine, RunRecord& record, const Scene& scene, MemoryImage& image,
                 OutputFolder& out, const Progress& whole) {
  if (options.choose_engine) {
    if (!options.within.empty()) return draw_within(options, record, scene, image, out, whole);
    engine = take(options, record, engine_for_error(error_of(options), engine_costs(options, record)));
  }
  if (engine == Engine::Sampled) return draw_sampled_frame(options, record, scene, image, whole);
  if (engine == Engine::Estimate) return draw_estimated_frame(options, record, scene, image);
  if (engine == Engine::Native) return draw_with_precision(options, record, scene, image, out);
  return draw_on_chip(options, engine, record, scene, image, out);
}

void print_modules(const SimOptions& options, Engine engine, const RunRecord& record, const Scene& scene,
                   MemoryImage& image) {
  Surroundings around(scene, image, record);
  ChipOptions frame = chip_options(record, scene, image, around);
  DrawingChip drawing;
  make_drawing_chip(options, engine, record, image, frame, drawing);
  fmt::print("{}", chip_modules(frame, *drawing.chip));
}

void print_table(const SimOptions& options, const RunRecord& record, const OutputFolder& out) {
  fmt::print("{}  results     {}: image.png, report.json{}\n", to_table(record),
             fs::proximate(out.path(".")).lexically_normal().string(),
             record.unstable          ? ", unstable.png"
             : options.waves          ? ", waves.fst"
             : !options.trace.empty() ? ", trace.json, trace.kanata"
                                      : "");
}

/// The record of a run from its options, before its scene is read.
RunRecord record_of(const SimOptions& options, Engine engine, const ImageSize& size, const shader::ShaderSet* shaders) {
  RunRecord record;
  if (shaders != nullptr) {
    record.shaders = options.shaders;
    record.waits = shaders->waits();
  }
  record.command = options.command;
  record.engine = options.engine;
  if (has_verilog(engine)) record.boundary = options.boundary.empty() ? "unit" : options.boundary;
  if (!record.boundary.empty()) parse_boundary(record.boundary);
  if (engine == Engine::Native) {
    record.hits = options.hits.empty() ? "own" : options.hits;
    record.precision = options.precision.empty() ? "single" : options.precision;
  }
  std::vector<std::string> set = options.set;
  if (!options.traverser.empty()) set.push_back("chip.traverser=" + options.traverser);
  if (shaders != nullptr) add_settings_for(*shaders, options.units, set);
  record.configuration = load_configuration(options.config, set);
  check_fields_in_use(record.configuration);
  record.width = size.width;
  record.height = size.height;
  record.depth = options.depth;
  record.units = options.units;
  record.samples = options.samples;
  return record;
}

/// What the machine's memory holds. `shaders`: that draw, or null. Throws InputError when the machine of the record
/// cannot draw the frame.
MemoryImage build_image(const SimOptions& options, RunRecord& record, const Scene& scene,
                        const shader::ShaderSet* shaders) {
  if (shaders == nullptr) {
    check_fits(record, scene);
    return build_memory(ray_program(record).program, scene);
  }
  check_shaders(record);
  MemoryImage image = build_shader_image(options.shader_source, *shaders, scene, record);
  check_fits(record, scene);
  return image;
}

/// Reports the centre of a scene that is recentred, if words of the machine are shown.
void tell_centre(const SimOptions& options, const Scene& scene) {
  if (!scene.recentred() || (!options.waves && options.inspect_until == 0)) return;
  const Vec3d& centre = scene.centre;
  fmt::print(stderr, "raypool: coordinates in words of the machine are counted from {}, {}, {} of the file\n", centre.x,
             centre.y, centre.z);
}

}  // namespace

int sim_command(const SimOptions& options) {
  const Progress whole(true);
  const Engine engine = parse_engine(options.engine);
  const ImageSize size = parse_image_size(options.size);
  check_options(options, engine);

  std::shared_ptr<const shader::ShaderSet> shaders;
  if (!options.shaders.empty()) shaders = options.shader_source.load(options.shaders);
  RunRecord record = record_of(options, engine, size, shaders.get());
  const Scene scene =
      load_scene_and_warn(options.scene, options.detail, options.view, options.look, !options.shaders.empty());
  record.scene = scene.name;
  record.triangles = scene.triangles.size();
  record.materials = scene.materials.size();
  record.view = scene.view();
  record.reflections = record.chip_depth() > 1 && (shaders || scene.reflects());
  tell_centre(options, scene);
  MemoryImage image = build_image(options, record, scene, shaders.get());
  if (options.modules) {
    print_modules(options, engine, record, scene, image);
    return 0;
  }
  OutputFolder out(options.out.empty()
                       ? default_folder(options, scene, record, size, shaders ? shaders->folder() : std::string())
                       : fs::path(options.out));

  clear_unfinished(out);
  // A run that is stopped leaves its waveform until then.
  std::optional<KeepRunning> keep_running;
  if (options.waves) keep_running.emplace();

  const FrameBuffer frame = draw(options, engine, record, scene, image, out, whole);
  if (shaders && record.chip) record.chip->ray_counts = record.chip->ray_counts.without_weights();
  if (shaders && record.native) record.native->ray_counts = record.native->ray_counts.without_weights();

  const std::vector<uint8_t> png = encode_png(frame);
  out.write("image.png", std::string(png.begin(), png.end()));
  record.wall_seconds = whole.seconds();
  const std::string report = to_json(record);
  out.write("report.json", report);
  out.publish();
  const std::string black = why_black(frame, record.chip ? record.chip->ray_counts : record.native->ray_counts, scene,
                                      eye_of(options, scene), shaders != nullptr);
  if (!black.empty()) std::fprintf(stderr, "raypool: warning: %s\n", black.c_str());
  if (options.json) {
    fmt::print("{}", report);
    return 0;
  }
  if (!options.quiet) print_table(options, record, out);
  return 0;
}

}  // namespace raypool
