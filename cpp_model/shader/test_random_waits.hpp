// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Random shader sets in GLSL that wait for their rays, for tests that compare their kernels with another reading.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "random.hpp"

namespace raypool::shader {

/// What the shaders of a set begin with: their bindings, and short words for what they often do.
inline constexpr const char* kWaitingPrelude = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tree;
layout(set = 0, binding = 1, rgba32f) uniform image2D picture;
layout(set = 0, binding = 2, std140) uniform Numbers {
  vec4 floats[4];
  ivec4 ints[2];
  mat3 turn;
} numbers;
layout(set = 0, binding = 3, std430) buffer Table {
  vec4 rows[16];
  int codes[16];
} table;
layout(set = 0, binding = 4) uniform sampler2D textures[4];
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Rows { vec4 row[4]; };
layout(set = 0, binding = 5, std430) readonly buffer Scene { vec4 lights[8]; } scene;
const uint kAny = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT;
const uint kOpaque = gl_RayFlagsOpaqueEXT;
#define X int(gl_LaunchIDEXT.x)
#define Y int(gl_LaunchIDEXT.y)
#define STORE(v) imageStore(picture, ivec2(gl_LaunchIDEXT.xy), vec4(v, 1.0))
#define TRACE(flags, hit, miss, origin, direction, location) \
  traceRayEXT(tree, flags, 0xff, hit, 0, miss, origin, 0.0, direction, 1e30, location)
#define PIXEL vec3(float(X) * 0.5 - 3.0, float(Y) * 0.25 - 1.0, 1.0)
)";

/// Writes sets in which no value is undefined: variables begin with a value, indices are in range, and every float that
/// is kept lies in -64 .. 64. The same for the same seed.
class RandomWaits {
 public:
  explicit RandomWaits(uint32_t seed) : random_(seed), size_(1 + seed % 3), nests_(seed % 4 == 3) {}

  /// Names and texts of the set's files.
  std::vector<std::pair<std::string, std::string>> files() {
    payload_ = members("Payload", 1 + below(2 * size_));
    light_ = members("Light", 1 + below(2));
    hits_ = chance(4) ? 2 : 1;
    misses_ = chance(4) ? 2 : 1;
    std::vector<std::pair<std::string, std::string>> files;
    files.emplace_back("a.rgen", begin());
    for (uint32_t i = 0; i < hits_; ++i) files.emplace_back(fmt::format("{}.rchit", i), hit());
    for (uint32_t i = 0; i < misses_; ++i) files.emplace_back(fmt::format("{}.rmiss", i), miss("Payload payload", 0));
    files.emplace_back(fmt::format("{}.rmiss", misses_), miss("Light light", 1));
    return files;
  }

 private:
  // Types are letters: f, i, b, 3, 4, m (mat2), a (float[3]), t (bvec2).
  struct Variable {
    char type;
    std::string name;
    bool writable = true;
  };

  uint32_t below(uint32_t limit) { return static_cast<uint32_t>(random_() % limit); }
  bool chance(uint32_t of) { return below(of) == 0; }

  static const char* name_of(char type) {
    switch (type) {
      case 'f':
      case 'a':
        return "float";
      case 'i':
        return "int";
      case 'b':
        return "bool";
      case '3':
        return "vec3";
      case '4':
        return "vec4";
      case 't':
        return "bvec2";
      default:
        return "mat2";
    }
  }

  /// Writes the struct, and gives its members.
  std::vector<Variable> members(const std::string& name, uint32_t count) {
    std::vector<Variable> all;
    structs_ += "struct " + name + " {\n";
    for (uint32_t i = 0; i < count; ++i) {
      const char type = "fi3bfat4m"[below(9)];
      all.push_back({type, fmt::format("m{}", i)});
      structs_ += fmt::format("  {} m{}{};\n", name_of(type), i, type == 'a' ? "[3]" : "");
    }
    structs_ += "};\n";
    return all;
  }

  void line(const std::string& text) { text_ += std::string(2 * static_cast<size_t>(indent_), ' ') + text + '\n'; }

