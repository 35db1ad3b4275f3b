#include "tools/picture_comparison.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "files/input_file.hpp"
#include "files/output_files.hpp"
#include "isa/input_error.hpp"
#include "scene/image.hpp"
#include "scene/picture_file.hpp"
#include "scene/pixel_decisions.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json not_compared(const std::string& reason, const std::string& map) {
  if (!map.empty()) throw InputError(fmt::format("--map {}: {}", map, reason));
  return {{"compared", false}, {"reason", reason}};
}

std::string beside(const Report& report, const char* file) {
  return (fs::path(report.path).parent_path() / file).string();
}

/// What the rays of a report's frame have come to, where it has been left.
std::optional<PixelDecisions> decisions_of(const Report& report) {
  const std::string path = beside(report, "decisions.bin");
  std::error_code none;
  if (!fs::exists(path, none)) return {};
  return PixelDecisions::from_bytes(read_text_file(path, "what rays have come to"), path);
}

/// The first picture in grey, and where the second differs a colour for the cause.
std::vector<uint8_t> map_of(const Picture& first, const std::vector<std::optional<PixelCause>>& causes) {
  constexpr std::array<std::array<uint8_t, 3>, kPixelCauses> kColours = {
      {{255, 40, 40}, {60, 120, 255}, {255, 220, 0}}};
  std::vector<uint8_t> map(first.rgb.size());
  for (size_t pixel = 0; pixel < causes.size(); ++pixel) {
    const int grey = (first.rgb[3 * pixel] + first.rgb[3 * pixel + 1] + first.rgb[3 * pixel + 2]) / 6;
    for (size_t channel = 0; channel < 3; ++channel)
      map[3 * pixel + channel] =
          causes[pixel] ? kColours[static_cast<size_t>(*causes[pixel])][channel] : static_cast<uint8_t>(grey);
  }
  return encode_png(static_cast<uint32_t>(first.width), static_cast<uint32_t>(first.height), map);
}

/// Adds to `json` how many pixels differ for which cause, if both frames have left what that takes. Throws InputError
/// when `map` is wanted and they have not.
void add_causes(Json& json, const Report& a, const Report& b, Picture first, Picture second, const std::string& map) {
  std::optional<PixelDecisions> of_a = decisions_of(a), of_b = decisions_of(b);
  if (!of_a || !of_b) {
    if (map.empty()) return;
    throw InputError(fmt::format(
        "there is no {}, and so no cause of a pixel's difference: draw both with --engine native --precision single or "
        "double (all engines draw the picture that native draws)",
        beside(of_a ? b : a, "decisions.bin")));
  }
  const auto fits = [&](const PixelDecisions& decisions) {
    return static_cast<int>(decisions.width()) == first.width && static_cast<int>(decisions.height()) == first.height;
  };
  if (!fits(*of_a) || !fits(*of_b))
    throw InputError(
        fmt::format("{}: not of the picture beside it: draw it again", beside(fits(*of_a) ? b : a, "decisions.bin")));
  const DecidedPicture one = {std::move(first), std::move(*of_a)}, other = {std::move(second), std::move(*of_b)};
  const std::vector<std::optional<PixelCause>> causes = causes_of(one, other);
  const std::array<uint64_t, kPixelCauses> count = count_causes(causes);
  for (size_t cause = 0; cause < kPixelCauses; ++cause) json["causes"][kPixelCauseNames[cause]] = count[cause];
  if (map.empty()) return;
  const std::vector<uint8_t> png = map_of(one.picture, causes);
  write_file(map, std::string(png.begin(), png.end()));
}

}  // namespace

Json compare_pictures(const Report& a, const Report& b, const std::string& map) {
  const auto path = [](const Report& report) { return beside(report, "image.png"); };
  for (const Report* report : {&a, &b}) {
    std::error_code none;
    if (!fs::exists(path(*report), none)) return not_compared(fmt::format("there is no {}", path(*report)), map);
  }
  Picture first = read_png(path(a)), second = read_png(path(b));
  if (first.width != second.width || first.height != second.height)
    return not_compared("the pictures have different sizes", map);
  const PictureDifference difference = difference_of(first, second);
  Json json = {{"compared", true},
               {"pixels", difference.pixels},
               {"differ", difference.differ},
               {"off_by_more", difference.share_off()},
               {"largest_difference", difference.largest},
               {"mean_difference", difference.mean},
               {"psnr", std::isfinite(difference.psnr) ? Json(difference.psnr) : Json()}};
  add_causes(json, a, b, std::move(first), std::move(second), map);
  return json;
}

}  // namespace raypool
