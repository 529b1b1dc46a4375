#include "edit/edit_text.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

TEST(EditText, AVerbAndASelection) {
  const EditOperation edit = parse_edit("delete pillow, cushion");
  EXPECT_EQ(edit.kind, EditKind::kDelete);
  EXPECT_EQ(edit.select, "pillow, cushion");
  EXPECT_TRUE(edit.fill) << "as the button of the page";
  EXPECT_EQ(parse_edit("  Remove  pillow#2 ").select, "pillow#2");
  EXPECT_EQ(parse_edit("keep everything but wall, floor").kind, EditKind::kExtract);
  EXPECT_EQ(parse_edit("extract everything but wall, floor").select, "everything but wall, floor");
}

TEST(EditText, AnEditThatMovesNothingIsRefused) {
  for (const char* text : {"move sofa 0 cm left", "move sofa by 0,0,0", "turn sofa by 0", "turn sofa by 360",
                           "move sofa 1 m left and 1 m right", "copy sofa by 0,0,0"}) {
    try {
      parse_edit(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage) << text;
      EXPECT_THAT(error.what(), HasSubstr("nothing would move")) << text;
    }
  }
  EXPECT_THROW(parse_edit("copy the armchair to the left"), Error) << "how far?";
  EXPECT_TRUE(parse_edit("copy sofa").motion.is_still()) << "a copy without a motion is beside the sofa";
}

TEST(EditText, AColourStandsAtTheEnd) {
  const std::array<uint8_t, 3> blue{0xad, 0xd8, 0xe6};
  for (const char* text : {"recolor sofa to #add8e6", "recolour sofa #add8e6", "Recolor sofa With #ADD8E6"}) {
    EXPECT_EQ(parse_edit(text).kind, EditKind::kRecolor) << text;
    EXPECT_EQ(parse_edit(text).select, "sofa") << text;
    EXPECT_EQ(parse_edit(text).color, blue) << text;
  }
  EXPECT_EQ(parse_edit("highlight sofa in #add8e6").color, blue);
  EXPECT_EQ(parse_edit("highlight sofa#1").select, "sofa#1");
  EXPECT_EQ(parse_edit("highlight coffee table, sofa").select, "coffee table, sofa");
}

TEST(EditText, OptionsAreThoseOfTheCommandLine) {
  EXPECT_TRUE(parse_edit("delete --fill pillow").fill);
  const EditOperation edit = parse_edit("delete --no-fill pillow --threshold 0.4");
  EXPECT_FALSE(edit.fill);
  EXPECT_EQ(edit.select, "pillow");
  EXPECT_EQ(edit.threshold.kind, ThresholdRule::Kind::kValue);
  EXPECT_DOUBLE_EQ(edit.threshold.value, 0.4);
  EXPECT_EQ(parse_edit("delete pillow --threshold=auto").threshold.kind, ThresholdRule::Kind::kAuto);
}

TEST(EditText, NoFillMayBeSaid) {
  for (const char* text : {"delete bed, no fill", "delete bed without filling", "delete bed without filling the hole",
                           "delete bed and do not fill the hole", "delete bed no-fill"}) {
    const EditOperation edit = parse_edit(text);
    EXPECT_FALSE(edit.fill) << text;
    EXPECT_EQ(edit.select, "bed") << text;
  }
}

TEST(EditText, AColourMayBeAName) {
  const EditOperation edit = parse_edit("recolor chest of drawers dark green");
  EXPECT_EQ(edit.select, "chest of drawers");
  EXPECT_EQ(color_text(edit.color), "#006400");
  EXPECT_EQ(parse_edit("paint the wall light blue").kind, EditKind::kRecolor);
}

TEST(EditText, WhatStandsOnAThingGoesWithIt) {
  for (const char* text :
       {"delete chest of drawers with contents", "delete chest of drawers and what is on it",
        "delete chest of drawers with its contents", "delete chest of drawers and everything on it",
        "delete chest of drawers including contents", "delete chest of drawers along with its contents",
        "delete chest of drawers --with-contents"}) {
    const EditOperation edit = parse_edit(text);
    EXPECT_TRUE(edit.with_contents) << text;
    EXPECT_EQ(edit.select, "chest of drawers") << text;
  }
  EXPECT_EQ(describe(parse_edit("delete bed with contents, hole left open")),
            "delete bed with contents, hole left open");
  EXPECT_THROW(parse_edit("highlight bed with contents"), Error);
}

