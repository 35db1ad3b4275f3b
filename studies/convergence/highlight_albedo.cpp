#include <array>
#include <cmath>

#include "convergence/microfacets.hpp"

namespace raypool::convergence {
namespace {

constexpr int kCosines = 96, kWidths = 48;  // intervals of the table
constexpr int kSlopes = 48;                 // and of what is integrated over, each way

/// By quadrature over the microfacets that a viewer at this cosine can see.
double integrated(double cosine, double roughness) {
  const Vec3d viewer{std::sqrt(1 - cosine * cosine), 0, cosine};
  const double width = highlight_width(roughness), square = width * width;
  double sum = 0;
  for (int i = 0; i < kSlopes; ++i) {
    const double place = (i + 0.5) / kSlopes;
    const double height = std::sqrt((1 - place) / (1 + (square - 1) * place));
    const double radius = std::sqrt(1 - height * height);
    for (int j = 0; j < kSlopes; ++j) {
      const double angle = kPi * (j + 0.5) / kSlopes;  // the other half is the same
      const double across = radius * std::cos(angle) * viewer.x + height * viewer.z;
      const double light = 2 * across * height - cosine;
      if (across <= 0 || light <= 0) continue;
      sum += fresnel({kDielectric, kDielectric, kDielectric}, across).x * microfacets_seen(light, width) *
             microfacets_seen(cosine, width) * across / (cosine * height);
    }
  }
  return sum / (kSlopes * kSlopes);
}

/// Close where it is steep: cosines grow with the square of their numbers.
class Table {
 public:
  Table() {
    for (int i = 0; i <= kCosines; ++i) {
      const double root = std::max(static_cast<double>(i) / kCosines, 0.01);
      for (int j = 0; j <= kWidths; ++j) values_[i][j] = integrated(root * root, static_cast<double>(j) / kWidths);
    }
  }
  double at(double cosine, double roughness) const {
    const double x = std::sqrt(cosine) * kCosines, y = roughness * kWidths;
    const int i = std::min(static_cast<int>(x), kCosines - 1), j = std::min(static_cast<int>(y), kWidths - 1);
    const double a = x - i, b = y - j;
    return (1 - a) * ((1 - b) * values_[i][j] + b * values_[i][j + 1]) +
           a * ((1 - b) * values_[i + 1][j] + b * values_[i + 1][j + 1]);
  }

 private:
  std::array<std::array<double, kWidths + 1>, kCosines + 1> values_;
};

}  // namespace

double highlight_albedo(double cosine, double roughness) {
  static const Table table;
  return table.at(cosine, roughness);
}

}  // namespace raypool::convergence
