#include "config/derived_files.hpp"

#include <utility>

#include "config/reference.hpp"
#include "files/input_file.hpp"
#include "files/output_files.hpp"
#include "isa/input_error.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

bool has_text(const std::filesystem::path& path, const std::string& text) {
  if (!std::filesystem::exists(path)) return false;
  std::string found = read_text_file(path.string(), "derived file");
  use_line_feeds(found);
  return found == text;
}

}  // namespace

std::vector<std::string> write_derived_files(const std::filesystem::path& root) {
  if (!std::filesystem::exists(root / "cpp_model/isa/isa.hpp"))
    throw InputError("there is no cpp_model/isa/isa.hpp here: write the derived files in the root of the checkout");
  std::vector<GeneratedFile> files = generated_files();
  for (GeneratedFile& file : generated_parameter_files()) files.push_back(std::move(file));
  std::vector<std::string> written;
  for (GeneratedFile& file : files) {
    if (has_text(root / file.path, file.text)) continue;
    write_file(root / file.path, file.text);
    written.push_back(std::move(file.path));
  }
  return written;
}

}  // namespace raypool
