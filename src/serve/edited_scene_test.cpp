#include "serve/edited_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "edit/edit_change.h"
#include "edit/testing/small_room.h"
#include "io/gzip.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

struct Part {
  nlohmann::json head;
  std::string bytes;
  size_t staying() const {
    size_t n = 0;
    for (size_t k = 0; k < head["total"].get<size_t>(); ++k)
      n += (static_cast<unsigned char>(bytes[k / 8]) >> k % 8) & 1;
    return n;
  }
};

class EditedScene : public testing::Test {
 protected:
  EditedScene() : trained_(small_room::make(pool_)) {
    shown_.order.resize(trained_.origins.size());
    std::iota(shown_.order.rbegin(), shown_.order.rend(), 0u);  // the page has them in another order than the file
    shown_.harmonics = 9;
  }
  EditableRoom after(EditKind kind, const std::string& select) {
    EditOperation edit;
    edit.kind = kind;
    edit.select = select;
    edit.motion.shift.x = kind == EditKind::kMove ? 0.2 : 0;
    EditableRoom room = trained_, out = trained_;
    const EditReport report = apply_edit(room, edit, pool_);
    EXPECT_TRUE(apply_change(out, difference(trained_, room, edit, report, 1, 0)));
    return out;
  }
  Part part(const EditableRoom& room) const {
    const std::string text = gzip_expanded(edited_scene(trained_, room, shown_), "part", 1 << 28);
    const size_t line = text.find('\n');
    return {parse_json(text.substr(0, line)), text.substr(line + 1)};
  }
  std::vector<uint32_t> sources(const Part& p) const {
    std::vector<uint32_t> out(p.head["added"].get<size_t>());
    const size_t bytes = out.size() * sizeof(uint32_t);
    if (bytes > 0) std::memcpy(out.data(), p.bytes.data() + p.bytes.size() - bytes, bytes);
    return out;
  }
  ThreadPool pool_{2};
  EditableRoom trained_;
  ShownSplats shown_;
};

TEST_F(EditedScene, NothingChangesWithoutEdits) {
  const Part p = part(trained_);
  EXPECT_EQ(p.staying(), trained_.origins.size());
  EXPECT_EQ(p.head["changed"], 0);
  EXPECT_EQ(p.head["added"], 0);
}

TEST_F(EditedScene, DeletedSplatsGo) {
  const EditableRoom room = after(EditKind::kDelete, "box");
  const Part p = part(room);
  EXPECT_EQ(p.staying(), room.origins.size());
  EXPECT_LT(p.staying(), trained_.origins.size());
  const uint32_t last = static_cast<uint32_t>(trained_.origins.size()) - 1;  // at the page's first place
  const bool stays =
      std::any_of(room.origins.begin(), room.origins.end(), [&](const GaussianOrigin& o) { return o.row == last; });
  EXPECT_EQ((p.bytes[0] & 1) != 0, stays);
}

TEST_F(EditedScene, RecolouredSplatsAreAtTheirPlaces) {
  const EditableRoom room = after(EditKind::kRecolor, "box");
  const Part p = part(room);
  const size_t changed = p.head["changed"].get<size_t>();
  ASSERT_GT(changed, 50u);
  EXPECT_EQ(p.head["changed_columns"].size(), 3u + 9u + 3u);
  for (size_t k = 0; k < changed; ++k) {
    uint32_t place;
    std::memcpy(&place, p.bytes.data() + (shown_.order.size() + 7) / 8 + sizeof place * k, sizeof place);
    const uint32_t row = shown_.order.at(place);
    EXPECT_NE(room.gaussians.model.sh[48 * row], trained_.gaussians.model.sh[48 * row]);
  }
}

TEST_F(EditedScene, CopiesAreNewSplats) {
  trained_.cameras.emplace_back();
  trained_.cameras.back().world_to_camera.translation = {0, 0.5, 2.5};
  const EditableRoom room = after(EditKind::kDuplicate, "box");
  const Part p = part(room);
  EXPECT_EQ(p.head["added"].get<size_t>(), room.origins.size() - trained_.origins.size());
  EXPECT_EQ(p.staying(), trained_.origins.size());
  for (const uint32_t source : sources(p)) EXPECT_EQ(source, 0xffffffffu);
}

TEST_F(EditedScene, MovedSplatsTellWhereTheyWere) {
  trained_.cameras.emplace_back();
  trained_.cameras.back().world_to_camera.translation = {0, 0.5, 2.5};
  const EditableRoom room = after(EditKind::kMove, "box");
  size_t moved = 0, of_box = 0;  // the edge of the box goes along, whatever its class is
  for (const uint32_t source : sources(part(room))) {
    if (source == 0xffffffffu) continue;
    of_box += trained_.gaussians.labels.label[shown_.order.at(source)] == small_room::kBox;
    ++moved;
  }
  EXPECT_GT(4 * of_box, 3 * moved);
  EXPECT_GT(moved, 50u);
}

}  // namespace
}  // namespace aligngs
