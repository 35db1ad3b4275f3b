#include "cli/command_options.hpp"

#include "cli/commands.hpp"
#include "cli/help.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {

CLI::Option* add_set(CLI::App& app, std::vector<std::string>& set) {
  return app.add_option("--set", set, "change a field of the configuration: chip.ray_pool.size=256")
      ->type_name("FIELD=VALUE")
      ->group(option_group::kMachine)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_config(CLI::App& app, std::string& config, std::vector<std::string>& set) {
  app.add_option("--config", config, "a name in configs/, NwMc (N warps, M lanes), a JSON file")
      ->type_name("NAME")
      ->group(option_group::kMachine)
      ->capture_default_str();
  add_set(app, set);
}

CLI::Option* add_threads(CLI::App& app, uint32_t& threads, const std::string& whose) {
  return app.add_option("--threads", threads, whose + ", 1 to 256 (default: one per core)")
      ->check(CLI::Range(1u, kMostRenderThreads));
}

void add_scene(CLI::App& app, std::string& scene, std::string& size, std::string& view, ViewWords& look,
               double& detail) {
  const auto add = [&app](const char* name, auto& value, const char* type, const char* what) {
    return app.add_option(name, value, what)->type_name(type)->group(option_group::kScene);
  };
  add("--scene,scene", scene, "SCENE", "cornell, room, or a .obj, .gltf, .glb or .ply file")->capture_default_str();
  add("--size", size, "WxH", "width and height in pixels, 1 to 16384 each")->capture_default_str();
  add("--view", view, "FILE", "camera and light, JSON (default: the scene's, or automatic)");
  add("--camera", look.camera, "NAME", "glTF: which camera, by its name or its node's (default: the first)");
  add("--eye", look.eye, "X,Y,Z", "camera position (default, also of the next four: the view's)");
  add("--look-at", look.look_at, "X,Y,Z", "point in the middle of the picture");
  add("--up", look.up, "X,Y,Z", "up direction");
  add("--fov", look.fov, "DEGREES", "vertical field of view, 1 to 170");
  add("--light", look.light, "X,Y,Z", "light position");
  add("--detail", detail, "N", "triangles of a built-in scene, 0.01 to 16 times as designed")->capture_default_str();
}

void add_shaders(CLI::App& app, std::string& shaders) {
  app.add_option("--shaders", shaders,
                 "a folder with GLSL shaders (.rgen, .rchit, .rmiss, .rahit) that draw in place of the built-in "
                 "kernels")
      ->type_name("FOLDER")
      ->group(option_group::kScene);
}

void add_samples(CLI::App& app, int& samples) {
  app.add_option("--samples", samples,
                 "with --shaders: frames that add up to the picture, each with its number; the shaders weigh them")
      ->group(option_group::kScene)
      ->check(CLI::Range(1, kMostSamples))
      ->capture_default_str();
}

void add_depth(CLI::App& app, int& depth) {
  app.add_option("--depth", depth, "1: eye and shadow rays only; up to 254: with reflections")
      ->group(option_group::kScene)
      ->capture_default_str();
}

void add_units(CLI::App& app, int& units) {
  app.add_option("--units", units, "compute units: 1, 2 or 4")->group(option_group::kMachine)->capture_default_str();
}

void add_traverser(CLI::App& app, std::string& traverser) {
  app.add_option("--traverser", traverser, "as --set chip.traverser=NAME")
      ->type_name("NAME")
      ->group(option_group::kMachine);
}

void add_engine(CLI::App& app, std::string& engine, std::string& library, const std::string& names) {
  app.add_option("--engine", engine, "what simulates the machine")
      ->type_name(names)
      ->group(option_group::kEngine)
      ->capture_default_str();
  app.add_option("--unit-library", library, "rtl, lockstep: Verilated unit (default: where raypool unit builds it)")
      ->type_name("FILE")
      ->group(option_group::kEngine);
}

void add_inspect(CLI::App& app, uint64_t& until) {
  app.add_option(
         "--inspect", until,
         "lockstep: inspect the RTL up to this cycle, in which an earlier run differed (that run does so by itself)")
      ->type_name("CYCLE")
      ->group(option_group::kEngine)
      ->check(CLI::PositiveNumber);
}

}  // namespace raypool
