// The catalogue as a whole, and the machine that its cases run on.
#include "numerics/extremes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "bits.hpp"
#include "chip/program_run.hpp"
#include "chip/tree_image.hpp"
#include "isa/assembler.hpp"
#include "isa/encoding.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::numerics {
namespace {

constexpr uint64_t kCycleLimit = 20'000'000;  // a frame that takes longer hangs
constexpr uint32_t kResultAddress = 256;

bool is_nan(uint32_t bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

uint32_t operate_natively(const std::string& mnemonic, uint32_t a, uint32_t b, uint32_t c, const arith::Mode& mode) {
  if (mnemonic == "ffma") return arith::fma(a, b, c, mode);
  using Binary = uint32_t (*)(uint32_t, uint32_t, arith::Mode);
  static const std::map<std::string, Binary> kOperations = {
      {"fadd", arith::add},
      {"fsub", arith::sub},
      {"fmul", arith::mul},
      {"fdiv", arith::div},
      {"fmin", arith::min},
      {"fmax", arith::max},
      {"frcp", [](uint32_t x, uint32_t, arith::Mode m) { return arith::rcp(x, m); }},
      {"fsqrt", [](uint32_t x, uint32_t, arith::Mode m) { return arith::sqrt(x, m); }},
      {"frsqrt", [](uint32_t x, uint32_t, arith::Mode m) { return arith::rsqrt(x, m); }},
      {"f2i", [](uint32_t x, uint32_t, arith::Mode m) { return arith::to_int(x, m); }},
      {"i2f", [](uint32_t x, uint32_t, arith::Mode m) { return arith::from_int(x, m); }},
      {"feq", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::equal(x, y, m)}; }},
      {"fne", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::not_equal(x, y, m)}; }},
      {"flt", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::less(x, y, m)}; }},
      {"fle", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::less_equal(x, y, m)}; }},
      {"fgt", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::greater(x, y, m)}; }},
      {"fge", [](uint32_t x, uint32_t y, arith::Mode m) { return uint32_t{arith::greater_equal(x, y, m)}; }},
  };
  return kOperations.at(mnemonic)(a, b, mode);
}

/// One thread that computes `mnemonic` of arguments 0, 1 and 2 and stores the result.
Program operation_program(const std::string& mnemonic) {
  const InstructionInfo& info = instruction(mnemonic);
  std::string operands = has_operand(info, Operand::B) ? "r1, r2" : "r1";
  if (has_operand(info, Operand::Rc)) operands += ", r6";
  const std::string compute =
      writes_predicate(info) ? fmt::format("{} p1, {}\nmov r4, 0\nmov r3, 1\nsel r3, p1, r3, r4\n", mnemonic, operands)
                             : fmt::format("{} r3, {}\n", mnemonic, operands);
  return assemble(
      fmt::format("arg r1, 0\narg r2, 1\narg r6, 2\n{}mov r5, {}\nst [r5+0], r3\nexit\n", compute, kResultAddress),
      "operation");
}

/// Puts what a frame left into an order that is the same for all engines.
void sort(Drawing& drawing) {
  std::sort(drawing.traced.begin(), drawing.traced.end(),
            [](const TracedRay& a, const TracedRay& b) { return a.ray < b.ray; });
  std::sort(drawing.contributions.begin(), drawing.contributions.end(),
            [](const FrameContribution& a, const FrameContribution& b) {
              return a.pixel != b.pixel ? a.pixel < b.pixel : a.rgb < b.rgb;
            });
}

void require_same(const Drawing& ours, const Drawing& native) {
  const auto same = [](bool condition, const char* otherwise) {
    if (!condition) throw EngineDifference(otherwise);
  };
  auto equal_rays = [](const TracedRay& a, const TracedRay& b) {
    return a.ray == b.ray && a.goes_on == b.goes_on && (!a.goes_on || a.intersection == b.intersection);
  };
  same(ours.traced.size() == native.traced.size() &&
           std::equal(ours.traced.begin(), ours.traced.end(), native.traced.begin(), equal_rays),
       "its rays are not those of engine native");
  auto equal_contributions = [](const FrameContribution& a, const FrameContribution& b) {
    return a.pixel == b.pixel && a.rgb == b.rgb;
  };
  same(ours.contributions.size() == native.contributions.size() &&
           std::equal(ours.contributions.begin(), ours.contributions.end(), native.contributions.begin(),
                      equal_contributions),
       "its contributions are not those of engine native");
  same(ours.frame == native.frame, "its picture is not that of engine native");
}

/// Finds hits, by the scene or by the frame's own function, and writes down what was asked.
class RecordingTracer : public RayTracer {
 public:
  RecordingTracer(const ExtremeFrame& frame, uint32_t material_base, std::vector<TracedRay>& traced)
      : frame_(frame), material_base_(material_base), tracer_(frame.scene, material_base), traced_(traced) {}

