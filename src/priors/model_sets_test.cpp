#include "priors/model_sets.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

std::vector<std::string> names_of(const std::vector<const PublishedModel*>& models) {
  std::vector<std::string> names;
  for (const PublishedModel* model : models) names.push_back(model->name);
  return names;
}

TEST(ModelSets, ASetStandsForItsModels) {
  EXPECT_THAT(names_of(models_of({"recommended"})), testing::ElementsAre("da3-base", "da3metric-large", "eomt-l"));
}

TEST(ModelSets, ModelsOfSeveralNamesComeOnceAndAfterTheirBackbones) {
  EXPECT_THAT(names_of(models_of({"light", "ade20k-linear-s", "lingbot-s"})),
              testing::ElementsAre("da3-small", "lingbot-s", "dinov2-s", "ade20k-linear-s"));
}

TEST(ModelSets, AnUnknownNameIsAUsageError) {
  try {
    models_of({"recomended"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  }
}

TEST(ModelSets, LightAndRecommendedMayBeUsedByAnyoneAndHaveTheStatedSizes) {
  const auto gigabytes = [](const char* set) {
    double bytes = 0;
    for (const PublishedModel* model : models_of({set})) {
      EXPECT_TRUE(model->licence.commercial) << model->name;
      EXPECT_FALSE(model->licence.gated) << model->name;
      bytes += double(download_bytes(*model));
    }
    return bytes / 1e9;
  };
  EXPECT_NEAR(gigabytes("light"), 0.2, 0.05);
  EXPECT_NEAR(gigabytes("recommended"), 3.1, 0.2);
}

TEST(ModelSets, EveryModelOfASetHasAnExpectedTime) {
  for (const ModelSet& set : model_sets()) {
    for (const std::string& model : set.models) EXPECT_GT(tera_operations_per_photo(model), 0) << model;
  }
}

}  // namespace
}  // namespace aligngs
