// `raypool scene` and `raypool hits`
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <vector>

#include "cli/image_size.hpp"
#include "files/output_files.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"
#include "scene/far_places.hpp"
#include "scene/hits_check.hpp"
#include "scene/scene.hpp"
#include "scene/scene_cache.hpp"
#include "scene/tree_file.hpp"
#include "tools/commands.hpp"

namespace raypool {
namespace {

template <typename Number>
std::string text(const Vector3<Number>& vector) {
  return fmt::format("{:g} {:g} {:g}", vector.x, vector.y, vector.z);
}

/// In the file's coordinates; of a scene far from their origin with all of their digits.
std::string place_text(const Scene& scene, const Vec3& place) {
  return scene.recentred() ? fmt::format("{}", fmt::join(texts_in_file(scene.centre, place), " ")) : text(place);
}

Scene load(const SceneCommandOptions& options) {
  return load_scene_and_warn(options.scene, options.detail, options.view, options.look);
}

void print_counts(const char* kind, const HitCounts& counts, const TraversalCounts& visits) {
  const double rays = counts.rays > 0 ? static_cast<double>(counts.rays) : 1;
  fmt::print("{:<8} {:>10} {:>10} {:>8} {:>11} {:>13} {:>11.1f} {:>15.1f}\n", kind, counts.rays, counts.agree,
             counts.ties, counts.ours_wrong, counts.embree_wrong, static_cast<double>(visits.nodes) / rays,
             static_cast<double>(visits.triangles) / rays);
}

/// What of it is printed.
std::string write_bvh(const Scene& scene, const std::string& path, OutputFiles& files) {
  const TreeFile tree = make_tree_file(scene);
  const std::string bytes = to_bytes(tree);
  files.write(path, bytes);
  std::string text = fmt::format("tree       {} nodes, {} triangles, {} bytes", tree.nodes.size(),
                                 tree.triangles.size(), bytes.size());
  if (tree.triangles.empty()) return text;
  const double share = static_cast<double>(bytes.size()) / static_cast<double>(tree.triangles.size());
  return text + fmt::format(", {:.1f} a triangle", share);
}

double megabytes(uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

int cache_command(const std::string& what) {
  const bool clear = what == "clear";
  if (!clear && what != "show") {
    throw InputError(
        fmt::format("--cache is '{}'{}", what, did_you_mean(what, {"show", "clear"}, "use show or clear")));
  }
  const std::optional<SceneCache>& cache = SceneCache::of_program();
  if (!cache) throw InputError("nothing is kept of scenes: set XDG_CACHE_HOME to a folder of your own");
  if (clear) {
    fmt::print("{} entries removed from {}\n", cache->clear(), cache->folder());
    return 0;
  }
  uint64_t bytes = 0;
  const std::vector<SceneCache::Entry> entries = cache->entries();
  for (const SceneCache::Entry& entry : entries) {
    fmt::print("{:>9.1f} MB  {}\n", megabytes(entry.bytes), entry.what);
    bytes += entry.bytes;
  }
  fmt::print("{:>9.1f} MB  of {:.0f} MB at most, {} entries, last used first, in {}\n", megabytes(bytes),
             megabytes(cache->limit()), entries.size(), cache->folder());
  return 0;
}

}  // namespace

int scene_command(const SceneCommandOptions& options) {
  if (!options.cache.empty()) return cache_command(options.cache);
  const Scene scene = load(options);
  if (!options.write_bvh.empty() && options.write_bvh == options.write_obj)
    throw InputError("--write-obj and --write-bvh name the same file: give them two");
  // Of both or none: what can fail comes before the OBJ gets its name.
  OutputFiles files;
  const std::string tree = options.write_bvh.empty() ? "" : write_bvh(scene, options.write_bvh, files);
  if (!options.write_obj.empty()) write_obj(scene, options.write_obj);
  files.publish();

  size_t degenerate = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i) degenerate += is_degenerate(scene, i) ? 1 : 0;
  size_t mirrors = 0;
  for (const Material& material : scene.materials) mirrors += material.reflects() ? 1 : 0;
  const Bounds bounds = scene.bounds();
  fmt::print("scene      {}\n", scene.name);
  fmt::print("triangles  {}, of which {} have no area; {} vertices\n", scene.triangles.size(), degenerate,
             scene.vertices.size());
  fmt::print("materials  {}, of which {} reflect\n", scene.materials.size(), mirrors);
  fmt::print("box        {} .. {}\n", place_text(scene, bounds.lower), place_text(scene, bounds.upper));
  if (scene.recentred()) {
    fmt::print("centre     {} {} {}, from which coordinates are counted in single precision\n", scene.centre.x,
               scene.centre.y, scene.centre.z);
  }
  if (!scene.cameras.empty()) {
    const std::vector<std::string> others(scene.cameras.begin() + 1, scene.cameras.end());
    fmt::print("cameras    '{}'{}{}\n", scene.cameras.front(),
               others.empty() ? "" : "; with --camera: ", fmt::join(others, ", "));
  }
  fmt::print("camera     eye {}, direction {}, up {}, vertical field of view {:g} degrees\n",
             place_text(scene, scene.camera.eye), text(scene.camera.direction), text(scene.camera.up),
             scene.camera.fov);
  fmt::print("light      position {}, colour {}\n", place_text(scene, scene.light.position), text(scene.light.color));
  if (!tree.empty()) fmt::print("{}\n", tree);
  return 0;
}

int hits_command(const SceneCommandOptions& options) {
  const ImageSize size = parse_image_size(options.size);
  const Scene scene = load(options);
  HitsOptions hits;
  hits.width = size.width;
  hits.height = size.height;
  const HitsReport report = compare_with_embree(scene, hits);

  fmt::print("{} at {}x{}, our traversal against Embree's (robust)\n", scene.name, size.width, size.height);
  fmt::print("rays           count      agree     ties  ours wrong  Embree wrong  nodes a ray  triangles a ray\n");
  print_counts("primary", report.primary, report.primary_visits);
  print_counts("shadow", report.shadow, report.shadow_visits);
  for (const std::string& line : report.explanations) fmt::print("  {}\n", line);
  return 0;
}

}  // namespace raypool
