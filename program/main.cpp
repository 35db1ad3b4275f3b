// The program `raypool`: the commands of the machine and of its studies.
#include "cli/run_program.hpp"
#include "commands/study_commands.hpp"
#include "estimate/estimated_frame.hpp"
#include "sampled/sampled_frame.hpp"
#include "tools/machine_commands.hpp"

namespace raypool {
namespace {

Estimates estimated(const Configuration& configuration, uint32_t units, const Scene& scene, const MemoryImage& image,
                    const Tracer& tracer, const NativeOptions& native, const NativeStatistics& whole) {
  return estimate::estimate_frame(configuration, units,
                                  estimate::count_frame(configuration, scene, image, tracer, native, whole));
}

constexpr EstimatingEngines kEstimating = {sampled::kSampler, estimate::error_of, estimated};

struct Commands {
  Commands(CLI::App& app, const std::vector<std::string>& words, int& code)
      : machine(app, words, kEstimating, code), studies(app, words, code) {}
  MachineCommands machine;
  StudyCommands studies;
};

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  return raypool::run_program(
      argc, argv, [](CLI::App& app, const std::vector<std::string>& words, int& code) -> std::shared_ptr<void> {
        return std::make_shared<raypool::Commands>(app, words, code);
      });
}
