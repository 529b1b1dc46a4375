// Prior depth of every scale (DepthScale) in training, in metric and arbitrary worlds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "train/prior_alignment.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/scene_maintenance.h"
#include "train/testing/textured_scene.h"
#include "train/train_run.h"
#include "train/training_set.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using test_train::TexturedScene;
using testing::HasSubstr;

constexpr double kWorlds[] = {1, 0.37};  // scene units per metre; the first scene is metric

/// Relative to metres: what a network's map of a view holds for a metre of the slope.
double unit_of(DepthScale scale, double world, int view) {
  switch (scale) {
    case DepthScale::kScene:
      return world;
    case DepthScale::kMetres:
      return 1 + 0.06 * (view - 0.5);
    case DepthScale::kOwn:
      return 2.7;
    case DepthScale::kPerView:
      return view == 0 ? 0.4 : 1.9;
  }
  return 0;
}

TexturedScene textured(DepthScale scale, double world) {
  TexturedScene how;
  how.scale = world;
  how.view = [=](int index, SceneViewParts& view) {
    for (float& z : view.prior_depth.data) z *= static_cast<float>(unit_of(scale, world, index) / world);
  };
  how.scene = [=](SceneParts& parts) { parts.priors.depth_scale = scale; };
  return how;
}

class DepthScales : public test_train::QuietRuns {
 protected:
  fs::path trained(const fs::path& scene, const std::string& name, int64_t steps,
                   const std::vector<std::string>& sets = {}) const {
    TrainOptions o;
    o.scene = scene;
    o.run = base_ / name;
    o.config.iterations = steps;
    o.config.sets = sets;
    o.config.sets.push_back("train.log_every=1");
    o.progress.enabled = false;
    o.threads = 1;
    train_run(o);
    return o.run;
  }

  static nlohmann::json last_step(const fs::path& run) {
    std::istringstream lines(read_file(RunFolder(run).events()));
    nlohmann::json last;
    for (std::string line; std::getline(lines, line);) {
      const nlohmann::json event = parse_json(line);
      if (event.is_object() && event.contains("losses")) last = event;
    }
    return last;
  }
};

TEST_F(DepthScales, EveryKindTrainsAsDepthInSceneUnitsDoes) {
  for (const double world : kWorlds) {
    const fs::path run = trained(test_train::write_textured_scene("scene", textured(DepthScale::kScene, world)),
                                 "scene" + std::to_string(world), 20);
    const nlohmann::json want = last_step(run);
    for (const DepthScale scale : {DepthScale::kMetres, DepthScale::kOwn, DepthScale::kPerView}) {
      const std::string name = std::string(name_of(scale)) + std::to_string(world);
      const nlohmann::json got =
          last_step(trained(test_train::write_textured_scene(name, textured(scale, world)), name, 20));
      EXPECT_GT(got["losses"]["log_depth"].get<double>(), 0) << name;
      EXPECT_LT(got["losses"]["log_depth"].get<double>(), 0.01) << name << ": 1 % of depth";
      EXPECT_NEAR(got["gaussians"].get<double>() / want["gaussians"].get<double>(), 1, 0.05) << name;
      EXPECT_NEAR(got["psnr"].get<double>(), want["psnr"].get<double>(), 0.5) << name;
    }
  }
}

TEST_F(DepthScales, TheRunSaysScaleFactorAndResidual) {
  const fs::path run = trained(test_train::write_textured_scene("own", textured(DepthScale::kOwn, 1)), "run", 1);
  const std::string note = read_run_record(RunFolder(run).record()).prior_depth;
  EXPECT_THAT(note, HasSubstr("\"own\""));
  EXPECT_THAT(note, HasSubstr("factor 0.37"));  // 1 / 2.7
  EXPECT_THAT(note, HasSubstr("2 views by points"));
  EXPECT_THAT(note, HasSubstr("residual 0."));
}