  // ---- expressions

  const Variable* variable(char type, bool writable) {
    std::vector<const Variable*> found;
    for (const Variable& one : variables_)
      if (one.type == type && (one.writable || !writable)) found.push_back(&one);
    if (found.empty()) return nullptr;
    return found[found.size() - 1 -
                 below(static_cast<uint32_t>(chance(2) ? found.size() : std::min<size_t>(4, found.size())))];
  }

  std::string leaf(char type) {
    const Variable* found = chance(6) ? nullptr : variable(type, false);
    if (found != nullptr) return found->name;
    switch (type) {
      case 'f':
        return fmt::format("{:.3f}", static_cast<double>(below(33)) / 8);
      case 'i':
        return fmt::format("{}", below(9));
      case 'b':
        return fmt::format("({} < {})", leaf('f'), leaf('f'));
      case '3':
        return fmt::format("vec3({}, 0.5, {})", leaf('f'), leaf('f'));
      case '4':
        return fmt::format("vec4({}, {})", leaf('3'), leaf('f'));
      case 't':
        return fmt::format("bvec2({}, {})", leaf('b'), leaf('b'));
      case 'a':
        return fmt::format("float[]({}, 0.25, {})", leaf('f'), leaf('f'));
      default:
        return fmt::format("mat2({}, 0.5, 0.25, {})", leaf('f'), leaf('f'));
    }
  }

  std::string fill(std::string_view pattern, int levels) {
    std::string text;
    for (size_t i = 0; i < pattern.size(); ++i) {
      if (pattern[i] == '$')
        text += expression(pattern[++i], levels - 1);
      else
        text += pattern[i];
    }
    return text;
  }

  std::string expression(char type, int levels) {
    if (levels <= 0) return leaf(type);
    static const std::vector<const char*> floats = {"($f + $f)",
                                                    "($f - $f)",
                                                    "($f * $f)",
                                                    "min($f, $f)",
                                                    "abs($f)",
                                                    "fract($f)",
                                                    "float($i & 63)",
                                                    "($b ? $f : $f)",
                                                    "dot($3, $3)",
                                                    "$3.y",
                                                    "$4[$i & 3]",
                                                    "$a[($i & 15) % 3]",
                                                    "$m[$i & 1].x",
                                                    "numbers.floats[$i & 3].z",
                                                    "table.rows[$i & 15].w",
                                                    "sin($f)",
                                                    "mix($f, $f, 0.25)",
                                                    "float($t.x)",
                                                    "texture(textures[$i & 3], $3.xy).y",
                                                    "sqrt(abs($f))"};
    static const std::vector<const char*> ints = {"($i + $i)",
                                                  "($i * 3 - $i)",
                                                  "($i & $i)",
                                                  "($i ^ $i)",
                                                  "($b ? $i : $i)",
                                                  "int(clamp($f, -99.0, 99.0))",
                                                  "(($i & 255) / (($i & 7) + 1))",
                                                  "table.codes[$i & 15]",
                                                  "(X + $i)",
                                                  "(Y - $i)"};
    static const std::vector<const char*> bools = {"($f < $f)",  "($i > $i)",       "($b && $b)", "($b || $b)", "(!$b)",
                                                   "($b != $b)", "(($i & 1) == 0)", "$t.y",       "any($t)"};
    static const std::vector<const char*> threes = {"vec3($f, $f, $f)",    "($3 + $3)",
                                                    "($3 * $f)",           "$3.zxy",
                                                    "cross($3, $3)",       "$4.xyw",
                                                    "(numbers.turn * $3)", "scene.lights[$i & 7].xyz",
                                                    "($b ? $3 : $3)",      "mix($3, $3, vec3(0.5))"};
    static const std::vector<const char*> fours = {"vec4($3, $f)", "($4 - $4)", "table.rows[$i & 15]", "$4.wzyx",
                                                   "vec4($f)"};
    static const std::vector<const char*> pairs = {"bvec2($b, $b)", "not($t)", "$t.yx", "lessThan($3.xy, $3.zz)"};
    static const std::vector<const char*> matrices = {"mat2($f, $f, $f, $f)", "($m * 0.5)", "transpose($m)",
                                                      "($m + $m)"};
    static const std::vector<const char*> arrays = {"float[]($f, $f, $f)", "$a"};
    const std::vector<const char*>& from = type == 'f'   ? floats
                                           : type == 'i' ? ints
                                           : type == 'b' ? bools
                                           : type == '3' ? threes
                                           : type == '4' ? fours
                                           : type == 't' ? pairs
                                           : type == 'a' ? arrays
                                                         : matrices;
    return fill(from[below(static_cast<uint32_t>(from.size()))], levels);
  }

