#include "isa/did_you_mean.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <numeric>

namespace raypool {
namespace {

constexpr size_t kMostNames = 3;       // that a message asks for
constexpr size_t kLeastBeginning = 2;  // letters of a name that is cut short

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

}  // namespace

size_t spelling_distance(std::string_view a, std::string_view b) {
  // Rows of the table of prefixes of `a` against those of `b`: of the letter before the last, the last, and this one.
  std::vector<size_t> older, old, row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    older = std::move(old);
    old = row;
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({old[j - 1] + (a[i - 1] != b[j - 1]), old[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], older[j - 2] + 1);
    }
  }
  return row[b.size()];
}

bool is_misspelling(std::string_view given, size_t distance) {
  return distance < given.size() && distance <= std::max<size_t>(1, given.size() / 3);
}

std::vector<std::string> nearest_names(std::string_view given, const std::vector<std::string>& names) {
  const std::string wanted = lower(given);
  size_t least = SIZE_MAX;
  std::vector<std::string> nearest;
  for (const std::string& name : names) {
    const std::string other = lower(name);
    const size_t distance = spelling_distance(wanted, other);
    const bool cut_short = wanted.size() >= kLeastBeginning && other.compare(0, wanted.size(), wanted) == 0;
    if (distance > least || !(cut_short || is_misspelling(wanted, distance))) continue;
    if (distance < least) nearest.clear();
    least = distance;
    nearest.push_back(name);
  }
  return nearest;
}

std::string did_you_mean(const std::vector<std::string>& nearest, std::string_view advice) {
  if (nearest.empty()) return advice.empty() ? "" : fmt::format("; {}", advice);
  const size_t count = std::min(nearest.size(), kMostNames);
  std::string names = nearest[0];
  for (size_t i = 1; i < count; ++i) names += (i + 1 == count ? " or " : ", ") + nearest[i];
  return fmt::format(": did you mean {}?{}", names, advice.empty() ? "" : fmt::format(" ({})", advice));
}

std::string did_you_mean(std::string_view given, const std::vector<std::string>& names, std::string_view advice) {
  return did_you_mean(nearest_names(given, names), advice);
}

}  // namespace raypool
