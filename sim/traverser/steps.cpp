#include "traverser/steps.hpp"

#include <algorithm>

#include "scene/tree_file.hpp"

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64, kTriangleBytes = sizeof(TreeTriangle);
static_assert(sizeof(TreeNode) == node_bytes(NodeFormat::Compressed));
static_assert(sizeof(BvhNode) == node_bytes(NodeFormat::Exact));

/// Triangles of the leaf that end in this line.
uint32_t triangles_of(const Visit& leaf, uint32_t line) {
  const uint64_t line_end = (uint64_t{lines_of(leaf).first} + line + 1) * kLineBytes;
  const auto complete = [&](uint64_t end) {
    return std::clamp<uint64_t>(end / kTriangleBytes, leaf.place, uint64_t{leaf.place} + leaf.triangles);
  };
  return static_cast<uint32_t>(complete(line_end) - complete(line_end - kLineBytes));
}

/// Entries that are taken from the stack after a visit: those that lie too far, and that of the next visit.
uint32_t pops(const VisitList& visits, size_t visit) {
  const Visit& present = visits[visit];
  return present.discarded + (visit + 1 < visits.size() && present.children == 0 ? 1u : 0u);
}

}  // namespace

// A leaf's triangles lie one behind the other, so that some share a line, and some lie in two.
LineRange lines_of(const Visit& visit) {
  if (visit.triangles == 0) return {visit.place, 1};
  const auto first = static_cast<uint32_t>(uint64_t{visit.place} * kTriangleBytes / kLineBytes);
  const uint64_t end = (uint64_t{visit.place} + visit.triangles) * kTriangleBytes;
  return {first, static_cast<uint32_t>((end - 1) / kLineBytes) - first + 1};
}

void plan(const VisitList& visits, const StepLatencies& latencies, std::vector<Step>& steps) {
  steps.clear();
  for (size_t i = 0; i < visits.size(); ++i) {
    const Visit& visit = visits[i];
    const LineRange lines = lines_of(visit);
    Step step;
    step.line = lines.first;
    step.taken = pops(visits, i);
    step.node = visit.triangles == 0;
    if (step.node) {
      step.tests = step.all_tests = 1;
      step.pushed = static_cast<uint8_t>(std::max<int>(1, visit.children) - 1);
      steps.push_back(step);
      continue;
    }
    step.all_tests = visit.triangles;
    for (uint32_t line = 0; line < lines.count; ++line, ++step.line) {
      step.tests = static_cast<uint8_t>(triangles_of(visit, line));
      step.more = static_cast<uint8_t>(lines.count - line - 1);
      steps.push_back(step);
      step.all_tests = 0;
    }
  }
  // A visit's results, or the entries that are taken after it, say in one cycle what is looked up in the next.
  uint64_t rest = latencies.finish - 1;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    rest += latencies.cache +
            (step->more != 0 ? 1 : (step->node ? latencies.box : latencies.triangle) + std::max(1u, step->taken));
    step->rest = static_cast<uint32_t>(rest);
  }
}

}  // namespace raypool::traverser
