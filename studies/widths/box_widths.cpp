#include "widths/box_widths.hpp"

#include <fmt/format.h>

#include "bits.hpp"

namespace raypool {
namespace {

bool same(const Hit& a, const Hit& b) {
  return a.triangle == b.triangle && as_bits(a.t) == as_bits(b.t) && as_bits(a.u) == as_bits(b.u) &&
         as_bits(a.v) == as_bits(b.v);
}

/// "+2.3%", beside the first row.
std::string more(uint64_t visits, uint64_t of_floats) {
  if (of_floats == 0) return "";
  return fmt::format("{:+.1f}%", 100 * (static_cast<double>(visits) / static_cast<double>(of_floats) - 1));
}

}  // namespace

BoxWidths try_box_widths(const Scene& scene, const std::vector<BenchRays>& rays, const std::vector<uint32_t>& widths,
                         const std::function<void(double)>& progress) {
  const Traversal exact(scene);
  BoxWidths result;
  for (const BenchRays& kind : rays) result.rays += kind.rays.size();
  std::vector<uint32_t> all{0};
  all.insert(all.end(), widths.begin(), widths.end());
  const double work = static_cast<double>(result.rays) * static_cast<double>(all.size());
  uint64_t done = 0;
  for (const uint32_t bits : all) {
    Traversal tree = exact;
    tree.compress_nodes(bits);
    BoxWidthRow row;
    row.bits = bits;
    for (const BenchRays& kind : rays) {
      for (const RayQuery& ray : kind.rays) {
        if (kind.any) {
          row.different += tree.occluded(ray, &row.visits) != exact.occluded(ray);
        } else {
          Hit ours, expected;
          const bool hits = exact.nearest(ray, expected);
          row.different += tree.nearest(ray, ours, &row.visits) != hits || (hits && !same(ours, expected));
        }
        if (progress && (++done & 0xfff) == 0) progress(static_cast<double>(done) / work);
      }
    }
    result.rows.push_back(row);
  }
  return result;
}

std::string box_width_table(const BoxWidths& tried) {
  const double rays = tried.rays > 0 ? static_cast<double>(tried.rays) : 1;
  const TraversalCounts& floats = tried.rows.front().visits;
  std::string text = "bits   nodes a ray    more  triangles a ray    more  different answers\n";
  for (const BoxWidthRow& row : tried.rows) {
    const bool first = row.bits == 0;
    text += fmt::format("{:<5} {:>12.3f} {:>7} {:>16.3f} {:>7} {:>18}\n", first ? "float" : fmt::to_string(row.bits),
                        static_cast<double>(row.visits.nodes) / rays, first ? "" : more(row.visits.nodes, floats.nodes),
                        static_cast<double>(row.visits.triangles) / rays,
                        first ? "" : more(row.visits.triangles, floats.triangles), row.different);
  }
  return text;
}

}  // namespace raypool
