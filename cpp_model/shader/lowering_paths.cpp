// Kernels of shaders that wait for their rays: what a ray takes along and brings back, what the path's record holds,
// and which shaders run for a ray that has come back.
#include <fmt/format.h>

#include <algorithm>

#include "kernel/compiler.hpp"
#include "shader/lowering.hpp"

namespace raypool::shader {
namespace {

constexpr uint32_t kPayloadInRay = 3;
// Bits 23:8 of a ray's flags word.
constexpr uint32_t kSiteShift = 8, kSiteMask = 0xff;
constexpr uint32_t kMissShift = 16, kHitShift = 20, kIndexMask = 7;
constexpr uint32_t kAsksAnyHit = 1u << 19, kNoClosestHit = 1u << 23;

uint32_t flags_of(const Module& module, const TraceSite& site) {
  return module.constant(site.line->operands.at(1)).value_or(0);
}

template <typename Visit>
void for_each_site(const WaitingShaders& shaders, const Visit& visit) {
  const auto look = [&](const WaitingShader& shader) {
    for (const TraceSite& site : shader.waits.sites) visit(shader.module, site);
  };
  look(shaders.ray_generation);
  for (const ClosestHitShader& hit : shaders.closest_hits) look(hit.shader);
}

/// Whether rays may go on behind hits that do not count.
bool ignores_hits(const WaitingShaders& shaders) {
  bool ignores = !shaders.any_hits.empty();
  for_each_site(shaders, [&](const Module& module, const TraceSite& site) {
    ignores |= (flags_of(module, site) & (ray_flag::kCullsBack | ray_flag::kCullsFront)) != 0;
  });
  return ignores;
}

/// Whether a path's record must hold where along its ray the trace began; otherwise that is a constant of each trace.
bool records_begin(const WaitingShaders& shaders) {
  bool records = ignores_hits(shaders);
  for_each_site(shaders, [&](const Module& module, const TraceSite& site) {
    records |= !module.constant(site.line->operands.at(7));
  });
  return records;
}

uint32_t most_payload(const WaitingShaders& shaders) {
  uint32_t most = 0;
  for_each_site(shaders, [&](const Module& module, const TraceSite& site) {
    most = std::max(most, module.scalars(payload_type(module, *site.line)));
  });
  return most;
}

uint32_t payload_words(const WaitingShaders& shaders) {
  const uint32_t most = most_payload(shaders);
  return most - std::min(most, kPayloadInRay);
}

bool has_incoming_payload(const Module& module) {
  return std::any_of(module.variables().begin(), module.variables().end(),
                     [](const auto& one) { return one.second.storage == spv::StorageClass::IncomingRayPayloadKHR; });
}

/// Beside what is held, the site that has called the closest-hit shader, and a payload that it does not look at.
uint32_t words_of_hit(const WaitingShaders& shaders, const WaitingShader& shader) {
  if (shader.waits.sites.empty()) return 0;
  const uint32_t passed = has_incoming_payload(shader.module) ? 0 : most_payload(shaders);
  return most_held_words(shader.module, shader.waits) + 1 + passed;
}

/// Words that a closest-hit shader that waits takes.
uint32_t words_of_level(const WaitingShaders& shaders) {
  uint32_t most = 0;
  for (const ClosestHitShader& hit : shaders.closest_hits) most = std::max(most, words_of_hit(shaders, hit.shader));
  return most;
}

std::vector<uint32_t> groups_without_closest_hit(const WaitingShaders& shaders) {
  std::vector<uint32_t> without;
  for (uint32_t group = 0; group < shaders.groups; ++group) {
    const auto has_it = [&](const ClosestHitShader& one) {
      return std::find(one.groups.begin(), one.groups.end(), group) != one.groups.end();
    };
    if (std::none_of(shaders.closest_hits.begin(), shaders.closest_hits.end(), has_it)) without.push_back(group);
  }
  return without;
}

/// Whether closest-hit shaders may wait for each other.
bool nests(const WaitingShaders& shaders) {
  const std::vector<uint32_t> without = groups_without_closest_hit(shaders);
  for (const ClosestHitShader& hit : shaders.closest_hits) {
    for (const TraceSite& site : hit.shader.waits.sites) {
      if ((flags_of(hit.shader.module, site) & ray_flag::kSkipsClosestHit) != 0) continue;
      const auto group = hit.shader.module.constant(site.line->operands.at(3));
      if (!group || std::find(without.begin(), without.end(), *group) == without.end()) return true;
    }
  }
  return false;
}

// Words of a path's record: those of the payload, how far along the ray has begun, how many closest-hit shaders wait if
// they may wait for each other, what the ray generation shader holds, and what each closest-hit shader that waits
// holds.
uint32_t begin_word(const WaitingShaders& shaders) { return payload_words(shaders); }
uint32_t level_word(const WaitingShaders& shaders) { return payload_words(shaders) + (records_begin(shaders) ? 1 : 0); }
uint32_t first_held_word(const WaitingShaders& shaders) { return level_word(shaders) + (nests(shaders) ? 1 : 0); }

/// Words of the ray that hold scalars 3 .. 9 of what a shader gives back, in place of its origin and direction.
bool goes_back_in_word(uint32_t scalar) { return scalar < kPayloadInRay + word::kPixel; }
int word_back(uint32_t scalar) {
  return static_cast<int>(scalar < kPayloadInRay ? word::kColor + scalar : scalar - kPayloadInRay);
}

/// A shader of the set stores to a buffer.
bool writes_memory(const WaitingShaders& shaders) {
  const auto writes = [](const auto& shader) { return writes_memory(shader.module); };
  return writes(shaders.ray_generation) || std::any_of(shaders.misses.begin(), shaders.misses.end(), writes) ||
         std::any_of(shaders.closest_hits.begin(), shaders.closest_hits.end(),
                     [&](const ClosestHitShader& hit) { return writes(hit.shader); }) ||
         std::any_of(shaders.any_hits.begin(), shaders.any_hits.end(), writes) ||
         std::any_of(shaders.callables.begin(), shaders.callables.end(),
                     [](const Module* module) { return module != nullptr && writes_memory(*module); });
}

}  // namespace

uint32_t path_words(const WaitingShaders& shaders, uint32_t levels) {
  const WaitingShader& first = shaders.ray_generation;
  const uint32_t before = first_held_word(shaders) + most_held_words(first.module, first.waits);
  return before + words_of_level(shaders) * (nests(shaders) ? levels : 1);
}

kernel::Function lower_waiting(const WaitingShaders& shaders, const Resources& resources, RayKernel kernel,
                               const KernelTarget& target, const RecordLayout& layout) {
  Recording recording(kernel, target, layout, &shaders.callables);
  const bool comes_back = kernel != RayKernel::CastEye;
  const WaitingShader& first = shaders.ray_generation;
  Lowering begin(first.module, resources, RayKernel::CastEye, recording);
  recording.path.emplace(Path{shaders, comes_back, {}, 0, {}, {}, {}, {}, {}, false, {}});
  recording.path->shares_buffers = resources.units > 1 && writes_memory(shaders);
  const Scalar inside = begin.begin_paths();
  const uint32_t of_begin = first_held_word(shaders);
  const uint32_t of_hits = of_begin + most_held_words(first.module, first.waits);
  if (comes_back) {
    if (ignores_hits(shaders)) {
      begin.ignore_sides();
      for (const AnyHitShader& shader : shaders.any_hits)
        Lowering(shader.module, resources, RayKernel::CastSecondary, recording).run_any_hit(shader);
      begin.pass_on();
    }
    begin.give_back_unread();
    begin.begin_calls();
    for (uint32_t i = 0; i < shaders.misses.size(); ++i) {
      Lowering miss(shaders.misses[i].module, resources, RayKernel::Shade, recording);
      miss.run_waiting(shaders.misses[i].waits, miss.goes_to_miss(i), of_hits);
    }
    for (const auto& [shader, groups] : shaders.closest_hits) {
      Lowering hit(shader.module, resources, RayKernel::CastSecondary, recording);
      hit.run_waiting(shader.waits, hit.called_by_hit(groups), of_hits);
    }
    begin.end_calls();
  }
  begin.run_waiting(first.waits, inside, of_begin);
  return begin.end_paths();
}

// ---- What a kernel of paths begins and ends with

/// The lanes that begin a path.
Scalar Lowering::begin_paths() {
  Scalar inside;
  place_saved();
  if (path_->comes_back) {
    inside = Scalar::in_predicate(recorder_.declare_predicate());
    k_.ray_in();
    pixel_ = of(k_.int_word(word::kPixel));
    flags_ = of(k_.int_word(word::kFlags));
  } else {
    inside = place_pixel();
  }
  const Scalar row = scaled(immediate(Opcode::Shr, *pixel_, 16), static_cast<uint32_t>(resources_.path_pitch()));
  const Scalar place = binary(Opcode::Iadd, row, immediate(Opcode::And, *pixel_, 0xffff));
  path_->record = scaled(place, static_cast<uint32_t>(resources_.path_bytes()));
  if (path_->comes_back && resources_.units > 1) forget_record();
  path_->sends = recorder_.declare_predicate();
  declare_stored(path_->shaders.ray_generation.module);
  if (!path_->comes_back) return inside;
  for (const WaitingShader& shader : path_->shaders.misses) declare_stored(shader.module);
  for (const ClosestHitShader& hit : path_->shaders.closest_hits) declare_stored(hit.shader.module);
  for (const AnyHitShader& shader : path_->shaders.any_hits) declare_stored(shader.module);
  path_->site = copy(immediate(Opcode::And, immediate(Opcode::Shr, *flags_, kSiteShift), kSiteMask));
  if (nests(path_->shaders)) path_->level = copy(record_word(level_word(path_->shaders)));
  return inside;
}

/// Where closest-hit shaders wait for each other, one that has ended may go back to one that has been recorded before
/// it: all of them are in a loop, as long as there are such.
void Lowering::begin_calls() {
  if (!path_->level) return;
  path_->fresh = recorder_.declare_predicate();
  recorder_.join(*path_->fresh);
  // No lane goes on yet behind the trace that has called.
  path_->caller = copy(path_->site);
  Scalar calls = Scalar::constant(0);
  for (uint32_t i = 0; i < path_->shaders.misses.size(); ++i) calls = either(calls, goes_to_miss(i));
  for (const ClosestHitShader& hit : path_->shaders.closest_hits) calls = either(calls, called_by_hit(hit.groups));
  under(calls, [&] { assign(path_->site, Scalar::constant(0)); });
  const int again = recorder_.declare_predicate();
  recorder_.join(again);
  recorder_.begin_loop(again, where_);
}

void Lowering::end_calls() {
  if (!path_->level) return;
  Scalar goes_on = Scalar::constant(0);
  for (const ClosestHitShader& hit : path_->shaders.closest_hits)
    for (const TraceSite& site : hit.shader.waits.sites)
      goes_on = either(goes_on, compare(Opcode::Ieq, path_->site, Scalar::constant(site.number)));
  recorder_.assign_predicate(*path_->fresh, predicate(Scalar::constant(0)), false);
  recorder_.end_loop(predicate(copy(goes_on)), false);
}

/// Places for what the shader stores, which shaders of its stage share.
void Lowering::declare_stored(const Module& shader) {
  std::vector<Stored>& all = path_->stored[shader.stage()];
  std::set<uint32_t> unseen;
  size_t stores = 0;
  for (const Block& block : shader.blocks()) {
    for (const Line& line : block.lines) {
      if (line.op == spv::Op::OpLoad) {
        const Decorations& of = shader.decorations(line.operands.at(0));
        if (of.binding && resources_.unseen.count({of.set.value_or(0), *of.binding}) != 0) unseen.insert(line.id);
      }
      stores += line.op == spv::Op::OpImageWrite && unseen.count(line.operands.at(0)) == 0 ? 1 : 0;
    }
  }
  while (all.size() < stores) {
    all.push_back({recorder_.declare_predicate(), {}});
    for (Scalar& scalar : all.back().values) scalar = declare(false);
  }
}

/// Rays with this bit of the flags word.
Scalar Lowering::has_flag(uint32_t flag) {
  return compare(Opcode::Ine, immediate(Opcode::And, *flags_, flag), Scalar::constant(0));
}

/// Rays that were sent to the miss shader of this index, and have met nothing.
Scalar Lowering::goes_to_miss(uint32_t index) {
  Scalar missed = inverse(has_flag(kMetFlag));
  if (path_->fresh) missed = both(missed, Scalar::in_predicate(*path_->fresh));
  if (path_->shaders.misses.size() == 1) return missed;
  const Scalar its = immediate(Opcode::And, immediate(Opcode::Shr, *flags_, kMissShift), kIndexMask);
  return both(compare(Opcode::Ieq, its, Scalar::constant(index)), missed);
}

/// Rays that have met something of one of these hit groups: as Vulkan counts, that of the trace, and as many further as
/// the geometry's number times the trace's stride.
Scalar Lowering::goes_to_groups(const std::vector<uint32_t>& groups) {
  const Scalar met = has_flag(kMetFlag);
  if (groups.size() == path_->shaders.groups) return met;
  Scalar its = immediate(Opcode::And, immediate(Opcode::Shr, *flags_, kHitShift), kIndexMask);
  const Scalar stride = of_site([](const Module& module, const TraceSite& site) {
    return module.constant(site.line->operands.at(4)).value_or(0);
  });
  const Scalar number = geometry();
  if (!(number == Scalar::constant(0)) && !(stride == Scalar::constant(0)))
    its = binary(Opcode::Iadd, its, binary(Opcode::Imul, stride, number));
  Scalar any = Scalar::constant(0);
  for (const uint32_t group : groups) any = either(any, compare(Opcode::Ieq, its, Scalar::constant(group)));
  return both(any, met);
}

Scalar Lowering::called_by_hit(const std::vector<uint32_t>& groups) {
  Scalar called = both(goes_to_groups(groups), inverse(has_flag(kNoClosestHit)));
  if (path_->fresh) called = both(called, Scalar::in_predicate(*path_->fresh));
  return path_->ignored ? both(called, Scalar::in_predicate(*path_->ignored, true)) : called;
}

// ---- Hits that do not count

void Lowering::ignore_sides() {
  path_->ignored = recorder_.declare_predicate();
  const auto ignore = [&](uint32_t flag, bool backs) {
    Scalar asks = Scalar::constant(0);
    for_each_site(path_->shaders, [&](const Module& module, const TraceSite& site) {
      if ((flags_of(module, site) & flag) != 0)
        asks = either(asks, compare(Opcode::Ieq, path_->site, Scalar::constant(site.number)));
    });
    if (asks.is_constant()) return;
    under(both(asks, has_flag(kMetFlag)), [&] {
      const Scalar back =
          compare(Opcode::Fgt, dot(ray_words(word::kDirection), ray_words(word::kNormal)), Scalar::constant(0));
      under(backs ? back : inverse(back), [&] { recorder_.join(*path_->ignored); });
    });
  };
  ignore(ray_flag::kCullsBack, true);
  ignore(ray_flag::kCullsFront, false);
}

void Lowering::run_any_hit(const AnyHitShader& shader) {
  const Scalar its = goes_to_groups(shader.groups);
  const Scalar asks = has_flag(kAsksAnyHit);
  const Scalar counts = Scalar::in_predicate(*path_->ignored, true);
  const Waits none;
  waits_ = &none;
  constants();
  begin_variables();
  under(both(both(its, asks), counts), [&] {
    reach_[kIgnored] = *path_->ignored;
    region(module_.blocks().front().label, kEnd);
    // Where the next shader, or the ray that goes on, finds it.
    for_each_payload([&](uint32_t id, uint32_t number, const Scalar& scalar) {
      if (written_.count(id) != 0) put_passed(number, scalar);
    });
  });
  waits_ = nullptr;
}

/// A ray goes on from behind its hit, off the triangle as far as the built-in kernels move rays that leave it.
void Lowering::pass_on() {
  under(Scalar::in_predicate(*path_->ignored), [&] {
    const Value origin = ray_words(word::kOrigin), direction = ray_words(word::kDirection);
    const Value normal = ray_words(word::kNormal);
    const Scalar t = of(k_.int_word(word::kDistance)), limit = of(k_.int_word(word::kLimit));
    Value hit(3);
    for (size_t i = 0; i < 3; ++i) hit[i] = multiply_add(t, direction[i], origin[i]);
    const auto size = [&](const Scalar& a) { return immediate(Opcode::And, a, 0x7fffffffu); };
    const Scalar largest = binary(Opcode::Fmax, binary(Opcode::Fmax, size(hit[0]), size(hit[1])), size(hit[2]));
    const Scalar offset =
        binary(Opcode::Fmul, binary(Opcode::Fadd, largest, t), of(k_.int_argument(argument::kOffset)));
    const Scalar back = compare(Opcode::Fgt, dot(direction, normal), Scalar::constant(0));
    const Scalar side = select(back, offset, negate(offset));
    if (records_begin(path_->shaders)) {
      const uint32_t word = begin_word(path_->shaders);
      put_record_word(word, binary(Opcode::Fadd, record_word(word), t));
    }
    for (size_t i = 0; i < 3; ++i) put_word(word::kOrigin + static_cast<int>(i), multiply_add(side, normal[i], hit[i]));
    put_word(word::kLimit, binary(Opcode::Fsub, limit, t));
    recorder_.join(path_->sends);
    assign(path_->site, Scalar::constant(0));
  });
}

Value Lowering::ray_words(int first) {
  Value value;
  for (int i = 0; i < 3; ++i) value.push_back(of(k_.int_word(first + i)));
  return value;
}

/// What a ray takes along of a payload, in its words and in the path's record.
void Lowering::put_passed(uint32_t number, const Scalar& scalar) {
  if (number < kPayloadInRay)
    put_word(word::kColor + static_cast<int>(number), scalar);
  else
    put_record_word(number - kPayloadInRay, scalar);
}

/// An older thread of the path may have brought these words, from the first byte to the last, into this unit's cache.
void Lowering::forget(const Scalar& base, uint32_t first, uint32_t last) {
  for (uint32_t byte = first; byte < last; byte += kLineBytes)
    k_.invalidate(as_int(base), static_cast<int>(byte), where_);
  k_.invalidate(as_int(base), static_cast<int>(last), where_);
}

/// The same of its record, which begins with a line.
void Lowering::forget_record() {
  for (uint64_t byte = 0; byte < resources_.path_bytes(); byte += kLineBytes)
    k_.invalidate(as_int(path_->record), static_cast<int>(resources_.saved + byte), where_);
}

kernel::Function Lowering::end_paths() {
  under(Scalar::in_predicate(path_->sends), [&] {
    if (resources_.units > 1 && resources_.path_words != 0)
      k_.wait_for_stores(as_int(path_->record), static_cast<int>(resources_.saved), where_);
    k_.ray_out();
  });
  for (const auto& [stage, all] : path_->stored) {
    for (const Stored& one : all) {
      under(Scalar::in_predicate(one.lanes), [&] {
        put_word(word::kPixel, one.values[0]);
        for (size_t i = 0; i < 3; ++i) put_word(word::kColor + static_cast<int>(i), one.values[i + 1]);
        k_.frame_out();
      });
    }
  }
  kernel::Function function = finished();
  kernel::remove_unreached(function);
  return function;
}

/// What is stored leaves at the kernel's end, as rays do: the words of one that waits to leave stay where they are.
void Lowering::store_later(const Value& place, const Value& colour) {
  const bool own = place.at(0).part == Scalar::Part::PixelX && place.at(1).part == Scalar::Part::PixelY;
  Scalar inside = Scalar::constant(1), pixel = *pixel_;
  if (!own) {
    inside = both(compare(Opcode::Ult, place[0], Scalar::constant(resources_.width)),
                  compare(Opcode::Ult, place[1], Scalar::constant(resources_.height)));
    pixel = binary(Opcode::Or, place[0], immediate(Opcode::Shl, place[1], 16));
  }
  const auto stored = path_->stored.find(module_.stage());
  if (stored == path_->stored.end()) fail("a callable shader writes to the picture: give the colour to its caller");
  if (path_->level && module_.stage() == spv::ExecutionModel::ClosestHitKHR) {
    fail(
        "imageStore is called in a closest-hit shader, and such shaders wait for each other: give the colour back in "
        "the payload, and store in the ray generation shader");
  }
  std::vector<Stored>& all = stored->second;
  // Each adds to the picture on its own: what is below zero adds nothing.
  Stored& its = all.at(stores_++);
  under(inside, [&] {
    assign(its.values[0], pixel);
    for (size_t i = 0; i < 3; ++i) assign(its.values[i + 1], colour.at(i));
    recorder_.join(its.lanes);
  });
}

/// A value as words hold it: a condition is 0 or not.
Scalar Lowering::from_word(const Scalar& word, bool is_condition) {
  return is_condition ? compare(Opcode::Ine, word, Scalar::constant(0)) : word;
}

Scalar Lowering::word_at(const Scalar& place, uint32_t number) {
  const uint32_t offset = resources_.saved + 4 * number;
  return of(k_.load_int(as_int(place), static_cast<int>(offset)));
}

void Lowering::put_word_at(const Scalar& place, uint32_t number, const Scalar& value) {
  if (value.is_undefined()) return;
  const uint32_t offset = resources_.saved + 4 * number;
  k_.store(as_int(place), static_cast<int>(offset), as_int(value));
}

Scalar Lowering::record_word(uint32_t number) { return word_at(path_->record, number); }
void Lowering::put_record_word(uint32_t number, const Scalar& value) { put_word_at(path_->record, number, value); }

/// Of a closest-hit shader, of which several of a path may wait.
bool Lowering::waits_on_a_level() const { return path_->level && kernel_ == RayKernel::CastSecondary; }

/// Where the shader's held words are counted from.
Scalar Lowering::place_held() {
  if (!waits_on_a_level()) return path_->record;
  return binary(Opcode::Iadd, path_->record, scaled(*path_->level, 4 * words_of_level(path_->shaders)));
}

Scalar Lowering::payload_scalar(uint32_t number) {
  if (number < kPayloadInRay) return of(k_.int_word(word::kColor + static_cast<int>(number)));
  return record_word(number - kPayloadInRay);
}

/// A variable that begins with what the ray has brought.
void Lowering::take_payload(uint32_t id, uint32_t type) {
  Value value;
  for (uint32_t i = 0; i < module_.scalars(type); ++i) {
    value.push_back(from_word(payload_scalar(i), is_condition(type, i)));
  }
  keep(id, type, value);
}

template <typename Put>
void Lowering::for_each_payload(const Put& put) {
  for (const auto& [id, variable] : module_.variables()) {
    if (variable.storage != spv::StorageClass::IncomingRayPayloadKHR) continue;
    const Value& value = this->variable(id);
    for (uint32_t i = 0; i < value.size(); ++i)
      if (!value[i].is_undefined()) put(id, i, Scalar::in_register(reg(value[i])));
  }
}

void Lowering::put_back(uint32_t number, const Scalar& scalar) {
  if (goes_back_in_word(number))
    put_word(word_back(number), scalar);
  else
    put_record_word(number - kPayloadInRay, scalar);
}

/// What variables of payloads hold goes back to the caller.
void Lowering::give_payload() {
  for_each_payload([&](uint32_t /*id*/, uint32_t number, const Scalar& scalar) { put_back(number, scalar); });
}

/// A payload that no shader is given goes back as it is.
void Lowering::give_back_unread() {
  const uint32_t most = most_payload(path_->shaders);
  if (most <= kPayloadInRay) return;
  const Scalar hit = has_flag(kMetFlag);
  Scalar unread = both(hit, has_flag(kNoClosestHit));
  const std::vector<uint32_t> empty = groups_without_closest_hit(path_->shaders);
  if (!empty.empty()) unread = either(unread, goes_to_groups(empty));
  if (path_->shaders.misses.empty()) unread = either(unread, inverse(hit));
  if (path_->ignored) unread = both(unread, Scalar::in_predicate(*path_->ignored, true));
  under(unread, [&] {
    for (uint32_t i = kPayloadInRay; i < most; ++i)
      if (goes_back_in_word(i)) put_back(i, payload_scalar(i));
  });
}

template <typename Of>
Scalar Lowering::of_site(const Of& of) {
  Scalar all;
  const Scalar caller = path_->caller.value_or(path_->site);
  for_each_site(path_->shaders, [&](const Module& module, const TraceSite& site) {
    const Scalar its = Scalar::constant(of(module, site));
    all = all.is_undefined() || all == its
              ? its
              : select(compare(Opcode::Ieq, caller, Scalar::constant(site.number)), its, all);
  });
  return all;
}

Scalar Lowering::flags_of_trace() {
  return of_site([](const Module& module, const TraceSite& site) { return flags_of(module, site); });
}

/// gl_RayTminEXT.
Scalar Lowering::least_distance() {
  if (records_begin(path_->shaders) && !ignores_hits(path_->shaders)) return record_word(begin_word(path_->shaders));
  return of_site([](const Module& module, const TraceSite& site) {
    return module.constant(site.line->operands.at(7)).value_or(0);
  });
}

/// How far along the ray of the shader its ray of the machine has begun.
Scalar Lowering::began() {
  return records_begin(path_->shaders) ? record_word(begin_word(path_->shaders)) : least_distance();
}

Scalar Lowering::plus(const Scalar& a, const Scalar& b) {
  return b == Scalar::constant(0) ? a : binary(Opcode::Fadd, a, b);
}

Value Lowering::ray_origin() {
  Value origin = ray_words(word::kOrigin);
  const Scalar began = path_ ? this->began() : Scalar::constant(0);
  if (began == Scalar::constant(0)) return origin;
  const Value direction = ray_words(word::kDirection);
  for (size_t i = 0; i < 3; ++i) origin[i] = multiply_add(negate(began), direction[i], origin[i]);
  return origin;
}

// ---- One shader of the kernel

void Lowering::declare_held() {
  for (const uint32_t id : waits_->values) {
    Value& variable = kept_[id];
    const uint32_t type = type_of(id), size = module_.scalars(type);
    for (uint32_t i = 0; i < std::max(1u, size); ++i) variable.push_back(declare(size != 0 && is_condition(type, i)));
  }
  written_.insert(waits_->variables.begin(), waits_->variables.end());
  for (const TraceSite& site : waits_->sites) written_.insert(payload_of(*site.line));
}

void Lowering::run_waiting(const Waits& waits, const Scalar& starts, uint32_t first_word) {
  waits_ = &waits;
  first_word_ = first_word;
  constants();
  const bool is_called = kernel_ != RayKernel::CastEye;
  if (is_called && (path_->caller || !waits.sites.empty())) return_ = copy(path_->caller.value_or(path_->site));
  if (is_called && !has_incoming_payload(module_))
    for (uint32_t i = 0; i < most_payload(path_->shaders); ++i) passed_.push_back(copy(payload_scalar(i)));
  declare_held();
  begin_variables();
  for (const Line* line : waits.steady) operation(*line);
  const uint32_t entry = module_.blocks().front().label;
  reach_[kEnd] = recorder_.declare_predicate();
  alive_ = starts;
  waiting_region(entry, kEnd);
  if (!is_called) return;
  under(Scalar::in_predicate(reach_.at(kEnd)), [&] {
    give_payload();
    for (uint32_t i = 0; i < passed_.size(); ++i) put_back(i, passed_[i]);
    if (return_) assign(path_->site, *return_);
  });
}

/// Calls visit(variable, word of the record) for each scalar that is held across the site.
template <typename Visit>
void Lowering::for_each_held(const TraceSite& site, const Visit& visit) {
  uint32_t word = first_word_;
  if (return_) visit(*return_, word++);
  for (Scalar& scalar : passed_) visit(scalar, word++);
  for (const uint32_t id : site.held) {
    const bool is_value = waits_->values.count(id) != 0;
    Value& held = is_value ? kept_.at(id) : variables_.at(id);
    for (Scalar& scalar : held) visit(scalar, word++);
  }
}

/// Products that wait for an addition behind a trace are computed before it.
void Lowering::flush_products() {
  while (!products_.empty()) get(products_.begin()->first);
}

/// Its hit group is known, and has no closest-hit shader.
bool Lowering::goes_to_no_closest_hit(const Line& line) {
  const Scalar group = get_scalar(line.operands.at(3)), stride = get_scalar(line.operands.at(4));
  const bool is_known = group.is_constant() && (!resources_.geometries || stride == Scalar::constant(0));
  const std::vector<uint32_t> without = groups_without_closest_hit(path_->shaders);
  return is_known && std::find(without.begin(), without.end(), group.bits) != without.end();
}

void Lowering::send(const Line& line, const TraceSite& site) {
  const uint32_t flags = ray_flags(line);
  const bool skips = (flags & ray_flag::kSkipsClosestHit) != 0 || goes_to_no_closest_hit(line);
  const bool asks = !path_->shaders.any_hits.empty() && (flags & ray_flag::kOpaque) == 0;
  const bool all_count = !asks && (flags & (ray_flag::kCullsBack | ray_flag::kCullsFront)) == 0;
  if (kernel_ == RayKernel::Shade)
    fail("a miss shader traces a ray: trace it in the shader that its payload comes from");
  const auto index = [&](uint32_t operand, const char* what, size_t count) {
    const Scalar its = get_scalar(line.operands.at(operand));
    if (its.is_constant() && its.bits >= count)
      fail(fmt::format("traceRayEXT names {} {}, and the set has {}", what, its.bits, count));
    return immediate(Opcode::And, its, kIndexMask);
  };
  const Path& path = *path_;
  const size_t misses = std::max(size_t{1}, path.shaders.misses.size());
  const Scalar miss = immediate(Opcode::Shl, index(5, "miss shader", misses), kMissShift);
  Scalar hit = Scalar::constant(0);  // of a ray that no hit group looks at
  if (asks || !skips) hit = immediate(Opcode::Shl, index(3, "hit group", path.shaders.groups), kHitShift);
  // Any hit will do where every hit counts and no shader looks at it.
  const uint32_t bits = (path.comes_back ? 2 : 1) | site.number << kSiteShift | kReturnsFlag |
                        (skips ? kNoClosestHit : 0) | (asks ? kAsksAnyHit : 0) | (skips && all_count ? kFirstFlag : 0);
  const Scalar word = immediate(Opcode::Or, binary(Opcode::Or, miss, hit), bits);
  const Scalar place = place_held();
  for_each_held(site, [&](const Scalar& scalar, uint32_t number) { put_word_at(place, number, scalar); });
  if (waits_on_a_level()) {
    assign(*path_->level, immediate(Opcode::Iadd, *path_->level, 1));
    put_record_word(level_word(path.shaders), *path_->level);
  } else if (nests(path.shaders)) {
    put_record_word(level_word(path.shaders), Scalar::constant(0));
  }
  const Scalar least = put_ray(line);
  if (records_begin(path.shaders)) put_record_word(begin_word(path.shaders), least);
  const Value payload = variable(payload_of(line));
  for (uint32_t i = 0; i < payload.size(); ++i) put_passed(i, payload[i]);
  put_word(word::kFlags, word);
  recorder_.join(path_->sends);
  if (path_->comes_back) assign(path_->site, Scalar::constant(0));
}

void Lowering::go_on(const TraceSite& site) {
  way_ = {};
  if (site.in_loop || waits_on_a_level()) assign(path_->site, Scalar::constant(0));
  take_payload_back(*site.line);
  if (waits_on_a_level()) assign(*path_->level, immediate(Opcode::Isub, *path_->level, 1));
  const Scalar place = place_held();
  for_each_held(site, [&](Scalar& scalar, uint32_t number) {
    assign(scalar, from_word(word_at(place, number), scalar.kind == Scalar::Kind::Predicate));
  });
}

void Lowering::take_payload_back(const Line& line) {
  const uint32_t type = payload_type(module_, line);
  Value& value = variables_.at(payload_of(line));
  for (uint32_t i = 0; i < value.size(); ++i) {
    const Scalar word = goes_back_in_word(i) ? of(k_.int_word(word_back(i))) : record_word(i - kPayloadInRay);
    assign(value[i], from_word(word, is_condition(type, i)));
  }
}

}  // namespace raypool::shader
