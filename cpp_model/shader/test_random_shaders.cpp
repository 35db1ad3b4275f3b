#include "shader/test_random_shaders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "bits.hpp"
#include "random.hpp"

namespace raypool::shader {
namespace {

// Types are letters, so that patterns can name them: f, i, u, b are float, int, uint, bool; 2, 3, 4 are vectors of
// floats, v is ivec3, m and n are mat2 and mat3. In a pattern $ and a letter stand for an expression of that type, $j
// for an int that costs nothing: a variable or a number.
struct Type {
  char letter;
  const char* name;
  int words;
};
constexpr std::array<Type, 10> kTypes = {{{'f', "float", 1},
                                          {'i', "int", 1},
                                          {'u', "uint", 1},
                                          {'b', "bool", 1},
                                          {'2', "vec2", 2},
                                          {'3', "vec3", 3},
                                          {'4', "vec4", 4},
                                          {'v', "ivec3", 3},
                                          {'m', "mat2", 4},
                                          {'n', "mat3", 9}}};

const Type& type_of(char letter) {
  return *std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& type) { return type.letter == letter; });
}

using Patterns = std::vector<const char*>;

// Expressions of a type. What grows only does so within a few levels: 64 multiplied with itself eight times is no more
// than 3e14. Functions with poles, and those that are undefined somewhere, get arguments where they are defined.
// NOLINTNEXTLINE(readability-function-size): a list of patterns
const Patterns& patterns_of(char letter) {
  static const Patterns floats = {"($f + $f)",
                                  "($f - $f)",
                                  "($f * $f)",
                                  "($f * $f)",
                                  "($f / (abs($f) + 0.5))",
                                  "(-$f)",
                                  "abs($f)",
                                  "sign($f)",
                                  "floor($f)",
                                  "ceil($f)",
                                  "trunc($f)",
                                  "roundEven($f)",
                                  "fract($f)",
                                  "mod($f, abs($f) + 0.5)",
                                  "min($f, $f)",
                                  "max($f, $f)",
                                  "clamp($f, -1.5, abs($f))",
                                  "mix($f, $f, fract($f))",
                                  "mix($f, $f, $b)",
                                  "step($f, $f)",
                                  "smoothstep(-1.0, 2.0, $f)",
                                  "sin($f)",
                                  "cos($f)",
                                  "tan(clamp($f, -1.25, 1.25))",
                                  "asin(clamp($f, -1.0, 1.0))",
                                  "acos(clamp($f, -1.0, 1.0))",
                                  "atan($f)",
                                  "atan($f, abs($f) + 0.5)",
                                  "sinh(clamp($f, -4.0, 4.0))",
                                  "cosh(clamp($f, -4.0, 4.0))",
                                  "tanh(clamp($f, -9.0, 9.0))",
                                  "asinh($f)",
                                  "acosh(abs($f) + 1.0)",
                                  "atanh(clamp($f, -0.875, 0.875))",
                                  "sqrt(abs($f))",
                                  "inversesqrt(abs($f) + 0.25)",
                                  "exp(clamp($f, -4.0, 4.0))",
                                  "exp2(clamp($f, -6.0, 6.0))",
                                  "log(abs($f) + 0.25)",
                                  "log2(abs($f) + 0.25)",
                                  "pow(abs($f) + 0.25, clamp($f, -2.0, 2.0))",
                                  "radians($f)",
                                  "degrees(clamp($f, -4.0, 4.0))",
                                  "fma($f, $f, $f)",
                                  "ldexp($f, clamp($i, -4, 4))",
                                  "length($2)",
                                  "length($3)",
                                  "distance($3, $3)",
                                  "dot($2, $2)",
                                  "dot($3, $3)",
                                  "dot($4, $4)",
                                  "determinant($m)",
                                  "determinant($n)",
                                  "$m[$j & 1].y",
                                  "$n[2][$j & 1]",
                                  "$3.z",
                                  "$4[$j & 3]",
                                  "float($i & 1023)",
                                  "(float($i >> 8) * 0.0009765625)",
                                  "float($u & 0xffffu)",
                                  "float($b)",
                                  "uintBitsToFloat(($u & 0x7fffffu) | 0x3f800000u)",
                                  "intBitsToFloat(($i & 0x807fffff) | 0x40000000)",
                                  "($b ? $f : $f)",
                                  "($b ? $f : $f)"};
  static const Patterns ints = {"($i + $i)",
                                "($i - $i)",
                                "($i * $i)",
                                "($i / (($i & 7) + 1))",
                                "(($i & 1023) % (($i & 7) + 1))",
                                "($i & $i)",
                                "($i | $i)",
                                "($i ^ $i)",
                                "(~$i)",
                                "(-$i)",
                                "($i << ($i & 15))",
                                "($i >> ($i & 31))",
                                "min($i, $i)",
                                "max($i, $i)",
                                "clamp($i, -9, 99)",
                                "abs($i)",
                                "sign($i)",
                                "bitCount($u)",
                                "bitCount($i)",
                                "findLSB($i)",
                                "findMSB($i)",
                                "findMSB($u)",
                                "bitfieldExtract($i, $j & 15, ($j & 15) + 1)",
                                "bitfieldInsert($i, $i, $j & 15, $j & 15)",
                                "bitfieldReverse($i)",
                                "int(clamp($f, -1000.0, 1000.0))",
                                "int($u)",
                                "int($b)",
                                "floatBitsToInt($f)",
                                "$v.x",
                                "$v[$j & 1]",
                                "($b ? $i : $i)"};
  static const Patterns uints = {"($u + $u)",
                                 "($u - $u)",
                                 "($u * $u)",
                                 "($u / ($u | 1u))",
                                 "($u % ($u | 1u))",
                                 "($u & $u)",
                                 "($u | $u)",
                                 "($u ^ ($u >> 15))",
                                 "(~$u)",
                                 "($u << ($u & 31u))",
                                 "($u >> ($u & 31u))",
                                 "min($u, $u)",
                                 "max($u, $u)",
                                 "bitfieldReverse($u)",
                                 "bitfieldExtract($u, $j & 15, ($j & 15) + 1)",
                                 "bitfieldInsert($u, $u, $j & 15, $j & 15)",
                                 "uint($i)",
                                 "uint($b)",
                                 "uint(clamp($f, 0.0, 4000.0))",
                                 "floatBitsToUint($f)",
                                 "packUnorm4x8($4)",
                                 "packSnorm4x8($4)",
                                 "packUnorm2x16($2)",
                                 "packSnorm2x16($2)",
                                 "packHalf2x16(clamp($2, -99.0, 99.0))",
                                 "($b ? $u : $u)"};
  static const Patterns bools = {"($f < $f)",
                                 "($f <= $f)",
                                 "($f > $f)",
                                 "($f >= $f)",
                                 "($f == $f)",
                                 "($f != $f)",
                                 "($i < $i)",
                                 "($i >= $i)",
                                 "($i == $i)",
                                 "($u < $u)",
                                 "($u >= $u)",
                                 "($u != $u)",
                                 "($b && $b)",
                                 "($b || $b)",
                                 "($b ^^ $b)",
                                 "(!$b)",
                                 "(($i & 1) == 0)",
                                 "(($u & 3u) != 0u)",
                                 "bool($i & 2)",
                                 "any(lessThan($3, $3))",
                                 "all(greaterThan($2, $2))",
                                 "any(notEqual($v, $v))",
                                 "not(lessThanEqual($4, $4)).y",
                                 "($2 == $2)",
                                 "(isnan($f) || $b)",
                                 "(isinf($f) || $b)"};
  static const Patterns vec2s = {"vec2($f, $f)",
                                 "vec2($f)",
                                 "vec2($3)",
                                 "vec2($v.zx & 255)",
                                 "($2 + $2)",
                                 "($2 - $2)",
                                 "($2 * $2)",
                                 "($2 * $f)",
                                 "($2 / (abs($f) + 0.5))",
                                 "$2.yx",
                                 "$3.zy",
                                 "$4.xw",
                                 "($m * $2)",
                                 "($2 * $m)",
                                 "inverse(mat2(3.0, clamp($2, -1.0, 1.0), 2.0))[$j & 1]",
                                 "transpose(mat2x3($3, $3))[2]",
                                 "normalize(abs($2) + 0.125)",
                                 "mix($2, $2, fract($f))",
                                 "floor($2)",
                                 "fract($2)",
                                 "max($2, $f)",
                                 "unpackHalf2x16(packHalf2x16(clamp($2, -99.0, 99.0)))",
                                 "unpackSnorm2x16($u)",
                                 "($b ? $2 : $2)"};
  static const Patterns vec3s = {"vec3($f, $f, $f)",
                                 "vec3($f, $2)",
                                 "vec3($2, $f)",
                                 "vec3($v & 255)",
                                 "($3 + $3)",
                                 "($3 - $3)",
                                 "($3 * $3)",
                                 "($f * $3)",
                                 "(-$3)",
                                 "($3 / (abs($3) + 0.5))",
                                 "$3.zxy",
                                 "$4.wyx",
                                 "$2.yxy",
                                 "cross($3, $3)",
                                 "normalize(abs($3) + 0.125)",
                                 "reflect($3, normalize(abs($3) + 0.125))",
                                 "refract(normalize(abs($3) + 0.125), vec3(0.0, 0.0, -1.0), 0.75)",
                                 "faceforward($3, $3, $3)",
                                 "($n * $3)",
                                 "($3 * $n)",
                                 "(inverse(mat3(4.0, clamp($3, -1.0, 1.0), 4.0, clamp($3, -1.0, 1.0), 4.0)) * $3)",
                                 "mix($3, $3, fract($3))",
                                 "mix($3, $3, lessThan($3, $3))",
                                 "clamp($3, -2.0, 2.0)",
                                 "min($3, $3)",
                                 "abs($3)",
                                 "sqrt(abs($3))",
                                 "smoothstep(vec3(-1.0), vec3(2.0), $3)",
                                 "($b ? $3 : $3)"};
  static const Patterns vec4s = {
      "vec4($f, $f, $2)",   "vec4($3, $f)",       "vec4($2, $2)", "vec4($f)",         "($4 + $4)",
      "($4 * $f)",          "($4 - $4)",          "$4.wzyx",      "$3.xyzx",          "max($4, $4)",
      "unpackUnorm4x8($u)", "unpackSnorm4x8($u)", "vec4($m)",     "mat4($n)[$j & 3]", "mix($4, $4, fract($f))",
      "(mat4($n) * $4)"};
  static const Patterns ivec3s = {"ivec3($i, $i, $i)", "ivec3($i)",   "($v + $v)",
                                  "($v * $v)",         "($v ^ $i)",   "$v.yzx",
                                  "($v >> 3)",         "max($v, $v)", "ivec3(clamp($3, -1000.0, 1000.0))",
                                  "abs($v)",           "(-$v)",       "ivec3(uvec3($u, $u, 7u))",
                                  "($b ? $v : $v)"};
  static const Patterns mat2s = {"mat2($2, $2)",         "mat2($4)",  "($m * $m)",
                                 "transpose($m)",        "($m + $m)", "mat2($n)",
                                 "outerProduct($2, $2)", "mat2($f)",  "(mat3x2($2, $2, $2) * mat2x3($3, $3))"};
  static const Patterns mat3s = {"mat3($3, $3, $3)",     "($n * $n)", "transpose($n)",          "($n - $n)",
                                 "outerProduct($3, $3)", "mat3($m)",  "matrixCompMult($n, $n)", "($n * $f)"};
  switch (letter) {
    case 'f':
      return floats;
    case 'i':
      return ints;
    case 'u':
      return uints;
    case 'b':
      return bools;
    case '2':
      return vec2s;
    case '3':
      return vec3s;
    case '4':
      return vec4s;
    case 'v':
      return ivec3s;
    case 'm':
      return mat2s;
    default:
      return mat3s;
  }
}

