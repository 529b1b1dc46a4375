#include "batch/room_list.h"

#include <gmock/gmock.h>

#include <functional>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTable =
    "# kitchens first\n"
    "room\tsource\toptions\n"
    "kitchen\tphotos/kitchen\t--method colmap --semantics none\n"
    "\n"
    "hall.2\t../scenes/hall\r\n"
    "trial\tdemo\t-n 50\t--room 'kitchen'\n";

constexpr const char* kToml = R"(options = ["--preset", "preview"]
[[room]]
name = "kitchen"
source = "photos/kitchen"
options = "--method colmap"
[[room]]
name = "trial"
source = "demo"
)";

/// The parser's message about a list that it refuses.
std::string fault(const std::function<void()>& parse) {
  try {
    parse();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
    EXPECT_FALSE(error.details().remedy.empty()) << error.what();
    return error.details().field + ": " + error.details().message;
  }
  ADD_FAILURE() << "it was accepted";
  return "";
}
std::string table_fault(const std::string& text) {
  return fault([&] { parse_room_table(text, "rooms.tsv"); });
}
std::string toml_fault(const std::string& text) {
  return fault([&] { parse_room_toml(text, "rooms.toml"); });
}

TEST(RoomList, TableHasRoomSourceAndOptions) {
  const std::vector<RoomEntry> rooms = parse_room_table(kTable, "rooms.tsv");
  ASSERT_EQ(rooms.size(), 3u);
  EXPECT_EQ(rooms[0].name, "kitchen");
  EXPECT_EQ(rooms[0].source, "photos/kitchen");
  EXPECT_THAT(rooms[0].options, ElementsAre("--method", "colmap", "--semantics", "none"));
  EXPECT_EQ(rooms[1].source, "../scenes/hall");
  EXPECT_THAT(rooms[1].options, ElementsAre());
  EXPECT_EQ(rooms[1].line, 5);
  EXPECT_TRUE(rooms[2].synthetic());
  EXPECT_THAT(rooms[2].options, ElementsAre("-n", "50", "--room", "kitchen"));
}

TEST(RoomList, TomlHasTablesAndSharedOptions) {
  const std::vector<RoomEntry> rooms = parse_room_toml(kToml, "rooms.toml");
  ASSERT_EQ(rooms.size(), 2u);
  EXPECT_THAT(rooms[0].options, ElementsAre("--preset", "preview", "--method", "colmap"));
  EXPECT_EQ(rooms[0].line, 2);
  EXPECT_TRUE(rooms[1].synthetic());
}

TEST(RoomList, FaultsOfATableNameTheirLine) {
  EXPECT_THAT(table_fault(""), HasSubstr("no rooms"));
  EXPECT_THAT(table_fault("kitchen photos\n"), HasSubstr("line 1: there is no tab"));
  EXPECT_THAT(table_fault("a\tx\n../b\ty\n"), HasSubstr("line 2: this is no name"));
  EXPECT_THAT(table_fault("a\tx\na\ty\n"), HasSubstr("line 2: the room a is listed twice, first in line 1"));
  EXPECT_THAT(table_fault("a\t\n"), HasSubstr("line 1: the room a has no source"));
  EXPECT_THAT(table_fault("a\tx\t--config 'b\n"), HasSubstr("line 1: a quote is not closed"));
}

TEST(RoomList, OptionsOfTheBatchAreRefused) {
  for (const char* option :
       {"-o out", "-oout", "--output=x", "--resume", "--overwrite", "--json", "-q", "--view", "--dry-run"}) {
    EXPECT_THAT(table_fault(std::string("a\tx\t") + option + "\n"), HasSubstr("may not have the option")) << option;
  }
}

TEST(RoomList, FaultsOfATomlListNameTheirLine) {
  EXPECT_THAT(toml_fault(""), HasSubstr("no rooms"));
  EXPECT_THAT(toml_fault("rooms = 3\n"), HasSubstr("line 1: there is no such key: rooms"));
  EXPECT_THAT(toml_fault("[[room]]\nname = \"a\"\nsuorce = \"x\"\n"), HasSubstr("line 3: a room has no key suorce"));
  EXPECT_THAT(toml_fault("[[room]]\nname = 3\nsource = \"x\"\n"), HasSubstr("line 2: name is no text"));
  EXPECT_THAT(toml_fault("[[room]]\nsource = \"x\"\n"), HasSubstr("line 1: the room has no name"));
  EXPECT_THAT(toml_fault("[[room]\n"), HasSubstr("line 1"));
  EXPECT_THAT(toml_fault("[room]\nname = \"a\"\n"), HasSubstr("room is no list of tables"));
}

/// Whatever happens to a list, it is read or refused with an Error.
TEST(RoomList, DamagedListsAreReadOrRefused) {
  for (const auto& [text, parse] :
       {std::pair{std::string(kTable), &parse_room_table}, std::pair{std::string(kToml), &parse_room_toml}}) {
    for (size_t i = 0; i < text.size(); ++i) {
      for (const char byte : {'\0', '\t', '\n', '"', '\'', '[', '\xff'}) {
        std::string damaged = text;
        damaged[i] = byte;
        for (const std::string& bytes : {damaged, text.substr(0, i)}) {
          try {
            parse(bytes, "x");
          } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
          }
        }
      }
    }
  }
}

TEST(RoomList, ATomlRoomWithoutASourceIsAdvisedInToml) {
  try {
    parse_room_toml("[[room]]\nname = \"a\"\n", "rooms.toml");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.details().remedy, HasSubstr("[[room]]"));
  }
}

TEST(RoomList, HeadingsOfSpreadsheetsAreNoRooms) {
  for (const char* heading : {"name\tsource", "Room\tSource\tOptions", "name\tpath", "rooms\tphotos"}) {
    const std::vector<RoomEntry> rooms = parse_room_table(std::string(heading) + "\na\tx\n", "rooms.tsv");
    ASSERT_EQ(rooms.size(), 1u) << heading;
    EXPECT_EQ(rooms[0].name, "a") << heading;
  }
}

TEST(RoomList, ARoomCalledNameIsOneBelowTheFirstLine) {
  EXPECT_EQ(parse_room_table("a\tx\nname\tsource\n", "rooms.tsv").size(), 2u);
}

}  // namespace
}  // namespace aligngs
