// The parts of the built-in meeting room. Each function adds one thing at the builder's
// transform: y up, standing on y = 0, metres.
#pragma once

#include "scene/mesh_builder.hpp"

namespace raypool::room {

/// Material numbers of the room.
struct Palette {
  uint32_t wall, ceiling, oak, oak_dark, oak_light, rug, rug_border, table, table_edge, fabric, shell, chrome, plastic,
      shelf;
  uint32_t books[5];
  uint32_t leaf, leaf_light, soil, ceramic, terracotta, brass, glow, curtain, sky, frame, screen, paper, silver,
      porcelain, bottle, sofa, accent;
};
inline constexpr int kMaterials = 36;

/// Adds the materials: each one's reflectance is half its diffuse value.
Palette add_palette(MeshBuilder& mesh);

// room_furniture.cpp
void add_chair(MeshBuilder& mesh, const Palette& palette);                     ///< swivel chair, looks along z
void add_table(MeshBuilder& mesh, const Palette& palette);                     ///< long along x, top at 0.75
void add_bookshelf(MeshBuilder& mesh, const Palette& palette, uint64_t seed);  ///< 1.9 wide along x, back at z = 0
void add_sideboard(MeshBuilder& mesh, const Palette& palette);                 ///< 2.0 wide along x, back at z = 0
void add_sofa(MeshBuilder& mesh, const Palette& palette);                      ///< 2.0 wide along x, looks along z

// room_decor.cpp
void add_pendant(MeshBuilder& mesh, const Palette& palette, double cord);  ///< hangs from y = 0 downwards
void add_floor_lamp(MeshBuilder& mesh, const Palette& palette);
void add_plant(MeshBuilder& mesh, const Palette& palette, uint64_t seed, int leaves, double height, uint32_t pot);
void add_curtain(MeshBuilder& mesh, const Palette& palette, double width, double height,
                 double phase);                                                           ///< hangs in the plane z = 0
void add_window(MeshBuilder& mesh, const Palette& palette, double width, double height);  ///< in the plane z = 0
void add_screen(MeshBuilder& mesh, const Palette& palette);                               ///< 2.4 x 1.35, centre at 0
void add_painting(MeshBuilder& mesh, const Palette& palette, double width, double height);  ///< centre at 0
void add_clock(MeshBuilder& mesh, const Palette& palette);                                  ///< centre at 0
void add_knot(MeshBuilder& mesh, const Palette& palette);                                   ///< sculpture on a plinth
void add_radiator(MeshBuilder& mesh, const Palette& palette, double width);

// room_tableware.cpp
void add_cup(MeshBuilder& mesh, const Palette& palette);
void add_carafe(MeshBuilder& mesh, const Palette& palette);
void add_bowl(MeshBuilder& mesh, const Palette& palette);  ///< with fruit
void add_laptop(MeshBuilder& mesh, const Palette& palette);
void add_papers(MeshBuilder& mesh, const Palette& palette, uint64_t seed);
void add_vase(MeshBuilder& mesh, const Palette& palette);

}  // namespace raypool::room
