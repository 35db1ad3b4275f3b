// An intersector of your own on a corpus of hard rays (docs/use/referee.md), without building raypool:
//   g++ -O2 -std=c++17 intersect.cpp -o intersect && ./intersect corpus.jsonl answers.jsonl
// Replace meet(), which is Moeller and Trumbore's test in double.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
using Json = nlohmann::json;
using Vector = std::array<double, 3>;

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
float number(const Json& text) { return std::strtof(text.get<std::string>().c_str(), nullptr); }
Vector vector(const Json& json) { return {number(json[0]), number(json[1]), number(json[2])}; }

/// t where the ray meets the triangle, or -1.
double meet(const Vector& origin, const Vector& direction, const Json& triangle) {
  const Vector a = vector(triangle[0]), edge1 = minus(vector(triangle[1]), a), edge2 = minus(vector(triangle[2]), a);
  const Vector p = cross(direction, edge2), from = minus(origin, a), q = cross(from, edge1);
  const double determinant = dot(edge1, p), u = dot(from, p) / determinant, v = dot(direction, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 ? dot(edge2, q) / determinant : -1;
}

int main(int, char** argv) {
  std::ifstream corpus(argv[1]);
  std::ofstream answers(argv[2]);
  int cases = 0, falsely = 0, lost = 0, wrong = 0;
  for (std::string line; std::getline(corpus, line); ++cases) {
    const Json hard = Json::parse(line);
    const Vector origin = vector(hard["origin"]), direction = vector(hard["direction"]);
    float best = number(hard["limit"]);
    Json answer = {{"case", cases}, {"hit", false}};
    for (size_t i = 0; i < hard["triangles"].size(); ++i) {
      const auto t = static_cast<float>(meet(origin, direction, hard["triangles"][i]));
      if (!(t > 0 && t < best)) continue;
      best = t;
      char text[32];
      std::snprintf(text, sizeof text, "%a", static_cast<double>(t));
      answer = {{"case", cases}, {"hit", true}, {"triangle", i}, {"t", text}};
    }
    answers << answer << '\n';
    const Json& allowed = hard["allowed"];
    const bool hit = answer["hit"].get<bool>();
    if (!hit) lost += !hard["miss"].get<bool>();
    if (hit && allowed.empty()) ++falsely;
    if (hit && !allowed.empty()) wrong += std::count(allowed.begin(), allowed.end(), answer["triangle"]) == 0;
  }
  std::printf("%d cases: %d false, %d lost, %d wrong\n", cases, falsely, lost, wrong);
}
