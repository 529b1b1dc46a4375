// Pieces of furniture. Each function adds its piece in the builder's current frame, in metres. x runs along the wall
// with the piece centred at x = 0, y from the wall (0) into the room, z up from the floor.
#pragma once

#include "synth/mesh_builder.h"
#include "synth/room_style.h"

namespace aligngs {

// furniture_bed.cpp
void add_bed(MeshBuilder& b, const RoomStyle& s, double width, double length);
void add_nightstand(MeshBuilder& b, const RoomStyle& s, double width);

// furniture_seating.cpp
void add_sofa(MeshBuilder& b, const RoomStyle& s, double width);
void add_armchair(MeshBuilder& b, const RoomStyle& s);
void add_chair(MeshBuilder& b, const RoomStyle& s);         ///< back at y = 0, seat towards +y
void add_swivel_chair(MeshBuilder& b, const RoomStyle& s);  ///< back at y = 0, seat towards +y
void add_stool(MeshBuilder& b, const RoomStyle& s);
void add_ottoman(MeshBuilder& b, const RoomStyle& s);

// furniture_tables.cpp
void add_table(MeshBuilder& b, const RoomStyle& s, double width, double depth);  ///< dining table, with a setting
void add_coffee_table(MeshBuilder& b, const RoomStyle& s, double width, double depth);
void add_desk(MeshBuilder& b, const RoomStyle& s, double width, bool computer);

// furniture_storage.cpp
void add_wardrobe(MeshBuilder& b, const RoomStyle& s, double width);
void add_chest_of_drawers(MeshBuilder& b, const RoomStyle& s, double width);
void add_bookcase(MeshBuilder& b, const RoomStyle& s, double width, double height);
void add_wall_shelf(MeshBuilder& b, const RoomStyle& s, double width, double z);
void add_tv_stand(MeshBuilder& b, const RoomStyle& s, double width);
void add_cabinet(MeshBuilder& b, const RoomStyle& s, double width, double height);
/// A row of books standing on z, from x0 to x1, backs at `front_y` (towards the room).
void add_books(MeshBuilder& b, double x0, double x1, double z, double front_y, double max_height);

// furniture_kitchen.cpp The whole kitchen run along a wall of the given length, from left to right: cupboards, sink,
/// stove with hood, refrigerator. Wall cupboards are above except over [window_low, window_high] (same x).
void add_kitchen_run(MeshBuilder& b, const RoomStyle& s, double length, double window_low, double window_high);

// furniture_decor.cpp
void add_table_lamp(MeshBuilder& b, const RoomStyle& s, double z, double brightness);
void add_floor_lamp(MeshBuilder& b, const RoomStyle& s, double brightness);
void add_ceiling_light(MeshBuilder& b, const RoomStyle& s, double ceiling, double brightness);
void add_pendant(MeshBuilder& b, const RoomStyle& s, double ceiling, double z, double brightness);
void add_plant(MeshBuilder& b, const RoomStyle& s, double height);
void add_vase(MeshBuilder& b, const RoomStyle& s, double z);
void add_rug(MeshBuilder& b, const RoomStyle& s, double width, double depth);  ///< centred in x and y
void add_painting(MeshBuilder& b, const RoomStyle& s, double width, double height, double z_centre);
void add_clock(MeshBuilder& b, const RoomStyle& s, double z_centre);
void add_bulletin_board(MeshBuilder& b, const RoomStyle& s, double width, double height, double z_centre);
void add_basket(MeshBuilder& b, const RoomStyle& s);
void add_waste_bin(MeshBuilder& b, const RoomStyle& s);
void add_radiator(MeshBuilder& b, const RoomStyle& s, double width);
/// Two curtains left and right of a window and their rail. `opening` is the half width left free.
void add_curtains(MeshBuilder& b, const RoomStyle& s, double opening, double bundle, double top, double bottom);
void add_box_pile(MeshBuilder& b, const RoomStyle& s);

}  // namespace aligngs
