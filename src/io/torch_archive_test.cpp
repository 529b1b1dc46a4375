#include "io/torch_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/half.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::string_literals;
namespace fs = std::filesystem;

fs::path tensor_folder() { return fs::path(testing::TempDir()) / "torch_archive_test"; }

std::string pickled_key(const std::string& s) {
  std::string out = "X";
  append_little(out, uint32_t(s.size()));
  return out + s;
}
std::string integer(int32_t value) {
  std::string out = "J";
  append_little(out, value);
  return out;
}
std::string tuple(const std::vector<int32_t>& values) {
  std::string out = "(";
  for (const int32_t value : values) out += integer(value);
  return out + "t";
}

/// The pickle of torch._utils._rebuild_tensor_v2(storage, offset, size, stride, False,
/// OrderedDict()).
struct TensorPickle {
  std::string storage = "FloatStorage";
  int32_t storage_elements = 6, offset = 0;
  std::vector<int32_t> size = {2, 3}, stride = {3, 1};

  std::string str() const {
    return "ctorch._utils\n_rebuild_tensor_v2\n((" + pickled_key("storage") + "ctorch\n" + storage + "\n" +
           pickled_key("0") + pickled_key("cuda:0") + integer(storage_elements) + "tQ" + integer(offset) + tuple(size) +
           tuple(stride) +
           "\x89"
           "ccollections\nOrderedDict\n)RtR";
  }
};

template <class T>
std::string storage_of(const std::vector<T>& values, bool big_endian = false) {
  std::string out;
  for (const T v : values) {
    std::string one;
    append_little(one, v);
    out += big_endian ? std::string(one.rbegin(), one.rend()) : one;
  }
  return out;
}
const std::string kSix = storage_of<float>({1, 2, 3, 4, 5, 6});

std::string tensor_archive(const std::string& pickle, const std::string& storage) {
  return make_stored_zip({{"t/data.pkl", "\x80\x02" + pickle + "."}, {"t/data/0", storage}, {"t/version", "3\n"}});
}

void expect_bad_tensor(const std::string& bytes, const std::string& message) {
  try {
    decode_torch_tensor(bytes, "logits.pt");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "logits.pt");
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(TorchArchive, RoundTripsWhatItWrites) {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6.5f};
  write_torch_tensor(tensor_folder() / "a.pt", {2, 1, 3}, values.data());
  const FloatArray array = read_torch_tensor(tensor_folder() / "a.pt");
  EXPECT_THAT(array.shape, ElementsAre(2, 1, 3));
  EXPECT_EQ(array.data, values);
  EXPECT_EQ(read_torch_tensor_header(tensor_folder() / "a.pt").dtype, "float32");
  EXPECT_THAT(read_torch_tensor_header(tensor_folder() / "a.pt").shape, ElementsAre(2, 1, 3));
}

TEST(TorchArchive, ReadsEveryStorageType) {
  const auto read = [](const std::string& type, const std::string& storage) {
    return decode_torch_tensor(tensor_archive(TensorPickle{type, 2, 0, {2}, {1}}.str(), storage), "").data;
  };
  EXPECT_THAT(read("HalfStorage", storage_of<uint16_t>({float_to_half(0.5f), float_to_half(-2)})),
              ElementsAre(0.5f, -2));
  EXPECT_THAT(read("BFloat16Storage", storage_of<uint16_t>({0x3f80, 0xc000})), ElementsAre(1, -2));
  EXPECT_THAT(read("DoubleStorage", storage_of<double>({0.25, 3})), ElementsAre(0.25f, 3));
  EXPECT_THAT(read("LongStorage", storage_of<int64_t>({-1, 3})), ElementsAre(-1, 3));
  EXPECT_THAT(read("IntStorage", storage_of<int32_t>({-1, 3})), ElementsAre(-1, 3));
  EXPECT_THAT(read("ShortStorage", storage_of<int16_t>({-1, 3})), ElementsAre(-1, 3));
  EXPECT_THAT(read("CharStorage", storage_of<int8_t>({-1, 3})), ElementsAre(-1, 3));
  EXPECT_THAT(read("ByteStorage", storage_of<uint8_t>({255, 3})), ElementsAre(255, 3));
  EXPECT_THAT(read("BoolStorage", storage_of<uint8_t>({0, 1})), ElementsAre(0, 1));
}

TEST(TorchArchive, ReadsStridedViews) {
  const auto read = [](TensorPickle pickle) {
    return decode_torch_tensor(tensor_archive(pickle.str(), kSix), "").data;
  };
  EXPECT_THAT(read({"FloatStorage", 6, 0, {3, 2}, {1, 3}}), ElementsAre(1, 4, 2, 5, 3, 6));  // transposed
  EXPECT_THAT(read({"FloatStorage", 6, 1, {2, 2}, {3, 1}}), ElementsAre(2, 3, 5, 6));        // a slice
  EXPECT_THAT(read({"FloatStorage", 6, 2, {2, 2}, {0, 1}}), ElementsAre(3, 4, 3, 4));        // expanded
  EXPECT_THAT(read({"FloatStorage", 6, 5, {}, {}}), ElementsAre(6));                         // a scalar
  EXPECT_THAT(read({"FloatStorage", 6, 0, {0, 3}, {3, 1}}), ElementsAre());                  // empty
}