  /// One that may be kept.
  std::string kept(char type, int levels) {
    switch (type) {
      case 'f':
      case '3':
      case '4':
        return fmt::format("clamp({}, -64.0, 64.0)", expression(type, levels));
      case 'a':
        return fill("float[](clamp($f, -64.0, 64.0), clamp($f, -64.0, 64.0), 0.5)", levels);
      case 'm':
        return fill("mat2(clamp($4, -8.0, 8.0))", levels);
      case 'i':
        return fmt::format("({} & 0xffff)", expression(type, levels));
      default:
        return expression(type, levels);
    }
  }

  // ---- statements

  void declare(char type) { declare(type, kept(type, 1)); }
  void declare(char type, const std::string& value) {
    const std::string name = fmt::format("v{}", names_++);
    line(fmt::format("{} {}{} = {};", name_of(type), name, type == 'a' ? "[3]" : "", value));
    variables_.push_back({type, name, true});
  }

  void assign() {
    const char type = "fi3b4matf3"[below(10)];
    const Variable* found = variable(type, true);
    if (found == nullptr) return declare(type);
    const std::string name = found->name;
    if (type == 'a' && chance(2)) return line(fmt::format("{}[({} & 15) % 3] = {};", name, leaf('i'), kept('f', 2)));
    if (type == '3' && chance(3)) return line(fmt::format("{}[{} % 3] = {};", name, below(9), kept('f', 2)));
    if (type == 'm' && chance(2)) return line(fmt::format("{}[{} & 1].y = {};", name, leaf('i'), kept('f', 2)));
    line(fmt::format("{} = {};", name, kept(type, 2 + static_cast<int>(below(2)))));
  }

  void trace() {
    if (traces_ == 0) return assign();
    --traces_;
    if (in_hit_ && nested_ > 0 && chance(2)) {
      // It comes to a closest-hit shader, which may trace one itself.
      --nested_;
      return line(fmt::format("TRACE(kOpaque, {}, {}, {}, {}, 2);",
                              hits_ > 1 ? fill("uint($i & 1)", 1) : std::string("0"), below(misses_), kept('3', 2),
                              kept('3', 2)));
    }
    const bool light = in_hit_ || chance(4);
    const bool any = in_hit_ || chance(4);
    const std::string miss = light                      ? fmt::format("{}", misses_)
                             : misses_ > 1 && chance(2) ? fill("uint($i & 1)", 1)
                                                        : fmt::format("{}", below(misses_));
    const std::string hit = hits_ > 1 && chance(2) ? fill("uint($i & 1)", 1) : fmt::format("{}", below(hits_));
    // The light's payload is of another type than hits take.
    const char* flags = light || any ? (chance(2) ? "kAny" : "kAny | kOpaque")
                        : chance(2)  ? "kOpaque"
                                     : "gl_RayFlagsNoneEXT";
    line(fmt::format("TRACE({}, {}, {}, {}, {}, {});", flags, light || any ? "0" : hit, miss, kept('3', 2),
                     chance(2) && !in_hit_ ? "PIXEL" : kept('3', 2), light ? 1 : 0));
  }

