// A rendering of the median depth alone has the depth of a whole one, bit for bit, with every instruction set.
#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "engine/cpu/cpu_engine.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

TEST(MedianDepth, AloneEqualsThatOfAWholeRendering) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    RandomSceneOptions o;
    o.gaussians = 400;
    o.width = 83;  // cut tiles
    o.height = 59;
    o.logit_max = 9;  // some pixels close at once
    CpuEngine engine(2);
    engine.load(make_model(o));
    const Camera camera = make_camera(o.width, o.height);
    RenderOptions options;
    const ImageF whole = engine.render(camera, options).depth_median;
    options.median_only = true;
    EXPECT_EQ(engine.render(camera, options).depth_median.data, whole.data) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace aligngs::cpu