TEST(TorchArchive, FindsTheOneTensorOfADictOrList) {
  const std::string tensor = TensorPickle().str();
  const std::string dict =
      "}" + pickled_key("note") + pickled_key("logits of a view") + "s" + pickled_key("logits") + tensor + "s";
  EXPECT_EQ(decode_torch_tensor(tensor_archive(dict, kSix), "").data.size(), 6u);
  EXPECT_EQ(decode_torch_tensor(tensor_archive("]" + tensor + "a", kSix), "").data.size(), 6u);
  expect_bad_tensor(tensor_archive("]" + tensor + "a" + tensor + "a", kSix), "2 tensors");
  expect_bad_tensor(tensor_archive("}", kSix), "0 tensors");
  expect_bad_tensor(tensor_archive("N", kSix), "0 tensors");
}

TEST(TorchArchive, ReadsAParameter) {
  const std::string parameter = "ctorch._utils\n_rebuild_parameter\n(" + TensorPickle().str() +
                                "\x88"
                                "ccollections\nOrderedDict\n)RtR";
  EXPECT_EQ(decode_torch_tensor(tensor_archive(parameter, kSix), "").data.size(), 6u);
}

TEST(TorchArchive, HonoursTheByteOrderRecord) {
  const std::string bytes = make_stored_zip({{"t/data.pkl", "\x80\x02" + TensorPickle().str() + "."},
                                             {"t/byteorder", "big"},
                                             {"t/data/0", storage_of<float>({1, 2, 3, 4, 5, 6}, true)}});
  EXPECT_THAT(decode_torch_tensor(bytes, "").data, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(TorchArchive, RefusesViewsBeyondTheStorage) {
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 1, {2, 3}, {3, 1}}.str(), kSix),
                    "beyond the storage");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {2, 3}, {4, 1}}.str(), kSix),
                    "beyond the storage");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 6, {1}, {1}}.str(), kSix), "beyond the storage");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {2, 3}, {-3, 1}}.str(), kSix), "whole number");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, -1, {1}, {1}}.str(), kSix), "whole number");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {-2}, {1}}.str(), kSix), "whole number");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {2, 3}, {1}}.str(), kSix), "different lengths");
}

TEST(TorchArchive, RefusesHugeViewsOfSmallStorages) {
  constexpr int32_t kLarge = 2'000'000'000;
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {kLarge}, {0}}.str(), kSix), "repeats");
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 6, 0, {kLarge, kLarge, kLarge}, {0, 0, 0}}.str(), kSix),
                    "too large");
}

TEST(TorchArchive, RefusesStoragesOfTheWrongSizeOrType) {
  expect_bad_tensor(tensor_archive(TensorPickle{"FloatStorage", 7, 0, {2, 3}, {3, 1}}.str(), kSix), "28 are needed");
  expect_bad_tensor(tensor_archive(TensorPickle{"DoubleStorage", 6, 0, {2, 3}, {3, 1}}.str(), kSix), "48 are needed");
  expect_bad_tensor(tensor_archive(TensorPickle{"QInt8Storage", 6, 0, {2, 3}, {3, 1}}.str(), kSix),
                    "torch.QInt8Storage");
  expect_bad_tensor(make_stored_zip({{"t/data.pkl", "\x80\x02" + TensorPickle().str() + "."}}), "missing");
}

TEST(TorchArchive, RefusesWhatTorchDidNotWrite) {
  expect_bad_tensor("no archive", "not a ZIP");
  expect_bad_tensor(make_stored_zip({{"t/data/0", kSix}}), "data.pkl");
  expect_bad_tensor("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19."s, "too early");
  expect_bad_tensor(tensor_archive("cposix\nsystem\n" + pickled_key("ls") + "\x85R", kSix), "posix.system");
}

TEST(TorchArchive, RefusesTheStoredBadFiles) {
  const fs::path files = fs::path(ALIGNGS_SOURCE_DIR) / "tests/data/parity/loader";
  for (const char* name : {"reject_global.pth", "reject_truncated.pth", "legacy.pth"}) {
    EXPECT_THROW(read_torch_tensor(files / name), Error) << name;
  }
  try {
    read_torch_tensor(files / "state_dict.pth");
    FAIL() << "a whole network is no single tensor";
  } catch (const Error& error) {
    EXPECT_THAT(error.details().message, HasSubstr("9 tensors"));
  }
}

}  // namespace
}  // namespace aligngs