  void block(const std::string& head, int nesting) {
    line(head + " {");
    ++indent_;
    const size_t scope = variables_.size();
    const uint32_t count = 1 + below(2);
    for (uint32_t i = 0; i < count; ++i) {
      if (chance(3))
        trace();
      else
        statement(nesting - 1);
    }
    variables_.resize(scope);
    --indent_;
  }

  void jump() {
    if (loops_ > 0 && chance(2)) return line(fill(chance(2) ? "if ($b) continue;" : "if ($b) break;", 2));
    if (chance(4)) return line(fill(in_function_ ? "if ($b) return 0.5;" : "if ($b) return;", 2));
    assign();
  }

  void loop(int nesting) {
    const std::string counter = fmt::format("n{}", names_++);
    const uint32_t turns = 1 + below(3);
    const uint32_t kind = below(3);
    ++loops_;
    line(kind == 0 ? "{" : fmt::format("{{ int {} = 0;", counter));
    const size_t scope = variables_.size();
    if (kind == 0) {
      variables_.push_back({'i', counter, false});
      block(fmt::format("for (int {0} = 0; {0} < {1}; ++{0})", counter, turns), nesting);
      line("}");
    } else if (kind == 1) {
      variables_.push_back({'i', counter, false});
      block(fill(fmt::format("while ({}++ < {} && ($b || true))", counter, turns), 2), nesting);
      line("}");
    } else {
      variables_.push_back({'i', counter, false});
      block("do", nesting);
      line(fill(fmt::format("}} while (++{} < {} && $b);", counter, turns + 1), 2));
    }
    variables_.resize(scope);
    line("}");
    --loops_;
  }

  void choose_of_many(int nesting) {
    line(fill("switch ($i & 3) {", 2));
    const uint32_t cases = 2 + below(3);
    const int outer = loops_;
    for (uint32_t i = 0; i < cases; ++i) {
      ++indent_;
      block(i + 1 == cases && chance(2) ? "default:" : fmt::format("case {}:", i), nesting);
      if (!chance(3)) line("  break;");
      line("}");
      --indent_;
    }
    loops_ = outer;
    line("}");
  }

  void store() {
    if (loops_ > 0 || in_function_) return assign();
    if (in_hit_ && nests_) return assign();
    line(chance(4) ? fill("imageStore(picture, ivec2($i & 15, $i & 7), vec4($3, 1.0));", 2) : fill("STORE($3);", 3));
  }

  void statement(int nesting) {
    switch (below(nesting > 0 ? 18 : 9)) {
      case 0:
      case 1:
      case 2:
        return assign();
      case 3:
      case 4:
      case 5:
        return trace();
      case 6:
        return jump();
      case 7:
        if (has_function_ && !in_function_ && calls_ > 0) {
          --calls_;
          const Variable* result = variable('f', true);
          const Variable* changed = variable('3', true);
          if (result != nullptr && changed != nullptr)
            return line(fmt::format("{} = look({}, {});", result->name, kept('f', 1), changed->name));
        }
        return declare("fi3b4mat"[below(8)]);
      case 8:
        return store();
      case 9:
      case 10:
      case 11:
        block(fill("if ($b)", 2), nesting);
        if (chance(2)) block(fill("} else if ($b)", 2), nesting);
        if (chance(2)) block("} else", nesting);
        return line("}");
      case 12:
        return choose_of_many(nesting);
      default:
        return loop(nesting);
    }
  }

  // ---- shaders