constexpr const char* kDeclarations = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_shader_explicit_arithmetic_types_int16 : require

layout(set = 0, binding = 0) uniform accelerationStructureEXT tree;
layout(set = 0, binding = 1, rgba32f) uniform writeonly image2D picture;
layout(set = 0, binding = 2, std140) uniform Numbers {
  vec3 eye;
  vec3 corner;
  vec3 step_x;
  vec3 step_y;
  vec4 floats[2];
  ivec4 ints;
  mat3 matrix;
  layout(row_major) mat2 turned;
  uint code;
} numbers;
layout(set = 0, binding = 3, std430) readonly buffer Table {
  vec4 rows[16];
  int codes[16];
  vec3 tints[];
} table;

struct Payload {
  float weight;
  uint seed;
  float tint;
  uint16_t count;
};
struct Thing {
  float size;
  vec3 color;
  int code;
};

const float kRamp[4] = float[](0.25, -1.5, 3.0, 0.125);
const uint kShadow = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT;
)";

constexpr uint32_t kBlockWords = kRandomCameraWords + 8 + 4 + 12 + 8 + 1;
constexpr uint32_t kTints = 8;
constexpr uint32_t kBufferWords = 64 + 16 + 4 * kTints;

struct Variable {
  char type;
  std::string name;  // a pattern
  bool writable;
  bool plain;  // neither an element nor a member of another, nor global
};

