// Answers of the Verilog to a corpus of the referee (docs/use/referee.md): referee_answers < corpus.jsonl >
// answers.jsonl The triangle pipe is given a test a cycle, of one case after another, as a lane gives them; a ray's
// set-up and the scale of its t are those of the classes, which benches compare with their Verilog.
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "Vtriangle_pipe_32.h"
#include "machine/traverser/ray_finish.hpp"
#include "machine/traverser/ray_setup.hpp"
#include "machine/traverser/triangle_pipe.hpp"
#include "scene/bvh.hpp"
#include "scene/hard_rays.hpp"
#include "scene/hit_case.hpp"
#include "unit/common/clocked.hpp"
#include "unit/traverser/triangle_signals.hpp"

namespace raypool::bench {
namespace {

/// A ray with tests in the pipe.
struct Flight {
  NumberedAnswer answer;
  RaySetup setup{{}, {}, 0};
  size_t left = 0;  ///< results that are to come
  float best_t = INFINITY;
  Triangle best{{}, kNoChild};
  std::vector<Triangle> triangles;  ///< of the tree, in its order

  explicit Flight(const HitCase& hit_case) {
    answer.number = hit_case.number;
    const RayQuery& ray = hit_case.ray;
    const Bvh tree = build_bvh(scene_of(hit_case.triangles));
    const auto words = [](const Vec3& v, float(&to)[3]) { to[0] = v.x, to[1] = v.y, to[2] = v.z; };
    RayWords given{};
    RootBox root{};
    words(ray.origin, given.origin), words(ray.direction, given.direction);
    given.limit = ray.limit;
    words(tree.bounds.lower, root.lower), words(tree.bounds.upper, root.upper);
    setup = RaySetup(given, root, kMostBoxBits);
    for (const TriangleBlock& block : tree.blocks) {
      for (uint32_t lane = 0; lane < block.count; ++lane) add(block, lane);
    }
    if (!setup.valid) triangles.clear();
    left = triangles.size();
  }
  Flight() = default;

 private:
  void add(const TriangleBlock& block, uint32_t lane) {
    Triangle triangle{{}, block.triangles[lane]};
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) triangle.corners[corner][axis] = block.vertices[corner][axis][lane];
    }
    triangles.push_back(triangle);
  }
};

class PipeAnswers : Clocked<Vtriangle_pipe_32> {
 public:
  PipeAnswers() : Clocked(1), flights_(kTags) {}

  void answer(const HitCase& hit_case) {
    const uint32_t tag = next_tag_++ % kTags;
    Flight& flight = flights_[tag] = Flight(hit_case);
    if (flight.left == 0) print(flight);
    for (size_t i = 0, count = flight.left; i < count; ++i) {
      set_triangle_ray(*u, flight.setup.triangle);
      const Triangle& triangle = flight.triangles[i];
      for (int corner = 0; corner < 3; ++corner) set_floats(&u->corners_i[3 * corner], triangle.corners[corner]);
      u->number_i = triangle.number;
      u->tag_i = static_cast<uint8_t>(tag);
      cycle(true);
    }
  }
  /// Until all results are there.
  void finish() {
    for (uint32_t i = 0; i <= TrianglePipe::stages(32); ++i) cycle(false);
  }

 private:
  static constexpr uint32_t kTags = 256;  // more than tests in the pipe

  void cycle(bool begins) {
    u->valid_i = begins;
    // What the pipe shows comes from registers, as the last edge has left them.
    if (u->valid_o) take(flights_[u->tag_o]);
    const Flight &limited = flights_[limit_tag_], &compared = flights_[best_tag_];
    u->limit_i = as_bits(limited.setup.limit);
    u->scale_i = limited.setup.scale & 0x1ff;
    u->best_t_i = as_bits(compared.best_t);
    u->best_number_i = compared.best.number;
    limit_tag_ = u->limit_tag_o;
    best_tag_ = u->best_tag_o;
    clock();
  }
  void take(Flight& flight) {
    if (u->hit_o) {
      flight.best_t = as_float(u->t_o);
      for (const Triangle& triangle : flight.triangles) {
        if (triangle.number == u->number_o) flight.best = triangle;
      }
    }
    if (--flight.left == 0) print(flight);
  }
  static void print(Flight& flight) {
    if (flight.best.number != kNoChild) {
      const RayFinish made(flight.setup.triangle, flight.best, flight.best_t, flight.setup.scale);
      flight.answer.answer = {true, flight.best.number, made.t};
    }
    std::puts(to_line(flight.answer).c_str());
  }

  std::vector<Flight> flights_;
  uint32_t next_tag_ = 0, limit_tag_ = 0, best_tag_ = 0;
};

int answer_all() {
  std::ios::sync_with_stdio(false);
  PipeAnswers pipe;
  uint64_t number = 0;
  for (std::string line; std::getline(std::cin, line); ++number) {
    HitCase hit_case = parse_hit_case(line, "corpus, line " + std::to_string(number + 1));
    hit_case.number = number;
    pipe.answer(hit_case);
  }
  pipe.finish();
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace
}  // namespace raypool::bench

int main() {
  try {
    return raypool::bench::answer_all();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "referee_answers: %s\n", error.what());
    return 1;
  }
}
