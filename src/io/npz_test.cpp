#include "io/npz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/half.h"
#include "io/atomic_file.h"
#include "io/npy.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::filesystem::path file() { return std::filesystem::path(testing::TempDir()) / "npz_test.npz"; }

const std::vector<uint16_t> kHalf = {float_to_half(1), float_to_half(-0.5f), 0, 0, 0, float_to_half(2)};

std::string refusal(const std::string& bytes) {
  try {
    decode_npz(bytes, "a.npz");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Npz, ReadsBackTheArrayItWrote) {
  write_npz_float16(file(), {2, 3}, kHalf.data());
  const FloatArray array = read_npz(file());
  EXPECT_THAT(array.shape, ElementsAre(2, 3));
  EXPECT_THAT(array.data, ElementsAre(1, -0.5f, 0, 0, 0, 2));
}

TEST(Npz, TheHeaderIsReadAlone) {
  write_npz_float16(file(), {2, 3}, kHalf.data());
  const ArrayHeader header = read_npz_header(file());
  EXPECT_THAT(header.shape, ElementsAre(2, 3));
  EXPECT_EQ(header.dtype, "<f2");
}

TEST(Npz, AMapOfFewClassesTakesFewBytes) {
  std::vector<uint16_t> map(150 * 96 * 128);  // bytes: 3.7 million
  for (size_t i = 0; i < 96 * 128; ++i) map[i] = float_to_half(0.9f);
  write_npz_float16(file(), {150, 96, 128}, map.data());
  EXPECT_LT(std::filesystem::file_size(file()), 20000u);
  EXPECT_THAT(read_npz_header(file()).shape, ElementsAre(150, 96, 128));
}

TEST(Npz, EqualArraysGiveEqualBytes) {
  write_npz_float16(file(), {2, 3}, kHalf.data());
  const std::string first = read_file(file());
  write_npz_float16(file(), {2, 3}, kHalf.data());
  EXPECT_EQ(read_file(file()), first);
}

TEST(Npz, ArraysStoredWithoutCompressionAreRead) {
  const std::string array = encode_npy_float16("a", {6}, kHalf.data());
  EXPECT_THAT(decode_npz(make_stored_zip({{"values.npy", array}}), "a.npz").data, ElementsAre(1, -0.5f, 0, 0, 0, 2));
}

TEST(Npz, SeveralArraysAreRefused) {
  const std::string array = encode_npy_float16("a", {6}, kHalf.data());
  EXPECT_THAT(refusal(make_deflated_zip({{"a.npy", array}, {"b.npy", array}})), HasSubstr("2 arrays"));
}

TEST(Npz, NoArrayIsRefused) { EXPECT_THAT(refusal(make_deflated_zip({})), HasSubstr("0 arrays")); }

TEST(Npz, AnotherFileIsRefused) {
  EXPECT_THAT(refusal(make_deflated_zip({{"a.txt", "hello"}})), HasSubstr("not a NumPy"));
}

TEST(Npz, EveryCutFileIsRefused) {
  write_npz_float16(file(), {2, 3}, kHalf.data());
  const std::string whole = read_file(file());
  for (size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_NE(refusal(whole.substr(0, bytes)), "accepted") << bytes;
  }
}

TEST(Npz, AFlippedBitOfTheDataIsRefused) {
  write_npz_float16(file(), {2, 3}, kHalf.data());
  std::string damaged = read_file(file());
  damaged[60] ^= 1;  // within the compressed array
  EXPECT_NE(refusal(damaged), "accepted");
}

}  // namespace
}  // namespace aligngs