struct Function {
  char result;  // a type, or ' ' for none
  std::string name;
  struct Parameter {
    char type;
    bool out;
  };
  std::vector<Parameter> parameters;
  int cost;
};

class ShaderWriter {
 public:
  /// `size` is 0 .. 3.
  ShaderWriter(Random& random, uint32_t size) : random_(random), size_(size) {}

  std::string ray_generation() {
    begin("layout(location = 0) rayPayloadEXT Payload payload;\n");
    line(
        "vec3 direction = numbers.corner + float(gl_LaunchIDEXT.x) * numbers.step_x + float(gl_LaunchIDEXT.y) * "
        "numbers.step_y;");
    line("vec3 base = clamp(direction, -64.0, 64.0);");
    locals({{'3', "base", false, true}});
    line(fill("payload.weight = clamp($f, -64.0, 64.0);", 2));
    line(fill("payload.seed = $u;", 2));
    line(fill("payload.tint = clamp($f, -64.0, 64.0);", 1));
    line(fill("payload.count = uint16_t($u & 0xffffu);", 1));
    if (chance(3)) store();
    if (chance(4)) line(fill("if ($b) return;", 2));
    trace("gl_RayFlagsOpaqueEXT", "numbers.eye", "direction", "1e30", 0);
    return end();
  }

