#include "io/safetensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
namespace fs = std::filesystem;

fs::path safetensors_folder() { return fs::path(testing::TempDir()) / "safetensors_test"; }

std::string safetensors_of(const std::string& header, const std::string& data) {
  std::string bytes;
  append_little(bytes, uint64_t(header.size()));
  return bytes + header + data;
}

void expect_bad_safetensors(const std::string& bytes, const std::string& message) {
  try {
    decode_safetensors(bytes, "model.safetensors");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "model.safetensors");
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(Safetensors, RoundTrip) {
  TensorFile file;
  file.tensors["weights"] = tensor_of({1, 2, 3, 4, 5, 6}, {2, 3});
  file.tensors["a byte"] = {"U8", {1}, {200}};
  file.tensors["empty"] = {"F16", {0, 4}, {}};
  file.tensors["\xc3\xa4"] = {"I64", {}, std::vector<uint8_t>(8, 0xff)};
  file.metadata["note"] = "made \"here\"";
  write_safetensors(safetensors_folder() / "a.safetensors", file);
  const TensorFile back = read_safetensors(safetensors_folder() / "a.safetensors");
  ASSERT_EQ(back.tensors.size(), 4u);
  for (const auto& [name, tensor] : file.tensors) {
    EXPECT_EQ(back.tensors.at(name).dtype, tensor.dtype);
    EXPECT_EQ(back.tensors.at(name).shape, tensor.shape);
    EXPECT_EQ(back.tensors.at(name).bytes, tensor.bytes);
  }
  EXPECT_THAT(back.metadata, ElementsAre(Pair("note", "made \"here\"")));
  EXPECT_THAT(floats_of(back.tensors.at("\xc3\xa4"), ""), ElementsAre(-1));
}

TEST(Safetensors, DataAreAlignedForAnyReader) {
  TensorFile file;
  file.tensors["a"] = {"U8", {3}, {1, 2, 3}};
  file.tensors["b"] = tensor_of({1});
  write_safetensors(safetensors_folder() / "aligned.safetensors", file);
  const std::string bytes = read_file(safetensors_folder() / "aligned.safetensors");
  EXPECT_EQ(load_number<uint64_t>(bytes.data(), false) % 8, 0u);
  const float one = 1;
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - 7, &one, 4), 0);  // the float comes first
}

TEST(Safetensors, EqualContentGivesEqualBytes) {
  TensorFile file;
  file.tensors["x"] = tensor_of({1, 2});
  write_safetensors(safetensors_folder() / "1.safetensors", file);
  write_safetensors(safetensors_folder() / "2.safetensors", file);
  EXPECT_EQ(read_file(safetensors_folder() / "1.safetensors"), read_file(safetensors_folder() / "2.safetensors"));
}

TEST(Safetensors, ConvertsEveryNumericTypeToFloat) {
  const auto convert = [](const std::string& dtype, std::vector<uint8_t> bytes) {
    return floats_of({dtype, {int64_t(1)}, std::move(bytes)}, "t");
  };
  EXPECT_THAT(convert("F16", {0x00, 0x3c}), ElementsAre(1));
  EXPECT_THAT(convert("BF16", {0x80, 0x3f}), ElementsAre(1));
  EXPECT_THAT(convert("F64", {0, 0, 0, 0, 0, 0, 0xf8, 0x3f}), ElementsAre(1.5f));
  EXPECT_THAT(convert("I8", {0xff}), ElementsAre(-1));
  EXPECT_THAT(convert("U8", {0xff}), ElementsAre(255));
  EXPECT_THAT(convert("BOOL", {1}), ElementsAre(1));
  EXPECT_THAT(convert("I16", {0xfe, 0xff}), ElementsAre(-2));
  EXPECT_THAT(convert("U16", {0xfe, 0xff}), ElementsAre(65534));
  EXPECT_THAT(convert("I32", {1, 0, 0, 0}), ElementsAre(1));
  EXPECT_THAT(convert("U32", {0, 0, 0, 0x80}), ElementsAre(2147483648.f));
  EXPECT_THAT(convert("U64", {7, 0, 0, 0, 0, 0, 0, 0}), ElementsAre(7));
  EXPECT_THROW(convert("F8_E4M3", {1}), Error);
}

