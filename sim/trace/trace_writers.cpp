// The formats in which other programs open a trace.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "isa/assembler.hpp"
#include "trace/machine_trace.hpp"

namespace raypool::trace {

namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, kPorts> kPortNames = {
    "kernels launched", "memory requests", "memory responses", "record requests", "records", "rays", "contributions"};
constexpr uint32_t kPortsProcess = 0;  // units are the processes behind it

std::string_view alu_of_span(const InstructionSpan& span) { return kAluNames[info_of(span).alu()]; }

/// Events, one a line.
class Events {
 public:
  void name(const char* what, uint32_t process, std::optional<uint32_t> thread, const std::string& text) {
    ordered_json event = {{"ph", "M"}, {"name", what}, {"pid", process}};
    if (thread) event["tid"] = *thread;
    event["args"] = {{"name", text}};
    add(event);
  }
  /// Spans of one track lie behind or within each other.
  void span(uint32_t process, uint32_t thread, uint64_t from, uint64_t to, std::string_view text,
            const ordered_json& arguments = {}) {
    if (to <= from) return;
    ordered_json event = {{"ph", "X"},     {"name", text}, {"pid", process},
                          {"tid", thread}, {"ts", from},   {"dur", to - from}};
    if (!arguments.is_null()) event["args"] = arguments;
    add(event);
  }
  const std::string& text() const { return text_; }

 private:
  void add(const ordered_json& event) { text_ += (text_.empty() ? "" : ",\n") + event.dump(); }
  std::string text_;
};

/// A warp's instructions with what they waited for, in their kernels.
void add_warp(const MachineTrace& trace, const std::vector<const InstructionSpan*>& spans, Events& events) {
  for (size_t first = 0; first < spans.size();) {
    size_t last = first;
    while (last + 1 < spans.size() && info_of(*spans[last]).opcode != Opcode::Exit) ++last;
    const uint32_t process = 1 + spans[first]->unit, thread = spans[first]->warp;
    const std::string kernel = trace.kernel_of(spans[first]->pc);
    events.span(process, thread, spans[first]->wanted, spans[last]->retired, kernel.empty() ? "kernel" : kernel);
    uint64_t before = 0;
    for (size_t i = first; i <= last; ++i) {
      const InstructionSpan& span = *spans[i];
      events.span(process, thread, std::max(before, span.wanted), span.issued, "fetch");
      events.span(process, thread, span.issued, span.retired, alu_of_span(span),
                  {{"instruction", disassemble(span.encoding)},
                   {"pc", span.pc},
                   {"threads", span.threads},
                   {"wanted", span.wanted},
                   {"granted", span.granted}});
      events.span(process, thread, span.granted, span.retired, "executes");
      before = span.retired;
    }
    first = last + 1;
  }
}

}  // namespace

std::string to_trace_events(const MachineTrace& trace) {
  Events events;
  events.name("process_name", kPortsProcess, {}, "ports");
  for (uint32_t port = 0; port < kPorts; ++port)
    events.name("thread_name", kPortsProcess, port, std::string(kPortNames[port]));
  for (const Transfer& transfer : trace.transfers) {
    events.span(kPortsProcess, to_underlying(transfer.port), transfer.from, transfer.to,
                transfer.waits ? "waits" : transfer.what, {{"unit", transfer.unit}, {"what", transfer.what}});
  }
  for (uint32_t unit = 0; unit < trace.units; ++unit) {
    events.name("process_name", 1 + unit, {}, fmt::format("compute unit {}", unit));
    for (uint32_t warp = 0; warp < trace.warps; ++warp) {
      events.name("thread_name", 1 + unit, warp, fmt::format("warp {}", warp));
      std::vector<const InstructionSpan*> spans;
      for (const InstructionSpan& span : trace.instructions)
        if (span.unit == unit && span.warp == warp) spans.push_back(&span);
      add_warp(trace, spans, events);
    }
  }
  const ordered_json about = {{"configuration", trace.configuration},
                              {"units", trace.units},
                              {"warps", trace.warps},
                              {"lanes", trace.lanes},
                              {"from", trace.from},
                              {"to", trace.to},
                              {"unit of time", "a cycle is shown as a microsecond"}};
  return fmt::format("{{\"displayTimeUnit\": \"ns\",\n\"otherData\": {},\n\"traceEvents\": [\n{}\n]}}\n", about.dump(),
                     events.text());
}

std::string to_kanata(const MachineTrace& trace) {
  struct Command {
    uint64_t cycle;
    std::string text;
  };
  std::vector<Command> commands;
  std::vector<uint32_t> executed(size_t{trace.units} * trace.warps);  // [unit and warp]
  std::vector<const InstructionSpan*> spans;
  for (const InstructionSpan& span : trace.instructions) spans.push_back(&span);
  std::stable_sort(spans.begin(), spans.end(), [](const auto* a, const auto* b) { return a->wanted < b->wanted; });
  for (uint32_t id = 0; id < spans.size(); ++id) {
    const InstructionSpan& span = *spans[id];
    const uint32_t warp = span.unit * trace.warps + span.warp;
    commands.push_back({span.wanted, fmt::format("I\t{}\t{}\t{}\n", id, executed[warp]++, warp)});
    commands.push_back({span.wanted, fmt::format("L\t{}\t0\t{}: {}\n", id, span.pc, disassemble(span.encoding))});
    commands.push_back(
        {span.wanted, fmt::format("L\t{}\t1\tunit {}, warp {}, {} threads\n", id, span.unit, span.warp, span.threads)});
    commands.push_back({span.wanted, fmt::format("S\t{}\t0\tfetch\n", id)});
    commands.push_back({span.issued, fmt::format("S\t{}\t0\twait\n", id)});
    commands.push_back({span.granted, fmt::format("S\t{}\t0\t{}\n", id, alu_of_span(span))});
    commands.push_back({span.retired, fmt::format("R\t{}\t{}\t0\n", id, id)});
  }
  std::stable_sort(commands.begin(), commands.end(), [](const auto& a, const auto& b) { return a.cycle < b.cycle; });
  std::string text = fmt::format("Kanata\t0004\nC=\t{}\n", trace.from);
  uint64_t now = trace.from;
  for (const Command& command : commands) {
    if (command.cycle > now) text += fmt::format("C\t{}\n", command.cycle - now);
    now = std::max(now, command.cycle);
    text += command.text;
  }
  return text;
}

}  // namespace raypool::trace