  std::string closest_hit() {
    const bool with_struct = chance(2);
    const char* attributes = with_struct ? "hit.barycentrics" : "attributes";
    std::string text =
        "layout(location = 0) rayPayloadInEXT Payload payload;\nlayout(location = 1) rayPayloadEXT vec3 light;\n";
    if (with_struct) {
      text +=
          "struct RaypoolHit {\n  vec2 barycentrics;\n  vec3 normal;\n  uint material;\n  uint depth;\n};\n"
          "hitAttributeEXT RaypoolHit hit;\n";
    } else {
      text += "hitAttributeEXT vec2 attributes;\n";
    }
    begin(text);
    const char* normal = with_struct ? "hit.normal" : "vec3(0.0, 0.0, 1.0)";
    line("vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;");
    line(fmt::format("place -= 0.001 * sign(dot(gl_WorldRayDirectionEXT, {0})) * {0};", normal));
    line("vec3 base = clamp(place, -64.0, 64.0);");
    std::vector<Variable> given = {{'3', "base", false, true},           {'2', attributes, false, true},
                                   {'f', "payload.weight", true, false}, {'f', "payload.tint", true, false},
                                   {'u', "payload.seed", true, false},   {'u', "uint(payload.count)", false, false},
                                   {'i', "gl_PrimitiveID", false, true}};
    if (with_struct) {
      given.push_back({'3', "hit.normal", false, true});
      given.push_back({'u', "hit.depth", false, true});
    }
    locals(given);
    if (chance(2)) store();
    const bool shadow_first = chance(2);
    for (const bool shadow : {shadow_first, !shadow_first}) {
      if (chance(4)) continue;
      const bool conditional = chance(2);
      if (conditional) line(fill("if ($b) {", 2));
      indent_ += conditional;
      if (shadow) {
        line(fill("light = abs(clamp($3, -64.0, 64.0));", 2));
        trace("kShadow", "place", fill("clamp($3, -64.0, 64.0) - place", 1), "1.0", 1);
      } else {
        line("payload.count = uint16_t((uint(payload.count) + 1u) & 0xffffu);");
        line(fill("payload.weight = clamp($f, -64.0, 64.0);", 1));
        trace("gl_RayFlagsOpaqueEXT", "place", fmt::format("reflect(gl_WorldRayDirectionEXT, {})", normal), "1e30", 0);
        forget("payload");  // it is the other ray's from here on
      }
      indent_ -= conditional;
      if (conditional) line("}");
    }
    return end();
  }

  std::string miss() {
    begin("layout(location = 1) rayPayloadInEXT vec3 light;\n");
    line("vec3 base = clamp(gl_WorldRayDirectionEXT, -64.0, 64.0);");
    locals({{'3', "light", false, true}, {'3', "base", false, true}});
    store();
    return end();
  }

 private:
  uint32_t below(uint32_t limit) { return static_cast<uint32_t>(random_() % limit); }
  bool chance(uint32_t of) { return below(of) == 0; }
  const char* pick(const Patterns& patterns) { return patterns[below(size32(patterns))]; }

  void line(const std::string& text) {
    text_.append(2 * static_cast<size_t>(indent_), ' ');
    text_ += text;
    text_ += '\n';
  }

  // ---- a shader

