#include "shader/glsl.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "config/data_folder.hpp"
#include "files/input_file.hpp"
#include "isa/input_error.hpp"

namespace raypool::shader {
namespace {

namespace fs = std::filesystem;

/// A folder that goes when this does.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "raypool-shader-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw InputError(fmt::format("{}: {}: set TMPDIR to a folder that can be written", name, std::strerror(errno)));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

struct Finished {
  int code = 0;
  std::string output;  // of both streams
};

Finished run(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += quoted(word) + " ";
  FILE* pipe = popen((command + "2>&1").c_str(), "r");
  if (pipe == nullptr) throw InputError(fmt::format("{}: {}", words[0], std::strerror(errno)));
  Finished result;
  std::array<char, 4096> part;
  for (size_t got = fread(part.data(), 1, part.size(), pipe); got > 0; got = fread(part.data(), 1, part.size(), pipe))
    result.output.append(part.data(), got);
  const int status = pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  constexpr int kNotFound = 127;
  if (result.code == kNotFound) {
    throw InputError(fmt::format("{} is missing: install Debian's {} (scripts/setup.sh sim)", words[0],
                                 words[0] == "glslangValidator" ? "glslang-tools" : "spirv-tools"));
  }
  return result;
}

/// The first line that reports an error, with the place in front: "file:line: what".
std::string first_error(const std::string& output, const std::string& path) {
  std::istringstream lines(output);
  std::string line;
  const std::string mark = "ERROR: ";
  while (std::getline(lines, line)) {
    if (line.rfind(mark, 0) != 0) continue;
    line = line.substr(mark.size());
    // What has recursed stands in the line below.
    if (std::string more; !line.empty() && line.back() == ':' && std::getline(lines, more))
      line += " " + more.substr(std::min(more.size(), more.find_first_not_of(' ')));
    return line.rfind(path, 0) == 0 ? line : path + ": " + line;
  }
  std::istringstream again(output);
  while (std::getline(again, line))
    if (!line.empty() && line != path) return path + ": " + line;
  return path + ": it cannot be compiled";
}

std::vector<uint32_t> words_of(const std::string& bytes, const std::string& path) {
  if (bytes.empty() || bytes.size() % 4 != 0)
    throw InputError(fmt::format("{}: {} bytes are not SPIR-V, which has words of 4", path, bytes.size()));
  std::vector<uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

}  // namespace

std::vector<uint32_t> spirv_of(const std::string& path) {
  const std::string text = read_file(path, "shader");
  const ScratchFolder scratch;
  std::string compiled = path;
  if (fs::path(path).extension() != ".spv") {
    compiled = scratch.file("compiled.spv");
    const Finished result = run({"glslangValidator", "-V", "--target-env", "vulkan1.2", "-g",
                                 "-I" + (fs::path(path).parent_path() / ".").string(),
                                 "-I" + (fs::path(data_folder()) / "shaders").string(), "-o", compiled, path});
    if (result.code != 0) throw InputError(first_error(result.output, path));
  } else {
    words_of(text, path);
  }
  const std::string optimised = scratch.file("optimised.spv");
  const Finished result =
      run({"spirv-opt", "--target-env=vulkan1.2", "--scalar-block-layout", "-O", compiled, "-o", optimised});
  if (result.code != 0)
    throw InputError(
        fmt::format("{}: spirv-opt refuses it: {}", path, result.output.substr(0, result.output.find('\n'))));
  return words_of(read_file(optimised, "SPIR-V"), path);
}

}  // namespace raypool::shader
