// A catalogue of hard cases, each with the behaviour that is defined for it, and the machine that they are run on: one
// arithmetic mode on one engine. The rule for all: no hang, no NaN in a picture, and every engine gives the same bits.
//
// A case checks what happened on its machine. ExtremeMachine itself checks the rule: every drawing and every operation
// of another engine is compared with engine native's, and a frame that does not end is a failure.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "chip/board.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"
#include "numerics/modes.hpp"
#include "scene/image.hpp"
#include "scene/narrow_triangles.hpp"
#include "scene/scene.hpp"

namespace raypool::numerics {

/// A frame to draw. Its scene need not pass check_scene().
struct ExtremeFrame {
  Scene scene;
  int width = 1, height = 1, depth = 2;
  std::function<void(std::array<uint32_t, kArguments>&)> change_arguments;  ///< may be empty
  /// Takes the place of the scene's tracer; may be empty. Intersections name
  /// materials by their number in word kMaterial.
  std::function<bool(const Ray&, Intersection&)> trace;
};

struct TracedRay {
  Ray ray{};
  bool goes_on = false;         ///< a normal ray hit, a shadow ray was not blocked
  Intersection intersection{};  ///< meaningful when it goes on
};

/// What a frame left. Rays and contributions in an order that does not depend on the engine.
struct Drawing {
  FrameBuffer frame;
  std::vector<TracedRay> traced;
  std::vector<FrameContribution> contributions;

  uint64_t nan_contributions() const;
  /// Rays of a kind that were traced.
  std::vector<TracedRay> rays(bool shadow, uint32_t depth) const;
};

/// What is wrong; ends a case.
struct ExtremeFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// An engine does not do what engine native does.
struct EngineDifference : ExtremeFailure {
  using ExtremeFailure::ExtremeFailure;
};
/// Throws ExtremeFailure unless `condition`.
void require(bool condition, const std::string& otherwise);

/// Makes the compute unit of an engine, over a memory that outlives it.
using UnitMaker = std::function<std::unique_ptr<ComputeUnit>(const Configuration&, Memory&)>;

class ExtremeMachine {
 public:
  /// Without `unit` engine native; else the engine that it makes. `base` gets the mode's arithmetic.
  ExtremeMachine(std::string engine, const ArithmeticMode& mode, const Configuration& base, UnitMaker unit = nullptr);
  /// A whole chip, with its own traverser where the frame has none: frames alone are drawn on it, and rays are those of
  /// engine native with that traverser's hits.
  ExtremeMachine(std::string engine, const ArithmeticMode& mode, const Configuration& base, ChipMaker chip);

  /// The chips that it makes: as it is, and for frames that have a traverser of their own without one.
  std::vector<Configuration> chips() const;

  /// Rays of engine native hit by this test; there must be no other engine.
  void set_triangle_test(const TriangleTest& test) { triangle_test_ = test; }

  const std::string& engine() const { return engine_; }
  const ArithmeticMode& mode() const { return mode_; }
  bool flushes() const { return mode_.mode.subnormals != Subnormals::Ieee; }
  int significand() const { return static_cast<int>(mode_.mode.significand); }
  bool exact() const { return mode_.mode.slow_unit == SlowUnit::Exact; }

  /// Result of one instruction, flt or slw unit or float compare (then 0 or 1), on bit
  /// patterns; ffma only where the mode has it.
  /// Throws EngineDifference when it is not engine native's.
  uint32_t operate(const std::string& mnemonic, uint32_t a, uint32_t b = 0, uint32_t c = 0) const;
  /// Throws ExtremeFailure when the frame does not end, EngineDifference when it is not engine native's, bit for bit;
  /// InputError for what the scene checks refuse.
  Drawing draw(const ExtremeFrame& frame) const;

 private:
  uint32_t operate_on_unit(const std::string& mnemonic, uint32_t a, uint32_t b, uint32_t c) const;
  Drawing draw_on_unit(const ExtremeFrame& frame) const;
  Drawing draw_on_chip(const ExtremeFrame& frame) const;

  std::string engine_;
  ArithmeticMode mode_;
  Configuration configuration_;
  UnitMaker unit_;
  ChipMaker chip_;
  std::optional<TriangleTest> triangle_test_;
};

struct ExtremeCase {
  std::string theme, name;
  std::string expected;                              ///< the defined behaviour, one clause
  std::function<void(const ExtremeMachine&)> check;  ///< throws ExtremeFailure
  int least_significand = 11;  ///< bits with which the behaviour holds; with fewer it may break, on all engines alike
};

// The themes; each file has one.
std::vector<ExtremeCase> arithmetic_extremes();
std::vector<ExtremeCase> ray_extremes();
std::vector<ExtremeCase> triangle_extremes();
std::vector<ExtremeCase> scene_extremes();
std::vector<ExtremeCase> shading_extremes();
std::vector<ExtremeCase> image_extremes();
/// All of them.
const std::vector<ExtremeCase>& extreme_cases();

struct ExtremeOutcome {
  bool holds = false;   ///< the behaviour is the expected one
  std::string failure;  ///< what is wrong; empty also where it may break, and does
};
ExtremeOutcome run_extreme(const ExtremeCase& extreme, const ExtremeMachine& machine);

}  // namespace raypool::numerics