  void begin(const std::string& declarations) {
    text_ = kDeclarations + declarations;
    variables_.clear();
    functions_.clear();
    names_ = 0;
    const bool with_global = size_ > 0 && chance(2);
    if (with_global) text_ += "float carried = 1.0;\n";
    variables_.push_back({'f', "kRamp[$j & 3]", false, false});
    variables_.push_back({'f', "numbers.floats[$j & 1].y", false, false});
    variables_.push_back({'4', "table.rows[$j & 15]", false, false});
    variables_.push_back({'f', "table.rows[$j & 15][$j & 3]", false, false});
    variables_.push_back({'i', "table.codes[$j & 15]", false, false});
    variables_.push_back({'3', fmt::format("table.tints[$j & {}]", kTints - 1), false, false});
    variables_.push_back({'i', "numbers.ints.z", false, false});
    variables_.push_back({'i', "numbers.ints[$j & 3]", false, false});
    variables_.push_back({'u', "numbers.code", false, false});
    variables_.push_back({'n', "numbers.matrix", false, false});
    variables_.push_back({'m', "numbers.turned", false, false});
    if (with_global) variables_.push_back({'f', "carried", true, false});
    const uint32_t functions = below(2 + size_ / 2);
    for (uint32_t i = 0; i < functions; ++i) function();
    text_ += "\nvoid main() {\n";
    indent_ = 1;
  }

  std::string end() {
    text_ += "}\n";
    return text_;
  }

  void trace(const char* flags, const char* origin, const std::string& direction, const char* limit, int payload) {
    line(fmt::format("traceRayEXT(tree, {}, 0xff, 0, 0, 0, {}, 0.0, {}, {}, {});", flags, origin, direction, limit,
                     payload));
  }

  // No expression uses the variable and its members any more.
  void forget(const std::string& name) {
    variables_.erase(std::remove_if(variables_.begin(), variables_.end(),
                                    [&](const Variable& v) { return v.name.find(name) != std::string::npos; }),
                     variables_.end());
  }

  void store() {
    line(fill("imageStore(picture, ivec2(gl_LaunchIDEXT.xy), vec4(abs(clamp($3, -64.0, 64.0)), 1.0));", 2));
  }

  // Variables of main, and its statements.
  void locals(const std::vector<Variable>& given) {
    variables_.insert(variables_.end(), given.begin(), given.end());
    variables_.push_back({'u', "gl_LaunchIDEXT.x", false, false});
    variables_.push_back({'i', "int(gl_LaunchIDEXT.y)", false, false});
    variables_.push_back({'f', "float(gl_LaunchIDEXT.x & 63u)", false, false});
    static constexpr std::array<int, 4> kWords = {8, 14, 22, 34};
    int words = kWords[size_];
    words -= declare('f') + declare('3');
    while (words > 0) words -= chance(5) ? declare_many() : declare(pick_type());
    budget_ = 12 + 16 * static_cast<int>(size_);
    statements(4 + 2 * size_, 2, false);
  }

  // ---- expressions

  // Replaces each $ and letter, from the left to the right, with an expression of so many levels.
  std::string fill(std::string_view pattern, int levels) {
    std::string text;
    for (size_t i = 0; i < pattern.size(); ++i) {
      if (pattern[i] != '$') {
        text += pattern[i];
      } else {
        ++i;
        text += pattern[i] == 'j' ? index() : expression(pattern[i], levels);
      }
    }
    return text;
  }

  std::string expression(char type, int levels) {
    if (levels <= 0 || budget_ <= 0 || chance(6)) return leaf(type);
    --budget_;
    return fill(pick(patterns_of(type)), levels - 1);
  }

  std::string index() {
    std::vector<const Variable*> found;
    for (const Variable& variable : variables_)
      if (variable.type == 'i' && variable.name.find('$') == std::string::npos) found.push_back(&variable);
    return chance(3) || found.empty() ? fmt::format("{}", below(9)) : found[below(size32(found))]->name;
  }

  std::string leaf(char type) {
    std::vector<const Variable*> found;
    for (const Variable& variable : variables_)
      if (variable.type == type) found.push_back(&variable);
    if (found.empty() || chance(5)) return literal(type);
    // The last ones are the shader's own.
    const size_t among = chance(2) ? found.size() : std::min<size_t>(found.size(), 4);
    const size_t back = below(static_cast<uint32_t>(among));
    return fill(found[found.size() - 1 - back]->name, 0);
  }

