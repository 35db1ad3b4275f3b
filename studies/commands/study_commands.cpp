#include "commands/study_commands.hpp"

#include "arith/narrow_float.hpp"
#include "cli/command_options.hpp"
#include "cli/help.hpp"
#include "machine/traverser/box_ray.hpp"

namespace raypool {
namespace {

void add_widths_command(CLI::App& app, WidthsOptions& options, uint32_t least, uint32_t most) {
  add_scene(app, options.scene, options.size, options.view, options.look, options.detail);
  app.add_option("--depth", options.depth, "of the rays")
      ->group(option_group::kScene)
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  app.add_option("--bits", options.bits, "widths, with commas between")
      ->delimiter(',')
      ->check(CLI::Range(least, most))
      ->capture_default_str();
  app.add_flag("--quiet", options.quiet, "no progress");
}

}  // namespace

StudyCommands::StudyCommands(CLI::App& app, const std::vector<std::string>& command, int& code)
    : app_(app), code_(code) {
  fit_.command = explore_.command = command;
  add_numerics_command();
  add_significands_command();
  add_widths_commands();
  add_referee_command();
  add_fit_command();
  add_explore_command();
}

CLI::App* StudyCommands::add(const std::string& name, const std::string& what) {
  return app_.add_subcommand(name, what)->group(command_group::kStudies);
}

void StudyCommands::add_numerics_command() {
  CLI::App* numerics_app = add("numerics", "compare arithmetic modes: pictures, cost, seams, offsets, hard cases");
  add_config(*numerics_app, numerics_.config, numerics_.set);
  numerics_app->add_option("--mode", numerics_.mode, "all, or one: ieee-exact, flush-newton1, ...")
      ->type_name("NAME")
      ->capture_default_str();
  add_scene(*numerics_app, numerics_.scene, numerics_.size, numerics_.view, numerics_.look, numerics_.detail);
  add_shaders(*numerics_app, numerics_.shaders);
  add_samples(*numerics_app, numerics_.samples);
  numerics_app->add_option("--depth", numerics_.depth, "of the pictures' rays")
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  numerics_app
      ->add_option("--out", numerics_.out,
                   "numerics.json and plots (default: out/numerics beside the program; installed: in raypool-out)")
      ->type_name("FOLDER");
  numerics_app->add_option("--synthesis", numerics_.synthesis, "synthesis reports (default: synth beside the program)")
      ->type_name("FOLDER");
  numerics_app->add_flag("--extremes", numerics_.extremes, "run the catalogue of hard cases, by mode and engine");
  numerics_app
      ->add_option("--boundary", numerics_.boundary,
                   "with --extremes: what is Verilog, units or small whole chips too; with --configurations: of which")
      ->type_name("unit|chip")
      ->capture_default_str();
  numerics_app->add_flag("--catalogue", numerics_.catalogue, "only list those cases, with what is expected");
  numerics_app->add_option("--configurations", numerics_.configurations, "only write a configuration file of each mode")
      ->type_name("FOLDER");
  numerics_app->add_flag("--quiet", numerics_.quiet, "no progress");
  numerics_app->callback([this, numerics_app] {
    for (const char* option :
         {"--scene", "--view", "--camera", "--eye", "--look-at", "--up", "--fov", "--light", "--detail", "--samples"})
      if (numerics_app->count(option) > 0) numerics_.option_of_shaders = option;
    code_ = numerics_command(numerics_);
  });
}

void StudyCommands::add_significands_command() {
  CLI::App* significands_app =
      add("significands", "draw a scene with floats of fewer bits: what changes, and how few bits are enough");
  add_scene(*significands_app, significands_.scene, significands_.size, significands_.view, significands_.look,
            significands_.detail);
  significands_app->add_option("--depth", significands_.depth, "of the picture's rays")
      ->group(option_group::kScene)
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  add_config(*significands_app, significands_.config, significands_.set);
  significands_app->add_flag("--quiet", significands_.quiet, "no progress");
  significands_app->callback([this] { code_ = significands_command(significands_); });
}

void StudyCommands::add_widths_commands() {
  CLI::App* boxes_app =
      add("boxes", "test boxes in integers of few bits: nodes and triangles that a scene's rays visit");
  add_widths_command(*boxes_app, boxes_, kLeastBoxBits, kMostBoxBits);
  boxes_app->callback([this] { code_ = boxes_command(boxes_); });
  CLI::App* triangles_app =
      add("triangles", "test triangles without double: a scene's hits and picture, seams, hard cases");
  add_widths_command(*triangles_app, triangles_, kLeastTimeBits, kMostTimeBits);
  triangles_app->callback([this] { code_ = triangles_command(triangles_); });
}

void StudyCommands::add_referee_command() {
  CLI::App* referee_app =
      add("referee", "compare hits of hard rays and triangles with rational numbers: ours, and files'");
  add_referee_options(*referee_app, referee_);
  referee_app->callback([this] { code_ = referee_command(referee_); });
}

void StudyCommands::add_fit_command() {
  CLI::App* fit_app = add("fit", "find what a scene needs of a machine; leaves a configuration with only that");
  add_scene(*fit_app, fit_.scene, fit_.size, fit_.view, fit_.look, fit_.detail);
  add_shaders(*fit_app, fit_.shaders);
  add_config(*fit_app, fit_.config, fit_.set);
  add_depth(*fit_app, fit_.depth);
  add_units(*fit_app, fit_.units);
  add_traverser(*fit_app, fit_.traverser);
  fit_app->add_option("--slower", fit_.slower, "more cycles that the fitted machine may take")
      ->type_name("PERCENT")
      ->capture_default_str();
  fit_app
      ->add_option("--out", fit_.out,
                   "the configuration (default: out/fit/NAME.json beside the program; installed: in raypool-out)")
      ->type_name("FILE")
      ->group(option_group::kOutput);
  fit_app->add_option("--json", fit_.json, "all that was found, JSON")->type_name("FILE")->group(option_group::kOutput);
  fit_app->add_flag("--quiet", fit_.quiet, "no progress");
  fit_app->callback([this] { code_ = fit_command(fit_); });
}

void StudyCommands::add_explore_command() {
  CLI::App* explore_app = add("explore", "find the fastest machines for their area, of thousands around one");
  add_scene(*explore_app, explore_.scene, explore_.size, explore_.view, explore_.look, explore_.detail);
  add_config(*explore_app, explore_.config, explore_.set);
  add_depth(*explore_app, explore_.depth);
  explore_app
      ->add_option("--vary", explore_.vary,
                   "values of a field, or of units: warps=4,8,16 (default: what docs/studies/explore.md lists)")
      ->type_name("FIELD=V,V");
  explore_app->add_option("--machines", explore_.machines, "as many at random where there are more combinations")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  explore_app->add_option("--seed", explore_.seed, "of their choice")->type_name("N")->capture_default_str();
  explore_app
      ->add_option("--deviations", explore_.deviations,
                   "standard deviations by which guesses and estimates may be too high")
      ->type_name("N")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  explore_app->add_option("--check", explore_.check, "simulate so many of the machines at random too")
      ->type_name("N")
      ->capture_default_str();
  explore_app->add_option("--areas", explore_.areas, "table of areas (default: the project's, of make areas)")
      ->type_name("FILE");
  explore_app
      ->add_option(
          "--out", explore_.out,
          "all machines, JSON (default: out/explore/explore.json beside the program; installed: in raypool-out)")
      ->type_name("FILE")
      ->group(option_group::kOutput);
  explore_app->add_flag("--quiet", explore_.quiet, "no progress");
  explore_app->callback([this] { code_ = explore_command(explore_); });
}

}  // namespace raypool
