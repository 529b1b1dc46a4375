#include "io/weight_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/half.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/safetensors.h"
#include "io/safetensors_stream.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Key;
using testing::Pair;
using namespace std::string_literals;
namespace fs = std::filesystem;

fs::path weight_folder() {
  const fs::path path = fs::path(testing::TempDir()) / "weight_file_test";
  fs::create_directories(path);
  return path;
}

std::string pickled_text(const std::string& s) {
  std::string out = "X";
  append_little(out, uint32_t(s.size()));
  return out + s;
}

/// A pickled float tensor of one dimension, the whole of storage `key`.
std::string tensor(const std::string& key, uint8_t elements, bool legacy = false) {
  const std::string n = "K"s + char(elements);
  return "ctorch._utils\n_rebuild_tensor_v2\n((" + pickled_text("storage") + "ctorch\nFloatStorage\n" +
         pickled_text(key) + pickled_text("cpu") + n + (legacy ? "N" : "") + "tQK\0"s + n +
         "\x85K\x01\x85\x89"s
         "ccollections\nOrderedDict\n)RtR";
}
std::string entry(const std::string& key, const std::string& value) { return pickled_text(key) + value + "s"; }
std::string floats(const std::vector<float>& values) {
  std::string out;
  for (const float v : values) append_little(out, v);
  return out;
}
std::string weight_archive(const std::string& root) {
  return make_stored_zip(
      {{"w/data.pkl", "\x80\x02" + root + "."}, {"w/data/0", floats({1, 2})}, {"w/data/1", floats({3, 4, 5})}});
}
std::string legacy(const std::string& root, const std::string& storages) {
  return "\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19."s + "\x80\x02M\xe9\x03."s + "\x80\x02}" +
         entry("little_endian", "\x88") + "." + "\x80\x02" + root + "." + "\x80\x02](" + pickled_text("7") +
         pickled_text("9") + "e." + storages;
}
std::string storage(const std::vector<float>& values) {
  std::string out;
  append_little(out, uint64_t(values.size()));
  return out + floats(values);
}

