#include "synth/room_style.h"

#include <vector>

namespace aligngs {
namespace {

struct Pair {
  int a[3], b[3];
};

Material make(TextureKind kind, const int (&a)[3], const int (&b)[3], float scale, Random& random) {
  Material m;
  m.kind = kind;
  m.a = linear_rgb(a[0], a[1], a[2]);
  m.b = linear_rgb(b[0], b[1], b[2]);
  m.c = (m.a + m.b) * 0.5f;
  m.scale = scale;
  m.seed = static_cast<uint32_t>(random.next());
  return m;
}

Material plain(int r, int g, int b, float gloss = 0) {
  Material m;
  m.a = linear_rgb(r, g, b);
  m.gloss = gloss;
  return m;
}

const Pair& pick(const std::vector<Pair>& list, Random& random) {
  return list[static_cast<size_t>(random.below(static_cast<int>(list.size())))];
}

Material wood_of(Random& random, float gloss) {
  static const std::vector<Pair> kWoods = {{{205, 170, 125}, {160, 118, 75}}, {{150, 100, 62}, {98, 60, 34}},
                                           {{110, 72, 48}, {66, 40, 26}},     {{222, 196, 158}, {186, 152, 108}},
                                           {{176, 112, 64}, {124, 70, 36}},   {{130, 112, 96}, {88, 74, 62}}};
  const Pair& p = pick(kWoods, random);
  Material m = make(TextureKind::kWood, p.a, p.b, static_cast<float>(random.uniform(0.8, 1.4)), random);
  m.gloss = gloss;
  return m;
}

Material cloth(Random& random, bool patterned) {
  static const std::vector<Pair> kCloths = {{{96, 112, 128}, {62, 76, 92}},  {{150, 80, 62}, {108, 50, 40}},
                                            {{88, 112, 88}, {56, 78, 60}},   {{186, 160, 120}, {146, 120, 84}},
                                            {{70, 82, 130}, {44, 52, 92}},   {{170, 130, 60}, {126, 92, 36}},
                                            {{130, 100, 126}, {92, 64, 90}}, {{120, 118, 112}, {84, 82, 78}}};
  static const TextureKind kPatterns[] = {TextureKind::kStripes, TextureKind::kChecks, TextureKind::kFloral};
  const Pair& p = pick(kCloths, random);
  const TextureKind kind = patterned ? kPatterns[random.below(3)] : TextureKind::kWeave;
  Material m = make(kind, p.a, p.b, static_cast<float>(random.uniform(0.8, 1.5)), random);
  if (patterned) {
    const Pair& q = pick(kCloths, random);
    m.a = linear_rgb(225, 215, 198);
    m.b = linear_rgb(p.a[0], p.a[1], p.a[2]);
    m.c = linear_rgb(q.b[0], q.b[1], q.b[2]);
  }
  return m;
}

Material floor_of(Random& random, float gloss) {
  const int choice = random.below(4);
  Material m;
  if (choice == 3) {
    m = make(TextureKind::kTiles, {214, 206, 192}, {176, 164, 148}, static_cast<float>(random.uniform(1.0, 1.6)),
             random);
    m.c = linear_rgb(112, 106, 98);
  } else {
    m = wood_of(random, 0);
    m.kind = choice == 2 ? TextureKind::kParquet : TextureKind::kPlanks;
    m.scale = static_cast<float>(random.uniform(0.9, 1.3));
  }
  m.gloss = gloss;
  return m;
}

Material feature_of(Random& random) {
  const int choice = random.below(5);
  if (choice == 0) {
    Material m = make(TextureKind::kBrick, {168, 92, 66}, {128, 64, 48}, 1, random);
    m.c = linear_rgb(196, 188, 176);
    return m;
  }
  static const std::vector<Pair> kPapers = {{{206, 198, 176}, {128, 140, 120}},
                                            {{178, 196, 204}, {92, 120, 140}},
                                            {{214, 188, 170}, {164, 104, 88}},
                                            {{190, 190, 204}, {116, 108, 146}},
                                            {{92, 112, 118}, {170, 180, 170}}};
  static const TextureKind kKinds[] = {TextureKind::kWallStripes, TextureKind::kWallDamask, TextureKind::kWallLeaves,
                                       TextureKind::kWallDamask};
  const Pair& p = pick(kPapers, random);
  Material m = make(kKinds[choice - 1], p.a, p.b, static_cast<float>(random.uniform(0.8, 1.3)), random);
  m.c = m.b * 0.7f;
  return m;
}

}  // namespace

Material another(const Material& material, Random& random) {
  Material m = material;
  m.seed = static_cast<uint32_t>(random.next());
  return m;
}

Material picture_material(TextureKind kind, Random& random) {
  Material m;
  m.kind = kind;
  m.a = linear_rgb(58, 60, 64);
  m.b = linear_rgb(20, 20, 22);
  m.c = linear_rgb(210, 210, 210);
  m.seed = static_cast<uint32_t>(random.next());
  return m;
}

Material book_material(Random& random) {
  static const std::vector<Pair> kCovers = {{{150, 40, 36}, {220, 190, 110}},  {{36, 64, 110}, {210, 210, 200}},
                                            {{40, 90, 62}, {224, 200, 130}},   {{214, 204, 180}, {90, 50, 40}},
                                            {{36, 36, 40}, {200, 170, 90}},    {{190, 120, 40}, {60, 40, 30}},
                                            {{104, 60, 110}, {220, 214, 220}}, {{220, 220, 222}, {50, 80, 140}},
                                            {{80, 130, 150}, {240, 236, 220}}, {{110, 76, 50}, {214, 180, 120}}};
  const Pair& p = pick(kCovers, random);
  return make(TextureKind::kBooks, p.a, p.b, 1, random);
}

RoomStyle make_room_style(Random& random, bool glossy) {
  RoomStyle s;
  const int warm = random.below(12);
  s.bare_paint = plain(236, 234 - warm / 3, 228 - warm);
  s.feature_wall = feature_of(random);
  s.floor = floor_of(random, glossy ? 0.8f : 0.0f);
  s.skirting = plain(232, 232, 228);
  s.wood = wood_of(random, glossy ? 0.6f : 0.1f);
  s.second_wood = wood_of(random, 0.1f);
  const int lacquer[3] = {226 - random.below(30), 224 - random.below(20), 218 - random.below(20)};
  s.lacquer = plain(lacquer[0], lacquer[1], lacquer[2], 0.2f);
  s.metal = plain(168, 168, 172, 0.8f);
  s.dark_metal = plain(52, 52, 56, 0.3f);
  s.black_gloss = plain(14, 14, 16, 0.9f);
  s.black_gloss.unreliable_depth = true;
  s.white_plastic = plain(232, 232, 230, 0.3f);
  s.black_plastic = plain(32, 32, 34, 0.2f);
  s.upholstery = cloth(random, false);
  s.second_upholstery = cloth(random, false);
  s.bed_cloth = cloth(random, random.chance(0.6));
  s.throw_cloth = cloth(random, true);
  s.linen = make(TextureKind::kWeave, {236, 230, 220}, {206, 198, 186}, 0.8f, random);
  s.cushion_a = cloth(random, true);
  s.cushion_b = cloth(random, true);
  s.cushion_c = cloth(random, false);
  s.curtain = cloth(random, random.chance(0.4));
  s.rug = make(TextureKind::kCarpet, {150, 52, 44}, {36, 48, 84}, 2, random);
  static const int kRugs[][3][3] = {{{150, 52, 44}, {36, 48, 84}, {214, 190, 150}},
                                    {{64, 92, 110}, {206, 196, 176}, {150, 84, 56}},
                                    {{96, 110, 84}, {196, 180, 140}, {60, 50, 46}},
                                    {{176, 138, 92}, {92, 60, 46}, {228, 216, 192}}};
  const auto& rug = kRugs[random.below(4)];
  s.rug.a = linear_rgb(rug[0][0], rug[0][1], rug[0][2]);
  s.rug.b = linear_rgb(rug[1][0], rug[1][1], rug[1][2]);
  s.rug.c = linear_rgb(rug[2][0], rug[2][1], rug[2][2]);
  s.lampshade = plain(244, 226, 190);
  s.lampshade.emission = 0.35f;
  const int ceramic[3] = {130 + random.below(100), 130 + random.below(90), 130 + random.below(90)};
  s.ceramic = plain(ceramic[0], ceramic[1], ceramic[2], 0.5f);
  s.leaf = make(TextureKind::kLeaf, {58, 104, 44}, {98, 146, 70}, 1, random);
  s.soil = make(TextureKind::kStone, {58, 44, 34}, {36, 28, 22}, 0.6f, random);
  s.wicker = make(TextureKind::kWicker, {190, 150, 96}, {104, 72, 40}, 1, random);
  s.counter = make(TextureKind::kStone, {96, 94, 92}, {62, 60, 60}, 1, random);
  s.counter.c = linear_rgb(190, 186, 180);
  s.counter.gloss = glossy ? 0.8f : 0.3f;
  return s;
}

}  // namespace aligngs