  std::string literal(char type) {
    switch (type) {
      case 'f': {
        const double value = (static_cast<double>(below(65)) - 32) / 8;
        return value < 0 ? fmt::format("({:.3f})", value) : fmt::format("{:.3f}", value);
      }
      case 'i':
        return chance(4) ? fmt::format("(-{})", 1 + below(9)) : fmt::format("{}", chance(4) ? below(100000) : below(9));
      case 'u':
        return chance(2) ? fmt::format("{}u", below(9)) : fmt::format("0x{:x}u", random_());
      case 'b':
        return fill("($f < $f)", 0);
      case '2':
        return fill("vec2($f, 1.0)", 0);
      case '3':
        return fill("vec3($f, 0.5, $f)", 0);
      case '4':
        return fill("vec4($f, -1.0, $f, 0.25)", 0);
      case 'v':
        return fill("ivec3($i, 2, $i)", 0);
      case 'm':
        return fill("mat2($f, 1.0, -0.5, $f)", 0);
      default:
        return fill("mat3($f, 1.0, 0.0, -0.5, $f, 0.25, 0.0, 2.0, 1.0)", 0);
    }
  }

  // An expression that may be kept: floats of it are between -64 and 64.
  std::string kept(char type, int levels) {
    switch (type) {
      case 'f':
      case '2':
      case '3':
      case '4':
        return fmt::format("clamp({}, -64.0, 64.0)", expression(type, levels));
      case 'm':
        return fill("mat2(clamp($2, -8.0, 8.0), clamp($2, -8.0, 8.0))", levels - 1);
      case 'n':
        return fill("mat3(clamp($3, -8.0, 8.0), clamp($3, -8.0, 8.0), clamp($3, -8.0, 8.0))", levels - 1);
      default:
        return expression(type, levels);
    }
  }

  // ---- declarations; each returns the words of what it declares

  char pick_type() {
    static constexpr std::string_view kLetters = "ffffiiiuub2334vmn";
    return kLetters[below(kLetters.size())];
  }

  std::string new_name() { return fmt::format("x{}", names_++); }

  int declare(char type) {
    const std::string name = new_name(), value = kept(type, 1);
    line(fmt::format("{} {} = {};", type_of(type).name, name, value));
    add(type, name);
    return type_of(type).words;
  }

  // A variable, and its elements.
  void add(char type, const std::string& name) {
    variables_.push_back({type, name, true, true});
    switch (type) {
      case '2':
        variables_.push_back({'f', name + "[$j & 1]", true, false});
        break;
      case '3':
        variables_.push_back({'f', name + ".y", true, false});
        variables_.push_back({'2', name + ".zx", true, false});
        break;
      case '4':
        variables_.push_back({'f', name + "[$j & 3]", true, false});
        variables_.push_back({'3', name + ".wyx", true, false});
        break;
      case 'v':
        variables_.push_back({'i', name + ".z", true, false});
        break;
      case 'm':
        variables_.push_back({'2', name + "[$j & 1]", true, false});
        break;
      case 'n':
        variables_.push_back({'3', name + "[1]", true, false});
        break;
      default:
        break;
    }
  }

  // An array or a structure.
  int declare_many() {
    const std::string name = new_name();
    switch (below(3)) {
      case 0:
        line(fmt::format("float {}[4] = float[]({});", name,
                         fill("0.5, clamp($f, -64.0, 64.0), -1.0, clamp($f, -64.0, 64.0)", 1)));
        variables_.push_back({'f', name + "[$j & 3]", true, false});
        return 4;
      case 1:
        line(
            fmt::format("int {}[2][2] = int[2][2](int[2]({}), int[2]({}));", name, fill("$i, 3", 1), fill("7, $i", 0)));
        variables_.push_back({'i', name + "[$j & 1][$j & 1]", true, false});
        return 4;
      default:
        line(fmt::format("Thing {} = Thing({});", name, fill("clamp($f, -64.0, 64.0), clamp($3, -64.0, 64.0), $i", 1)));
        variables_.push_back({'f', name + ".size", true, false});
        variables_.push_back({'3', name + ".color", true, false});
        variables_.push_back({'f', name + ".color[$j & 1]", true, false});
        variables_.push_back({'i', name + ".code", true, false});
        return 5;
    }
  }

  // ---- statements

  void statements(uint32_t count, int nesting, bool in_loop) {
    const size_t scope = variables_.size();
    for (uint32_t i = 0; i < count && (i == 0 || budget_ > 0); ++i) statement(nesting, in_loop);
    variables_.resize(scope);
  }

  void block(const std::string& head, int nesting, bool in_loop) {
    line(head + " {");
    ++indent_;
    statements(1 + below(2), nesting - 1, in_loop);
    --indent_;
  }

