#include "io/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/half.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::filesystem::path npy_folder() { return std::filesystem::path(testing::TempDir()) / "npy_test"; }

/// A file as numpy.save writes it, without the padding.
std::string npy(const std::string& descr, const std::string& shape, const std::string& data, bool fortran = false,
                int version = 1) {
  const std::string header =
      "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
  std::string file = "\x93NUMPY";
  file += char(version);
  file += '\0';
  if (version == 1) {
    append_little(file, uint16_t(header.size()));
  } else {
    append_little(file, uint32_t(header.size()));
  }
  return file + header + data;
}

template <class T>
std::string bytes_of(std::vector<T> values, bool big_endian = false) {
  std::string out;
  for (const T v : values) {
    std::string one;
    append_little(one, v);
    if (big_endian) std::reverse(one.begin(), one.end());
    out += one;
  }
  return out;
}

void expect_bad_npy(const std::string& bytes, const std::string& field) {
  try {
    decode_npy(bytes, "depth.npy");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().field, field);
    EXPECT_EQ(error.details().path, "depth.npy");
  }
}

TEST(Npy, RoundTripsFloat32) {
  const std::vector<float> values = {1, -2.5f, INFINITY, 4, 5, std::numeric_limits<float>::denorm_min()};
  write_npy_float32(npy_folder() / "a.npy", {2, 3}, values.data());
  const FloatArray array = read_npy(npy_folder() / "a.npy");
  EXPECT_THAT(array.shape, ElementsAre(2, 3));
  EXPECT_EQ(array.data, values);
}

TEST(Npy, RoundTripsFloat16) {
  const std::vector<uint16_t> halves = {float_to_half(0.5f), float_to_half(-3)};
  write_npy_float16(npy_folder() / "h.npy", {2}, halves.data());
  EXPECT_THAT(read_npy(npy_folder() / "h.npy").data, ElementsAre(0.5f, -3.f));
  EXPECT_EQ(read_npy_header(npy_folder() / "h.npy").dtype, "<f2");
}

TEST(Npy, DataStartOnAMultipleOf64) {
  const float value = 1;
  for (const std::vector<int64_t>& shape : {std::vector<int64_t>{}, {1}, {1, 1, 1, 1, 1, 1, 1, 1, 1}}) {
    write_npy_float32(npy_folder() / "aligned.npy", shape, &value);
    EXPECT_EQ((std::filesystem::file_size(npy_folder() / "aligned.npy") - sizeof(float)) % 64, 0u);
    EXPECT_EQ(read_npy(npy_folder() / "aligned.npy").shape, shape);
  }
}

TEST(Npy, ReadsEveryNumericType) {
  EXPECT_THAT(decode_npy(npy("<f8", "(2,)", bytes_of<double>({0.25, -1e3})), "").data, ElementsAre(0.25f, -1e3f));
  EXPECT_THAT(decode_npy(npy("|i1", "(2,)", bytes_of<int8_t>({-3, 4})), "").data, ElementsAre(-3, 4));
  EXPECT_THAT(decode_npy(npy("<i2", "(2,)", bytes_of<int16_t>({-300, 4})), "").data, ElementsAre(-300, 4));
  EXPECT_THAT(decode_npy(npy("<i4", "(1,)", bytes_of<int32_t>({-70000})), "").data, ElementsAre(-70000));
  EXPECT_THAT(decode_npy(npy("<i8", "(1,)", bytes_of<int64_t>({-5})), "").data, ElementsAre(-5));
  EXPECT_THAT(decode_npy(npy("|u1", "(1,)", bytes_of<uint8_t>({200})), "").data, ElementsAre(200));
  EXPECT_THAT(decode_npy(npy("<u2", "(1,)", bytes_of<uint16_t>({65535})), "").data, ElementsAre(65535));
  EXPECT_THAT(decode_npy(npy("<u4", "(1,)", bytes_of<uint32_t>({1u << 31})), "").data, ElementsAre(2147483648.f));
  EXPECT_THAT(decode_npy(npy("<u8", "(1,)", bytes_of<uint64_t>({7})), "").data, ElementsAre(7));
  EXPECT_THAT(decode_npy(npy("|b1", "(2,)", bytes_of<uint8_t>({1, 0})), "").data, ElementsAre(1, 0));
}

TEST(Npy, ReadsBigEndian) {
  EXPECT_THAT(decode_npy(npy(">f4", "(2,)", bytes_of<float>({1.5f, -2}, true)), "").data, ElementsAre(1.5f, -2));
  EXPECT_THAT(decode_npy(npy(">i2", "(1,)", bytes_of<int16_t>({-300}, true)), "").data, ElementsAre(-300));
}

TEST(Npy, TurnsFortranOrderIntoCOrder) {
  const FloatArray array = decode_npy(npy("<f4", "(2, 3)", bytes_of<float>({1, 4, 2, 5, 3, 6}), true), "");
  EXPECT_THAT(array.data, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Npy, ReadsVersionsTwoAndThree) {
  for (const int version : {2, 3}) {
    EXPECT_THAT(decode_npy(npy("<f4", "(1,)", bytes_of<float>({9}), false, version), "").data, ElementsAre(9));
  }
  expect_bad_npy(npy("<f4", "(1,)", bytes_of<float>({9}), false, 4), "version");
}

TEST(Npy, ReadsALongHeaderFromAFile) {
  const std::string shape = "(" + std::string(10000, ' ') + "1,)";
  write_file_atomically(npy_folder() / "long.npy", npy("<f4", shape, bytes_of<float>({9}), false, 2));
  EXPECT_THAT(read_npy_header(npy_folder() / "long.npy").shape, ElementsAre(1));
}

TEST(Npy, ReadsScalarsAndEmptyArrays) {
  EXPECT_THAT(decode_npy(npy("<f4", "()", bytes_of<float>({9})), "").data, ElementsAre(9));
  EXPECT_TRUE(decode_npy(npy("<f4", "(0, 5)", "", true), "").data.empty());
}

TEST(Npy, RefusesWhatItCannotRead) {
  expect_bad_npy("not numpy at all", "magic");
  expect_bad_npy(npy("<c8", "(1,)", std::string(8, 'x')), "descr");
  expect_bad_npy(npy("|O", "(1,)", std::string(8, 'x')), "descr");
  expect_bad_npy(npy("<f4", "(1.5,)", std::string(4, 'x')), "header");
  expect_bad_npy(npy("<f4", "(-1,)", std::string(4, 'x')), "shape");
}

TEST(Npy, RefusesSizesThatDoNotMatchTheShape) {
  expect_bad_npy(npy("<f4", "(2,)", std::string(7, 'x')), "shape");
  expect_bad_npy(npy("<f4", "(2,)", std::string(9, 'x')), "shape");
  expect_bad_npy(npy("<f4", "(4611686018427387904, 4)", ""), "shape");
  expect_bad_npy(npy("<f4", "(0, 4611686018427387904, 4)", ""), "shape");
}

TEST(Npy, HeaderOfATruncatedFileIsRefused) {
  write_file_atomically(npy_folder() / "short.npy", npy("<f4", "(2,)", std::string(7, 'x')));
  EXPECT_THROW(read_npy_header(npy_folder() / "short.npy"), Error);
  EXPECT_THROW(read_npy_header(npy_folder() / "absent.npy"), Error);
}

}  // namespace
}  // namespace aligngs