void expect_bad_weights(const std::string& bytes, const std::string& message) {
  try {
    WeightFile::from_memory(bytes, "net.pth");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "net.pth");
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(WeightFile, ReadsSafetensors) {
  TensorFile file;
  file.tensors["a"] = tensor_of({1, 2, 3, 4}, {2, 2});
  file.tensors["b"] = {"F16", {1}, {0x00, 0x3c}};
  write_safetensors(weight_folder() / "a.safetensors", file);
  const auto weights = WeightFile::open(weight_folder() / "a.safetensors");
  EXPECT_THAT(weights->tensors(), ElementsAre(Key("a"), Key("b")));
  EXPECT_THAT(weights->tensors().at("a").shape, ElementsAre(2, 2));
  EXPECT_THAT(weights->read("a"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(weights->read("b"), ElementsAre(1));
}

TEST(WeightFile, ReadsTensorsLargerThanAPiece) {
  std::vector<float> values(200'003);
  for (size_t i = 0; i < values.size(); ++i) values[i] = float(i);
  TensorFile file;
  file.tensors["before"] = {"U8", {3}, {1, 2, 3}};
  file.tensors["long"] = tensor_of(values);
  write_safetensors(weight_folder() / "long.safetensors", file);
  EXPECT_EQ(WeightFile::open(weight_folder() / "long.safetensors")->read("long"), values);
}

TEST(WeightFile, AFileThatShrinksWhileItIsOpenIsAnError) {
  TensorFile file;
  file.tensors["a"] = tensor_of(std::vector<float>(100'000, 1.f));
  const fs::path path = weight_folder() / "shrinking.safetensors";
  write_safetensors(path, file);
  const auto weights = WeightFile::open(path);
  fs::resize_file(path, 5000);
  try {
    weights->read("a");
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, path);
    EXPECT_THAT(error.details().message, HasSubstr("shorter"));
  }
}

TEST(WeightFile, ReadsAStateDict) {
  const std::string bytes = weight_archive("}" + entry("a", tensor("0", 2)) + entry("b", tensor("1", 3)));
  const auto weights = WeightFile::from_memory(bytes, "");
  EXPECT_THAT(weights->read("a"), ElementsAre(1, 2));
  EXPECT_THAT(weights->read("b"), ElementsAre(3, 4, 5));
}

TEST(WeightFile, ListsOnlyTheStateDictOfACheckpoint) {
  for (const char* const key : {"state_dict", "model"}) {
    const std::string bytes = weight_archive("}" + entry("optimizer", "}" + entry("momentum", tensor("1", 3))) +
                                             entry(key, "}" + entry("a", tensor("0", 2))));
    EXPECT_THAT(WeightFile::from_memory(bytes, "")->tensors(), ElementsAre(Key("a")));
  }
}

TEST(WeightFile, ReadsTheFormatBeforeZip) {
  const std::string root = "}" + entry("a", tensor("9", 2, true)) + entry("b", tensor("7", 3, true));
  const std::string bytes = legacy(root, storage({3, 4, 5}) + storage({1, 2}));
  const auto weights = WeightFile::from_memory(bytes, "");
  EXPECT_THAT(weights->read("a"), ElementsAre(1, 2));
  EXPECT_THAT(weights->read("b"), ElementsAre(3, 4, 5));
}

TEST(WeightFile, RefusesADamagedFileOfTheFormatBeforeZip) {
  const std::string root = "}" + entry("a", tensor("9", 2, true)) + entry("b", tensor("7", 3, true));
  const std::string good = legacy(root, storage({3, 4, 5}) + storage({1, 2}));
  for (size_t length = 14; length < good.size(); length += 3) {
    EXPECT_THROW(WeightFile::from_memory(good.substr(0, length), ""), Error) << length;
  }
  std::string huge_count;
  append_little(huge_count, uint64_t(1) << 62);
  expect_bad_weights(legacy(root, huge_count), "cannot hold");
  expect_bad_weights(legacy("}" + entry("a", tensor("9", 2, true)), storage({3, 4, 5}) + storage({1, 2})),
                     "nothing refers to it");
  const std::string short_storage = legacy(root, storage({3, 4}) + storage({1, 2}));
  EXPECT_THROW(WeightFile::from_memory(short_storage, "")->read("b"), Error);
}

TEST(WeightFile, NamesAGlobalThatIsNotAllowed) {
  expect_bad_weights(weight_archive("}" + entry("a", "cos\nsystem\n(" + pickled_text("true") + "tR")), "os.system");
}

TEST(WeightFile, RefusesAFileWithoutNamedTensors) {
  expect_bad_weights(weight_archive("}" + entry("epoch", "K\x03")), "no named tensors");
  expect_bad_weights(weight_archive(tensor("0", 2)), "no named tensors");
}

TEST(WeightFile, RefusesWhatIsNoWeightFile) {
  EXPECT_THROW(WeightFile::from_memory("", "x"), Error);
  EXPECT_THROW(WeightFile::from_memory("this is a text of more than sixteen bytes", "x"), Error);
  EXPECT_THROW(WeightFile::open(weight_folder() / "absent.pth"), Error);
}

TEST(WeightFile, AnUnknownTensorIsNamed) {
  const std::string bytes = weight_archive("}" + entry("a", tensor("0", 2)));
  EXPECT_THROW(WeightFile::from_memory(bytes, "")->read("b"), Error);
}

TEST(SafetensorsStream, WritesWhatTheReaderReads) {
  for (const char* const dtype : {"F32", "F16"}) {
    SafetensorsStream out(weight_folder() / "stream.safetensors", {{"a", {2}}, {"b", {1, 3}}}, dtype);
    const std::vector<float> values = {1, 2, 3, 4, 0.5f};
    out.append(values.data(), 3);
    out.append(values.data() + 3, 2);
    out.commit();
    const auto weights = WeightFile::open(weight_folder() / "stream.safetensors");
    EXPECT_THAT(weights->read("a"), ElementsAre(1, 2));
    EXPECT_THAT(weights->read("b"), ElementsAre(3, 4, 0.5f));
  }
}

TEST(SafetensorsStream, LeavesNoFileUntilEveryValueIsThere) {
  fs::remove(weight_folder() / "part.safetensors");
  SafetensorsStream out(weight_folder() / "part.safetensors", {{"a", {2}}}, "F32");
  const float value = 1;
  out.append(&value, 1);
  EXPECT_THROW(out.commit(), Error);
  EXPECT_FALSE(fs::exists(weight_folder() / "part.safetensors"));
  out.append(&value, 1);
  EXPECT_THROW(out.append(&value, 1), Error);
  out.commit();
  EXPECT_TRUE(fs::exists(weight_folder() / "part.safetensors"));
}

}  // namespace
}  // namespace aligngs
