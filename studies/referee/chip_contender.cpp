#include "referee/chip_contender.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "bits.hpp"
#include "chip/tree_image.hpp"
#include "isa/assembler.hpp"
#include "scene/traversal.hpp"

namespace raypool::referee {
namespace {

constexpr uint32_t kProgramBytes = 1024, kRayAddress = kProgramBytes, kAnswerAddress = kProgramBytes + 64;
constexpr uint64_t kCycleLimit = 10'000'000;

/// One pixel casts the ray in memory; what it hits is stored.
Program program() {
  std::string text = fmt::format(".kernel {}\ntid r0\nieq p1, r0, 0\nmov r1, {}\n",
                                 kRayKernelNames[static_cast<size_t>(RayKernel::CastEye)], kRayAddress);
  for (uint32_t number = 0; number < kRayWords; ++number)
    text += fmt::format("ld r2, [r1+{}]\nrst {}, r2\n", 4 * number, number);
  text += "@p1 rout\nexit\n";
  for (const RayKernel kernel : {RayKernel::CastSecondary, RayKernel::CastSecondaryDirect, RayKernel::Shade}) {
    text += fmt::format(".kernel {}\nrin\nrld r1, {}\nrld r2, {}\nmov r3, {}\nst [r3], r1\nst [r3+4], r2\nexit\n",
                        kRayKernelNames[static_cast<size_t>(kernel)], word::kDistance, word::kTriangle, kAnswerAddress);
  }
  return assemble(text, "the referee's kernels");
}

class NoPicture : public FrameSink {
 public:
  void add(const FrameContribution& /*contribution*/) override {}
};

class ChipAnswers : public Contender {
 public:
  ChipAnswers(std::string name, const Configuration& configuration, const ChipMaker& make)
      : name_(std::move(name)),
        configuration_(configuration),
        program_(program()),
        memory_(kProgramBytes + 128),
        chip_(make(configuration, memory_)) {
    for (uint32_t i = 0; i < program_.code.size(); ++i) {
      memory_.store(8 * i, static_cast<uint32_t>(program_.code[i]));
      memory_.store(8 * i + 4, static_cast<uint32_t>(program_.code[i] >> 32));
    }
  }

  std::vector<std::string> names() const override { return {name_}; }

  void answer(const HitCase& hit_case, Said* answers) override {
    const Scene scene = scene_of(hit_case);
    const Traversal traversal(scene);
    TreeImage tree = make_tree_image(scene, traversal.bvh(), configuration_.chip, 0);
    store(hit_case.ray);
    ChipOptions options;
    options.configuration = configuration_;
    options.memory = &memory_;
    options.program_length = size32(program_.code);
    for (size_t i = 0; i < kRayKernels; ++i) options.entries[i] = program_.entries.at(std::string(kRayKernelNames[i]));
    options.width = options.height = 1;
    options.depth = 1;
    options.tree = &tree;
    options.frame = &picture_;
    options.limits.cycles = kCycleLimit;
    run_board(options, *chip_);
    const uint32_t triangle = memory_.load(kAnswerAddress + 4);
    *answers = HitAnswer{triangle != kNone, triangle == kNone ? 0 : triangle, as_float(memory_.load(kAnswerAddress))};
  }

 private:
  static constexpr uint32_t kNone = 0xffffffff;

  void store(const RayQuery& query) {
    Ray ray{};
    for (int axis = 0; axis < 3; ++axis) {
      ray[word::kOrigin + axis] = as_bits(query.origin[axis]);
      ray[word::kDirection + axis] = as_bits(query.direction[axis]);
      ray[word::kColor + axis] = as_bits(1.0f);
    }
    ray[word::kLimit] = as_bits(query.limit);
    ray[word::kFlags] = 1;
    for (uint32_t i = 0; i < ray.size(); ++i) memory_.store(kRayAddress + 4 * i, ray[i]);
    memory_.store(kAnswerAddress, 0);
    memory_.store(kAnswerAddress + 4, kNone);
  }

  std::string name_;
  const Configuration configuration_;
  const Program program_;
  Memory memory_;
  std::unique_ptr<ChipDevice> chip_;
  NoPicture picture_;
};

}  // namespace

std::unique_ptr<Contender> chip_answers(std::string name, const Configuration& configuration, const ChipMaker& make) {
  return std::make_unique<ChipAnswers>(std::move(name), configuration, make);
}

}  // namespace raypool::referee