TEST_F(DepthScales, DepthThatDoesNotFitThePointsGivesItsCorrelationAlone) {
  TexturedScene how = textured(DepthScale::kPerView, 1);
  const auto scaled = how.view;
  how.view = [=](int index, SceneViewParts& view) {
    scaled(index, view);
    for (int y = 0; y < view.prior_depth.height; ++y) {
      for (int x = 0; x < view.prior_depth.width; ++x)
        view.prior_depth.at(x, y) *= 1 + 0.03f * static_cast<float>(x % 12);
    }
  };
  const fs::path scene = test_train::write_textured_scene("rough", how);
  const PriorUse use = decide_prior_use(open_scene(scene), make_preset(Preset::kDefault));
  EXPECT_EQ(use.depth, PriorDepthKind::kRelative);
  EXPECT_TRUE(use.warnings.empty()) << "training does not go without it";
  EXPECT_THAT(use.depth_note, HasSubstr("correlation"));
  EXPECT_GT(last_step(trained(scene, "run", 20, {"init.start=cloud"}))["losses"]["pearson"].get<double>(), 0);
}

TEST_F(DepthScales, WithoutPointsAnUnknownScaleStaysUnknown) {
  for (const DepthScale scale : {DepthScale::kOwn, DepthScale::kPerView}) {
    TexturedScene how = textured(scale, 0.37);
    const auto stated = how.scene;
    how.scene = [=](SceneParts& parts) {
      stated(parts);
      parts.cloud = {};
    };
    const Scene scene = open_scene(test_train::write_textured_scene(name_of(scale), how));
    TrainConfig config = make_preset(Preset::kDefault);
    EXPECT_EQ(decide_prior_use(scene, config).depth, PriorDepthKind::kRelative);
    config.data.prior_depth = PriorDepthUse::kMetric;
    const PriorUse forced = decide_prior_use(scene, config);
    EXPECT_EQ(forced.depth, PriorDepthKind::kMetric);
    EXPECT_EQ(forced.depth_factor(0), 1) << "as it is";
  }
}

TEST_F(DepthScales, NearPlanesAreInTheUnitsOfTheScene) {
  const double world = 0.37;
  const Scene of_scene = open_scene(test_train::write_textured_scene("scene", textured(DepthScale::kScene, world)));
  const Scene own = open_scene(test_train::write_textured_scene("own", textured(DepthScale::kOwn, world)));
  const TrainConfig config = make_preset(Preset::kDefault);
  const float want = near_plane_of_view(of_scene, config, decide_prior_use(of_scene, config), of_scene.train[0]);
  EXPECT_NEAR(near_plane_of_view(own, config, decide_prior_use(own, config), own.train[0]) / want, 1, 0.02);
}

/// A use with metric depth in which the second of two views is not placed.
PriorUse one_unplaced() {
  PriorUse use;
  use.depth = PriorDepthKind::kMetric;
  use.placement = as_given(2);
  use.placement.views[1] = {};
  return use;
}

TEST(UnplacedDepth, CountsAsNoneUntilRenderingsTellItsScale) {
  const PriorUse use = one_unplaced();
  EXPECT_FALSE(use.is_unplaced(0));
  EXPECT_TRUE(use.is_unplaced(1));
  EXPECT_EQ(use.depth_factor(1), 1);
  PriorScales scales = scales_of_agreeing_depth(2);
  free_unplaced(use, scales);
  EXPECT_THAT(scales.scale, testing::ElementsAre(1, 0));
  EXPECT_THAT(scales.known, testing::ElementsAre(1, 0));
  EXPECT_THAT(scales.free, testing::ElementsAre(0, 1));
}

TEST(UnplacedDepth, ItsScaleIsFoundInARenderingHoweverFarFromOne) {
  PriorAlignmentRule rule;
  ImageF prior(20, 20, 1), rendered(20, 20, 1);
  for (size_t i = 0; i < prior.data.size(); ++i) {
    prior.data[i] = 1 + 0.001f * static_cast<float>(i);
    rendered.data[i] = (i % 4 == 0 ? 5.0f : 3.7f) * prior.data[i];  // a quarter shows another surface
  }
  ASSERT_TRUE(find_prior_scale(prior, {}, rendered, rule));
  EXPECT_NEAR(*find_prior_scale(prior, {}, rendered, rule), 3.7, 1e-5);
  EXPECT_FALSE(align_prior_to_depth(prior, {}, rendered, rule)) << "which is for depth of a known scale";
  EXPECT_FALSE(find_prior_scale(ImageF(5, 5, 1, 1.0f), {}, ImageF(5, 5, 1, 2.0f), rule)) << "too few pixels";
}

}  // namespace
}  // namespace aligngs