TEST(Safetensors, RefusesBadHeaders) {
  expect_bad_safetensors("", "ends too early");
  expect_bad_safetensors(safetensors_of("{\"a\":", ""), "JSON");
  expect_bad_safetensors(safetensors_of("[]", ""), "header");
  expect_bad_safetensors(safetensors_of("{}", "x"), "belong to no tensor");
  expect_bad_safetensors(safetensors_of(R"({"a":{"dtype":"F32","shape":[1]}})", "1234"), "dtype, shape");
  expect_bad_safetensors(safetensors_of(R"({"a":{"dtype":"F99","shape":[1],"data_offsets":[0,4]}})", "1234"), "F99");
  expect_bad_safetensors(safetensors_of(R"({"a":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", "1234"),
                         "no size");
  expect_bad_safetensors(safetensors_of(R"({"a":{"dtype":"F32","shape":[1.0],"data_offsets":[0,4]}})", "1234"),
                         "no size");
  expect_bad_safetensors(safetensors_of(R"({"__metadata__":{"x":1}})", ""), "not a string");
  expect_bad_safetensors(safetensors_of(R"({"a":[[[[[[[[]]]]]]]]})", ""), "header");
  expect_bad_safetensors(safetensors_of(R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},"a":{}})", "1"),
                         "twice");
}

TEST(Safetensors, RefusesOffsetsThatDoNotTile) {
  const auto two = [](const std::string& first, const std::string& second) {
    return safetensors_of(R"({"a":{"dtype":"U8","shape":[2],"data_offsets":)" + first +
                              R"(},"b":{"dtype":"U8","shape":[2],"data_offsets":)" + second + "}}",
                          "1234");
  };
  EXPECT_NO_THROW(decode_safetensors(two("[2,4]", "[0,2]"), ""));
  expect_bad_safetensors(two("[0,2]", "[1,3]"), "overlap");
  expect_bad_safetensors(two("[0,2]", "[0,2]"), "overlap");
  expect_bad_safetensors(two("[0,2]", "[3,5]"), "beyond");
  expect_bad_safetensors(two("[2,0]", "[2,4]"), "beyond");
  expect_bad_safetensors(two("[0,3]", "[3,4]"), "does not fill");
}

TEST(Safetensors, RefusesHugeShapes) {
  expect_bad_safetensors(
      safetensors_of(R"({"a":{"dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,0]}})", ""), "too large");
  std::string bytes;
  append_little(bytes, uint64_t(1) << 62);
  expect_bad_safetensors(bytes, "100 MB");
}

TEST(Safetensors, RefusesToWriteWhatDoesNotFit) {
  TensorFile file;
  file.tensors["x"] = {"F32", {2}, {1, 2, 3}};
  EXPECT_THROW(write_safetensors(safetensors_folder() / "bad.safetensors", file), Error);
  file.tensors["x"] = {"F32", {0}, {}};
  file.metadata["x"] = "\xff";
  EXPECT_THROW(write_safetensors(safetensors_folder() / "bad.safetensors", file), Error);
  EXPECT_FALSE(fs::exists(safetensors_folder() / "bad.safetensors"));
  EXPECT_THROW(tensor_of({1, 2, 3}, {2}), Error);
}

TEST(Safetensors, ReadsAndRefusesTheStoredFiles) {
  const fs::path files = fs::path(ALIGNGS_SOURCE_DIR) / "tests/data/parity/loader";
  const TensorFile mixed = read_safetensors(files / "mixed.safetensors");
  const TensorFile expected = read_safetensors(files / "mixed.expected.safetensors");
  EXPECT_GT(expected.tensors.size(), 5u);
  for (const auto& [name, tensor] : expected.tensors) {
    EXPECT_EQ(floats_of(mixed.tensors.at(name), name), floats_of(tensor, name)) << name;
  }
  for (const char* name : {"header", "offset", "overflow", "shape"}) {
    EXPECT_THROW(read_safetensors(files / (std::string("reject_") + name + ".safetensors")), Error) << name;
  }
}

}  // namespace
}  // namespace aligngs