  void statement(int nesting, bool in_loop) {
    const uint32_t kind = below(nesting > 0 ? 16 : 8);
    switch (kind) {
      case 6:
        if (in_loop) return line(fill(chance(2) ? "if ($b) continue;" : "if ($b) break;", 1));
        if (result_ != '-' && chance(2)) return give_back();
        return assign();
      case 7:
        if (!functions_.empty()) return call();
        return take_apart();
      case 8:
      case 9:
      case 10:
        return choose(nesting, in_loop);
      case 11:
        return choose_of_many(nesting, in_loop);
      case 12:
      case 13:
      case 14:
      case 15:
        return repeat(nesting);
      default:
        return assign();
    }
  }

  const Variable* writable(char type, bool plain) {
    std::vector<const Variable*> found;
    for (const Variable& variable : variables_)
      if (variable.writable && (!plain || variable.plain) && (type == '*' || variable.type == type))
        found.push_back(&variable);
    return found.empty() ? nullptr : found[below(size32(found))];
  }

  void assign() {
    const Variable* found = writable('*', false);
    if (found == nullptr) return;
    const Variable variable = *found;
    const std::string name = fill(variable.name, 0);
    const int levels = 2 + static_cast<int>(below(2));
    switch (variable.type) {
      case 'i':
        if (chance(3))
          return line(name + fill(pick({" += $i;", " ^= $i;", " -= $i;", " *= $i;", "++;", " >>= 1;"}), levels));
        break;
      case 'u':
        if (chance(3))
          return line(name + fill(pick({" += $u;", " ^= $u;", " *= $u;", " |= $u;", "--;", " <<= 3;"}), levels));
        break;
      default:
        break;
    }
    line(fmt::format("{} = {};", name, kept(variable.type, levels)));
  }

  // Functions with out parameters.
  void take_apart() {
    const Variable* number = writable('f', true);
    const Variable* integer = writable('i', true);
    const Variable* word = writable('u', true);
    switch (below(4)) {
      case 0: {
        if (number == nullptr) break;
        const std::string fraction = number->name, whole = new_name();
        line(fmt::format("float {} = 0.0;", whole));
        line(fmt::format("{} = modf({}, {});", fraction, kept('f', 2), whole));
        return add('f', whole);
      }
      case 1:
        if (number == nullptr || integer == nullptr) break;
        return line(fmt::format("{} = frexp({}, {});", number->name, kept('f', 2), integer->name));
      case 2: {
        if (word == nullptr) break;
        const std::string sum = word->name, carry = new_name();
        line(fmt::format("uint {} = 0u;", carry));
        line(fmt::format("{} = uaddCarry({}, {});", sum, fill("$u, $u", 1), carry));
        return add('u', carry);
      }
      default:
        break;
    }
    assign();
  }

  void choose(int nesting, bool in_loop) {
    block(fill("if ($b)", 2), nesting, in_loop);
    if (chance(3)) block(fill("} else if ($b)", 1), nesting, in_loop);
    if (chance(2)) block("} else", nesting, in_loop);
    line("}");
  }

  void choose_of_many(int nesting, bool in_loop) {
    line(fill("switch ($i & 3) {", 1));
    const uint32_t cases = 2 + below(2);
    for (uint32_t i = 0; i < cases; ++i) {
      ++indent_;
      block(fmt::format("case {}:", i), nesting, in_loop);
      if (!chance(4)) line("  break;");
      line("}");
      --indent_;
    }
    ++indent_;
    block("default:", nesting, in_loop);
    line("}");
    --indent_;
    line("}");
  }

  void repeat(int nesting) {
    const std::string turn = fmt::format("turn{}", names_++);
    const size_t scope = variables_.size();
    switch (below(4)) {
      case 0:
        line(fmt::format("int {} = 0;", turn));
        variables_.push_back({'i', turn, false, false});
        block(fill(fmt::format("while ({}++ < 3 && $b)", turn), 1), nesting, true);
        line("}");
        break;
      case 1:
        line(fmt::format("int {} = 0;", turn));
        variables_.push_back({'i', turn, false, false});
        block("do", nesting, true);
        line(fill(fmt::format("}} while (++{} < 3 && $b);", turn), 1));
        break;
      case 2:
        variables_.push_back({'i', turn, false, false});
        block(fmt::format("for (int {0} = 0; {0} < {1}; ++{0})", turn, 2 + below(3)), nesting, true);
        line("}");
        break;
      default: {
        const std::string first = fill("$i & 3", 1);
        variables_.push_back({'i', turn, false, false});
        block(fmt::format("for (int {0} = {1}; {0} >= 0; --{0})", turn, first), nesting, true);
        line("}");
      }
    }
    variables_.resize(scope);
  }

  // ---- functions

