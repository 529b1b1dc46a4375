#include "train/checkpoint_packing.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "train/checkpoint_tensors.h"

namespace aligngs {
namespace {

TensorFile some_tensors() {
  TensorFile file;
  std::vector<float> alike(40000, 0.25f), noise(40000), sparse(40000, -9.25f);
  uint32_t state = 1;
  for (float& v : noise) {
    state = state * 1664525u + 1013904223u;
    std::memcpy(&v, &state, sizeof v);
  }
  for (size_t i = 0; i < alike.size(); ++i) alike[i] = static_cast<float>(i % 100);
  for (size_t i = 0; i < sparse.size(); i += 7) sparse[i] = noise[i];
  file.tensors["alike"] = {"F32", {400, 100}, {}};
  file.tensors["alike"].bytes = raw_tensor("F32", alike.data(), alike.size()).bytes;
  file.tensors["sparse"] = {"F32", {200, 200}, {}};
  file.tensors["sparse"].bytes = raw_tensor("F32", sparse.data(), sparse.size()).bytes;
  file.tensors["noise"] = raw_tensor("F32", noise.data(), noise.size());
  file.tensors["small"] = raw_tensor("F32", alike.data(), 3);
  file.metadata["iteration"] = "7";
  return file;
}

TEST(CheckpointPacking, NothingIsLostAndOnlyWhatShrinksIsPacked) {
  const TensorFile before = some_tensors();
  TensorFile file = before;
  pack_tensors(file);
  EXPECT_LT(file.tensors.at("gzip.alike").bytes.size(), 3000u);
  EXPECT_LT(file.tensors.at("sparse.sparse").bytes.size(), 30000u);
  EXPECT_EQ(file.metadata.at("sparse.sparse"), "3239313408 F32 200 200");
  EXPECT_EQ(file.metadata.at("gzip.alike"), "F32 400 100");
  EXPECT_TRUE(file.tensors.count("small"));
  unpack_tensors(file, "test");
  EXPECT_EQ(file.metadata, before.metadata);
  ASSERT_EQ(file.tensors.size(), before.tensors.size());
  for (const auto& [name, tensor] : before.tensors) {
    EXPECT_EQ(file.tensors.at(name).bytes, tensor.bytes) << name;
    EXPECT_EQ(file.tensors.at(name).shape, tensor.shape) << name;
    EXPECT_EQ(file.tensors.at(name).dtype, tensor.dtype) << name;
  }
}

TEST(CheckpointPacking, AWrongDescriptionIsBadInput) {
  for (const char* const text : {"", "F32", "F32 400 99", "F32 400 101", "F16 400 100", "F32 -400 -100", "F32 400 x",
                                 "F32 9000000000 9000000000"}) {
    TensorFile file = some_tensors();
    pack_tensors(file);
    file.metadata["gzip.alike"] = text;
    EXPECT_THROW(unpack_tensors(file, "test"), Error) << text;
  }
}

TEST(CheckpointPacking, AWrongDescriptionOfSparseFloatsIsBadInput) {
  for (const char* const text : {"", "F32 200 200", "x F32 200 200", "7 F32 200 199", "7 F32 200 300", "7 I64 100 200",
                                 "7 F32 9000000000 9000000000"}) {
    TensorFile file = some_tensors();
    pack_tensors(file);
    file.metadata["sparse.sparse"] = text;
    EXPECT_THROW(unpack_tensors(file, "test"), Error) << text;
  }
}

TEST(CheckpointPacking, ADamagedStreamIsBadInput) {
  for (const char* const name : {"gzip.alike", "sparse.sparse"}) {
    TensorFile file = some_tensors();
    pack_tensors(file);
    std::vector<uint8_t>& stream = file.tensors.at(name).bytes;
    stream.resize(stream.size() / 2);
    EXPECT_THROW(unpack_tensors(file, "test"), Error) << name;
  }
}

}  // namespace
}  // namespace aligngs
