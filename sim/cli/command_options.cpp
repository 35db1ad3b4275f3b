#include "cli/command_options.hpp"

#include "scene/native_renderer.hpp"

namespace raypool {

CLI::Option* add_set(CLI::App& app, std::vector<std::string>& set) {
  return app
      .add_option("--set", set, "change a field of the configuration, alus.flt.count=2 or chip.ray_pool.size=256")
      ->type_name("FIELD=VALUE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_config(CLI::App& app, std::string& config, std::vector<std::string>& set) {
  app.add_option("--config", config, "machine: a name in configs/, NwMc (N warps, M lanes) or a JSON file")
      ->capture_default_str();
  add_set(app, set);
}

void add_threads(CLI::App& app, uint32_t& threads, const std::string& whose) {
  app.add_option("--threads", threads, whose + " (default: as many as the machine has cores)")
      ->check(CLI::Range(1u, kMostRenderThreads));
}

void add_scene(CLI::App& app, std::string& scene, std::string& size, std::string& view, ViewWords& look,
               double& detail) {
  app.add_option("--scene,scene", scene, "cornell, room, or the path of a .obj, .gltf, .glb or .ply file")
      ->capture_default_str();
  app.add_option("--size", size, "image, WIDTHxHEIGHT in pixels, 1 to 16384 each")->capture_default_str();
  app.add_option("--view", view, "JSON file with camera and light (default: the scene's own, or framed automatically)");
  app.add_option("--camera", look.camera, "camera of a glTF file, by its name or its node's (default: the first one)");
  app.add_option("--eye", look.eye, "place of the camera, x,y,z (default, as of the next four: the view's)");
  app.add_option("--look-at", look.look_at, "point in the middle of the picture, x,y,z");
  app.add_option("--up", look.up, "upwards, x,y,z");
  app.add_option("--fov", look.fov, "vertical field of view, degrees, 1 to 170");
  app.add_option("--light", look.light, "place of the light, x,y,z");
  app.add_option("--detail", detail, "triangles of a built-in scene, 0.01 to 16, 1 = as designed")
      ->capture_default_str();
}

void add_units_and_depth(CLI::App& app, int& units, int& depth) {
  app.add_option("--units", units, "compute units: 1, 2 or 4")->capture_default_str();
  app.add_option("--depth", depth, "1: eye and shadow rays only; up to 254: with reflections")->capture_default_str();
}

CLI::Option* add_engine(CLI::App& app, std::string& engine, std::string& library) {
  app.add_option("--unit-library", library, "Verilated unit (default: where raypool unit builds it)");
  return app
      .add_option("--engine", engine,
                  "what plays the machine; native, the kernels as C++, and sampled are for sim only")
      ->type_name("native|functional|sampled|model|rtl|lockstep")
      ->capture_default_str();
}

void add_inspect(CLI::App& app, uint64_t& until) {
  app.add_option("--inspect", until,
                 "lockstep: look inside the RTL up to this cycle, in which an earlier run met a difference; that run "
                 "does it by itself")
      ->type_name("CYCLE")
      ->check(CLI::PositiveNumber);
}

}  // namespace raypool
