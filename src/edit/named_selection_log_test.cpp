#include "edit/named_selection_log.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/edit_lock.h"
#include "edit/edit_operation.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NamedSelectionLog : public testing::Test {
 protected:
  NamedSelectionLog() {
    fs::remove_all(run_);
    write_file_atomically(run_ / "run.json", "{}");
  }
  ~NamedSelectionLog() override { fs::remove_all(run_); }
  void add(const std::string& name) {
    NamedSelection s;
    s.name = name;
    s.set_rows({0, 1, 1});
    add_selection(run_, s, labels_, 0);
  }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const NamedSelection& s : read_named_selections(named_selections_file(run_))) out.push_back(s.name);
    return out;
  }
  static std::string message_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return {};
  }
  const fs::path run_ = fs::path(testing::TempDir()) / "named_selection_log";
  const LabelSet labels_ = ade20k_labels();
};

TEST_F(NamedSelectionLog, SelectionsAreAddedRenamedAndRemoved) {
  add("my corner");
  add("window seat");
  EXPECT_EQ(names(), (std::vector<std::string>{"my corner", "window seat"}));
  rename_selection(run_, "My Corner", "reading corner", labels_, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"reading corner", "window seat"}));
  remove_selection(run_, "reading corner", labels_, 0);
  remove_selection(run_, "window seat", labels_, 0);
  EXPECT_FALSE(fs::exists(named_selections_file(run_)));
}

TEST_F(NamedSelectionLog, NamesThatMeanSomethingElseAreRefused) {
  for (const char* name : {"bed", "Beds", "nightstand", "bed 2", "every lamp", "the left pillow", "everything"})
    EXPECT_THAT(message_of([&] { add(name); }), HasSubstr("means objects of the room already")) << name;
  for (const char* name : {"this and that", "all but me", "corner dark green", "corner by 1 m to the left",
                           "nook with contents", "corner to"})
    EXPECT_THAT(message_of([&] { add(name); }), HasSubstr("reads as something else")) << name;
  add("my corner");
  EXPECT_THAT(message_of([&] { add("My-corner"); }), HasSubstr("already"));
  EXPECT_THAT(message_of([&] { rename_selection(run_, "my corner", "bed", labels_, 0); }), HasSubstr("already"));
  EXPECT_EQ(names().size(), 1u);
}

TEST_F(NamedSelectionLog, AnEmptySelectionIsNotKept) {
  NamedSelection s;
  s.name = "nothing";
  s.set_rows({0, 0});
  EXPECT_THAT(message_of([&] { add_selection(run_, s, labels_, 0); }), HasSubstr("nothing is selected"));
}

TEST_F(NamedSelectionLog, WhatAnEditSpeaksOfStays) {
  add("my corner");
  add("window seat");
  EditOperation edit;
  edit.select = "bed, my corner";
  write_file_atomically(run_ / "edits.json", edits_text({edit}));
  EXPECT_THAT(message_of([&] { remove_selection(run_, "my corner", labels_, 0); }), HasSubstr("delete bed, my corner"));
  EXPECT_THAT(message_of([&] { rename_selection(run_, "my corner", "nook", labels_, 0); }), HasSubstr("speaks of"));
  remove_selection(run_, "window seat", labels_, 0);
  EXPECT_EQ(names(), std::vector<std::string>{"my corner"});
}

TEST_F(NamedSelectionLog, UnknownNamesAreRefused) {
  EXPECT_THAT(message_of([&] { remove_selection(run_, "nook", labels_, 0); }), HasSubstr("no selection \"nook\""));
}

TEST_F(NamedSelectionLog, AChangeWaitsForAnEditOfTheRun) {
  const EditLock lock(run_, "delete bed", 0);
  EXPECT_THAT(message_of([&] { add("my corner"); }), HasSubstr("delete bed"));
}

}  // namespace
}  // namespace aligngs
