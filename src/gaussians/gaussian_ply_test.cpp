#include "gaussians/gaussian_ply.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/random.h"

namespace aligngs {
namespace {

std::filesystem::path file_in_temp(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "gaussian_ply_test";
  std::filesystem::create_directories(folder);
  return folder / name;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

GaussianModel random_model(size_t count) {
  GaussianModel model;
  model.sh_degree = 3;
  model.resize(count);
  Random random(5);
  for (auto* values : {&model.positions, &model.log_scales, &model.rotations, &model.opacity_logits, &model.sh}) {
    for (float& v : *values) v = static_cast<float>(random.normal());
  }
  return model;
}

std::string body_of(const std::string& file) { return file.substr(file.find("end_header\n") + 11); }

float number(const std::string& body, size_t index) {
  float value;
  std::memcpy(&value, body.data() + 4 * index, 4);
  return value;
}

TEST(GaussianPly, TheFileHasExactlyTheStandardRows) {
  const GaussianModel model = random_model(3);
  write_gaussian_ply(file_in_temp("strict.ply"), model);
  const std::string file = content_of(file_in_temp("strict.ply"));
  EXPECT_EQ(file.rfind("ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: default\nelement vertex 3\n"
                       "property float x\n",
                       0),
            0u);
  const std::string body = body_of(file);
  ASSERT_EQ(body.size(), 3u * 248);
  EXPECT_EQ(number(body, 62), model.positions[3]);
  EXPECT_EQ(number(body, 3), 0);                 // nx
  EXPECT_EQ(number(body, 6), model.sh[0]);       // f_dc_0
  EXPECT_EQ(number(body, 9), model.sh[3]);       // f_rest_0: red of coefficient 1
  EXPECT_EQ(number(body, 10), model.sh[6]);      // f_rest_1: red of coefficient 2
  EXPECT_EQ(number(body, 9 + 15), model.sh[4]);  // f_rest_15: green of coefficient 1
  EXPECT_EQ(number(body, 54), model.opacity_logits[0]);
  EXPECT_EQ(number(body, 55), model.log_scales[0]);
}

TEST(GaussianPly, RotationsAreNormalisedOnWriting) {
  write_gaussian_ply(file_in_temp("rotation.ply"), random_model(2));
  const std::string body = body_of(content_of(file_in_temp("rotation.ply")));
  double squared = 0;
  for (int k = 0; k < 4; ++k) squared += number(body, 58 + k) * number(body, 58 + k);
  EXPECT_NEAR(squared, 1, 1e-6);
}

TEST(GaussianPly, WrittenModelReadsBackEqual) {
  const GaussianModel model = random_model(5);
  write_gaussian_ply(file_in_temp("round.ply"), model);
  const GaussianModel back = read_gaussian_ply(file_in_temp("round.ply"));
  EXPECT_EQ(back.positions, model.positions);
  EXPECT_EQ(back.log_scales, model.log_scales);
  EXPECT_EQ(back.opacity_logits, model.opacity_logits);
  EXPECT_EQ(back.sh, model.sh);
  EXPECT_EQ(back.sh_degree, 3);
  EXPECT_EQ(back.semantic_channels, 0);
}

TEST(GaussianPly, TheSameModelGivesTheSameBytes) {
  write_gaussian_ply(file_in_temp("a.ply"), random_model(4));
  write_gaussian_ply(file_in_temp("other_name.ply"), random_model(4));
  EXPECT_EQ(content_of(file_in_temp("a.ply")), content_of(file_in_temp("other_name.ply")));
}

TEST(GaussianPly, LabelsFollowTheStandardProperties) {
  GaussianLabels labels;
  labels.label_set = "ade20k150";
  labels.label = {7, 65535};
  labels.instance = {1, 0};
  labels.confidence = {200, 0};
  write_labelled_gaussian_ply(file_in_temp("labels.ply"), random_model(2), labels);
  const std::string file = content_of(file_in_temp("labels.ply")), body = body_of(file);
  EXPECT_NE(file.find("comment aligngs label_set ade20k150\n"), std::string::npos);
  EXPECT_EQ(file.find("property float nx"), std::string::npos) << "zero normals are left out";
  ASSERT_EQ(body.size(), 2u * 241);
  EXPECT_EQ(static_cast<uint8_t>(body[236]), 7);
  EXPECT_EQ(static_cast<uint8_t>(body[240]), 200);
  EXPECT_EQ(static_cast<uint8_t>(body[241 + 237]), 255);
  EXPECT_EQ(read_gaussian_ply(file_in_temp("labels.ply")).size(), 2u);
}

TEST(GaussianPly, AFileWithLabelsLeavesOutHarmonicsThatAreZeroEverywhere) {
  GaussianModel model = random_model(2);
  for (size_t i = 0; i < model.sh.size(); ++i) {
    if (i % (3 * kShCoefficients) / 3 >= 4) model.sh[i] = 0;  // degree 1 has four coefficients
  }
  const GaussianLabels labels{"ade20k150", {7, 3}, {1, 0}, {200, 0}};
  write_labelled_gaussian_ply(file_in_temp("degree_1.ply"), model, labels);
  const std::string file = content_of(file_in_temp("degree_1.ply"));
  EXPECT_NE(file.find("property float f_rest_8\nproperty float opacity\n"), std::string::npos);
  EXPECT_EQ(body_of(file).size(), 2u * (4 * 23 + 5));
  const LabelledModel back = read_labelled_gaussian_ply(file_in_temp("degree_1.ply"));
  EXPECT_EQ(back.model.sh, model.sh);
  EXPECT_EQ(back.model.opacity_logits, model.opacity_logits);
  EXPECT_EQ(back.labels.label, labels.label);
}

TEST(GaussianPly, AFileWithLabelsOfPlainColoursHasNoHarmonics) {
  GaussianModel model = random_model(1);
  for (size_t k = 3; k < model.sh.size(); ++k) model.sh[k] = 0;
  write_labelled_gaussian_ply(file_in_temp("degree_0.ply"), model, {"ade20k150", {7}, {1}, {200}});
  EXPECT_EQ(content_of(file_in_temp("degree_0.ply")).find("f_rest"), std::string::npos);
  EXPECT_EQ(read_labelled_gaussian_ply(file_in_temp("degree_0.ply")).model.sh, model.sh);
}

TEST(GaussianPly, LabelsReadBack) {
  const GaussianModel model = random_model(700);
  GaussianLabels labels;
  labels.label_set = "ade20k150";
  for (size_t i = 0; i < model.size(); ++i) {
    labels.label.push_back(static_cast<uint16_t>(i % 3 == 0 ? 65535 : i));
    labels.instance.push_back(static_cast<uint16_t>(i / 2));
    labels.confidence.push_back(static_cast<uint8_t>(i));
  }
  const auto path = file_in_temp("labels_back.ply");
  write_labelled_gaussian_ply(path, model, labels);
  const LabelledModel back = read_labelled_gaussian_ply(path);
  EXPECT_EQ(back.labels.label, labels.label);
  EXPECT_EQ(back.labels.instance, labels.instance);
  EXPECT_EQ(back.labels.confidence, labels.confidence);
  EXPECT_EQ(back.model.sh, model.sh);
  EXPECT_EQ(back.model.positions, read_gaussian_ply(path).positions);
  write_gaussian_ply(path, model);
  EXPECT_THROW(read_labelled_gaussian_ply(path), Error) << "it has none";
}

TEST(GaussianPly, LabelsOfAnotherLengthAreRefused) {
  EXPECT_THROW(write_labelled_gaussian_ply(file_in_temp("bad.ply"), random_model(2), {}), Error);
}

TEST(GaussianPly, ANonFiniteModelIsNotWritten) {
  GaussianModel model = random_model(2);
  model.log_scales[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_gaussian_ply(file_in_temp("never.ply"), model), Error);
  EXPECT_FALSE(std::filesystem::exists(file_in_temp("never.ply")));
}

std::filesystem::path ascii_file(const std::string& name, const std::vector<std::string>& properties,
                                 const std::string& row) {
  std::ofstream out(file_in_temp(name));
  out << "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (const std::string& property : properties) out << "property double " << property << "\n";
  out << "end_header\n" << row << "\n";
  return file_in_temp(name);
}

const std::vector<std::string> kMinimal = {"opacity", "z",       "y",       "x",     "f_dc_0", "f_dc_1", "f_dc_2",
                                           "scale_0", "scale_1", "scale_2", "rot_0", "rot_1",  "rot_2",  "rot_3"};

TEST(GaussianPly, MissingHarmonicsAreZeroAndOrderDoesNotMatter) {
  const GaussianModel model =
      read_gaussian_ply(ascii_file("minimal.ply", kMinimal, "0.5 3 2 1 .1 .2 .3 -1 -2 -3 1 0 0 0"));
  ASSERT_EQ(model.size(), 1u);
  EXPECT_EQ(model.positions, (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(model.sh_degree, 0);
  EXPECT_FLOAT_EQ(model.sh[1], 0.2f);
  EXPECT_EQ(model.sh[3], 0);
}

TEST(GaussianPly, SemanticRowsAreRead) {
  std::vector<std::string> properties = kMinimal;
  properties.insert(properties.end(), {"semantic_0", "semantic_1"});
  const GaussianModel model =
      read_gaussian_ply(ascii_file("semantic.ply", properties, "0.5 3 2 1 0 0 0 0 0 0 1 0 0 0 0.25 -4"));
  EXPECT_EQ(model.semantic_channels, 2);
  EXPECT_EQ(model.semantics, (std::vector<float>{0.25f, -4}));
}

TEST(GaussianPly, DegreeOneHarmonicsAreNinePropertiesChannelByChannel) {
  std::vector<std::string> properties = kMinimal;
  for (int i = 0; i < 9; ++i) properties.push_back("f_rest_" + std::to_string(i));
  const GaussianModel model =
      read_gaussian_ply(ascii_file("degree1.ply", properties, "0 3 2 1 0 0 0 0 0 0 1 0 0 0 1 2 3 4 5 6 7 8 9"));
  EXPECT_EQ(model.sh_degree, 1);
  EXPECT_EQ(model.sh[3], 1);      // coefficient 1, red
  EXPECT_EQ(model.sh[4], 4);      // coefficient 1, green
  EXPECT_EQ(model.sh[3 * 3], 3);  // coefficient 3, red
}

TEST(GaussianPly, BadFilesAreNamed) {
  const auto message = [](const std::filesystem::path& path) -> std::string {
    try {
      read_gaussian_ply(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  };
  std::vector<std::string> flat = kMinimal;
  flat.erase(flat.begin() + 9);
  EXPECT_NE(message(ascii_file("flat.ply", flat, "0 3 2 1 0 0 0 0 0 1 0 0 0")).find("scale_2"), std::string::npos);
  EXPECT_NE(message(ascii_file("nan.ply", kMinimal, "0 3 2 nan 0 0 0 0 0 0 1 0 0 0")).find("not finite"),
            std::string::npos);
  std::vector<std::string> odd = kMinimal;
  odd.push_back("f_rest_0");
  EXPECT_NE(message(ascii_file("odd.ply", odd, "0 3 2 1 0 0 0 0 0 0 1 0 0 0 1")).find("f_rest"), std::string::npos);
}

}  // namespace
}  // namespace aligngs
