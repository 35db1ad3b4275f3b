#include "trace/machine_trace.hpp"

#include <fmt/format.h>

#include <charconv>
#include <iterator>

#include "isa/encoding.hpp"
#include "isa/input_error.hpp"

namespace raypool::trace {

namespace {

constexpr uint64_t kMostFrom = 1'000'000'000'000'000;

/// The whole text is a number up to `most`.
bool number(std::string_view text, uint64_t most, uint64_t& value) {
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  return error == std::errc() && end == text.end() && value <= most;
}

bool parse_pixel(std::string_view text, Window& window) {
  const size_t comma = text.find(','), colon = std::min(text.find(':'), text.size());
  uint64_t x = 0, y = 0;
  if (comma > colon || !number(text.substr(0, comma), 0xffff, x) ||
      !number(text.substr(comma + 1, colon - comma - 1), 0xffff, y)) {
    return false;
  }
  window.pixel = static_cast<uint32_t>(y << 16 | x);
  return colon == text.size() || number(text.substr(colon + 1), kMostCycles, window.cycles);
}

bool parse_cycles(std::string_view text, Window& window) {
  const size_t colon = std::min(text.find(':'), text.size());
  const std::string_view from = text.substr(0, colon);
  if (!from.empty() && !number(from, kMostFrom, window.from)) return false;
  return colon >= text.size() - 1 || number(text.substr(colon + 1), kMostCycles, window.cycles);
}

}  // namespace

Window parse_window(const std::string& text) {
  static constexpr std::string_view kPixelWord = "pixel:";
  Window window;
  const bool pixel = text.rfind(kPixelWord, 0) == 0;
  const bool fits = !text.empty() && (pixel ? parse_pixel(std::string_view(text).substr(kPixelWord.size()), window)
                                            : parse_cycles(text, window));
  if (!fits || window.cycles == 0) {
    throw InputError(
        fmt::format("--trace {}: a window is FROM:CYCLES, such as 0:20000, or pixel:X,Y:CYCLES, and has 1 to {} cycles",
                    text, kMostCycles));
  }
  return window;
}

const InstructionInfo& info_of(const InstructionSpan& span) { return *unpack(span.encoding).info; }

std::string MachineTrace::kernel_of(uint32_t pc) const {
  const auto behind = kernels.upper_bound(pc);
  return behind == kernels.begin() ? "" : std::prev(behind)->second;
}

}  // namespace raypool::trace
