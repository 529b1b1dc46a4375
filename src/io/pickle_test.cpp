#include "io/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
using namespace std::string_literals;

const std::vector<std::string> kAllowed = {"collections OrderedDict", "torch Size"};

Pickle parse(const std::string& bytes) { return Pickle(bytes, kAllowed, "x.pkl"); }

void expect_bad_pickle(const std::string& bytes, const std::string& message) {
  try {
    parse(bytes);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(Pickle, ReadsScalars) {
  EXPECT_TRUE(parse("\x80\x02N."s).root().is(PickleKind::kNone));
  EXPECT_EQ(parse("\x80\x02\x88."s).root().integer, 1);
  EXPECT_EQ(parse("K\xff."s).root().integer, 255);
  EXPECT_EQ(parse("M\x00\x01."s).root().integer, 256);
  EXPECT_EQ(parse("J\xfe\xff\xff\xff."s).root().integer, -2);
  EXPECT_EQ(parse("\x8a\x02\x00\xff."s).root().integer, -256);
  EXPECT_EQ(parse("\x8a\x00."s).root().integer, 0);
  EXPECT_EQ(parse("\x8a\x08\x00\x00\x00\x00\x00\x00\x00\x80."s).root().integer, INT64_MIN);
  EXPECT_TRUE(parse("\x8a\x09"s + std::string(9, '\1') + "."s).root().is(PickleKind::kBigInt));
  EXPECT_EQ(parse("G\x3f\xf8\x00\x00\x00\x00\x00\x00."s).root().real, 1.5);
  EXPECT_EQ(parse("X\x02\x00\x00\x00hi."s).root().text, "hi");
  EXPECT_EQ(parse("C\x02hi."s).root().kind, PickleKind::kBytes);
}

TEST(Pickle, ReadsProtocol2Containers) {
  // {'a': [1, 2], 'b': (3,)} as pickle.dumps(..., 2) writes it
  const Pickle pickle = parse(
      "\x80\x02}q\x00(X\x01\x00\x00\x00"
      "aq\x01]q\x02(K\x01K\x02"
      "eX\x01\x00\x00\x00"
      "bq\x03K\x03\x85q\x04u."s);
  ASSERT_TRUE(pickle.root().is(PickleKind::kDict));
  EXPECT_EQ(pickle.root().find("a")->items.at(1)->integer, 2);
  EXPECT_TRUE(pickle.root().find("b")->is(PickleKind::kTuple));
  EXPECT_EQ(pickle.root().find("c"), nullptr);
}

TEST(Pickle, ReadsProtocol4FramesAndMemo) {
  // ['x', 'x'] as pickle.dumps(..., 4) writes it: frame, MEMOIZE, BINGET
  const Pickle pickle = parse(
      "\x80\x04\x95\x0a\x00\x00\x00\x00\x00\x00\x00]\x94(\x8c\x01x\x94h\x01"
      "e."s);
  EXPECT_EQ(pickle.root().items.at(0), pickle.root().items.at(1));
}

TEST(Pickle, AnOrderedDictIsADictAndItsAttributesAreIgnored) {
  const Pickle pickle = parse(
      "\x80\x02"
      "ccollections\nOrderedDict\n)RX\x01\x00\x00\x00"
      "aK\x07s}b."s);
  EXPECT_EQ(pickle.root().find("a")->integer, 7);
}

TEST(Pickle, AnAllowedCallIsKeptAsData) {
  const Pickle pickle = parse(
      "\x80\x02"
      "ctorch\nSize\nK\x05\x85R."s);
  ASSERT_TRUE(pickle.root().is_object_of("torch Size"));
  EXPECT_EQ(pickle.root().items.at(1)->items.at(0)->integer, 5);
}

TEST(Pickle, OtherGlobalsAreRefusedByName) {
  expect_bad_pickle(
      "\x80\x02"
      "cos\nsystem\nX\x02\x00\x00\x00ls\x85R."s,
      "os.system");
  expect_bad_pickle(
      "\x80\x04\x8c\x08"
      "builtins\x8c\x04"
      "eval\x93\x8c\x01x\x85R."s,
      "builtins.eval");
}

TEST(Pickle, RefusesUnknownOperationsAndProtocols) {
  expect_bad_pickle("\x80\x02NN\x81."s, "operation 129");  // NEWOBJ
  expect_bad_pickle("\x80\x02i."s, "operation 105");       // INST
  expect_bad_pickle("\x80\x06N."s, "protocol 6");
}

TEST(Pickle, RefusesBrokenStacks) {
  expect_bad_pickle("."s, "operand");
  expect_bad_pickle("t."s, "mark");
  expect_bad_pickle("N(."s, "operand");
  expect_bad_pickle("N\x87."s, "operand");
  expect_bad_pickle("h\x05."s, "memo entry 5");
  expect_bad_pickle("NNa."s, "no list");
  expect_bad_pickle("}(Nu."s, "without a value");
  expect_bad_pickle("NNR."s, "no global");
  expect_bad_pickle("NNb."s, "state");
}

TEST(Pickle, RefusesTruncationAtEveryByte) {
  const std::string whole =
      "\x80\x02}q\x00(X\x01\x00\x00\x00"
      "aG\x3f\xf8\x00\x00\x00\x00\x00\x00X\x01\x00\x00\x00"
      "bN\x85u."s;
  EXPECT_NO_THROW(parse(whole));
  for (size_t keep = 0; keep < whole.size(); ++keep) EXPECT_THROW(parse(whole.substr(0, keep)), Error) << keep;
}

TEST(Pickle, ManyValuesAreRefusedAndCyclesAreHarmless) {
  expect_bad_pickle(std::string(1'200'000, 'N') + ".", "values");
  expect_bad_pickle(
      "Nq\0"s +
          [] {
            std::string gets;
            for (int i = 0; i < 1'000'001; ++i) gets += "h\0"s;
            return gets;
          }() +
          ".",
      "values");
  const Pickle cycle = parse(
      "]q\x00h\x00"
      "a."s);
  EXPECT_EQ(cycle.root().items.at(0), &cycle.root());
}

}  // namespace
}  // namespace aligngs