TEST(EditText, ObjectsAreMovedTurnedAndCopied) {
  const EditOperation move = parse_edit("move the largest chair 0.5 m to the left");
  EXPECT_EQ(move.kind, EditKind::kMove);
  EXPECT_EQ(move.select, "the largest chair");
  EXPECT_DOUBLE_EQ(move.motion.shift.x, -0.5);
  EXPECT_TRUE(move.fill) << "what it leaves is filled";
  EXPECT_DOUBLE_EQ(parse_edit("turn sofa by 90").motion.turn, 90);
  EXPECT_TRUE(parse_edit("copy lamp#1").motion.is_still());
  for (const char* text : {"move desk with contents by 0.5,0,-0.2 and turn by 30", "turn desk by -90, hole left open",
                           "duplicate chair by 1,0,0", "duplicate chair"}) {
    EXPECT_EQ(describe(parse_edit(text)), text);
  }
  EXPECT_TRUE(parse_edit("move desk 0.5 m to the left with everything on it").with_contents);
  for (const char* text : {"move sofa", "turn sofa", "move by 1,2,3", "turn sofa by 999"})
    EXPECT_THROW(parse_edit(text), Error) << text;
}

TEST(EditText, AnObjectIsReplaced) {
  const EditOperation edit = parse_edit("replace the largest chair with My Runs/other#sofa#1, fitted and turn by 90");
  EXPECT_EQ(edit.kind, EditKind::kReplace);
  EXPECT_EQ(edit.select, "the largest chair");
  EXPECT_EQ(edit.with, "My Runs/other#sofa#1");
  EXPECT_TRUE(edit.fit);
  EXPECT_DOUBLE_EQ(edit.motion.turn, 90);
  EXPECT_TRUE(edit.fill) << "what is behind it is filled";
  for (const char* text : {"replace chair with a.ply",
                           "replace chair (threshold 0.25) with contents with a.ply, fitted, up -y and turn by 5",
                           "replace chair with a.ply, up x, hole left open"}) {
    EXPECT_EQ(describe(parse_edit(text)), text);
  }
  for (const char* text :
       {"replace chair", "replace chair with", "replace with a.ply", "replace chair with a.ply, up w"})
    EXPECT_THROW(parse_edit(text), Error) << text;
}

TEST(EditText, AnExchangeIsAReplacement) {
  for (const char* text :
       {"swap armchair with chair.ply", "exchange armchair for chair.ply", "replace armchair by chair.ply"}) {
    const EditOperation edit = parse_edit(text);
    EXPECT_EQ(edit.select, "armchair") << text;
    EXPECT_EQ(edit.with, "chair.ply") << text;
  }
  EXPECT_EQ(parse_edit("replace armchair with chair.ply and turn by 90").motion.turn, 90);
}

TEST(EditText, ARequestMayBeAnUndo) {
  EXPECT_EQ(parse_request("Could you undo the last two edits, please?").undo, (UndoRequest{0, 2}));
  EXPECT_FALSE(parse_request("delete bed").undo);
  EXPECT_THROW(parse_request("undo everything else"), Error);
}

TEST(EditText, ReadsBackHowEditsAreDescribed) {
  for (const EditKind kind : {EditKind::kDelete, EditKind::kExtract, EditKind::kRecolor, EditKind::kHighlight}) {
    for (const char* threshold : {"argmax", "auto", "0.25"}) {
      for (const bool fill : {false, true}) {
        if (fill && kind != EditKind::kDelete) continue;
        EditOperation edit;
        edit.kind = kind;
        edit.select = "pillow, cushion#2";
        edit.threshold = parse_threshold(threshold);
        edit.color = {1, 2, 3};
        edit.fill = fill;
        const EditOperation back = parse_edit(describe(edit));
        EXPECT_EQ(describe(back), describe(edit));
        EXPECT_EQ(back.select, edit.select);
        EXPECT_EQ(back.fill, fill);
      }
    }
  }
}

TEST(EditText, MistakesSayWhatIsExpected) {
  const auto expect = [](const std::string& text, const char* words) {
    try {
      parse_edit(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage) << text;
      EXPECT_THAT(error.what(), HasSubstr(words)) << text;
    }
  };
  expect("", "there is no edit");
  expect("explode sofa", "is no edit");
  expect("delete", "names no object");
  expect("delete   --fill", "names no object");
  expect("recolor", "no colour");
  expect("recolor sofa to bleu", "no colour");
  expect("recolor #add8e6", "names no object");
  expect("extract sofa --fill", "deletion");
  expect("delete sofa --threshold", "no threshold");
  expect("delete sofa --threshold 7", "no threshold");
  expect("delete " + std::string(5000, 'x'), "4096");
}

}  // namespace
}  // namespace aligngs