  void start(const std::string& declarations) {
    text_ = kWaitingPrelude + structs_ + declarations;
    variables_.clear();
    names_ = 0;
    indent_ = loops_ = 0;
    has_function_ = in_hit_ = false;
    traces_ = calls_ = 0;
  }
  void take(const std::vector<Variable>& members, const std::string& payload) {
    for (const Variable& member : members) variables_.push_back({member.type, payload + "." + member.name, true});
  }
  void give_values(const std::vector<Variable>& members, const std::string& payload) {
    for (const Variable& member : members) line(fmt::format("{}.{} = {};", payload, member.name, kept(member.type, 1)));
    take(members, payload);
  }
  void function() {
    text_ += "float look(float p, inout vec3 q) {\n";
    indent_ = 1;
    const std::vector<Variable> globals = variables_;
    variables_.push_back({'f', "p"});
    variables_.push_back({'3', "q"});
    in_function_ = true;
    const uint32_t count = 2 + below(3);
    for (uint32_t i = 0; i < count; ++i) statement(1);
    line(fmt::format("return {};", kept('f', 2)));
    in_function_ = false;
    text_ += "}\n";
    variables_ = globals;
    has_function_ = true;
    calls_ = 2;
  }
  std::string body(uint32_t statements, const std::string& last) {
    const size_t globals = variables_.size();
    // Paths differ.
    declare('f', "fract(float(X * 7 + Y * 3) * 0.37)");
    declare('i', "((X ^ (Y * 3)) & 7)");
    declare('3', "PIXEL");
    for (uint32_t i = 0; i + 1 < size_; ++i) declare("fi34bmat"[below(8)]);
    std::rotate(variables_.begin(), variables_.begin() + static_cast<std::ptrdiff_t>(globals), variables_.end());
    for (uint32_t i = 0; i < statements; ++i) statement(2);
    line(last.empty() ? std::string() : fill(last, 3));
    text_ += "}\n";
    return text_;
  }

  std::string begin() {
    start("layout(location = 0) rayPayloadEXT Payload payload;\nlayout(location = 1) rayPayloadEXT Light light;\n");
    if (chance(2)) {
      text_ += "float carried = 0.75;\n";
      variables_.push_back({'f', "carried"});
    }
    const bool with_function = chance(2);
    take(payload_, "payload");
    take(light_, "light");
    traces_ = 2;
    if (with_function) function();
    variables_.resize(variables_.size() - payload_.size() - light_.size());
    text_ += "void main() {\n";
    indent_ = 1;
    give_values(payload_, "payload");
    give_values(light_, "light");
    traces_ = 2 + size_;
    return body(2 + size_, "STORE(abs($3) + $f + $f);");
  }
  std::string hit() {
    start(fmt::format(
        "layout(location = 0) rayPayloadInEXT Payload payload;\nlayout(location = 1) rayPayloadEXT Light light;\n"
        "{}hitAttributeEXT vec2 attributes;\n",
        nests_ ? "layout(location = 2) rayPayloadEXT Payload inner;\n" : ""));
    in_hit_ = true;
    text_ += "void main() {\n";
    indent_ = 1;
    take(payload_, "payload");
    for (const char* name : {"gl_HitTEXT", "attributes.x", "gl_WorldRayDirectionEXT.y"})
      variables_.push_back({'f', name, false});
    variables_.push_back({'i', "gl_PrimitiveID", false});
    variables_.push_back({'3', "gl_WorldRayOriginEXT", false});
    give_values(light_, "light");
    if (nests_) give_values(payload_, "inner");
    traces_ = nests_ ? 2 : chance(2) ? 0 : 1 + below(2);
    nested_ = nests_ ? 1 : 0;
    return body(1 + below(size_), "");
  }
  std::string miss(const std::string& payload, uint32_t location) {
    start(fmt::format("layout(location = {}) rayPayloadInEXT {};\n", location, payload));
    text_ += "void main() {\n";
    indent_ = 1;
    take(location == 0 ? payload_ : light_, location == 0 ? "payload" : "light");
    variables_.push_back({'3', "gl_WorldRayDirectionEXT", false});
    return body(below(2), "");
  }

  Random random_;
  uint32_t size_;
  std::string structs_, text_;
  std::vector<Variable> payload_, light_, variables_;
  const bool nests_;  // closest-hit shaders wait for each other
  uint32_t hits_ = 1, misses_ = 1, traces_ = 0, calls_ = 0, nested_ = 0;
  int indent_ = 0, loops_ = 0, names_ = 0;
  bool has_function_ = false, in_function_ = false, in_hit_ = false;
};

}  // namespace raypool::shader
