#include "cli/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "cli/version.hpp"
#include "files/json_text.hpp"
#include "kernel/kernel_report.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

double share(uint64_t part, uint64_t rest) {
  return part + rest == 0 ? 0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

double ratio(uint64_t part, uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

double hit_rate(const CacheWork& cache) { return share(cache.hits, cache.misses + cache.joined); }

double rate(uint64_t count, double seconds) { return seconds > 0 ? static_cast<double>(count) / seconds : 0; }

/// The set, and what its kernels have become on this machine.
Json shaders_json(const RunRecord& record) {
  Json instructions;
  for (const std::string_view name : kRayKernelNames)
    instructions[std::string(name)] = extract_kernel(record.kernels->program, std::string(name)).code.size();
  Json spilled;
  for (size_t i = 0; i < kRayKernels; ++i) {
    const kernel::SpillCounts& counts = record.kernels->counts[i].spilled;
    spilled[std::string(kRayKernelNames[i])] = {{"to_words", counts.to_words}, {"to_memory", counts.to_memory}};
  }
  return {
      {"folder", record.shaders}, {"samples", record.samples}, {"instructions", instructions}, {"spilled", spilled}};
}

/// A figure that only an engine with a notion of time has.
template <typename Value>
Json timed(const ChipResult& chip, const Value& value) {
  return chip.timed ? Json(value) : Json(nullptr);
}

Json pool_json(const PoolFill& pool) { return {{"capacity", pool.capacity}, {"peak", pool.peak}, {"mean", pool.mean}}; }

Json lockstep_json(const ChipLockstepCounts& counts) {
  return {{"differences", counts.differences},
          {"cycles", counts.cycles},
          {"kernels", counts.kernels},
          {"rays", counts.rays},
          {"intersections", counts.intersections},
          {"frame_contributions", counts.contributions},
          {"memory_reads", counts.memory_reads},
          {"memory_writes", counts.memory_writes}};
}

Json lockstep_json(const LockstepCounts& counts) {
  return {{"instructions", counts.instructions},
          {"differences", counts.differences},
          {"cycles", counts.cycles},
          {"kernels", counts.kernels},
          {"thread_results", counts.thread_results},
          {"stored_words", counts.stores},
          {"memory_writes", counts.memory_writes},
          {"ray_words", counts.ray_words},
          {"imports", counts.imports},
          {"exports", counts.exports},
          {"frame_contributions", counts.frame_contributions}};
}

void add_rays(Json& json, const RayCounts& rays, uint64_t too_deep) {
  const auto by_kind = [&](uint64_t RayCounts::Kind::*figure) {
    return Json{{"eye", rays.eye.*figure}, {"reflection", rays.reflection.*figure}, {"shadow", rays.shadow.*figure}};
  };
  json["rays_by_kind"] = by_kind(&RayCounts::Kind::traced);
  json["rays_without_weight"] = by_kind(&RayCounts::Kind::weightless);
  json["rays_wasted"] = by_kind(&RayCounts::Kind::futile);
  json["rays_left_out"] = by_kind(&RayCounts::Kind::left_out);
  json["rays_that_end"] = {{"missed", rays.missed()}, {"blocked", rays.blocked()}, {"too_deep", too_deep}};
}

Json by_type(const EnumArray<AluType, uint64_t, kAluTypes>& figures) {
  Json json;
  for (size_t i = 0; i < kAluTypes; ++i) json[std::string(kAluNames[i])] = figures[i];
  return json;
}

Json warp_cycles_json(const ChipResult& chip) {
  const WarpCycles& cycles = chip.warp_cycles;
  return {{"all", cycles.busy + chip.warp_cycles_without_kernel},
          {"without_kernel", chip.warp_cycles_without_kernel},
          {"not_launched", cycles.not_launched},
          {"ended", cycles.ended},
          {"fetch", cycles.fetch},
          {"registers", cycles.registers},
          {"issued", cycles.issued},
          {"import", cycles.imports},
          {"export", cycles.exports},
          {"waiting", by_type(cycles.waiting)},
          {"executing", by_type(cycles.executing)}};
}

Json ceilings_json(const ChipResult& chip) {
  const auto ceiling = [&](std::string_view name) {
    for (const Ceiling& one : chip.ceilings) {
      if (one.name == name) return Json(one.mrays_per_s);
    }
    return Json(nullptr);
  };
  Json json = {{"issue", ceiling("issue")}};
  for (const std::string_view name : kAluNames) json["alus"][std::string(name)] = ceiling(name);
  for (const char* name : {"ray_port", "intersection_port", "frame_port", "memory_port", "traverser", "box_pipes",
                           "triangle_pipes", "rays_in_flight", "latency"}) {
    json[name] = ceiling(name);
  }
  const bool any = !chip.ceilings.empty();
  json["lowest"] = any ? Json(chip.ceilings.front().name) : Json(nullptr);
  json["reached"] = any ? Json(chip.mrays_per_s / chip.ceilings.front().mrays_per_s) : Json(nullptr);
  return json;
}

Json cache_json(const CacheWork& cache) {
  return {{"hits", cache.hits}, {"misses", cache.misses}, {"joined", cache.joined}, {"hit_rate", hit_rate(cache)}};
}

Json pipes_json(const PipeWork& pipes, uint64_t count, uint64_t cycles) {
  return {{"tests", pipes.tests},
          {"utilisation", ratio(pipes.tests, count * cycles)},
          {"waiting", ratio(pipes.waiting, cycles)}};
}

Json traversal_json(const TraverserWork& work, const ChipConfiguration& machine, uint64_t cycles) {
  return {{"nodes_a_ray", ratio(work.boxes.tests, work.rays)},
          {"leaves_a_ray", ratio(work.leaves, work.rays)},
          {"triangles_a_ray", ratio(work.triangles.tests, work.rays)},
          {"bytes_a_ray", ratio(work.bytes(), work.rays)},
          {"rays_in_flight",
           {{"capacity", machine.hardware_traverser_rays},
            {"peak", work.most_rays},
            {"mean", ratio(work.ray_cycles, cycles)}}},
          {"box_pipes", pipes_json(work.boxes, machine.hardware_traverser_lanes, cycles)},
          {"triangle_pipes", pipes_json(work.triangles, machine.hardware_traverser_triangle_pipes, cycles)},
          {"node_cache", cache_json(work.node_cache)},
          {"triangle_cache", cache_json(work.triangle_cache)},
          {"stacks", {{"deepest", work.deepest_stack}, {"spills", work.stack_spills}, {"fills", work.stack_fills}}},
          {"memory", {{"line_reads", work.memory_lines}, {"quadword_writes", work.memory_quadwords}}}};
}

void add_chip(Json& json, const ChipResult& chip, const ChipConfiguration& machine) {
  json["cycles"] = timed(chip, chip.cycles);
  json["rays"] = chip.rays();
  json["mrays_per_second"] = timed(chip, chip.mrays_per_s);
  json["mrays_per_second_thesis"] = timed(chip, chip.thesis_mrays_per_s);
  json["frames_per_second"] = timed(chip, chip.frames_per_s);
  json["time_utilisation"] = timed(chip, chip.time_utilisation);
  json["resource_utilisation"] = chip.resource_utilisation;
  json["instructions"] = chip.instructions;
  json["thread_instructions"] = chip.thread_instructions;
  add_rays(json, chip.ray_counts, chip.dropped_depth);
  json["contributions"] = chip.contributions;
  for (size_t i = 0; i < kRayKernels; ++i) {
    const ChipResult::Kernel& kernel = chip.kernels[i];
    json["kernels"][std::string(kRayKernelNames[i])] = {
        {"launches", kernel.launches}, {"threads", kernel.threads}, {"cycles", timed(chip, kernel.cycles)}};
  }
  for (size_t i = 0; i < kAluTypes; ++i) {
    const ChipResult::Alu& alu = chip.alus[i];
    json["alus"][std::string(kAluNames[i])] = {
        {"utilisation", timed(chip, alu.utilisation)}, {"waiting", timed(chip, alu.waiting)}, {"issued", alu.issued}};
  }
  if (!chip.timed) return;
  json["warp_cycles"] = warp_cycles_json(chip);
  json["ceilings"] = ceilings_json(chip);
  json["caches"]["instruction"] = {{"hits", chip.instruction_cache_hits},
                                   {"misses", chip.instruction_cache_misses},
                                   {"hit_rate", share(chip.instruction_cache_hits, chip.instruction_cache_misses)}};
  json["caches"]["data"] = {{"hits", chip.data_cache_hits},
                            {"misses", chip.data_cache_misses},
                            {"hit_rate", share(chip.data_cache_hits, chip.data_cache_misses)},
                            {"stores", chip.data_cache_stores}};
  json["pools"] = {{"rays", pool_json(chip.rays_pool)},
                   {"normal_intersections", pool_json(chip.normal_pool)},
                   {"shadow_intersections", pool_json(chip.shadow_pool)},
                   {"direct_intersections", pool_json(chip.direct_pool)},
                   {"ray_port_utilisation", chip.ray_port_utilisation},
                   {"intersection_port_utilisation", chip.intersection_port_utilisation}};
  json["memory"] = {{"line_reads", chip.memory_reads},
                    {"quadword_writes", chip.memory_writes},
                    {"port_utilisation", chip.memory_port_utilisation}};
  if (chip.traversal) {
    json["traversal"] = traversal_json(*chip.traversal, machine, chip.cycles);
  } else if (machine.traverser == TraverserName::Static) {
    json["traverser_batches"] = {{"at_kernel_end", chip.traverser_batches},
                                 {"after_stall", chip.traverser_stall_batches}};
  }
}

void add_native(Json& json, const NativeStatistics& native) {
  json["cycles"] = nullptr;
  json["rays"] = native.rays();
  for (const char* key : {"mrays_per_second", "mrays_per_second_thesis", "frames_per_second", "time_utilisation",
                          "resource_utilisation"}) {
    json[key] = nullptr;
  }
  add_rays(json, native.ray_counts, native.dropped_rays);
  json["contributions"] = native.contributions;
  for (size_t i = 0; i < kRayKernels; ++i) {
    json["kernels"][std::string(kRayKernelNames[i])] = {{"threads", native.kernel_threads[i]}};
  }
}

/// `name`: of the object that has the intervals.
void add_estimates(Json& json, const char* name, const Estimates& figures, bool thesis_counts_pixels) {
  const auto interval = [](const Interval& x) { return Json{{"value", x.value}, {"low", x.low}, {"high", x.high}}; };
  const double cycles = figures.cycles.value;
  json["cycles"] = std::llround(cycles);
  json["mrays_per_second"] = figures.mrays_per_s.value;
  const double pixels = json["size"]["width"].get<double>() * json["size"]["height"].get<double>();
  json["mrays_per_second_thesis"] = thesis_counts_pixels ? 2e3 * pixels / cycles : figures.mrays_per_s.value;
  json["frames_per_second"] = 1e9 / cycles;
  Json& estimated = json[name];
  estimated["error"] = figures.error();
  estimated["cycles"] = interval(figures.cycles);
  estimated["mrays_per_second"] = interval(figures.mrays_per_s);
  for (size_t i = 0; i < kAluTypes; ++i) estimated["alus"][std::string(kAluNames[i])] = interval(figures.alus[i]);
  estimated["ports"] = {{"ray_port", interval(figures.ray_port)},
                        {"intersection_port", interval(figures.intersection_port)},
                        {"memory_port", interval(figures.memory_port)}};
}

void add_sampled(Json& json, const sampled::Figures& figures, uint64_t seed, bool thesis_counts_pixels) {
  json["sampled"] = {{"seed", seed},
                     {"whole", figures.whole},
                     {"tiles", figures.tiles},
                     {"counted_tiles", figures.counted_tiles},
                     {"simulated_tiles", figures.simulated_tiles}};
  add_estimates(json, "sampled", figures, thesis_counts_pixels);
}

/// Appends a line to the table.
template <typename... Arguments>
void line(std::string& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
  text += '\n';
}

std::string shaders_text(const RunRecord& record) {
  std::string text = record.shaders;
  if (record.samples > 1) text += fmt::format(", {} samples a pixel, of which these are the sums", record.samples);
  for (const std::string_view name : kRayKernelNames) {
    text += fmt::format("{} {} {}", name == kRayKernelNames[0] ? "; instructions:" : ",", name,
                        extract_kernel(record.kernels->program, std::string(name)).code.size());
  }
  // What has found no register.
  kernel::SpillCounts sum;
  for (const kernel::CompileCounts& counts : record.kernels->counts) {
    sum.to_words = std::max(sum.to_words, counts.spilled.to_words);
    sum.to_memory = std::max(sum.to_memory, counts.spilled.to_memory);
  }
  if (sum.to_words + sum.to_memory > 0)
    text += fmt::format("; spilled: {} values to ray words, {} to memory", sum.to_words, sum.to_memory);
  return text;
}

void kernel_table(std::string& text, const ChipResult& chip) {
  line(text, "  kernel                  launches    threads  a launch");
  for (size_t i = 0; i < kRayKernels; ++i) {
    const ChipResult::Kernel& kernel = chip.kernels[i];
    if (kernel.launches == 0) continue;
    line(text, "    {:<21} {:>8} {:>10} {:>9.1f}", kRayKernelNames[i], kernel.launches, kernel.threads,
         static_cast<double>(kernel.threads) / static_cast<double>(kernel.launches));
  }
}

void ray_table(std::string& text, const RunRecord& record, const RayCounts& rays) {
  line(text, "  rays        {}: {} eye, {} reflection, {} shadow", rays.traced(), rays.eye.traced,
       rays.reflection.traced, rays.shadow.traced);
  if (record.kernels) {
    line(text, "    ended     {} eye, {} reflection in nothing; {} shadow at an obstacle", rays.eye.ended,
         rays.reflection.ended, rays.shadow.ended);
    return;
  }
  line(text, "    wasted    {} eye, {} reflection, {} shadow; of these had no weight: {}, {}, {}", rays.eye.futile,
       rays.reflection.futile, rays.shadow.futile, rays.eye.weightless, rays.reflection.weightless,
       rays.shadow.weightless);
  if (record.depth > 1 && !record.reflections)
    line(text, "    left out  reflections: no material of this scene reflects");
  if (rays.reflection.left_out + rays.shadow.left_out > 0)
    line(text, "    left out  {} reflection, {} shadow: they could not add to the picture", rays.reflection.left_out,
         rays.shadow.left_out);
}

// Where the warps' cycles went, in shares of all.
void warp_table(std::string& text, const ChipResult& chip) {
  const WarpCycles& cycles = chip.warp_cycles;
  const auto all = static_cast<double>(cycles.busy + chip.warp_cycles_without_kernel);
  const auto percent = [&](uint64_t part) {
    return fmt::format("{:.1f}%", all == 0 ? 0 : 100 * static_cast<double>(part) / all);
  };
  // The types that have more than 0.05%
  const auto types = [&](const EnumArray<AluType, uint64_t, kAluTypes>& figures) {
    std::string list;
    for (size_t i = 0; i < kAluTypes; ++i) {
      if (const std::string share = percent(figures[i]); share != "0.0%")
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", kAluNames[i], share);
    }
    return list.empty() ? list : " (" + list + ")";
  };
  line(text, "  warps       fetch {}, registers {}, issued {}, executing {}{}", percent(cycles.fetch),
       percent(cycles.registers), percent(cycles.issued), percent(cycles.executing_sum()), types(cycles.executing));
  line(text, "    waiting   for an ALU {}{}, import {}, export {}", percent(cycles.waiting_sum()),
       types(cycles.waiting), percent(cycles.imports), percent(cycles.exports));
  line(text, "    empty     ended {}, not launched {}, without a kernel {}", percent(cycles.ended),
       percent(cycles.not_launched), percent(chip.warp_cycles_without_kernel));
}

// The lowest ceilings, and how far it is to the first.
void ceiling_line(std::string& text, const ChipResult& chip) {
  constexpr size_t kShown = 5;
  if (chip.ceilings.empty()) return;
  const Ceiling& lowest = chip.ceilings.front();
  std::string others;
  for (size_t i = 1; i < std::min(kShown, chip.ceilings.size()); ++i)
    others += fmt::format("{} {} {:.1f}", i == 1 ? ";" : ",", chip.ceilings[i].name, chip.ceilings[i].mrays_per_s);
  line(text, "  ceilings    {} {:.1f} Mrays/s, of which {:.1f}% is reached{}", lowest.name, lowest.mrays_per_s,
       100 * chip.mrays_per_s / lowest.mrays_per_s, others);
}

void traversal_table(std::string& text, const TraverserWork& work, uint64_t cycles, const ChipConfiguration& machine) {
  const auto busy = [&](const PipeWork& pipes, uint64_t count) { return 100 * ratio(pipes.tests, count * cycles); };
  line(text,
       "  traverser   {:.1f} nodes, {:.1f} triangles and {:.1f} bytes a ray; {:.0f} of {} rays in flight (peak {})",
       ratio(work.boxes.tests, work.rays), ratio(work.triangles.tests, work.rays), ratio(work.bytes(), work.rays),
       ratio(work.ray_cycles, cycles), machine.hardware_traverser_rays, work.most_rays);
  line(text,
       "    pipes     boxes {:.1f}%, triangles {:.1f}% busy; stacks up to {} deep, {} blocks of them to the memory",
       busy(work.boxes, machine.hardware_traverser_lanes),
       busy(work.triangles, machine.hardware_traverser_triangle_pipes), work.deepest_stack, work.stack_spills);
  line(text, "    caches    nodes {:.1f}% hits, triangles {:.1f}% hits", 100 * hit_rate(work.node_cache),
       100 * hit_rate(work.triangle_cache));
}

void chip_table(std::string& text, const ChipResult& chip, const ChipConfiguration& machine) {
  if (!chip.timed) {
    kernel_table(text, chip);
    line(text, "  work        {} warp instructions, {} thread instructions", chip.instructions,
         chip.thread_instructions);
    return;
  }
  line(text, "  speed       {:.2f} Mrays/s, {:.2f} frames/s ({} cycles at 1 GHz); as the thesis counts, {:.2f} Mrays/s",
       chip.mrays_per_s, chip.frames_per_s, chip.cycles, chip.thesis_mrays_per_s);
  line(text, "  utilisation time {:.1f}%, resources {:.1f}%", 100 * chip.time_utilisation,
       100 * chip.resource_utilisation);
  kernel_table(text, chip);
  line(text, "  ALU   utilisation  waiting      tasks");
  for (size_t i = 0; i < kAluTypes; ++i) {
    const ChipResult::Alu& alu = chip.alus[i];
    line(text, "    {} {:>11.1f}% {:>8.2f} {:>10}", kAluNames[i], 100 * alu.utilisation, alu.waiting, alu.issued);
  }
  warp_table(text, chip);
  ceiling_line(text, chip);
  line(text, "  work        {} warp instructions, {} thread instructions", chip.instructions, chip.thread_instructions);
  line(text, "  caches      instructions {:.2f}% hits of {}, data {:.2f}% hits of {}",
       100 * share(chip.instruction_cache_hits, chip.instruction_cache_misses),
       chip.instruction_cache_hits + chip.instruction_cache_misses,
       100 * share(chip.data_cache_hits, chip.data_cache_misses), chip.data_cache_hits + chip.data_cache_misses);
  line(text,
       "  pools       rays {:.0f} of {} (peak {}), intersections {:.0f} normal (peak {}), {:.0f} shadow (peak {})",
       chip.rays_pool.mean, chip.rays_pool.capacity, chip.rays_pool.peak, chip.normal_pool.mean, chip.normal_pool.peak,
       chip.shadow_pool.mean, chip.shadow_pool.peak);
  if (chip.traversal) traversal_table(text, *chip.traversal, chip.cycles, machine);
  line(text, "  ports       rays {:.1f}%, intersections {:.1f}%, memory {:.1f}% busy", 100 * chip.ray_port_utilisation,
       100 * chip.intersection_port_utilisation, 100 * chip.memory_port_utilisation);
}

void estimates_table(std::string& text, const Estimates& figures) {
  const Interval &cycles = figures.cycles, &speed = figures.mrays_per_s;
  line(text, "  speed       {:.2f} Mrays/s ({:.2f} .. {:.2f}), {:.0f} cycles ({:.0f} .. {:.0f}, +-{:.1f}%)",
       speed.value, speed.low, speed.high, cycles.value, cycles.low, cycles.high, 100 * figures.error());
  const auto percent = [](const Interval& x) {
    return fmt::format("{:>6.1f}% ({:.1f} .. {:.1f})", 100 * x.value, 100 * x.low, 100 * x.high);
  };
  line(text, "  ALU    utilisation");
  for (size_t i = 0; i < kAluTypes; ++i) line(text, "    {} {}", kAluNames[i], percent(figures.alus[i]));
  line(text, "  ports  rays {}, intersections {}, memory {} busy", percent(figures.ray_port),
       percent(figures.intersection_port), percent(figures.memory_port));
}

void sampled_table(std::string& text, const RunRecord& record) {
  const sampled::Figures& figures = *record.sampled;
  if (figures.whole) {
    line(text, "  sample      all of the {} tiles: the figures are exact", figures.tiles);
  } else {
    line(text, "  sample      {} of {} tiles ({:.1f}%), {} more around them, seed {}; in brackets 95% intervals",
         figures.counted_tiles, figures.tiles, 100.0 * figures.counted_tiles / figures.tiles,
         figures.simulated_tiles - figures.counted_tiles, record.seed);
  }
  estimates_table(text, figures);
}

}  // namespace

std::string to_json(const RunRecord& record) {
  Json json;
  json["raypool"] = kVersion;
  json["command"] = record.command;
  json["config"] = record.configuration.name;
  const Json configuration = Json::parse(to_json(record.configuration));
  json["configuration"] = configuration;
  json["engine"] = record.engine;
  if (!record.engine_choice.empty()) json["engine_choice"] = record.engine_choice;
  if (!record.boundary.empty()) json["boundary"] = record.boundary;
  if (!record.hits.empty()) json["hits"] = record.hits;
  if (!record.precision.empty()) json["precision"] = record.precision;
  if (record.kernels) json["shaders"] = shaders_json(record);
  json["scene"] = {{"name", record.scene}, {"triangles", record.triangles}, {"materials", record.materials}};
  const Vec3d& centre = record.view.centre;
  if (!(centre == Vec3d{})) json["scene"]["centre"] = {centre.x, centre.y, centre.z};
  json["view"] = Json::parse(to_json(record.view));
  json["size"] = {{"width", record.width}, {"height", record.height}};
  json["depth"] = record.depth;
  json["reflections"] = record.reflections;
  json["units"] = record.units;
  json["traverser"] = configuration["chip"]["traverser"];
  if (record.chip) add_chip(json, *record.chip, record.configuration.chip);
  if (record.native) add_native(json, *record.native);
  if (record.unstable) json["unstable"] = {{"frames", record.unstable->frames}, {"pixels", record.unstable->pixels}};
  if (record.estimated) add_estimates(json, "estimated", *record.estimated, record.depth == 1);
  if (record.sampled) add_sampled(json, *record.sampled, record.seed, record.depth == 1);
  if (record.lockstep) json["lockstep"] = lockstep_json(*record.lockstep);
  if (record.chip_lockstep) json["lockstep"] = lockstep_json(*record.chip_lockstep);
  json["wall_seconds"] = record.wall_seconds;
  json["simulation_seconds"] = record.simulation_seconds;
  if (record.chip && record.chip->timed) {
    json["simulated_per_second"] = {
        {"cycles", rate(record.chip->cycles, record.simulation_seconds)},
        {"thread_instructions", rate(record.chip->thread_instructions, record.simulation_seconds)}};
  }
  return to_text(json, 2) + "\n";
}

std::string to_table(const RunRecord& record) {
  std::string text;
  line(text, "{}, {} triangles, {}x{}, depth {}: {} on {}, {} compute unit{}", record.scene, record.triangles,
       record.width, record.height, record.depth, record.engine, record.configuration.name, record.units,
       record.units == 1 ? "" : "s");
  if (record.kernels) line(text, "  shaders     {}", shaders_text(record));
  if (record.chip) {
    ray_table(text, record, record.chip->ray_counts);
    chip_table(text, *record.chip, record.configuration.chip);
  }
  if (record.native) ray_table(text, record, record.native->ray_counts);
  if (record.estimated) {
    line(text, "  estimate    without simulation; in brackets 95% intervals");
    estimates_table(text, *record.estimated);
  }
  if (record.sampled) sampled_table(text, record);
  if (record.lockstep) line(text, "  {}", to_string(*record.lockstep));
  if (record.chip_lockstep) line(text, "  {}", to_string(*record.chip_lockstep));
  std::string simulated;
  if (record.chip && record.chip->timed) {
    simulated = fmt::format(", {:.0f} kcycles/s and {:.0f} thousand thread instructions/s",
                            rate(record.chip->cycles, record.simulation_seconds) / 1e3,
                            rate(record.chip->thread_instructions, record.simulation_seconds) / 1e3);
  }
  line(text, "  wall time   {:.1f} s, of which drawing {:.1f} s{}", record.wall_seconds, record.simulation_seconds,
       simulated);
  return text;
}

}  // namespace raypool
