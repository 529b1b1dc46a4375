#include "edit/undo_words.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "edit/edit_log.h"
#include "edit/edit_text.h"

namespace aligngs {
namespace {

TEST(UndoWords, TheLatestEdit) {
  for (const char* text : {"undo", "Undo the last edit", "undo that", "revert my latest change", "take back it"})
    EXPECT_EQ(parse_undo(text), (UndoRequest{0, 1})) << text;
}

TEST(UndoWords, OneEditByItsNumber) {
  for (const char* text : {"undo the second edit", "undo #2", "undo edit number 2", "undo 2nd", "undo edit two"})
    EXPECT_EQ(parse_undo(text), (UndoRequest{2, 1})) << text;
}

TEST(UndoWords, SeveralOfTheLatest) {
  for (const char* text : {"undo the last two edits", "undo 2 edits", "undo last 2", "undo twice", "undo two times",
                           "revert the previous two changes"})
    EXPECT_EQ(parse_undo(text), (UndoRequest{0, 2})) << text;
}

TEST(UndoWords, Everything) {
  for (const char* text : {"undo everything", "undo all", "undo all edits", "undo all of my changes", "UNDO ALL"})
    EXPECT_EQ(parse_undo(text), (UndoRequest{0, UndoRequest::kAll})) << text;
}

TEST(UndoWords, OtherSentencesAreNoUndo) {
  EXPECT_FALSE(parse_undo("delete bed"));
  EXPECT_FALSE(parse_undo("undone"));
}

TEST(UndoWords, WhatIsNotClearIsRefused) {
  for (const char* text : {"undo everything else", "undo 0", "undo -1", "undo the last edits", "undo edits 2 and 3",
                           "undo the second last edit"})
    EXPECT_THROW(parse_undo(text), Error) << text;
}

TEST(UndoWords, AStepBackIsOne) {
  for (const char* text : {"go back", "step back", "one step back", "take that back"})
    EXPECT_EQ(parse_undo(text), (UndoRequest{0, 1})) << text;
}

TEST(UndoWords, PuttingBackAsksHowMuch) {
  for (const char* text : {"put it back", "put the rug back", "bring back the rug", "bring the rug back",
                           "restore the rug", "reset", "redo"})
    EXPECT_THROW(parse_undo(text), Error) << text;
}

TEST(UndoWords, TheLatestEditsAreTakenOffAList) {
  std::vector<EditOperation> edits;
  for (const char* text : {"delete bed", "delete lamp", "delete rug"}) edits.push_back(parse_edit(text));
  std::vector<EditOperation> rest = edits;
  const std::vector<EditOperation> taken = take_latest(rest, 2);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].select, "bed");
  EXPECT_EQ(taken[0].select, "rug") << "the latest is the first";
  EXPECT_THROW(take_latest(rest, 2), Error);
  EXPECT_EQ(take_latest(edits, UndoRequest::kAll).size(), 3u);
  EXPECT_THROW(take_latest(edits, UndoRequest::kAll), Error) << "none is left";
}

}  // namespace
}  // namespace aligngs
