// What a kernel imports, and the rays and contributions that leave it.
#include <fmt/format.h>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "shader/lowering.hpp"

namespace raypool::shader {
namespace {

constexpr uint32_t kTagShift = 8, kTagMask = 0xffff;
constexpr int kPayloadWords = 3;

std::string stage_name(RayKernel kernel) {
  switch (kernel) {
    case RayKernel::CastEye:
      return "ray generation";
    case RayKernel::Shade:
      return "miss";
    default:
      return "closest hit";
  }
}

}  // namespace

kernel::Function lower(const Module& module, const Resources& resources, RayKernel kernel, const KernelTarget& target,
                       const RecordLayout& layout, const Callables* callables) {
  Recording recording(kernel, target, layout, callables);
  return Lowering(module, resources, kernel, recording).run();
}

Lowering::Lowering(const Module& module, const Resources& resources, RayKernel kernel, Recording& recording)
    : module_(module),
      resources_(resources),
      kernel_(kernel),
      recorder_(recording.recorder),
      k_(recording.k),
      pixel_(recording.pixel),
      flags_(recording.flags),
      saved_(recording.saved),
      path_(recording.path),
      recording_(recording),
      where_{lasting(module.name()), 1} {
  recorder_.set_place(where_);
}

void Lowering::constants() {
  for (const Line& line : module_.constants()) {
    where_ = line.where;
    const auto bits = module_.constant(line.id);
    if (bits) {
      set(line, {Scalar::constant(*bits)});
    } else if (module_.is_wide(line.type) && line.operands.size() == 2) {
      set(line, {Scalar::constant(line.operands[0]), Scalar::constant(line.operands[1])});
    } else if (line.op == spv::Op::OpConstantNull) {
      set(line, Value(module_.scalars(line.type), Scalar::constant(0)));
    } else if (line.op == spv::Op::OpUndef) {
      set(line, Value(module_.scalars(line.type)));
    } else {
      Value value;
      for (const uint32_t part : line.operands) {
        const Value its = get(part);
        value.insert(value.end(), its.begin(), its.end());
      }
      set(line, value);
    }
  }
  // Messages name no line before that of an instruction.
  where_ = {lasting(module_.name()), 0};
  recorder_.set_place({where_.file, 1});
}

kernel::Function Lowering::run() {
  constants();
  const uint32_t entry = module_.blocks().front().label;
  if (kernel_ != RayKernel::CastEye) {
    k_.ray_in();
    pixel_ = of(k_.int_word(word::kPixel));
    flags_ = of(k_.int_word(word::kFlags));
    place_saved();
    begin_variables();
    region(entry, kEnd);
    return finished();
  }
  const Scalar inside = place_pixel();
  place_saved();
  under(inside, [&] {
    begin_variables();
    region(entry, kEnd);
  });
  return finished();
}

/// The pixel of an eye ray's thread, and whether it is in the picture.
Scalar Lowering::place_pixel() {
  // Thread and block both become x | y << 16: their sum is the pixel.
  const Scalar thread = of(k_.thread());
  const Scalar x = binary(Opcode::And, thread, of(k_.int_argument(argument::kTileMask)));
  const Scalar row = binary(Opcode::Shr, thread, of(k_.int_argument(argument::kTileWidthLog2)));
  const Scalar corner = of(k_.block());
  pixel_ = binary(Opcode::Iadd, binary(Opcode::Iadd, x, immediate(Opcode::Shl, row, 16)), corner);
  const Scalar in_row =
      compare(Opcode::Ult, immediate(Opcode::And, *pixel_, 0xffff), Scalar::constant(resources_.width));
  const Scalar in_picture =
      compare(Opcode::Ult, immediate(Opcode::Shr, *pixel_, 16), Scalar::constant(resources_.height));
  return both(in_row, in_picture);
}

/// Where the thread's own memory lies.
void Lowering::place_saved() {
  const uint64_t end = resources_.spilled() + resources_.saved_stride() * kSpillSlots;
  if (resources_.saved == 0 || end > UINT32_MAX) return;
  Scalar thread = of(k_.thread());
  if (resources_.units > 1) thread = binary(Opcode::Iadd, thread, scaled(of(k_.unit()), resources_.threads));
  saved_ = reg(immediate(Opcode::Shl, thread, 2));
}

kernel::Function Lowering::finished() {
  kernel::Function function = recorder_.finish();
  function.reuses_values = true;
  if (saved_)
    function.spill_memory = {*saved_, resources_.spilled(), static_cast<uint32_t>(resources_.saved_stride()),
                             kSpillSlots};
  return function;
}

Value Lowering::built_in(uint32_t number, uint32_t type) {
  const auto word_of_ray = [&](int which) { return Value{of(k_.int_word(which))}; };
  const auto only = [&](bool fits, const char* name) {
    if (!fits) fail(fmt::format("{} has no value in a {} shader", name, stage_name(kernel_)));
  };
  const bool has_ray = kernel_ != RayKernel::CastEye;
  const bool has_hit = has_ray && kernel_ != RayKernel::Shade;
  switch (static_cast<spv::BuiltIn>(number)) {
    case spv::BuiltIn::LaunchIdKHR: {
      Scalar x = immediate(Opcode::And, *pixel_, 0xffff), y = immediate(Opcode::Shr, *pixel_, 16);
      x.part = Scalar::Part::PixelX;
      y.part = Scalar::Part::PixelY;
      return {x, y, Scalar::constant(0)};
    }
    case spv::BuiltIn::LaunchSizeKHR:
      return {Scalar::constant(resources_.width), Scalar::constant(resources_.height), Scalar::constant(1)};
    case spv::BuiltIn::WorldRayOriginKHR:
    case spv::BuiltIn::ObjectRayOriginKHR:
      only(has_ray, "gl_WorldRayOriginEXT");
      return ray_origin();
    case spv::BuiltIn::WorldRayDirectionKHR:
    case spv::BuiltIn::ObjectRayDirectionKHR:
      only(has_ray, "gl_WorldRayDirectionEXT");
      return ray_words(word::kDirection);
    case spv::BuiltIn::RayTminKHR:
      return {path_ ? least_distance() : Scalar::constant(0)};
    case spv::BuiltIn::RayTmaxKHR: {
      only(has_ray, "gl_RayTmaxEXT");
      const Value behind = word_of_ray(has_hit ? word::kDistance : word::kLimit);
      return path_ ? Value{plus(behind[0], began())} : behind;
    }
    case spv::BuiltIn::PrimitiveId:
      only(has_hit, "gl_PrimitiveID");
      return word_of_ray(word::kTriangle);
    case spv::BuiltIn::InstanceId:
    case spv::BuiltIn::InstanceCustomIndexKHR:
      return {Scalar::constant(0)};  // the scene is one instance
    case spv::BuiltIn::RayGeometryIndexKHR:
      only(has_hit, "gl_GeometryIndexEXT");
      return {geometry()};
    case spv::BuiltIn::HitKindKHR: {
      only(has_hit, "gl_HitKindEXT");
      const Scalar back =
          compare(Opcode::Fgt, dot(ray_words(word::kDirection), ray_words(word::kNormal)), Scalar::constant(0));
      return {select(back, Scalar::constant(0xff), Scalar::constant(0xfe))};
    }
    case spv::BuiltIn::IncomingRayFlagsKHR:
      return {path_ ? flags_of_trace() : Scalar::constant(kernel_ == RayKernel::Shade ? kShadowRay : 0)};
    case spv::BuiltIn::ObjectToWorldKHR:
    case spv::BuiltIn::WorldToObjectKHR: {
      const uint32_t columns = module_.type(type).count, rows = module_.scalars(type) / columns;
      Value value;
      for (uint32_t c = 0; c < columns; ++c)
        for (uint32_t r = 0; r < rows; ++r) value.push_back(Scalar::constant(r == c ? as_bits(1.0f) : 0));
      return value;
    }
    default:
      fail(fmt::format("built-in variable {} is not supported", number));
  }
}

/// gl_GeometryIndexEXT: the number of the material, where each is a geometry.
Scalar Lowering::geometry() {
  if (!resources_.geometries) return Scalar::constant(0);
  constexpr uint32_t kLog2OfRecord = 5;
  static_assert(1u << kLog2OfRecord == kMaterialBytes);
  const Scalar place = of(k_.int_word(word::kMaterial));
  return immediate(Opcode::Shr, immediate(Opcode::Isub, place, *resources_.geometries), kLog2OfRecord);
}

/// vec2 barycentrics, and of a larger struct: vec3 normal, uint material, uint depth.
Value Lowering::hit_attribute(uint32_t type) {
  const uint32_t size = module_.scalars(type);
  if (kernel_ == RayKernel::CastEye || kernel_ == RayKernel::Shade)
    fail(fmt::format("a {} shader has no hit attributes", stage_name(kernel_)));
  constexpr uint32_t kMost = 7;
  if (size > kMost) {
    fail(
        fmt::format("hit attributes of {} words: a hit has barycentrics (vec2), normal (vec3), material (uint) and "
                    "depth (uint), in this order",
                    size));
  }
  Value value;
  for (uint32_t i = 0; i < size; ++i) {
    value.push_back(i + 1 < kMost ? of(k_.int_word(word::kBarycentric + static_cast<int>(i)))
                                  : immediate(Opcode::And, *flags_, kDepthMask));
  }
  return value;
}

/// Of each scalar of a payload: its word of the ray, or that it is the tag.
std::vector<std::pair<int, bool>> Lowering::payload_words(uint32_t type) const {
  std::vector<std::pair<int, bool>> words;
  int next = 0;
  bool has_tag = false;
  const auto visit = [&](const auto& self, uint32_t id) -> void {
    const Type& its = module_.type(id);
    switch (its.kind) {
      case TypeKind::Struct:
        for (const uint32_t member : its.members) self(self, member);
        return;
      case TypeKind::Vector:
      case TypeKind::Matrix:
      case TypeKind::Array:
        for (uint32_t i = 0; i < its.count; ++i) self(self, its.element);
        return;
      case TypeKind::Int:
        if (its.bits == 16) {
          if (has_tag) fail("a payload has two 16-bit integers, and a ray carries one: pack them into one");
          has_tag = true;
          words.emplace_back(0, true);
          return;
        }
        break;
      case TypeKind::Float:
        break;
      default:
        fail("a payload holds floats and integers alone: carry a condition as a uint");
    }
    for (uint32_t i = 0; i < module_.scalars(id); ++i) words.emplace_back(word::kColor + next++, false);
  };
  visit(visit, type);
  if (next > kPayloadWords) {
    fail(
        fmt::format("a payload has {} words, and a ray carries {} and a uint16_t: carry less, or compute it again from "
                    "the hit",
                    next, kPayloadWords));
  }
  return words;
}

void Lowering::load_payload(uint32_t id, const Variable& variable) {
  const uint32_t type = module_.type(variable.type).element;
  if (path_) return take_payload(id, type);
  Value value;
  for (const auto& [number, is_tag] : payload_words(type)) {
    if (!is_tag) {
      value.push_back(of(k_.int_word(number)));
      continue;
    }
    value.push_back(immediate(Opcode::And, immediate(Opcode::Shr, *flags_, kTagShift), kTagMask));
    tag_came_ = true;
  }
  keep(id, type, value);
}

void Lowering::put_word(int number, const Scalar& value) {
  if (!value.is_undefined()) k_.set_word(number, as_int(value));
}

uint32_t Lowering::ray_flags(const Line& line) {
  const Scalar flags = get_scalar(line.operands.at(1));
  if (!flags.is_constant()) fail("the ray flags are computed: give traceRayEXT constant flags");
  constexpr uint32_t kKnown = kShadowRay | ray_flag::kOpaque | ray_flag::kNoOpaque | ray_flag::kCullsBack |
                              ray_flag::kCullsFront | ray_flag::kCullsNoOpaque;
  if ((flags.bits & ray_flag::kCullsOpaque) != 0)
    fail("gl_RayFlagsCullOpaqueEXT is not supported: decide in an any-hit shader");
  if ((flags.bits & ~kKnown) != 0)
    fail(fmt::format("ray flags {:#x} are not those of a ray: use gl_RayFlags...EXT", flags.bits));
  return flags.bits;
}

/// Words of the ray but payload and flags; gives its tmin.
Scalar Lowering::put_ray(const Line& line) {
  Value origin = get(line.operands.at(6));
  const Value direction = get(line.operands.at(8));
  const Scalar least = get_scalar(line.operands.at(7));
  Scalar most = get_scalar(line.operands.at(9));
  if (!least.is_constant() || (least.bits & 0x7fffffffu) != 0) {
    // The ray begins where it may first hit.
    for (size_t i = 0; i < 3; ++i) origin[i] = multiply_add(direction[i], least, origin[i]);
    most = binary(Opcode::Fsub, most, least);
  }
  for (int i = 0; i < 3; ++i) put_word(word::kOrigin + i, origin[static_cast<size_t>(i)]);
  for (int i = 0; i < 3; ++i) put_word(word::kDirection + i, direction[static_cast<size_t>(i)]);
  put_word(word::kLimit, most);
  put_word(word::kPixel, *pixel_);
  return least;
}

/// Of a shader that ends with its traces: find_waits() has seen that it does.
void Lowering::trace(const Line& line) {
  const bool shadow = (ray_flags(line) & kShadowRay) == kShadowRay;
  if (!shadow && kernel_ == RayKernel::CastSecondaryDirect) return;
  put_ray(line);
  put_payload(payload_of(line), shadow);
  k_.ray_out();
}

void Lowering::put_payload(uint32_t id, bool shadow) {
  const auto known = module_.variables().find(id);
  if (known == module_.variables().end()) fail("the payload of a ray must be a variable of the shader");
  const uint32_t type = module_.type(known->second.type).element;
  Value value = variable(id);
  for (size_t i = 0; i < value.size(); ++i) {
    const auto held = way_.known.find({id, i});
    if (held != way_.known.end()) value[i] = held->second;
  }
  const auto words = payload_words(type);
  Scalar tag = Scalar::constant(0);
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i].second)
      tag = value[i];
    else
      put_word(words[i].first, value[i]);
  }
  Scalar flags = Scalar::constant(1);
  if (flags_) flags = tag_came_ ? immediate(Opcode::And, *flags_, kDepthMask) : *flags_;
  if (flags_ && !shadow) flags = immediate(Opcode::Iadd, flags, 1);
  if (shadow) flags = immediate(Opcode::Or, flags, kShadowFlag);
  if (!tag.is_undefined()) {
    const Scalar narrow = immediate(Opcode::And, tag, kTagMask);
    flags = binary(Opcode::Or, immediate(Opcode::Shl, narrow, kTagShift), flags);
  }
  put_word(word::kFlags, flags);
}

void Lowering::write_picture(const Line& line) {
  const auto image = images_.find(line.operands.at(0));
  if (image == images_.end() || !image->second.second) fail("imageStore writes to the picture alone");
  if (unseen_.count(line.operands.at(0)) != 0) return;
  if (loops_ > 0) fail("imageStore is called in a loop: add up first, and store behind the loop");
  const Value place = get(line.operands.at(1)), colour = get(line.operands.at(2));
  if (path_) return store_later(place, colour);
  const auto out = [&](const Scalar& pixel) {
    put_word(word::kPixel, pixel);
    for (int i = 0; i < 3; ++i) put_word(word::kColor + i, colour.at(static_cast<size_t>(i)));
    k_.frame_out();
  };
  if (place.at(0).part == Scalar::Part::PixelX && place.at(1).part == Scalar::Part::PixelY) {
    out(*pixel_);
    return;
  }
  const Scalar inside = both(compare(Opcode::Ult, place[0], Scalar::constant(resources_.width)),
                             compare(Opcode::Ult, place[1], Scalar::constant(resources_.height)));
  under(inside, [&] { out(binary(Opcode::Or, place[0], immediate(Opcode::Shl, place[1], 16))); });
}

}  // namespace raypool::shader