  bool trace(const Ray& ray, Intersection& intersection) override {
    bool goes_on = false;
    if (frame_.trace) {
      intersection.fill(0);
      std::copy(ray.begin(), ray.end(), intersection.begin());
      goes_on = frame_.trace(ray, intersection);
      intersection[word::kMaterial] =
          material_base_ + intersection[word::kMaterial] * static_cast<uint32_t>(kMaterialBytes);
    } else {
      goes_on = tracer_.trace(ray, intersection);
    }
    traced_.push_back({ray, goes_on, intersection});
    return goes_on;
  }
  const Tracer& scene_tracer() const { return tracer_; }
  void set_triangle_test(const TriangleTest& test) { tracer_.set_triangle_test(test); }
  void take_hits_of(const ChipConfiguration& chip) { tracer_.take_hits_of(chip); }

 private:
  const ExtremeFrame& frame_;
  uint32_t material_base_;
  Tracer tracer_;
  std::vector<TracedRay>& traced_;
};

class RecordingSink : public FrameSink {
 public:
  explicit RecordingSink(Drawing& drawing) : drawing_(drawing) {}
  void add(const FrameContribution& contribution) override {
    drawing_.contributions.push_back(contribution);
    drawing_.frame.add(contribution);
  }

 private:
  Drawing& drawing_;
};

/// With the hits of `chip`, if there is one.
Drawing draw_natively(const ExtremeFrame& frame, const arith::Mode& mode, const std::optional<TriangleTest>& test,
                      const ChipConfiguration* chip = nullptr) {
  Drawing drawing{FrameBuffer(frame.width, frame.height), {}, {}};
  const MemoryImage image = build_memory(ray_kernel_program({mode.fused, false}), frame.scene);
  RecordingTracer tracer(frame, image.material_base, drawing.traced);
  if (test) tracer.set_triangle_test(*test);
  if (chip != nullptr) tracer.take_hits_of(*chip);
  NativeOptions options;
  options.width = frame.width;
  options.height = frame.height;
  options.depth = frame.depth;
  options.mode = mode;
  options.change_arguments = frame.change_arguments;
  options.trace = [&](const Ray& ray, Intersection& intersection) { return tracer.trace(ray, intersection); };
  options.kernel = [&](RayKernel which, NativeThread& thread) {
    run_native(which, thread);
    drawing.contributions.insert(drawing.contributions.end(), thread.frame.begin(), thread.frame.end());
  };
  drawing.frame = render_native(frame.scene, image, tracer.scene_tracer(), options);
  sort(drawing);
  return drawing;
}

}  // namespace

uint64_t Drawing::nan_contributions() const {
  return static_cast<uint64_t>(
      std::count_if(contributions.begin(), contributions.end(),
                    [](const FrameContribution& c) { return std::any_of(c.rgb.begin(), c.rgb.end(), is_nan); }));
}

std::vector<TracedRay> Drawing::rays(bool shadow, uint32_t depth) const {
  std::vector<TracedRay> found;
  std::copy_if(traced.begin(), traced.end(), std::back_inserter(found),
               [&](const TracedRay& t) { return t.ray[word::kFlags] == ((shadow ? kShadowFlag : 0) | depth); });
  return found;
}

void require(bool condition, const std::string& otherwise) {
  if (!condition) throw ExtremeFailure(otherwise);
}

ExtremeMachine::ExtremeMachine(std::string engine, const ArithmeticMode& mode, const Configuration& base,
                               UnitMaker unit)
    : engine_(std::move(engine)), mode_(mode), configuration_(mode.applied_to(base)), unit_(std::move(unit)) {
  configuration_.chip.traverser = TraverserName::Static;  // at the ports its rays are seen
}

ExtremeMachine::ExtremeMachine(std::string engine, const ArithmeticMode& mode, const Configuration& base,
                               ChipMaker chip)
    : engine_(std::move(engine)), mode_(mode), configuration_(mode.applied_to(base)), chip_(std::move(chip)) {}

std::vector<Configuration> ExtremeMachine::chips() const {
  Configuration ports = configuration_;
  ports.chip.traverser = TraverserName::Static;
  return {configuration_, ports};
}

uint32_t ExtremeMachine::operate(const std::string& mnemonic, uint32_t a, uint32_t b, uint32_t c) const {
  const uint32_t native = operate_natively(mnemonic, a, b, c, mode_.mode);
  if (!unit_) return native;
  const uint32_t ours = operate_on_unit(mnemonic, a, b, c);
  if (ours != native) {
    throw EngineDifference(fmt::format("{} of {:08x}, {:08x} and {:08x} is {:08x}, but {:08x} on engine native",
                                       mnemonic, a, b, c, ours, native));
  }
  return ours;
}