  void function() {
    static constexpr std::string_view kResults = "f3i ";
    static constexpr std::string_view kParameters = "fffiu233";
    Function made;
    made.result = kResults[below(kResults.size())];
    made.name = fmt::format("change{}", functions_.size());
    const std::vector<Variable> globals = variables_;
    const uint32_t parameters = 2 + below(2);
    std::string list;
    for (uint32_t i = 0; i < parameters; ++i) {
      const char type = kParameters[below(kParameters.size())];
      const uint32_t direction = i == 0 ? 1 : below(4);  // 0 and 3 are in, 2 is out; the first is inout
      made.parameters.push_back({type, direction == 1 || direction == 2});
      const std::string name = fmt::format("p{}", i);
      list += fmt::format("{}{}{} {}", i == 0 ? "" : ", ",
                          direction == 1   ? "inout "
                          : direction == 2 ? "out "
                                           : "",
                          type_of(type).name, name);
      add(type, name);
      if (direction == 2) outs_.push_back({type, name, true, true});
    }
    text_ += fmt::format("\n{} {}({}) {{\n", made.result == ' ' ? "void" : type_of(made.result).name, made.name, list);
    indent_ = 1;
    // An out parameter has no value before it is written.
    for (const Variable& out : outs_) line(fmt::format("{} = {};", out.name, literal_value(out.type)));
    outs_.clear();
    budget_ = 8 + 6 * static_cast<int>(size_);
    const int before = budget_;
    result_ = made.result;
    statements(2 + size_, 2, false);
    if (made.result != ' ') line(fmt::format("return {};", kept(made.result, 1)));
    result_ = '-';
    made.cost = before - budget_;
    text_ += "}\n";
    variables_ = globals;
    functions_.push_back(made);
  }

  static const char* literal_value(char type) {
    switch (type) {
      case 'f':
        return "0.5";
      case 'i':
        return "3";
      case 'u':
        return "5u";
      case '2':
        return "vec2(0.25)";
      default:
        return "vec3(0.75)";
    }
  }

  // Leaves the function, in some cases.
  void give_back() {
    const std::string condition = fill("if ($b) ", 1);
    line(condition + (result_ == ' ' ? std::string("return;") : fmt::format("return {};", kept(result_, 1))));
  }

  // What is changed are different variables, none of them an element: the order in which they change does not matter.
  void call() {
    const Function& called = functions_[below(size32(functions_))];
    std::vector<std::string> changed;
    std::string list;
    for (const Function::Parameter& parameter : called.parameters) {
      if (!list.empty()) list += ", ";
      if (!parameter.out) {
        list += kept(parameter.type, 1);
        continue;
      }
      const Variable* variable = writable(parameter.type, true);
      if (variable == nullptr || std::count(changed.begin(), changed.end(), variable->name) > 0) return assign();
      changed.push_back(variable->name);
      list += variable->name;
    }
    budget_ -= called.cost;
    const Variable* result = called.result == ' ' ? nullptr : writable(called.result, true);
    if (result != nullptr && std::count(changed.begin(), changed.end(), result->name) > 0) result = nullptr;
    line(fmt::format("{}{}({});", result == nullptr ? "" : result->name + " = ", called.name, list));
  }

  Random& random_;
  uint32_t size_;
  std::string text_;
  int indent_ = 0;
  int budget_ = 0;
  int names_ = 0;
  char result_ = '-';  // of the function that is written; in main '-'
  std::vector<Variable> variables_, outs_;
  std::vector<Function> functions_;
};

// A multiple of 1/8 from -4 to 4.
uint32_t random_float(Random& random) { return as_bits((static_cast<float>(random() % 65) - 32.0f) / 8.0f); }

}  // namespace

RandomShaders random_shaders(uint32_t seed) {
  Random random(seed);
  ShaderWriter writer(random, seed % 4);
  RandomShaders shaders;
  shaders.ray_generation = writer.ray_generation();
  shaders.closest_hit = writer.closest_hit();
  shaders.miss = writer.miss();
  shaders.block.assign(kRandomCameraWords, 0);
  while (shaders.block.size() < kBlockWords) {
    const size_t word = shaders.block.size();
    const bool integer = (word >= kRandomCameraWords + 8 && word < kRandomCameraWords + 12) || word + 1 == kBlockWords;
    shaders.block.push_back(integer ? random() : random_float(random));
  }
  while (shaders.buffer.size() < kBufferWords) {
    const size_t word = shaders.buffer.size();
    shaders.buffer.push_back(word >= 64 && word < 80 ? random() : random_float(random));
  }
  return shaders;
}

}  // namespace raypool::shader
