#include "cosim/program_file.hpp"

#include <fmt/format.h>

#include "cosim/program_check.hpp"
#include "enum_array.hpp"
#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "isa/assembler.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr int kFaultCodes = 8;
constexpr EnumArray<ImportKind, std::string_view, kImportKinds> kImportNames = {"none", "normal", "shadow", "direct"};

template <typename Names>
size_t number_of(const Names& names, const std::string& name) {
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  throw InputError("unknown name '" + name + "'");
}

uint32_t hex_word(const Json& json) {
  size_t used = 0;
  const std::string text = json.get<std::string>();
  const unsigned long value = std::stoul(text, &used, 16);
  if (used != text.size() || value > 0xffffffffu) throw InputError("'" + text + "' is no word of 8 hexadecimal digits");
  return static_cast<uint32_t>(value);
}

std::string hex(uint32_t value) { return fmt::format("{:08x}", value); }

// Older files have one fault, 0 for none.
uint32_t faults_of(const Json& json) {
  uint32_t faults = 0;
  for (const Json& code : json.contains("fault") ? Json::array({json.at("fault")}) : json.at("faults")) {
    const int number = code.get<int>();
    if (number < 0 || number >= kFaultCodes) throw InputError(fmt::format("there is no fault {}", number));
    if (number != 0) faults |= fault_bit(static_cast<FaultCode>(number));
  }
  return faults;
}

uint32_t number_in(const std::string& key) {
  size_t used = 0;
  const unsigned long value = std::stoul(key, &used);
  if (used != key.size() || value > 0xffff)
    throw InputError("'" + key + "' is not the number of an instruction or argument");
  return static_cast<uint32_t>(value);
}

Json to_json(const Rewrite& rewrite) {
  Json json = {{"code", Json::object()}, {"data_seed", rewrite.data_seed}, {"arguments", Json::object()}};
  for (const auto& [pc, instruction] : rewrite.code) json["code"][std::to_string(pc)] = disassemble(instruction);
  for (const auto& [number, value] : rewrite.arguments) json["arguments"][std::to_string(number)] = hex(value);
  return json;
}

Rewrite rewrite_of(const Json& json) {
  Rewrite rewrite;
  for (const auto& [pc, line] : json.at("code").items())
    rewrite.code[number_in(pc)] = assemble(line.get<std::string>() + "\n", "rewrite").code.at(0);
  rewrite.data_seed = json.at("data_seed").get<uint64_t>();
  for (const auto& [number, value] : json.at("arguments").items())
    rewrite.arguments[number_in(number)] = hex_word(value);
  return rewrite;
}

}  // namespace

std::string to_json(const SavedProgram& saved) {
  const RandomProgram& program = saved.program;
  Json json;
  json["format"] = kFormat;
  json["note"] = saved.note;
  json["configuration"] = Json::parse(to_json(saved.configuration));
  json["units"] = program.units;
  json["seed"] = program.seed;
  json["profile"] = program.profile;
  json["faults"] = Json::array();
  for (int code = 1; code < kFaultCodes; ++code)
    if ((program.faults & fault_bit(static_cast<FaultCode>(code))) != 0) json["faults"].push_back(code);
  json["data_begin"] = program.data_begin;
  json["memory_bytes"] = program.memory_bytes;
  json["program_length"] = program.program_length;
  json["memory_limit"] = program.memory_limit;
  json["restart"] = program.restart;
  for (const uint32_t argument : program.arguments) json["arguments"].push_back(hex(argument));
  for (size_t port = 0; port < kPorts; ++port)
    json["stalls"][std::string(kPortNames[port])] = kStallStyleNames[program.stalls.styles[port]];
  json["kernels"] = Json::array();
  for (const RandomProgram::Kernel& kernel : program.kernels) {
    json["kernels"].push_back({{"pc", kernel.pc},
                               {"threads", kernel.threads},
                               {"block", hex(kernel.block)},
                               {"blocks", hex(kernel.blocks)},
                               {"import", kImportNames[kernel.import]}});
    if (kernel.rewrite) json["kernels"].back()["rewrite"] = to_json(*kernel.rewrite);
  }
  json["code"] = Json::array();
  for (const uint64_t instruction : program.program.code) json["code"].push_back(disassemble(instruction));
  return to_text(json, 1) + "\n";
}

SavedProgram parse_saved_program(const std::string& text, const std::string& where, bool check) {
  SavedProgram saved;
  RandomProgram& program = saved.program;
  const Json json = parse_json(text, where);
  try {
    if (json.at("format").get<int>() != kFormat) throw InputError("its format is not " + std::to_string(kFormat));
    saved.note = json.at("note").get<std::string>();
    saved.configuration = parse_configuration(json.at("configuration").dump(), where);
    program.units = json.at("units").get<int>();
    program.intersection_words = saved.configuration.intersection_words;
    program.seed = json.at("seed").get<uint64_t>();
    program.profile = json.at("profile").get<std::string>();
    program.faults = faults_of(json);
    program.data_begin = json.at("data_begin").get<uint32_t>();
    program.memory_bytes = json.at("memory_bytes").get<uint32_t>();
    // Older files lack what follows, and mean exact limits, no restart and as many blocks as launches.
    program.program_length = json.value("program_length", 0u);
    program.memory_limit = json.value("memory_limit", 0u);
    program.restart = json.value("restart", 0u);
    for (size_t i = 0; i < program.arguments.size(); ++i) program.arguments[i] = hex_word(json.at("arguments").at(i));
    for (size_t port = 0; port < kPorts; ++port) {
      const std::string style = json.at("stalls").at(std::string(kPortNames[port])).get<std::string>();
      program.stalls.styles[port] = static_cast<StallStyle>(number_of(kStallStyleNames, style));
    }
    const std::string launches = hex(static_cast<uint32_t>(json.at("kernels").size()));
    for (const Json& kernel : json.at("kernels")) {
      program.kernels.push_back(
          {kernel.at("threads").get<uint32_t>(), hex_word(kernel.at("block")),
           static_cast<ImportKind>(number_of(kImportNames, kernel.at("import").get<std::string>())),
           kernel.at("pc").get<uint32_t>(), hex_word(kernel.value("blocks", launches))});
      if (kernel.contains("rewrite")) program.kernels.back().rewrite = rewrite_of(kernel.at("rewrite"));
    }
    std::string code;
    for (const Json& line : json.at("code")) code += line.get<std::string>() + "\n";
    program.program.code = assemble(code, "code").code;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: not a saved program: {}", where, json_reason(error)));
  }
  if (program.data_begin < program.program.code.size() * 8 || program.data_begin > program.memory_bytes ||
      program.memory_bytes > 64u << 20) {
    throw InputError(
        fmt::format("{}: data_begin {} and memory_bytes {} do not fit the code of {} instructions (and 64 MB)", where,
                    program.data_begin, program.memory_bytes, program.program.code.size()));
  }
  fill_memory(program);
  if (!check) return saved;
  const std::string problem = check_program(saved.configuration, program);
  if (!problem.empty()) throw InputError(fmt::format("{}: the program is not a valid one: {}", where, problem));
  return saved;
}

SavedProgram load_saved_program(const std::string& path, bool check) {
  return parse_saved_program(read_text_file(path, "saved program"), path, check);
}

}  // namespace raypool