uint32_t ExtremeMachine::operate_on_unit(const std::string& mnemonic, uint32_t a, uint32_t b, uint32_t c) const {
  const Program program = operation_program(mnemonic);
  Memory memory(kResultAddress + 64);
  for (uint32_t i = 0; i < program.code.size(); ++i) {
    memory.store(8 * i, static_cast<uint32_t>(program.code[i]));
    memory.store(8 * i + 4, static_cast<uint32_t>(program.code[i] >> 32));
  }
  const std::unique_ptr<ComputeUnit> unit = unit_(configuration_, memory);
  ProgramOptions options;
  options.configuration = configuration_;
  options.device = unit.get();
  options.memory = &memory;
  options.program_length = size32(program.code);
  options.arguments[0] = a;
  options.arguments[1] = b;
  options.arguments[2] = c;
  options.limits.cycles = kCycleLimit;
  run_program(options);
  return memory.load(kResultAddress);
}

Drawing ExtremeMachine::draw(const ExtremeFrame& frame) const {
  if (chip_) return draw_on_chip(frame);
  Drawing native = draw_natively(frame, mode_.mode, triangle_test_);
  if (!unit_) return native;
  Drawing ours = draw_on_unit(frame);
  require_same(ours, native);
  return ours;
}

namespace {

/// Draws on what `make` makes of the configuration, the frame and its memory.
template <typename Make>
Drawing draw_on(const Configuration& configuration, const ExtremeFrame& frame, const Make& make) {
  Drawing drawing{FrameBuffer(frame.width, frame.height), {}, {}};
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  MemoryImage image = build_memory(program, frame.scene);
  RecordingTracer tracer(frame, image.material_base, drawing.traced);
  RecordingSink sink(drawing);
  ChipOptions chip;
  chip.configuration = configuration;
  chip.memory = &image.memory;
  chip.program_length = size32(program.code);
  for (size_t i = 0; i < kRayKernels; ++i) chip.entries[i] = program.entries.at(std::string(kRayKernelNames[i]));
  chip.layout = ray_record_layout(configuration);
  chip.arguments =
      camera_arguments(frame.scene, frame.width, frame.height, configuration.contents(), configuration.significand);
  if (frame.change_arguments) frame.change_arguments(chip.arguments);
  chip.width = frame.width;
  chip.height = frame.height;
  chip.depth = frame.depth;
  chip.tracer = &tracer;
  chip.frame = &sink;
  chip.limits.cycles = kCycleLimit;
  std::optional<TreeImage> tree;
  if (has_traverser(configuration.chip)) {
    tree =
        make_tree_image(frame.scene, tracer.scene_tracer().traversal().bvh(), configuration.chip, image.material_base);
    chip.tree = &*tree;
  }
  const std::unique_ptr<ChipDevice> device = make(chip, image.memory);
  run_board(chip, *device);
  sort(drawing);
  return drawing;
}

}  // namespace

Drawing ExtremeMachine::draw_on_unit(const ExtremeFrame& frame) const {
  return draw_on(configuration_, frame, [&](ChipOptions& chip, Memory& memory) {
    return make_chip_around(chip, unit_(configuration_, memory));
  });
}

Drawing ExtremeMachine::draw_on_chip(const ExtremeFrame& frame) const {
  const Configuration machine = chips()[frame.trace ? 1 : 0];
  const Drawing native = draw_natively(frame, mode_.mode, {}, &machine.chip);
  Drawing ours = draw_on(machine, frame, [&](const ChipOptions&, Memory& memory) { return chip_(machine, memory); });
  // What goes over the ports of a traverser inside the lockstep compares.
  if (!frame.trace) ours.traced = native.traced;
  require_same(ours, native);
  return ours;
}

const std::vector<ExtremeCase>& extreme_cases() {
  static const std::vector<ExtremeCase> kCases = [] {
    std::vector<ExtremeCase> all;
    for (auto* theme :
         {arithmetic_extremes, ray_extremes, triangle_extremes, scene_extremes, shading_extremes, image_extremes}) {
      const std::vector<ExtremeCase> cases = theme();
      all.insert(all.end(), cases.begin(), cases.end());
    }
    return all;
  }();
  return kCases;
}

ExtremeOutcome run_extreme(const ExtremeCase& extreme, const ExtremeMachine& machine) {
  const auto failure = [](const std::exception& error) {
    const std::string text = error.what();
    return ExtremeOutcome{false, text.empty() ? "it failed without saying why" : text};
  };
  try {
    extreme.check(machine);
    return {true, ""};
  } catch (const EngineDifference& error) {
    return failure(error);
  } catch (const ExtremeFailure& error) {
    return machine.significand() < extreme.least_significand ? ExtremeOutcome{} : failure(error);
  } catch (const std::exception& error) {
    return failure(error);
  }
}

}  // namespace raypool::numerics
